/// Surfaces that are not flat: their heights and spectra, and contacts that ride on them, against closed forms and an
/// independent integrator.
#include "oscillators/profile.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/pin_on_disk.hpp"
#include "oscillators/station_forces.hpp"
#include "oscillators/structure_system.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::Vector2d, Eigen::VectorXd;
using std::numbers::pi;
using Complex = std::complex<double>;

namespace {

/// A mass on springs along a track (mass, damping, stiffness of each direction), pressed on it by N₀.
struct Rider {
  Vector2d mass, damping, stiffness;
  double load, speed;
  std::shared_ptr<const FrictionLaw> law;
  std::shared_ptr<const NormalLaw> contact;

  analysis::motion::StructureModel over(const Profile& profile) const {
    Structure structure;
    structure.M = mass.asDiagonal(), structure.C = damping.asDiagonal(), structure.K = stiffness.asDiagonal();
    structure.names = {"along", "normal"};
    FrictionContact rides;
    rides.law = law;
    rides.tangential = Vector2d{1, 0}, rides.normal = Vector2d{0, 1};
    rides.speed = speed, rides.normal_load = load;
    rides.normal_law = std::make_shared<OverProfile>(contact, profile, speed);
    structure.contacts = {rides};
    structure.check();
    return {std::move(structure), {}};
  }
  analysis::cycles::StructureCycle cycle(const Profile& profile, double tolerance = 1e-10) const {
    return analysis::cycles::find_cycle(over(profile), {.tolerance = tolerance, .multipliers = false});
  }
};

std::shared_ptr<const FrictionLaw> coulomb(double mu) { return laws::find_law("coulomb")->with({mu, mu}); }

double value(const analysis::cycles::StructureCycle& cycle, const std::string& name) {
  REQUIRE(cycle.outcome.complete());
  return cycle.metrics.at(name).value;
}

/// Of friction that is a part of the nominal area of a Hertzian contact.
Rider on_hertz(double damping) {
  constexpr double load = 20, c = 2e9;
  const double approach = std::cbrt(load / c * load / c);
  return {{0.5, 0.5},
          {10, damping},
          {2e5, 0},
          load,
          0.5,
          coulomb(0.3),
          laws::normal_law(laws::PowerContact{
              .coefficient = c, .exponent = 1.5, .bound_coefficient = load / approach, .bound_exponent = 1})};
}

}  // namespace

TEST_CASE("stations ride on the profile at the distance of the surface, each with its own lead") {
  const Profile profile{{{2e-6, 3e-3, 0.4}, {1e-6, 0.7e-3, -1}}};
  const auto law = laws::normal_law(laws::LinearContact{.stiffness = 1e6});
  for (const double V : {0.3, -0.2}) {
    const OverProfile over(law, profile, V, {0, 1e-4, -5e-4});
    for (const double t : {0.0, 0.013, 2.7}) {
      const double ahead[] = {0, 1e-4, -5e-4}, x = V * t, d = 1e-8;
      CHECK(over.height().value(t) == Approx(profile.height(x)).margin(1e-18));
      for (const int s : {0, 1, 2}) {
        const auto [level, rate] = over.under(s, t);
        CHECK(level == Approx(profile.height(x + ahead[s])).margin(1e-17));
        const double slope = (profile.height(x + ahead[s] + d) - profile.height(x + ahead[s] - d)) / (2 * d);
        CHECK(rate == Approx(V * slope).epsilon(1e-6));
      }
    }
    CHECK(profile_under(&over) == &over);
  }
  CHECK(!profile_under(law.get()));
  CHECK(!profile_under(nullptr));
  CHECK_THROWS_WITH(OverProfile(law, profile, 0.0), Catch::Contains("constant speed"));
  CHECK_THROWS_WITH(OverProfile(law, profile, Signal(Signal::Ramp{1, 1})), Catch::Contains("constant speed"));
  CHECK_THROWS_WITH(OverProfile(laws::normal_law(laws::LinearContact{}), profile, 1.0),
                    Catch::Contains("without stiffness"));
}

