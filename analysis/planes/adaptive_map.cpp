/// Patches of a plane: which pixels they ask for, how these are computed, and what is made of them.
#include "analysis/planes/adaptive_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "analysis/planes/forecast.hpp"
#include "analysis/planes/map_point.hpp"
#include "analysis/planes/parts.hpp"
#include "analysis/planes/patch.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::planes {

namespace {

constexpr double node_share = 0.03;   ///< of the tolerance, asked of nodes: interpolation multiplies their errors
constexpr double direct_share = 0.1;  ///< the same of other points: few, but beside borders, where cycles settle slowly
constexpr int coarsest = 8;           ///< stride of the points beside borders that are looked at first
constexpr double finest = 1e-11;      ///< tolerance that is asked of any point

/// The pixels of a patch: [x0, x1] × [y0, y1]. Neighbours share a line of pixels, which belongs to the one beyond it.
struct Frame {
  int x0, x1, y0, y1;
  bool own_right, own_top;
};

/// In the order of the parts.
std::vector<Frame> frames(const Axis& x, const Axis& y) {
  const auto is_last = [](const Axis& axis, int end) { return end >= axis.regular; };
  std::vector<Frame> list;
  for (const auto& [y0, y_end] : patches_along(y))
    for (const auto& [x0, x_end] : patches_along(x)) {
      const bool own_right = is_last(x, x_end), own_top = is_last(y, y_end);
      list.push_back({x0, x_end - own_right, y0, y_end - own_top, own_right, own_top});
    }
  return list;
}

/// Classes of pixels.
enum : Patch::Class { settled = Patch::blank, unstable, beside_steady, refused };

/// The quantities that a patch interpolates: the metrics asked for, and what helps to interpolate them.
class Quantities {
 public:
  explicit Quantities(const MapOptions& options) {
    for (const auto& name : options.metrics) metrics.push_back(&cycles::find_metric(name));
    std::vector<std::string> wanted = options.metrics;
    const auto has = [&](const char* name) {
      return std::ranges::find(options.metrics, name) != options.metrics.end();
    };
    const std::pair<const char*, double> thresholds[] = {{"stick_fraction", options.stick_threshold},
                                                         {"slow_fraction", options.stick_threshold},
                                                         {"stick_fraction_001", 0.01},
                                                         {"stick_fraction_05", 0.5}};
    for (const auto& [name, threshold] : thresholds) {
      if (!has(name)) continue;
      const int q = int(std::ranges::find(options.metrics, name) - options.metrics.begin());
      roots.push_back({q, int(metrics.size()), threshold});
      lowest = true;
    }
    if (lowest) wanted.emplace_back("slip_rate_min");
    if (has("loop_area"))  // its size is that of v_max μ_max
      for (const char* name : {"slip_rate_max", "friction_max"}) wanted.emplace_back(name);
    std::ranges::sort(wanted);
    wanted.erase(std::ranges::unique(wanted).begin(), wanted.end());
    names = wanted;
  }
  int count() const { return int(metrics.size()) + lowest; }
  PixelValues of(const MapPoint& point, double V) const {
    PixelValues values;
    for (const auto* metric : metrics) {
      values.value.push_back(point.metrics.*metric->member);
      values.error.push_back(point.error.*metric->member);
      values.size.push_back(cycles::size_of(*metric, point.metrics, V));
    }
    if (lowest) {
      values.value.push_back(point.metrics.slip_rate_min / V);
      values.error.push_back(point.error.slip_rate_min / V);
      values.size.push_back(std::max(1.0, std::abs(values.value.back())));
    }
    return values;
  }

  std::vector<const cycles::MetricName*> metrics;
  std::vector<Patch::Options::Root> roots;
  std::vector<std::string> names;  ///< of the metrics to be computed
  bool lowest = false;             ///< the lowest slip rate, in units of the drive's, helps
};

/// One patch of the plane.
struct Piece {
  Piece(const Frame& f, const Quantities& quantities, const MapOptions& options,
        std::function<Patch::Class(int, int)> classify)
      : frame(f),
        patch({f.x1 - f.x0 + 1, f.y1 - f.y0 + 1, options.tolerance, quantities.count(), quantities.lowest ? 1 : 0,
               quantities.roots},
              std::move(classify)) {}
  int width() const { return frame.x1 - frame.x0 + 1; }
  Frame frame;
  Patch patch;
  lanes::Tile tile;                ///< the cycles known in it
  std::map<int, std::string> why;  ///< of failures
};

/// A part of the plane that becomes one patch.
struct Plot {
  Frame frame;
  std::unique_ptr<Patch> outline = nullptr;  ///< knows the classes of pixels, if the time left is foretold
  int width() const { return frame.x1 - frame.x0 + 1; }
};

class Workshop {
 public:
  Workshop(const Model& model, const MapOptions& options, cycles::CoexistenceSearch& coexistence)
      : model_(model), options_(options), coexistence_(coexistence), quantities_(options) {}

