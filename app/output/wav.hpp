/// Sound: a signal as a WAV file.
#pragma once
#include <filesystem>
#include <span>

namespace rosin::app::output {

inline constexpr double lowest_heard = 20;  ///< Hz

/// 16-bit mono at 48 kHz, or at the signal's own rate if that is lower: above half of the new rate nothing is left, nor
/// below lowest_heard. The largest value is full scale. Returns what full scale is, in the signal's unit. \throws
/// std::runtime_error if the file cannot be written
double write_wav(const std::filesystem::path&, std::span<const double> signal, double sample_rate);

}  // namespace rosin::app::output
