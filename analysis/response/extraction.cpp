/// Estimates of responses from averaged spectra, and the checks of what they assume.
#include "analysis/response/extraction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace rosin::analysis::response {

using Complex = std::complex<double>;

namespace {

constexpr int slip = 0, force = 1, second = 2;
constexpr int fewest_segments = 8;
constexpr double driven_part = 1e-2;  ///< of the largest density of slip rate: less is not driven

/// Random error of each part of a response: half of the mean square of |Ĥ − H|. Bendat & Piersol (2010), eq 9.90, with
/// the expected value of the F distribution's numerator: `freedom` = averages − inputs.
double random_error(double unexplained, double inverse_input, double freedom) {
  return std::sqrt(std::max(0.0, unexplained) * inverse_input / (2 * std::max(freedom, 1.0)));
}

/// ½ m₂ H'' of the window's second moment m₂, and −iκ H'/(2π) of the share κ of power at its ends, by which what of an
/// answer falls behind the end of a segment is lost; by a parabola through eleven bins (least squares).
std::vector<double> bias_of_width(const std::vector<Complex>& H, double moment, double ends) {
  constexpr int reach = 5;
  const int n = int(H.size());
  std::vector<double> bias(H.size(), std::nan(""));
  for (int k = 0; k < n && n > 2 * reach; ++k) {
    const int centre = std::clamp(k, reach, n - 1 - reach);
    double sum_xx = 0, sum_x4 = 0;
    Complex sum_y = 0, sum_xy = 0, sum_xxy = 0;
    for (int i = -reach; i <= reach; ++i) {
      const double xx = double(i) * i;
      sum_xx += xx, sum_x4 += xx * xx;
      const Complex y = H[std::size_t(centre + i)];
      sum_y += y, sum_xy += double(i) * y, sum_xxy += xx * y;
    }
    const double count = 2 * reach + 1;
    const Complex curvature = 2.0 * (sum_xxy - sum_xx / count * sum_y) / (sum_x4 - sum_xx * sum_xx / count);
    const Complex slope = sum_xy / sum_xx + curvature * double(k - centre);
    bias[std::size_t(k)] = std::abs(0.5 * moment * curvature - Complex(0, ends / (2 * std::numbers::pi)) * slope);
  }
  return bias;
}

void warn(MeasuredFrf& result, const CrossSpectra& spectra, const Channels& channels, double sample_rate,
          const std::string& estimator) {
  const auto v = spectra.level(slip), F = spectra.level(force);
  auto& warnings = result.warnings;
  const auto low = std::count_if(result.coherence.begin(), result.coherence.end(), [](double c) { return !(c > 0.8); });
  if (low > 0)
    warnings.push_back(
        fmt::format("coherence is below 0.8 at {:.3g} % of the frequencies: noise, another input, or friction that is "
                    "not linear here",
                    100.0 * double(low) / double(result.coherence.size())));
  if (v.rms > 0.1 * std::abs(v.mean))
    warnings.push_back(fmt::format("slip rate varies by {:.2g} of its mean (rms): linear theory wants a tenth at most",
                                   v.rms / std::abs(v.mean)));
  if (v.least <= 0 && v.mean > 0)
    warnings.push_back(fmt::format("slip rate falls to {:.3g} m/s: the contact sticks or reverses", v.least));
  for (const auto& [name, level] : {std::pair{"slip rate", v}, std::pair{"force", F}})
    if (level.drift > 3 * level.rms)
      warnings.push_back(fmt::format("{} drifts: its mean over a segment changes by {:.3g}, {:.2g} times its rms", name,
                                     level.drift, level.drift / level.rms));
  if (result.outside_band > 0.01)
    warnings.push_back(
        fmt::format("{:.2g} % of the force's power lies where slip rate is hardly driven, and does not follow it: "
                    "harmonics of a nonlinear contact, or noise",
                    100 * result.outside_band));
  const int bins = spectra.bins(), top = bins * 9 / 10;
  for (const auto& [name, channel] : {std::pair{"slip rate", slip}, std::pair{"force", force}}) {
    double peak = 0, above = 0;
    for (int k = 2; k < bins; ++k) peak = std::max(peak, spectra.spectrum(channel, channel, k).real());
    for (int k = top; k < bins; ++k) above += spectra.spectrum(channel, channel, k).real() / (bins - top);
    if (above > 0.01 * peak)
      warnings.push_back(
          fmt::format("{} holds {:.2g} of its peak density just below half the sample rate ({:.4g} Hz): "
                      "what lies above is folded down (aliasing)",
                      name, above / peak, sample_rate / 2));
  }
  struct Name {
    const char *name, *unit;
  };
  std::vector<Name> names = {{"slip rate", "m/s"}, {"force", "N"}};
  if (channels.second == Channels::Second::approach_rate) names.push_back({"approach rate", "m/s"});
  if (channels.second != Channels::Second::none) names.push_back({"normal load", "N"});
  if (channels.reference) names.push_back({"reference", "1"});
  for (std::size_t c = 0; c < names.size(); ++c)
    if (auto clipped = clipping_warning(spectra.clipping(int(c)), names[c].name, names[c].unit, spectra.samples());
        !clipped.empty())
      warnings.push_back(std::move(clipped));
  if (estimator == "hv" && channels.inputs() == 1 && !channels.reference) {
    const double least = *std::ranges::min_element(result.coherence);
    warnings.push_back(fmt::format(
        "Hv is the geometric mean of H1 and H2, without bias only where noise is the same part of slip rate "
        "and of force; if one of them has it all, |Hv| is off by up to a factor {:.3g}",
        1 / std::sqrt(least)));
  }
}

}  // namespace