TEST_CASE("a rough track has its mean square, the spectrum of its Hurst exponent, and repeats by its seed") {
  RoughTrack track{.rms = 3e-6, .shortest = 0.1e-3, .longest = 5e-3, .length = 20e-3, .hurst = 0.7, .seed = 5};
  const auto profile = profile_of(track);
  REQUIRE(profile.waves.size() == 197);  // n = 4 … 200
  CHECK(profile.waves.front().wavelength == 5e-3);
  CHECK(profile.waves.back().wavelength == Approx(0.1e-3));
  CHECK(profile.rms() == Approx(3e-6).epsilon(1e-14));
  // The mean square over the track, of which 1024 places miss nothing.
  double square = 0;
  for (int i = 0; i < 1024; ++i) square += std::pow(profile.height(i * 20e-3 / 1024), 2) / 1024;
  CHECK(std::sqrt(square) == Approx(3e-6).epsilon(1e-12));
  CHECK(profile.height(0.0123) == Approx(profile.height(0.0323)).epsilon(1e-9));
  const auto &one = profile.waves[0], &other = profile.waves[100];
  CHECK(std::pow(one.amplitude / other.amplitude, 2) ==
        Approx(std::pow(one.wavelength / other.wavelength, 1 + 2 * 0.7)).epsilon(1e-12));
  CHECK(profile_of(track).waves[7].phase == profile.waves[7].phase);
  track.seed = 6;
  CHECK(profile_of(track).waves[7].phase != profile.waves[7].phase);
  track.shortest = 1e-6;
  CHECK_THROWS_WITH(profile_of(track), Catch::Contains("more than 1000"));
  track.shortest = 8.1e-3, track.longest = 9e-3;
  CHECK_THROWS_WITH(profile_of(track), Catch::Contains("no wave fits"));
}

TEST_CASE("a track of measured heights passes through them, less their mean") {
  for (const int count : {7, 8}) {
    std::vector<double> heights;
    for (int i = 0; i < count; ++i) heights.push_back(1e-6 * std::sin(1.0 + i * i));
    double mean = 0;
    for (const double h : heights) mean += h / count;
    const auto profile = profile_of(heights, 2e-4);
    for (int i = 0; i < 2 * count; ++i)
      CHECK(profile.height(i * 2e-4) == Approx(heights[i % count] - mean).margin(1e-18));
  }
}

TEST_CASE("over a wave the load of a linear contact swings by |Z (1 - Z G)| of the amplitude", "[profile]") {
  const double m = 1.5, K = 2e4, C = 3, k = 5e5, c = 20, V = 0.4, wavelength = 8e-3, a = 2e-6;
  const double w = 2 * pi * V / wavelength;
  const Complex Z{k, w * c}, G = 1.0 / (Complex{K - m * w * w, w * C} + Z);
  const double amplitude = std::abs(Z * (1.0 - Z * G)) * a;
  CHECK(amplitude == Approx(0.344216818949956).epsilon(1e-13));  // by another program
  const Rider rider{{1, m},
                    {50, C},
                    {1e5, K},
                    10,
                    V,
                    coulomb(0.3),
                    laws::normal_law(laws::LinearContact{.stiffness = k, .damping = c})};
  const auto cycle = rider.cycle({{{a, wavelength, 0}}});
  CHECK(value(cycle, "period") == Approx(wavelength / V).epsilon(1e-12));
  CHECK(value(cycle, "normal_load_amplitude") == Approx(amplitude).epsilon(1e-9));
  CHECK(value(cycle, "normal_load_mean") == Approx(10).epsilon(1e-10));
  CHECK(value(cycle, "normal_harmonic_1") == Approx(std::abs(Z * G) * a).epsilon(1e-8));
  CHECK(value(cycle, "profile_height_max") == Approx(a).epsilon(1e-9));
  CHECK(std::abs(value(cycle, "friction_drop")) < 1e-10);  // friction in proportion to a load with the same mean
  // Steady sliding, and its stability, are those on the mean level.
  CHECK(analysis::steady::stability(rider.over({{{a, wavelength, 0}}}).structure).coordinates[1] == 0);
}

