/// The verb frf: the friction frequency response, predicted, simulated and measured.

#include "app/tasks/frf.hpp"

#include <numbers>
#include <optional>

#include "analysis/response/interval_means.hpp"
#include "app/output/figure.hpp"
#include "app/output/scene_figure.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/record.hpp"
#include "app/scene/scene.hpp"
#include "app/verbs/frf_scene.hpp"
#include "app/verbs/frf_use.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/verb.hpp"
#include "core/files.hpp"
#include "core/stop.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

namespace fs = std::filesystem;
using Complex = std::complex<double>;
using analysis::response::FrfCurve;

ordered_json roots(const std::vector<analysis::response::FrictionResponse::Root>& list) {
  auto array = ordered_json::array();
  for (const auto& root : list) array.push_back(results::pair(root.value));
  return array;
}

using analysis::response::ResponseMatrix;

/// An array of pairs for each entry; of errors, which are real numbers, an array of numbers.
ordered_json entries(const std::vector<ResponseMatrix>& matrices, bool errors = false) {
  ordered_json object;
  for (const auto& [name, entry] : {std::pair{"tt", &ResponseMatrix::tt}, std::pair{"tn", &ResponseMatrix::tn},
                                    std::pair{"nt", &ResponseMatrix::nt}, std::pair{"nn", &ResponseMatrix::nn}}) {
    auto& list = object[name] = ordered_json::array();
    for (const auto& matrix : matrices)
      list.push_back(errors ? ordered_json((matrix.*entry).real()) : results::pair(matrix.*entry));
  }
  return object;
}

const char* second_input(const scene::Scene& scene) {
  return scene.task<tasks::Frf>().options.rig.normal ? "approach_rate" : "normal_load";
}

template <class Document>
void describe(Document& object, const FrfCurve& curve) {
  object["slip_rate"] = curve.slip_rate;
  object["normal_load"] = curve.normal_load;
  object["friction_coefficient"] = curve.friction_coefficient;
  object["tangential"] = results::pairs(curve.tangential);
  object["low_frequency_limit"] = curve.limits.low;
  object["high_frequency_limit"] = curve.limits.high;
  if (curve.limits.stiffness != 0) object["high_frequency_stiffness"] = curve.limits.stiffness;
  object["poles"] = roots(curve.poles);
  object["zeros"] = roots(curve.zeros);
  auto pole_error = ordered_json::array(), zero_error = ordered_json::array();
  for (const auto& root : curve.poles) pole_error.push_back(root.error);
  for (const auto& root : curve.zeros) zero_error.push_back(root.error);
  object["error"] = {{"poles", pole_error}, {"zeros", zero_error}};
  object["linear_amplitude"] = curve.linear_amplitude;
  if (!curve.matrix.empty()) object["matrix"] = entries(curve.matrix);
}

results::Result result_of(const Job& job, const analysis::response::FrfPrediction& prediction) {
  const auto& scene = job.scene();
  const auto& frf = scene.task<tasks::Frf>();
  auto result = job.result();
  result.add({"frequency", "Hz"}, frf.options.frequencies);
  describe(result, prediction.curve);
  if (frf.options.rig.matrix) result["matrix"]["inputs"] = {"slip_rate", second_input(scene)};
  for (const auto& s : prediction.sensitivities)
    result["sensitivities"][s.parameter] = {{"unit", s.unit}, {"slope", results::pairs(s.slope)}, {"error", s.error}};
  if (!prediction.family.empty()) {
    auto& family = result["family"];
    family = {{"parameter", frf.options.family}, {"unit", scene.model.describe(frf.options.family).unit}};
    family["members"] = ordered_json::array();
    for (const auto& member : prediction.family) {
      ordered_json one{{"value", member.value}};
      describe(one, member);
      family["members"].push_back(std::move(one));
    }
    if (!prediction.load_exponent.empty()) family["load_exponent"] = prediction.load_exponent;
  }
  return result;
}

