/// Series of a run in other programs' columns.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

namespace {

/// The rows of numbers behind the header.
std::vector<std::vector<double>> rows_of(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    for (auto& c : line)
      if (c == ',') c = ' ';
    std::istringstream words(line);
    std::vector<double> row;
    for (std::string word; words >> word;) {
      char* end = nullptr;
      const double value = std::strtod(word.c_str(), &end);
      if (*end == '\0') row.push_back(value);
    }
    if (row.size() > 4) rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("a run in the columns of rsfmodel, QDYN and EQcycle", "[app][imports]") {
  const Folder folder;
  // at 1 um/s for 10 s, then at 10 um/s: the load point moves 10 + 300 um
  const auto ran = run_rosin(folder, "import '" ROSIN_SOURCE_DIR "/examples/import/velocity-step.py'");
  REQUIRE(ran.status == 0);
  std::ofstream(folder.path / "scene.toml") << ran.out;
  REQUIRE(run_rosin(folder, "run scene.toml --no-pictures --quiet").status == 0);
  const auto rsfmodel = rows_of(run_rosin(folder, "export out/scene --as rsfmodel").out);
  REQUIRE(rsfmodel.size() == 4001);
  REQUIRE(rsfmodel[0].size() == 6);
  CHECK(rsfmodel[1000][1] == Approx(10).epsilon(1e-9));
  CHECK(rsfmodel[4000][1] == Approx(310).epsilon(1e-9));
  CHECK(rsfmodel[1100][3] == Approx(0.60720485).margin(1e-7));
  // what the load point moves and the slider does not stretches the spring: k (x_lp - x) = mu - mu0
  CHECK(1e-3 * (rsfmodel[1300][1] - rsfmodel[1300][4]) == Approx(rsfmodel[1300][3] - 0.6).margin(1e-7));

  const auto text = run_rosin(folder, "export out/scene --as qdyn").out;
  CHECK_THAT(text, Contains("# 1=t, 2=pot (not filled), 3=pot_rate (not filled)") && Contains("4=V, 5=theta, 6=tau"));
  const auto qdyn = rows_of(text);
  REQUIRE(qdyn.size() == 4001);
  REQUIRE(qdyn[0].size() == 9);
  CHECK(std::isnan(qdyn[0][1]));
  CHECK(qdyn[1100][3] == Approx(1e-6 * rsfmodel[1100][2]).epsilon(1e-12));
  CHECK(qdyn[1100][5] == Approx(rsfmodel[1100][3]).epsilon(1e-12));
  CHECK(qdyn[1100][6] == Approx(1e3 * (1e-5 - qdyn[1100][3])).epsilon(1e-9));
  CHECK(qdyn[1100][7] == Approx(1e-6 * rsfmodel[1100][4]).epsilon(1e-12));
  CHECK(qdyn[1100][8] == 1);

  const auto eqcycle = rows_of(run_rosin(folder, "export out/scene --as eqcycle").out);
  REQUIRE(eqcycle.size() == 4001);
  CHECK(eqcycle[1300][4] == Approx(eqcycle[1300][3]).margin(1e-9));  // without mass the spring's load is friction
}

TEST_CASE("an export says what it needs", "[app][imports]") {
  const Folder folder;
  CHECK_THAT(run_rosin(folder, "export nowhere --as qdyn").error, Contains("nowhere/: holds no run"));
  CHECK_THAT(run_rosin(folder, "export nowhere").error, Contains("--as is missing; there are rsfmodel, qdyn, eqcycle"));
  CHECK_THAT(run_rosin(folder, "export nowhere --as qdynn").error, Contains("did you mean 'qdyn'?"));
}
