/// Stability of a structure with friction contacts: summary, loop picture, JSON.
#include "app/verbs/frf_use.hpp"

#include <numbers>

#include "app/output/figure.hpp"
#include "app/output/scene_figure.hpp"
#include "app/tasks/frf.hpp"
#include "core/files.hpp"
#include "core/random.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

namespace fs = std::filesystem;
using Complex = std::complex<double>;

/// What a picture of the loop says beside its line.
struct Verdict {
  std::string text;           ///< "unstable: 2 roots in the right half-plane"
  std::vector<double> modes;  ///< Hz, marked along the loop
  double margin, margin_frequency;
};

/// "174 Hz" of each mode where the loop passes it, away from the origin.
std::vector<results::Mark> marks_of(const std::vector<double>& modes, const std::vector<double>& frequency,
                                    const std::vector<Complex>& loop) {
  std::vector<results::Mark> marks;
  for (const double mode : modes) {
    const auto above = std::ranges::upper_bound(frequency, mode);
    if (above == frequency.begin() || above == frequency.end()) continue;
    const auto k = std::size_t(above - frequency.begin());
    const double part = (mode - frequency[k - 1]) / (frequency[k] - frequency[k - 1]);
    const Complex at = loop[k - 1] + part * (loop[k] - loop[k - 1]);
    marks.push_back({at.real(),
                     at.imag(),
                     fmt::format("{:.4g} Hz", mode),
                     at.real() < 0 ? results::Side::left : results::Side::right,
                     {.size = 0.7}});
  }
  return marks;
}

/// The loop iω Z H in the complex plane with the modes along it, the verdict, and the distance to −1 along frequency.
void draw_loop(Job& job, const std::vector<double>& frequency, const std::vector<Complex>& loop, const Verdict& verdict,
               results::Result& result, std::vector<std::string>& files) {
  std::vector<double> real, imaginary, distance;
  for (const auto& L : loop) {
    real.push_back(L.real()), imaginary.push_back(L.imag());
    distance.push_back(std::abs(1.0 + L));
  }
  result.tables.push_back(results::rows(
      "loop",
      {{{"frequency", "Hz"}, frequency}, {{"real"}, real}, {{"imaginary"}, imaginary}, {{"distance"}, distance}}));
  if (frequency.size() < 2) return;  // no line
  auto figure = output::figure_of(job.scene(), "loop", "Nyquist's plot of the loop of friction and structure");
  figure.title += figure.title.empty() ? verdict.text : ": " + verdict.text;
  figure.width = 1000, figure.columns = 2, figure.height = 350, figure.key = results::Key::own;
  results::Panel plane{
      .x = {.name = "real part of the loop iω Z H",
            .shown = results::Extent::of(real),
            .before = 0.1,
            .after = 0.1,
            .zero = true},
      .y = {.name = "imaginary part of the loop", .shown = results::Extent::of(imaginary), .zero = true},
      .lines = {{.table = "loop.csv", .x = {2}, .y = {3}, .title = "loop, modes along it"}},
      .marks = marks_of(verdict.modes, frequency, loop)};
  plane.marks.push_back({-1, 0, "", results::Side::none, {.style = 1, .size = 1.2}, true, "critical point −1"});
  const auto [nearest, farthest] = std::ranges::minmax(distance);
  results::Panel along{
      .x = {.name = "frequency",
            .unit = "Hz",
            .decades = frequency.back() > 20 * frequency.front(),
            .from = frequency.front(),
            .to = frequency.back()},
      .y = {.name = "distance to the critical point", .decades = true, .from = nearest / 1.5, .to = farthest * 1.5},
      .lines = {{.table = "loop.csv", .y = {4}}}};
  if (std::isfinite(verdict.margin))
    along.marks = {{verdict.margin_frequency,
                    verdict.margin,
                    "",
                    results::Side::none,
                    {.style = 1, .size = 1},
                    true,
                    fmt::format("margin {:.3g} at {:.4g} Hz", verdict.margin, verdict.margin_frequency)}};
  figure.panels = {std::move(plane), std::move(along)};
  for (auto& file : output::write(job.folder(), figure)) files.push_back(std::move(file));
}

