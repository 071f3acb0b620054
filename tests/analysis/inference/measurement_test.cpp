/// Predictions of measurements against closed forms, and their slopes against differences of predictions.
#include "analysis/inference/measurement.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.hpp"
#include "tests/bristol_board.hpp"
#include "tests/surrounded_laws.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::inference;
using oscillators::Model;
using tests::any_slider;
using tests::slider_under;
using Kind = Measurement::Kind;

namespace {

Model ageing() { return slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5); }

/// The history of a displacement with straight lines between these times.
Measurement::History in_straight_lines(std::vector<double> time, std::vector<double> slip_rate, double N) {
  const auto n = time.size();
  RecordedMotion motion;
  motion.displacement = {0}, motion.before = {slip_rate[0]}, motion.after = slip_rate;
  for (std::size_t i = 1; i < n; ++i) {
    motion.displacement.push_back(motion.displacement.back() + slip_rate[i - 1] * (time[i] - time[i - 1]));
    motion.before.push_back(slip_rate[i - 1]);
  }
  return {std::move(time), std::move(slip_rate), std::vector<double>(n, N), std::move(motion)};
}

}  // namespace

TEST_CASE("predictions of steps and holds are the closed forms", "[fit]") {
  // μ = μ_ss(V₂) + b ln(ψ V₂/L): ψ = L/V₂ + (L/V₁ − L/V₂) e^{−V₂t/L} (ageing); printed to 14 digits.
  Measurement m{Kind::velocity_step, "step", 1e-6, 1e-5, 1, {0, 0.05, 0.5, 1, 3, 10}, {}, {}};
  const auto by_age = predict(slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1, 1), m).y;
  const auto by_slip = predict(slider_under("slip", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1, 1), m).y;
  const double age[] = {0.62302585092994, 0.62235256109141, 0.61646867178205,
                        0.61040432711105, 0.59404069010018, 0.58849320227374};
  const double slip[] = {0.62302585092994, 0.62134137492812, 0.6094359013675,
                         0.60119318029393, 0.59020665895675, 0.58848864259305};
  for (std::size_t k = 0; k < 6; ++k) {
    CHECK(by_age[k] == Approx(age[k]).epsilon(1e-9));
    CHECK(by_slip[k] == Approx(slip[k]).epsilon(1e-9));
  }
  // At rest the age grows as time: μ = μ* + a ln(V/V*) + b ln((L/V + t) V*/L).
  Measurement hold{Kind::hold, "hold", 1e-6, 1e-6, 1, {1, 100, 1e4}, {}, {}};
  const auto peaks = predict(ageing(), hold).y;
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(peaks[k] == Approx(0.6 + 0.015 * std::log((10 + hold.x[k]) / 10)).epsilon(1e-8));
  // A stiff contact spring hardly changes a step.
  auto sprung = slider_under("slip", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1, 1);
  sprung.contact_stiffness.tangential = 1e8;
  m.x = {0.5, 1, 3, 10};
  const auto behind_spring = predict(sprung, m).y;
  for (std::size_t k = 0; k < 4; ++k) CHECK(behind_spring[k] == Approx(slip[k + 2]).epsilon(1e-5));
}

TEST_CASE("behind a soft machine friction relaxes in a hold, and slip precedes the peak", "[measurement]") {
  // b = 0.01, a = 0.005, L = 10 um, k = 1e-3 of the load per um, V = 1 um/s: peaks of an independent integration of
  // dμ/dt = k (V_lp − v), v = v0 e^((μ − μ0 − b ln(θ v0/L))/a), to five digits with noise of 1e-5.
  auto rock = slider_under("ageing", {0.6, 0.005, 0.010, 1e-5, 1e-6}, any_slider, 1e-6, 1);
  rock.contact_stiffness.per_load = 1e3;
  const Measurement hold{Kind::hold, "hold", 1e-6, 1e-6, 1, {10, 30, 100, 300, 1000, 3000}, {}, {}};
  const double peaks[] = {0.60540297, 0.61138244, 0.62043613, 0.63008621, 0.64146622, 0.65220407};
  const auto predicted = predict(rock, hold).y;
  for (std::size_t k = 0; k < 6; ++k) CHECK(std::abs(predicted[k] - peaks[k]) < 4e-5);
}

