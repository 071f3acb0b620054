/// Texts for gnuplot, and pictures that are whole or not there.
#include "app/output/gnuplot.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>

#include "app/output/scene_figure.hpp"
#include "app/output/sheet.hpp"
#include "core/files.hpp"
#include "core/process.hpp"
#include "tests/app/folder.hpp"
#include "tests/printable_texts.hpp"

using namespace rosin::app;
using Catch::Matchers::Contains;
using rosin::tests::Folder;

namespace fs = std::filesystem;

namespace {

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// The texts of an SVG, without markup; spaces at their ends and in rows are not kept there.
std::vector<std::string> texts_of(const std::string& svg) {
  std::vector<std::string> texts;
  for (std::size_t at = 0; (at = svg.find("<text", at)) != std::string::npos;) {
    const auto end = svg.find("</text>", at);
    std::string text;
    bool tag = false;
    for (; at < end; ++at) {
      tag |= svg[at] == '<';
      if (!tag) text += svg[at];
      tag &= svg[at] != '>';
    }
    for (const auto& [from, to] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}})
      text = replaced(text, from, to);
    texts.push_back(std::move(text));
  }
  return texts;
}

std::string without_spaces(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
  return text;
}

}  // namespace

TEST_CASE("any text is drawn as it is: as label, tic, title of a plot, and title of a sheet", "[gnuplot]") {
  const Folder folder;
  const auto texts = rosin::tests::printable_texts();
  std::string script =
      "set terminal svg size 4000,40000\nset encoding utf8\nset output 'x.svg'\nset key on maxrows 2000\n";
  std::string tics, plots;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    script += "set label " + std::to_string(i + 1) + " " + output::single_quoted(texts[i]) + " at graph 0.5,0.5\n";
    const auto separator = i == 0 ? "" : ", ";
    tics += separator + output::single_quoted(replaced(texts[i], "%", "%%")) + " " + std::to_string(i);
    plots += separator + std::to_string(i) + " title " + output::single_quoted(texts[i]);
  }
  std::ofstream(folder.path / "x.gp") << script << "set ytics (" << tics << ")\nplot " << plots << "\n";
  const auto gnuplot = rosin::find_program("gnuplot");
  REQUIRE(gnuplot);
  const auto ran = rosin::run_program({*gnuplot, {"x.gp"}, folder.path});
  REQUIRE(ran);
  CHECK(ran->status == 0);
  CHECK(ran->messages.empty());
  std::map<std::string, int> drawn;
  for (const auto& text : texts_of(rosin::tests::content(folder.path / "x.svg"))) ++drawn[without_spaces(text)];
  for (const auto& text : texts) {
    const auto wanted = without_spaces(replaced(text, "]]>", "]]\u2060>"));
    CAPTURE(text, wanted);
    if (!wanted.empty()) CHECK(drawn[wanted] >= 3);
  }

  const output::Sheet sheet{"run", "A line", {.width = 900, .panel = 200}, "Friction f''(x) of 't Hooft", "''"};
  std::ofstream(folder.path / "run.gp") << sheet.with("plot x title " + output::single_quoted("f''") + "\n");
  CHECK(output::draw(folder.path, {"run.gp"}, {}).problems.empty());
  CHECK_THAT(rosin::tests::content(folder.path / "run.svg"), Contains("Friction f''(x) of 't Hooft"));
}

TEST_CASE("names on axes come with the symbols of their quantities", "[gnuplot]") {
  CHECK(output::readable("slip_rate_max") == "largest slip rate v");
  CHECK(output::readable("normal_load") == "normal load N");
  CHECK(output::readable("slip_rate_2") == "slip rate v₂");
  CHECK(output::readable("stick_time") == "stick time");
  CHECK(output::readable("slip_rate") == "slip rate v");
  CHECK(output::readable("theta") == "θ");
  CHECK(output::readable("mu_s") == "μ_s");
}

TEST_CASE("numbers of a scene are named on axes by what they mean, their symbol and their unit", "[gnuplot]") {
  const auto named = [](const char* path, const char* meaning) {
    const auto axis = output::axis_of(path, rosin::Quantity{.name = path, .unit = "N", .meaning = meaning});
    return std::array{axis.name, axis.symbol, axis.detail};
  };
  using Parts = std::array<std::string, 3>;
  CHECK(named("drive.speed", "speed of the driving surface") == Parts{"speed of the driving surface", "V", ""});
  CHECK(named("drive.force.harmonics.1.amplitude", "force on the slider, along its displacement") ==
        Parts{"force on the slider", "f", "amplitude of harmonic 1"});
  CHECK(named("law.mu_d", "dynamic coefficient, in motion") == Parts{"dynamic coefficient", "μ_d", ""});
  CHECK(named("oscillator.contacts.2.normal_load", "normal load") == Parts{"normal load", "N", "contact 2"});
  CHECK(named("oscillator.bow_position", "distance of the bow") == Parts{"distance of the bow", "", ""});
}

