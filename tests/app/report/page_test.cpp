/// Pages of reports: sections with the numbers of the documents, texts that stay texts, size, and what is refused.
#include "app/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/report/figures.hpp"
#include "app/report/quantities.hpp"
#include "app/report/tables.hpp"
#include "app/report/verdicts.hpp"
#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;
using rosin::app::report::amount;
using rosin::app::report::known;
using rosin::app::report::number_text;
using rosin::app::report::numbers;
using rosin::app::report::ordered_json;
using rosin::app::report::page_of;
using rosin::app::report::Result;
using rosin::app::report::unit_of;
using rosin::app::report::unit_of_parameter;
namespace fs = std::filesystem;

namespace {

const std::string examples = ROSIN_SOURCE_DIR "/examples/";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// What stands between two marks, the first of its kind.
std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const auto begin = text.find(from);
  if (begin == text.npos) return {};
  return text.substr(begin + from.size(), text.find(to, begin + from.size()) - begin - from.size());
}

std::string section(const std::string& page, const std::string& id) {
  return between(page, "<section id=\"" + id + "\"", "</section>");
}

ordered_json figure(const std::string& page, const std::string& id) {
  return ordered_json::parse(between(page, "<script type=\"application/json\" id=\"" + id + "\">", "</script>"));
}

/// The page without its scripts and style.
std::string markup(std::string page) {
  for (const std::string name : {"script", "style"})
    for (auto from = page.find("<" + name); from != page.npos; from = page.find("<" + name, from)) {
      const std::string end = "</" + name + ">";
      page.erase(from, page.find(end, from) + end.size() - from);
    }
  return page;
}

ordered_json json_of(const fs::path& path) { return ordered_json::parse(content(path)); }

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// Results of a map of that many values a side with five metrics.
Result plane_of(int size) {
  ordered_json x{
      {"parameter", "drive.normal_load"}, {"unit", "N"}, {"scale", "log"}, {"values", ordered_json::array()}};
  auto y = x;
  y["parameter"] = "drive.speed", y["unit"] = "m/s";
  for (int i = 0; i < size; ++i)
    x["values"].push_back(std::pow(10, i / 50.0)), y["values"].push_back(std::pow(10, i / 60.0));
  ordered_json document{{"title", "Large"}, {"verb", "map"}, {"outcome", "reached the end"}, {"x", x}, {"y", y}};
  for (const auto* metric : {"period", "slip_rate_max", "friction_max", "stick_fraction", "loop_area"}) {
    auto rows = ordered_json::array(), errors = rows;
    for (int iy = 0; iy < size; ++iy) {
      rows.push_back(ordered_json::array()), errors.push_back(ordered_json::array());
      for (int ix = 0; ix < size; ++ix)
        rows.back().push_back(std::sin(1.0 + ix + 0.37 * iy)),
            errors.back().push_back(1e-9 * (1.5 + std::cos(ix * iy)));
    }
    document["metrics"][metric] = rows, document["error"][metric] = errors;
  }
  return {"map", document, {{"verb", "map"}, {"version", "0"}, {"scene", "large.toml"}}, "0"};
}

}  // namespace

TEST_CASE("numbers of reports have the digits of their errors, and units with prefixes", "[app][report]") {
  CHECK(number_text(8.4507e-5) == "8.4507·10⁻⁵");
  CHECK(number_text(-1e-12) == "−10⁻¹²");
  CHECK(number_text(NAN) == "none");
  CHECK(number_text(0.4, 3e-5) == "0.40000 ± 3·10⁻⁵");
  CHECK(number_text(2e-6, 3e-5) == "0 ± 3·10⁻⁵");
  CHECK(amount(22.587055801, "s", 3e-8) == "22.58705580 ± 3·10⁻⁸ s");
  CHECK(amount(9.81e-4, "N") == "981 µN");
  CHECK(amount(0.02, "m/s", 2e-5) == "(20.00 ± 0.02) mm/s");
  CHECK(known("slip_rate_2_max").unit == "m/s");
  CHECK(known("drive.normal_load").symbol == "N");
}

