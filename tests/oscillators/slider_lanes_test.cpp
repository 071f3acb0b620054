/// Sliders in lanes are the sliders one by one, for every law that lanes can carry.
#include "oscillators/slider_lanes.hpp"

#include <catch2/catch.hpp>
#include <random>

#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::oscillators;

namespace {
Model slider(std::shared_ptr<const FrictionLaw> law, double mass, double damping, double contact_stiffness, int lane,
             double contact_damping = 0) {
  Model model;
  model.law = std::move(law);
  model.lambda = model.law->has_states() ? 0.5 * lane : 1;  // λ = 0 in the first lane
  model.slider = {mass, 1.1 + 0.1 * lane, damping};
  if (contact_stiffness > 0) model.contact_stiffness.tangential = contact_stiffness * (1 + lane);
  model.contact_stiffness.damping = contact_damping * (1 + lane);
  model.drive = {1e-5 * (1 + lane), 0.01 * (1 + lane), 0.001 * lane};
  return model;
}
}  // namespace

TEST_CASE("lanes evaluate and linearise as single sliders do", "[slider-lanes]") {
  struct Kind {
    double mass, damping, contact_stiffness, contact_damping;
  };
  const auto kind = GENERATE(Kind{1, 0.1, 0, 0}, Kind{1, 0, 5, 0}, Kind{0, 0.3, 0, 0}, Kind{0, 0, 0, 0},
                             Kind{1, 0.1, 2, 3}, Kind{0, 0.3, 2, 3}, Kind{0, 0, 2, 3});
  for (const auto& law : laws::catalogue()) {
    if (law->set_valued() && (kind.mass == 0 || kind.contact_stiffness > 0)) continue;
    if (!law->has_slip_rate() && kind.mass == 0) continue;
    // Friction of these does not answer to the slip rate at once, which an undamped spring leaves open.
    if ((law->card().name == "dahl" || law->card().name.ends_with("film")) &&
        kind.contact_stiffness > kind.contact_damping)
      continue;
    INFO(law->card().name << ", mass " << kind.mass << ", contact stiffness " << kind.contact_stiffness);
    std::vector<SliderSystem> sliders;
    for (int lane = 0; lane < lane_count; ++lane)
      sliders.emplace_back(slider(law, kind.mass, kind.damping, kind.contact_stiffness,
                                  law->has_slip_rate() ? lane : lane + 1, kind.contact_damping));
    SliderLanes lanes(sliders.front());
    const int n = sliders.front().size();
    REQUIRE(lanes.size() == n);
    std::vector<Lanes> y(n), f(n), J(n * n), m(n);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> about(0.8, 1.2);
    for (int lane = 0; lane < lane_count; ++lane) {
      REQUIRE(lanes.fits(sliders[lane]));
      lanes.load(lane, sliders[lane]);
      const auto steady = sliders[lane].steady(0);
      for (int i = 0; i < n; ++i) y[i].set(lane, steady[i] * about(random));
    }
    lanes.linearise(y.data(), f.data(), J.data());
    lanes.mass(m.data());
    std::vector<Lanes> f_only(n);
    lanes.evaluate(y.data(), f_only.data());
    for (int lane = 0; lane < lane_count; ++lane) {
      std::vector<double> at(n), f1(n), J1(n * n), m1(n);
      for (int i = 0; i < n; ++i) at[i] = y[i][lane];
      sliders[lane].linearise(0, at.data(), f1.data(), J1.data());
      sliders[lane].mass(0, m1.data());
      double size_f = 0, size_J = 0;
      for (const double x : f1) size_f = std::max(size_f, std::abs(x));
      for (const double x : J1) size_J = std::max(size_J, std::abs(x));
      for (int i = 0; i < n; ++i) {
        INFO("lane " << lane << ", row " << i);
        CHECK(std::abs(f[i][lane] - f1[i]) <= 1e-11 * size_f);
        CHECK(std::abs(f_only[i][lane] - f1[i]) <= 1e-11 * size_f);
        CHECK(m[i][lane] == m1[i]);
        for (int j = 0; j < n; ++j) CHECK(std::abs(J[i * n + j][lane] - J1[i * n + j]) <= 1e-11 * size_J);
      }
    }
  }
}

