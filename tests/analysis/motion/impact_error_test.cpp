/// Stated errors of impacts against the closed form of Hunt and Crossley.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "analysis/motion/structure_run.hpp"
#include "oscillators/structure.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

/// Speed of rebound where the force is c aⁿ (1 + β ȧ): g(v₀) = g(−v) with g(v) = v/β − ln(1 + β v)/β², by halves.
double rebound(double v0, double beta) {
  if (beta == 0) return v0;
  const auto g = [&](long double v) {
    const long double b = beta;
    return v / b - std::log1p(b * v) / (b * b);
  };
  long double low = 0, high = v0;
  for (int i = 0; i < 80; ++i) {
    const long double middle = 0.5L * (low + high);
    (g(-middle) < g(v0) ? low : high) = middle;
  }
  return double(low);
}

}  // namespace

TEST_CASE("stated errors of two hundred impacts on power-law contacts cover the closed form", "[impact-errors]") {
  std::mt19937_64 random(7);
  const auto real = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const auto one_of = [&](std::initializer_list<double> values) {
    return values.begin()[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random)];
  };
  for (int k = 0; k < 200; ++k) {
    const double m = real(0.2, 3), c = std::pow(10, real(2, 7)), n = one_of({1, 1.2, 1.5, 1.5, 1.7, 2, 2.5, 3});
    const double v0 = real(0.05, 2), beta = k % 2 ? 0 : real(0.05, 0.6) / v0, flight = k % 3 ? real(0, 0.05) : 0;
    StructureModel model;
    auto& structure = model.structure;
    structure.M = MatrixXd::Constant(1, 1, m), structure.C = structure.K = MatrixXd::Zero(1, 1);
    structure.names = {"approach"};
    auto contact = oscillators::frictionless_contact(VectorXd::Ones(1),
                                                     laws::normal_law(laws::PowerContact{.coefficient = c,
                                                                                         .exponent = n,
                                                                                         .damping = beta * c,
                                                                                         .separation_damping = beta * c,
                                                                                         .damping_exponent = n,
                                                                                         .bound_coefficient = c,
                                                                                         .bound_exponent = n}));
    contact.normal_load = 0.0;
    structure.contacts = {contact};
    model.start.kind = Start::Kind::given;
    model.start.coordinates = {-flight}, model.start.velocities = {v0};
    const double deepest = std::pow((n + 1) * m * v0 * v0 / (2 * c), 1 / (n + 1));
    RunOptions options;
    options.duration = (flight + 8 * deepest) / v0, options.samples = 10;
    options.tolerance = one_of({1e-6, 1e-8, 1e-9, 1e-10, 1e-11});
    const auto run = run_structure(model, options);
    INFO("impact " << k << ": exponent " << n << ", tolerance " << options.tolerance << " " << run.outcome.detail);
    REQUIRE(run.outcome.complete());
    const double off = std::abs(run.columns[1].back() + rebound(v0, beta));
    CHECK(off <= run.column_error[1]);
    CHECK(off <= options.tolerance * v0);
  }
}