TEST_CASE("the unit that a document states goes before the usual one", "[app][report]") {
  const ordered_json units = {{"tilt", "rad"}, {"period", "1"}};  // of a string, over that of the open one
  CHECK(unit_of("tilt_amplitude", units) == "rad");
  CHECK(unit_of("period", units) == "1");
  CHECK(unit_of("period", ordered_json()) == "s");
  CHECK(unit_of("slip_rate_mean", units) == "m/s");
  CHECK(unit_of("impact_work", units) == "J");
  CHECK(unit_of("nothing", units).empty());
  CHECK(unit_of_parameter(ordered_json{{"parameter", "law.period"}, {"unit", "1"}}) == "1");

  const Folder folder;
  REQUIRE(run_rosin(folder, "run " + examples + "bowed-string.toml --out out --no-pictures").status == 0);
  REQUIRE(run_rosin(folder, "report out").status == 0);
  const auto rows = section(content(folder.path / "out/report.html"), "run");
  CHECK(count(rows, "<audio controls") == 1);
  const auto row = rows.substr(rows.find("<tr><th scope=\"row\">period"), 120);
  CHECK_THAT(row, Contains("</td><td>period at the end over that of the open string") && !Contains(" s</td>"));
}

TEST_CASE("a report has a section for each verb, with the numbers of its document", "[app][report]") {
  const Folder folder;
  for (const auto* verb : {"stability", "cycle", "curve"})
    REQUIRE(run_rosin(folder, std::string(verb) + " " + examples + "bristol-board-cycle.toml --out out --no-pictures")
                .status == 0);
  const auto printed = run_rosin(folder, "report out");
  CHECK(printed.status == 0);
  CHECK_THAT(printed.out, Contains("Report: out/report.html, "));
  const auto page = content(folder.path / "out/report.html");

  const auto cycle = json_of(folder.path / "out/cycle.json");
  const auto digits = fmt::format("{:.9f}", cycle["period"].get<double>()).substr(0, 9);  // all but those of its error
  CHECK_THAT(section(page, "cycle"), Contains("has the period " + digits));
  CHECK_THAT(section(page, "cycle"),
             Contains(fmt::format("sticking for {:.3g} %", 100 * cycle["stick_fraction"].get<double>())));
  CHECK_THAT(section(page, "cycle"),
             Contains("Putelat, Dawes &amp; Willis (2011)") || Contains("see <a href=\"#curve\">"));
  // The law's card and the scene stand on the page once, and the other sections point there.
  CHECK(count(page, "Putelat, Dawes &amp; Willis (2011)") == 1);
  CHECK(count(page, "The scene, as resolved") == 1);
  CHECK_THAT(page, Contains("[oscillator]"));

  const auto stability = json_of(folder.path / "out/stability.json");
  CHECK_THAT(section(page, "stability"), Contains("is unstable: small motions grow at " +
                                                  number_text(stability["eigenvalues"][0][0].get<double>(), 4)));
  CHECK_THAT(section(page, "stability"), Contains("A periodic motion of period " + digits));
  CHECK_THAT(section(page, "stability"), Contains("supercritical"));
  CHECK_THAT(
      section(page, "curve"),
      Contains(
          "a minimum of " +
          number_text(json_of(folder.path / "out/curve.json")["extrema"][1]["friction_coefficient"].get<double>(), 5)));

  // The figures hold the solver's own steps: their fastest slip is that of the document, to the curvature between
  // steps.
  const auto panels = json_of(folder.path / "out/cycle.figure.json")["panels"];
  const auto over_time = figure(page, "cycle-1"), loop = figure(page, "cycle-2");
  CHECK(over_time["x"]["name"] == "time");
  CHECK(over_time["y"]["name"] == panels[0]["y"]["name"]);
  const auto rates = numbers(over_time["series"][0]["y"]);
  CHECK(*std::max_element(rates.begin(), rates.end()) == Approx(cycle["slip_rate_max"].get<double>()).epsilon(1e-2));
  CHECK(loop["y"]["symbol"] == "μ");
  CHECK(loop["series"][1]["name"] == "steady sliding");
}

TEST_CASE("only the loop of a structure has the point that it must not go round", "[app][report]") {
  const Folder folder;
  for (const auto& [scene, marked] : {std::pair{"frf-load-family", false}, {"frf-squeal", true}}) {
    INFO(scene);
    REQUIRE(run_rosin(folder, "frf " + examples + scene + ".toml --no-pictures --out " + scene).status == 0);
    REQUIRE(run_rosin(folder, std::string("report ") + scene).status == 0);
    const auto page = content(folder.path / scene / "report.html");
    CHECK(count(page, R"("title":"critical point −1")") == int(marked));
    CHECK_FALSE(figure(page, "frf-1").contains("marks"));
  }
}