TEST_CASE("the contact lifts off where the wave takes more than its load", "[profile]") {
  // Held still along its normal the load is N0 + k h, cut off at 0: open for acos(N0/(k a))/pi of the period.
  const double k = 1e6, a = 20e-6, N0 = 10;
  const Rider rider{
      {1, 1e6}, {50, 1e3}, {1e5, 1e14}, N0, 0.1, coulomb(0.3), laws::normal_law(laws::LinearContact{.stiffness = k})};
  const auto cycle = rider.cycle({{{a, 1e-2, 0}}}, 1e-8);
  const double open = std::acos(N0 / (k * a));
  CHECK(value(cycle, "open_fraction_mean") == Approx(open / pi).epsilon(2e-4));
  CHECK(value(cycle, "normal_load_min") == 0);
  CHECK(value(cycle, "normal_load_max") == Approx(N0 + k * a).epsilon(1e-6));
  const double mean = (N0 * (pi - open) + k * a * std::sin(open)) / pi;
  CHECK(value(cycle, "normal_load_mean") == Approx(mean).epsilon(1e-6));
  CHECK(value(cycle, "friction_drop") == Approx(1 - mean / N0).epsilon(1e-5));  // it grows
}

TEST_CASE("friction in proportion to the area of a Hertzian contact falls by A^2/8", "[profile]") {
  // A: amplitude of the approach over its mean; the mean load is N0, so that the mean approach must fall.
  const auto rider = on_hertz(40);
  const double a0 = std::cbrt(1e-16), k = 1.5 * 20 / a0, m = 0.5, w = 2 * pi * 0.5 / 1e-3;
  const Complex G = 1.0 / Complex{k - m * w * w, w * 40};
  const auto drop_over_limit = [&](double a) {
    const double A = std::abs(1.0 - k * G) * a / a0;
    return value(rider.cycle({{{a, 1e-3, 0}}}), "friction_drop") / (A * A / 8);
  };
  const double coarse = drop_over_limit(2e-8), fine = drop_over_limit(1e-8);
  CHECK(fine - (coarse - fine) / 3 == Approx(1).epsilon(1e-6));
  // At finite amplitude: shooting with scipy's DOP853 at 1e-13.
  CHECK(value(rider.cycle({{{1e-7, 1e-3, 0}}}), "friction_drop") == Approx(6.033863134732309e-4).epsilon(1e-7));
  const auto strong = on_hertz(400).cycle({{{1e-6, 1e-3, 0}}});
  CHECK(value(strong, "friction_drop") == Approx(0.047114078549561955).epsilon(1e-8));
  auto open = on_hertz(400);  // for 0.287 of the time
  open.speed = 0.57;
  CHECK(value(open.cycle({{{1.6e-6, 1e-3, 0}}}), "friction_drop") == Approx(0.17660462703259).epsilon(1e-8));
  CHECK(value(strong, "normal_load_mean") == Approx(20).epsilon(1e-9));
  CHECK(value(strong, "normal_load_max") == Approx(39.459021528).epsilon(1e-6));
}

TEST_CASE("over a wave mean friction under a falling curve is that of the second order, and of scipy", "[profile]") {
  // mean F/(N0 mu) - 1 = mu''<x'^2>/(2 mu) - mu'<dN x'>/(mu N0), from linear responses.
  const double N0 = 50, V = 0.5, wavelength = 2e-3, w = 2 * pi * V / wavelength, k = 4e6, c = 30;
  const Vector2d m{2, 1}, C{40, 60}, K{4.5e6, 1e5};
  const Rider rider{m,
                    C,
                    K,
                    N0,
                    V,
                    laws::find_law("hyperbolic")->with({0.5, 2.0}),
                    laws::normal_law(laws::LinearContact{.stiffness = k, .damping = c})};
  const double mu = 0.25, slope = -0.25, bend = 0.5;  // of 0.5/(1 + 2 v) at 0.5 m/s
  const auto second_order = [&](double a) {
    const Complex Z{k, w * c}, G = 1.0 / (Complex{K[1] - m[1] * w * w, w * C[1]} + Z), dN = Z * (1.0 - Z * G) * a,
                               speed = Complex{0, w} * mu * dN / Complex{K[0] - m[0] * w * w, w * (C[0] + N0 * slope)};
    return -(bend / 2 * N0 * std::norm(speed) / 2 - slope * (dN * std::conj(speed)).real() / 2) / (N0 * mu);
  };
  const auto drop = [&](double a) { return value(rider.cycle({{{a, wavelength, 0}}}), "friction_drop"); };
  CHECK(second_order(5e-6) == Approx(-0.0010807845956314938).epsilon(1e-12));
  const double coarse = drop(2e-6) / second_order(2e-6), fine = drop(1e-6) / second_order(1e-6);
  CHECK(fine - (coarse - fine) / 3 == Approx(1).epsilon(2e-6));
  CHECK(drop(5e-6) == Approx(-0.0010811414149265453).epsilon(1e-6));  // shooting with scipy's DOP853 at 1e-13
}

