/// An elastic block through the last oscillation of a run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/motion/last_oscillation.hpp"
#include "analysis/motion/run.hpp"
#include "app/output/animation.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/scene/scene.hpp"
#include "oscillators/block.hpp"

namespace rosin::app::output {

namespace {
constexpr double visible = 0.3;  // part of the height that the largest displacement is drawn as

/// From the wall to the face.
std::vector<Place> spring(double wall, double face, double height, double size) {
  constexpr int turns = 6;
  std::vector<Place> line{{wall, height}};
  const double straight = 0.15 * (face - wall), coil = (face - wall - 2 * straight) / turns;
  line.push_back({wall + straight, height});
  for (int i = 0; i < turns; ++i)
    line.push_back({wall + straight + (i + 0.5) * coil, height + (i % 2 == 0 ? size : -size)});
  line.push_back({face - straight, height});
  line.push_back({face, height});
  return line;
}
}  // namespace

std::vector<std::string> write_block_motion(const std::filesystem::path& folder, const scene::Scene& scene,
                                            const analysis::motion::Frames& oscillation) {
  const auto& mesh = *scene.block;
  const auto [nx, ny] = mesh.block.elements;
  const int columns = 2 * nx + 1, rows = 2 * ny + 1;
  const auto frames = oscillation.evenly(frames_for(std::size_t((ny + 1) * columns + (nx + 1) * rows)));
  // About the mean place along the belt: a spring gives way by far more than the block is deformed.
  double mean = 0, largest = 0, deepest = 0;
  for (const auto& q : frames.coordinates) mean += mesh.centre_x.dot(q) / double(frames.size());
  for (const auto& q : frames.coordinates) {
    for (Eigen::Index k = 0; k < q.size(); ++k) largest = std::max(largest, std::abs(q[k] - (k % 2 == 0 ? mean : 0)));
    for (const auto& station : mesh.stations) deepest = std::max(deepest, station.normal.dot(q));
  }
  const double scale = largest > 0 ? visible * mesh.block.height / largest : 1;
  const auto place = [&](const Eigen::VectorXd& q, int node) -> Place {
    return {mesh.nodes(0, node) + scale * (q[2 * node] - mean), mesh.nodes(1, node) + scale * q[2 * node + 1]};
  };

  const double half = mesh.block.length / 2, height = mesh.block.height, wall = -1.5 * half;
  const double V = scene.model.drive.speed.level();
  Animation animation{.title = scene.title,
                      .left = wall,
                      .right = 1.25 * half,
                      .low = -scale * deepest - 0.2 * height,
                      .high = (1 + 1.2 * visible) * height,
                      .begin = frames.time.front(),
                      .period = frames.duration(),
                      .rough = scale * deepest,
                      .belt = scale * V * frames.duration(),
                      .curve_unit = "N"};
  Animation::Lines edges{body_style, {}}, held{spring_style, {}};
  for (const auto& q : frames.coordinates) {
    auto& lines = edges.frames.emplace_back();
    for (int j = 0; j < rows; j += 2)
      for (int i = 0; i < columns; ++i) {
        if (i == 0) lines.emplace_back();
        lines.back().push_back(place(q, j * columns + i));
      }
    for (int i = 0; i < columns; i += 2)
      for (int j = 0; j < rows; ++j) {
        if (j == 0) lines.emplace_back();
        lines.back().push_back(place(q, j * columns + i));
      }
    const auto [face, at] = place(q, ny * columns);  // in the middle
    held.frames.push_back({spring(wall, face, at, 0.05 * height)});
  }
  const std::vector<std::vector<Place>> frame{{{wall, 0.1 * height}, {wall, 0.75 * height}}};
  animation.lines = {std::move(held), std::move(edges), {spring_style, {frame, frame}}};
  for (std::size_t s = 0; s < mesh.stations.size(); ++s) {
    const auto& station = mesh.stations[s];
    auto& drawn = animation.stations.emplace_back();
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const auto& q = frames.coordinates[f];
      drawn.place.push_back(
          {station.place + scale * (station.tangential.dot(q) - mean), -scale * station.normal.dot(q)});
      drawn.touch.push_back(frames.touch[f][s]);
    }
  }
  animation.curves = {{"normal load", "fill:none;stroke:#00336f;stroke-width:1.8", frames.load},
                      {"friction", "fill:none;stroke:#b0560f;stroke-width:1.8;stroke-dasharray:7 3", frames.friction}};
  const auto time = scaled("s", animation.begin + animation.period), length = scaled("m", largest);
  animation.caption = {
      fmt::format(
          "One oscillation of {:.4g} {}, from {:.6g} to {:.6g} {} of the run, in 6 s. The belt moves at {:.4g} m/s.",
          animation.period * time.factor, time.unit, animation.begin * time.factor,
          (animation.begin + animation.period) * time.factor, time.unit, V),
      fmt::format("Displacements × {:.3g}, the largest {:.3g} {}; along the belt about their mean of {:.4g} m.", scale,
                  largest * length.factor, length.unit, mean)};
  write_whole(folder / "motion.svg", svg(animation));
  return {"motion.svg"};
}

}  // namespace rosin::app::output