TEST_CASE("a report points nowhere but into itself", "[app][report]") {
  const Folder folder;
  REQUIRE(run_rosin(folder, "run " + examples + "coulomb-stick-slip.toml --out out").status == 0);
  REQUIRE(run_rosin(folder, "report out --quiet").out.empty());
  const auto page = content(folder.path / "out/report.html"), shown = markup(page);
  CHECK(page.size() < 1'000'000);
  CHECK(count(shown, "http") == 1);  // http-equiv of the policy
  CHECK_THAT(shown, Contains("default-src 'none'; script-src 'sha256-") && !Contains("unsafe"));
  CHECK(count(shown, "href=\"") == count(shown, "href=\"#"));
  CHECK(count(shown, "src=\"") == count(shown, "src=\"data:"));
  CHECK(count(shown, " style=\"") == 0);
  CHECK(count(page, "<link") == 0);
  CHECK(count(page, "@import") + count(page, "url(http") == 0);
  CHECK_THAT(shown, Contains("lang=\"en\"") && Contains("<main") && Contains("<nav aria-label") &&
                        Contains("name=\"viewport\""));
}

TEST_CASE("texts of a scene stay texts on the page", "[app][report]") {
  const Folder folder;
  const std::string evil = "</script><script>alert(1)</script><img src=x onerror='alert(2)'><!-- \"";
  auto scene = content(examples + "coulomb-stick-slip.toml");
  scene.erase(scene.find("title"), scene.find('\n', scene.find("title")) - scene.find("title"));
  write(folder.path / "a <b>'\"&.toml", "title = '''" + evil + " '''\n" + scene);
  const auto ran = run_rosin(folder, "run \"a <b>'\\\"&.toml\" --out out --no-pictures");
  INFO(ran.error);
  REQUIRE(ran.status == 0);
  // A document that somebody else wrote: its keys and texts are no more to be trusted.
  auto document = json_of(folder.path / "out/run.json");
  document["notes"] = {evil}, document["warnings"] = {evil}, document["metrics"][evil] = 1, document[evil] = evil;
  document["columns"][evil] = document["time"], document["law"] = evil;
  write(folder.path / "out/run.json", document.dump());
  auto declared = json_of(folder.path / "out/run.figure.json");
  declared["what"] = evil, declared["panels"][0]["x"]["name"] = evil, declared["panels"][0]["notes"] = {evil};
  write(folder.path / "out/run.figure.json", declared.dump());
  REQUIRE(run_rosin(folder, "report out").status == 0);
  const auto page = content(folder.path / "out/report.html");
  CHECK(count(page, "alert(2)") > 5);
  CHECK(count(page, "<img") == 0);
  CHECK(count(page, "<script>") == 2);
  CHECK(count(page, "<script") == 2 + count(page, "<script type=\"application/json\""));
  CHECK(count(page, "<script") == count(page, "</script>"));
  CHECK(count(markup(page), "<!--") == 0);
  CHECK_THAT(page, Contains("&lt;/script&gt;&lt;script&gt;alert(1)"));
  CHECK_THAT(page, Contains("rosin run &#39;a &lt;b&gt;&#39;\\&#39;&#39;&quot;&amp;.toml&#39;"));  // quoted for a shell
  CHECK(figure(page, "run-1")["x"]["name"] == evil);
}