results::Result result_of(const Job& job, const analysis::response::MeasuredFrf& measured,
                          const std::vector<Complex>& predicted) {
  auto result = job.result();
  result.add({"frequency", "Hz"}, measured.frequency);
  result.add({"tangential", "N s/m"}, results::pairs(measured.tangential));
  result["coherence"] = measured.coherence;
  result["standard_error"] = measured.standard_error;
  result["bias_error"] = measured.bias_error;
  if (!measured.h1.empty()) {
    result["h1"] = results::pairs(measured.h1);
    result["h2"] = results::pairs(measured.h2);
    result["hv"] = results::pairs(measured.hv);
  }
  if (!measured.matrix.empty()) {
    result["matrix"] = entries(measured.matrix);
    result["matrix_standard_error"] = entries(measured.matrix_error, true);
    result["conditioning"] = measured.conditioning;
    if (!measured.load_coherence.empty()) result["load_coherence"] = measured.load_coherence;
  }
  result["averages"] = measured.averages;
  result.add({"resolution", "Hz"}, measured.resolution);
  result["mean"] = {{"slip_rate", measured.slip_rate}, {"force", measured.force}};
  result["rms"] = {{"slip_rate", measured.slip_rate_rms}, {"force", measured.force_rms}};
  result["outside_band"] = measured.outside_band;
  result["warnings"] = measured.warnings;
  if (!predicted.empty()) result["predicted"] = results::pairs(predicted);
  return result;
}

/// Continuous along the curve, in degrees.
std::vector<double> phase(const std::vector<Complex>& Z) {
  std::vector<double> degrees;
  for (const auto& z : Z) {
    double now = std::arg(z) * 180 / std::numbers::pi;
    if (!degrees.empty()) now -= 360 * std::round((now - degrees.back()) / 360);
    degrees.push_back(now);
  }
  return degrees;
}

std::vector<double> parts(const std::vector<Complex>& Z, double (*part)(const Complex&)) {
  std::vector<double> values;
  for (const auto& z : Z) values.push_back(part(z));
  return values;
}

/// A response over frequency, in parts and in polar form.
results::Table table_of(std::string name, const std::vector<double>& frequency, const std::vector<Complex>& Z,
                        const char* unit = "N s/m") {
  return results::rows(std::move(name), {{{"frequency", "Hz"}, frequency},
                                         {{"real", unit}, parts(Z, [](const Complex& z) { return z.real(); })},
                                         {{"imaginary", unit}, parts(Z, [](const Complex& z) { return z.imag(); })},
                                         {{"magnitude", unit}, parts(Z, [](const Complex& z) { return std::abs(z); })},
                                         {{"phase", "degree"}, phase(Z)}});
}

/// False of friction that does not answer: Z is 0 throughout.
bool answers(const std::vector<Complex>& Z) {
  return std::ranges::any_of(Z, [](const Complex& z) { return std::abs(z) > 0; });
}

/// The members of a family, over the parameter that they differ in.
results::Table table_of(const scene::Scene& scene, const std::vector<FrfCurve>& family) {
  const auto& options = scene.task<tasks::Frf>().options;
  results::Table plane{.name = "frf-family", .dimensions = {}, .columns = {}};
  std::vector<double> values;
  for (const auto& member : family) {
    values.push_back(member.value);
    auto one = table_of("", options.frequencies, member.tangential);
    if (plane.columns.empty()) {
      plane.columns = std::move(one.columns);
      continue;
    }
    for (std::size_t c = 1; c < one.columns.size(); ++c) {
      auto& all = std::get<std::vector<double>>(plane.columns[c].values);
      all.insert(all.end(), one.columns[c].numbers().begin(), one.columns[c].numbers().end());
    }
  }
  std::vector<std::string> taken;
  for (auto& column : plane.columns) column.over = {0, 1}, taken.push_back(column.of.name);
  plane.columns.front().over = {1};
  const auto name = results::axis_names({options.family}, taken).front();
  const auto quantity = scene.model.describe(options.family);
  plane.columns.insert(plane.columns.begin(),
                       {{name, quantity.unit, quantity.meaning}, values, {}, {0}, {{"path", options.family}}});
  plane.dimensions = {{name, values.size()}, {"frequency", options.frequencies.size()}};
  return plane;
}