  /// The desk is given the pixels of each patch once it is complete.
  void compute(const std::vector<Plot>& plots, const std::vector<std::size_t>& parts, Desk& desk) {
    std::vector<std::unique_ptr<Piece>> pieces;
    for (const std::size_t part : parts) {
      const Plot& plot = plots[part];
      pieces.push_back(std::make_unique<Piece>(plot.frame, quantities_, options_, [this, &plot](int x, int y) {
        return plot.outline ? plot.outline->class_of(y * plot.width() + x) : classify(plot.frame, x, y);
      }));
    }
    FinishedPoints finished;
    // One patch waits for the last of its pixels while lanes work on the others.
    const auto go_on = [&](std::size_t k) -> std::optional<lanes::CycleBatch> {
      auto& piece = pieces[k];
      end_if_stopped();
      if (auto batch = next_batch(*piece, k)) return batch;
      collect(*piece, finished);
      desk.points(finished);
      piece.reset();
      return std::nullopt;
    };
    std::vector<lanes::CycleBatch> begun;
    for (std::size_t k = 0; k < pieces.size(); ++k)
      if (auto batch = go_on(k)) begun.push_back(std::move(*batch));
    lanes::find_cycles(std::move(begun), options_.stick_threshold, quantities_.names, [&](lanes::CycleBatch& batch) {
      double attempts = 0;
      for (const auto& cycle : batch.cycles) attempts += Forecast::attempts_of(cycle);
      desk.work(parts[batch.label], attempts);
      desk.points(finished);
      for (std::size_t i = 0; i < batch.cycles.size(); ++i) take(*pieces[batch.label], batch, i);
      return go_on(batch.label);
    });
  }

  /// Divides the patch for the sake of its borders alone, and sums up what that will take, in step attempts.
  double outline(Plot& plot, const Forecast& forecast) const {
    const Frame& f = plot.frame;
    const int width = plot.width();
    double expected = Forecast::judging;
    auto& outline = plot.outline;
    outline = std::make_unique<Patch>(Patch::Options{width, f.y1 - f.y0 + 1, options_.tolerance},
                                      [this, f](int x, int y) { return classify(f, x, y); });
    const auto weigh = [&](const std::vector<int>& pixels, double share) {
      for (const int pixel : pixels) {
        outline->set(pixel, outline->class_of(pixel), {{0.0}, {0.0}, {1.0}});
        expected += share * forecast.attempts_at(f.x0 + pixel % width, f.y0 + pixel / width);
      }
    };
    for (auto wanted = outline->advance(); !wanted.empty(); wanted = outline->advance()) {
      weigh(wanted.nodes, 1);
      weigh(wanted.direct, 0.5);  // their tolerance is wider
    }
    return expected;
  }
  double node_tolerance() const { return std::max(node_share * options_.tolerance, finest); }
  const std::vector<std::string>& metrics() const { return quantities_.names; }

 private:
  Model model_at(int ix, int iy) const {
    return model_.with(options_.x.parameter, options_.x.values[ix]).with(options_.y.parameter, options_.y.values[iy]);
  }
  Model model_of(const Piece& piece, int pixel) const {
    return model_at(piece.frame.x0 + pixel % piece.width(), piece.frame.y0 + pixel / piece.width());
  }
  Patch::Class classify(const Frame& frame, int x, int y) const {
    try {
      switch (judge(model_at(frame.x0 + x, frame.y0 + y), coexistence_)) {
        case PointVerdict::stable:
          return settled;
        case PointVerdict::look_for_cycle:
          return unstable;
        case PointVerdict::look_beside_steady:
          return beside_steady;
      }
    } catch (const InputError&) {
    }
    return refused;
  }

  /// What the patch asks for next; nothing once it is complete.
  std::optional<lanes::CycleBatch> next_batch(Piece& piece, std::size_t label) const {
    const auto wanted = piece.patch.advance();
    if (wanted.empty()) return std::nullopt;
    lanes::CycleBatch batch{
        .label = label,
        .tolerance = wanted.direct.empty() ? node_tolerance() : std::max(direct_share * options_.tolerance, finest)};
    const auto ask = [&](int pixel, int phase) {
      const Model here = model_of(piece, pixel);
      if (piece.patch.class_of(pixel) == refused) {
        try {
          (void)judge(here, coexistence_);
        } catch (const InputError& e) {
          set(piece, pixel, here, failed_point(e.what()));
        }
        return;
      }
      batch.models.push_back(here);
      batch.places.push_back({&piece.tile, pixel % piece.width(), pixel / piece.width(), phase});
    };
    for (const int pixel : wanted.nodes) ask(pixel, piece.patch.phase(pixel));
    for (const int pixel : wanted.direct)
      ask(pixel, lanes::phase_of(pixel % piece.width(), pixel / piece.width(), coarsest));
    return batch;
  }

