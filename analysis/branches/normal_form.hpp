/// Small cycles at a Hopf point as its normal form has them, to compare with those that are computed.
#pragma once
#include <functional>
#include <optional>
#include <string_view>

#include "analysis/steady/thresholds.hpp"
#include "oscillators/model.hpp"
#include "oscillators/structure.hpp"

namespace rosin::analysis::branches {

/// ẇ = (iω + μ′(p − p_H)) w + c₁ w|w|² has the cycle |w|² = −μ′ (p − p_H)/Re c₁. The slip rate of the first contact is
/// V(1 + |w| cos ωt), to the first order in |w|.
struct SmallCycles {
  double value;                       ///< p_H
  double first_lyapunov_coefficient;  ///< Re c₁/ω
  double slope;                       ///< −μ′/Re c₁: |w|² over p − p_H
  /// |w|; NaN on the side on which there is no small cycle, and where |w| > 1: slip would reverse.
  double amplitude(double p) const;
};

/// Nothing where the coefficient is 0 within its error, or the eigenvalues do not cross by themselves.
std::optional<SmallCycles> small_cycles(const std::function<oscillators::Structure(double)>&, const steady::Crossing&);
std::optional<SmallCycles> small_cycles(const oscillators::Model&, std::string_view parameter, const steady::Crossing&);

}  // namespace rosin::analysis::branches
