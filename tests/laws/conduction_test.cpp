/// Conduction from a disc: its exponentials against the closed kernel, in time and frequency, and in the laws that use
/// it.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/motion/run.hpp"
#include "analysis/response/frf.hpp"
#include "laws/catalogue.hpp"
#include "laws/heating.hpp"

using namespace rosin;
using Complex = std::complex<double>;

namespace {

/// Rise of the disc's centre after the onset of even heating, over its end; x = κt/r² (Carslaw & Jaeger, 1959, 10.5).
double rise(double x) {
  const double z = 1 / (2 * std::sqrt(x)), pi_root = std::sqrt(std::numbers::pi);
  return 2 * std::sqrt(x) * (-std::expm1(-z * z) / pi_root + z * std::erfc(z));
}
/// Its Laplace transform, times s.
Complex response(Complex s) { return (1.0 - std::exp(-std::sqrt(s))) / std::sqrt(s); }

double rise_of_modes(double x) {
  double sum = 0;
  for (const auto& mode : laws::disc) sum -= mode.share * std::expm1(-x / mode.time);
  return sum;
}
Complex response_of_modes(Complex s) {
  Complex sum = 0;
  for (const auto& mode : laws::disc) sum += mode.share / (1.0 + s * mode.time);
  return sum;
}

/// Z of friction μ(T) that falls by `mu_T` per kelvin, a heat balance dq = ν μ dv …, and a kernel H, at load N.
struct Balance {
  double mu, mu_T, rise, V, N, h0, h1, crowding;
  Complex Z(Complex H) const {
    return N * mu_T * H * (crowding * mu - h1 * rise) / (h0 + H * V * (h1 - crowding * mu_T));
  }
};

}  // namespace

TEST_CASE("ten exponentials stand for a disc with the error that is stated", "[laws][conduction]") {
  double sum = 0, worst = 0, worst_response = 0;
  for (const auto& mode : laws::disc) {
    CHECK(mode.share > 0);
    sum += mode.share;
  }
  CHECK(sum == Approx(1).epsilon(1e-15));
  for (double x = laws::disc_from; x < 1e9; x *= 1.01)
    worst = std::max(worst, std::abs(rise_of_modes(x) / rise(x) - 1));
  for (double omega = 1e-6; omega < 1 / laws::disc_from; omega *= 1.01)
    worst_response = std::max(worst_response, std::abs(response_of_modes({0, omega}) / response({0, omega}) - 1.0));
  CHECK(worst < laws::disc_error);
  CHECK(worst > 0.95 * laws::disc_error);
  CHECK(worst_response < laws::disc_response_error);
  CHECK(worst_response > 0.95 * laws::disc_response_error);
  const std::string said(laws::disc_approximation);
  for (const auto& number :
       {fmt::format("within {:.3g} %", 100 * laws::disc_error),
        fmt::format("within {:.3g} %", 100 * laws::disc_response_error), fmt::format("from {} r2", laws::disc_from),
        fmt::format("= {} kappa", 1 / laws::disc_from)})
    CHECK_THAT(said, Catch::Contains(number));
  // The shares are those of least squares: no exchange between two of them brings the sum of squares down.
  const auto squares = [](int raised, int lowered, double by) {
    double total = 0;
    const auto changed = [&](auto of_mode) {
      return by * (of_mode(laws::disc[raised]) - of_mode(laws::disc[lowered]));
    };
    for (int i = 0; i < 400; ++i) {
      const double x = std::pow(10, -3 + 10 * i / 399.0), omega = std::pow(10, -5 + 8 * i / 399.0);
      const double late = changed([&](const auto& m) { return -std::expm1(-x / m.time); });
      const Complex s(0, omega), swing = changed([&](const auto&m) { return 1.0 / (1.0 + s * m.time); });
      total += std::norm((rise_of_modes(x) + late) / rise(x) - 1) +
               std::norm((response_of_modes(s) + swing) / response(s) - 1.0);
    }
    return total;
  };
  for (int k = 1; k < laws::disc_modes; ++k)
    for (const double by : {1e-4, -1e-4}) CHECK(squares(k, k - 1, by) > squares(0, 0, 0));
}

TEST_CASE("between its corners a disc answers an oscillation like a half-space", "[laws][conduction]") {
  for (const double omega : {30.0, 100.0, 300.0, 900.0}) {
    const Complex H = response_of_modes({0, omega}) * std::sqrt(Complex(0, omega));
    CHECK(std::abs(H - 1.0) < laws::disc_response_error + 1.1 * std::exp(-std::sqrt(omega / 2)));
  }
}

