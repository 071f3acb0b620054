/// Plans of FFTW with aligned arrays of their own.
#include "core/fourier.hpp"

#include <fftw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace rosin {

std::mutex& fourier_planner() {
  static std::mutex planner;
  return planner;
}

const std::vector<std::string>& window_names() {
  static const std::vector<std::string> names = {"hann", "blackman-harris", "rectangular"};
  return names;
}

std::span<const double> window_cosines(const std::string& name) {
  // F. J. Harris, Proc. IEEE 66, 51-83, 1978; the second: four terms, −92 dB
  static constexpr double hann[] = {0.5, 0.5}, blackman_harris[] = {0.35875, 0.48829, 0.14128, 0.01168}, none[] = {1};
  if (std::ranges::find(window_names(), name) == window_names().end())
    throw InputError(fmt::format("unknown window '{}'", name));
  if (name == "hann") return hann;
  if (name == "blackman-harris") return blackman_harris;
  return none;
}

std::vector<double> window_values(const std::string& name, int n) {
  const auto a = window_cosines(name);
  std::vector<double> w(std::size_t(n), a[0]);
  for (int i = 0; i < n; ++i) {
    const double x = 2 * std::numbers::pi * i / n;
    for (std::size_t k = 1; k < a.size(); ++k) w[std::size_t(i)] += (k % 2 ? -a[k] : a[k]) * std::cos(double(k) * x);
  }
  return w;
}

struct RealTransform::Work {
  int n;
  double* record;
  fftw_complex* transformed;
  fftw_plan plan;
};

RealTransform::RealTransform(int n) : work_(std::make_unique<Work>()) {
  const std::lock_guard lock(fourier_planner());
  work_->n = n;
  work_->record = fftw_alloc_real(std::size_t(n));
  work_->transformed = fftw_alloc_complex(std::size_t(n / 2 + 1));
  work_->plan = fftw_plan_dft_r2c_1d(n, work_->record, work_->transformed, FFTW_ESTIMATE);
}

RealTransform::RealTransform(RealTransform&&) noexcept = default;

RealTransform::~RealTransform() {
  if (!work_) return;
  const std::lock_guard lock(fourier_planner());
  fftw_destroy_plan(work_->plan);
  fftw_free(work_->record);
  fftw_free(work_->transformed);
}

int RealTransform::bins() const { return work_->n / 2 + 1; }

std::span<double> RealTransform::record() { return {work_->record, std::size_t(work_->n)}; }

std::span<const std::complex<double>> RealTransform::operator()() {
  fftw_execute(work_->plan);
  return {reinterpret_cast<const std::complex<double>*>(work_->transformed), std::size_t(bins())};
}

}  // namespace rosin
