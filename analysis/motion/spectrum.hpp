/// Amplitudes of a motion over frequency, and how they change over time.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "analysis/motion/run.hpp"

namespace rosin::analysis::motion {

struct SpectrumOptions {
  std::vector<std::string> columns;  ///< of the run; empty: all
  double from = 0;                   ///< s: the motion before is left out
  std::string window = "hann";       ///< one of window_names() (core/fourier.hpp)
  double segment = 0;                ///< s, of the spectrogram's parts, each half over the next; 0: no spectrogram
  int lines = 8;                     ///< of each column that are told by frequency and amplitude
};

/// A sinusoid of the motion, from a maximum of the spectrum and its larger neighbour.
struct SpectralLine {
  double frequency, amplitude;              ///< Hz, and the column's unit
  double frequency_error, amplitude_error;  ///< differences to the estimate with the smaller neighbour, and to that of
                                            ///< every second sample, which sees what lies between samples otherwise
};

struct MotionSpectrum {
  std::vector<std::string> names, units;  ///< of the columns
  std::vector<double> frequency;          ///< Hz
  /// [column][frequency]: half a peak to peak that a sinusoid at that frequency has; at 0 the mean.
  std::vector<std::vector<double>> amplitude;
  std::vector<std::vector<SpectralLine>> lines;  ///< [column], the largest first
  double resolution = 0;                         ///< Hz, of neighbouring sinusoids: main lobe of the window
  std::vector<double> part_time, part_frequency;
  std::vector<std::vector<double>> part_amplitude;  ///< [column][time · frequencies + frequency]
};

/// Of a record with samples at equal intervals. \throws InputError for other records, unknown columns, and parts or
/// motions of fewer than 16 samples
MotionSpectrum spectrum(const Run&, const SpectrumOptions&);

}  // namespace rosin::analysis::motion
