/// Figures as scripts and as JSON.
#include "app/output/figure.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "app/output/gnuplot.hpp"
#include "tests/app/folder.hpp"

using namespace rosin::app;
using namespace rosin::app::results;
using Catch::Matchers::Contains;
using rosin::tests::content;
using rosin::tests::Folder;

namespace {

/// Two panels over one time, of a table with a gap.
Figure two_panels() {
  const Axis time{.name = "time", .unit = "s", .shown = {0, 2e-3}, .from = 0, .to = 2e-3};
  const Axis place{.name = "displacement x", .unit = "m", .shown = {0, 4e-6}};
  return {.name = "run",
          .what = "A place over time",
          .title = "Two panels",
          .panels = {{.x = time, .y = place, .lines = {{.table = "places.csv", .title = "place"}}},
                     {.x = time,
                      .y = place,
                      .lines = {{.table = "places.csv",
                                 .y = {.column = 2, .absolute = true},
                                 .how = How::points,
                                 .look = {.style = 1, .halo = true},
                                 .title = "size",
                                 .where = {{2, '>', 1e-6}}}},
                      .rules = {{'x', 1e-3, {}, "middle"}},
                      .marks = {{1e-3, 2e-6, "here", Side::above, {}, true, ""}}}},
          .tables = {{"places.csv", {{"time (s)", {0, 1e-3, NAN, 2e-3}}, {"displacement (m)", {0, 2e-6, NAN, 4e-6}}}}}};
}

}  // namespace

TEST_CASE("a declared figure is drawn in units with prefixes, its common axis named once", "[figure]") {
  const Folder folder;
  CHECK(output::write(folder.path, two_panels()) ==
        std::vector<std::string>{"places.csv", "run.gp", "run.figure.json"});
  CHECK(content(folder.path / "places.csv") == "time (s),displacement (m)\n0,0\n0.001,2e-06\n\n0.002,4e-06\n");
  const auto script = content(folder.path / "run.gp");
  CHECK_THAT(script, Contains("'displacement x (µm)'") && Contains("($1*1000):($2*1000000)"));
  CHECK(script.find("'time (ms)'") == script.rfind("'time (ms)'"));
  const auto drawn = output::draw(folder.path, {"run.gp"}, {});
  CHECK(drawn.problems.empty());
  const auto svg = content(folder.path / "run.svg");
  for (const char* text : {"place", "size", "middle", "here", "Two panels"}) CHECK_THAT(svg, Contains(text));
}

TEST_CASE("the declaration of a figure beside its script says what it draws in SI units", "[figure]") {
  const auto figure = nlohmann::json::parse(output::to_json(two_panels()));
  const auto& line = figure["panels"][1]["lines"][0];
  CHECK(line["how"] == "points");
  CHECK(line["table"] == "places.csv");
  CHECK(line["y"] == nlohmann::json{{"column", 2}, {"absolute", true}});
  CHECK(line["where"][0]["value"] == 1e-6);
  CHECK(line["look"]["colour"] == line_styles[1].colour);
  CHECK(figure["panels"][0]["x"]["to"] == 2e-3);
  CHECK_FALSE(figure["panels"][0].contains("rules"));
}
