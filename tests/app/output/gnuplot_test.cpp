/// Texts for gnuplot, and pictures that are whole or not there.
#include "app/output/gnuplot.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "app/output/sheet.hpp"
#include "core/files.hpp"
#include "tests/app/folder.hpp"

using namespace rosin::app;
using Catch::Matchers::Contains;
using rosin::tests::Folder;

namespace fs = std::filesystem;

TEST_CASE("texts with apostrophes and the end of an SVG's text stay texts", "[gnuplot]") {
  CHECK(output::single_quoted("a 'b'") == "'a ''b'''");
  CHECK(output::single_quoted("'t Hooft's slider") == "\"'\".'t Hooft''s slider'");
  CHECK(output::single_quoted("a]]>b") == "'a]]\u2060>b'");
  CHECK(output::single_quoted("a > b") == "'a > b'");
}

TEST_CASE("names on axes come with the symbols of their quantities", "[gnuplot]") {
  CHECK(output::readable("slip_rate_max") == "largest slip rate v");
  CHECK(output::readable("normal_load") == "normal load N");
  CHECK(output::readable("slip_rate_2") == "slip rate v₂");
  CHECK(output::readable("stick_time") == "stick time");
  CHECK(output::readable("slip_rate") == "slip rate v");
  CHECK(output::readable("theta") == "θ");
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

TEST_CASE("units have the prefix of their largest value", "[gnuplot]") {
  CHECK(output::scaled("m/s", 4e-5).unit == "µm/s");
  CHECK(output::scaled("m/s", 4e-5).factor == Approx(1e6));
  CHECK(output::scaled("m", 3e-11).unit == "pm");  // the way of a contact that hardly gives
  CHECK(output::scaled("1", 3e-5).unit == "1");
}
