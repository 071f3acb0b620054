/// Windows of growth: those of two modes of a pin on a disk, by independent eigenvalues, at any spacing; and of modes
/// whose frequencies cross, told by their shapes.
#include "analysis/steady/mode_windows.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"
#include "oscillators/pin_on_disk.hpp"

using namespace rosin;
using namespace rosin::analysis::steady;

namespace {

Scan over_load(double pin_stiffness, double from, double to, int points) {
  std::vector<double> values;
  for (int i = 0; i < points; ++i) values.push_back(from + (to - from) * i / (points - 1));
  return scan(
      [&](double load) {
        oscillators::PinOnDisk rig;
        rig.pin_stiffness = {1.2e6, pin_stiffness, 600};
        rig.normal_law = laws::normal_law(laws::PowerContact{
            .coefficient = 1.25e20, .exponent = 2.5, .bound_coefficient = 1.25e20, .bound_exponent = 2.5});
        oscillators::FrictionContact contact;
        contact.law = laws::find_law("coulomb")->with({0.25, 0.25});
        contact.speed = 0.46, contact.normal_load = load;
        return stability(oscillators::pin_on_disk(rig, contact));
      },
      values);
}

/// Two modes of fixed shapes, with growth rates and frequencies over the parameter.
StructureStability two_modes(double growth_1, double frequency_1, double growth_2, double frequency_2) {
  StructureStability sliding;
  sliding.inertia = {1, 1};
  sliding.modes = {{{growth_1, frequency_1}, 1e-14, {1, 0.2}}, {{growth_2, frequency_2}, 1e-14, {-0.2, 1}}};
  for (const auto& mode : sliding.modes) sliding.eigenvalues.push_back(mode.eigenvalue);
  return sliding;
}

}  // namespace

TEST_CASE("a pin on a disk squeals in two windows of load, seen at any spacing") {
  // By numpy's dense eigenvalues of the same rig, written anew.
  const double onset_1 = 10.3332705, end_1 = 31.5641258, onset_2 = 33.5637129, end_2 = 74.1845574;
  for (const int points : {2, 3, 6, 20, 96}) {
    INFO(points);
    const auto found = over_load(2.4e6, 5, 100, points);
    REQUIRE(found.windows.size() == 2);
    const auto &slider = found.windows[0], &pin = found.windows[1];
    REQUIRE((slider.onset && slider.end && pin.onset && pin.end));
    CHECK(slider.onset->value == Approx(onset_1).epsilon(1e-7));
    CHECK(slider.end->value == Approx(end_1).epsilon(1e-7));
    CHECK(pin.onset->value == Approx(onset_2).epsilon(1e-7));
    CHECK(pin.end->value == Approx(end_2).epsilon(1e-7));
    CHECK(slider.fastest.frequency() == Approx(127).epsilon(0.01));
    CHECK(pin.fastest.frequency() == Approx(19000).epsilon(0.1));
    CHECK(found.thresholds.size() == 4);
  }
}

TEST_CASE("while one mode of the pin grows another begins to and ceases: two modes at once, one threshold") {
  const auto found = over_load(2.2e6, 20, 100, 9);
  REQUIRE(found.windows.size() == 2);
  REQUIRE(found.windows[0].onset);
  CHECK(found.windows[0].onset->value == Approx(23.498037).epsilon(1e-7));
  CHECK_FALSE(found.windows[0].end);
  REQUIRE((found.windows[1].onset && found.windows[1].end));
  CHECK(found.windows[1].onset->value == Approx(34.6424601).epsilon(1e-7));
  CHECK(found.windows[1].end->value == Approx(76.8242623).epsilon(1e-7));
  REQUIRE(found.thresholds.size() == 1);
  CHECK(found.unstable_modes == std::vector<int>{0, 1, 2, 2, 2, 2, 1, 1, 1});
}

TEST_CASE("modes whose frequencies cross while both grow are told by their shapes") {
  for (const int points : {2, 5, 16}) {
    std::vector<double> values;
    for (int i = 0; i < points; ++i) values.push_back(4.03 * i / (points - 1));
    const auto found = scan(
        [](double p) { return two_modes(0.1 * (p - 1) * (2 - p), 10 + p, 0.1 * (p - 1.5) * (3 - p), 14 - p); }, values);
    INFO(points);
    REQUIRE(found.windows.size() == 2);
    const double edges[][2] = {{1, 2}, {1.5, 3}};
    for (int k = 0; k < 2; ++k) {
      const auto& window = found.windows[std::size_t(k)];
      REQUIRE((window.onset && window.end));
      CHECK(std::abs(window.onset->value - edges[k][0]) <= window.onset->error);
      CHECK(std::abs(window.end->value - edges[k][1]) <= window.end->error);
      CHECK(window.onset->angular_frequency == Approx(k == 0 ? 11 : 12.5));
    }
    REQUIRE(found.thresholds.size() == 2);
    CHECK(found.thresholds[0].value == Approx(1));
    CHECK(found.thresholds[1].value == Approx(3));
  }
}

TEST_CASE("a gap of a thousandth of the spacing between two windows of one mode is seen") {
  // Grows for |p − 0.537| above 0.0005 and below about 0.5.
  const auto found = scan(
      [](double p) {
        const double x = p - 0.537;
        return two_modes((x * x - 0.25e-6) * (0.25 - x * x), 3, -1, 7);
      },
      {0.0, 0.5, 1.0});
  REQUIRE(found.windows.size() == 2);
  REQUIRE((found.windows[0].end && found.windows[1].onset));
  CHECK(found.windows[0].end->value == Approx(0.5365).epsilon(1e-9));
  CHECK(found.windows[1].onset->value == Approx(0.5375).epsilon(1e-9));
}
