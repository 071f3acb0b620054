/// The pin-on-disk rig: equilibria and eigenvalues of independent computations, published thresholds, and limits.
#include "oscillators/pin_on_disk.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "analysis/steady/structure_stability.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure_system.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using analysis::steady::stability;
using Complex = std::complex<double>;

namespace {

PinOnDisk rig(double pin_stiffness = 2.057e6) {
  PinOnDisk rig;
  rig.pin_stiffness[1] = pin_stiffness;
  rig.normal_law = laws::normal_law(
      laws::PowerContact{.coefficient = 1.25e20, .exponent = 2.5, .bound_coefficient = 1.25e20, .bound_exponent = 2.5});
  return rig;
}

/// With springs and dampers between pin and block in all directions.
PinOnDisk damped_pin() {
  auto damped = rig();
  damped.pin_stiffness = {1.2e6, 2.057e6, 600};
  damped.pin_damping = {100, 130, 0.01};
  return damped;
}

Structure pressed(const PinOnDisk& rig, double load, double mu) {
  FrictionContact contact;
  contact.law = laws::find_law("coulomb")->with({mu, mu});
  contact.speed = 0.46, contact.normal_load = load;
  return pin_on_disk(rig, contact);
}

void check_eigenvalue(const Structure& structure, Complex expected, double part = 1e-6) {
  const auto& all = stability(structure).eigenvalues;
  double nearest = infinity;
  for (const auto& value : all) nearest = std::min(nearest, std::abs(value - expected));
  INFO(expected);
  CHECK(nearest <= part * std::abs(expected));
}

double growth(const Structure& structure) {
  double most = -infinity;
  for (const auto& mode : stability(structure).modes)
    if (mode.eigenvalue.imag() > 1 && mode.eigenvalue.imag() < 5000) most = std::max(most, mode.growth_rate());
  return most;
}

}  // namespace

TEST_CASE("pin on disk with rigid links: equilibrium and eigenvalues") {
  const auto structure = pressed(rig(), 200, 0.25);
  REQUIRE(structure.names == std::vector<std::string>{"pin_normal_displacement", "block_displacement",
                                                      "block_normal_displacement", "block_rotation"});
  const StructureSystem system(structure);
  const auto y = system.steady(0);
  const double expected[] = {-5.0541547590e-06, 4.2124729055e-04, -7.4321380600e-05, 3.0807929785e-04};
  for (int i = 0; i < 4; ++i) CHECK(y[i] == Approx(expected[i]).epsilon(1e-8));
  CHECK(system.normal_load(0, 0, y.data()) == Approx(142.482683554).epsilon(1e-10));
  check_eigenvalue(structure, {0, 137.045693});
  check_eigenvalue(structure, {1.5285661, 793.059465});
  check_eigenvalue(structure, {-1.5285661, 793.059465});
  check_eigenvalue(structure, {0, 176949.783});
  check_eigenvalue(pressed(rig(2.4e6), 15, 0.25), {3.9415651, 793.549679});
  check_eigenvalue(pressed(rig(2.4e6), 10.5, 0.25), {0, 784.683375});
}

TEST_CASE("pin on disk with an elastic, damped pin, and with an elastic disk") {
  const auto damped = pressed(damped_pin(), 200, 0.25);
  const StructureSystem system(damped);
  const auto y = system.steady(0);
  const double expected[] = {4.6031845338e-04, -4.9839885377e-06, 6.3246472618e-04,
                             4.2136394403e-04, -7.4270396136e-05, 3.0023976523e-04};
  for (int i = 0; i < 6; ++i) CHECK(y[i] == Approx(expected[i]).epsilon(1e-8));
  for (const Complex value :
       {Complex{-18.433198, 787.513528}, Complex{4.7870553, 796.825467}, Complex{-21783.639, 6948.43425},
        Complex{-108549.52, 58903.7893}, Complex{-26898.594, 172455.683}})
    check_eigenvalue(damped, value);

  auto disk = damped_pin();
  disk.disk_stiffness = {1e9, 1e9, 1e6}, disk.disk_inertia = 0.1;
  const auto nine = pressed(disk, 200, 0.25);
  REQUIRE(nine.size() == 9);
  for (const Complex value : {Complex{-18.269092, 787.020705}, Complex{4.678716, 796.742221},
                              Complex{-2.6216134, 6461.21964}, Complex{-0.002242962, 3162.4221}})
    check_eigenvalue(nine, value);
  disk.convective = true;
  for (const Complex value :
       {Complex{4.6787149, 796.742177}, Complex{-2.6197108, 6461.22043}, Complex{-0.0042730106, 3162.42168}})
    check_eigenvalue(pressed(disk, 200, 0.25), value);
}

