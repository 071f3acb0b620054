/// Planes of the probability that steady sliding is unstable, under uncertain inputs.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

namespace {

const std::string brake =
    "map " ROSIN_SOURCE_DIR "/examples/brake-two-modes.toml --no-pictures --json --set law.mu=0.3 ";
const std::string axes =
    "x={ parameter='law.mu', from=0.28, to=0.4, points=7 }, y={ parameter='drive.normal_load', from=500, to=1000, "
    "points=2 }";

}  // namespace

TEST_CASE("a plane of probability follows the distribution of friction about its threshold", "[map][structure]") {
  const Folder folder;
  const auto run =
      run_rosin(folder, brake + "--set \"map={ " + axes +
                            ", metrics=['probability_unstable', 'growth_rate'], uncertain={ 'law.mu' = 0.1 }, "
                            "samples=2000 }\"");
  INFO(run.error);
  REQUIRE(run.status == 0);
  const auto document = nlohmann::json::parse(run.out);
  constexpr double threshold = 0.336635733;  // of the damped brake, whatever its load
  for (std::size_t iy = 0; iy < 2; ++iy)
    for (std::size_t ix = 0; ix < 7; ++ix) {
      const double mu = document["x"]["values"][ix];
      const double wanted = 0.5 * std::erfc(-std::log(mu / threshold) / std::log1p(0.1) / std::sqrt(2));
      const double found = document["metrics"]["probability_unstable"][iy][ix],
                   error = document["error"]["probability_unstable"][iy][ix];
      INFO(mu);
      CHECK(std::abs(found - wanted) < 4 * error);
      CHECK(error < 0.012);
      CHECK((document["metrics"]["growth_rate"][iy][ix].get<double>() > 0) == (mu > threshold));
    }
}

TEST_CASE("uncertain inputs of a plane and their metric go together", "[map][structure]") {
  const Folder folder;
  const auto refused = [&](const std::string& keys) {
    const auto run = run_rosin(folder, brake + "--set \"map={ " + axes + ", " + keys + " }\"");
    CHECK(run.status == 2);
    return run.error;
  };
  CHECK_THAT(refused("metrics=['probability_unstable']"), Contains("needs map.uncertain"));
  CHECK_THAT(refused("metrics=['growth_rate'], uncertain={ 'law.mu_d' = 0.1 }"),
             Contains("has no effect without the metric"));
  CHECK_THAT(refused("metrics=['growth_rate'], samples=50"),
             Contains("map.samples has no effect without map.uncertain"));
  CHECK_THAT(refused("metrics=['probability_unstable'], uncertain={ 'law.mu_q' = 0.1 }"), Contains("mu_q"));
}

TEST_CASE("Coulomb friction in a linear structure decides nothing of how vibration sets in, whatever the load",
          "[structure]") {
  const Folder folder;
  for (const int load : {200, 500, 800, 1000}) {
    const auto run = run_rosin(folder, "stability " ROSIN_SOURCE_DIR
                                       "/examples/brake-two-modes.toml --no-pictures --json --set drive.normal_load=" +
                                           std::to_string(load));
    INFO(load << run.error);
    CHECK(nlohmann::json::parse(run.out)["thresholds"][0]["criticality"] == "degenerate");
  }
}