const std::vector<std::string>& estimator_names() {
  static const std::vector<std::string> names = {"h1", "h2", "hv"};
  return names;
}

int segment_for(double resolution, double sample_rate) {
  const double samples = std::ceil(sample_rate / resolution);
  if (!(samples >= 16))
    throw InputError(
        fmt::format("resolution = {} Hz is too coarse for {} samples per second: a segment would have {} "
                    "samples, and at least 16 are needed",
                    resolution, sample_rate, samples));
  if (samples > 1e8)
    throw InputError(fmt::format("resolution = {} Hz needs segments of {} samples", resolution, samples));
  return 2 * int(samples / 2 + 0.5);  // even
}

MeasuredFrf extract_frf(const CrossSpectra& spectra, const Channels& channels, double sample_rate,
                        const ExtractionOptions& options) {
  MeasuredFrf result;
  const int bins = spectra.bins(), segment = 2 * (bins - 1);
  result.resolution = sample_rate / segment;
  if (spectra.segments() < fewest_segments)
    throw InputError(fmt::format(
        "the record is too short: {} samples make {} segments of {} samples, and at least {} are needed; ask for a "
        "resolution coarser than {:.3g} Hz, or record longer",
        spectra.samples(), spectra.segments(), segment, fewest_segments, result.resolution));
  result.averages = spectra.averages();
  result.slip_rate = spectra.level(slip).mean, result.slip_rate_rms = spectra.level(slip).rms;
  result.force = spectra.level(force).mean, result.force_rms = spectra.level(force).rms;
  const double freedom = result.averages - channels.inputs();
  const bool load_out = channels.second == Channels::Second::approach_rate;
  const int load = 3, reference = channels.count() - 1;

  for (int k = 2; k < bins; ++k) {  // the first two hold what is left of mean and drift
    const double f = k * result.resolution;
    if (f < options.from || f > options.to) continue;
    const auto S = [&](int i, int j) { return spectra.spectrum(i, j, k); };
    result.frequency.push_back(f);
    const double S_vv = S(slip, slip).real(), S_FF = S(force, force).real();
    if (channels.inputs() == 1) {
      const Complex S_vF = S(slip, force);
      // A force that does not move at all answers with nothing, by every estimator.
      const Complex h1 = S_vF / S_vv, h2 = S_FF > 0 ? S_FF / std::conj(S_vF) : 0;
      const double coherence = S_FF > 0 ? std::norm(S_vF) / (S_vv * S_FF) : 0;
      if (channels.reference) {
        const Complex S_rv = S(reference, slip), H = S(reference, force) / S_rv;
        const double unexplained = S_FF - 2 * (std::conj(H) * S_vF).real() + std::norm(H) * S_vv;
        result.tangential.push_back(H);
        result.coherence.push_back(std::norm(S(reference, force)) / (S(reference, reference).real() * S_FF));
        result.standard_error.push_back(
            random_error(unexplained, S(reference, reference).real() / std::norm(S_rv), freedom));
      } else {
        const Complex hv = S_FF > 0 ? h1 / std::abs(h1) * std::sqrt(S_FF / S_vv) : 0;
        result.h1.push_back(h1), result.h2.push_back(h2), result.hv.push_back(hv);
        result.tangential.push_back(options.estimator == "h2" ? h2 : options.estimator == "hv" ? hv : h1);
        result.coherence.push_back(coherence);
        const double H = std::abs(result.tangential.back());
        result.standard_error.push_back(
            random_error(H * H * (1 - coherence) / std::max(coherence, 1e-300), 1, freedom));
      }
      continue;
    }
    // [H_v H_2] = S_yx S_xx⁻¹ with S_yx = conj(S_xy) of the convention conj(X) Y; two inputs by hand.
    const double S_22 = S(second, second).real();
    const Complex S_v2 = S(slip, second);
    const double determinant = S_vv * S_22 - std::norm(S_v2);
    struct Row {
      Complex by_slip, by_second;
      double coherence, error_slip, error_second;
    };
    const auto row = [&](int output) {
      const Complex a = S(slip, output), b = S(second, output);  // = S_xx^T (H_v, H_2)
      Row r;
      r.by_slip = (S_22 * a - S_v2 * b) / determinant;
      r.by_second = (S_vv * b - std::conj(S_v2) * a) / determinant;
      const double power = S(output, output).real();
      const double explained = (std::conj(r.by_slip) * a + std::conj(r.by_second) * b).real();
      r.coherence = explained / power;
      r.error_slip = random_error(power - explained, S_22 / determinant, freedom);
      r.error_second = random_error(power - explained, S_vv / determinant, freedom);
      return r;
    };
    const Row F = row(force);
    ResponseMatrix H{F.by_slip, F.by_second, 0, 1}, error{F.error_slip, F.error_second, 0, 0};
    if (load_out) {
      const Row N = row(load);
      H.nt = N.by_slip, H.nn = N.by_second;
      error.nt = N.error_slip, error.nn = N.error_second;
      result.load_coherence.push_back(N.coherence);
    }
    result.matrix.push_back(H), result.matrix_error.push_back(error);
    result.tangential.push_back(F.by_slip);
    result.coherence.push_back(F.coherence);
    result.standard_error.push_back(F.error_slip);
    const double common = std::min(1.0, std::abs(S_v2) / std::sqrt(S_vv * S_22));
    result.conditioning.push_back((1 + common) / (1 - common));
  }
  if (result.frequency.empty())
    throw InputError(fmt::format("no frequency of the record lies between {} and {} Hz: it has {:.4g} … {:.4g} Hz",
                                 options.from, options.to, 2 * result.resolution, sample_rate / 2));
  result.bias_error = bias_of_width(result.tangential, spectra.window_moment(), spectra.window_ends());

  double peak = 0, outside = 0, all = 0;
  for (int k = 2; k < bins; ++k) peak = std::max(peak, spectra.spectrum(slip, slip, k).real());
  for (int k = 2; k < bins; ++k) {
    const double power = spectra.spectrum(force, force, k).real();
    all += power;
    const double input = spectra.spectrum(slip, slip, k).real();
    if (input < driven_part * peak) outside += power - std::norm(spectra.spectrum(slip, force, k)) / input;
  }
  result.outside_band = all > 0 ? outside / all : 0;
  warn(result, spectra, channels, sample_rate, options.estimator);
  const auto worst = result.conditioning.empty() ? 1.0 : std::ranges::max(result.conditioning);
  if (worst > 20)
    result.warnings.push_back(fmt::format(
        "the two inputs are nearly one (condition number up to {:.3g}): the columns of the matrix cannot be told apart",
        worst));
  return result;
}

}  // namespace rosin::analysis::response
