/// Pages of reports.
#include "app/report/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "app/output/markup.hpp"
#include "app/report/assets.hpp"
#include "app/report/figures.hpp"
#include "app/report/quantities.hpp"
#include "app/report/tables.hpp"
#include "app/report/verdicts.hpp"
#include "core/error.hpp"
#include "core/results_folder.hpp"
#include "laws/catalogue.hpp"

namespace rosin::app::report {

using output::escaped;

namespace fs = std::filesystem;

namespace {

constexpr std::string_view mark = "<meta name=\"generator\" content=\"rosin report";
constexpr std::uintmax_t largest_pictures = 300'000, largest_sound = 600'000;  // bytes of one section's

std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned block = 0;
    for (std::size_t k = 0; k < 3; ++k)
      block = block << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= bytes.size() - i ? letters[block >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// A checksum as a security policy takes it.
std::string source_of(const Asset& asset) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < asset.sha256.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(asset.sha256.substr(i, 2)), nullptr, 16));
  return fmt::format("'sha256-{}'", base64(bytes));
}

/// JSON within an element script: no end of that element, no comment, whatever texts it holds.
std::string embedded(const ordered_json& data) {
  std::string safe;
  for (const char c : data.dump(-1, ' ', false, ordered_json::error_handler_t::replace)) {
    if (c == '<' || c == '>' || c == '&')
      safe += fmt::format("\\u{:04x}", unsigned(c));
    else
      safe += c;
  }
  return safe;
}

const std::map<std::string, std::string>& headings() {
  static const std::map<std::string, std::string> list = {
      {"curve", "Steady friction curve"},
      {"stability", "Stability of steady sliding"},
      {"run", "Motion from a start"},
      {"cycle", "Periodic motion"},
      {"map", "Parameter plane"},
      {"branch", "Branches along a parameter"},
      {"sweep", "Sweep along a parameter"},
      {"basin", "Basins of attraction"},
      {"lyapunov", "Lyapunov exponents"},
      {"compare", "Laws compared"},
      {"design", "The measurement that decides"},
      {"frf", "Friction frequency response"},
      {"fit", "Parameters from measurements"},
      {"lab", "Laboratory experiment"},
      {"study", "Study of force algorithms"},
      {"verify", "Numbers of others"},
  };
  return list;
}

std::string heading_of(const std::string& label) {
  const auto found = headings().find(label);
  return found == headings().end() ? label : found->second;
}

/// A label as an id: letters, digits and hyphens.
std::string id_of(const std::string& label) {
  std::string id;
  for (const char c : label) id += std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  return id;
}

std::string list_of(const std::vector<std::string>& texts) {
  std::string html = "<ul>\n";
  for (const auto& text : texts) html += fmt::format("<li>{}</li>\n", escaped(text));
  return html + "</ul>\n";
}

/// A picture as gnuplot drew it; empty where there is none, or `room` for it.
std::string picture_html(const Folder& folder, const std::string& file, const std::string& caption,
                         std::uintmax_t& room) {
  std::error_code problem;
  if (folder.left_out.contains(file) || !fs::is_regular_file(folder.path / file, problem)) return {};
  const auto size = fs::file_size(folder.path / file, problem);
  if (problem || size > room) return {};
  room -= size;
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
      escaped(caption + " As drawn by gnuplot."), base64(read_found(folder.path / file, largest_pictures)));
}

/// Sounds of a result, to be heard on the page.
std::string sounds_html(const Folder& folder, const Result& result) {
  std::string html;
  for (const auto& file : at(result.manifest, "files")) {
    const fs::path name = file.is_string() ? file.get<std::string>() : "";
    std::error_code problem;
    if (name.extension() != ".wav" || name.has_parent_path() || folder.left_out.contains(name.string()) ||
        !fs::is_regular_file(folder.path / name, problem) || fs::file_size(folder.path / name, problem) > largest_sound)
      continue;
    html += fmt::format(
        "<figure><audio controls preload=\"metadata\" aria-label=\"{0}\" src=\"data:audio/wav;base64,{1}\"></audio>"
        "<figcaption>{0}: as loud as a file can hold.</figcaption></figure>\n",
        escaped(name.stem().string() == "bridge" ? "The force on the bridge, heard" : name.stem().string()),
        base64(read_found(folder.path / name, largest_sound)));
  }
  return html;
}

