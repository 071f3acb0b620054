/// Branches drawn at random, whose events are known from closed forms and from eigenvalues of equations written anew;
/// multipliers against Liouville's formula.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "analysis/branches/branches.hpp"
#include "core/eigenpairs.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"
#include "oscillators/structure.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::branches;
using Eigen::MatrixXd, Eigen::VectorXd;
using oscillators::Model;
using tests::board_under;

namespace {

/// The library's distributions differ from one standard library to the next.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double real(double low, double high) { return low + (high - low) * double(random_() >> 11) * 0x1p-53; }
  double log(double low, double high) { return std::exp(real(std::log(low), std::log(high))); }
  int whole(int low, int high) { return low + int(random_() % unsigned(high - low + 1)); }

 private:
  std::mt19937_64 random_;
};

/// None is missed, none is false, each within its error.
void check(const std::vector<rosin::analysis::steady::Crossing>& found, const std::vector<double>& wanted,
           double accuracy) {
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    INFO("wanted " << fmt::format("{:.15g}, found {:.15g} ± {:.1e}", wanted[i], found[i].value, found[i].error));
    CHECK(std::abs(found[i].value - wanted[i]) <= found[i].error + accuracy * wanted[i]);
    CHECK(found[i].error < 1e-6 * wanted[i]);
  }
}

/// Along stiffness, load or speed of a slider under rate-and-state friction: k = N (b − a)/L (1 + m V²/(N a L)) where
/// steady sliding loses its stability (Rice & Ruina 1983).
void check_sliders(unsigned from, unsigned to) {
  for (unsigned seed = from; seed < to; ++seed) {
    Dice dice(seed);
    const char* laws[] = {"ageing", "slip", "prz"};
    const char* law = laws[dice.whole(0, 2)];
    const double a = dice.log(0.005, 0.03), b = a * dice.real(1.1, 2.5), L = dice.log(1e-3, 0.3), mu0 = 0.6,
                 m = dice.log(0.1, 10), N = dice.log(0.3, 30), V = dice.log(1e-3, 1);
    const double k = N * (b - a) / L * (1 + m * V * V / (N * a * L));
    Model model;
    model.law = laws::find_law(law)->with({mu0, a, b, L, 0.05});
    model.slider = {m, k, 0};
    model.drive.speed = V, model.drive.normal_load = N;
    const int path = dice.whole(0, 2);
    const char* paths[] = {"oscillator.stiffness", "drive.normal_load", "drive.speed"};
    const double value = path == 0 ? k : path == 1 ? N : V, below = dice.log(1.2, 10), above = dice.log(1.2, 10);
    BranchOptions options;
    options.parameter = {value / below, value * above, dice.whole(0, 1) == 1};
    options.most_points = 2;
    INFO("slider " << seed << ", " << law << " along " << paths[path]);
    const Family family = [&](double p) { return oscillator_of(model.with(paths[path], p)); };
    check(from_steady_sliding(family, options, crossings_of(model, paths[path], options.parameter)).crossings, {value},
          1e-13);
    check(from_steady_sliding(family, options).crossings, {value}, 1e-13);
  }
}

/// A structure whose contacts creep, and the largest growth rate of its steady sliding by equations in q, q̇ and
/// ln(θV/L): δμ = a δv/V + b δw, δẇ = −(V δw + δv)/L.
struct Creeping {
  MatrixXd M, C, K;
  struct Contact {
    VectorXd t;
    double a, b, L, V, N;
    const char* law;
  };
  std::vector<Contact> contacts;

  explicit Creeping(Dice& dice) {
    const int n = dice.whole(1, 4), count = dice.whole(1, std::min(n, 3));
    const auto positive = [&](double size) {
      MatrixXd A(n, n);
      for (double& entry : A.reshaped()) entry = dice.real(-0.5, 0.5);
      return MatrixXd(size * (MatrixXd::Identity(n, n) + A * A.transpose()));
    };
    M = positive(1), C = positive(dice.log(0.001, 0.05)), K = positive(dice.real(0.5, 3));
    for (int j = 0; j < count; ++j) {
      Contact contact;
      contact.t = VectorXd::Unit(n, j);
      for (double& entry : contact.t) entry += dice.real(-0.4, 0.4);
      contact.a = dice.log(0.008, 0.03), contact.b = contact.a * dice.real(0.5, 2.5), contact.L = dice.log(0.01, 0.2);
      contact.V = dice.log(0.02, 0.3), contact.N = dice.log(0.3, 3);
      contact.law = dice.whole(0, 1) ? "ageing" : "slip";
      contacts.push_back(contact);
    }
  }
  /// Loads or speeds by a factor.
  oscillators::Structure structure(double loads, double speeds) const {
    oscillators::Structure structure;
    structure.M = M, structure.C = C, structure.K = K;
    for (Eigen::Index i = 0; i < M.rows(); ++i) structure.names.push_back(fmt::format("displacement_{}", i + 1));
    for (const auto& of : contacts) {
      oscillators::FrictionContact contact;
      contact.law = laws::find_law(of.law)->with({0.6, of.a, of.b, of.L, 0.05});
      contact.tangential = of.t, contact.speed = of.V * speeds, contact.normal_load = of.N * loads;
      structure.contacts.push_back(contact);
    }
    return structure;
  }
  double growth(double loads, double speeds) const {
    const Eigen::Index n = M.rows(), m = Eigen::Index(contacts.size());
    const MatrixXd W = M.inverse();
    MatrixXd J = MatrixXd::Zero(2 * n + m, 2 * n + m);
    J.block(0, n, n, n).setIdentity();
    J.block(n, 0, n, n) = -W * K, J.block(n, n, n, n) = -W * C;
    for (Eigen::Index j = 0; j < m; ++j) {
      const auto& [t, a, b, L, V0, N0, law] = contacts[std::size_t(j)];
      const double V = V0 * speeds, N = N0 * loads;
      J.block(n, n, n, n) -= W * t * t.transpose() * (N * a / V);
      J.block(n, 2 * n + j, n, 1) += W * t * (N * b);
      J.block(2 * n + j, n, 1, n) += t.transpose() / L;
      J(2 * n + j, 2 * n + j) = -V / L;
    }
    return J.eigenvalues().real().maxCoeff();
  }
};

