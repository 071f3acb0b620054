/// Any set-valued law made smooth: friction that rises through rest over a width of slip rates, as in codes without
/// events.
#pragma once
#include <memory>
#include <span>
#include <string_view>

#include "laws/law.hpp"

namespace rosin::laws {

/// F = N·μ(|v|, ψ)·S(v/width), μ the friction of the law in motion and S an odd function that rises from −1 to 1. What
/// holds at rest is lost: under a steady force below the limit the contact creeps.
struct Smoothing {
  enum class Type {
    tanh,       ///< S(w) = tanh w
    arctan,     ///< S(w) = (2/π) arctan w
    linear,     ///< S(w) = w, up to |w| = 1, then the sign
    parabolic,  ///< S(w) = (2 − |w|) w, up to |w| = 1, then the sign
  };
  Type type = Type::tanh;
  double width = 1e-3;  ///< m/s
};

/// Names of the types, in their order.
std::span<const std::string_view> smoothing_names();
/// Of the width.
const Quantity& smoothing_width();

/// The law smoothed, with the parameters and states of the law. States that begin anew at a stop never do.
/// \throws InputError for a law that is not set-valued, and for a width outside its range.
std::shared_ptr<const FrictionLaw> smoothed(std::shared_ptr<const FrictionLaw> law, const Smoothing&);

}  // namespace rosin::laws