/// One line of a picture: a table of write_curve, and what it holds.
struct Line {
  std::string file, title;
  const std::vector<Complex>* response;
};

results::Axis axis(std::string name, std::string symbol, std::string unit) {
  return {.name = std::move(name), .unit = std::move(unit), .symbol = std::move(symbol)};
}

results::Axis frequencies(const std::vector<double>& f) {
  auto over = axis("frequency", "f", "Hz");
  over.from = f.front(), over.to = f.back();
  over.decades = f.back() / f.front() > 20;
  return over;
}

/// Magnitude, phase, real and imaginary part over frequency, and the path in the complex plane: of tables whose columns
/// 1 to 5 are frequency, real and imaginary part, magnitude and phase.
std::vector<results::Panel> response_panels(const results::Axis& over,
                                            const std::vector<const std::vector<Complex>*>& responses) {
  auto real = axis("real part", "Re Z", "N s/m"), imaginary = axis("imaginary part", "Im Z", "N s/m");
  for (const auto* response : responses)
    for (const auto& z : *response) real.shown.include(z.real()), imaginary.shown.include(z.imag());
  real.zero = imaginary.zero = true;
  auto along = real;
  along.before = along.after = 0.05;
  return {{.x = over, .y = axis("magnitude", "|Z|", "N s/m")},
          {.x = over, .y = axis("phase", "arg Z", "degree")},
          {.x = over, .y = real},
          {.x = over, .y = imaginary},
          {.x = along, .y = imaginary}};
}
constexpr int column_of_panel[] = {4, 5, 2, 3, 3};  ///< of those tables

/// \returns the names of the files
std::vector<std::string> write_picture(const fs::path& folder, const scene::Scene& scene,
                                       const std::vector<Line>& lines) {
  std::vector<const std::vector<Complex>*> responses;
  for (const auto& line : lines) responses.push_back(line.response);
  auto figure =
      output::figure_of(scene, "frf", "Friction frequency response: magnitude, phase, parts, and the complex plane");
  figure.width = 1000, figure.columns = 2, figure.height = 250;
  figure.panels = response_panels(frequencies(scene.task<tasks::Frf>().options.frequencies), responses);
  for (std::size_t p = 0; p < figure.panels.size(); ++p)
    for (std::size_t k = 0; k < lines.size(); ++k)
      figure.panels[p].lines.push_back({.table = lines[k].file,
                                        .x = {p == 4 ? 2 : 1},
                                        .y = {column_of_panel[p]},
                                        .look = {.style = results::style_of(k)},
                                        .title = lines[k].title});
  auto& magnitude = figure.panels.front();
  // Where no magnitude is above 0, a logarithmic axis has nothing to show.
  magnitude.y.decades = std::ranges::any_of(lines, [](const auto& line) { return answers(*line.response); });
  if (magnitude.y.decades)
    for (auto& line : magnitude.lines) line.where = {{4, '>', 0}};
  else
    magnitude.y.from = -1, magnitude.y.to = 1;
  figure.panels.erase(figure.panels.begin() + 3);  // the imaginary part stands over the real one
  return output::write(folder, figure);
}