int check_structures(unsigned from, unsigned to) {
  int events = 0;
  for (unsigned seed = from; seed < to; ++seed) {
    Dice dice(seed);
    const Creeping drawn(dice);
    const bool along_loads = dice.whole(0, 1) == 1;
    const auto growth = [&](double p) { return drawn.growth(along_loads ? p : 1, along_loads ? 1 : p); };
    BranchOptions options;
    options.parameter = {0.1, 10, true};
    options.most_points = 2;
    std::vector<double> wanted;
    constexpr int parts = 2000;
    const auto place = [](int i) { return 0.1 * std::pow(100.0, double(i) / parts); };
    for (int i = 1; i <= parts; ++i) {
      double low = place(i - 1), high = place(i);
      const bool grows = growth(low) > 0;
      if (grows == (growth(high) > 0)) continue;
      for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        ((growth(middle) > 0) == grows ? low : high) = middle;
      }
      wanted.push_back((low + high) / 2);
    }
    INFO("structure " << seed << (along_loads ? " along its loads" : " along its speeds"));
    check(
        from_steady_sliding(
            [&](double p) { return oscillator_of(drawn.structure(along_loads ? p : 1, along_loads ? 1 : p)); }, options)
            .crossings,
        wanted, 1e-11);
    events += int(wanted.size());
  }
  return events;
}

/// The trace of the linearised flow, integrated over a cycle that begins at y.
double divergence(Oscillator& oscillator, std::vector<double> y, double period) {
  auto& system = oscillator.system();
  const int n = system.size();
  std::vector<double> f(n), stage(n);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(n, n);
  VectorXd mass(n), scale(n);
  double sum = 0;
  auto follower = oscillator.follower(1e-11);
  follower.observe = [&](auto& step, auto) {
    for (int i = 0; i < solvers::steps::Collocation::stages; ++i) {
      step.stage(i, stage.data());
      const double t = step.stage_time(i);
      system.linearise(t, stage.data(), f.data(), J.data());
      system.mass(t, mass.data());
      system.scale(stage.data(), scale.data());
      sum += solvers::steps::RadauTableau::get().b[i] * step.length() * moving_part(J, mass, scale).A.trace();
    }
  };
  REQUIRE(follower.follow(0, y, period).complete());
  return sum;
}

int check_liouville(const Branches& found, const Family& family) {
  int points = 0;
  for (const auto& cycle : found.cycles)
    for (const auto& point : cycle.branch.points) {
      const auto& z = point.view.multipliers;
      const auto& error = point.view.multiplier_errors;
      REQUIRE(!z.empty());
      REQUIRE(error.size() == z.size());
      const auto oscillator = family(point.p);
      const double wanted = divergence(*oscillator, point.view.start, point.view.metrics.at("period"));
      double sum = 0, known = 1e-7 * (1 + std::abs(wanted));
      for (std::size_t i = 0; i + 1 < z.size(); ++i)
        sum += std::log(std::abs(z[i])), known += error[i] / std::abs(z[i]);
      // The smallest by itself: it may be below all numbers.
      const double last = std::exp(wanted - sum);
      INFO("at " << point.p << ": " << std::abs(z.back()) << " ± " << error.back() << ", by Liouville " << last);
      CHECK(std::abs(std::abs(z.back()) - last) <= error.back() + last * std::expm1(known));
      ++points;
    }
  return points;
}

}  // namespace

TEST_CASE("Hopf points of random sliders and structures are those of closed forms and of eigenvalues",
          "[branches][known_events]") {
  check_sliders(1, 7);
  check_structures(1, 7);
}

TEST_CASE("sixty branches have the Hopf points of closed forms and of eigenvalues, and no others",
          "[long][branches][known_events]") {
  check_sliders(100, 130);
  CHECK(check_structures(100, 130) > 20);
}

TEST_CASE("multipliers of a branch multiply to the exponential of the trace's integral",
          "[branches][known_events][long]") {
  struct Along {
    Model model;
    const char* path;
    ParameterScale range;
  };
  for (const auto& [model, path, range] : {Along{board_under(1e-4, 10, 1e-5), "drive.normal_load", {1e-4, 1e-2, true}},
                                           Along{board_under(9.81e-2, 1, 3e-4), "drive.speed", {4e-4, 5e-3, true}}}) {
    const Family family = [&model, &path](double p) { return oscillator_of(model.with(path, p)); };
    BranchOptions options;
    options.parameter = range;
    INFO(path);
    CHECK(check_liouville(from_steady_sliding(family, options, crossings_of(model, path, range)), family) > 20);
  }
}
