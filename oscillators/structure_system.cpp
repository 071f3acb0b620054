/// Assembly of a structure: right-hand side, Jacobian, forces of contacts that stick, starts and what is observed.
#include "oscillators/structure_system.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "laws/regions.hpp"
#include "oscillators/profile.hpp"

namespace rosin::oscillators {

namespace {
using Eigen::MatrixXd, Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows of the contacts' speeds: for each contact the coordinate in which its direction, cleared of those before it, is
/// largest; −1 where nothing is left of it.
std::vector<int> rows_of_contacts(const std::vector<FrictionContact>& contacts) {
  std::vector<int> rows;
  // Directions along one coordinate each depend on each other only where that is the same.
  if (std::ranges::all_of(contacts, [](const auto& c) { return (c.tangential.array() != 0).count() <= 1; })) {
    for (const FrictionContact& contact : contacts) {
      int row = 0;
      const bool any = contact.tangential.cwiseAbs().maxCoeff(&row) > 0;
      rows.push_back(any && std::ranges::find(rows, row) == rows.end() ? row : -1);
    }
    return rows;
  }
  std::vector<VectorXd> cleared;
  for (const FrictionContact& contact : contacts) {
    VectorXd t = contact.tangential;
    if (!contact.frictionless()) t.normalize();
    for (std::size_t j = 0; j < cleared.size(); ++j)
      if (rows[j] >= 0) t -= t[rows[j]] / cleared[j][rows[j]] * cleared[j];
    int row = 0;
    const double largest = t.cwiseAbs().maxCoeff(&row);
    constexpr double nothing = 1e-10;
    rows.push_back(largest > nothing ? row : -1);
    cleared.push_back(t);
  }
  return rows;
}

/// x of K x = f, or nothing where K has no inverse; sparse where a dense factorisation would take long.
std::optional<VectorXd> solve_stiffness(const MatrixXd& K, const VectorXd& f) {
  constexpr Eigen::Index most_dense = 32;  // rows
  if (K.rows() <= most_dense) {
    const Eigen::FullPivLU<MatrixXd> lu(K);
    return lu.isInvertible() ? std::optional<VectorXd>(lu.solve(f)) : std::nullopt;
  }
  const Eigen::SparseMatrix<double> entries = K.sparseView();
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(entries);
  if (lu.info() != Eigen::Success) return std::nullopt;
  const VectorXd x = lu.solve(f);
  // Where nothing holds, rounding does: displacements are those of springs 10⁻¹³ times as stiff.
  constexpr double rounding = 1e-13;
  const double force = f.cwiseAbs().maxCoeff(), terms = (entries.cwiseAbs() * x.cwiseAbs()).maxCoeff();
  if (!x.allFinite() || rounding * terms > force) return std::nullopt;
  return x;
}
}  // namespace

StructureSystem::StructureSystem(Structure structure, Unknowns unknowns)
    : structure_(std::move(structure)),
      n_(structure_.size()),
      is_constant_(structure_.constant()),
      stop_mode_(structure_.stops.size(), StopMode::open) {
  structure_.check();
  const auto& contacts = structure_.contacts;
  for (const FrictionContact& c : contacts) at_.emplace_back(c.law, c.lambda, c.load_memory, c.stiffness, unknowns);
  // Contacts whose stick holds coordinates come first, because they need a speed of their own.
  std::vector<int> order;
  for (const bool holds : {true, false})
    for (std::size_t j = 0; j < contacts.size(); ++j)
      if ((contacts[j].law->set_valued() && !at_[j].is_elastic()) == holds) order.push_back(int(j));
  std::vector<FrictionContact> ordered;
  for (const int j : order) {
    ordered.push_back(contacts[j]);
    if (contacts[j].ring) ordered.back().tangential.setZero();  // no speed belongs to a direction that turns
  }
  const auto rows = rows_of_contacts(ordered);
  for (std::size_t i = 0; i < order.size(); ++i) at_[order[i]].row = rows[i];

  K_ = SparseRows(structure_.K), C_ = SparseRows(structure_.C);
  MatrixXd directions(at_.size(), n_);
  for (int j = 0; j < friction_contacts(); ++j) {
    directions.row(j) = contacts[j].tangential;
    at_[j].first_station = int(station_.size());
    const auto& [area, gap] = std::tie(contacts[j].area, contacts[j].gap);
    for (Eigen::Index s = 0; s < contacts[j].normal.cols(); ++s)
      station_.push_back(
          {area.size() > 0 ? area[s] : 1, gap.size() > 0 ? gap[s] : 0, contacts[j].load_along.size() == 0, {}});
    at_[j].end_station = int(station_.size());
    if (area.size() > 0) at_[j].area = area.sum();
  }
  MatrixXd normals(station_.size(), n_);
  for (int j = 0; j < friction_contacts(); ++j)
    if (follows_motion(j))
      normals.middleRows(at_[j].first_station, contacts[j].normal.cols()) = contacts[j].normal.transpose();
  tangential_ = SparseRows(directions), normal_ = SparseRows(normals);
  for (std::size_t s = 0; s < station_.size(); ++s) station_[s].normal = normal_[int(s)];
  along_ = VectorXd::Ones(n_);
  contact_of_row_.assign(n_, -1);
  is_diagonal_ =
      structure_.M.isDiagonal(0) && std::ranges::none_of(contacts, [](const auto& c) { return bool(c.ring); });
  for (int j = 0; j < friction_contacts(); ++j)
    if (const int row = at_[j].row; row >= 0) {
      along_[row] = -1, contact_of_row_[row] = j;
      const auto t = tangential_[j];
      is_diagonal_ = is_diagonal_ && t.end() - t.begin() == 1 && t.begin()->value == 1;
    }
  // q̇ = B⁻¹ (V − w of contacts, w of the others), B the unit matrix with t in the contacts' rows.
  if (is_diagonal_) {
    row_mass_ = structure_.M.diagonal();
    for (int j = 0; j < friction_contacts(); ++j) {
      const double by_root = 1 / std::sqrt(mobility(j));
      holding_of_surface_alone_.push_back(by_root * by_root);
      holding_alone_.push_back(by_root > 0 ? -holding_of_surface_alone_[j] * mobility(j) : 0);  // 0: no mass, no stick
    }
  } else {
    MatrixXd B = MatrixXd::Identity(n_, n_);
    for (int j = 0; j < friction_contacts(); ++j)
      if (const int row = at_[j].row; row >= 0) B.row(row) = contacts[j].tangential;
    velocity_of_speed_ = B.inverse() * along_.asDiagonal();
    inverse_mass_ = structure_.M.llt().solve(MatrixXd::Identity(n_, n_));
    row_mass_ = VectorXd::Ones(n_);
  }
  speed_scale_ = VectorXd::Zero(n_);
  coordinate_scale_ = VectorXd::Zero(n_);

  int next = 2 * n_;
  for (std::size_t j = 0; j < at_.size(); ++j) {
    At& at = at_[j];
    const FrictionContact& contact = contacts[j];
    const FrictionLaw& law = *contact.law;
    at.region = laws::region_width(law);
    at.first = next;
    next += at.contact->unknowns();
    if (law.set_valued()) switching_.push_back(int(j));
    const double N = at.natural_load = natural_load(int(j));
    const VectorXd& t = contact.tangential;
    const double holds = law.set_valued() && !law.has_states() ? N * law.static_limit(N) : N * 0.5;
    // Without a drive slip is as fast as what the contact holds makes the structure, in a second what nothing holds.
    const double held_by = std::max(stiffness_along(int(j)) / t.squaredNorm(), natural_stiffness(t, holds));
    const double of_friction = holds * (held_by > 0 ? std::sqrt(mobility(int(j)) / held_by) : mobility(int(j)));
    at.reference_speed = std::max(std::abs(contact.speed.value(0)), std::abs(contact.speed.level()));
    if (at.reference_speed == 0)
      at.reference_speed = std::isfinite(of_friction) && of_friction > 0 ? of_friction : 1e-9;
    at.weigh(at.reference_speed, N, true);
    if (N > 0) at.require_slip_rate(at.reference_speed, N);
    const double coefficient = at.carries_friction() ? at.weight[0] : 0.1;
    for (const auto& [i, value] : tangential_[int(j)]) {
      speed_scale_[i] = std::max(speed_scale_[i], at.reference_speed);
      if (const double k = stiffness_at(i); k > 0)
        coordinate_scale_[i] = std::max(coordinate_scale_[i], at.reference_speed * std::sqrt(structure_.M(i, i) / k) +
                                                                  std::abs(value) * N * coefficient / k);
    }
  }
  size_ = next;
  const double largest_speed = speed_scale_.maxCoeff() > 0 ? speed_scale_.maxCoeff() : 1;
  for (int i = 0; i < n_; ++i) {
    if (speed_scale_[i] == 0) speed_scale_[i] = largest_speed;
    for (const Stop& stop : structure_.stops)  // of a coordinate that nothing else holds
      if (stop.coordinate == i && coordinate_scale_[i] == 0 && structure_.K(i, i) == 0)
        coordinate_scale_[i] = std::abs(stop.at);
    // Without mass a coordinate follows its spring as fast as its damping lets it.
    const double m = structure_.M(i, i), k = structure_.K(i, i), c = structure_.C(i, i);
    if (coordinate_scale_[i] == 0 && k > 0) coordinate_scale_[i] = speed_scale_[i] * (m > 0 ? std::sqrt(m / k) : c / k);
    if (coordinate_scale_[i] == 0) coordinate_scale_[i] = speed_scale_[i];
  }
  for (int i = 0; i < n_; ++i) is_held_.push_back(stiffness_at(i) > 0);
  has_regions_ = std::ranges::any_of(at_, [](const At& at) { return at.region > 0; });
  if (is_diagonal_) find_pattern();
  follow_modes();
}

/// q̇ of one coordinate whose speed is its own.
double StructureSystem::velocity_of(int i, double t, const double* y) const {
  const int j = contact_of_row_[i];
  return j >= 0 ? structure_.contacts[j].speed.value(t) - y[n_ + i] : y[n_ + i];
}

double StructureSystem::approach_rate(const Station& station, double t, const double* y) const {
  if (!is_diagonal_) return station.normal.times(velocity(t, y));
  double rate = 0;
  for (const auto& [i, value] : station.normal) rate += value * velocity_of(i, t, y);
  return rate;
}

double StructureSystem::mobility(int contact) const {
  const VectorXd& t = structure_.contacts[contact].tangential;
  if (!is_diagonal_) return t.dot(inverse_mass_ * t);
  double sum = 0;
  for (const auto& [i, value] : tangential_[contact]) sum += value * (1 / structure_.M(i, i) * value);
  return sum;
}

double StructureSystem::stiffness_along(int contact) const {
  double sum = 0;
  for (const auto& [i, value] : tangential_[contact])
    sum += value * K_[i].times(structure_.contacts[contact].tangential);
  return sum;
}

/// Of the springs and contacts that hold a coordinate while the others rest, N/m.
double StructureSystem::stiffness_at(int coordinate) const {
  double sum = structure_.K(coordinate, coordinate);
  for (int j = 0; j < friction_contacts(); ++j)
    if (follows_motion(j)) sum += normal_stiffness(j, coordinate);
  return sum;
}

/// Of the contact under N₀, as its stations share it.
double StructureSystem::normal_stiffness(int contact, int coordinate) const {
  const auto& law = *structure_.contacts[contact].normal_law;
  const double p = preload(contact, 0), k = law.at(law.approach_under(p), 0, p).pressure_by_approach;
  double sum = 0;
  for (int s = at_[contact].first_station; s < at_[contact].end_station; ++s) {
    const double n = structure_.contacts[contact].normal(coordinate, s - at_[contact].first_station);
    sum += station_[s].area * k * n * n;
  }
  return sum;
}

void StructureSystem::set_mode(int contact, ContactMode mode) {
  At& at = at_[switching_[contact]];
  const bool held = at.sticks();
  at.mode = mode;
  if (at.sticks() != held) follow_modes();
}

void StructureSystem::slide() {
  for (int c = 0; c < contacts(); ++c) {
    const double V = structure().contacts[friction_contact(c)].speed.level();
    set_mode(c, V == 0 && is_elastic(c) ? ContactMode::stick : slip_along(V));
  }
}

/// Matrices that depend on which contacts stick.
void StructureSystem::follow_modes() {
  if (is_diagonal_) return;
  stuck_.clear();
  for (const int j : switching_)
    if (sticks(j)) stuck_.push_back(j);
  const int count = int(stuck_.size());
  MatrixXd T(n_, count);
  for (int s = 0; s < count; ++s) T.col(s) = structure_.contacts[stuck_[s]].tangential;
  const MatrixXd weighted = T.transpose() * inverse_mass_, G = weighted * T;
  holding_of_surface_ = G.llt().solve(MatrixXd::Identity(count, count));
  holding_ = -holding_of_surface_ * weighted;
  MatrixXd B = MatrixXd::Identity(n_, n_);
  for (std::size_t j = 0; j < at_.size(); ++j)
    if (at_[j].row >= 0) B.row(at_[j].row) = -structure_.contacts[j].tangential;
  acceleration_ = row_mass_.asDiagonal() * B * inverse_mass_ * (MatrixXd::Identity(n_, n_) + T * holding_);
  acceleration_of_surfaces_ = row_mass_.asDiagonal() * B * inverse_mass_ * T * holding_of_surface_;
  for (const int j : stuck_) {
    acceleration_.row(at_[j].row).setZero();
    acceleration_of_surfaces_.row(at_[j].row).setZero();
  }
}

StructureSystem::Load StructureSystem::load(int contact, double t) const {
  const auto& of = structure_.contacts[contact];
  return {of.load_factor * of.normal_load.value(t), of.load_factor * of.normal_load.rate(t)};
}

StructureSystem::Load StructureSystem::load(int contact, double t, const double* y) const {
  if (!follows_motion(contact)) return load(contact, t);
  Load load{0, 0};
  for (const Station& s : stations(contact, y)) {
    const auto answer = this->answer(contact, s, t, y);
    load.level += s.area * answer.bound;
    // A law never sees the rate of a load that holds accelerations: what would ask for it is refused.
    if (at_[contact].is_elastic()) load.rate += s.area * answer.bound_by_approach * approach_rate(s, t, y);
  }
  return load;
}

/// N₀, or what presses a contact that motion alone presses: the structure's own springs, taken through its gap; without
/// one the forces on it, or what a micrometre of approach makes.
double StructureSystem::natural_load(int contact) const {
  const double N = load(contact, 0).level;
  if (N > 0 || !follows_motion(contact)) return N;
  const VectorXd n = structure_.contacts[contact].normal.col(0);
  const double gap = std::abs(station_[at_[contact].first_station].gap);
  if (const double of_gap = gap * n.dot(structure_.K * n) / n.squaredNorm(); of_gap > 0) return of_gap;
  double pushed = 0;
  for (std::size_t i = 0; i < structure_.force.size(); ++i) {
    double size = std::abs(structure_.force[i].level());
    for (const auto& term : structure_.force[i].piece(0).terms) size += std::abs(term.amplitude);
    pushed += size * std::abs(n[Eigen::Index(i)]);
  }
  return pushed > 0 ? pushed : structure_.contacts[contact].normal_law->at(1e-6, 0, 0).pressure;
}

StructureSystem::Turn StructureSystem::turn(int contact, const double* y) const {
  const auto& centre = structure_.contacts[contact].ring->centre;
  const double along_n = normal_[at_[contact].first_station].times(y) - centre[0],
               along_t = tangential_[contact].times(y) - centre[1], radius = std::hypot(along_n, along_t);
  if (radius == 0) return {1, 0, 0};  // where nothing is touched
  return {along_n / radius, along_t / radius, 1 / radius};
}

VectorXd StructureSystem::tangential(int contact, const double* y) const {
  const auto& of = structure_.contacts[contact];
  if (!of.ring) return of.tangential;
  const auto [cosine, sine, curvature] = turn(contact, y);
  return cosine * of.tangential - sine * of.normal.col(0);
}

VectorXd StructureSystem::turned_normal(int contact, const double* y) const {
  const auto& of = structure_.contacts[contact];
  const auto [cosine, sine, curvature] = turn(contact, y);
  return cosine * of.normal.col(0) + sine * of.tangential;
}

double StructureSystem::speed_along(int contact, const double* y, const VectorXd& velocity) const {
  return structure_.contacts[contact].ring ? tangential(contact, y).dot(velocity) : along(contact, velocity);
}

/// Of the part of a rigid face that touches: Gauss points in the root of the distance from the place where the approach
/// is 0, of which any power of the approach is smooth. Where that place is far, they are those of the whole face.
StructureSystem::Stations StructureSystem::stations(int contact, const double* y) const {
  const Station* fixed = station_.data();
  Stations whole(fixed + at_[contact].first_station, fixed + at_[contact].end_station);
  if (const auto& ring = structure_.contacts[contact].ring) {
    const auto& [area, gap, preloaded, normal] = station_[at_[contact].first_station];
    const auto [cosine, sine, curvature] = turn(contact, y);
    std::vector<SparseRows::Entry> entries;
    const VectorXd turned = turned_normal(contact, y);
    for (int i = 0; i < n_; ++i)
      if (turned[i] != 0) entries.push_back({i, turned[i]});
    const double from_centre = gap + cosine * ring->centre[0] + sine * ring->centre[1];
    return {{{area, from_centre, preloaded, {entries.data(), entries.data() + entries.size()}}}, std::move(entries)};
  }
  const auto& face = structure_.contacts[contact].face;
  if (!face) return whole;
  const Eigen::Map<const VectorXd> q(y, n_);
  const double at_middle = face->middle.dot(q), slope = face->along.dot(q), half = face->half_length;
  const double edge = -at_middle / slope,
               side = slope > 0 ? 1 : -1;  // the approach is positive on this side of the edge
  const double nearest = side * (-side * half - edge), farthest = side * (side * half - edge);
  if (slope == 0 || !std::isfinite(edge) || nearest > half) return whole;
  if (farthest <= 0) return {fixed, fixed};
  const double low = std::sqrt(std::max(nearest, 0.0)), high = std::sqrt(farthest);
  std::vector<Station> stations;
  std::vector<SparseRows::Entry> entries;
  entries.reserve(face->points.size() * std::size_t(n_));
  for (const auto& [at, weight] : face->points) {
    const double root = 0.5 * (low + high) + 0.5 * (high - low) * at, place = edge + side * root * root;
    const std::size_t first = entries.size();
    for (int i = 0; i < n_; ++i)
      if (const double value = face->middle[i] + place * face->along[i]; value != 0) entries.push_back({i, value});
    stations.push_back({face->thickness * (high - low) * weight * root,
                        0,
                        false,
                        {entries.data() + first, entries.data() + entries.size()}});
  }
  return {std::move(stations), std::move(entries)};
}

NormalAnswer StructureSystem::answer(int contact, const Station& station, double t, const double* y) const {
  const NormalLaw& law = *structure_.contacts[contact].normal_law;
  double approach = station.normal.times(y) - station.gap, rate = approach_rate(station, t, y);
  if (const auto* profile = profile_under(&law)) {
    const auto [level, rise] = profile->under(int(&station - &station_[at_[contact].first_station]), t);
    approach += level, rate += rise;
  }
  return law.at(approach, rate, preload(contact, t));
}

double StructureSystem::push_back(int contact, const Station& station, double t, const NormalAnswer& answer) const {
  const double force = station.area * answer.pressure;
  return station.preloaded ? force - load(contact, t).level : force;
}

double StructureSystem::normal_load(int contact, double t, const double* y) const {
  if (!follows_motion(contact)) return load(contact, t).level;
  double force = 0;
  for (const Station& s : stations(contact, y)) force += s.area * answer(contact, s, t, y).pressure;
  return force;
}

double StructureSystem::open_fraction(int contact, double t, const double* y) const {
  double open = 0, all = 0;
  for (const Station& s : stations(contact, y)) {
    all += s.area;
    if (answer(contact, s, t, y).pressure == 0) open += s.area;
  }
  if (structure_.contacts[contact].face) open += std::max(at_[contact].area - all, 0.0);
  return open / at_[contact].area;
}

double StructureSystem::normal_power(double t, const double* y) const {
  double power = 0;
  for (int j = 0; j < friction_contacts(); ++j) {
    for (const Station& s : stations(j, y)) power -= push_back(j, s, t, answer(j, s, t, y)) * approach_rate(s, t, y);
    if (const auto& along = structure_.contacts[j].load_along; along.size() > 0)
      power += load(j, t).level * along.dot(velocity(t, y));
  }
  return power;
}

double StructureSystem::unlimited(const LimitedForce& of, double t, const double* y) const {
  const int x = of.coordinate;
  const double v = is_diagonal_ ? velocity_of(x, t, y) : velocity(t, y)[x];
  const double u = of.command.value(t) - of.stiffness * y[x] - of.damping * v;
  return of.integral >= 0 ? u + y[of.integral] : u;
}

double StructureSystem::cut_off(const LimitedForce& of, double t, const double* y) const {
  const double u = unlimited(of, t, y);
  return std::clamp(u, -of.limit, of.limit) - u;
}

double StructureSystem::limit_power(double t, const double* y) const {
  if (structure_.limited.empty()) return 0;
  const VectorXd v = velocity(t, y);
  double power = 0;
  for (const LimitedForce& of : structure_.limited) {
    const double cut = cut_off(of, t, y);
    power += cut * (v[of.coordinate] + (of.integral >= 0 ? of.tracking * v[of.integral] : 0));
  }
  return power;
}

/// Where a contact lifts off its load has a kink, a force at its limit, friction has those of its law, and the rates of
/// states one in |v|.
void StructureSystem::kinks(double t, const double* y, std::vector<double>& values) const {
  values.clear();
  for (const LimitedForce& of : structure_.limited) {
    const double u = unlimited(of, t, y);
    values.push_back(u / of.limit - 1), values.push_back(u / of.limit + 1);
  }
  for (const auto& [j, force, holds, slip] : regions(t, y)) {  // where the force comes to the limit within the width
    const double limit = std::abs(slip), width = at_[j].region;
    values.push_back(std::max((std::abs(holds) - limit) / (std::abs(holds) + limit),
                              std::tanh(std::abs(slip_rate(j, t, y)) / width - 1)));
  }
  for (int j = 0; j < friction_contacts(); ++j) {
    const At& at = at_[j];
    const double* states = y + at.first + at.first_state();
    if (at.states > 0) values.push_back(law(j).kink({states, std::size_t(at.states)}));
    if (!std::isnan(law(j).slip_kink(0))) values.push_back(law(j).slip_kink(contact_slip_rate(j, t, y)));
    if (at.states > 0 && !law(j).set_valued()) values.push_back(contact_slip_rate(j, t, y) / at.reference_speed);
    // Many stations together answer smoothly.
    if (at.end_station - at.first_station != 1) continue;
    const Stations only = stations(j, y);
    const Station& s = *only.begin();
    double size = 0, speed = 0;
    for (const auto& [i, value] : s.normal)
      size += std::abs(value) * coordinate_scale_[i], speed += std::abs(value) * speed_scale_[i];
    const NormalLaw& law = *structure_.contacts[j].normal_law;
    const auto* profile = profile_under(&law);
    const auto [level, rise] = profile ? profile->under(0, t) : OverProfile::Height{0, 0};
    values.push_back(
        law.kink(s.normal.times(y) - s.gap + level, approach_rate(s, t, y) + rise, size, speed, preload(j, t)));
  }
}

bool StructureSystem::kinks_are_singular() const {
  return std::ranges::any_of(structure_.contacts, [](const FrictionContact& contact) {
    return contact.normal.cols() == 1 && !contact.normal_law->is_smooth_beside_kink();
  });
}

/// Contacts under regions lie each on a coordinate of its own: what the others exert on it is R without its own force.
std::vector<StructureSystem::InRegions> StructureSystem::regions(double t, const double* y) const {
  if (!has_regions_) return {};
  VectorXd R = forces_of_others(t, y, nullptr);
  return add_regions(t, y, R, nullptr);
}

/// V̇ under the contacts that stick.
Eigen::VectorXd StructureSystem::accelerations_of_surfaces(double t) const {
  VectorXd rates(stuck_.size());
  for (std::size_t s = 0; s < stuck_.size(); ++s) rates[Eigen::Index(s)] = structure_.contacts[stuck_[s]].speed.rate(t);
  return rates;
}

/// V of the contacts at their rows, 0 at the others.
Eigen::VectorXd StructureSystem::speeds_of_surfaces(double t) const {
  VectorXd V = VectorXd::Zero(n_);
  for (std::size_t j = 0; j < at_.size(); ++j)
    if (at_[j].row >= 0) V[at_[j].row] = structure_.contacts[j].speed.value(t);
  return V;
}

/// q̇ = ∂q̇/∂w (w − V): its columns of contacts have the sign of −1.
Eigen::VectorXd StructureSystem::velocity(double t, const double* y) const {
  if (is_diagonal_) return VectorXd::NullaryExpr(n_, [&](Eigen::Index i) { return velocity_of(int(i), t, y); });
  return velocity_of_speed_ * (Eigen::Map<const VectorXd>(y + n_, n_) - speeds_of_surfaces(t));
}

Eigen::VectorXd StructureSystem::acceleration(double t, const double* y) const {
  std::vector<double> f(size_);
  evaluate(t, y, f.data());
  VectorXd rate = Eigen::Map<const VectorXd>(f.data() + n_, n_).cwiseQuotient(row_mass_);
  for (std::size_t j = 0; j < at_.size(); ++j)
    if (at_[j].row >= 0) rate[at_[j].row] -= structure_.contacts[j].speed.rate(t);
  if (!is_diagonal_) return velocity_of_speed_ * rate;
  return along_.cwiseProduct(rate);
}

double StructureSystem::slip_rate(int contact, double t, const double* y) const {
  if (at_[contact].row >= 0) return y[n_ + at_[contact].row];
  const double V = structure_.contacts[contact].speed.value(t);
  if (structure_.contacts[contact].ring) return V - speed_along(contact, y, velocity(t, y));
  if (!is_diagonal_) return V - structure_.contacts[contact].tangential.dot(velocity(t, y));
  double along = 0;
  for (const auto& [i, value] : tangential_[contact]) along += value * velocity_of(i, t, y);
  return V - along;
}

/// Behind a spring the contact slips at a rate of its own.
double StructureSystem::contact_slip_rate(int contact, double t, const double* y) const {
  const At& at = at_[contact];
  if (at.rigid()) return slip_rate(contact, t, y);
  if (at.is_elastic()) {
    if (at.mode == ContactMode::stick) return 0;
    const double u = slip_rate(contact, t, y);
    const auto [N, N_rate] = load(contact, t, y);
    double stretching, F;  // of a spring at its limit: with the load
    at.contact->evaluate({u, N, N_rate, sign(at.mode)}, y + at.first, &stretching, F);
    if (!at.is_damped())
      stretching = sign(at.mode) * law(contact).static_limit(N) * at.setup.spring.compliance * N_rate;
    return u - stretching;
  }
  return at.own_slip_rate(load(contact, t, y).level, y + at.first);
}

/// R: all forces on the coordinates but those of contacts that stick. `contact_rows`: g of every contact, if asked.
Eigen::VectorXd StructureSystem::forces_without_stick(double t, const double* y, double* f) const {
  VectorXd R = forces_of_others(t, y, f);
  if (has_regions_) add_regions(t, y, R, f);
  return R;
}

/// The same without those of contacts under regions.
Eigen::VectorXd StructureSystem::forces_of_others(double t, const double* y, double* f) const {
  const Eigen::Map<const VectorXd> q(y, n_);
  const VectorXd v = C_.empty() ? VectorXd() : velocity(t, y);
  VectorXd R(n_);
  for (int i = 0; i < n_; ++i) R[i] = -K_[i].times(q) - C_[i].times(v);
  for (std::size_t i = 0; i < structure_.force.size(); ++i) R[i] += structure_.force[i].value(t);
  for (int s = 0; s < stops(); ++s)
    if (stop_mode_[s] == StopMode::pushes)
      R[structure_.stops[s].coordinate] -= structure_.stops[s].side * stop_push(s, t, y);
  for (const LimitedForce& of : structure_.limited) {
    const double cut = cut_off(of, t, y);
    R[of.coordinate] += cut;
    if (of.integral >= 0) R[of.integral] += of.tracking * cut;
  }
  for (int j = 0; j < friction_contacts(); ++j) {
    auto [N, rate] = load(j, t);
    if (follows_motion(j)) {
      if (structure_.contacts[j].load_along.size() > 0) R += N * structure_.contacts[j].load_along;
      N = 0, rate = 0;
      for (const Station& s : stations(j, y)) {
        const auto answer = this->answer(j, s, t, y);
        const double away = push_back(j, s, t, answer);
        for (const auto& [i, value] : s.normal) R[i] -= away * value;
        N += s.area * answer.bound;
      }
    }
    if (at_[j].region > 0) continue;
    double F, g[Slopes<double>::capacity];
    const bool stuck = sticks(j);
    at_[j].contact->evaluate({stuck ? 0 : slip_rate(j, t, y), N, rate, sign(at_[j].mode)}, y + at_[j].first,
                             f ? f + at_[j].first : g, F);
    if (f && at_[j].creep > 0) f[at_[j].first] -= at_[j].creep * y[at_[j].first];
    if (stuck) continue;
    if (structure_.contacts[j].ring)
      R += F * tangential(j, y);
    else
      for (const auto& [i, value] : tangential_[j]) R[i] += F * value;
  }
  return R;
}

double StructureSystem::holding(int contact, double t, const VectorXd& R) const {
  const int row = at_[contact].row;
  return -R[row] + row_mass_[row] * structure_.contacts[contact].speed.rate(t);
}

std::vector<StructureSystem::InRegions> StructureSystem::add_regions(double t, const double* y, VectorXd& R,
                                                                     double* f) const {
  std::vector<InRegions> found;
  for (int j = 0; j < friction_contacts(); ++j) {
    const At& at = at_[j];
    if (at.region == 0) continue;
    const auto [N, rate] = load(j, t, y);
    const double u = slip_rate(j, t, y), holds = holding(j, t, R);
    double slip, g[Slopes<double>::capacity];
    at.contact->evaluate({u, N, rate, 1}, y + at.first, f ? f + at.first : g, slip);
    found.push_back({j, laws::region_friction(u, at.region, slip, holds).force, holds, slip});
    R[at.row] += found.back().force;
  }
  return found;
}

void StructureSystem::mass(double t, double* m) const {
  std::fill(m, m + n_, 1.0);
  std::copy(row_mass_.data(), row_mass_.data() + n_, m + n_);
  for (int j = 0; j < friction_contacts(); ++j) {
    at_[j].contact->mass(load(j, t).level, m + at_[j].first);
    if (is_at_limit(at_[j])) m[at_[j].first] = 0;
  }
}

void StructureSystem::evaluate(double t, const double* y, double* f) const {
  const VectorXd R = forces_without_stick(t, y, f);
  Eigen::Map<VectorXd> rate(f + n_, n_);
  if (is_diagonal_) {
    for (int i = 0; i < n_; ++i) f[i] = velocity_of(i, t, y);
    rate = along_.cwiseProduct(R);
    for (const int j : switching_)
      if (sticks(j)) rate[at_[j].row] = 0;
  } else {
    Eigen::Map<VectorXd>(f, n_) = velocity(t, y);
    rate.noalias() = acceleration_ * R;
  }
  for (int j = 0; j < friction_contacts(); ++j)
    if (at_[j].row >= 0 && !sticks(j)) rate[at_[j].row] += row_mass_[at_[j].row] * structure_.contacts[j].speed.rate(t);
  if (!stuck_.empty()) rate += acceleration_of_surfaces_ * accelerations_of_surfaces(t);
  for (int s = 0; s < stops(); ++s) {
    if (!stop_holds(s, t)) continue;
    const int i = structure_.stops[s].coordinate;
    f[i] = 0, rate[i] = row_mass_[i] * surface_acceleration(i, t);
  }
}

void StructureSystem::linearise(double t, const double* y, double* f, double* jacobian) const {
  Eigen::Map<RowMajor> J(jacobian, size_, size_);
  J.setZero();
  if (is_diagonal_) {
    std::vector<double> entries(pattern_.entries());
    linearise_entries(t, y, f, entries.data());
    for (int i = 0; i < size_; ++i)
      for (int e = pattern_.row_begin[i]; e < pattern_.row_begin[i + 1]; ++e) J(i, pattern_.column[e]) = entries[e];
    return;
  }
  evaluate(t, y, f);
  J.block(0, n_, n_, n_) = velocity_of_speed_;
  MatrixXd R_q = -structure_.K, R_w = -structure_.C * velocity_of_speed_;
  for (int s = 0; s < stops(); ++s) {
    if (stop_mode_[s] != StopMode::pushes) continue;
    const auto& [i, at, side, restitution, k, c] = structure_.stops[s];
    R_q(i, i) -= k;
    R_w.row(i) -= c * velocity_of_speed_.row(i);
  }
  for (const LimitedForce& of : structure_.limited) {
    if (cut_off(of, t, y) == 0) continue;
    const auto add = [&](int row, double part) {
      R_q(row, of.coordinate) += part * of.stiffness;
      R_w.row(row) += part * of.damping * velocity_of_speed_.row(of.coordinate);
      if (of.integral >= 0) R_q(row, of.integral) -= part;
    };
    add(of.coordinate, 1);
    if (of.integral >= 0) add(of.integral, of.tracking);
  }
  for (int j = 0; j < friction_contacts(); ++j) {
    const At& at = at_[j];
    const VectorXd direction = tangential(j, y);
    const int nz = at.contact->unknowns();
    const auto [N, rate] = load(j, t, y);
    const bool stuck = sticks(j);
    double F, g[Slopes<double>::capacity];
    Slopes<double> slopes;
    at.contact->linearise({stuck ? 0 : slip_rate(j, t, y), N, rate, sign(at.mode)}, y + at.first, g, F, slopes);
    for (int a = 0; a < nz; ++a)
      for (int b = 0; b < nz; ++b) J(at.first + a, at.first + b) = slopes.g_z[a * nz + b];
    if (at.creep > 0) J(at.first, at.first) -= at.creep;
    Eigen::RowVectorXd N_q = Eigen::RowVectorXd::Zero(n_), N_w = N_q;
    if (follows_motion(j)) {
      for (const Station& s : stations(j, y)) {
        const auto answer = this->answer(j, s, t, y);
        const double area = s.area;
        const VectorXd normal = s.normal.dense(n_);
        const Eigen::RowVectorXd by_w = normal.transpose() * velocity_of_speed_;
        R_q -= normal * (area * answer.pressure_by_approach * normal.transpose());
        R_w -= normal * (area * answer.pressure_by_rate * by_w);
        N_q += area * answer.bound_by_approach * normal.transpose();
        N_w += area * answer.bound_by_rate * by_w;
      }
      if (!stuck) {
        R_q += slopes.F_N * direction * N_q;
        R_w += slopes.F_N * direction * N_w;
      }
      for (int a = 0; a < nz; ++a) {
        J.block(at.first + a, 0, 1, n_) += slopes.g_N[a] * N_q;
        J.block(at.first + a, n_, 1, n_) += slopes.g_N[a] * N_w;
      }
    }
    if (stuck) continue;
    if (structure_.contacts[j].ring) add_turning(j, t, y, F, slopes, R_q, J);
    Eigen::RowVectorXd u_w = Eigen::RowVectorXd::Zero(n_);
    if (at.row >= 0)
      u_w[at.row] = 1;
    else
      u_w = -direction.transpose() * velocity_of_speed_;
    R_w += slopes.F_u * direction * u_w;
    for (int a = 0; a < nz; ++a) {
      J.block(at.first + a, n_, 1, n_) += slopes.g_u[a] * u_w;
      J.block(n_, at.first + a, n_, 1) = acceleration_ * direction * slopes.F_z[a];
    }
  }
  J.block(n_, 0, n_, n_) = acceleration_ * R_q;
  J.block(n_, n_, n_, n_) = acceleration_ * R_w;
}

/// What the turning of a ring's directions adds: dn = κ t tᵀ dq and dt = −κ n tᵀ dq, with κ the curvature, turn the
/// forces and, of velocities, the slip rate and the approach rate.
void StructureSystem::add_turning(int j, double t, const double* y, double F, const Slopes<double>& slopes,
                                  MatrixXd& R_q, Eigen::Ref<RowMajor> J) const {
  const At& at = at_[j];
  const Stations only = stations(j, y);
  const Station& station = *only.begin();
  const double curvature = turn(j, y).curvature;
  const auto answer = this->answer(j, station, t, y);
  const VectorXd along = tangential(j, y), normal = turned_normal(j, y), v = velocity(t, y);
  const double u_turn = curvature * normal.dot(v), rate_turn = curvature * along.dot(v);
  const double N_turn = station.area * answer.bound_by_rate * rate_turn;
  const double by_normal = -curvature * F - station.area * answer.pressure_by_rate * rate_turn,
               by_tangent = -curvature * push_back(j, station, t, answer) + slopes.F_u * u_turn + slopes.F_N * N_turn;
  R_q += (by_normal * normal + by_tangent * along) * along.transpose();
  for (int a = 0; a < at.contact->unknowns(); ++a)
    J.block(at.first + a, 0, 1, n_) += (slopes.g_u[a] * u_turn + slopes.g_N[a] * N_turn) * along.transpose();
}

void StructureSystem::held(double t, const double* y, Held* held) const {
  constexpr double digits = 8 * std::numeric_limits<double>::epsilon();
  for (int i = 0; i < contacts(); ++i) {
    const At& at = at_[switching_[i]];
    if (!at.is_elastic() || at.mode != ContactMode::stick) continue;
    const auto [N, rate] = load(switching_[i], t, y);
    double F, stretching;
    at.contact->evaluate({slip_rate(switching_[i], t, y), N, rate, 0}, y + at.first, &stretching, F);
    constexpr double nothing = 1e-10;  // of the natural load: the contact opens or closes
    const double limit = N > nothing * at.natural_load ? at.limit_at_rest(N, y + at.first) : 0;
    held[i] = {F, limit, digits * (limit + std::abs(F))};
  }
  const bool any = std::ranges::any_of(switching_, [&](int j) { return sticks(j); });
  if (!any) return;
  const VectorXd R = forces_without_stick(t, y, nullptr);
  const VectorXd terms = K_.size_of_terms(Eigen::Map<const VectorXd>(y, n_));
  VectorXd F, rounding;
  if (!is_diagonal_) {
    F = holding_ * R + holding_of_surface_ * accelerations_of_surfaces(t);
    rounding = holding_.cwiseAbs() * terms;
  }
  int s = 0;  // among those that stick
  for (int i = 0; i < contacts(); ++i) {
    const int j = switching_[i];
    if (!sticks(j)) continue;
    const double N = load(j, t, y).level;
    const double limit = at_[j].limit_at_rest(N, y + at_[j].first);
    if (is_diagonal_) {
      const int row = at_[j].row;
      held[i] = {holding_alone_[j] * R[row] + holding_of_surface_alone_[j] * structure_.contacts[j].speed.rate(t),
                 limit, digits * (limit + std::abs(holding_alone_[j]) * terms[row])};
      for (int stop = 0; stop < stops(); ++stop) {
        if (stop_mode_[stop] != StopMode::holds || structure_.stops[stop].coordinate != row) continue;
        if (contact_beside_stop(stop, t) == i)
          held[i].force = structure_.stops[stop].side * std::max(structure_.stops[stop].side * held[i].force, 0.0);
        else  // the surface takes nothing along
          held[i] = {row_mass_[row] * structure_.contacts[j].speed.rate(t), 0, 0};
      }
    } else {
      held[i] = {F[s], limit, digits * (limit + rounding[s])};
    }
    ++s;
  }
}

void StructureSystem::slip_accelerations(double t, const double* y, double* acceleration) const {
  std::vector<double> f(size_);
  evaluate(t, y, f.data());
  for (int i = 0; i < contacts(); ++i) {
    const int row = at_[switching_[i]].row;
    if (mode(i) != ContactMode::stick && !is_elastic(i)) acceleration[i] = f[n_ + row] / row_mass_[row];
  }
}

double StructureSystem::displacement(int contact, const double* y) const {
  const auto& direction = structure_.contacts[switching_[contact]].tangential;
  return direction.dot(Eigen::Map<const Eigen::VectorXd>(y, n_)) / direction.squaredNorm();
}

void StructureSystem::stop(int contact, double* y) const {
  if (is_elastic(contact)) return;
  y[slip_rate_unknown(contact)] = 0;
  const At& at = at_[switching_[contact]];
  at.stop(y + at.first);
}

/// Moves the contact along its direction by what its own spring needs.
void StructureSystem::release(int contact, double t, double* y) const {
  const int j = switching_[contact];
  const VectorXd& direction = structure_.contacts[j].tangential;
  std::vector<double> acceleration(contacts());
  slip_accelerations(t, y, acceleration.data());
  const double effective_mass = 1 / mobility(j);
  const double N = load(j, t, y).level, along = sign(mode(contact));
  constexpr double digits = 8 * std::numeric_limits<double>::epsilon();
  const VectorXd terms = K_.size_of_terms(Eigen::Map<const VectorXd>(y, n_));
  double rounding = 0;  // of the acceleration
  if (is_diagonal_)
    for (const auto& [i, value] : tangential_[j]) rounding += std::abs(value / structure_.M(i, i)) * terms[i];
  else
    rounding = (inverse_mass_ * direction).cwiseAbs().dot(terms);
  const double sure =
      digits * (N * law(j).steady_friction({reference_speed(contact), N}).friction + effective_mass * rounding);
  const double driving = along * effective_mass * acceleration[contact], k = stiffness_along(j);
  if (k > 0 && driving < sure) Eigen::Map<VectorXd>(y, n_) += along * (sure - driving) / k * direction;
}

void StructureSystem::scale(const double* y, double* s) const {
  for (int i = 0; i < n_; ++i) {
    s[i] = std::max(coordinate_scale_[i], is_held_[i] ? 0 : std::abs(y[i]));
    s[n_ + i] = std::max(speed_scale_[i], std::abs(y[n_ + i]));
  }
  for (int j = 0; j < friction_contacts(); ++j) {
    const At& at = at_[j];
    at.scale(y + at.first, s + at.first);
  }
}

std::string StructureSystem::unknown(int i) const {
  const auto coordinate = [&](int k) {
    return structure_.names.empty() ? fmt::format("q{}", k + 1) : structure_.names[k];
  };
  if (i < n_) return coordinate(i);
  if (i < 2 * n_) {
    for (std::size_t j = 0; j < at_.size(); ++j)
      if (at_[j].row == i - n_) return at_.size() == 1 ? "slip rate" : fmt::format("slip rate of contact {}", j + 1);
    return "velocity of " + coordinate(i - n_);
  }
  for (std::size_t j = 0; j < at_.size(); ++j) {
    const int k = i - at_[j].first;
    if (k >= 0 && k < at_[j].contact->unknowns())
      return at_[j].unknown(k) + (at_.size() == 1 ? "" : fmt::format(" of contact {}", j + 1));
  }
  return "";
}

double StructureSystem::next_break(double t) const {
  double next = infinity;
  for (const Signal& f : structure_.force) next = std::min(next, f.next_break(t));
  for (const LimitedForce& of : structure_.limited) next = std::min(next, of.command.next_break(t));
  for (const SampledServo& of : structure_.sampled) next = std::min(next, of.next_sample(t));
  for (const auto& c : structure_.contacts) next = std::min({next, c.speed.next_break(t), c.normal_load.next_break(t)});
  return next;
}

double StructureSystem::resolution() const {
  double shortest = infinity;
  for (const Signal& f : structure_.force) shortest = std::min(shortest, f.resolution());
  for (const auto& c : structure_.contacts) {
    shortest = std::min({shortest, c.speed.resolution(), c.normal_load.resolution()});
    if (const auto* profile = profile_under(c.normal_law.get()))
      shortest = std::min(shortest, profile->height().resolution());
  }
  return shortest;
}

void StructureSystem::sample(double t, double* y) const {
  for (const SampledServo& of : structure_.sampled) {
    if (!of.is_sample(t)) continue;
    const Servo& servo = of.servo;
    const double x = of.read(y[servo.coordinate]), h = servo.sampling_time;
    double v = 0;
    if (servo.reads_differences()) {
      v = (servo.filter * y[of.speed()] + x - y[of.reading()]) / (servo.filter + h);
      y[of.reading()] = x, y[of.speed()] = v;
    } else {
      v = velocity(t, y)[servo.coordinate];
    }
    const double error = servo.reference.value(t) - x;
    double u = servo.proportional * error - servo.derivative * v;
    if (servo.feedforward > 0) u += servo.feedforward * servo.reference.rate(t);
    if (of.integral() >= 0) u += y[of.integral()];
    const double limited = std::clamp(u, -servo.limit, servo.limit);
    if (of.integral() >= 0) y[of.integral()] += h * (servo.integral * error - (u - limited) / servo.anti_windup);
    y[of.held] = limited;
  }
}

void StructureSystem::begin_sampling(double* y) const {
  for (const SampledServo& of : structure_.sampled)
    if (of.reading() >= 0) y[of.reading()] = of.read(y[of.servo.coordinate]);
  sample(0, y);
}

/// Velocities and the forces in contact springs are continuous; friction of rigid contacts follows their slip rate.
void StructureSystem::cross_break(double t, double* y) const {
  const double before = std::nextafter(t, -infinity);
  for (int j = 0; j < friction_contacts(); ++j) {
    At const& at = at_[j];
    const FrictionContact& contact = structure_.contacts[j];
    double* z = y + at.first;
    const double N = load(j, before, y).level, changed = load(j, t, y).level;
    if (N != changed) at.contact->change_load(slip_rate(j, before, y), N, changed, z);
    if (at.is_elastic() && !at.is_damped() && N != changed) {  // a spring bears no more than the limit
      const double most =
          law(j).static_limit(changed) * (at.setup.spring.compliance * changed + at.setup.spring.compliance_per_load);
      z[0] = std::clamp(z[0], -most, most);
    }
    if (at.row >= 0) y[n_ + at.row] += contact.speed.value(t) - contact.speed.value(before);
    if (!at.carries_friction()) continue;
    if (at.rigid())
      at.make_friction_fit(slip_rate(j, t, y), changed, z);
    else if (at.setup.compliance_per_load == 0)
      z[0] *= N / changed;
  }
}

std::vector<double> StructureSystem::states(int contact, double t, const double* y) const {
  const At& at = at_[contact];
  return at.natural_states(slip_rate(contact, t, y), load(contact, t, y).level, y + at.first);
}

void StructureSystem::friction_forces(double t, const double* y, double* force) const {
  std::vector<Held> held(contacts());
  this->held(t, y, held.data());
  for (int c = 0; c < contacts(); ++c) force[switching_[c]] = held[c].force;
  for (const auto& at : regions(t, y)) force[at.contact] = at.force;
  for (int j = 0; j < friction_contacts(); ++j) {
    if (sticks(j) || at_[j].region > 0) continue;
    const auto [N, rate] = load(j, t, y);
    double g[Slopes<double>::capacity];
    at_[j].contact->evaluate({slip_rate(j, t, y), N, rate, sign(at_[j].mode)}, y + at_[j].first, g, force[j]);
  }
}

std::vector<double> StructureSystem::unknowns_at(double t, const VectorXd& q, const VectorXd& velocity,
                                                 const std::vector<std::vector<double>>& states) const {
  std::vector<double> y(size_);
  Eigen::Map<VectorXd>(y.data(), n_) = q;
  Eigen::Map<VectorXd>(y.data() + n_, n_) = velocity;
  for (int j = 0; j < friction_contacts(); ++j)
    if (at_[j].row >= 0) y[n_ + at_[j].row] = structure_.contacts[j].speed.value(t) - along(j, velocity);
  for (int j = 0; j < friction_contacts(); ++j) {
    const At& at = at_[j];
    const double N = load(j, t, y.data()).level, u = slip_rate(j, t, y.data());
    const std::vector<double> state = j < int(states.size()) && !states[j].empty() ? states[j]
                                      : u == 0                                     ? law(j).rest(N)
                                                                                   : law(j).steady({u, N});
    double* z = y.data() + at.first;
    if (at.carries_friction()) z[0] = at.rigid() ? law(j).friction({u, N}, state) : 0;
    if (at.states > 0) at.write_states(state, z);
    if (const int v = at.slip_rate_place(); v >= 0) z[v] = u;  // and a deflection of 0
  }
  return y;
}

/// Coordinates where contacts whose normals give way bear their loads without friction: each as a spring from where it
/// touches to where it bears N₀.
VectorXd StructureSystem::touching(double t) const {
  VectorXd force = VectorXd::Zero(n_);
  MatrixXd K = structure_.K;
  bool any = false;
  for (std::size_t i = 0; i < structure_.force.size(); ++i) force[Eigen::Index(i)] = structure_.force[i].value(t);
  for (int j = 0; j < friction_contacts(); ++j) {
    if (!follows_motion(j)) continue;
    const auto& contact = structure_.contacts[j];
    const double p = preload(j, t), a = contact.normal_law->approach_under(p);
    if (!(a > 0)) continue;
    any = true;
    if (contact.load_along.size() > 0) force += load(j, t).level * contact.load_along;
    for (int s = at_[j].first_station; s < at_[j].end_station; ++s) {
      const VectorXd normal = contact.normal.col(s - at_[j].first_station);
      const double k = station_[s].area * p / a;
      K += k * normal * normal.transpose();
      force += (k * station_[s].gap + (station_[s].preloaded ? load(j, t).level : 0)) * normal;
    }
  }
  return any ? solve_stiffness(K, force).value_or(VectorXd::Zero(n_)) : VectorXd::Zero(n_);
}

/// At the surface's own speed (N).
double StructureSystem::steady_friction(int contact, double t, double N) const {
  const double V = structure_.contacts[contact].speed.value(t);
  return V == 0 || N == 0 ? 0 : N * law(contact).steady_friction({V, N}).friction;
}

/// Newton's method for K q = f + Σ (t F − n (N − N₀)), at rest, with a part of the friction of steady sliding.
StructureSystem::Balance StructureSystem::balance(double t, double part, VectorXd& q) const {
  const auto friction = [&](int j, double N) { return part * steady_friction(j, t, N); };
  std::vector<double> y(2 * n_);  // q, and speeds of slip at the surfaces' own
  for (std::size_t j = 0; j < at_.size(); ++j)
    if (at_[j].row >= 0) y[n_ + at_[j].row] = structure_.contacts[j].speed.value(t);
  VectorXd residual, size;
  MatrixXd slope;
  const auto evaluate = [&](const VectorXd& at) {
    Eigen::Map<VectorXd>(y.data(), n_) = at;
    residual = -(K_ * at), size = K_.size_of_terms(at);
    slope = structure_.K;
    for (std::size_t i = 0; i < structure_.force.size(); ++i) {
      residual[i] += structure_.force[i].value(t);
      size[i] += std::abs(structure_.force[i].value(t));
    }
    for (int j = 0; j < friction_contacts(); ++j) {
      const auto& contact = structure_.contacts[j];
      const double N = load(j, t, y.data()).level, F = friction(j, N);
      const VectorXd direction = tangential(j, y.data());
      residual += F * direction, size += std::abs(F) * direction.cwiseAbs();
      if (!follows_motion(j)) continue;
      if (const auto& along = contact.load_along; along.size() > 0)
        residual += load(j, t).level * along, size += std::abs(load(j, t).level) * along.cwiseAbs();
      constexpr double aside = 1e-6;
      const double dN = aside * std::max(std::abs(N), 1e-300), F_N = (friction(j, N + dN) - F) / dN;
      for (const Station& s : stations(j, y.data())) {
        const auto answer = this->answer(j, s, t, y.data());
        const double away = push_back(j, s, t, answer);
        const VectorXd normal = s.normal.dense(n_);
        residual -= away * normal;
        size += std::max(std::abs(away), s.area * std::abs(answer.pressure)) * normal.cwiseAbs();
        slope += s.area * (answer.pressure_by_approach * normal - F_N * answer.bound_by_approach * direction) *
                 normal.transpose();
        if (contact.ring)
          slope += turn(j, y.data()).curvature * (away * direction + F * normal) * direction.transpose();
      }
    }
  };
  // Work of what is left over, in sizes of the coordinates: forces and moments compare.
  const auto work = [&] { return residual.cwiseProduct(coordinate_scale_).norm(); };
  constexpr int most_iterations = 50, most_halvings = 20;
  constexpr double rounding = 1e-13;
  evaluate(q);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (iteration > 0 && (residual.cwiseAbs() - rounding * size).maxCoeff() <= 0) return {true, true, iteration, 0};
    const auto change = solve_stiffness(slope, residual);
    if (!change) return {false, false, iteration, residual.cwiseAbs().maxCoeff()};
    const VectorXd from = q;
    const double before = work();
    double length = 1;
    evaluate(q = from + *change);
    for (int halving = 0; !(work() <= before) && halving < most_halvings; ++halving)
      evaluate(q = from + (length *= 0.5) * *change);
    // Rounding ends the descent where forces of stiff springs nearly cancel.
    if (length < 1e-3 && before <= 1e3 * rounding * size.cwiseProduct(coordinate_scale_).norm()) {
      q = from;
      return {true, true, iteration, 0};
    }
  }
  return {false, true, most_iterations, residual.cwiseAbs().maxCoeff()};
}