/// Measured points with bands of two standard errors, the prediction as a line, and the coherence.
/// \returns the names of the files
std::vector<std::string> write_measured_picture(const fs::path& folder, const scene::Scene& scene,
                                                const analysis::response::MeasuredFrf& measured, bool predicted) {
  auto figure = output::figure_of(
      scene, "frf", "Friction frequency response as measured, with bands of two standard errors, and as predicted");
  figure.width = 1000, figure.columns = 2, figure.height = 215;
  const auto over = frequencies(measured.frequency);
  figure.panels = response_panels(over, {&measured.tangential});
  results::FigureTable bands{"frf-bands.csv", {{"frequency (Hz)", measured.frequency}}};
  const auto& z = measured.tangential;
  const std::pair<const char*, std::vector<double>> shown[] = {
      {"magnitude", parts(z, [](const Complex& one) { return std::abs(one); })},
      {"phase", phase(z)},
      {"real", parts(z, [](const Complex& one) { return one.real(); })},
      {"imaginary", parts(z, [](const Complex& one) { return one.imag(); })}};
  for (const auto& [name, values] : shown)
    for (const double side : {-2.0, 2.0}) {
      auto edge = values;
      for (std::size_t i = 0; i < edge.size(); ++i)
        edge[i] += side * measured.standard_error[i] *
                   (name == std::string("phase") ? 180 / std::numbers::pi / std::abs(z[i]) : 1);
      bands.columns.push_back({std::string(name) + (side < 0 ? "_low" : "_high"), std::move(edge)});
    }
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const int x = p == 4 ? 2 : 1, low = int(2 * p) + 2, y = column_of_panel[p];
    auto& lines = figure.panels[p].lines;
    if (p < 4)
      lines.push_back({.table = bands.file,
                       .how = results::How::band,
                       .look = {.colour = "#C8D6EA"},
                       .title = "95 % band",
                       .low = {low},
                       .high = {low + 1}});
    lines.push_back({.table = "frf.csv",
                     .x = {x},
                     .y = {y},
                     .how = p < 4 ? results::How::line : results::How::points,
                     .look = {.width = 1, .size = 0.3},
                     .title = "measured"});
    if (predicted)
      lines.push_back(
          {.table = "frf-predicted.csv", .x = {x}, .y = {y}, .look = {.style = 1, .width = 2}, .title = "predicted"});
  }
  auto coherence = axis("coherence", "", "1");
  coherence.from = 0, coherence.to = 1.02;
  figure.panels.push_back(
      {.x = over, .y = coherence, .lines = {{.table = "frf.csv", .y = {7}, .look = {.width = 1.2}}}});
  figure.tables = {std::move(bands)};
  return output::write(folder, figure);
}

/// Writes what was measured, by whatever means, beside what is predicted.
/// \param record  the motion that was simulated
Status finish_measured(Job& job, const analysis::response::MeasuredFrf& measured,
                       std::optional<results::Table> record = {}) {
  std::vector<std::string> files;
  auto& scene = job.scene();
  for (const auto& warning : measured.warnings) job.note(warning);
  std::vector<Complex> predicted;
  if (scene.task<tasks::Frf>().predicts) {
    const analysis::response::FrictionResponse response(scene.model);
    for (const double f : measured.frequency) {
      const Complex s(0, 2 * std::numbers::pi * f);
      predicted.push_back(response.tangential(s, scene.task<tasks::Frf>().options.rig));
    }
  }
  job.say("{} frequencies from {:.6g} to {:.6g} Hz, {:.4g} independent averages, resolution {:.4g} Hz",
          measured.frequency.size(), measured.frequency.front(), measured.frequency.back(), measured.averages,
          measured.resolution);
  job.say("slip rate {:.6g} m/s, rms {:.3g} m/s; force {:.6g} N, rms {:.3g} N", measured.slip_rate,
          measured.slip_rate_rms, measured.force, measured.force_rms);
  double least = 1;
  for (const double c : measured.coherence) least = std::min(least, c);
  job.say("coherence at least {:.4g}", least);
  Reached reached;
  std::size_t near = 0;
  for (std::size_t k = 0; k < measured.frequency.size(); ++k) {
    reached.add(std::abs(measured.tangential[k]), measured.standard_error[k]);
    if (!predicted.empty()) near += std::abs(measured.tangential[k] - predicted[k]) <= 3 * measured.standard_error[k];
  }
  job.manifest().tolerance_reached = reached.value();
  if (!predicted.empty())
    job.say("within three standard errors of the prediction at {:.3g} % of the frequencies",
            100.0 * double(near) / double(predicted.size()));

  for (auto& file : write_measured_picture(job.folder(), scene, measured, !predicted.empty()))
    files.push_back(std::move(file));
  auto result = result_of(job, measured, predicted);
  result.tables.insert(result.tables.begin(), table_of("frf", measured.frequency, measured.tangential));
  auto& columns = result.tables.front().columns;
  columns.push_back({{"standard_error", "N s/m"}, measured.standard_error});
  columns.push_back({{"coherence"}, measured.coherence});
  if (!predicted.empty()) result.tables.push_back(table_of("frf-predicted", measured.frequency, predicted));
  if (record) result.tables.push_back(std::move(*record));
  return job.finish(result, std::move(files));
}

