/// Structures with friction: the single slider's critical load, and Nyquist against eigenvalues on random structures.
#include "analysis/structure.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/stability.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using oscillators::Model;
using tests::any_slider;
using tests::bristol_board;
using tests::slider_under;
using Complex = std::complex<double>;

namespace {

const Structure single{{1}, {0}, {1.09}, {{{1}, {}}}};

}  // namespace

TEST_CASE("the single slider gives its critical load, rigid and behind a contact spring", "[structure]") {
  for (const auto& [stiffness, load] : {std::pair{infinity, 4.0877514056773e-4}, std::pair{0.5, 1.8372063200725e-4}}) {
    auto model = bristol_board(1e-4, 10);
    model.contact_stiffness.tangential = stiffness;
    const auto found = critical_values({.form = single, .model = model, .normal = {}}, "drive.normal_load", 1e-5, 1e-1);
    REQUIRE(found.size() == 1);
    CHECK(found.front().value == Approx(load).epsilon(1e-9));
    CHECK(found.front().angular_frequency == Approx(0.69102017882153).epsilon(1e-6));
    for (const double part : {0.98, 1.02}) {
      const auto loop = close_loop(single, model.with("drive.normal_load", part * load));
      CHECK(loop.stable == (part < 1));
      CHECK(loop.unstable_by_nyquist == (part < 1 ? 0 : 2));
    }
  }
}

TEST_CASE("eigenvalues are those of the slider", "[structure]") {
  for (const char* law : {"ageing", "spinodal", "two-state-slip", "lugre", "stribeck"}) {
    auto model =
        slider_under(law, laws::find_law(law)->values(), {.mass = 2, .stiffness = 300, .damping = 0.4}, 1e-3, 3);
    const auto expected = stability(model).eigenvalues;
    const auto found = close_loop({{2}, {0.4}, {300}, {{{1}, {}}}}, model).eigenvalues;
    INFO(law);
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      CHECK(std::abs(found[i] - expected[i]) <= 1e-7 * std::abs(expected[i]));
  }
}

TEST_CASE("Nyquist and eigenvalues agree on 1000 random structures", "[structure][long]") {
  std::mt19937 random(7);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
  const auto decades = [&](double a, double b) { return std::pow(10, uniform(std::log10(a), std::log10(b))); };
  const std::vector<const char*> laws = {"ageing", "spinodal", "two-state-ageing", "lugre", "stribeck", "coulomb"};
  int stable = 0, unstable = 0, uncounted = 0;
  for (int k = 0; k < 1000; ++k) {
    const char* law = laws[std::size_t(k) % laws.size()];
    auto model = slider_under(law, laws::find_law(law)->values(), any_slider, decades(1e-6, 1e-2), decades(0.01, 100));
    const int n = 1 + k % 4, contacts = 1 + (k / 4) % 2;
    Structure s;
    std::vector<double> root(std::size_t(n) * n), stiff(root.size());
    for (auto* list : {&root, &stiff})
      for (double& x : *list) x = uniform(-1, 1);
    const double scale = decades(10, 1e5);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        double m = i == j ? 0.3 : 0, stiffness = i == j ? 0.3 : 0;
        for (int l = 0; l < n; ++l) {
          m += root[std::size_t(i * n + l)] * root[std::size_t(j * n + l)];
          stiffness += stiff[std::size_t(i * n + l)] * stiff[std::size_t(j * n + l)];
        }
        s.M.push_back(m), s.K.push_back(scale * stiffness);
      }
    const double loss = decades(1e-4, 1e-2) / std::sqrt(scale);
    for (const double x : s.K) s.C.push_back(loss * x);
    const bool pressed = k % 3 == 0;
    for (int c = 0; c < contacts; ++c) {
      Structure::Contact contact;
      for (int i = 0; i < n; ++i) contact.tangential.push_back(uniform(-1, 1));
      for (int i = 0; pressed && i < n; ++i) contact.normal.push_back(uniform(-1, 1));
      s.contacts.push_back(contact);
    }
    const NormalContact normal{.stiffness = scale * decades(0.1, 3), .damping = 0, .lift = 0};
    const auto loop = close_loop(s, model, normal);
    INFO(k << ": " << law << ", " << n << " coordinates, " << contacts << " contacts, pressed " << pressed);
    if (loop.unstable_by_nyquist < 0) {
      ++uncounted;
      CHECK(std::abs(loop.eigenvalues.front().real()) < 1e-6 * std::abs(loop.eigenvalues.front()));
      continue;
    }
    CHECK(loop.unstable_by_nyquist == loop.unstable_by_eigenvalues);
    (loop.stable ? stable : unstable)++;
  }
  CHECK(stable > 100);
  CHECK(unstable > 100);
  CHECK(uncounted < 10);
}

