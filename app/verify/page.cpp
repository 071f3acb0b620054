/// Markdown, and gnuplot scripts with their data within.
#include "app/verify/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/sheet.hpp"

namespace rosin::app::verify {

namespace fs = std::filesystem;

namespace {

/// "fault-cycles" as a heading.
std::string heading(std::string group) {
  std::ranges::replace(group, '-', ' ');
  if (!group.empty()) group[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(group[0])));
  return group;
}

/// A text in a cell of a table.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : c == '\n' ? std::string(" ") : std::string(1, c);
  return out;
}

/// A text of so many characters at most, cut between words.
std::string shortened(const std::string& text, int most) {
  auto cut = fmt::format("{:.{}}", text, most);
  if (cut == text) return text;
  return cut.substr(0, cut.find_last_of(' ')) + " …";
}

/// A text for gnuplot that is a format, in which % means something.
std::string tic_label(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '%' ? std::string("%%") : std::string(1, c);
  return output::single_quoted(out);
}

/// A text as a sentence within a paragraph, in which nothing is markup.
std::string sentence(const std::string& text) {
  std::string out;
  for (const char c : text.substr(0, text.find_last_not_of(" .") + 1))
    out += std::string_view("*_|<>`[]").find(c) == std::string_view::npos ? std::string(1, c) : std::string("\\") + c;
  return out + '.';
}

std::string picture_name(const std::string& group) { return "verify-" + group; }

/// Rows of a picture: relative to the size of the number that is wanted.
std::string rows_of(const std::vector<const Answer*>& answers, bool explained) {
  constexpr double least = 1e-16;
  std::string rows;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto& answer = *answers[i];
    if (explained != (answer.verdict == Verdict::differs)) continue;
    const double accuracy = answer.question->accuracy[answer.worst];
    const double size = std::max(std::abs(answer.wanted()[answer.worst]), accuracy), error = answer.error[answer.worst];
    rows += fmt::format("{} {:.3g} {:.3g} {}\n", i, std::max(answer.difference() / size, least), accuracy / size,
                        std::isfinite(error) ? fmt::format("{:.3g}", std::max(error / size, least)) : "nan");
  }
  return rows;
}

std::string picture(const std::string& group, const std::vector<const Answer*>& answers) {
  constexpr int row = 19;  // pixels
  const auto count = static_cast<int>(answers.size());
  const output::Sheet sheet{picture_name(group),
                            "How far rosin is from the numbers of others",
                            {.width = 1060, .panel = double(row * count), .left = 440},
                            heading(group)};
  std::string script;
  std::string tics;
  for (int i = 0; i < count; ++i) {
    const auto& answer = *answers[static_cast<std::size_t>(i)];
    tics += fmt::format("{}{} {}", i ? ", " : "",
                        tic_label(shortened(fmt::format("{}: {}", answer.name, answer.question->what), 66)), i);
  }
  const auto agreeing = rows_of(answers, false), explained = rows_of(answers, true);
  script += fmt::format(R"($agreeing << EOD
{}EOD
$explained << EOD
{}EOD
set datafile separator ' '
set logscale x
set xrange [5e-17:2]
set yrange [{}.5:-0.5]
set format x '10^{{%T}}'
set xtics 1e-16, 100
tick_font = narrow ? small : sprintf(',%.4g', 11/13.*size)
set ytics ({}) font tick_font
set grid x linecolor '#DDDDDD'
set xlabel 'difference over the number wanted (dimensionless)'
)",
                        agreeing, explained, count - 1, tics);
  std::string plots;
  const auto add = [&](const std::string& plot) { plots += (plots.empty() ? "plot " : ", \\\n     ") + plot; };
  const auto bars = [&](const char* data, const char* title) {
    add(fmt::format("{} using (5e-17):1:($3-5e-17):(0) with vectors nohead linewidth 8 linecolor '#CFCFCF' {}", data,
                    title));
  };
  if (!agreeing.empty()) bars("$agreeing", "title 'source''s accuracy'");
  if (!explained.empty()) bars("$explained", agreeing.empty() ? "title 'source''s accuracy'" : "notitle");
  for (const char* data : {"$agreeing", "$explained"}) {
    const bool first = data == std::string("$agreeing");
    if ((first ? agreeing : explained).empty()) continue;
    add(fmt::format("{} using 4:1 with points pointtype 8 pointsize 1 linewidth 1.5 linecolor '#00336F' {}", data,
                    first || agreeing.empty() ? "title 'rosin''s stated error'" : "notitle"));
  }
  if (!agreeing.empty())
    add("$agreeing using 2:1 with points pointtype 7 pointsize 0.7 linecolor 'black' title 'difference'");
  if (!explained.empty())
    add("$explained using 2:1 with points pointtype 5 pointsize 0.9 linecolor '#B0560F' title 'difference, as "
        "explained'");
  return sheet.with(script + plots + "\n");
}

std::string unit_of(const Answer& answer) {
  const auto& unit = answer.question->unit.name;
  return unit.empty() ? unit : " " + unit;
}

std::string number_cells(const Answer& answer) {
  auto wanted = wanted_text(answer);
  if (!answer.wanted().empty())
    wanted += fmt::format(" ± {:.2g}", answer.question->accuracy[answer.worst] / answer.question->unit.factor);
  return fmt::format("{} | {} | {} | {}", cell(wanted), cell(got_text(answer)),
                     answer.has_number() ? readable_ratio(answer.over_error()) : "–",
                     answer.has_number() ? readable_ratio(answer.over_accuracy()) : "–");
}