TEST_CASE("large planes and long motions are thinned to a page that browsers open", "[app][report]") {
  rosin::app::report::Folder folder{"large", {plane_of(300)}};
  const auto page = page_of(folder);
  CHECK(page.size() < 1'000'000);
  CHECK_THAT(page, Contains("One value in "));
  const auto data = figure(page, "map-1");
  const auto& axis = data["x"]["values"];
  REQUIRE(axis.size() > 40);
  const auto& wanted = folder.results[0].document;
  // Values that are left stand at their own places.
  const auto every = std::size_t(std::lround(50 * std::log10(axis[1].get<double>() / axis[0].get<double>())));
  CHECK(axis[3] == wanted["x"]["values"][3 * every]);
  CHECK(data["layers"][1]["values"][2][3].get<double>() ==
        Approx(wanted["metrics"]["slip_rate_max"][2 * every][3 * every].get<double>()).epsilon(1e-8));

  const Folder own;
  std::string rows = "time (s),slip_rate (m/s)\n";
  for (int i = 0; i < 200'000; ++i) rows += fmt::format("{},{}\n", i, i == 77'777 ? 5.0 : std::sin(i));
  write(own.path / "run.csv", rows);
  const ordered_json column{{"column", 2}}, time{{"column", 1}};
  const ordered_json line{{"how", "line"}, {"table", "run.csv"}, {"x", time}, {"y", column}};
  const ordered_json panel{{"x", {{"name", "time"}}}, {"y", {{"name", "slip rate"}}}, {"lines", {line}}};
  write(own.path / "run.figure.json", ordered_json{{"what", "Long"}, {"panels", {panel}}}.dump());
  const Result motion{"run", {{"title", "Long"}}, {{"verb", "run"}, {"files", {"run.csv", "run.figure.json"}}}, "0"};
  const auto long_page = page_of({own.path, {motion}});
  CHECK(long_page.size() < 1'000'000);
  const auto kept = numbers(figure(long_page, "run-1")["series"][0]["y"]);
  CHECK(*std::max_element(kept.begin(), kept.end()) == 5);  // one sample of 200 000, which is the one that matters
}

TEST_CASE("a declared figure is drawn from the columns that it names", "[app][report]") {
  const Folder own;
  write(own.path / "run.csv", "time (s),kind,force (N)\n0,slip,1\n1,stick,-2\n\n2,slip,4\n");
  const auto cell = [](int column) { return ordered_json{{"column", column}}; };
  auto scaled = cell(3);
  scaled["absolute"] = true, scaled["factor"] = 10, scaled["plus"] = 1, scaled["over"] = 3, scaled["least"] = 5;
  const ordered_json where{{{"column", 2}, {"compare", "="}, {"value", "slip"}}};
  const ordered_json lines{{{"how", "line"}, {"table", "run.csv"}, {"x", cell(1)}, {"y", cell(3)}},
                           {{"how", "points"}, {"table", "run.csv"}, {"x", cell(1)}, {"y", cell(3)}, {"where", where}},
                           {{"how", "points"}, {"rows", {{1, 2}, {3, nullptr}}}, {"x", cell(1)}, {"y", cell(2)}},
                           {{"how", "line"}, {"table", "../run.csv"}, {"x", cell(1)}, {"y", cell(3)}},
                           {{"how", "line"}, {"table", "run.csv"}, {"x", cell(1)}, {"y", scaled}}};
  const ordered_json panel{{"x", {{"name", "time"}}}, {"y", {{"name", "force"}}}, {"lines", lines}};
  write(own.path / "run.figure.json", ordered_json{{"what", "Forces"}, {"panels", {panel}}}.dump());
  const ordered_json datasets{
      {{"name", "run"}, {"variables", {{"time", {}}, {"kind", {}}, {"force", {{"error", 1e-3}}}}}}};
  const Result run{"run", {{"datasets", datasets}}, {{"files", {"run.figure.json"}}}, "0"};
  const auto drawn = figure(page_of({own.path, {run}}), "run-1");
  const auto& series = drawn["series"];
  REQUIRE(series.size() == 4);  // without the table that is elsewhere
  CHECK(series[0]["y"] == ordered_json{1, -2, nullptr, 4});
  CHECK(series[1]["y"] == ordered_json{1, nullptr, nullptr, 4});
  CHECK(series[2]["y"] == ordered_json{2, nullptr});
  CHECK(series[3]["y"] == ordered_json{11, 11, nullptr, 11});
  CHECK(drawn["y"]["error"] == 1e-3);
}

TEST_CASE("values outside an axis stand beside it", "[app][report]") {
  auto result = plane_of(6);
  result.document["y"] = {
      {"parameter", "law.lambda"}, {"unit", "1"}, {"scale", "log"}, {"values", {1, 10, 100, 1000, 10000, 0}}};
  const auto y = figure(page_of({"extra", {result}}), "map-1")["y"];
  CHECK(y["extra"][0]["value"] == 0);
  CHECK(y["high"][5].get<double>() < y["low"][0].get<double>());
  CHECK(y["low"][0].get<double>() == Approx(1 / std::sqrt(10)));
  CHECK(y["high"][4].get<double>() == Approx(1e4 * std::sqrt(10)));
}