void add_uncertainty(Job& job, ordered_json& stability, const analysis::response::Uncertainty& spread,
                     const char* measure, const char* unit) {
  const auto& inputs = job.scene().task<tasks::Frf>().use->uncertain;
  job.say("with uncertain inputs: unstable in {:.3g} ± {:.1g} % of {} samples, {} {:.4g} … {:.4g}{} (5 to 95 %)",
          100 * spread.probability, 100 * spread.standard_error, spread.samples, measure, spread.low, spread.high,
          std::string_view(unit).empty() ? "" : fmt::format(" {}", unit));
  auto& uncertainty = stability["uncertainty"];
  uncertainty = {{"samples", spread.samples},
                 {"probability_unstable", spread.probability},
                 {"standard_error", spread.standard_error},
                 {measure, {spread.low, spread.median, spread.high}}};
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    uncertainty["influence"][inputs[i].parameter] = spread.influence[i];
    job.say("  {:<32} rank correlation with {} {:+.3f}", inputs[i].parameter, measure, spread.influence[i]);
  }
}

void add_critical(Job& job, ordered_json& stability, const std::vector<analysis::response::CriticalValue>& values) {
  const auto& use = *job.scene().task<tasks::Frf>().use;
  stability["critical"] = ordered_json::array();
  const auto unit = use.sliding.describe(use.scan).unit;
  for (const auto& critical : values) {
    job.say("critical {} = {}, at {:.6g} Hz", use.scan, justified(critical.value, critical.error, unit),
            critical.angular_frequency / (2 * std::numbers::pi));
    stability["critical"].push_back({{"parameter", use.scan},
                                     {"value", critical.value},
                                     {"angular_frequency", critical.angular_frequency},
                                     {"error", critical.error}});
  }
  if (values.empty()) job.say("no critical value of {} from {} to {}", use.scan, use.scan_from, use.scan_to);
}

/// The loop of friction and receptance as measured or as the sliding structure gives them. A measured receptance has
/// resonances: between its frequencies nothing is known.
analysis::response::LoopPath loop_by_tables(const analysis::response::SlidingStructure& sliding,
                                            const std::vector<double>& frequency, std::vector<Complex> friction,
                                            const std::vector<Complex>& receptance) {
  if (receptance.empty())
    return analysis::response::measured_friction_loop(sliding.structure(), sliding.model, sliding.normal, frequency,
                                                      friction);
  if (friction.empty()) {
    const analysis::response::FrictionResponse response(sliding.model);
    for (const double f : frequency) friction.push_back(response.tangential({0, 2 * std::numbers::pi * f}));
  }
  analysis::response::LoopPath path{frequency, {}};
  for (std::size_t k = 0; k < frequency.size(); ++k)
    path.loop.push_back(Complex(0, 2 * std::numbers::pi * frequency[k]) * friction[k] * receptance[k]);
  return path;
}

/// "stable", or that the tables do not tell.
std::string judgement(const analysis::response::TableLoop& loop) {
  return !loop.resolved ? "undecided" : loop.unstable == 0 ? "stable" : "unstable";
}

/// Adds to each value what its standard error lets expect.
void disturb(std::vector<Complex>& values, const std::vector<double>& error, std::uint64_t seed) {
  const auto noise = white_noise(2 * error.size(), seed);
  for (std::size_t k = 0; k < error.size(); ++k) values[k] += error[k] * Complex(noise[2 * k], noise[2 * k + 1]);
}