TEST_CASE("slopes of a step, a hold and a steady curve are the closed forms", "[measurement]") {
  // Ageing law: μ = μ* + a ln(V₂/V*) + b ln(θ V*/L), θ = L/V₂ + (L/V₁ − L/V₂) e^{−V₂t/L}.
  const double a = 0.010, b = 0.015, L = 1e-5, v0 = 1e-6, V1 = 1e-6, V2 = 1e-5;
  const std::vector<std::string> paths = {"law.mu0", "law.a", "law.b", "law.L", "law.contact_stiffness.tangential"};
  const auto step = predict(ageing(), {Kind::velocity_step, "step", V1, V2, 5, {0, 0.3, 1, 4}, {}, {}},
                            {paths.begin(), paths.end() - 1});
  const double times[] = {0, 0.3, 1, 4};
  for (std::size_t k = 0; k < 4; ++k) {
    const double t = times[k], decay = std::exp(-V2 * t / L), age = L / V2 + (L / V1 - L / V2) * decay;
    const double age_L = age / L + (L / V1 - L / V2) * decay * V2 * t / (L * L);
    CHECK(step.slopes[0][k] == Approx(1).epsilon(1e-8));
    CHECK(step.slopes[1][k] == Approx(std::log(V2 / v0)).epsilon(1e-8));
    CHECK(step.slopes[2][k] == Approx(std::log(age * v0 / L)).epsilon(1e-8).margin(1e-9));
    CHECK(step.slopes[3][k] == Approx(b * (age_L / age - 1 / L)).epsilon(1e-8).margin(1e-8 * b / L));
  }
  // At rest θ = L/V + t. A spring takes no part in a steady curve, nor in a hold if it hardly yields.
  auto sprung = ageing();
  sprung.contact_stiffness.tangential = 1e6;
  const auto hold =
      predict(ageing(), {Kind::hold, "hold", V1, V1, 5, {1, 100}, {}, {}}, {paths.begin(), paths.end() - 1});
  for (std::size_t k = 0; k < 2; ++k) {
    const double t = k == 0 ? 1 : 100, age = L / V1 + t;
    CHECK(hold.slopes[2][k] == Approx(std::log(age * v0 / L)).epsilon(1e-8));
    CHECK(hold.slopes[3][k] == Approx(b * (1 / (V1 * age) - 1 / L)).epsilon(1e-8));
  }
  sprung.contact_stiffness.tangential = 1e12;
  const auto stiff = predict(sprung, {Kind::hold, "hold", V1, V1, 5, {1, 100}, {}, {}}, paths);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(stiff.y[k] == Approx(hold.y[k]).epsilon(1e-5));
    CHECK(stiff.slopes[2][k] == Approx(hold.slopes[2][k]).epsilon(1e-4));
  }
  const auto curve = predict(sprung, {Kind::steady_curve, "curve", V1, V1, 5, {V1, V2}, {}, {}}, paths);
  CHECK(curve.y[1] == Approx(0.6 + (a - b) * std::log(V2 / v0)).epsilon(1e-12));
  CHECK(curve.slopes[1][1] == Approx(std::log(V2 / v0)).epsilon(1e-12));
  CHECK(curve.slopes[2][1] == Approx(-std::log(V2 / v0)).epsilon(1e-12));
  CHECK(std::abs(curve.slopes[3][1]) < 1e-8 * b / L);
}