TEST_CASE("errors of a state are forgiven where it forgets them before they are felt", "[slider-lanes]") {
  Model model;
  model.law = laws::find_law("spinodal");
  model.lambda = 0.15;
  model.slider = {1, 1.09, 0};
  model.drive = {1e-5, 0.1, 0.0};
  /// Scales of all unknowns at a slip rate over V and a state.
  const auto scales = [](const Model& model, double slip_rate, double log_psi) {
    const SliderSystem slider(model);
    const SliderLanes lanes(slider);
    const int n = slider.size();
    const double v = slip_rate * model.drive.speed.level(), N = model.drive.normal_load.level();
    const double mu = model.law->friction({v, N}, std::vector{std::exp(log_psi)});
    std::vector<double> at = slider.steady(0);
    at[0] = N * mu / model.slider.stiffness, at[1] = v, at[2] = mu, at[3] = log_psi;
    std::vector<Lanes> y(n), f(n), J(n * n), s(n);
    for (int i = 0; i < n; ++i) y[i] = Lanes(at[i]);
    lanes.linearise(y.data(), f.data(), J.data());
    lanes.scale(y.data(), J.data(), s.data());
    std::vector<double> scales;
    for (const auto& of_unknown : s) scales.push_back(of_unknown[0]);
    return scales;
  };
  const double steady_state = std::log(1 / (1 + 1e-5 * 90 / 0.9e-6));
  const auto steady = scales(model, 1, steady_state);
  const auto arrested = scales(model, 1e-3, -4.6), fast = scales(model, 300, steady_state - std::log(300));
  CHECK(arrested[3] > 20 * steady[3]);  // it has only begun to heal, and cannot move the slider
  CHECK(fast[3] > 20 * steady[3]);      // it follows slip within a 1e-4 of the swing's time
  CHECK(arrested[3] <= 100 * steady[3]);
  CHECK(scales(model, 0.3, -4)[3] == Approx(steady[3]));  // slip begins: here errors grow
  for (const int unknown : {0, 2}) CHECK(arrested[unknown] == steady[unknown]);
  model.contact_stiffness.tangential = 10;  // what it then does is another matter
  CHECK(scales(model, 1e-3, -4.6)[3] == scales(model, 1, steady_state)[3]);
}

TEST_CASE("lanes refuse what does not fit", "[slider-lanes]") {
  const auto spinodal = laws::find_law("spinodal");
  const SliderLanes lanes{SliderSystem(slider(spinodal, 1, 0, 0, 1))};
  CHECK(lanes.fits(SliderSystem(slider(spinodal, 2, 0.5, 0, 7))));
  CHECK_FALSE(lanes.fits(SliderSystem(slider(spinodal, 0, 0.5, 0, 1))));                // other mechanics
  CHECK_FALSE(lanes.fits(SliderSystem(slider(spinodal, 1, 0, 3, 1))));                  // a contact spring
  CHECK_FALSE(lanes.fits(SliderSystem(slider(spinodal, 1, 0, 3, 1, 2))));               // a damped one
  CHECK_FALSE(lanes.fits(SliderSystem(slider(laws::find_law("ageing"), 1, 0, 0, 1))));  // another law
  auto varying = slider(spinodal, 1, 0, 0, 1);
  varying.drive.normal_load = Signal(Signal::Steps{{{0, 1}, {1, 2}}});
  CHECK_FALSE(lanes.fits(SliderSystem(varying)));
  CHECK_THROWS_AS(SliderLanes{SliderSystem(varying)}, InputError);
}

TEST_CASE("packs that nobody uses are not worked on", "[slider-lanes]") {
  const char* law = GENERATE("spinodal", "lugre");
  const SliderSystem single(slider(laws::find_law(law), 1, 0.1, 0, 1));
  SliderLanes lanes(single);
  const int n = lanes.size();
  const auto steady = single.steady(0);
  std::vector<Lanes> y(steady.begin(), steady.end()), f(n, -7.0), J(n * n, -7.0);
  constexpr int one = pack_width - 1, used = 2 * pack_width - 1, left_out = lane_count - 1;
  lanes.use_packs(1);
  lanes.linearise(y.data(), f.data(), J.data());
  for (int i = 0; i < n; ++i) {
    CHECK(f[i][one] != -7);
    CHECK(f[i][used] == -7);
    for (int j = 0; j < n; ++j) CHECK(J[i * n + j][used] == -7);
  }
  lanes.evaluate(y.data(), f.data());  // two packs side by side
  for (int i = 0; i < n; ++i) CHECK(f[i][left_out] == -7);
  lanes.use_packs(lane_packs);
  lanes.linearise(y.data(), f.data(), J.data());
  for (int i = 0; i < n; ++i) CHECK(f[i][left_out] == f[i][one]);
}
