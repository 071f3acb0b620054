/// Where entries of a structure's Jacobian stand if each speed belongs to a mass of its own, and the entries.
#include <algorithm>

#include "laws/regions.hpp"
#include "oscillators/structure_system.hpp"

namespace rosin::oscillators {

namespace {
void sort_rows(const std::vector<std::vector<int>>& rows, Pattern& pattern) {
  pattern.row_begin = {0};
  for (std::vector<int> row : rows) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    pattern.column.insert(pattern.column.end(), row.begin(), row.end());
    pattern.row_begin.push_back(int(pattern.column.size()));
  }
}
}  // namespace

void StructureSystem::find_pattern() {
  std::vector<std::vector<int>> rows(size_);
  for (int i = 0; i < size_; ++i) rows[i].push_back(i);
  for (int i = 0; i < n_; ++i) {
    rows[i].push_back(n_ + i);
    for (const auto& [k, value] : K_[i]) rows[n_ + i].push_back(k);
    for (const auto& [k, value] : C_[i]) rows[n_ + i].push_back(n_ + k);
  }
  for (const Stop& stop : structure_.stops)
    rows[n_ + stop.coordinate].push_back(stop.coordinate), rows[n_ + stop.coordinate].push_back(n_ + stop.coordinate);
  for (const LimitedForce& of : structure_.limited) {
    std::vector<int> columns = {of.coordinate, n_ + of.coordinate};
    if (of.integral >= 0) columns.push_back(of.integral);
    for (const int row : {of.coordinate, of.integral})
      if (row >= 0) rows[n_ + row].insert(rows[n_ + row].end(), columns.begin(), columns.end());
  }
  for (int j = 0; j < friction_contacts(); ++j) {
    const At& at = at_[j];
    std::vector<int> own, by_motion;  // rows of the contact's unknowns, and columns that its slip rate and load are of
    for (int a = 0; a < at.contact->unknowns(); ++a) own.push_back(at.first + a);
    if (at.row >= 0)
      by_motion.push_back(n_ + at.row);
    else
      for (const auto& [k, value] : tangential_[j]) by_motion.push_back(n_ + k);
    for (int s = at.first_station; s < at.end_station; ++s)
      for (const auto& [k, value] : station_[s].normal) by_motion.push_back(k), by_motion.push_back(n_ + k);
    const auto add = [&](int row, const std::vector<int>& columns) {
      rows[row].insert(rows[row].end(), columns.begin(), columns.end());
    };
    for (const int row : own) add(row, own), add(row, by_motion);
    for (const auto& [i, value] : tangential_[j]) add(n_ + i, own), add(n_ + i, by_motion);
    for (int s = at.first_station; s < at.end_station; ++s)
      for (const auto& [i, value] : station_[s].normal) add(n_ + i, by_motion);
  }
  sort_rows(rows, pattern_);
}

