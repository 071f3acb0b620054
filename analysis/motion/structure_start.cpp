/// Unknowns of a structure at its start.
#include "analysis/motion/structure_start.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rosin::analysis::motion {

using Eigen::VectorXd;

namespace {
/// \throws InputError for a start behind a rigid stop, or on it and moving into it.
void check_stops(const oscillators::StructureSystem& system, const VectorXd& q, const VectorXd& velocity) {
  for (const auto& stop : system.structure().stops) {
    const double x = q[stop.coordinate], v = velocity[stop.coordinate];
    const auto name = system.unknown(stop.coordinate);
    if (!stop.rigid()) continue;
    if (stop.side * (x - stop.at) > 0)
      throw InputError(fmt::format("the start at {} = {:.9g} m lies behind the stop at {:.9g} m; give one {} it", name,
                                   x, stop.at, stop.side > 0 ? "below" : "above"));
    if (x == stop.at && stop.side * v > 0)
      throw InputError(fmt::format("{} starts on the stop at {:.9g} m and moves into it with {:.9g} m/s", name, stop.at,
                                   std::abs(v)));
  }
}
}  // namespace

namespace {
std::vector<double> before_sampling(const oscillators::StructureSystem& system, const StructureStart& start) {
  const int n = system.coordinates();
  std::vector<double> steady;
  if (start.kind == Start::Kind::steady) steady = system.steady(0);
  VectorXd q = VectorXd::Zero(n), velocity = VectorXd::Zero(n);
  if (!steady.empty()) q = Eigen::Map<const VectorXd>(steady.data(), n);
  bool given = false;
  const auto take = [&](const std::vector<std::optional<double>>& values, VectorXd& into) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i]) into[i] = *values[i], given = true;
  };
  take(start.coordinates, q);
  take(start.velocities, velocity);
  if (start.beside.size() > 0) q += start.beside, given = true;
  // At rest no contact slips: slip rates and the speeds of other coordinates are 0.
  if (start.kind == Start::Kind::rest) velocity = system.velocity(0, std::vector<double>(system.size()).data());
  check_stops(system, q, velocity);
  if (!given && !steady.empty()) return steady;
  auto y = system.unknowns_at(0, q, velocity);
  std::vector<std::vector<double>> states(start.states.size());
  for (std::size_t j = 0; j < states.size(); ++j) {
    if (start.states[j].empty()) continue;
    const auto& contact = system.structure().contacts[j];
    if (contact.lambda == 0)
      throw InputError(fmt::format("start: the states of contact {} follow its slip rate at once (lambda = 0)", j + 1));
    states[j] = system.states(int(j), 0, y.data());
    take_states(*contact.law, start.states[j], states[j]);
    given = true;
  }
  return given ? system.unknowns_at(0, q, velocity, states) : y;
}
}  // namespace

std::vector<double> starting_point(const oscillators::StructureSystem& system, const StructureStart& start) {
  if (!start.unknowns.empty()) return start.unknowns;
  auto y = before_sampling(system, start);
  system.begin_sampling(y.data());
  return y;
}

}  // namespace rosin::analysis::motion
