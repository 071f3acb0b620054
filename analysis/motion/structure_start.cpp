/// Unknowns of a structure at its start.
#include "analysis/motion/structure_start.hpp"

namespace rosin::analysis::motion {

using Eigen::VectorXd;

std::vector<double> starting_point(const oscillators::StructureSystem& system, const StructureStart& start) {
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
  if (!given && !steady.empty()) return steady;
  // At rest no contact slips: slip rates and the speeds of other coordinates are 0.
  if (start.kind == Start::Kind::rest) velocity = system.velocity(0, std::vector<double>(system.size()).data());
  return system.unknowns_at(0, q, velocity);
}

}  // namespace rosin::analysis::motion
