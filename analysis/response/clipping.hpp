/// Clipped records: flat tops at the limit of a sensor, seen sample by sample.
#pragma once
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace rosin::analysis::response {

/// Watches one column. A clipped end holds the extreme value in several runs of consecutive samples, and far more often
/// than the value next to it: of a sine in the steps of a converter the last step holds 2.4 times as many samples as
/// the one before, of noise far fewer.
class ClippingWatch {
 public:
  void add(double x) { high_.add(x), low_.add(-x); }

  struct End {
    double value;
    long samples;  ///< at that value
  };
  std::optional<End> high() const { return high_.found(1); }
  std::optional<End> low() const { return low_.found(-1); }

 private:
  /// The two largest values so far.
  struct Top {
    double first = -std::numeric_limits<double>::infinity(), second = first;
    long of_first = 0, of_second = 0;
    long run = 0, runs = 0;  ///< of the first: as long as now, and how many of three samples or more

    void add(double x);
    std::optional<End> found(double sign) const;
  };
  Top high_, low_;
};

/// "force is flat at its largest value, …" for each end that is clipped, one after the other; empty if none is.
std::string clipping_warning(const ClippingWatch&, std::string_view name, std::string_view unit, long samples);

}  // namespace rosin::analysis::response
