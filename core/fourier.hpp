/// Discrete Fourier transforms of real records by FFTW, and the windows that records are seen through.
#pragma once
#include <complex>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace rosin {

/// FFTW makes and ends its plans one at a time.
std::mutex& fourier_planner();

/// "hann", "blackman-harris" and "rectangular".
const std::vector<std::string>& window_names();
/// a₀, a₁ … of a window a₀ − a₁ cos φ + a₂ cos 2φ − …, φ once around. \throws InputError for an unknown name.
std::span<const double> window_cosines(const std::string& name);
/// n values of a periodic window.
std::vector<double> window_values(const std::string& name, int n);

/// X_k = Σ x_i e^(−2πi ik/n), k = 0 … n/2, of records of n samples.
class RealTransform {
 public:
  explicit RealTransform(int n);
  ~RealTransform();
  RealTransform(RealTransform&&) noexcept;
  int bins() const;
  /// Where the record stands.
  std::span<double> record();
  std::span<const std::complex<double>> operator()();

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace rosin
