/// Stops that begin where a reversal is loaded to just the limit, against closed forms of half a period.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/branches/branches.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"

using namespace rosin;
using namespace rosin::analysis;
using oscillators::Model;

namespace {

/// ẍ + x + f sgn ẋ = cos(w t) between two reversals, each the mirror image of the other (Den Hartog 1931): the largest
/// kinetic friction f of a motion without stops, with static friction r f.
double largest_friction(double w, double r) {
  const double t = std::tan(0.5 * std::numbers::pi / w);
  return w * w / (std::abs(1 - w * w) * std::sqrt(r * r + w * w * t * t));
}

enum class Along { load, force, frequency };

Model forced(double w, double friction, double force, double r) {
  Model model;
  model.law = laws::find_law("coulomb")->with({r, 1.0});
  model.slider = {1, 1, 0};
  model.drive.speed = 0, model.drive.normal_load = friction;
  model.drive.force = Signal(Signal::Harmonics{0, {{force, w, 0}}});
  return model;
}

}  // namespace

TEST_CASE("stops begin and end where a reversal is loaded to just the limit, whatever is varied",
          "[long][branches][stops_begin]") {
  int followed = 0, drawn = 0;
  for (const double r : {1.0, 1.1})
    for (const double w : {0.6, 0.7, 0.75, 1.3, 1.7, 2.5})
      for (const Along along : {Along::load, Along::force, Along::frequency})
        for (const bool into_stops : {true, false}) {
          if (drawn++ % 5 > 1) continue;  // two of five, of each kind: all 72 take a minute
          const double f = largest_friction(w, r);
          const auto model_at = [&](double p) {
            return along == Along::load    ? forced(w, p, 1, r)
                   : along == Along::force ? forced(w, 1, p, r)
                                           : forced(p, f, 1, r);
          };
          const double wanted = along == Along::load ? f : along == Along::force ? 1 / f : w;
          // Friction above the limit: stops.
          const double aside = 1e-4;
          const bool more = along != Along::force &&
                            (along == Along::load || largest_friction(w + aside, r) < largest_friction(w - aside, r));
          const double reach = along == Along::frequency ? 0.02 : 0.1;
          const double without = wanted * (more ? 1 - reach : 1 + reach), with = 2 * wanted - without;
          branches::BranchOptions options;
          options.parameter = {into_stops ? without : with, into_stops ? with : without, false};
          options.tolerance = 1e-9;
          options.doublings = 0;
          INFO("static over kinetic " << r << ", " << w << " rad/s, along " << int(along) << ", into stops "
                                      << into_stops);
          const auto settled = branches::settle(model_at(options.parameter.from), 1e-9);
          REQUIRE(settled.outcome.complete());
          const auto found = branches::from_cycle([&](double p) { return branches::oscillator_of(model_at(p)); },
                                                  settled, options.parameter.from, options);
          REQUIRE(found.cycles.size() == 1);
          const auto& branch = found.cycles[0].branch;
          CHECK(branch.outcome.detail == "");
          const bool starts_with = branch.points.front().view.metrics.at("stick_fraction") > 0,
                     ends_with = branch.points.back().view.metrics.at("stick_fraction") > 0;
          REQUIRE(starts_with == !into_stops);
          REQUIRE(ends_with == into_stops);
          ++followed;
          REQUIRE(branch.special.size() == 1);
          CHECK(branch.special[0].kind == "switching-sliding");
          CHECK(branch.special[0].error < 1e-8);
          CHECK(std::abs(branch.special[0].p - wanted) <= branch.special[0].error);
        }
  CHECK(followed >= 24);
}
