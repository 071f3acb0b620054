/// A parameter plane of a structure, of a slider under a drive that varies, or of an oscillator that is followed by
/// steps: each point computed by itself.
#pragma once
#include <functional>
#include <string_view>

#include "analysis/motion/stepped_oscillator.hpp"
#include "analysis/motion/structure_start.hpp"
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// Metrics of steady sliding, which take no integration: "growth_rate" (1/s, the largest), "unstable_modes", the number
/// of modes that grow, "criticality", the normal form's coefficient of the oscillation that grows most or decays
/// least, and "probability_unstable", the share of draws of uncertain inputs in which a mode grows.
bool is_of_sliding(std::string_view metric);

/// The metrics of a structure's cycles by their names, those of steady sliding, "largest_multiplier" (modulus) and
/// "returns" of the cycle, and "lyapunov", the largest exponent beside that along the flow (1/s; none where all is
/// forgotten). \throws InputError for an unknown name.
std::vector<PlaneMetric> metrics_of_structure(const oscillators::Structure&, const std::vector<std::string>& names);

/// The structure with its uncertain inputs as drawn, of so many draws.
struct Draws {
  int count = 0;
  std::function<oscillators::Structure(int draw)> structure = {};
};

/// One point: the motion from the model's start, and what steady sliding says of it.
/// \param stick_threshold  |v| over V below which a contact counts as stuck under a law that has no stick
/// \param end  if given, the unknowns on the section that the motion came to; empty where it came to none
MapPoint compute_structure_point(const motion::StructureModel&, double tolerance,
                                 const std::vector<PlaneMetric>& metrics, const cycles::LyapunovOptions& exponents,
                                 double stick_threshold, std::vector<double>* end = nullptr, const Draws& = {});

/// The same of an oscillator that is followed by steps: metrics of its periods, "returns" and "lyapunov". Steady
/// sliding is "stable" where the motion comes to it, or to rest.
std::vector<PlaneMetric> metrics_of_stepped(const motion::SteppedOscillator&, const std::vector<std::string>& names);
MapPoint compute_stepped_point(const motion::SteppedOscillator&, double tolerance,
                               const std::vector<PlaneMetric>& metrics, const cycles::LyapunovOptions& exponents,
                               std::vector<double>* end = nullptr);

/// The structure at values of x and y, and what is drawn there.
using StructureFamily = std::function<motion::StructureModel(double x, double y)>;
using DrawnFamily = std::function<Draws(double x, double y)>;

/// Regimes and metrics of the motion from the family's start. Where the drive is periodic each point is its periodic
/// response; else steady sliding is judged first, and "bistable" is a cycle beside stable sliding. Points that end
/// short are "failed", with the reason. Metrics of steady sliding alone: nothing is integrated.
Map compute_structure_map(const StructureFamily&, const MapOptions&, const std::vector<PlaneMetric>&,
                          const MapHooks& = {}, const DrawnFamily& = {});

using SteppedFamily = std::function<motion::SteppedOscillator(double x, double y)>;
Map compute_stepped_map(const SteppedFamily&, const MapOptions&, const std::vector<PlaneMetric>&, const MapHooks& = {});

/// What the motion at a point is, as far as its "returns" and "lyapunov" tell: "steady", "period 3", "periodic",
/// "quasi-periodic" or "chaotic"; else empty. \param mean_return  s, of the motion; infinite: not known
std::string motion_of(const MapPoint&, const std::vector<PlaneMetric>&, double mean_return);

}  // namespace rosin::analysis::planes
