/// Friction frequency responses as an experiment would find them: the law's own equations are integrated under small
/// changes of an imposed slip rate and normal load, by swept sine or by noise, and the response is taken from the
/// record.
#pragma once
#include "analysis/response/extraction.hpp"

namespace rosin::analysis::response {

struct SweepOptions {
  std::vector<double> frequencies;  ///< Hz
  double amplitude = 0.01;          ///< of slip rate, then of the load, over its mean
  Rig rig = {};
  int threads = 1;
  double tolerance = 1e-10;
};

/// At each frequency two amplitudes are simulated, ε and ε/2. What is odd in ε and free of it is the linear response.
struct SweptFrf {
  std::vector<std::complex<double>> tangential;    ///< extrapolated to zero amplitude, N s/m
  std::vector<std::complex<double>> at_amplitude;  ///< at ε: their difference is the amplitude dependence
  std::vector<double> error;  ///< absolute, N s/m: of the solution, the transient, the extrapolation
  std::vector<double> second_harmonic, third_harmonic;  ///< of the force at ε, over the first harmonic
  std::vector<double> coherence;                     ///< part of the force's variance at ε that the first harmonic has
  std::vector<ResponseMatrix> matrix, matrix_error;  ///< errors (real numbers) as `error`
  std::vector<std::string> warnings;
};

/// \throws InputError where the contact by itself is unstable.
SweptFrf simulate_sweep(const Model&, const SweepOptions&);

struct NoiseOptions {
  double amplitude = 0.02;   ///< rms of slip rate over its mean; of the load too
  double low = 0, high = 0;  ///< band, Hz
  double resolution = 0;     ///< Hz
  int averages = 64;         ///< segments
  std::uint64_t seed = 1;
  Rig rig = {};             ///< with the matrix, the load varies too, by noise of its own
  double tolerance = 1e-6;  ///< far below what noise leaves uncertain
  WelchOptions welch;
};

struct NoiseFrf {
  MeasuredFrf measured;
  double sample_rate = 0;
  std::vector<double> time, slip_rate, force, normal_load;  ///< the record; the load if it varies
};

/// The experiment before it is run: the slip rate imposed with noise, and when it is sampled.
struct NoisePlan {
  Model model;
  std::vector<double> times;
  double sample_rate, margin;  ///< Hz; the ends of the band, where bins are driven by the window's leakage only
  WelchOptions welch;
};
/// \throws InputError where the contact by itself is unstable, and for records too long.
NoisePlan plan_noise(const Model&, const NoiseOptions&);

NoiseFrf simulate_noise(const Model&, const NoiseOptions&);

}  // namespace rosin::analysis::response