TEST_CASE("a bristle under a recorded motion follows the closed form of its displacement", "[measurement]") {
  // Dahl: μ = μ_d (1 − e^{−s x/μ_d}) over the way x from rest, and, turned back at x₁ with μ₁,
  // μ = −μ_d + (μ_d + μ₁) e^{−s (x₁ − x)/μ_d}: the pace does not matter.
  const double s = 500, mu_d = 0.2, peak = 0.03, N = 40, period = 1;
  Measurement m{Kind::record, "swing", 0, 0, N, {}, {}, {}};
  constexpr int samples = 201;
  for (int k = 0; k < samples; ++k) {
    const double t = period * k / (samples - 1);
    m.history.time.push_back(t);
    m.history.slip_rate.push_back(peak * std::cos(2 * 3.14159265358979 * t / period));
    m.history.normal_load.push_back(N);
  }
  m.x = m.history.time;
  const auto dahl = slider_under("dahl", {s, mu_d}, any_slider, 1, N);
  auto started = m;  // from rest
  started.history.slip_rate.front() = 0;
  const auto friction = predict(dahl, started).y;
  double x = 0, turned_at = 0, at_turn = 0, sign = 1;
  const auto law = [&] {
    return sign * mu_d + (at_turn - sign * mu_d) * std::exp(-s * std::abs(x - turned_at) / mu_d);
  };
  for (std::size_t k = 1; k < std::size_t(samples); ++k) {
    const double dt = m.x[k] - m.x[k - 1], before = started.history.slip_rate[k - 1],
                 now = started.history.slip_rate[k];
    if (before * now < 0) {  // a straight line passes 0 after the part before/(before − now)
      x += before / 2 * dt * before / (before - now);
      at_turn = law(), turned_at = x, sign = -sign;
      x += now / 2 * dt * now / (now - before);
    } else {
      x += (before + now) / 2 * dt;
    }
    CHECK(friction[k] == Approx(law()).epsilon(1e-9));
  }
  // In newton it is N times that; from steady sliding it begins at μ_d.
  started.in_force = true;
  CHECK(predict(dahl, started).y.back() == Approx(N * friction.back()).epsilon(1e-12));
  CHECK(predict(dahl, m).y.front() == Approx(mu_d).epsilon(1e-12));
}

TEST_CASE("friction of a dry law under a record has the sign of slip, and a bound at rest", "[measurement]") {
  const double N = 10;
  Measurement m{Kind::record, "record", 0, 0, N, {0, 1, 2, 3}, {0.1, 0.1, 0.1, -0.5}, {}};
  m.history = {{0, 1, 2, 3}, {0.01, 0, -0.01, 0}, {N, N, N, N}};
  const auto found = predict(slider_under("stribeck", {0.4, 0.2, 0.01, 2.0, 0.0}, any_slider, 1, N), m, {"law.mu_s"});
  const auto& y = found.y;
  const double moving = 0.2 + 0.2 * std::exp(-1.0);
  CHECK(y[0] == Approx(moving));
  CHECK(y[2] == Approx(-moving));
  // At rest friction is bounded by the static limit.
  CHECK(found.bounded == std::vector<char>{0, 1, 0, 1});
  for (const int k : {1, 3}) {
    CHECK(y[std::size_t(k)] == Approx(0.4));
    CHECK(found.slopes[0][std::size_t(k)] == Approx(1));
  }
}