/// How many numbers came about how.
std::string origins(const std::vector<Answer>& answers) {
  std::map<Origin, int> counts;
  for (const auto& answer : answers) ++counts[answer.question->origin];
  const std::map<Origin, const char*> words = {
      {Origin::printed, "printed in a table, a figure or a text"},
      {Origin::stored, "stored with another program"},
      {Origin::closed_form, "in closed form from equations that a source prints"},
      {Origin::computed, "computed from such equations by an integrator or a root finder that is not rosin's"}};
  std::string text;
  for (const auto& [origin, count] : counts) text += fmt::format("- {} {}\n", count, words.at(origin));
  return text;
}

}  // namespace

std::string wanted_text(const Answer& answer) {
  const auto& question = *answer.question;
  if (const auto* text = std::get_if<std::string>(&question.wanted)) return *text;
  if (const auto* truth = std::get_if<bool>(&question.wanted)) return *truth ? "true" : "false";
  return fmt::format("{:.14g}", answer.wanted()[answer.worst] / question.unit.factor) + unit_of(answer);
}

std::string got_text(const Answer& answer) {
  const auto& question = *answer.question;
  if (!answer.has_number()) return answer.text.empty() ? "–" : answer.text;
  const double got = answer.got[answer.worst] / question.unit.factor;
  const double accuracy = question.accuracy[answer.worst] / question.unit.factor;
  if (got == 0) return "0" + unit_of(answer);
  const double digits = std::floor(std::log10(std::abs(got))) - std::floor(std::log10(accuracy)) + 2;
  return fmt::format("{:.{}g}", got, static_cast<int>(std::clamp(digits, 2.0, 16.0))) + unit_of(answer);
}

std::string readable_ratio(double ratio) {
  if (!std::isfinite(ratio)) return "–";
  return ratio == 0 ? "0" : ratio < 0.01 ? fmt::format("{:.0e}", ratio) : fmt::format("{:.2g}", ratio);
}

std::string counted(const std::vector<Answer>& answers) {
  std::map<Verdict, int> counts;
  for (const auto& answer : answers) ++counts[answer.verdict];
  std::string text;
  for (const auto& [verdict, count] : counts)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", name(verdict), count);
  return text;
}

std::vector<std::string> write_page(const fs::path& folder, const std::vector<Answer>& answers) {
  std::vector<std::string> groups, files;
  std::set<const Case*> cases;
  for (const auto& answer : answers) {
    if (groups.empty() || groups.back() != answer.of->group) groups.push_back(answer.of->group);
    cases.insert(answer.of);
  }
  std::string page = fmt::format(R"(# Numbers of others, asked of rosin again

This page is written by `rosin verify`. It asks rosin {} questions of {} cases; each case is one file that holds the scene,
the question, the number, its accuracy and its source. Of the numbers are

{}
Verdicts: {}.

A number *agrees* where the error that rosin states is no larger than the accuracy of the source, and the difference no
larger than both together; where rosin states no error (–), where the difference is within the source's accuracy. Where a
source is known to differ, the case says why and what rosin gives instead; where rosin cannot be asked, why. Of a list of
numbers the table shows the one that is furthest off. In the pictures a difference within the grey bar is within the
source's accuracy, a triangle is the error that rosin states, and differences below 10⁻¹⁶ stand at the left edge.

)",
                                 answers.size(), cases.size(), origins(answers), counted(answers));
  std::vector<fs::path> old;  // pictures of another time
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename().string().starts_with("verify-")) old.push_back(entry.path());
  for (const auto& path : old) fs::remove(path);
  for (const auto& group : groups) {
    page += fmt::format("## {}\n\n", heading(group));
    std::vector<const Answer*> here, drawn;
    for (const auto& answer : answers)
      if (answer.of->group == group) here.push_back(&answer);
    std::ranges::copy_if(here, std::back_inserter(drawn), &Answer::has_number);
    if (!drawn.empty()) {
      files.push_back(picture_name(group) + ".gp");
      write_whole(folder / files.back(), picture(group, drawn));
      page += fmt::format(
          "![Differences from the numbers wanted, beside the accuracy of their sources and the errors that "
          "rosin states]({}.svg)\n\n",
          picture_name(group));
    }
    page +=
        "| case | number | wanted | got | difference over stated error | over source's accuracy | verdict |\n"
        "|---|---|---|---|---|---|---|\n";
    for (const auto* answer : here) {
      const auto size = answer->wanted().size();
      page +=
          fmt::format("| {} | {}{} | {} | {} |\n", answer->name, cell(answer->question->what),
                      answer->question->list ? fmt::format(" ({} numbers, here the {}.)", size, answer->worst + 1) : "",
                      number_cells(*answer), name(answer->verdict));
    }
    page += '\n';
    const Case* told = nullptr;
    for (const auto* answer : here) {
      if (const auto& one = *answer->of; &one != told) {
        std::error_code problem;
        const auto link = fs::relative(one.path, folder, problem).generic_string();
        page += fmt::format("- **[{}]({})**: {} *{}:* {}{}\n", one.name, link, sentence(one.title), name(one.origin),
                            sentence(one.source), one.note.empty() ? "" : " " + sentence(one.note));
        told = &one;
        if (!answer->command.empty()) page += fmt::format("  `{}`\n", answer->command);
      }
      if (!answer->reason.empty())
        page += fmt::format("  {} {}: {}\n", answer->name, name(answer->verdict), sentence(answer->reason));
    }
    page += '\n';
  }
  write_whole(folder / "verify.md", page);
  files.emplace_back("verify.md");
  return files;
}

}  // namespace rosin::app::verify