/// Takes the stretches between rows in which a number is missing, one after the other.
class Stretches {
 public:
  Stretches(const tasks::FrfRecord& record, double sample_rate)
      : spectra_(record.channels.count(), welch(record, sample_rate)) {
    if (record.displacement) means_.emplace(record.channels.count(), sample_rate);
  }
  void add(std::span<const std::span<const double>> block) {
    const auto missing = [&](std::size_t i) {
      return std::ranges::any_of(block, [&](const auto& column) { return std::isnan(column[i]); });
    };
    const auto length = block.front().size();
    for (std::size_t begin = 0, end = 0; end <= length; ++end) {
      if (end < length && !missing(end)) continue;
      if (end > begin) {
        std::vector<std::span<const double>> part;
        for (const auto& column : block) part.push_back(column.subspan(begin, end - begin));
        spectra_.add(means_ ? means_->add(part) : part);
      }
      if (end < length) {
        spectra_.interrupt();
        if (means_) means_->interrupt();
      }
      begin = end + 1;
    }
  }
  const analysis::response::CrossSpectra& spectra() const { return spectra_; }
  const std::optional<analysis::response::IntervalMeans>& means() const { return means_; }

 private:
  static analysis::response::WelchOptions welch(const tasks::FrfRecord& record, double sample_rate) {
    auto options = record.welch;
    options.segment = analysis::response::segment_for(record.resolution, sample_rate);
    return options;
  }
  analysis::response::CrossSpectra spectra_;
  std::optional<analysis::response::IntervalMeans> means_;
};

Status extract(Job& job) {
  const auto& record = *job.scene().task<tasks::Frf>().record;
  job.explain("segments of {} Hz resolution, window {}, overlap {}; the record is read in blocks", record.resolution,
              record.welch.window, record.welch.overlap);
  const auto begin = std::chrono::steady_clock::now();
  std::optional<Stretches> stretches;
  const auto end = scene::read_record(record.source, [&](double rate, std::span<const std::span<const double>> block) {
    if (!stretches) stretches.emplace(record, rate);
    stretches->add(block);
  });
  job.explain("{}", end.understood);
  std::vector<std::string> warnings;
  const auto& spectra = stretches->spectra();
  if (end.gaps > 0)
    warnings.push_back(fmt::format(
        "{} of {} rows lack a number{}; no segment reaches across them, and {} rows ({:.3g} %) stand in none", end.gaps,
        end.samples, end.missing > 0 ? fmt::format(", or stand for {} that are missing", end.missing) : "",
        end.samples - spectra.used(), 100.0 * double(end.samples - spectra.used()) / double(end.samples)));
  auto extraction = record.extraction;
  if (record.displacement) {
    job.explain(
        "slip rate: the displacement's means over the interval between samples, beside means of the other columns; "
        "what "
        "that changes, θ²/12 with θ = 2π f/f_s, is a part of bias_error");
    const double highest = analysis::response::highest_part * end.sample_rate;
    if (extraction.to > highest && extraction.to < infinity)
      warnings.push_back(
          fmt::format("frequencies end at {:.6g} Hz, a quarter of the sample rate: above it a displacement says too "
                      "little of slip rate",
                      highest));
    extraction.to = std::min(extraction.to, highest);
  }
  auto measured = analysis::response::extract_frf(spectra, record.channels, end.sample_rate, extraction);
  if (const auto& means = stretches->means())
    analysis::response::state_interval_bias(measured, means->sample_rate(), end.sample_rate);
  measured.warnings.insert(measured.warnings.begin(), warnings.begin(), warnings.end());
  job.manifest().cost = {{"seconds", seconds_since(begin)}, {"samples", double(end.samples)}};
  return finish_measured(job, measured);
}

