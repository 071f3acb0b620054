/// A slider answers by its model, a structure by its family.
#include "analysis/planes/varied.hpp"

#include <algorithm>
#include <iterator>

#include "analysis/cycles/period_record.hpp"
#include "analysis/planes/structure_map.hpp"

namespace rosin::analysis::planes {

motion::StructureModel Varied::structure(Numbers more) const {
  auto numbers = changed_;
  std::ranges::move(more, std::back_inserter(numbers));
  return structures_.with(numbers);
}

double Varied::get(const std::string& path) const {
  if (!structures_.with) return model_.get(path);
  const auto given = std::ranges::find(changed_, path, &Numbers::value_type::first);
  return given != changed_.end() ? given->second : structures_.value(path);
}

Varied Varied::with(const std::string& path, double value) const {
  Varied varied = *this;
  if (!structures_.with) {
    varied.model_ = model_.with(path, value);
    return varied;
  }
  std::erase_if(varied.changed_, [&](const auto& number) { return number.first == path; });
  varied.changed_.emplace_back(path, value);
  return varied;
}

std::vector<PlaneMetric> Varied::metrics(const std::vector<std::string>& names) const {
  return structures_.with ? metrics_of_structure(structure().structure, names) : metrics_of_slider(names);
}

Map Varied::map(const MapOptions& options, const MapHooks& hooks) const {
  if (!structures_.with) return compute_map(model_, options, hooks);
  const auto at = [&](double x, double y) { return structure({{options.x.parameter, x}, {options.y.parameter, y}}); };
  return compute_structure_map(at, options, metrics(options.metrics), hooks);
}

std::map<std::string, double> Varied::in_steady_sliding() const {
  if (structures_.with) return cycles::metrics_of_sliding(structure().structure);
  std::map<std::string, double> values;
  const double V = model_.drive.speed.level(),
               mu = model_.law->steady_friction({V, model_.drive.normal_load.level()}).friction;
  for (const auto& metric : cycles::metric_names())
    if (metric.member != &cycles::Metrics::period) values[metric.name] = 0;
  for (const char* end : {"max", "min", "mean"})
    values[std::string("slip_rate_") + end] = V, values[std::string("friction_") + end] = mu;
  return values;
}

}  // namespace rosin::analysis::planes