void StructureSystem::linearise_entries(double t, const double* y, double* f, double* entries) const {
  evaluate(t, y, f);
  std::fill(entries, entries + pattern_.entries(), 0.0);
  const auto entry = [&](int row, int column) -> double& { return entries[pattern_.place(row, column)]; };
  // Rows of the speeds first as forces on the coordinates.
  for (int i = 0; i < n_; ++i) {
    entry(i, n_ + i) = along_[i];
    for (const auto& [k, value] : K_[i]) entry(n_ + i, k) = -value;
    for (const auto& [k, value] : C_[i]) entry(n_ + i, n_ + k) = -value * along_[k];
  }
  for (int s = 0; s < stops(); ++s) {
    if (stop_mode_[s] != StopMode::pushes) continue;
    const auto& [i, at, side, restitution, k, c] = structure_.stops[s];
    entry(n_ + i, i) -= k, entry(n_ + i, n_ + i) -= c * along_[i];
  }
  for (const LimitedForce& of : structure_.limited) {
    if (cut_off(of, t, y) == 0) continue;
    const int x = of.coordinate;
    const auto add = [&](int row, double part) {
      entry(n_ + row, x) += part * of.stiffness, entry(n_ + row, n_ + x) += part * of.damping * along_[x];
      if (of.integral >= 0) entry(n_ + row, of.integral) -= part;
    };
    add(x, 1);
    if (of.integral >= 0) add(of.integral, of.tracking);
  }
  // Contacts under regions come last: their friction answers to all other forces on their coordinate.
  const auto of_regions = regions(t, y);
  auto of_region = of_regions.begin();
  for (int place = 0; place < (has_regions_ ? 2 : 1) * friction_contacts(); ++place) {
    const int j = place % friction_contacts();
    if ((at_[j].region > 0) != (place >= friction_contacts())) continue;
    const At& at = at_[j];
    const int nz = at.contact->unknowns();
    const auto [N, rate] = load(j, t, y);
    const bool stuck = sticks(j);
    double F, g[Slopes<double>::capacity];
    Slopes<double> slopes;
    at.contact->linearise({stuck ? 0 : slip_rate(j, t, y), N, rate, sign(at.mode)}, y + at.first, g, F, slopes);
    for (int a = 0; a < nz; ++a)
      for (int b = 0; b < nz; ++b) entry(at.first + a, at.first + b) = slopes.g_z[a * nz + b];
    if (at.creep > 0) entry(at.first, at.first) -= at.creep;
    if (at.region > 0) {
      const double u = slip_rate(j, t, y);
      const auto by = laws::region_friction(u, at.region, F, (of_region++)->holding);
      for (int e = pattern_.row_begin[n_ + at.row]; e < pattern_.row_begin[n_ + at.row + 1]; ++e)
        entries[e] *= 1 - by.by_holding;
      slopes.F_u = by.by_slip * slopes.F_u + by.by_slip_rate, slopes.F_N *= by.by_slip;
      for (int a = 0; a < nz; ++a) slopes.F_z[a] *= by.by_slip;
    }
    for (const Station& s : stations(j, y)) {
      const auto answer = this->answer(j, s, t, y);
      const double area = s.area;
      for (const auto& [k, normal] : s.normal) {
        const double p_q = area * answer.pressure_by_approach * normal;
        const double p_w = area * answer.pressure_by_rate * normal * along_[k];
        for (const auto& [i, value] : s.normal) entry(n_ + i, k) -= value * p_q, entry(n_ + i, n_ + k) -= value * p_w;
        const double N_q = area * answer.bound_by_approach * normal;
        const double N_w = area * answer.bound_by_rate * normal * along_[k];
        if (!stuck)
          for (const auto& [i, value] : tangential_[j])
            entry(n_ + i, k) += slopes.F_N * value * N_q, entry(n_ + i, n_ + k) += slopes.F_N * value * N_w;
        for (int a = 0; a < nz; ++a)
          entry(at.first + a, k) += slopes.g_N[a] * N_q, entry(at.first + a, n_ + k) += slopes.g_N[a] * N_w;
      }
    }
    if (stuck) continue;
    const auto by_slip_rate = [&](int speed, double u_w) {
      for (const auto& [i, value] : tangential_[j]) entry(n_ + i, n_ + speed) += slopes.F_u * value * u_w;
      for (int a = 0; a < nz; ++a) entry(at.first + a, n_ + speed) += slopes.g_u[a] * u_w;
    };
    if (at.row >= 0)
      by_slip_rate(at.row, 1);
    else
      for (const auto& [k, value] : tangential_[j]) by_slip_rate(k, -value * along_[k]);
    for (const auto& [i, value] : tangential_[j])
      for (int a = 0; a < nz; ++a) entry(n_ + i, at.first + a) = value * slopes.F_z[a];
  }
  const auto scale_row = [&](int row, double factor) {
    for (int e = pattern_.row_begin[row]; e < pattern_.row_begin[row + 1]; ++e) entries[e] *= factor;
  };
  for (int i = 0; i < n_; ++i) scale_row(n_ + i, along_[i]);
  const auto clear_row = [&](int row) {
    std::fill(entries + pattern_.row_begin[row], entries + pattern_.row_begin[row + 1], 0.0);
  };
  for (int j = 0; j < friction_contacts(); ++j)
    if (sticks(j)) clear_row(n_ + at_[j].row);
  for (int s = 0; s < stops(); ++s)
    if (stop_holds(s, t)) clear_row(structure_.stops[s].coordinate), clear_row(n_ + structure_.stops[s].coordinate);
}

}  // namespace rosin::oscillators