Status simulate_noise(Job& job, std::optional<double> tolerance) {
  auto options = *job.scene().task<tasks::Frf>().noise;
  options.tolerance = tolerance.value_or(options.tolerance);
  job.explain(
      "the contact is run at an imposed slip rate: {} m/s and noise of {} times that (rms), {} to {} Hz; then "
      "the response is extracted from the record",
      job.scene().model.drive.speed.level(), options.amplitude, options.low, options.high);
  const auto begin = std::chrono::steady_clock::now();
  const auto noise = analysis::response::simulate_noise(job.scene().model, options);
  job.manifest().cost = {{"seconds", seconds_since(begin)}, {"samples", double(noise.time.size())}};
  std::vector<results::Column> columns = {
      {{"time", "s"}, noise.time}, {{"slip_rate", "m/s"}, noise.slip_rate}, {{"friction_force", "N"}, noise.force}};
  if (!noise.normal_load.empty()) columns.push_back({{"normal_load", "N"}, noise.normal_load});
  return finish_measured(job, noise.measured, results::rows("frf-record", std::move(columns)));
}

Status simulate_sweep(Job& job) {
  const auto& request = job.request();
  const auto& scene = job.scene();
  auto options = *scene.task<tasks::Frf>().sweep;
  options.tolerance = request.tolerance.value_or(options.tolerance);
  options.threads = request.threads;
  job.explain(
      "the slip rate is imposed, with a sine of {} and {} of its mean: at each frequency one period of the steady "
      "motion, "
      "found by Newton's method; no transient is waited for",
      options.amplitude, options.amplitude / 2);
  const auto begin = std::chrono::steady_clock::now();
  const auto swept = analysis::response::simulate_sweep(scene.model, options);
  job.manifest().cost = {{"seconds", seconds_since(begin)}};
  const analysis::response::FrictionResponse response(scene.model);
  std::vector<Complex> predicted;
  std::vector<ResponseMatrix> predicted_matrix;
  Reached reached;
  double worst = 0, dependence = 0;
  const auto relative = [](const Complex& difference, double size) {
    return difference == 0.0 ? 0.0 : std::abs(difference) / size;
  };
  for (std::size_t k = 0; k < options.frequencies.size(); ++k) {
    const Complex s(0, 2 * std::numbers::pi * options.frequencies[k]);
    predicted.push_back(response.tangential(s, options.rig));
    const double size = std::abs(predicted.back());
    reached.add(size, swept.error[k]);
    worst = std::max(worst, relative(swept.tangential[k] - predicted.back(), size));
    dependence = std::max(dependence, relative(swept.at_amplitude[k] - swept.tangential[k], size));
    if (!options.rig.matrix) continue;
    predicted_matrix.push_back(response.matrix(s, options.rig));
    const auto& matrix = predicted_matrix.back();
    reached.add(std::abs(matrix.tn), swept.matrix_error[k].tn.real());
    worst = std::max(worst, relative(swept.matrix[k].tn - matrix.tn, std::abs(matrix.tn)));
  }
  job.manifest().tolerance_reached = reached.value();
  for (const auto& warning : swept.warnings) job.note(warning);
  job.say("{} frequencies{}: at most {:.2g} from the prediction, stated error at most {:.2g}", predicted.size(),
          options.rig.matrix ? ", slip rate and load moved in turn" : "", worst, reached.value());
  job.say(
      "an amplitude of {:g} of the mean changes the response by {:.2g} at most; second harmonic up to {:.2g}, third "
      "up to {:.2g} of the first",
      options.amplitude, dependence, std::ranges::max(swept.second_harmonic), std::ranges::max(swept.third_harmonic));
  auto result = job.result();
  result.add({"frequency", "Hz"}, options.frequencies);
  result.add({"tangential", "N s/m"}, results::pairs(swept.tangential));
  result["standard_error"] = swept.error;
  result["coherence"] = swept.coherence;
  result["at_amplitude"] = results::pairs(swept.at_amplitude);
  result["second_harmonic"] = swept.second_harmonic;
  result["third_harmonic"] = swept.third_harmonic;
  result["predicted"] = results::pairs(predicted);
  if (options.rig.matrix) {
    result["matrix"] = entries(swept.matrix);
    result["matrix"]["inputs"] = {"slip_rate", second_input(scene)};
    result["matrix_standard_error"] = entries(swept.matrix_error, true);
    result["predicted_matrix"] = entries(predicted_matrix);
  }
  result["warnings"] = swept.warnings;
  result.tables = {table_of("frf", options.frequencies, swept.tangential),
                   table_of("frf-predicted", options.frequencies, predicted)};
  std::vector<std::string> files;
  if (options.frequencies.size() > 1) {
    files =
        write_picture(job.folder(), scene,
                      {{"frf.csv", "simulated", &swept.tangential}, {"frf-predicted.csv", "predicted", &predicted}});
  }
  return job.finish(result, std::move(files));
}

