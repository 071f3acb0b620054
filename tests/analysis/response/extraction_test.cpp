/// Responses out of records: against systems whose response is known exactly, with error bars that are counted over
/// seeds.
#include "analysis/response/extraction.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>

#include "core/error.hpp"
#include "core/random.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::response;
using Complex = std::complex<double>;
using Second = Channels::Second;
using Catch::Matchers::Contains;

namespace {

constexpr double rate = 1000;

/// F_k = 0.9 F_{k−1} + 3 v_k − 2 v_{k−1}: its response at a frequency is exact, sampled as it is.
std::vector<double> filtered(const std::vector<double>& v) {
  std::vector<double> F(v.size());
  for (std::size_t k = 1; k < v.size(); ++k) F[k] = 0.9 * F[k - 1] + 3 * v[k] - 2 * v[k - 1];
  return F;
}
Complex filter_response(double f) {
  const Complex back = std::polar(1.0, -2 * std::numbers::pi * f / rate);
  return (3.0 - 2.0 * back) / (1.0 - 0.9 * back);
}

std::vector<double> sum(std::vector<double> a, const std::vector<double>& b, double weight) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] += weight * b[k];
  return a;
}

MeasuredFrf extracted(const std::vector<std::vector<double>>& columns, const Channels& channels, int segment,
                      const ExtractionOptions& options = {}, const std::string& window = "hann") {
  CrossSpectra spectra(channels.count(), {.segment = segment, .overlap = 0.5, .window = window});
  std::vector<std::span<const double>> block(columns.begin(), columns.end());
  spectra.add(block);
  return extract_frf(spectra, channels, rate, options);
}

}  // namespace

TEST_CASE("blocks of any length give the same spectra, and white noise its variance", "[extraction]") {
  const auto x = white_noise(20000, 3), y = white_noise(20000, 4);
  CrossSpectra whole(2, {.segment = 256}), pieces(2, {.segment = 256});
  const std::vector<std::span<const double>> all = {x, y};
  whole.add(all);
  for (std::size_t at = 0, length = 1; at < x.size(); at += length, length = length % 977 + 131) {
    const auto count = std::min(length, x.size() - at);
    const std::vector<std::span<const double>> block = {std::span(x).subspan(at, count),
                                                        std::span(y).subspan(at, count)};
    pieces.add(block);
  }
  CHECK(whole.segments() == (20000 - 256) / 128 + 1);
  CHECK(pieces.segments() == whole.segments());
  double mean = 0;
  for (int k = 2; k < whole.bins() - 1; ++k) {
    CHECK(whole.spectrum(0, 1, k) == pieces.spectrum(0, 1, k));
    CHECK(whole.spectrum(1, 0, k) == std::conj(whole.spectrum(0, 1, k)));
    mean += whole.spectrum(0, 0, k).real() / (whole.bins() - 3);
  }
  CHECK(mean == Approx(1).epsilon(0.03));
}

TEST_CASE("independent averages and the moment of Hann's window are Welch's", "[extraction]") {
  CrossSpectra spectra(1, {.segment = 512});
  const auto x = white_noise(512 * 200, 1);
  const std::vector<std::span<const double>> block = {x};
  spectra.add(block);
  // ρ₁ = 1/6 for half-overlapping Hann segments (Welch 1967): K/(1 + 2/36)
  CHECK(spectra.averages() == Approx(double(spectra.segments()) / (1 + 2.0 / 36)).epsilon(1e-3));
  CHECK(spectra.window_moment() == Approx(1.0 / 3).epsilon(1e-3));  // ∫f²|W|²/∫|W|² = 1/(3T²)
}

