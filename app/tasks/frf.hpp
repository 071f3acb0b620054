/// What the verb frf is asked.
#pragma once
#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/response/extraction.hpp"
#include "analysis/response/frf.hpp"
#include "analysis/response/frf_simulation.hpp"
#include "analysis/response/sliding_receptance.hpp"
#include "analysis/response/structure.hpp"
#include "app/scene/record.hpp"

namespace rosin::app::tasks {

/// A measured record, and how a response is taken out of it.
struct FrfRecord {
  scene::RecordSource source;  ///< columns in the order of the channels
  bool displacement = false;   ///< stands in the place of slip rate, which is made of it
  analysis::response::Channels channels;
  double resolution = 0;  ///< Hz
  analysis::response::WelchOptions welch;
  analysis::response::ExtractionOptions extraction;
};

/// A structure that a friction response is used on, and what is asked of both.
struct FrfUse {
  analysis::response::SlidingStructure sliding;
  /// Measured: at the same frequencies (Hz) where both are. Errors are of real and imaginary part each, or none.
  struct Measured {
    std::vector<double> frequency;
    std::vector<std::complex<double>> value;
    std::vector<double> error;
  };
  Measured friction, receptance;  ///< N s/m, m/N
  std::string scan;               ///< path of a parameter, or empty
  double scan_from = 0, scan_to = 0;
  int scan_points = 60;
  std::vector<Uncertain> uncertain;
  int samples = 400;
  std::uint64_t seed = 1;
};

/// A friction response: predicted, extracted from a record, or simulated; and the structure that it is used on.
struct Frf {
  analysis::response::FrfOptions options;
  bool predicts = true;  ///< the scene has a drive to predict at
  std::optional<FrfRecord> record;
  std::optional<FrfUse> use;
  std::optional<analysis::response::SweepOptions> sweep;
  std::optional<analysis::response::NoiseOptions> noise;
  /// What stands behind the contact and moves with it.
  std::optional<analysis::response::SlidingReceptance> oscillator;
};

}  // namespace rosin::app::tasks