void table_stability(Job& job, results::Result& result, std::vector<std::string>& files) {
  auto& stability = result["stability"];
  const auto& use = *job.scene().task<tasks::Frf>().use;
  const auto& table = use.friction.frequency.empty() ? use.receptance : use.friction;
  if (!use.friction.frequency.empty() && !use.receptance.frequency.empty() &&
      use.friction.frequency != use.receptance.frequency)
    throw InputError(
        "frf.structure: friction and receptance must be measured at the same frequencies; nothing is "
        "interpolated");
  const auto path = loop_by_tables(use.sliding, table.frequency, use.friction.value, use.receptance.value);
  const auto loop = analysis::response::close_table(path);
  stability["stable"] = loop.resolved ? ordered_json(loop.unstable == 0) : ordered_json();
  stability["unstable_by_nyquist"] = loop.unstable;
  stability["turns"] = loop.turns;
  stability["resolved"] = loop.resolved;
  stability["margin"] = loop.margin;
  stability["margin_frequency"] = loop.margin_frequency;
  job.say("structure and friction, by tables: {}, {} roots in the right half-plane; margin {:.4g} at {:.5g} Hz",
          judgement(loop), loop.unstable, loop.margin, loop.margin_frequency);
  if (!loop.resolved)
    job.note(use.receptance.frequency.empty() ? "friction between the frequencies of its table is not known well "
                                                "enough for the count of roots: it needs closer ones"
                                              : "the loop turns by more than a quarter between neighbouring "
                                                "frequencies: the count is not to be relied on");
  const auto loop_at = [&](double value) {
    return loop_by_tables(use.sliding.with(use.scan, value), table.frequency, use.friction.value, use.receptance.value);
  };
  const bool scans = !use.scan.empty();
  if (scans && loop_at(use.scan_from).loop == loop_at(use.scan_to).loop) {
    job.note(fmt::format("{} changes nothing here: what is measured holds at the load and speed of its measurement",
                         use.scan));
  } else if (scans) {
    add_critical(job, stability,
                 analysis::response::critical_values(
                     [&](double value) { return analysis::response::close_table(loop_at(value)); }, use.scan_from,
                     use.scan_to, use.scan_points));
  }
  if (!use.uncertain.empty() || !use.friction.error.empty() || !use.receptance.error.empty()) {
    const auto spread = analysis::response::propagate(
        use.sliding, use.uncertain, use.samples, use.seed,
        [&](const analysis::response::SlidingStructure& changed, int sample) {
          auto friction = use.friction.value, receptance = use.receptance.value;
          disturb(friction, use.friction.error, use.seed + 2 * std::uint64_t(sample) + 1);
          disturb(receptance, use.receptance.error, use.seed + 2 * std::uint64_t(sample) + 2);
          const auto drawn =
              analysis::response::close_table(loop_by_tables(changed, table.frequency, friction, receptance));
          return analysis::response::Drawn{drawn.unstable > 0, drawn.margin};
        });
    add_uncertainty(job, stability, spread, "margin", "");
  }
  draw_loop(job, path.frequency, path.loop,
            {fmt::format("{} by tables: {} roots in the right half-plane", judgement(loop), loop.unstable),
             {},
             loop.margin,
             loop.margin_frequency},
            result, files);
}

}  // namespace

namespace {
/// Says where friction would change a load that was measured without sliding.
void note_loads(Job& job, const analysis::response::Structure& structure,
                const analysis::response::NormalContact& normal) {
  const auto& model = job.scene().model;
  const double N = model.drive.normal_load.level();
  const auto loads = analysis::response::loads_under_friction(structure, model, normal);
  const auto off = [N](double load) { return std::abs(load - N); };
  constexpr double hardly = 0.01;
  if (loads.empty() || !(off(std::ranges::max(loads, {}, off)) > hardly * N)) return;
  job.note(
      fmt::format("{:.6g} N presses each contact in steady sliding, as drive.normal_load has it; where that is the "
                  "load without friction, sliding makes it {:.4g} N",
                  N, fmt::join(loads, " N, ")));
}
}  // namespace