TEST_CASE("thermal-disc: its frequency response is that of the closed kernel", "[laws][conduction]") {
  const double V = 0.1, t = 1e-3, h0 = 1e-3, h1 = 8e-3;
  oscillators::Model model;
  for (const auto& [m, s, N] : {std::tuple{1.0, 0.0, 2.0}, {0.0, 0.0, 1.1}, {1.0, 1.0, 1.44}}) {
    CAPTURE(m, s, N);
    model.law = laws::find_law("thermal-disc")->with("area_exponent", m)->with("size_exponent", s);
    model.drive = {.speed = V, .normal_load = N, .force = 0.0};
    // T of the calibrating curve at N_ref = 1 N: ΔT = μ w/(h0 + h1 w), found from the balance by bisection.
    const double crowding = std::pow(N, 1 - m + s / 2), grown = std::pow(N, s);
    const auto mu = [](double w) { return 0.35 + 0.4 * std::exp(-w / 0.01) + 0.45 * std::exp(-w / 0.1); };
    const auto dT = [&](double w) { return mu(w) * w / (h0 + h1 * w); };
    double low = 0, high = 100;
    for (int i = 0; i < 200; ++i) {
      const double w = (low + high) / 2;
      (dT(w) > crowding * mu(w) * V / (h0 + h1 * V) ? high : low) = w;
    }
    const double w = low, h = 1e-4 * w;
    const double mu_T = (mu(w + h) - mu(w - h)) / (dT(w + h) - dT(w - h));
    const Balance balance{mu(w), mu_T, dT(w), V, N, h0, h1, crowding};
    const analysis::response::FrictionResponse found(model);
    CHECK(found.friction_coefficient() == Approx(mu(w)).epsilon(1e-12));
    CHECK(found.limits().low == Approx(balance.Z(1).real()).epsilon(1e-6));
    for (double x = 1e-4; x < 1e3; x *= 3) {
      const Complex i(0, x / (t * grown)), Z = found.tangential(i);
      CAPTURE(x);
      CHECK(std::abs(Z / balance.Z(response_of_modes({0, x})) - 1.0) < 1e-6);  // slopes of the curve are differences
      CHECK(std::abs(Z / balance.Z(response({0, x})) - 1.0) < 1.5 * laws::disc_response_error);
    }
  }
  CHECK_THROWS_WITH(laws::find_law("thermal-disc")->with("size_exponent", 0.5)->with("area_exponent", 0.2),
                    Catch::Contains("size_exponent"));
}

TEST_CASE("heat spreads from a contact into depth as from a disc", "[laws][conduction]") {
  const double R = 30, t = 0.2, soft = 1e6, mu = 0.3, N = 1.7, V1 = 0.01, V2 = 0.05;  // no feedback
  oscillators::Model model;
  model.law = laws::heated(laws::find_law("ageing")->with({mu, 0.01, 0.0, 1e-5, 1e-3}), {R, t, soft, laws::disc});
  model.slider = {0, infinity, 0};
  model.drive = {Signal(Signal::Steps{{{0, V1}, {1, V2}}}), N, 0.0};
  analysis::motion::RunOptions how;
  how.duration = 1e4;
  for (const double x : {1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3}) how.times.push_back(1 + x * t);
  how.tolerance = 1e-10;
  const auto record = analysis::motion::run(model, how);
  REQUIRE(record.outcome.complete());
  const auto at = std::ranges::find(record.column_names, "temperature_rise") - record.column_names.begin();
  const double before = R * N * V1 * (mu + 0.01 * std::log(V1 / 1e-3)),
               after = R * N * V2 * (mu + 0.01 * std::log(V2 / 1e-3));
  for (std::size_t i = 0; i < how.times.size(); ++i) {
    const double risen = (record.columns[at][i] - before) / (after - before), x = (how.times[i] - 1) / t;
    CHECK(risen == Approx(rise(x)).epsilon(laws::disc_error));
    CHECK(risen == Approx(rise_of_modes(x)).epsilon(1e-5));
  }
}

TEST_CASE("Coulomb friction that conducts like a disc has the impedance of the closed kernel", "[laws][conduction]") {
  const double R = 30, t = 0.4, soft = 5, mu = 0.3, N = 1.7, V = 0.3;
  oscillators::Model model;
  model.law = laws::heated(laws::find_law("coulomb")->with(std::vector<Value>{mu, mu}), {R, t, soft, laws::disc});
  model.drive = {.speed = V, .normal_load = N, .force = 0.0};
  const analysis::response::FrictionResponse found(model);
  const double h = 0.5 * (1 + std::sqrt(1 + 4 * R * N * mu * V / soft)), F = N * mu / h;
  for (double x = 1e-3; x < 1e3; x *= 7) {
    const auto Z = [&](Complex H) { return -F * F * R * H / (h * soft) / (1.0 + R * V * F * H / (h * soft)); };
    const Complex answer = found.tangential({0, x / t});
    CHECK(std::abs(answer / Z(response_of_modes({0, x})) - 1.0) < 1e-12);
    CHECK(std::abs(answer / Z(response({0, x})) - 1.0) < laws::disc_response_error);
  }
}