std::string figures_html(const Folder& folder, const Result& result) {
  std::string html;
  int number = 0;
  auto room = largest_pictures;
  for (const auto& [caption, data, picture] : figures_of(folder, result)) {
    if (!picture.empty()) {
      html += picture_html(folder, picture, caption, room);
      continue;
    }
    const auto id = fmt::format("{}-{}", id_of(result.label), ++number);
    html += fmt::format(
        "<script type=\"application/json\" id=\"{0}\">{1}</script>\n"
        "<figure data-figure=\"{0}\"><figcaption>{2}</figcaption>"
        "<noscript><p>This figure needs JavaScript; its numbers stand in the results folder.</p></noscript></figure>\n",
        id, embedded(data), escaped(caption));
  }
  return html;
}

std::string problems_html(const Result& result) {
  std::vector<std::string> texts;
  const auto outcome = word(result.document, "outcome"), detail = word(result.document, "outcome_detail");
  if (!outcome.empty() && outcome != "reached the end" && outcome != "event")
    texts.push_back(fmt::format("The work ended short: {}{}.", outcome, detail.empty() ? "" : ", " + detail));
  if (const auto& warnings = at(result.document, "warnings"); warnings.is_array())
    for (const auto& warning : warnings)
      if (warning.is_string()) texts.push_back(warning.get<std::string>());
  if (const auto& failures = at(result.document, "failures"); failures.is_array()) {
    std::map<std::string, int> reasons;  // hundreds of points fail for few reasons
    for (const auto& failure : failures) ++reasons[word(failure, "why")];
    for (const auto& [why, n] : reasons)
      texts.push_back(fmt::format("{} failed: {}", n == 1 ? "1 point" : fmt::format("{} points", n), why));
  }
  if (yes(result.document, "ill_conditioned_stick"))
    texts.emplace_back("The lowest slip rate touches the threshold of stick: the stick fraction jumps nearby.");
  if (texts.empty()) return {};
  return fmt::format("<div class=\"warnings\" role=\"note\"><h3>Warnings and failures</h3>\n{}</div>\n",
                     list_of(texts));
}

/// What stands on the page already, and the label of the section in which it does.
using Shown = std::map<std::string, std::string>;

/// Empty for what is shown for the first time, else where it stands.
std::string reference(Shown& shown, const std::string& content, const std::string& label) {
  const auto [there, first] = shown.try_emplace(content, label);
  if (first) return {};
  return fmt::format("<a href=\"#{}\">{}</a>", id_of(there->second), escaped(heading_of(there->second)));
}

std::string law_html(const Result& result, Shown& shown) {
  const auto name = word(result.document, "law");
  if (name.empty()) return {};
  if (const auto there = reference(shown, "law " + name, result.label); !there.empty())
    return fmt::format("<p>Law <code>{}</code>: see {}.</p>\n", escaped(name), there);
  std::shared_ptr<const FrictionLaw> law;
  for (const auto& known_law : laws::catalogue())
    if (known_law->card().name == name) law = known_law;
  if (!law) return fmt::format("<p>Law: <code>{}</code>, as the scene writes it.</p>\n", escaped(name));
  const auto& card = law->card();
  return fmt::format("<p>Law <code>{}</code>: {}. Source: {}</p>\n<pre>{}</pre>\n<p>Valid: {}</p>\n", escaped(name),
                     escaped(card.title), escaped(card.source), escaped(card.formula), escaped(card.limits));
}

std::string parameters_html(const Result& result, Shown& shown) {
  const auto& parameters = at(result.manifest, "parameters");
  if (!parameters.is_object() || parameters.empty()) return {};
  if (const auto there = reference(shown, parameters.dump(), result.label); !there.empty())
    return fmt::format("<p>Parameters: those of {}.</p>\n", there);
  std::string rows;
  for (const auto& [path, parameter] : parameters.items()) {
    const auto of_path = known(path);
    rows += fmt::format("<tr><th scope=\"row\"><code>{}</code></th><td>{}</td><td>{}</td></tr>\n", escaped(path),
                        escaped(amount(number(parameter, "value"), word(parameter, "unit"), 0, 10)),
                        escaped(of_path.meaning));
  }
  return fmt::format(
      "<details><summary>Parameters of the model</summary>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"Parameters\"><table>\n"
      "<thead><tr><th scope=\"col\">parameter</th><th scope=\"col\">value</th><th "
      "scope=\"col\">meaning</th></tr></thead>\n"
      "<tbody>{}</tbody></table></div></details>\n",
      rows);
}

