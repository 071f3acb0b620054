/// A root between two places at which a function has different signs.
#pragma once

namespace rosin {

/// Regula falsi by the Illinois method: the end that stays twice counts half.
struct Bracket {
  double low, high, f_low, f_high;
  int kept = 0;  ///< −1: low stayed last, 1: high

  double secant() const { return (low * f_high - high * f_low) / (f_high - f_low); }
  bool holds(double x) const { return x > low && x < high; }
  double width() const { return high - low; }
  void take(double x, double f) {
    if ((f > 0) == (f_high > 0)) {
      high = x, f_high = f;
      if (kept == -1) f_low *= 0.5;
      kept = -1;
    } else {
      low = x, f_low = f;
      if (kept == 1) f_high *= 0.5;
      kept = 1;
    }
  }
};

}  // namespace rosin
