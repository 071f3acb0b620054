/// Friction frequency responses out of records: H1, H2, Hv, coherence, random and bias error, and when not to believe
/// them.
///
/// Sources: Bendat & Piersol (2010), chapters 6, 7 and 9; Welch (1967); Rocklin, Crowley & Vold (1985) for Hv.
#pragma once
#include <complex>
#include <string>
#include <vector>

#include "analysis/response/frf.hpp"
#include "analysis/response/spectra.hpp"

namespace rosin::analysis::response {

/// Channels of a record, in the order in which CrossSpectra takes those that are there: slip rate, force, second input,
/// normal load as output, reference.
struct Channels {
  /// What else moves the contact: nothing, the normal load itself, or the speed of approach with the load as an output.
  enum class Second { none, normal_load, approach_rate } second = Second::none;
  /// The excitation itself: the estimate S_rF/S_rv is free of bias where the structure feeds friction back to slip
  /// rate.
  bool reference = false;

  int inputs() const { return second == Second::none ? 1 : 2; }
  int count() const { return inputs() + 1 + (second == Second::approach_rate ? 1 : 0) + (reference ? 1 : 0); }
};

struct ExtractionOptions {
  double from = 0, to = infinity;  ///< band of the answer, Hz
  std::string estimator = "h1";    ///< of `tangential`: "h1" (noise on force), "h2" (noise on slip rate), "hv" (both)
};

const std::vector<std::string>& estimator_names();

/// A measured response at the bins of the band.
struct MeasuredFrf {
  std::vector<double> frequency;                     ///< Hz
  std::vector<std::complex<double>> tangential;      ///< by the estimator asked for, N s/m
  std::vector<std::complex<double>> h1, h2, hv;      ///< of one input without reference
  std::vector<double> coherence;                     ///< of two inputs: multiple coherence of the force
  std::vector<double> standard_error;                ///< of real and imaginary part each, N s/m
  std::vector<double> bias_error;                    ///< of the finite width of a bin, N s/m
  std::vector<ResponseMatrix> matrix, matrix_error;  ///< of two inputs; errors (real numbers) as standard_error
  std::vector<double> load_coherence;                ///< multiple coherence of the load where it is an output
  std::vector<double> conditioning;                  ///< of the inputs' spectra, each scaled to 1; 1: independent
  double averages = 0;                               ///< independent ones
  double resolution = 0;                             ///< width of a bin, Hz
  double slip_rate = 0, slip_rate_rms = 0, force = 0, force_rms = 0;
  double outside_band = 0;  ///< part of the force's power that does not follow slip rate, where that is hardly driven
  std::vector<std::string> warnings;
};

/// \throws InputError for fewer than eight segments or a band without bins.
MeasuredFrf extract_frf(const CrossSpectra&, const Channels&, double sample_rate, const ExtractionOptions&);

/// Samples of one segment for a resolution in Hz. \throws InputError where it would be too short.
int segment_for(double resolution, double sample_rate);

}  // namespace rosin::analysis::response
