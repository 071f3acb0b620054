/// The same law in a form that allows more: rate-and-state friction whose evolution effect may be negative.
#pragma once
#include <memory>
#include <optional>

#include "analysis/inference/fit.hpp"

namespace rosin::analysis::inference {

/// A fit of a law with two states of which the first has no effect: the law with one, with any sign of b.
struct WiderFit {
  Fit fit;
  double b = 0, standard_error = 0;
};
/// Where `found` is incomplete or leaves more than noise, and fitted `law.b`: the fit of `two_states` in its place, if
/// its b is negative and its BIC lower by more than 10, which is strong evidence. Phyllosilicates have such a b.
std::optional<WiderFit> fit_with_negative_evolution(const Model& start,
                                                    const std::shared_ptr<const FrictionLaw>& two_states,
                                                    const std::vector<Measurement>&, const FitOptions&,
                                                    const Fit& found);

}  // namespace rosin::analysis::inference
