/// Checks of a structure, and the structures that have names.
#include "oscillators/structure.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "laws/frictionless.hpp"
#include "laws/regions.hpp"
#include "laws/wrappers.hpp"
#include "oscillators/profile.hpp"

namespace rosin::oscillators {

double SampledServo::read(double x) const {
  const double q = servo.encoder_resolution;
  return q > 0 ? q * std::round(x / q) : x;
}

namespace {
constexpr double same_moment = 1e-6;  // of the sampling time
}

bool SampledServo::is_sample(double t) const {
  const double samples = t / servo.sampling_time;
  return std::abs(samples - std::round(samples)) <= same_moment;
}

double SampledServo::next_sample(double t) const {
  return (std::floor(t / servo.sampling_time + same_moment) + 1) * servo.sampling_time;
}

bool Structure::constant() const {
  return sampled.empty() && std::all_of(force.begin(), force.end(), [](const Signal& f) { return f.constant(); }) &&
         std::all_of(contacts.begin(), contacts.end(), [](const FrictionContact& c) {
           const auto* profile = profile_under(c.normal_law.get());
           return c.speed.constant() && c.normal_load.constant() && (!profile || profile->is_flat());
         });
}

namespace {
bool depend_on_each_other(const std::vector<FrictionContact>& contacts, const std::vector<std::size_t>& chosen) {
  if (chosen.empty()) return false;
  const auto n = contacts.front().tangential.size();
  // Directions along one coordinate each, as of a chain, do only where that is the same.
  std::vector<bool> taken(n);
  bool along_one_each = true, twice = false;
  for (const std::size_t j : chosen) {
    const Eigen::VectorXd& t = contacts[j].tangential;
    along_one_each = along_one_each && (t.array() != 0).count() == 1;
    Eigen::Index row = 0;
    t.cwiseAbs().maxCoeff(&row);
    twice = twice || taken[row];
    taken[row] = true;
  }
  if (along_one_each) return twice;
  Eigen::MatrixXd directions(n, chosen.size());
  for (std::size_t s = 0; s < chosen.size(); ++s)
    directions.col(Eigen::Index(s)) = contacts[chosen[s]].tangential.normalized();
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(directions).rank() < directions.cols();
}

/// Without mass the other forces balance at every moment: friction has to say how fast the contact slips, or, where no
/// contact is, dampers how fast the coordinate moves, as the integral of a controller's error does.
/// \throws InputError where they do not
void check_without_mass(const Structure& structure, int i) {
  const auto fail = [&](const char* why) {
    throw InputError(fmt::format("{} has no mass: {} (mass, kg)",
                                 structure.names.empty() ? fmt::format("coordinate {}", i + 1) : structure.names[i],
                                 why));
  };
  constexpr const char* needs =
      "it needs a damping of its own (C, N s/m), which says how fast it moves, or one contact with friction, along it "
      "alone, whose slip rate balances the forces; and other contacts lie along one coordinate each";
  const FrictionContact* only = nullptr;
  for (const auto& contact : structure.contacts) {
    if (contact.frictionless()) continue;
    const bool alone = contact.tangential.sum() == 1 && (contact.tangential.array() != 0).count() == 1;
    if (!alone || (only && contact.tangential[i] != 0)) fail(needs);
    if (contact.tangential[i] != 0) only = &contact;
  }
  if (std::ranges::any_of(structure.stops, [&](const Stop& stop) { return stop.coordinate == i; }))
    fail("a stop needs a mass that it stops");
  if (!only) {
    if (structure.C(i, i) == 0) fail(needs);
    return;
  }
  if (only->law->set_valued()) fail("under a set-valued law nothing says how fast it slips; give it a mass");
  if (only->stiffness.present() && structure.C(i, i) == 0)
    fail("with a contact spring and no damper forces do not depend on its slip rate; give it a mass or a damping");
}

/// The force that would hold a contact must not depend on friction itself.
void check_regions(const Structure& structure) {
  for (std::size_t j = 0; j < structure.contacts.size(); ++j) {
    const auto& contact = structure.contacts[j];
    if (contact.frictionless() || laws::region_width(*contact.law) == 0) continue;
    Eigen::Index i = 0;
    const bool alone =
        contact.tangential.maxCoeff(&i) == 1 && (contact.tangential.array() != 0).count() == 1 &&
        std::ranges::count_if(structure.contacts, [&](const auto& c) { return c.tangential[i] != 0; }) == 1;
    if (!alone || !structure.M.isDiagonal(0) || structure.M(i, i) == 0 || contact.normal.size() > 0 ||
        contact.stiffness.present())
      throw InputError(fmt::format(
          "contact {}: solver.smoothing.type = 'multi-region' needs the force that would hold the contact, which "
          "is known where M is diagonal, the contact alone acts along its coordinate, of a mass, and "
          "its load is given; without contact stiffness",
          j + 1));
  }
}

/// The slip of a contact behind a spring needs the rate of its load, which must not hold accelerations.
void check_spring_beside(const FrictionContact& contact, std::size_t number) {
  constexpr double somewhat = 1e-6;  // m
  if (!contact.law->set_valued())
    throw InputError(fmt::format(
        "contact {}: under law '{}' contact stiffness does not go with a load that follows motion; it does with laws "
        "that stick",
        number, contact.law->card().name));
  if (contact.normal_law->at(somewhat, 0, 1).bound_by_rate != 0)
    throw InputError(fmt::format(
        "contact {}: contact stiffness needs friction that is a part of what the approach alone gives, and here "
        "damping adds to it; give normal_contact as a power law with bound = \"elastic\"",
        number));
}

void check_ring(const FrictionContact& contact, std::size_t number) {
  const auto refuse = [&](const char* why) { throw InputError(fmt::format("contact {}: a ring {}", number, why)); };
  if (contact.frictionless() || contact.normal.cols() != 1)
    refuse("needs normal and tangential, the directions where it is touched along the first");
  if (contact.face || profile_under(contact.normal_law.get())) refuse("does not go with a profile");
  if (!(contact.gap.size() == 1 && contact.gap[0] > 0)) refuse("needs a gap above 0: its clearance, m");
  if (!contact.normal_load.constant() || contact.normal_load.level() * contact.load_factor != 0)
    refuse("takes no dead load, which has no direction in it: give normal_load = 0 (N), and loads as oscillator.force");
  if (contact.law->set_valued() && !contact.stiffness.present())
    refuse(
        "turns the direction of stick with the motion, which rigid stick does not follow: give law.contact_stiffness, "
        "a law with a bristle, or solver.smoothing");
}

/// Rates of several coordinates without mass and contact follow from their dampers together.
void check_rates_without_mass(const Structure& structure) {
  std::vector<int> without;
  for (int i = 0; i < structure.size(); ++i)
    if (structure.M(i, i) == 0 &&
        std::ranges::none_of(structure.contacts, [&](const auto& contact) { return contact.tangential[i] != 0; }))
      without.push_back(i);
  if (without.size() < 2) return;
  const Eigen::MatrixXd C = structure.C(without, without);
  if (Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(C).rank() < C.cols())
    throw InputError(
        "the coordinates without mass and contact have a damping matrix without an inverse, which leaves their speeds "
        "open (C, N s/m)");
}
}  // namespace

bool Structure::stands_still(int coordinate) const {
  return std::ranges::any_of(contacts, [coordinate](const FrictionContact& contact) {
    return contact.tangential[coordinate] != 0 && contact.speed.constant() && contact.speed.level() == 0;
  });
}

bool Structure::feeds_itself() const {
  constexpr double rounding = 1e-12;
  if ((K - K.transpose()).cwiseAbs().maxCoeff() > rounding * K.cwiseAbs().maxCoeff()) return true;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> damping(C + C.transpose(), Eigen::EigenvaluesOnly);
  return damping.eigenvalues().minCoeff() < -rounding * C.cwiseAbs().maxCoeff();
}

void Structure::require_drive() const {
  const auto rests = [](const FrictionContact& contact) { return contact.speed.level() == 0; };
  if (common_period(*this) > 0 || !std::ranges::all_of(contacts, rests) || feeds_itself()) return;
  throw InputError(
      "nothing drives the structure: no surface moves, no force varies (drive.speed, m/s), and its matrices feed no "
      "energy: K is symmetric and C damps");
}

void Structure::check() const {
  const int n = size();
  const auto square = [&](const Eigen::MatrixXd& A, const char* name) {
    if (A.rows() != n || A.cols() != n)
      throw InputError(fmt::format("{} is {} × {}, but M has {} coordinates", name, A.rows(), A.cols(), n));
    if (!A.allFinite()) throw InputError(fmt::format("{} has an entry that is not finite", name));
  };
  if (n == 0) throw InputError("M has no rows: a structure has one coordinate or more");
  square(M, "M");
  square(C, "C");
  square(K, "K");
  const bool is_positive =
      M.isDiagonal(0) ? ((M.diagonal().array() > 0) || (M.diagonal().array() == 0)).all()
                      : M.isApprox(M.transpose(), 1e-12) && Eigen::LLT<Eigen::MatrixXd>(M).info() == Eigen::Success;
  if (!is_positive) throw InputError("M is not symmetric and positive definite (mass matrix, kg)");
  for (int i = 0; i < n; ++i)
    if (M.isDiagonal(0) && M(i, i) == 0) check_without_mass(*this, i);
  check_rates_without_mass(*this);
  if (!force.empty() && int(force.size()) != n)
    throw InputError(fmt::format("{} forces for {} coordinates", force.size(), n));
  std::vector<std::size_t> set_valued;
  for (std::size_t j = 0; j < contacts.size(); ++j) {
    const FrictionContact& contact = contacts[j];
    if (contact.tangential.size() != n)
      throw InputError(fmt::format("contact {}: tangential has {} entries, but M has {} coordinates", j + 1,
                                   contact.tangential.size(), n));
    if ((contact.frictionless() && contact.normal.size() == 0) || !contact.tangential.allFinite())
      throw InputError(fmt::format("contact {}: tangential has no direction", j + 1));
    if (contact.normal.size() > 0) {
      if (contact.normal.rows() != n)
        throw InputError(fmt::format("contact {}: normal has {} entries, but M has {} coordinates", j + 1,
                                     contact.normal.rows(), n));
      if (contact.normal.isZero(0) || !contact.normal.allFinite())
        throw InputError(fmt::format("contact {}: normal has no direction", j + 1));
      const auto stations = contact.normal.cols();
      if (!contact.normal_law || (contact.area.size() > 0 && contact.area.size() != stations) ||
          (contact.gap.size() > 0 && contact.gap.size() != stations) ||
          (contact.load_along.size() > 0 ? contact.load_along.size() != n : stations > 1))
        throw InputError(
            fmt::format("contact {}: its {} stations need a normal law, areas and gaps, and the direction of the load",
                        j + 1, stations));
      const auto* profile = profile_under(contact.normal_law.get());
      if (profile && (contact.face || profile->stations() != stations))
        throw InputError(fmt::format("contact {}: its profile needs stations that stay where they are", j + 1));
      if (contact.load_memory > 0)
        throw InputError(fmt::format("contact {}: a load that follows motion does not go with load memory", j + 1));
      if (contact.stiffness.present()) check_spring_beside(contact, j + 1);
    }
    if (const auto why = laws::refusal_of_spring(*contact.law, contact.stiffness.damped());
        contact.stiffness.present() && !why.empty())
      throw InputError(fmt::format("law.contact_stiffness of contact {} does not go with law '{}'{}", j + 1,
                                   contact.law->card().name, why));
    if (contact.ring) check_ring(contact, j + 1);
    if (contact.law->set_valued() && !contact.frictionless() && !contact.stiffness.present()) set_valued.push_back(j);
  }
  check_regions(*this);
  if (depend_on_each_other(contacts, set_valued))
    throw InputError(fmt::format(
        "{} contacts that stick have directions that depend on each other: stick leaves their forces open; give them "
        "laws that creep, or contact stiffness (law.contact_stiffness)",
        set_valued.size()));
  check_stops();
}

void Structure::check_stops() const {
  for (std::size_t s = 0; s < stops.size(); ++s) {
    const Stop& stop = stops[s];
    if (stop.coordinate < 0 || stop.coordinate >= size())
      throw InputError(
          fmt::format("stop {}: coordinate {} of a structure with {}", s + 1, stop.coordinate + 1, size()));
    for (std::size_t other = 0; other < s; ++other) {
      if (stops[other].coordinate != stop.coordinate) continue;
      if (stops[other].side == stop.side)
        throw InputError(fmt::format("stops {} and {} stand on the same side of coordinate {}", other + 1, s + 1,
                                     stop.coordinate + 1));
      if (stop.side * (stop.at - stops[other].at) <= 0)
        throw InputError(
            fmt::format("stops {} and {} leave coordinate {} no room: the upper one must stand above the "
                        "lower ({} m, {} m)",
                        other + 1, s + 1, stop.coordinate + 1, stops[other].at, stop.at));
    }
    const bool shares_impacts = !M.isDiagonal(0) || std::ranges::any_of(contacts, [](const FrictionContact& contact) {
      return (contact.tangential.array() != 0).count() != 1 || contact.tangential.sum() != 1;
    });
    if (stop.rigid() && shares_impacts)
      throw InputError(fmt::format(
          "stop {}: a rigid stop needs a mass matrix M that is diagonal and contacts along one coordinate each "
          "(tangential with a single entry of 1), so that its impact stops one mass alone; give the stop a stiffness "
          "(N/m)",
          s + 1));
  }
}

FrictionContact contact_of(const Model& model) {
  FrictionContact contact;
  contact.law = model.law;
  contact.lambda = model.lambda;
  contact.stiffness = model.contact_stiffness;
  contact.load_memory = model.load_memory;
  contact.tangential = Eigen::VectorXd::Ones(1);
  contact.speed = model.drive.speed;
  contact.normal_load = model.drive.normal_load;
  return contact;
}

FrictionContact frictionless_contact(Eigen::VectorXd normal, std::shared_ptr<const NormalLaw> law) {
  FrictionContact contact;
  contact.law = laws::frictionless();
  contact.tangential = Eigen::VectorXd::Zero(normal.size());
  contact.speed = 0.0;
  contact.normal = std::move(normal);
  contact.normal_law = std::move(law);
  return contact;
}

Structure one_slider(const Model& model) {
  if (!std::isfinite(model.slider.stiffness))
    throw InputError(
        "under an infinite stiffness the drive imposes the motion: there is none of its own (oscillator."
        "stiffness, N/m)");
  Structure structure;
  structure.M = Eigen::MatrixXd::Constant(1, 1, model.slider.mass);
  structure.C = Eigen::MatrixXd::Constant(1, 1, model.slider.damping);
  structure.K = Eigen::MatrixXd::Constant(1, 1, model.slider.stiffness);
  structure.force = {model.drive.force};
  structure.names = {"displacement"};
  structure.contacts = {contact_of(model)};
  structure.check();
  return structure;
}

double common_period(const Structure& structure) {
  std::vector<double> frequencies;
  const auto take = [&](const Signal& signal, const char* what) {
    const auto terms = signal.piece(0).terms;
    if (terms.empty() && !signal.constant())
      throw InputError(
          fmt::format("{} has no period: a periodic motion needs a drive that is constant or a sum of "
                      "harmonics",
                      what));
    for (const auto& term : terms)
      if (term.amplitude != 0) frequencies.push_back(std::abs(term.angular_frequency));
  };
  for (const auto& force : structure.force) take(force, "drive.force");
  for (const auto& contact : structure.contacts) {
    take(contact.speed, "drive.speed"), take(contact.normal_load, "drive.normal_load");
    if (const auto* profile = profile_under(contact.normal_law.get())) take(profile->height(), "the profile");
  }
  for (const auto& of : structure.sampled) take(of.servo.reference, "the servo's reference");
  if (frequencies.empty()) return 0;
  const double slowest = *std::ranges::min_element(frequencies);
  constexpr int most_turns = 1000;
  constexpr double same = 1e-9;
  for (int turns = 1; turns <= most_turns; ++turns)
    if (std::ranges::all_of(frequencies, [&](double w) {
          const double of_this = turns * w / slowest;
          return std::abs(of_this - std::round(of_this)) <= same * of_this;
        })) {
      const double period = turns * 2 * std::numbers::pi / slowest;
      for (const auto& of : structure.sampled)
        if (!of.is_sample(period))
          throw InputError(
              fmt::format("the period of the drive, {:.9g} s, is no multiple of the sampling time, {:.9g} s", period,
                          of.servo.sampling_time));
      return period;
    }
  throw InputError(
      fmt::format("the angular frequencies of the drive have no common period within {} of the slowest "
                  "({} rad/s)",
                  most_turns, slowest));
}

Structure two_mass_belt(const TwoMassBelt& belt, const FrictionContact& contact, const Signal& force) {
  const auto& [m, k, c] = belt.block;
  const auto& [m2, k2, c2] = belt.second;
  Structure structure;
  structure.M = Eigen::Vector2d(m, m2).asDiagonal();
  structure.K = Eigen::Matrix2d{{k, -k}, {-k, k + k2}};
  structure.C = Eigen::Matrix2d{{c, -c}, {-c, c + c2}};
  structure.force = {force, 0.0};
  structure.names = {"displacement", "second_displacement"};
  structure.contacts = {contact};
  structure.contacts[0].tangential = Eigen::Vector2d(1, 0);
  structure.check();
  return structure;
}

Structure mode_coupling(const ModeCoupling& model, const FrictionContact& contact, const Signal& force) {
  Structure structure;
  structure.M = Eigen::Vector2d(model.mass[0], model.mass[1]).asDiagonal();
  structure.C = Eigen::Vector2d(model.damping[0], model.damping[1]).asDiagonal();
  structure.K = Eigen::Matrix2d::Zero();
  for (const auto& [stiffness, angle] : model.springs) {
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    structure.K += stiffness * along * along.transpose();
  }
  structure.force = {force, 0.0};
  structure.names = {"displacement", "normal_displacement"};
  structure.contacts = {contact};
  structure.contacts[0].tangential = Eigen::Vector2d(1, 0);
  structure.contacts[0].normal = Eigen::Vector2d(0, 1);
  structure.contacts[0].normal_law = model.contact;
  structure.check();
  return structure;
}

Structure chain(const Chain& chain, std::vector<FrictionContact> contacts) {
  const std::size_t n = chain.mass.size();
  const auto fits = [](const std::vector<double>& list, std::size_t count, const char* name) {
    if (list.size() != count) throw InputError(fmt::format("{} has {} entries where {} fit", name, list.size(), count));
  };
  if (n == 0) throw InputError("a chain has one block or more");
  fits(chain.coupling_stiffness, n - 1, "stiffness between neighbours");
  fits(chain.coupling_damping, n - 1, "damping between neighbours");
  fits(chain.pull_stiffness, n, "pull_stiffness");
  fits(chain.pull_damping, n, "pull_damping");
  if (contacts.size() != n) throw InputError(fmt::format("{} contacts for {} blocks", contacts.size(), n));
  const auto row = [n](const std::vector<double>& between, const std::vector<double>& to_frame) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < n; ++i) A(i, i) = to_frame[i];
    for (std::size_t i = 0; i + 1 < n; ++i) {
      A(i, i) += between[i], A(i + 1, i + 1) += between[i];
      A(i, i + 1) -= between[i], A(i + 1, i) -= between[i];
    }
    return A;
  };
  Structure structure;
  structure.M = Eigen::Map<const Eigen::VectorXd>(chain.mass.data(), n).asDiagonal();
  structure.K = row(chain.coupling_stiffness, chain.pull_stiffness);
  structure.C = row(chain.coupling_damping, chain.pull_damping);
  structure.contacts = std::move(contacts);
  for (std::size_t i = 0; i < n; ++i) {
    structure.names.push_back(fmt::format("displacement_{}", i + 1));
    structure.contacts[i].tangential = Eigen::VectorXd::Unit(n, i);
  }
  structure.check();
  return structure;
}

}  // namespace rosin::oscillators
