/// Slopes by dual numbers against differences of the response at changed parameters, for every law and what surrounds
/// it.
#include "analysis/response/contact_slopes.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "tests/bristol_board.hpp"
#include "tests/surrounded_laws.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::response;
using oscillators::Model;
using tests::any_slider;
using tests::slider_under;
using Complex = std::complex<double>;

namespace {

/// Central differences of Z at three steps, extrapolated; the error is what they disagree by.
ResponseSlope::Answer by_differences(const Model& model, const std::string& path, Complex s) {
  const double value = model.get(path), widest = 0.01 * std::abs(value);
  Complex slope[3];
  double size = 0;
  for (int k = 0; k < 3; ++k) {
    const double h = widest / (1 << k);
    const Complex up = FrictionResponse(model.with(path, value + h)).tangential(s),
                  down = FrictionResponse(model.with(path, value - h)).tangential(s);
    slope[k] = (up - down) / (2 * h);
    size = std::max(size, std::abs(up));
  }
  const Complex coarse = (4.0 * slope[1] - slope[0]) / 3.0, fine = (4.0 * slope[2] - slope[1]) / 3.0;
  const Complex best = (16.0 * fine - coarse) / 15.0;
  return {best, std::abs(best - fine) + 1e-14 * size / (widest / 4)};
}

}  // namespace

TEST_CASE("slopes of every law's response are those that changed parameters give", "[contact-slopes]") {
  long compared = 0;
  for (const auto& model : tests::surrounded_laws())
    for (const auto& quantity : model.parameters()) {
      const auto& path = quantity.name;
      const double value = model.get(path);
      const double room = std::min(value - quantity.range.low, quantity.range.high - value);
      if (value == 0 || !std::isfinite(value) || room < 0.01 * std::abs(value)) continue;
      INFO(model.law->card().name << ", " << path << " = " << value << ", lambda " << model.lambda << ", spring "
                                  << model.contact_stiffness.tangential << ", " << model.contact_stiffness.per_load
                                  << ", heated " << (model.law->find("heating.resistance") ? "yes" : "no"));
      const FrictionResponse response(model);
      const ResponseSlope slope(response, model, path);
      for (const double omega : {0.0, 0.3, 40.0, 3e3}) {
        const Complex s(0, omega);
        const auto exact = slope(response.passage(s));
        const auto difference = by_differences(model, path, s);
        INFO("omega " << omega << ": " << exact.slope.real() << " " << exact.slope.imag() << " i against "
                      << difference.slope.real() << " " << difference.slope.imag() << " i, error " << difference.error);
        CHECK(std::abs(exact.slope - difference.slope) <=
              exact.error + 3 * difference.error + 1e-9 * std::abs(difference.slope));
        const double direct = model.drive.normal_load.level() / model.drive.speed.level();
        CHECK(exact.error <= 1e-6 * std::max(std::abs(exact.slope), std::abs(response.tangential(s) / value)) +
                                 1e-9 * direct / std::abs(value));
        ++compared;
      }
    }
  CHECK(compared > 2000);
}

TEST_CASE("no slope is taken where the contact is another one beside the value", "[contact-slopes]") {
  auto model = slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5);
  const auto slope = [&](const char* path) { return ContactSlopes(model, imposed_contact_setup(model), path); };
  CHECK_THROWS_WITH(slope("law.contact_stiffness.tangential"), Catch::Contains("rigid"));
  model.contact_stiffness.tangential = 1e5;
  CHECK_THROWS_WITH(slope("law.contact_stiffness.damping"), Catch::Contains("another contact"));
  model.lambda = 0;
  CHECK_THROWS_WITH(slope("law.lambda"), Catch::Contains("equilibrium"));
  CHECK_THROWS_AS(slope("law.q"), InputError);
  const FrictionResponse response(model);
  CHECK(ResponseSlope(response, model, "oscillator.mass")(response.passage({0, 3})).slope == 0.0);
}