  /// What came of slider i of a batch; by itself where lanes have not found its cycle.
  void take(Piece& piece, const lanes::CycleBatch& batch, std::size_t i) const {
    const Model& model = batch.models[i];
    const lanes::LaneCycle& cycle = batch.cycles[i];
    const int pixel = batch.places[i].row * piece.width() + batch.places[i].column;
    const bool beside = piece.patch.class_of(pixel) == beside_steady;
    auto point = point_of(cycle, beside);
    if (!point) point = compute_point(model, batch.tolerance, options_.stick_threshold, beside, cycle.near);
    if (point->regime == Regime::failed)  // too much was asked
      point = compute_point(model, options_.tolerance, options_.stick_threshold, beside, cycle.near);
    set(piece, pixel, model, *point);
  }

  void set(Piece& piece, int pixel, const Model& model, const MapPoint& point) const {
    piece.patch.set(pixel, int(point.regime), quantities_.of(point, model.drive.speed.level()));
    if (!point.why.empty()) piece.why[pixel] = point.why;
  }

  void collect(Piece& piece, FinishedPoints& finished) const {
    const auto& f = piece.frame;
    const int right = f.own_right ? f.x1 : f.x1 - 1, top = f.own_top ? f.y1 : f.y1 - 1;
    finished.reserve(finished.size() + std::size_t(right - f.x0 + 1) * (top - f.y0 + 1));
    for (int iy = f.y0; iy <= top; ++iy)
      for (int ix = f.x0; ix <= right; ++ix) {
        const int pixel = (iy - f.y0) * piece.width() + (ix - f.x0);
        MapPoint point = stable_point();
        if (piece.patch.origin(pixel) != Patch::Origin::blank) {
          const bool computed = piece.patch.origin(pixel) == Patch::Origin::computed;
          const bool decided = computed && piece.patch.class_of(pixel) == refused;
          point.origin = decided ? Origin::decided : computed ? Origin::computed : Origin::interpolated;
          point.regime = Regime(piece.patch.kind(pixel));
          for (std::size_t q = 0; q < quantities_.metrics.size(); ++q) {
            const cycles::MetricName& metric = *quantities_.metrics[q];
            double& value = point.metrics.*metric.member = piece.patch.value(pixel, int(q));
            // Interpolation may leave, by less than the error, the range of what it stands for.
            if (cycles::is_stick(metric)) value = std::clamp(value, 0.0, 1.0);
            if (cycles::is_loop(metric)) value = std::max(value, 0.0);
            point.error.*metric.member = piece.patch.error(pixel, int(q));
          }
          if (const auto why = piece.why.find(pixel); why != piece.why.end()) point.why = why->second;
          if (!computed && point.regime == Regime::failed) point.why = "as at the points around it";
        }
        finished.emplace_back(std::size_t(iy) * options_.x.values.size() + ix, std::move(point));
      }
  }

  const Model& model_;
  const MapOptions& options_;
  cycles::CoexistenceSearch& coexistence_;
  Quantities quantities_;
};

}  // namespace

bool interpolates(const MapOptions& options) {
  // Nodes come to lie apart by a distance that grows with the fifth root of the tolerance; the planes that broke even
  // had 64 points a side at 1e-3.
  const double even = 64 * std::pow(1e-3 / options.tolerance, 1.0 / 5);
  return !options.exact && options.x.regular > 1 && options.y.regular > 1 &&
         double(options.x.regular) * options.y.regular >= even * even;
}

void compute_adaptively(const Model& model, const MapOptions& options, cycles::CoexistenceSearch& coexistence,
                        const MapHooks& hooks, Map& map) {
  std::vector<Plot> plots;
  for (const auto& f : frames(options.x, options.y)) plots.push_back({.frame = f});
  const Workshop planner(model, options, coexistence);
  std::optional<Forecast> forecast;
  // Borders are foretold, but not how finely the rest is divided: as the order of the polynomials has it, along both
  // axes.
  const int degree = Patch::degree(options.tolerance);
  Expectation expectation;
  expectation.usual = (degree > 4 ? 0.95 : 1.1) * std::pow(1e-3 / options.tolerance, 2.0 / (degree + 1));
  if (hooks.progress) {
    forecast.emplace(model, options, planner.node_tolerance(), planner.metrics(), coexistence);
    expectation.attempts = [&](std::size_t part) { return planner.outline(plots[part], *forecast); };
  }
  compute_parts(partition_of(options, false), expectation, options, hooks, map,
                [&](const std::vector<std::size_t>& parts, Desk& desk) {
                  Workshop(model, options, coexistence).compute(plots, parts, desk);
                });
}

}  // namespace rosin::analysis::planes