TEST_CASE("modes are matrices, and 1 + L is what the margin measures", "[structure]") {
  const double turn = 2 * std::numbers::pi;
  const auto s = modal({{100 / turn, 0.01, 0.5, 1.0}, {270 / turn, 0.02, 0.2, -0.6}});
  const Complex at(0, 130);
  const Complex H = 1.0 / (0.5 * (at * at + 2 * 0.01 * 100.0 * at + 1e4)) +
                    0.36 / (0.2 * (at * at + 2 * 0.02 * 270.0 * at + 270.0 * 270.0));
  CHECK(std::abs(receptance(s, at) - H) < 1e-13 * std::abs(H));
  const auto model = slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-3, 5);
  const FrictionResponse friction(model);
  const auto loop = close_loop(s, model);
  const Complex critical(0, loop.margin_frequency);
  CHECK(loop.margin ==
        Approx(std::abs(1.0 + critical * friction.tangential(critical) * receptance(s, critical))).epsilon(1e-9));
  // The same from tables that sample the loop densely.
  for (const double load : {0.5, 5.0, 500.0}) {
    const auto loaded = model.with("drive.normal_load", load);
    const FrictionResponse there(loaded);
    std::vector<double> hertz;
    std::vector<Complex> Z, receptances;
    for (int i = 0; i <= 40000; ++i) {
      hertz.push_back(1e-2 * std::pow(10, i / 8000.0));
      const Complex jw(0, 2 * std::numbers::pi * hertz.back());
      Z.push_back(there.tangential(jw)), receptances.push_back(receptance(s, jw));
    }
    const auto table = close_table(hertz, Z, receptances);
    CHECK(table.resolved);
    CHECK(table.unstable == close_loop(s, loaded).unstable_by_eigenvalues);
  }
}

TEST_CASE("mode coupling under Coulomb friction: two modes merge at the friction that theory names", "[structure]") {
  // Two equal masses; a normal spring k_n couples: K_c = [k1, -μ k_n; 0, k2 + k_n] cannot flutter; with an oblique
  // spring K = [k11, k12 − μ k_n; k12, k22 + k_n], det: flutter where (k12 − μ k_n) k12 < −((k11 − k22')/2)².
  const double k11 = 11e3, k22 = 0, k12 = -5e3, k_n = 10e3, m = 1;
  const double half = (k11 - (k22 + k_n)) / 2;
  const double critical = (k12 + half * half / k12) / k_n;  // negative: sliding the other way
  Structure s{{m, 0, 0, m}, {0, 0, 0, 0}, {k11, -k12, -k12, k22}, {{{1, 0}, {0, 1}}}};
  // with the sign of x turned, μ_c = −critical
  const NormalContact normal{.stiffness = k_n};
  for (const double part : {0.97, 1.03}) {
    const double mu = -critical * part;
    const auto loop = close_loop(s, slider_under("coulomb", {mu, mu}, any_slider, 1, 100), normal);
    const double growth = loop.eigenvalues.front().real();
    INFO(mu << ": " << growth);
    CHECK((growth > 1) == (part > 1));
  }
}

TEST_CASE("uncertain inputs move stability by as much as their spread", "[structure]") {
  auto model = bristol_board(4.0877514056773e-4 / tests::gravity, 10);
  // At the critical load itself any spread of load makes half of the samples unstable.
  const auto spread =
      propagate({.form = single, .model = model, .normal = {}}, {{"drive.normal_load", 0.1}, {"law.mu0", 0.1}}, 400, 3);
  CHECK(std::abs(spread.probability - 0.5) < 4 * spread.standard_error);
  CHECK(spread.influence[0] > 0.99);
  CHECK(std::abs(spread.influence[1]) < 0.2);  // the mean coefficient does not matter
  CHECK(spread.low < 0);
  CHECK(spread.high > 0);
}

TEST_CASE("parameters of the structure move stability as those of the model do", "[structure]") {
  // At the damping that is critical half of the samples are unstable, and more damping is more stable.
  const auto model = bristol_board(1e-3 / tests::gravity, 10);
  const double omega = std::sqrt(1.09);
  const SlidingStructure sliding{std::vector<Mode>{{omega / (2 * std::numbers::pi), 1e-3, 1, 1}}, model, {}};
  const auto critical = critical_values(sliding, "structure.modes.1.damping_ratio", 1e-6, 1);
  REQUIRE(critical.size() == 1);
  const auto at_it = sliding.with("structure.modes.1.damping_ratio", critical[0].value);
  CHECK(at_it.get("structure.modes.1.damping_ratio") == critical[0].value);
  // The same damping on the slider makes the load critical.
  auto slider = sliding.model;
  slider.slider = {.mass = 1, .stiffness = 1.09, .damping = 2 * critical[0].value * omega};
  CHECK(std::abs(stability(slider).eigenvalues.front().real()) < 1e-9);
  const auto spread = propagate(at_it, {{"structure.modes.1.damping_ratio", 0.1}, {"law.mu0", 0.1}}, 400, 3);
  CHECK(std::abs(spread.probability - 0.5) < 4 * spread.standard_error);
  CHECK(spread.influence[0] < -0.99);
  CHECK_THROWS_WITH(sliding.describe("structure.modes.1.damping"), Catch::Contains("structure.modes.1.damping_ratio"));
  CHECK_THROWS_WITH(sliding.with("structure.modes.1.mass", -1), Catch::Contains("is outside"));

  // The model's own slider as the structure follows its parameters, and factors scale matrices.
  const SlidingStructure own{{}, slider, {}};
  CHECK(own.with("oscillator.mass", 3.0).structure().M[0] == 3);
  const SlidingStructure matrices{Structure{{1}, {0}, {1.09}, {{{1}, {}}}}, model, {}};
  CHECK(matrices.with("structure.K", 2.0).structure().K[0] == Approx(2.18));
}
