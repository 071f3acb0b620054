/// Rounding error in the metrics of cycles.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "laws/catalogue.hpp"
#include "tests/analysis/agreement.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::check_agreement;
using rosin::tests::slider_under;

TEST_CASE("a mass reverses under friction that turns over within e^(-260) of the slip rate", "[cycle]") {
  const auto model = slider_under("ageing", {0.8495, 0.003227, 0.006083, 1.524e-6, 2.497e-6}, {0.0002596, 0.1122, 0},
                                  0.03234, 7.259e-5);
  const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
             tight = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(loose.outcome.ending == tight.outcome.ending);
  if (loose.outcome.complete()) check_agreement(loose, tight, {&cycles::Metrics::period});
}

TEST_CASE("stick ends under a load that rises by less than rounding error in a step", "[cycle]") {
  // k V h is far below rounding error of k x: without a carried remainder the load stood still.
  Model model = slider_under("coulomb", {0.28, 0.21}, {1.4131102906351356, 0.22212693588927454, 0},
                             1.6771671090107842e-08, 1489.0859522122828);
  model.law = laws::find_law("tabulated")
                  ->with({std::vector<double>{0, 0.00085140793421681078, 0.0025542238026504322, 0.0085140793421681071,
                                              0.025542238026504321, 0.085140793421681071},
                          std::vector<double>{0.27995845494442712, 0.23796468670276308, 0.21696780258193102,
                                              0.20996884120832035, 0.21696780258193102, 0.23096572532915238}});
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.metrics.period == Approx(39165515584.15).epsilon(1e-8));
}

TEST_CASE("a small cycle is known within rounding error of the displacement that it oscillates about", "[cycle]") {
  // Displacements of 5e-11 m about 2e-4 m: rounding error is 5e-10 of the amplitude, and comes back two thousandfold.
  const auto cycle_at = [](double tolerance) {
    auto model = slider_under("prz",
                              {0.72819302526756302, 0.0036218242219852705, 0.006180175588128738, 0.0001345184834891712,
                               0.00062882432050937896},
                              {74.676193966753146, 227018.66177122964, 1973682.3163139357}, 4.256691443557705e-08,
                              32.853482640961225);
    model.lambda = 1.2156585726957905e-06;
    model.drive.force = 16.527347723308491;
    return cycles::find_cycle(model, {.tolerance = tolerance});
  };
  const auto loose = cycle_at(1e-6), tight = cycle_at(1e-9);
  REQUIRE(loose.metrics.period > 0);
  REQUIRE(tight.metrics.period > 0);
  check_agreement(loose, tight,
                  {&cycles::Metrics::period, &cycles::Metrics::slip_rate_max, &cycles::Metrics::slip_rate_min});
}

TEST_CASE("friction a million times the load is known relative to itself", "[cycle]") {
  auto model =
      slider_under("lugre", {5.076e5, 9.84e5, 233.2, 3.224, 9.095e-6, 0.001188}, {3173.0, 2.971, 0}, 0.05345, 0.1488);
  model.lambda = 1.586e5;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(cycle.outcome.complete());
  CHECK(std::abs(cycle.metrics.friction_min) > 1e6);
  CHECK(cycle.error.friction_min < 1e-6 * std::abs(cycle.metrics.friction_min));
}

TEST_CASE("a cycle that forgets 1e-4 of a disturbance per period states rounding error of the spring force",
          "[cycle]") {
  // A period forgets 1e-4 of its start, and rounding error of the spring force is 1e-12 of its amplitude.
  const auto model =
      slider_under("nagata", {0.6, 0.05, 0.055, 1e-5, 1e-6, 2.0}, {0.0074075051691001618, 4700388.1445865892, 0},
                   3.710831763406306e-10, 28202.331919641918);
  const auto tight = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(tight.metrics.period > 0);
  CHECK(std::abs(tight.multipliers.front()) > 0.9998);
  for (const double tolerance : {1e-6, 3e-7, 1e-8}) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.metrics.period > 0);
    check_agreement(cycle, tight,
                    {&cycles::Metrics::period, &cycles::Metrics::slip_rate_max, &cycles::Metrics::friction_min});
  }
}

TEST_CASE("weak oscillations are known within rounding error of the forces that hold them", "[cycle]") {
  const auto agree = [](const Model& model, std::initializer_list<double cycles::Metrics::*> members) {
    const auto loose = cycles::find_cycle(model, {.tolerance = 1e-6}),
               tight = cycles::find_cycle(model, {.tolerance = 1e-9});
    REQUIRE(loose.metrics.period > 0);
    REQUIRE(tight.metrics.period > 0);
    for (const auto member : members)
      CHECK(std::abs(loose.metrics.*member - tight.metrics.*member) <= loose.error.*member + tight.error.*member);
  };
  // A period changes the energy by 5e-10 of the work of the mean friction, which is three times the energy itself.
  agree(slider_under("lugre-unscaled", {1e5, 100.0, 0.4, 0.4, 0.3, 0.001}, {1e12, 2.0477e5, 0}, 1.1937e-7, 18.005),
        {&cycles::Metrics::slip_rate_min, &cycles::Metrics::slip_rate_max});
  // Slip reverses in each period, which forgets 2e-7 of its start.
  auto reversing = slider_under("slip-distance", {1.2597, 0.17682, 3.4266e-5}, {7.4099, 74.182, 0}, 55.272, 1.2337e-5);
  reversing.lambda = 22113.0;
  agree(reversing,
        {&cycles::Metrics::slip_rate_max, &cycles::Metrics::friction_mean, &cycles::Metrics::stick_fraction_001});
}