TEST_CASE("pin on disk: loads at which self-excitation begins and ends") {
  struct Case {
    double stiffness, mu, angle, below, above;
  };
  constexpr double degree = 3.14159265358979323846 / 180;
  const auto [stiffness, mu, angle, below, above] =
      GENERATE(Case{2.057e6, 0.25, 0, 187.6068, 187.6088}, Case{2.057e6, 0.30, 0, 114.1261, 114.1281},
               Case{2.4e6, 0.25, 0, 11.5421, 11.5431}, Case{2.057e6, 0.25, -0.005 * degree, 108.511, 108.513},
               Case{2.057e6, 0.25, 0.005 * degree, 324.588, 324.590});
  auto with_angle = rig(stiffness);
  with_angle.angle = angle;
  CHECK(growth(pressed(with_angle, below, mu)) < 1e-3);
  CHECK(growth(pressed(with_angle, above, mu)) > 1e-3);
}

TEST_CASE("pin on disk: without friction the two slider modes cross where normal stiffness in series matches") {
  const auto modes = stability(pressed(rig(2.4e6), 15.1068666, 0)).modes;
  int near = 0;
  for (const auto& mode : modes) near += std::abs(mode.eigenvalue.imag() - 793.667949) < 1e-3 * 793.667949;
  CHECK(near == 2);
}

TEST_CASE("pin on disk: what has no effect is refused") {
  auto given = rig();
  given.pin_damping = {100, 0, 0};
  CHECK_THROWS_WITH(pressed(given, 200, 0.25), Catch::Contains("pin_damping along the track has no effect"));
  given = rig(), given.convective = true;
  CHECK_THROWS_WITH(pressed(given, 200, 0.25), Catch::Contains("convective has no effect"));
}

TEST_CASE("random rigs over six decades: steady sliding balances the load, or is refused with its reason") {
  std::mt19937 draw(7);
  const auto decades = [&](double centre, double width) {
    return centre * std::pow(10.0, width * (2.0 * double(draw()) / double(std::mt19937::max()) - 1));
  };
  int balanced = 0;
  constexpr int rigs = 200;
  for (int i = 0; i < rigs; ++i) {
    auto given = damped_pin();
    for (auto* triple : {&given.arm_stiffness, &given.pin_stiffness})
      for (double& k : *triple) k *= decades(1, 1.5);
    for (double& c : given.pin_damping) c *= decades(1, 3);
    if (i % 2) given.disk_stiffness = {decades(1e8, 2), decades(1e8, 2), decades(1e5, 2)}, given.disk_inertia = 0.1;
    given.angle = decades(1e-4, 2) * (i % 3 - 1);
    const double exponent = 1 + double(i % 7) / 3, coefficient = 1e-3 / std::pow(decades(1e-6, 1), exponent) * 1e10;
    given.normal_law = laws::normal_law(laws::PowerContact{.coefficient = coefficient,
                                                           .exponent = exponent,
                                                           .bound_coefficient = coefficient,
                                                           .bound_exponent = exponent});
    const auto structure = pressed(given, decades(30, 2), decades(0.3, 0.5));
    INFO("rig " << i);
    try {
      const StructureSystem system(structure);
      const auto y = system.steady(0);
      std::vector<double> f(system.size());
      system.evaluate(0, y.data(), f.data());
      const auto& contact = structure.contacts[0];
      const double N = system.normal_load(0, 0, y.data()), away = contact.normal_load.level() - N;
      CHECK(std::isfinite(N));
      // What the contact does not bear, arm and disk do.
      double arm = 0;
      for (int k = 0; k < structure.size(); ++k)
        if (structure.names[k] == "block_normal_displacement") arm = -given.arm_stiffness[1] * y[k];
      CHECK(away == Approx(arm).epsilon(1e-8).margin(1e-10 * contact.normal_load.level()));
      for (const auto& value : stability(structure).eigenvalues)
        CHECK((std::isfinite(value.real()) && std::isfinite(value.imag())));
      ++balanced;
    } catch (const InputError& error) {
      CHECK_THAT(error.what(), Catch::Contains("no steady sliding"));
    }
  }
  CHECK(balanced > rigs / 2);
}
