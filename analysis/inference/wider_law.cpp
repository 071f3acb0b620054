/// The numbers of the law with one state, in the law with two.
#include "analysis/inference/wider_law.hpp"

#include <algorithm>

namespace rosin::analysis::inference {

std::optional<WiderFit> fit_with_negative_evolution(const Model& start,
                                                    const std::shared_ptr<const FrictionLaw>& two_states,
                                                    const std::vector<Measurement>& data, const FitOptions& options,
                                                    const Fit& found) {
  const auto b = std::ranges::find(options.parameters, "law.b");
  const bool misfits = std::ranges::any_of(found.measurements, [](const auto& m) { return m.misfit.has_value(); });
  if ((found.outcome.complete() && !misfits) || b == options.parameters.end()) return std::nullopt;
  const auto renamed = [](std::string path) {
    for (const char* state : {"law.b", "law.L"})
      if (path == state) path += '2';
    return path;
  };
  Model wider = start;
  wider.law = two_states;
  wider = wider.with("law.b1", 0);
  for (const auto& quantity : start.law->parameters())
    wider = wider.with(renamed("law." + quantity.name), start.get("law." + quantity.name));
  auto same = options;
  same.derived.clear();
  for (auto& path : same.parameters) path = renamed(path);
  auto fit = inference::fit(wider, data, same);
  constexpr double strong = 10;
  const auto evolution = fit.parameters[std::size_t(b - options.parameters.begin())];
  if (!fit.outcome.complete() || !(evolution.value < 0) || !(fit.bic < found.bic - strong)) return std::nullopt;
  return WiderFit{std::move(fit), evolution.value, evolution.standard_error};
}

}  // namespace rosin::analysis::inference