/// Friction that has no answer at once is put on in steps.
std::vector<double> StructureSystem::steady(double t) const {
  if (!structure_.sampled.empty())
    throw NoSteadySliding(
        "a servo that samples holds its force in between and answers no motion there, so that no steady sliding "
        "follows "
        "from a balance of forces; give start = \"rest\"");
  const VectorXd without = touching(t);
  VectorXd q = without;
  const auto all_of_it = balance(t, 1, q);
  auto found = all_of_it;
  if (!found.converged) {
    constexpr double shortest = 1.0 / 4096;
    VectorXd reached = without;
    double part = 0, step = 0.25;
    bool begins = balance(t, 0, reached).converged;
    while (begins && part < 1 && step >= shortest) {
      q = reached;
      const double next = std::min(1.0, part + step);
      if (auto there = balance(t, next, q); there.converged)
        reached = q, part = next, step *= 2, found = there;
      else
        step /= 2, found.converged = false;
    }
    found.converged = found.converged && part >= 1;
  }
  if (!found.converged && !found.held)
    throw NoSteadySliding("K has no inverse: a structure that no spring holds has no steady sliding (stiffness, N/m)");
  if (!found.converged && !all_of_it.held)
    throw NoSteadySliding(
        "friction locks the structure: with all of it the tangent of steady sliding has no inverse, and the load "
        "grows without bound");
  if (!found.converged || !q.allFinite())
    throw NoSteadySliding(
        fmt::format("no steady sliding was found: after {} steps of Newton's method forces are {:.1e} N apart",
                    found.iterations, found.left));
  auto start = unknowns_at(t, q, VectorXd::Zero(n_));
  for (int j = 0; j < friction_contacts(); ++j) {
    const At& at = at_[j];
    const double N = load(j, t, start.data()).level;
    if (at.rigid()) continue;
    const double F = steady_friction(j, t, N);
    if (at.carries_friction()) start[at.first] = F / N;
    if (at.setup.spring.present()) {
      const double compliance = at.setup.spring.compliance + at.setup.spring.compliance_per_load / N;
      start[at.first + at.contact->unknowns() - 1] = F * compliance;
    }
  }
  for (const LimitedForce& of : structure_.limited)
    if (const double u = unlimited(of, t, start.data()); std::abs(u) > of.limit)
      throw NoSteadySliding(fmt::format(
          "steady sliding would need a force of {:.6g} N of the servo, whose limit is {:.6g} N", u, of.limit));
  return start;
}

}  // namespace rosin::oscillators