TEST_CASE("a swing of whole periods fills the bins that its window's cosines say, at the ends and in the middle",
          "[extraction]") {
  // w = a₀ − a₁ cos x + a₂ cos 2x − a₃ cos 3x sends cos(2πp(i + ½)/n) into bin k as (n/2)(e^{iφ} C(k − p) + e^{−iφ} C(k
  // + p)), φ = πp/n, C(0) = a₀, C(±m) = ±aₘ/2, modulo n; the scale is n(a₀² + ½Σaₘ²). A half sample's shift leaves no
  // slope.
  constexpr int n = 64;
  for (const auto& [window, a] : {std::pair{"hann", std::vector{0.5, 0.5, 0.0, 0.0}},
                                  {"blackman-harris", std::vector{0.35875, 0.48829, 0.14128, 0.01168}},
                                  {"rectangular", std::vector{1.0, 0.0, 0.0, 0.0}}}) {
    const auto C = [&](int offset) {
      offset = ((offset + n / 2) % n + n) % n - n / 2;
      const int m = std::abs(offset);
      return m > 3 ? 0 : m == 0 ? a[0] : 0.5 * a[std::size_t(m)] * (m % 2 ? -1 : 1);
    };
    const double power = n * (a[0] * a[0] + 0.5 * (a[1] * a[1] + a[2] * a[2] + a[3] * a[3]));
    for (const int p : {1, 2, 17, 29, 31}) {
      std::vector<double> x;
      for (int i = 0; i < n; ++i)  // On a straight line, which is taken away.
        x.push_back(3 - 0.2 * i + std::cos(2 * std::numbers::pi * p * (i + 0.5) / n));
      CrossSpectra spectra(1, {.segment = n, .window = window});
      const std::vector<std::span<const double>> block = {x};
      spectra.add(block);
      for (int k = 0; k < spectra.bins(); ++k) {
        const auto turn = std::polar(1.0, std::numbers::pi * p / n);
        const double expected = std::norm(0.5 * n * (turn * C(k - p) + std::conj(turn) * C(k + p))) / power;
        INFO(window << ", " << p << " periods, bin " << k);
        CHECK(spectra.spectrum(0, 0, k).real() == Approx(expected).epsilon(1e-11).margin(1e-13 * n));
      }
    }
  }
}

TEST_CASE("a swing between two bins leaks as far as its window is known to let it", "[extraction]") {
  // F. J. Harris (1978), Table I: highest side lobes of −13 dB (rectangular), −32 dB (Hann) and −92 dB below the peak.
  constexpr int n = 1024, at = 300, padding = 8;
  for (const auto& [window, lobes, main] :
       {std::tuple{"rectangular", -13.26, 1}, {"hann", -31.47, 2}, {"blackman-harris", -92.0, 4}}) {
    double highest = -infinity;
    for (int part = 0; part <= padding; ++part) {  // of a bin: all offsets from the peak are met
      std::vector<double> x;
      for (int i = 0; i < n; ++i) x.push_back(std::sin(2 * std::numbers::pi * (at + double(part) / padding) * i / n));
      CrossSpectra spectra(1, {.segment = n, .window = window});
      const std::vector<std::span<const double>> block = {x};
      spectra.add(block);
      double gain = 0, power = 0;
      for (int i = 0; i < n; ++i) {
        const double t = 2 * std::numbers::pi * i / n;
        const double w = main == 1 ? 1
                         : main == 2
                             ? 0.5 - 0.5 * std::cos(t)
                             : 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
        gain += w, power += w * w;
      }
      const double peak = gain * gain / 4 / power;
      for (int k = at + main + 1; k < at + 60; ++k)
        highest = std::max(highest, 10 * std::log10(spectra.spectrum(0, 0, k).real() / peak));
    }
    INFO(window << ": " << highest << " dB");
    CHECK(highest == Approx(lobes).margin(0.3));
  }
}

TEST_CASE("error bars of H1 are calibrated, for one and for two inputs", "[extraction]") {
  long inside = 0, inside_second = 0, all = 0;
  double sum_of_squares = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::size_t n = 60000;
    const auto v = white_noise(n, 3 * seed), w = white_noise(n, 3 * seed + 1), noise = white_noise(n, 3 * seed + 2);
    const auto one = extracted({v, sum(filtered(v), noise, 4)}, {}, 512);
    const auto two = extracted({v, sum(sum(filtered(v), noise, 4), w, 1.5), w}, {.second = Second::normal_load}, 512);
    for (std::size_t k = 0; k + 1 < one.frequency.size(); k += 3) {  // every third bin: Hann's neighbours correlate
      const auto H = filter_response(one.frequency[k]);
      const auto off = one.tangential[k] - H;
      for (const double part : {off.real(), off.imag()}) {
        ++all;
        inside += std::abs(part) <= 1.96 * one.standard_error[k];
        sum_of_squares += part * part / (one.standard_error[k] * one.standard_error[k]);
      }
      const auto off_second = two.matrix[k].tn - 1.5;
      for (const double part : {off_second.real(), off_second.imag()})
        inside_second += std::abs(part) <= 1.96 * two.matrix_error[k].tn.real();
    }
  }
  // 13 600 numbers of which neighbours are nearly independent: 95 % ± 0.6 %
  CHECK(double(inside) / double(all) == Approx(0.95).margin(0.01));
  CHECK(double(inside_second) / double(all) == Approx(0.95).margin(0.01));
  CHECK(sum_of_squares / double(all) == Approx(1).margin(0.05));
}