TEST_CASE("programs of several steps are the same over time, over displacement and as a record", "[measurement]") {
  auto rock = slider_under("slip", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-6, 5);
  rock.contact_stiffness.per_load = 3e3;
  Measurement m{Kind::velocity_step, "steps", 1e-6, 1e-5, 5, {-2, 0.5, 1, 3, 4, 4.5, 9}, {}, {}};
  m.step_at = 0.5, m.later = {{3.5, 1e-6}, {5, 3e-6}};
  m.terms.clock_offset = true;
  const std::vector<std::string> paths = {"law.a", "law.L", "law.contact_stiffness.per_load"};
  const auto over_time = predict(rock, m, paths);
  auto by_way = m;
  by_way.over = Measurement::Over::displacement;
  by_way.step_at = 0, by_way.later = {{3e-5, 1e-6}, {3.15e-5, 3e-6}};
  by_way.x = {-2.5e-6, 0, 0.5e-5, 2.5e-5, 3.05e-5, 3.1e-5, 3.15e-5 + 1.2e-5};
  const auto over_displacement = predict(rock, by_way, paths);
  auto recorded = m;
  recorded.kind = Kind::record;
  recorded.history = in_straight_lines({-3, 0.5, 3.5, 5, 10}, {1e-6, 1e-5, 1e-6, 3e-6, 3e-6}, 5);
  const auto record = predict(rock, recorded, paths);
  for (std::size_t k = 0; k < m.x.size(); ++k) {
    CHECK(over_displacement.y[k] == Approx(over_time.y[k]).epsilon(1e-9));
    CHECK(record.y[k] == Approx(over_time.y[k]).epsilon(1e-9));
    for (std::size_t p = 0; p < paths.size(); ++p)
      CHECK(record.slopes[p][k] == Approx(over_time.slopes[p][k]).epsilon(1e-6).margin(1e-12));
  }
  // A clock that is late, against differences; where a step begins there is a corner.
  const double h = 1e-3;
  const auto later = predict(rock, m, {}, h).y, sooner = predict(rock, m, {}, -h).y;
  for (const std::size_t k : {0, 2, 3, 4, 5, 6})
    CHECK(over_time.by_clock[k] == Approx((later[k] - sooner[k]) / (2 * h)).epsilon(1e-4).margin(1e-9));
  // What a trend is multiplied by.
  m.terms.trend = by_way.terms.trend = recorded.terms.trend = Measurement::Terms::Trend::displacement;
  const auto way = trend_abscissa(m), same = trend_abscissa(by_way), from_begin = trend_abscissa(recorded);
  for (std::size_t k = 0; k < m.x.size(); ++k) {
    CHECK(way[k] == Approx(by_way.x[k]).margin(1e-18));
    CHECK(same[k] == by_way.x[k]);
    CHECK(from_begin[k] == Approx(by_way.x[k] + 3.5e-6).margin(1e-18));
  }
  by_way.terms.trend = Measurement::Terms::Trend::time;
  const auto times = trend_abscissa(by_way);
  for (std::size_t k = 0; k < m.x.size(); ++k) CHECK(times[k] == Approx(m.x[k] - 0.5).margin(1e-9));
}

TEST_CASE("a record of sliding, holding and sliding passes through the peak of the hold", "[measurement]") {
  auto rock = slider_under("ageing", {0.6, 0.005, 0.010, 1e-5, 1e-6}, any_slider, 1e-6, 1);
  rock.contact_stiffness.per_load = 1e3;
  const double start = 5, rest = 100, peak = predict(rock, {Kind::hold, "hold", 1e-6, 1e-6, 1, {rest}, {}, {}}).y[0];
  Measurement m{Kind::record, "slide-hold-slide", 0, 0, 1, {}, {}, {}};
  m.history = in_straight_lines({0, start, start + rest, 200}, {1e-6, 0, 1e-6, 1e-6}, 1);
  for (int k = 0; k < 2000; ++k) m.x.push_back(0.1 * k);
  const auto y = predict(rock, m).y;
  CHECK(y.front() == Approx(0.6).epsilon(1e-12));
  CHECK(*std::ranges::max_element(y) == Approx(peak).epsilon(1e-6));
  CHECK(*std::ranges::max_element(y) <= peak * (1 + 1e-9));
  CHECK(*std::ranges::min_element(y) < 0.595);  // it relaxed while it was held
}

