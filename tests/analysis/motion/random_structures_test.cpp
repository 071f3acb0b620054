/// Structures drawn at random, of two to six set-valued contacts on shared masses: every sample obeys Coulomb's law.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

StructureModel draw(unsigned seed) {
  std::mt19937_64 random(seed);
  const auto real = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const auto whole = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
  const int contacts = whole(2, 6), n = whole(contacts, 6);
  const auto positive = [&](double size, double spread) {
    MatrixXd A(n, n);
    for (double& entry : A.reshaped()) entry = real(-spread, spread);
    return MatrixXd(size * (MatrixXd::Identity(n, n) + A * A.transpose()));
  };
  StructureModel model;
  auto& structure = model.structure;
  structure.M = positive(1, 0.5), structure.K = positive(real(0.5, 3), 0.6), structure.C = positive(0.03, 0.5);
  const double ratio = whole(0, 1) == 0 ? 1 : real(1, 2);  // static over kinetic friction
  for (int i = 0; i < n; ++i) {
    structure.names.push_back("displacement_" + std::to_string(i + 1));
    structure.force.emplace_back(Signal::Harmonics{0, {{real(0, 0.8), real(0.3, 2), real(0, 6)}}});
    model.start.coordinates.emplace_back(real(-1, 1)), model.start.velocities.emplace_back(real(-0.5, 0.5));
  }
  model.start.kind = Start::Kind::given;
  for (int j = 0; j < contacts; ++j) {
    oscillators::FrictionContact contact;
    const double kinetic = real(0.1, 0.5);
    contact.law = laws::find_law("coulomb")->with({ratio * kinetic, kinetic});
    contact.tangential = VectorXd::Unit(n, j);
    for (double& entry : contact.tangential) entry += real(-0.5, 0.5);
    contact.speed = whole(0, 2) == 0 ? 0.0 : real(-0.4, 0.4);
    contact.normal_load = real(0.5, 1.5);
    structure.contacts.push_back(contact);
  }
  structure.check();
  return model;
}

/// What Coulomb's law finds wrong with the samples; empty: nothing.
std::string violation(const Run& run, const StructureModel& model) {
  const auto column = [&](const std::string& name) -> const std::vector<double>& {
    return run.columns[std::size_t(std::ranges::find(run.column_names, name) - run.column_names.begin())];
  };
  for (std::size_t j = 0; j < model.structure.contacts.size(); ++j) {
    const auto& contact = model.structure.contacts[j];
    const std::string number = "_" + std::to_string(j + 1);
    const auto &u = column("slip_rate" + number), &F = column("friction_force" + number);
    const double N = contact.normal_load.level(), kinetic = N * contact.law->steady_friction({1, N}).friction,
                 largest = N * contact.law->static_limit(N);
    for (std::size_t i = 0; i < u.size(); ++i) {
      constexpr double rounding = 1e-9, slow = 1e-7;
      const bool in_law = u[i] == 0 ? std::abs(F[i]) <= largest * (1 + rounding)
                                    : std::abs(F[i] - std::copysign(kinetic, u[i])) <= rounding * kinetic ||
                                          (std::abs(u[i]) < slow && std::abs(F[i]) <= largest * (1 + rounding));
      if (!in_law)
        return "contact " + std::to_string(j + 1) + " at t = " + std::to_string(run.time[i]) + ": slip rate " +
               std::to_string(u[i]) + ", friction " + std::to_string(F[i]) + " of " + std::to_string(kinetic);
    }
  }
  return "";
}

void check_structures(unsigned from, unsigned to) {
  RunOptions options;
  options.duration = 15, options.samples = 1500, options.tolerance = 1e-5;
  long switches = 0;
  for (unsigned seed = from; seed < to; ++seed) {
    INFO("seed " << seed);
    const auto model = draw(seed);
    const auto run = run_structure(model, options);
    INFO(run.outcome.detail);
    // What cannot be followed is said, with a reason.
    if (!run.outcome.complete()) {
      CHECK(run.outcome.ending == Ending::tolerance_not_met);
      CHECK_FALSE(run.outcome.detail.empty());
    }
    CHECK(violation(run, model).empty());
    CHECK(run.metrics.at("energy_residual") < 1e-5);
    switches += long(run.events.size());
  }
  CHECK(switches > 5 * long(to - from));
}

}  // namespace

TEST_CASE("random structures of two to six contacts obey Coulomb's law at every sample, and balance their energy") {
  check_structures(1, 21);
}

TEST_CASE("ten thousand random structures", "[.][long]") { check_structures(1000, 11000); }
