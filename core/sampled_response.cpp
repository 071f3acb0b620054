/// Second differences of a response's second integral.
#include "core/sampled_response.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>

#include "core/fourier.hpp"

namespace rosin {

double SampledResponse::sum() const {
  double sum = 0;
  for (const double w : weights) sum += w;
  return sum;
}

double SampledResponse::delay() const {
  double moment = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) moment += weights[i] * double(first + int(i));
  return moment / sum();
}

namespace {

/// ∫∫ h, cubic between rows; asked at times that ascend.
class SecondIntegral {
 public:
  SecondIntegral(const Signal::Table& h, double shift) : h_(h), shift_(shift) {}
  double operator()(double time) {
    const double t = time - shift_;
    const auto& at = h_.time;
    while (row_ + 1 < at.size() && t >= at[row_ + 1]) {
      const double d = at[row_ + 1] - at[row_], low = h_.value[row_], high = h_.value[row_ + 1];
      second_ += d * (first_ + d * (2 * low + high) / 6);
      first_ += 0.5 * d * (low + high);
      ++row_;
    }
    if (t <= at.front()) return 0;
    const double d = t - at[row_];
    if (row_ + 1 == at.size()) return second_ + d * first_;
    const double slope = (h_.value[row_ + 1] - h_.value[row_]) / (at[row_ + 1] - at[row_]);
    return second_ + d * (first_ + d * (h_.value[row_] / 2 + d * slope / 6));
  }

 private:
  const Signal::Table& h_;
  double shift_;
  std::size_t row_ = 0;
  double first_ = 0, second_ = 0;  ///< ∫ h and ∫∫ h at the row
};

}  // namespace

SampledResponse sampled(const Signal::Table& response, double shift, double step) {
  SampledResponse result;
  const long first = long(std::floor((response.time.front() + shift) / step)),
             last = long(std::ceil((response.time.back() + shift) / step));
  result.first = int(first);
  SecondIntegral integral(response, shift);
  double before = integral(double(first - 1) * step), now = integral(double(first) * step);
  for (long n = first; n <= last; ++n) {
    const double next = integral(double(n + 1) * step);
    result.weights.push_back(((next - now) - (now - before)) / step);
    before = now, now = next;
  }
  double size = 0;
  for (const double w : result.weights) size += std::abs(w);
  // The second integral grows with time, and its rounding with it: what is left of zero in an end is none.
  constexpr double rounding = 1e-14;
  const auto stays = [&](double w) { return std::abs(w) > rounding * size; };
  auto& weights = result.weights;
  weights.erase(std::ranges::find_if(weights.rbegin(), weights.rend(), stays).base(), weights.end());
  const auto begin = std::ranges::find_if(weights, stays);
  result.first += int(begin - weights.begin());
  weights.erase(weights.begin(), begin);
  return result;
}

constexpr std::size_t fewest = 16;  // samples of a transform

LargestGain largest_gain(const SampledResponse& response) {
  constexpr std::size_t finer = 8;
  const int n = int(std::bit_ceil(std::max(fewest, finer * response.weights.size())));
  RealTransform transform(n);
  std::ranges::fill(transform.record(), 0.0);
  std::ranges::copy(response.weights, transform.record().begin());
  LargestGain largest{0, 0};
  const auto spectrum = transform();
  for (std::size_t k = 0; k < spectrum.size(); ++k)
    if (const double gain = std::abs(spectrum[k]); gain > largest.gain) largest = {gain, double(k) / n};
  return largest;
}

std::vector<double> convolved(std::span<const double> samples, const SampledResponse& response) {
  std::vector<double> result(samples.size(), 0.0);
  if (samples.empty() || response.weights.empty()) return result;
  // Of real records X Y is the transform of the convolution, and its inverse the transform of the mirrored spectrum.
  const double base = samples.front() * response.sum();
  const int n = int(std::bit_ceil(std::max(fewest, samples.size() + response.weights.size())));
  RealTransform transform(n);
  const auto spectrum_of = [&](std::span<const double> values, double less) {
    std::ranges::fill(transform.record(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) transform.record()[i] = values[i] - less;
    const auto spectrum = transform();
    return std::vector<std::complex<double>>(spectrum.begin(), spectrum.end());
  };
  const auto x = spectrum_of(samples, samples.front()), w = spectrum_of(response.weights, 0);
  // Hartley's form: the real transform of Re − Im of a spectrum gives its record by Re − Im again.
  auto record = transform.record();
  for (int k = 0; k < n; ++k) {
    const auto bin = std::size_t(k <= n / 2 ? k : n - k);
    const auto product = x[bin] * w[bin];
    record[std::size_t(k)] = product.real() - (k <= n / 2 ? 1 : -1) * product.imag();
  }
  const auto back = transform();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const long from = long(i) - response.first;  // a response that begins before 0 looks ahead
    const auto bin = std::size_t(from <= n / 2 ? from : n - from);
    const bool known = from >= 0 && from < n;
    const double value = known ? (back[bin].real() - (from <= n / 2 ? 1 : -1) * back[bin].imag()) / n : 0;
    result[i] = base + value;
  }
  return result;
}

}  // namespace rosin