TEST_CASE("slopes of friction under a record with a varying load are those of differences", "[measurement]") {
  const auto lugre = slider_under("lugre", {1e3, 2.0, 0.1, 0.25, 0.15, 0.01}, any_slider, 0.1, 50);
  Measurement m{Kind::record, "record", 0, 0, 50, {}, {}, {}};
  for (int k = 0; k <= 100; ++k) {
    m.history.time.push_back(0.01 * k);
    m.history.slip_rate.push_back(0.05 * std::sin(0.09 * k));
    m.history.normal_load.push_back(50 + 20 * std::sin(0.05 * k));
  }
  m.x = {0.013, 0.2, 0.355, 0.5, 0.9};
  m.terms.clock_offset = true;
  const std::vector<std::string> paths = {"law.sigma0", "law.sigma1", "law.sigma2", "law.mu_s", "law.mu_d", "law.v_s"};
  const auto found = predict(lugre, m, paths);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const double value = lugre.get(paths[p]), h = 1e-4 * value;
    const auto up = predict(lugre.with(paths[p], value + h), m).y, down = predict(lugre.with(paths[p], value - h), m).y;
    for (std::size_t k = 0; k < m.x.size(); ++k)
      CHECK(found.slopes[p][k] == Approx((up[k] - down[k]) / (2 * h)).epsilon(1e-5).margin(1e-8 / value));
  }
  const auto later = predict(lugre, m, {}, 1e-5).y, sooner = predict(lugre, m, {}, -1e-5).y;
  for (const std::size_t k : {0, 2})  // between corners of the motion
    CHECK(found.by_clock[k] == Approx((later[k] - sooner[k]) / 2e-5).epsilon(1e-4));
  CHECK(found.steps > 90);
}

TEST_CASE("slopes of every law's predictions are those that changed parameters give", "[measurement]") {
  long compared = 0, answered = 0;
  for (auto model : tests::surrounded_laws()) {
    const double V = 3e-4, N = 2;
    const Measurement measurements[] = {
        {Kind::frequency_response, "response", V, V, N, {0.1, 30}, {}, {}},
        {Kind::velocity_step, "step", V, 3 * V, N, {1e-3, 0.05, 1}, {}, {}},
        {Kind::steady_curve, "curve", V, V, N, {1e-5, V}, {}, {}},
        {Kind::hold, "hold", V, V, N, {0.1, 10}, {}, {}},
    };
    for (const auto& m : measurements) {
      std::vector<std::string> paths;
      for (const auto& quantity : model.parameters()) {
        const double value = model.get(quantity.name);
        const double room = std::min(value - quantity.range.low, quantity.range.high - value);
        if (quantity.name.starts_with("law.") && value != 0 && std::isfinite(value) && room > 0.01 * std::abs(value))
          paths.push_back(quantity.name);
      }
      INFO(model.law->card().name << ", " << m.name << ", lambda " << model.lambda << ", spring "
                                  << model.contact_stiffness.tangential << ", " << model.contact_stiffness.per_load
                                  << ", heated " << (model.law->find("heating.resistance") ? "yes" : "no"));
      Prediction prediction;
      try {
        prediction = predict(model, m, paths);
      } catch (const InputError& error) {
        // Only what has no answer: without states nothing remembers a hold, and a jump of the slip rate may throw a
        // bristle's friction down by more than the damper of its spring takes up.
        CAPTURE(error.what());
        const bool bristle_behind_spring = model.law->deflects() && model.contact_stiffness.present();
        CHECK(((m.kind == Kind::hold && (!model.law->has_states() || model.contact_stiffness.present())) ||
               (m.kind == Kind::velocity_step && bristle_behind_spring)));
        continue;
      }
      ++answered;
      for (std::size_t p = 0; p < paths.size(); ++p) {
        const double value = model.get(paths[p]), h = 2e-3 * std::abs(value);
        const auto at = [&](double change) { return predict(model.with(paths[p], value + change), m).y; };
        const double rounding = 1e-10 * (m.kind == Kind::frequency_response ? N / V : 1) / std::abs(value);
        const auto up = at(h), down = at(-h), far_up = at(2 * h), far_down = at(-2 * h);
        for (std::size_t k = 0; k < prediction.y.size(); ++k) {
          const double near = (up[k] - down[k]) / (2 * h), far = (far_up[k] - far_down[k]) / (4 * h);
          const double difference = (4 * near - far) / 3, uncertain = std::abs(near - far) / 10;
          INFO(paths[p] << " at x[" << k << "]: " << prediction.slopes[p][k] << " against " << difference);
          CHECK(std::abs(prediction.slopes[p][k] - difference) <=
                uncertain + rounding + 1e-6 * (std::abs(difference) + std::abs(prediction.y[k] / value)));
          ++compared;
        }
      }
    }
  }
  CHECK(answered > 300);
  CHECK(compared > 4000);
}