/// The oscillator with friction in it: what a force along the contact's slip moves.
void add_receptance(Job& job, results::Result& result) {
  const auto& frf = job.scene().task<tasks::Frf>();
  if (!frf.oscillator) return;
  const auto& receptance = *frf.oscillator;
  const auto& frequencies = frf.options.frequencies;
  std::vector<Complex> contact;
  std::vector<double> contact_error;
  std::vector<std::vector<Complex>> coordinates(receptance.coordinates.size());
  std::vector<std::vector<double>> errors(receptance.coordinates.size());
  Reached reached;
  std::size_t largest = 0;
  for (const double f : frequencies) {
    end_if_stopped();
    const auto answer = receptance.at({0, 2 * std::numbers::pi * f});
    contact.push_back(answer.contact), contact_error.push_back(answer.contact_error);
    reached.add(std::abs(answer.contact), answer.contact_error);
    if (std::abs(answer.contact) > std::abs(contact[largest])) largest = contact.size() - 1;
    for (std::size_t i = 0; i < coordinates.size(); ++i)
      coordinates[i].push_back(answer.coordinates[i]), errors[i].push_back(answer.errors[i]);
  }
  job.manifest().tolerance_reached = reached.value();
  job.say("receptance along its slip, friction included: largest {} at {:.6g} Hz",
          justified(std::abs(contact[largest]), contact_error[largest], "m/N"), frequencies[largest]);
  auto& object = result["receptance"] = {{"contact", results::pairs(contact)}};
  ordered_json error = {{"contact", contact_error}};
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    object[receptance.coordinates[i]] = results::pairs(coordinates[i]);
    error[receptance.coordinates[i]] = errors[i];
  }
  result.describe({"receptance", "m/N"}, std::move(error));
  auto table = table_of("frf-receptance", frequencies, contact, "m/N");
  table.columns.push_back({{"error", "m/N"}, contact_error});
  result.tables.push_back(std::move(table));
}