TEST_CASE("each estimator is free of bias where its noise is, and a reference where friction feeds back",
          "[extraction]") {
  const std::size_t n = 400000;
  const auto r = white_noise(n, 1), a = white_noise(n, 2);
  const auto noisy_v = sum(r, a, 0.5);  // a quarter of noise power
  const auto clean = extracted({noisy_v, filtered(r)}, {}, 512),
             best = extracted({noisy_v, filtered(r)}, {}, 512, {.estimator = "h2"});
  Complex ratio_1 = 0, ratio_2 = 0, ratio_v = 0;
  for (std::size_t k = 0; k < clean.frequency.size(); ++k) {
    const auto H = filter_response(clean.frequency[k]) * double(clean.frequency.size());
    ratio_1 += clean.h1[k] / H, ratio_2 += best.tangential[k] / H, ratio_v += clean.hv[k] / H;
  }
  CHECK(ratio_1.real() == Approx(1 / 1.25).epsilon(0.01));  // −Z S_nn/(S_vv + S_nn)
  CHECK(ratio_2.real() == Approx(1).epsilon(0.01));
  CHECK(ratio_v.real() == Approx(1 / std::sqrt(1.25)).epsilon(0.01));
  const auto by_reference = extracted({noisy_v, filtered(r), r}, {.reference = true}, 512);
  Complex ratio_r = 0;
  long inside = 0;
  for (std::size_t k = 0; k < clean.frequency.size(); ++k) {
    const auto H = filter_response(clean.frequency[k]);
    ratio_r += by_reference.tangential[k] / H / double(clean.frequency.size());
    inside += std::abs(by_reference.tangential[k] - H) <= 3 * by_reference.standard_error[k];
  }
  CHECK(ratio_r.real() == Approx(1).epsilon(0.01));
  CHECK(double(inside) / double(clean.frequency.size()) > 0.95);
}

TEST_CASE("a matrix of two inputs and two outputs", "[extraction]") {
  const std::size_t n = 200000;
  const auto v = white_noise(n, 5), b = white_noise(n, 6);
  const auto w = sum(b, v, 0.8);  // inputs that have much in common
  const auto F = sum(filtered(v), w, 0.4), N = sum(filtered(w), v, -0.2);
  const auto m = extracted({v, F, w, N}, {.second = Second::approach_rate}, 1024);
  for (std::size_t k = 20; k < m.frequency.size() - 20; k += 50) {
    const auto H = filter_response(m.frequency[k]);
    CHECK(std::abs(m.matrix[k].tt - H) < 0.03 * std::abs(H) + m.bias_error[k]);
    CHECK(std::abs(m.matrix[k].tn - 0.4) < 0.02);
    CHECK(std::abs(m.matrix[k].nt + 0.2) < 0.02);
    CHECK(std::abs(m.matrix[k].nn - H) < 0.03 * std::abs(H) + m.bias_error[k]);
    const double common = 0.8 / std::sqrt(1.64);
    CHECK(m.conditioning[k] == Approx((1 + common) / (1 - common)).epsilon(0.3));
  }
  const auto twins = extracted({v, F, sum(v, b, 0.01), N}, {.second = Second::approach_rate}, 1024);
  CHECK_THAT(twins.warnings.back(), Contains("cannot be told apart"));
}

TEST_CASE("the bias of a bin's width is foretold where a response bends, neither too low nor too high",
          "[extraction]") {
  // A sharp filter in segments hardly longer than its memory. Of white noise, H1 comes out as Σ r_m h_m e^{−iωm}, r_m
  // the autocorrelation of the window: what of an answer falls behind the end of the segment is lost.
  constexpr int segment = 256;
  constexpr double memory = 0.97;
  const std::size_t n = 2000000;
  const auto v = white_noise(n, 9);
  std::vector<double> F(n);
  for (std::size_t k = 1; k < n; ++k) F[k] = memory * F[k - 1] + v[k];
  for (const std::string window : {"hann", "rectangular"}) {
    std::vector<double> w, r;
    for (int i = 0; i < segment; ++i)
      w.push_back(window == "hann" ? std::pow(std::sin(std::numbers::pi * i / segment), 2) : 1);
    for (std::size_t lag = 0; lag < segment; ++lag)
      r.push_back(std::inner_product(w.begin() + std::ptrdiff_t(lag), w.end(), w.begin(), 0.0));
    const auto m = extracted({v, F}, {}, segment, {}, window);
    for (std::size_t k = 9; k < 20; ++k) {
      const Complex back = std::polar(1.0, -2 * std::numbers::pi * m.frequency[k] / rate);
      Complex expected = 0, turned = 1;
      for (std::size_t lag = 0; lag < segment; ++lag, turned *= memory * back) expected += r[lag] / r[0] * turned;
      const Complex exact = 1.0 / (1.0 - memory * back);
      const double bias = std::abs(expected - exact);
      INFO(window << ", " << m.frequency[k] << " Hz: biased by " << bias << ", foretold " << m.bias_error[k] << ", off "
                  << std::abs(m.tangential[k] - exact) << " ± " << m.standard_error[k]);
      CHECK(std::abs(m.tangential[k] - expected) < 4 * m.standard_error[k]);
      CHECK(m.bias_error[k] > 0.98 * bias);
      CHECK(m.bias_error[k] < 1.3 * bias);
    }
  }
}

