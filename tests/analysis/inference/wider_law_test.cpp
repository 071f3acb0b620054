/// Friction that rises further after a step: an evolution effect below 0.
#include "analysis/inference/wider_law.hpp"

#include <catch2/catch.hpp>

#include "core/random.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;
using oscillators::Model;
using tests::slider_under;

TEST_CASE("a negative evolution effect is found by the law with two states where that with one is lost",
          "[wider-law]") {
  // A step on a phyllosilicate: a 0.014, b -0.008, L 200 um behind 2e-3 1/um, with noise of 6e-4.
  constexpr double a = 0.014, b = -0.008, V = 3e-7;
  const oscillators::Slider any_slider{.mass = 1, .stiffness = 1, .damping = 0};
  const auto behind_machine = [](Model model) {
    model.contact_stiffness.per_load = 2e3;
    return model;
  };
  const auto gouge = behind_machine(slider_under("two-state-slip", {0.47, a, 0.0, 1e-5, b, 2e-4, V}, any_slider, V, 1));
  Measurement m;
  m.kind = Measurement::Kind::velocity_step, m.name = "step", m.slip_rate = V, m.next_slip_rate = 10 * V;
  for (int k = 0; k < 300; ++k) m.x.push_back(-50 + 3.0 * k);
  m.y = predict(gouge, m).y;
  const auto white = white_noise(m.y.size(), 5);
  for (std::size_t i = 0; i < m.y.size(); ++i) m.y[i] += 6e-4 * white[i];
  const auto slip = behind_machine(slider_under("slip", {0.47, 0.010, 0.005, 5e-5, V}, any_slider, V, 1));
  const FitOptions options{.parameters = {"law.mu0", "law.a", "law.b", "law.L"}, .starts = 1};
  Fit lost;
  lost.outcome = {Ending::none_exists, "the data do not determine law.a"};
  lost.bic = 1e6;
  const auto wider = fit_with_negative_evolution(slip, gouge.law, {m}, options, lost);
  REQUIRE(wider);
  CHECK(wider->b == Approx(b).margin(3 * wider->standard_error));
  CHECK(wider->standard_error < 2e-4);
  CHECK(wider->fit.parameters[1].value == Approx(a).margin(3 * wider->fit.parameters[1].standard_error));
  lost.bic = wider->fit.bic;  // as good as that
  CHECK_FALSE(fit_with_negative_evolution(slip, gouge.law, {m}, options, lost));
  lost.outcome = {};
  lost.bic = 1e6;
  CHECK_FALSE(fit_with_negative_evolution(slip, gouge.law, {m}, options, lost));
}