TEST_CASE("what is no folder of results is refused, and what is no report is left alone", "[app][report]") {
  const Folder folder;
  const auto refuses = [&](const std::string& arguments, const std::string& why) {
    const auto printed = run_rosin(folder, "report " + arguments);
    INFO(printed.error);
    CHECK(printed.status == 2);
    CHECK_THAT(printed.error, Contains(why));
  };
  refuses("nowhere", "nowhere: no such folder");
  fs::create_directory(folder.path / "empty");
  refuses("empty", "holds no results (no <verb>.manifest.json)");
  CHECK(fs::is_empty(folder.path / "empty"));

  const auto command = "curve " + examples + "bristol-board-cycle.toml --no-pictures --out out";
  REQUIRE(run_rosin(folder, command).status == 0);
  refuses("out/curve.json", "is no folder");
  write(folder.path / "out/report.html", "<!DOCTYPE html><p>my own</p>");
  refuses("out", "is no report of rosin and is left alone; --out FILE");
  CHECK(content(folder.path / "out/report.html") == "<!DOCTYPE html><p>my own</p>");
  CHECK(run_rosin(folder, "report out --out elsewhere.html").status == 0);
  CHECK(run_rosin(folder, "report out --out elsewhere.html").status == 0);  // an older report is replaced

  const auto whole = content(folder.path / "out/curve.json");
  write(folder.path / "out/curve.json", whole.substr(0, whole.size() / 2));
  const auto before = content(folder.path / "elsewhere.html");
  refuses("out --out elsewhere.html", "is damaged, no JSON from byte");
  write(folder.path / "out/curve.json", "[1, 2]");
  refuses("out --out elsewhere.html", "holds no results, but something else");
  fs::remove(folder.path / "out/curve.json");
  refuses("out --out elsewhere.html", "out/curve.json: no such file");
  write(folder.path / "out/curve.json", whole);
  auto manifest = json_of(folder.path / "out/curve.manifest.json");
  manifest["version"] = "0.0.9";
  write(folder.path / "out/curve.manifest.json", manifest.dump());
  refuses("out --out elsewhere.html", "was written by rosin 0.0.9, and this is");
  CHECK(content(folder.path / "elsewhere.html") == before);
}

TEST_CASE("documents of any shape make a page", "[app][report]") {
  const ordered_json odd[] = {nullptr, 1, "text", {1, 2}, {{"a", 1}}, {nullptr, "x", {1, {2}}}, {{{"x", {1}}}, 3}};
  const std::initializer_list<const char*> keys = {
      "x",    "y",      "regime", "metrics", "error",    "time",        "columns",   "units",    "events",
      "hopf", "values", "up",     "down",    "points",   "eigenvalues", "frequency", "members",  "series",
      "path", "labels", "planes", "notes",   "readings", "parameters",  "ranking",   "failures", "threshold"};
  for (const auto& value : odd)
    for (const std::string label : {"map", "run", "cycle", "stability", "branch", "sweep", "basin", "compare", "design",
                                    "frf", "fit", "lab", "lyapunov", "curve", "unknown"}) {
      Result result{label, ordered_json::object(), ordered_json::object(), "0"};
      for (const auto* key : keys) result.document[key] = value, result.manifest[key] = value;
      result.document["parameter"] = "drive.speed";
      CHECK_FALSE(rosin::app::report::verdict_of(result).empty());
      CHECK_THAT(page_of({"odd", {result}}), Contains("class=\"verdict\">"));
    }
  const Folder own;
  const Result result{"run", ordered_json::object(), {{"files", {"run.figure.json"}}}, "0"};
  for (const auto& value : odd) {
    ordered_json line{{"how", "line"}, {"rows", {{1, 2}}}}, panel;
    for (const auto* key : {"x", "y", "where", "look", "title"}) line[key] = value;
    for (const auto* key : {"x", "y", "title", "shades", "rules", "marks", "notes"}) panel[key] = value;
    for (const auto& panels : {value, ordered_json{value}, ordered_json{{{"lines", value}}}, ordered_json{panel}}) {
      auto whole = panels;
      if (whole == ordered_json{panel}) whole[0]["lines"] = {line, value};
      write(own.path / "run.figure.json", ordered_json{{"what", value}, {"panels", whole}}.dump());
      CHECK_THAT(page_of({own.path, {result}}), Contains("class=\"verdict\">"));
    }
  }
}