void add_stability(Job& job, results::Result& result, std::vector<std::string>& files) {
  const auto& scene = job.scene();
  auto& frf = scene.task<tasks::Frf>();
  if (!frf.use) return;
  const auto& use = *frf.use;
  auto& stability = result["stability"];
  if (!use.friction.frequency.empty() || !use.receptance.frequency.empty()) {
    table_stability(job, result, files);
    return;
  }
  const auto structure = use.sliding.structure();
  if (use.sliding.normal) note_loads(job, structure, *use.sliding.normal);
  const auto loop = analysis::response::close_loop(structure, scene.model, use.sliding.normal);
  stability["stable"] = loop.stable;
  stability["marginal"] = loop.marginal;
  stability["eigenvalues"] = results::pairs(loop.eigenvalues);
  stability["unstable_by_eigenvalues"] = loop.unstable_by_eigenvalues;
  stability["unstable_by_nyquist"] = loop.unstable_by_nyquist;
  stability["margin"] = loop.margin;
  stability["margin_frequency"] = loop.margin_frequency / (2 * std::numbers::pi);
  const auto& leading = loop.eigenvalues.front();
  job.say("structure and friction: {}; largest growth {:.6g} 1/s at {:.6g} Hz",
          loop.marginal ? "marginal"
          : loop.stable ? "stable"
                        : "unstable",
          leading.real(), std::abs(leading.imag()) / (2 * std::numbers::pi));
  if (loop.marginal)
    job.say(
        "an eigenvalue lies on the imaginary axis within rounding, and none beyond it: Nyquist does not count there");
  else
    job.say("roots in the right half-plane: {} by eigenvalues, {} by Nyquist", loop.unstable_by_eigenvalues,
            loop.unstable_by_nyquist);
  if (!loop.marginal && loop.unstable_by_nyquist != loop.unstable_by_eigenvalues)
    job.note("eigenvalues and Nyquist do not agree: an eigenvalue is too near the imaginary axis to be told from it");
  if (std::isfinite(loop.margin))
    job.say("margin {:.4g} at {:.6g} Hz: the least distance of the loop to -1", loop.margin,
            loop.margin_frequency / (2 * std::numbers::pi));

  if (!use.scan.empty())
    add_critical(
        job, stability,
        analysis::response::critical_values(use.sliding, use.scan, use.scan_from, use.scan_to, use.scan_points));
  if (!use.uncertain.empty()) {
    const auto spread = analysis::response::propagate(use.sliding, use.uncertain, use.samples, use.seed);
    add_uncertainty(job, stability, spread, "growth", "1/s");
  }
  if (structure.contacts.size() == 1 && structure.contacts.front().normal.size() == 0) {
    const analysis::response::FrictionResponse response(scene.model);
    const auto loop_at = [&](double f) {
      const Complex s(0, 2 * std::numbers::pi * f);
      return s * response.tangential(s) * analysis::response::receptance(structure, s);
    };
    // Resonances are narrow: frequencies are added until the line is smooth.
    std::vector<double> frequency = frf.options.frequencies;
    std::vector<Complex> values;
    for (const double f : frequency) values.push_back(loop_at(f));
    double size = 0;
    for (const auto& L : values) size = std::max(size, std::abs(L));
    for (int pass = 0; pass < 8; ++pass) {
      std::vector<double> finer;
      std::vector<Complex> finer_values;
      for (std::size_t k = 0; k < frequency.size(); ++k) {
        if (k > 0 && std::abs(values[k] - values[k - 1]) > 0.03 * size) {
          finer.push_back(0.5 * (frequency[k - 1] + frequency[k]));
          finer_values.push_back(loop_at(finer.back()));
        }
        finer.push_back(frequency[k]);
        finer_values.push_back(values[k]);
      }
      frequency = std::move(finer), values = std::move(finer_values);
    }
    std::vector<double> modes;
    for (const auto& eigenvalue : loop.eigenvalues)
      if (eigenvalue.imag() > 0) modes.push_back(eigenvalue.imag() / (2 * std::numbers::pi));
    const auto text =
        fmt::format("{}: {} roots in the right half-plane; largest growth {:.4g} 1/s at {:.4g} Hz",
                    loop.marginal ? "marginal"
                    : loop.stable ? "stable"
                                  : "unstable",
                    loop.unstable_by_eigenvalues, leading.real(), std::abs(leading.imag()) / (2 * std::numbers::pi));
    draw_loop(job, frequency, values,
              {text, std::move(modes), loop.margin, loop.margin_frequency / (2 * std::numbers::pi)}, result, files);
  }
}

}  // namespace rosin::app::verbs