TEST_CASE("Hv says how far noise that is not shared evenly may put it off", "[extraction]") {
  // All noise on the force, as strong as what follows slip rate at half the frequencies: |Hv|² = |H|²/γ² there.
  const auto v = sum(std::vector<double>(200000, 1.0), white_noise(200000, 3), 0.02);
  const auto F = sum(filtered(v), white_noise(200000, 4), 0.02);
  const auto m = extracted({v, F}, {}, 256, {.from = 20, .to = 400, .estimator = "hv"});
  const auto said = std::ranges::find_if(m.warnings, [](const auto& text) { return text.starts_with("Hv is"); });
  REQUIRE(said != m.warnings.end());
  const double least = *std::ranges::min_element(m.coherence);
  double most = 0;
  for (std::size_t k = 0; k < m.frequency.size(); ++k)
    most = std::max(most, std::abs(m.tangential[k]) / std::abs(filter_response(m.frequency[k])));
  CHECK(std::stod(said->substr(said->rfind(' '))) == Approx(1 / std::sqrt(least)).epsilon(0.01));
  CHECK(most == Approx(1 / std::sqrt(least)).epsilon(0.05));
}

TEST_CASE("warnings say where linear theory fails", "[extraction]") {
  const std::size_t n = 200000;
  auto v = white_noise(n, 7);
  // Driven below a tenth of half the sample rate only.
  for (int pass = 0; pass < 6; ++pass)
    for (std::size_t k = 1; k < n; ++k) v[k] = 0.9 * v[k - 1] + 0.1 * v[k];
  const auto with = [&](double mean, double square, double drift, double noise) {
    const auto extra = white_noise(n, 8);
    std::vector<double> speed(n), F(n);
    for (std::size_t k = 0; k < n; ++k) {
      speed[k] = mean + v[k];
      F[k] = 5 * v[k] + square * v[k] * v[k] + drift * double(k) / double(n) + noise * extra[k];
    }
    return extracted({speed, F}, {}, 1024, {.from = 3, .to = 15}).warnings;
  };
  CHECK(with(100, 0, 0, 0).empty());
  CHECK_THAT(with(1e-3, 0, 0, 0).front(), Contains("slip rate varies by"));
  CHECK_THAT(with(1e-3, 0, 0, 0).back(), Contains("sticks or reverses"));
  CHECK_THAT(with(100, 0, 100, 0).front(), Contains("force drifts"));
  CHECK_THAT(with(100, 0, 0, 5).front(), Contains("coherence is below"));
  CHECK_THAT(with(100, 0, 0, 5).back(), Contains("aliasing"));
  const auto harmonic = with(100, 4e4, 0, 0);
  CHECK(std::any_of(harmonic.begin(), harmonic.end(),
                    [](const auto& text) { return text.find("harmonics") != std::string::npos; }));
}

TEST_CASE("records that are too short, bands without bins and coarse segments are refused", "[extraction]") {
  const auto v = white_noise(2000, 1);
  CHECK_THROWS_WITH(extracted({v, v}, {}, 1024), Contains("too short"));
  CHECK_THROWS_WITH(extracted({v, v}, {}, 64, {.from = 1e4, .to = 2e4}), Contains("no frequency"));
  CHECK_THROWS_AS(segment_for(200, 1000), InputError);
  CHECK(segment_for(1, 1000) == 1000);
  CHECK_THROWS_AS(CrossSpectra(1, {.segment = 64, .overlap = 0.5, .window = "hamm"}), InputError);
}

TEST_CASE("ten million samples are taken block by block", "[extraction]") {
  CrossSpectra spectra(2, {.segment = 8192});
  const auto x = white_noise(100000, 1);
  const std::vector<std::span<const double>> block = {x, x};
  for (int k = 0; k < 100; ++k) spectra.add(block);
  CHECK(spectra.samples() == 10000000);
}