std::string reproduction_html(const Result& result, Shown& shown) {
  const auto& manifest = result.manifest;
  auto html = fmt::format("<h3>How to reproduce</h3>\n<p>rosin {}, {}</p>\n<pre data-copy>{}</pre>\n",
                          escaped(word(manifest, "version")), escaped(word(manifest, "date")),
                          escaped(command_of(result, word(manifest, "verb"))));
  std::string sums = fmt::format("{}.json {}\n", result.label, result.checksum);
  if (const auto& scripts = at(manifest, "scripts"); scripts.is_object())
    for (const auto& [file, sum] : scripts.items())
      if (sum.is_string()) sums += fmt::format("{} {}\n", file, sum.get<std::string>());
  html += fmt::format(
      "<details><summary>Checksums</summary><p>FNV-1a, 64 bits; of the document as it was read, of scripts from the "
      "manifest.</p>"
      "<pre>{}</pre></details>\n",
      escaped(sums));
  const auto scene = word(manifest, "scene_resolved");
  if (scene.empty()) return html;
  if (const auto there = reference(shown, "scene " + scene, result.label); !there.empty())
    return html + fmt::format("<p>The scene is that of {}.</p>\n", there);
  return html +
         fmt::format(
             "<details><summary>The scene, as resolved with all --set</summary>\n<pre data-copy>{}</pre></details>\n",
             escaped(scene));
}

/// The result's own sentence, and what others of the folder add to it.
std::string verdict_html(const Folder& folder, const Result& result) {
  auto text = word(result.document, "verdict");
  if (result.label == "stability" && !yes(result.document, "stable"))
    for (const auto& other : folder.results)
      if (const double period = number(other.document, "period");
          other.label == "cycle" && period > 0 && at(other.manifest, "parameters") == at(result.manifest, "parameters"))
        text += fmt::format(" A periodic motion of period {} exists.",
                            amount(period, "s", number(at(other.document, "error"), "period")));
  return escaped(text);
}

std::string section_of(const Folder& folder, const Result& result, Shown& shown) {
  const auto id = id_of(result.label);
  const auto figures = figures_html(folder, result) + sounds_html(folder, result);
  auto html = fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-heading\">\n<h2 id=\"{0}-heading\">{1}</h2>\n<p "
      "class=\"verdict\">{2}</p>\n{3}{4}{5}",
      id, escaped(heading_of(result.label)), verdict_html(folder, result), problems_html(result), figures,
      tables_of(result));
  html += "<h3>Assumptions</h3>\n";
  if (const auto assumptions = assumptions_of(result); !assumptions.empty()) html += list_of(assumptions);
  return html + law_html(result, shown) + parameters_html(result, shown) + reproduction_html(result, shown) +
         "</section>\n";
}

std::string title_of(const Folder& folder) {
  for (const auto& result : folder.results)
    if (const auto title = word(result.document, "title"); !title.empty()) return title;
  const auto name = fs::absolute(folder.path).lexically_normal();
  return (name.has_filename() ? name : name.parent_path()).filename().string();
}

}  // namespace

std::string page_of(const Folder& folder) {
  Shown shown;
  std::string sections, links;
  for (const auto& result : folder.results) {
    sections += section_of(folder, result, shown);
    links += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", id_of(result.label), escaped(heading_of(result.label)));
  }
  const auto title = escaped(title_of(folder));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{} {}\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src {} {}; style-src {}; "
      "img-src data:; media-src data:; "
      "base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n"
      "<a class=\"skip\" href=\"#results\">To the results</a>\n<header>\n<h1>{}</h1>\n<p class=\"under\">Results of "
      "rosin {}</p>\n"
      "<nav aria-label=\"Sections\"><ul>\n{}</ul></nav>\n</header>\n<main id=\"results\">\n{}</main>\n"
      "<footer><p>Made by <code>rosin report</code>; this page needs no network and sends nothing. Axes and scales are "
      "drawn by "
      "d3 (d3js.org, copyright 2010–2022 Mike Bostock, ISC and BSD 3-clause licences: use and copies are allowed with "
      "this "
      "notice, without any warranty).</p></footer>\n<script>{}</script>\n<script>{}</script>\n</body>\n</html>\n",
      mark, ROSIN_VERSION, source_of(library), source_of(script), source_of(style), title, style.text, title,
      ROSIN_VERSION, links, sections, library.text, script.text);
}

bool is_report(std::string_view text) { return text.substr(0, 300).find(mark) != text.npos; }

}  // namespace rosin::app::report
