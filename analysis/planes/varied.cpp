/// A slider answers by its model, others by their families.
#include "analysis/planes/varied.hpp"

#include <algorithm>
#include <iterator>

#include "analysis/cycles/period_record.hpp"
#include "analysis/planes/structure_map.hpp"
#include "core/random.hpp"

namespace rosin::analysis::planes {

Numbers Varied::numbers(Numbers more) const {
  auto numbers = changed_;
  std::ranges::move(more, std::back_inserter(numbers));
  return numbers;
}

double Varied::get(const std::string& path) const {
  if (const auto* model = std::get_if<Model>(&of_)) return model->get(path);
  const auto given = std::ranges::find(changed_, path, &Numbers::value_type::first);
  if (given != changed_.end()) return given->second;
  if (const auto* structures = std::get_if<Structures>(&of_)) return structures->value(path);
  return std::get<SteppedOscillators>(of_).value(path);
}

Varied Varied::with(const std::string& path, double value) const {
  if (const auto* model = std::get_if<Model>(&of_)) return model->with(path, value);
  Varied varied = *this;
  std::erase_if(varied.changed_, [&](const auto& number) { return number.first == path; });
  varied.changed_.emplace_back(path, value);
  return varied;
}

std::vector<PlaneMetric> Varied::metrics(const std::vector<std::string>& names) const {
  if (const auto* structures = std::get_if<Structures>(&of_))
    return metrics_of_structure(structures->with(numbers()).structure, names);
  if (const auto* stepped = std::get_if<SteppedOscillators>(&of_))
    return metrics_of_stepped(stepped->with(numbers()), names);
  return metrics_of_slider(names);
}

Map Varied::map(const MapOptions& options, const MapHooks& hooks) const {
  const auto at = [&](double x, double y) { return numbers({{options.x.parameter, x}, {options.y.parameter, y}}); };
  if (const auto* structures = std::get_if<Structures>(&of_)) {
    const auto& inputs = options.uncertain;
    const auto normal = white_noise(inputs.size() * std::size_t(options.samples), options.seed);
    const auto drawn = [&](double x, double y) {
      const auto here = with(options.x.parameter, x).with(options.y.parameter, y);
      return Draws{options.samples, [&, here](int draw) {
                     auto changed = here;
                     for (std::size_t i = 0; i < inputs.size(); ++i)
                       changed = changed.with(inputs[i].parameter,
                                              inputs[i].drawn(here.get(inputs[i].parameter),
                                                              normal[std::size_t(draw) * inputs.size() + i]));
                     return structures->with(changed.numbers()).structure;
                   }};
    };
    return compute_structure_map([&](double x, double y) { return structures->with(at(x, y)); }, options,
                                 metrics(options.metrics), hooks, inputs.empty() ? DrawnFamily() : drawn);
  }
  if (const auto* stepped = std::get_if<SteppedOscillators>(&of_))
    return compute_stepped_map([&](double x, double y) { return stepped->with(at(x, y)); }, options,
                               metrics(options.metrics), hooks);
  return compute_map(std::get<Model>(of_), options, hooks);
}

std::map<std::string, double> Varied::in_steady_sliding() const {
  if (const auto* structures = std::get_if<Structures>(&of_))
    return cycles::metrics_of_sliding(structures->with(numbers()).structure);
  std::map<std::string, double> values;
  const auto* model = std::get_if<Model>(&of_);
  if (!model) return values;
  const double V = model->drive.speed.level(),
               mu = model->law->steady_friction({V, model->drive.normal_load.level()}).friction;
  for (const auto& metric : cycles::metric_names())
    if (metric.member != &cycles::Metrics::period) values[metric.name] = 0;
  for (const char* end : {"max", "min", "mean"})
    values[std::string("slip_rate_") + end] = V, values[std::string("friction_") + end] = mu;
  return values;
}

}  // namespace rosin::analysis::planes