TEST_CASE("a picture that gnuplot left cut short does not get its name", "[gnuplot]") {
  const Folder folder;
  const auto bin = folder.path / "bin";
  fs::create_directories(bin);
  const auto gnuplot = bin / "gnuplot";  // draws half a picture, and says that all is well
  std::ofstream(gnuplot) << "#!/bin/sh\noutput=$(echo \"$2\" | sed \"s/.*output='//; s/'.*//\")\n"
                            "case $output in *.svg) printf '<svg><g>' ;; *) printf 'PNG IEND' ;; esac > \"$output\"\n";
  fs::permissions(gnuplot, fs::perms::owner_all);
  std::ofstream(folder.path / "run.gp") << "plot x\n";
  const std::string before = std::getenv("PATH");
  setenv("PATH", (bin.string() + ":" + before).c_str(), 1);
  const auto drawn = output::draw(folder.path, {"run.gp"}, {.pdf = true});
  setenv("PATH", before.c_str(), 1);
  CHECK(drawn.files.empty());
  REQUIRE(drawn.problems.size() == 3);
  CHECK_THAT(drawn.problems[0], Contains("cut short"));
  CHECK_FALSE(fs::exists(folder.path / "run.svg"));
  CHECK_FALSE(fs::exists(folder.path / "run.png"));
  CHECK_FALSE(fs::exists(folder.path / "run.pdf"));
}

TEST_CASE("pictures are drawn as PDF where that is asked for", "[gnuplot]") {
  const Folder folder;
  const output::Sheet sheet{"run", "A line", {.width = 400, .panel = 200}, "A line"};
  std::ofstream(folder.path / "run.gp") << sheet.with("plot x\n");
  CHECK(output::draw(folder.path, {"run.gp"}, {.pdf = true}).files ==
        std::vector<std::string>{"run.svg", "run.png", "run.pdf"});
  CHECK(rosin::read_whole(folder.path / "run.pdf", 10'000'000).starts_with("%PDF"));
  CHECK(output::draw(folder.path, {"run.gp"}, {}).files.size() == 2);
}

namespace {

/// Width and height of a PNG, in pixels.
std::pair<unsigned, unsigned> size_of_png(const fs::path& path) {
  const auto bytes = rosin::read_whole(path, 10'000'000);
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes.at(at + i));
    return value;
  };
  return {number(16), number(20)};
}

}  // namespace

TEST_CASE("pictures for print are as wide as was asked, with panels and titles in as many rows as they need",
          "[gnuplot]") {
  const Folder folder;
  const output::Sheet sheet{"run",
                            "Two panels",
                            {.width = 900, .panels = 2, .columns = 2, .panel = 200},
                            "A title of many words that no column of a journal has room for in one row of text",
                            "law: none; drive: none"};
  std::ofstream(folder.path / "run.gp") << sheet.with("plot x title 'straight'\nplot x**2 title 'curved'\n");
  const auto drawn = [&](double width) {
    REQUIRE(output::draw(folder.path, {"run.gp"}, {.width = width}).problems.empty());
    return rosin::read_whole(folder.path / "run.svg", 10'000'000);
  };
  const auto title_is_whole = [](const std::string& svg) {
    return svg.find("A title of many words that no column of a journal has room for in one row of text") !=
           std::string::npos;
  };
  CHECK(title_is_whole(drawn(0)));
  CHECK(size_of_png(folder.path / "run.png").first == 900);
  const auto wide = drawn(175);
  CHECK(title_is_whole(wide));
  CHECK_THAT(wide, Contains("width=\"661\""));  // 175 mm at 96 pixels an inch
  const auto [pixels, height] = size_of_png(folder.path / "run.png");
  CHECK(pixels == 2066);  // at 300 pixels an inch
  const auto narrow = drawn(85);
  CHECK_FALSE(title_is_whole(narrow));  // broken at a space: all its words are there
  for (const char* word : {"A title", "journal", "row of text", "straight", "curved"})
    CHECK_THAT(narrow, Contains(word));
  CHECK_THAT(narrow, Contains("width=\"321\""));
  const auto [few, tall] = size_of_png(folder.path / "run.png");
  CHECK(few == 1003);
  // Two panels below each other, each of three quarters of the height at 300 pixels an inch.
  const double frame = 7 / 13. * 300 / 72;  // pixels of the file to one of the layout
  CHECK(tall > frame * 2 * 0.75 * 200);
  CHECK(double(tall) / few > 1.4 * height / pixels);

  std::ofstream(folder.path / "old.gp") << "set terminal svg\nset output output\nplot x\n";
  const auto old = output::draw(folder.path, {"old.gp"}, {.width = 85});
  CHECK(old.files.empty());
  REQUIRE(old.problems.size() == 1);
  CHECK_THAT(old.problems[0], Contains("old.gp knows no width"));
}

TEST_CASE("values that hardly change are drawn less what they have in common", "[gnuplot]") {
  const auto drawn = output::drawn_range("m", 5.00000012, 5.00004);
  CHECK(drawn.common == " − 5 m");
  CHECK(drawn.unit == "µm");
  CHECK(drawn.off == 5);
  CHECK(drawn.high == Approx(40));
  const auto plain = output::drawn_range("m/s", 0, 2e-3);
  CHECK(plain.common.empty());
  CHECK(plain.unit == "mm/s");
  CHECK(plain.factor == 1000);
}

TEST_CASE("units have the prefix of their largest value", "[gnuplot]") {
  CHECK(output::scaled("m/s", 4e-5).unit == "µm/s");
  CHECK(output::scaled("m/s", 4e-5).factor == Approx(1e6));
  CHECK(output::scaled("m", 3e-11).unit == "pm");  // the way of a contact that hardly gives
  CHECK(output::scaled("1", 3e-5).unit == "1");
}