Status perform_frf(Job& job) {
  const auto& scene = job.scene();
  auto& frf = scene.task<tasks::Frf>();
  const auto& model = scene.model;
  if (frf.record) return extract(job);
  if (frf.noise) return simulate_noise(job, job.request().tolerance);
  if (frf.sweep) return simulate_sweep(job);
  job.explain_model();
  job.explain("the contact is linearised about steady sliding; {} frequencies, no integration",
              frf.options.frequencies.size());
  if (!model.drive.constant()) job.note("the drive varies: the response is that about its mean, or about its start");

  const auto begin = std::chrono::steady_clock::now();
  const auto prediction = analysis::response::predict_frf(model, frf.options);
  job.manifest().cost = {{"seconds", seconds_since(begin)}};
  const auto& curve = prediction.curve;
  job.say("about steady sliding at {} m/s under {} N, friction coefficient {:.10g}", curve.slip_rate, curve.normal_load,
          curve.friction_coefficient);
  job.say("low-frequency limit  {:.10g} N s/m, the slope of the steady curve", curve.limits.low);
  if (curve.limits.stiffness != 0)
    job.say("high-frequency limit that of a spring of {:.10g} N/m", curve.limits.stiffness);
  else
    job.say("high-frequency limit {:.10g} N s/m", curve.limits.high);
  for (const auto& root : curve.poles) job.say("  pole {:.8g} {:+.8g} i 1/s", root.value.real(), root.value.imag());
  for (const auto& root : curve.zeros) job.say("  zero {:.8g} {:+.8g} i 1/s", root.value.real(), root.value.imag());
  const auto least = std::ranges::min(curve.linear_amplitude);
  if (std::isfinite(least))
    job.say("linear within 1 % of second harmonic up to {:.3g} m/s of slip rate amplitude, {:.2g} of the mean", least,
            least / std::abs(curve.slip_rate));
  if (const auto& exponent = prediction.load_exponent; !exponent.empty()) {
    job.say("over load, |Z| grows as N^{:.3g} at {:.4g} Hz and as N^{:.3g} at {:.4g} Hz", exponent.front(),
            frf.options.frequencies.front(), exponent.back(), frf.options.frequencies.back());
    if (exponent.back() < 0.5 && curve.limits.stiffness != 0)
      job.say(
          "friction itself scales with load, but a contact spring in series does not: at high frequency only it is "
          "seen");
  }

  auto result = result_of(job, prediction);
  std::vector<Line> lines;
  result.tables.push_back(table_of("frf", frf.options.frequencies, curve.tangential));
  for (std::size_t k = 0; k < prediction.family.size(); ++k) {
    const auto& member = prediction.family[k];
    const auto name = fmt::format("frf-{}", k + 1);
    result.tables.push_back(table_of(name, frf.options.frequencies, member.tangential));
    const auto quantity = model.describe(frf.options.family);
    lines.push_back({name + ".csv",
                     fmt::format("{} = {:g}{}", quantity.meaning.substr(0, quantity.meaning.find(';')), member.value,
                                 quantity.unit == "1" ? "" : " " + quantity.unit),
                     &member.tangential});
  }
  if (!prediction.family.empty()) result.tables.insert(result.tables.begin(), table_of(scene, prediction.family));
  if (lines.empty()) lines.push_back({"frf.csv", "predicted", &curve.tangential});
  std::vector<std::string> files;
  if (frf.options.frequencies.size() > 1) {  // one frequency is no line
    files = write_picture(job.folder(), scene, lines);
  }
  add_receptance(job, result);
  add_stability(job, result, files);
  return job.finish(result, std::move(files));
}

void read_frf_question(scene::SceneReader& reader) {
  auto& scene = reader.scene;
  const auto& document = reader.document;
  const bool measured = document.at_path("frf.record").node();  // which needs neither law nor drive
  const bool record_alone = measured && !document.contains("law") && !document.contains("drive");
  scene.task<tasks::Frf>().predicts = document.contains("drive");
  if (!record_alone) {
    reader.law();
    reader.oscillator_if_there();
    if (!measured) reader.need("drive", "speed and normal load");
    read_tables_of_models(reader);
  }
  read_frf(scene::Table(reader.need("frf", "frequencies"), "frf"), reader,
           record_alone ? nullptr : reader.root.find("oscillator"));
}

}  // namespace

Verb frf_verb() {
  return {.name = "frf",
          .help = "friction frequency response: how friction answers small changes of slip rate and load",
          .example = "rosin frf examples/frf-load-family.toml",
          .operands = {scene_operand},
          .needs = {{"law", "the friction law"},
                    {"drive", "speed and normal load"},
                    {"frf", "frequencies, and what is asked of them; a measured record needs neither law nor drive"}},
          .options = scene_options(),
          .read = read_frf_question,
          .perform = perform_frf};
}

}  // namespace rosin::app::verbs