TEST_CASE("a run over a profile ends on the periodic motion over it, and balances its energy", "[profile]") {
  const auto rider = on_hertz(400);
  const Profile profile{{{0.4e-6, 1e-3, 0}, {0.2e-6, 0.5e-3, 1}}};
  auto model = rider.over(profile);
  model.start.kind = analysis::motion::Start::Kind::steady;
  analysis::motion::RunOptions options;
  options.duration = 0.4, options.samples = 2001, options.tolerance = 1e-8;
  const auto run = analysis::motion::run_structure(model, options);
  REQUIRE(run.outcome.complete());
  CHECK(run.metrics.at("energy_residual") < 1e-8);
  const auto cycle = rider.cycle(profile);
  const auto load = std::ranges::find(run.column_names, "normal_load") - run.column_names.begin();
  const auto& N = run.columns[load];
  const double most = *std::max_element(N.begin() + 1500, N.end());
  CHECK(most <= value(cycle, "normal_load_max") * (1 + 1e-6));
  CHECK(most == Approx(value(cycle, "normal_load_max")).epsilon(0.02));  // as dense as the samples are
}

TEST_CASE("steps of a given length see the same forces over a profile", "[profile]") {
  const auto structure = on_hertz(400).over({{{1e-6, 1e-3, 0.3}}}).structure;
  const StationForces contacts(structure);
  const StructureSystem system(structure, Unknowns::states);
  const Vector2d q{3e-5, 4e-6}, v{0.01, -2e-3};
  for (const double t : {0.0, 3e-4}) {
    StationForces::Forces forces;
    contacts.evaluate(t, contacts.rows() * q, contacts.rows() * v, forces);
    const auto y = system.unknowns_at(t, q, v);
    CHECK(-forces.value[1] == Approx(system.normal_load(0, t, y.data())).epsilon(1e-12));
    double friction = 0;
    system.friction_forces(t, y.data(), &friction);
    CHECK(forces.value[0] == Approx(friction).epsilon(1e-12));
  }
}

TEST_CASE("a circular face takes 2 J1(kR)/(kR) of a wave as load", "[profile]") {
  const double a = 0.1e-6, wavelength = 8e-3, V = 0.46;
  PinOnDisk rig;
  rig.normal_law =
      laws::normal_law(laws::PowerContact{.coefficient = 4e12, .bound_coefficient = 4e12});  // Pa/m, pressed throughout
  rig.profile.waves = {{a, wavelength, 0}};
  FrictionContact contact;
  contact.law = coulomb(0.25), contact.speed = V, contact.normal_load = 200.0;
  const StructureSystem system(pin_on_disk(rig, contact));
  const double R = rig.pin_diameter / 2, kR = 2 * pi / wavelength * R, k = 4e12 * pi * R * R;
  const auto y = StructureSystem(analysis::steady::frozen(system.structure())).steady(0);
  rig.profile.waves.clear();
  const double N0 = StructureSystem(pin_on_disk(rig, contact)).normal_load(0, 0, y.data());
  for (const double t : {0.0, 1e-3, 7e-3}) {
    const double rise = a * 2 * std::cyl_bessel_j(1, kR) / kR * std::cos(2 * pi * V * t / wavelength);
    CHECK(system.normal_load(0, t, y.data()) - N0 == Approx(k * rise).epsilon(1e-9));
  }
}
