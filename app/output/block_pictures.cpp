/// Pictures of an elastic block: steady sliding and the leading mode drawn on the mesh, and forces of a motion.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/motion/run.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"
#include "app/scene/scene.hpp"
#include "oscillators/block.hpp"

namespace rosin::app::output {

using namespace results;

namespace {

using Eigen::VectorXcd, Eigen::VectorXd;
using oscillators::BlockMesh;

/// A table of edges of elements through all their nodes, parted by empty rows: columns as `row` gives them.
template <class Row>
FigureTable edges(const BlockMesh& mesh, std::string file, std::vector<std::string> headers, Row row) {
  FigureTable table{std::move(file), {}};
  for (auto& header : headers) table.columns.push_back({std::move(header), {}});
  const auto add = [&](const std::vector<double>& values) {
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      table.columns[c].values.push_back(values.empty() ? NAN : values[c]);
  };
  const int columns = 2 * mesh.block.elements[0] + 1, rows = 2 * mesh.block.elements[1] + 1;
  for (int j = 0; j < rows; j += 2, add({}))
    for (int i = 0; i < columns; ++i) add(row(j * columns + i));
  for (int i = 0; i < columns; i += 2, add({}))
    for (int j = 0; j < rows; ++j) add(row(j * columns + i));
  return table;
}

/// What makes the largest displacement about the centre a visible part of the height.
double scale_of(const BlockMesh& mesh, const VectorXd& size) {
  constexpr double visible = 0.18;
  const double largest = size.cwiseAbs().maxCoeff();
  return largest > 0 ? visible * mesh.block.height / largest : 0;
}

Axis along(const char* name, const char* unit, Extent shown, double from, double to) {
  return {.name = name, .unit = unit, .shown = shown, .from = from, .to = to};
}

}  // namespace

std::vector<std::string> write_block_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                             const analysis::steady::StructureStability& stability) {
  const BlockMesh& mesh = *scene.block;
  const auto& mode = stability.modes.front();
  const auto n = Eigen::Index(mesh.size());
  const VectorXd q = Eigen::Map<const VectorXd>(stability.coordinates.data(), n);
  const VectorXd bent = q - mesh.rigid(mesh.centre_x.dot(q), mesh.centre_y.dot(q), 0);
  const VectorXcd shape = Eigen::Map<const VectorXcd>(mode.shape.data(), n);
  const double of_bent = scale_of(mesh, bent), of_shape = scale_of(mesh, shape.cwiseAbs());
  auto figure = figure_of(scene, "block", "Steady sliding and the leading mode of an elastic block on its mesh");
  figure.width = 960, figure.columns = 2, figure.height = 205, figure.key = Key::own;
  figure.tables.push_back(
      edges(mesh, "block-mesh.csv",
            {"x (m)", "y (m)", "x of steady sliding (m)", "y of steady sliding (m)", "x of the mode (m)",
             "y of the mode (m)", "x of the mode a quarter later (m)", "y of the mode a quarter later (m)"},
            [&](int k) {
              const double x = mesh.nodes(0, k), y = mesh.nodes(1, k);
              const std::complex<double> across = of_shape * shape[2 * k], up = of_shape * shape[2 * k + 1];
              return std::vector{x,
                                 y,
                                 x + of_bent * bent[2 * k],
                                 y + of_bent * bent[2 * k + 1],
                                 x + across.real(),
                                 y + up.real(),
                                 x - across.imag(),
                                 y - up.imag()};
            }));
  FigureTable face{"block-face.csv",
                   {{"x (m)", {}},
                    {"pressure (Pa)", {}},
                    {"friction (Pa)", {}},
                    {"approach of the mode", {}},
                    {"slip of the mode", {}}}};
  for (std::size_t s = 0; s < mesh.stations.size(); ++s) {
    const auto& station = mesh.stations[s];
    const auto size = [&](const VectorXd& direction) {
      return std::abs((direction.cast<std::complex<double>>().transpose() * shape)(0));
    };
    const double row[] = {station.place, stability.contacts[s].normal_load / station.area,
                          stability.contacts[s].friction_force / station.area, size(station.normal),
                          size(station.tangential)};
    for (std::size_t c = 0; c < std::size(row); ++c) face.columns[c].values.push_back(row[c]);
  }
  const auto pressure = Extent::of(face.columns[1].values);
  figure.tables.push_back(std::move(face));

  // Room for the key above, and as much beside as fills the panel at equal scales.
  const double half = mesh.block.length / 2, height = mesh.block.height;
  constexpr double below = 0.35, above = 1.75, panel = 1.85;  // parts of the height; width over height
  const double tall = std::max((below + above) * height, 2.4 * half / panel);
  const Extent sides{0, std::max(mesh.block.length, mesh.block.height)};
  const auto x = along("x", "m", sides, -panel * tall / 2, panel * tall / 2),
             y = along("y", "m", sides, -below * height, tall - below * height),
             place = along("x", "m", sides, -half, half);
  const auto lines = [](int x, int y, Look look, const char* title) {
    return Line{.table = "block-mesh.csv", .x = {x}, .y = {y}, .look = std::move(look), .title = title};
  };
  const auto face_line = [](int y, int style, const char* title) {
    return Line{.table = "block-face.csv",
                .y = {y},
                .how = How::line_and_points,
                .look = {.style = style, .point = style == 0 ? Point::dot : Point::square},
                .title = title};
  };
  const Look grey{.colour = "#BBBBBB", .width = 1}, blue{.width = 1.5}, brown{.style = 1, .dash = "6,3", .width = 1.2};
  auto part = along("traction", "Pa", pressure, 0, unset),
       size = along("amplitude over the largest", "1", {}, 0, unset);
  part.after = size.after = 0.18;
  const auto hertz = fmt::format("leading mode: {:.4g} Hz, growth {:+.3g} 1/s", mode.frequency(), mode.growth_rate());
  figure.panels = {
      {.x = x,
       .y = y,
       .lines = {lines(1, 2, grey, "at rest"), lines(3, 4, blue, "sliding")},
       .title = fmt::format("steady sliding about the centre, × {:.3g}", of_bent),
       .equal_scales = true},
      {.x = x,
       .y = y,
       .lines = {lines(1, 2, grey, ""), lines(5, 6, blue, "mode"), lines(7, 8, brown, "a quarter period later")},
       .title = hertz,
       .equal_scales = true},
      {.x = place,
       .y = part,
       .lines = {face_line(2, 0, "pressure"), face_line(3, 1, "friction")},
       .title = "lower face in steady sliding"},
      {.x = place,
       .y = size,
       .lines = {face_line(4, 0, "approach"), face_line(5, 1, "slip")},
       .title = "lower face in the leading mode"}};
  return write(folder, figure);
}

std::vector<std::string> write_block_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                             const analysis::motion::Run& run) {
  const BlockMesh& mesh = *scene.block;
  const auto column = [&](const std::string& name) {
    return std::size_t(std::ranges::find(run.column_names, name) - run.column_names.begin());
  };
  auto figure = figure_of(scene, "run", "Forces on a block, what sticks and what is open, and its motion");
  figure.width = 860, figure.height = 140;
  const auto time = along("time", "s", {}, run.time.front(), run.time.back());
  const auto line = [&](const std::string& name, How how, Look look, const char* title) {
    return Line{.table = "run.csv", .y = {int(column(name)) + 2}, .how = how, .look = std::move(look), .title = title};
  };
  const auto extent = [&](const std::string& name) { return Extent::of(run.columns[column(name)]); };
  auto force = extent("normal_load");
  for (const double F : run.columns[column("friction_force")]) force.include(F);
  figure.panels = {{.x = time,
                    .y = {.name = "force", .unit = "N", .shown = force},
                    .lines = {line("normal_load", How::line, {}, "normal"),
                              line("friction_force", How::line, {.style = 1}, "friction")}},
                   {.x = time,
                    .y = {.name = "part of the face", .from = 0, .to = 1},
                    .lines = {line("stick_fraction", How::filled, {.colour = "#9DB4CC"}, "sticks"),
                              line("open_fraction", How::filled, {.colour = "#D9A273"}, "open")}}};
  for (const char* name : {"elongation", "tilt"})
    figure.panels.push_back({.x = time,
                             .y = {.name = name, .unit = run.column_units[column(name)], .shown = extent(name)},
                             .lines = {line(name, How::line, {}, "")}});
  auto files = write(folder, figure);

  // Pressure and slip along the face, over the last part of the run.
  constexpr std::size_t most_moments = 400;
  const std::size_t first = run.time.size() > most_moments ? run.time.size() - most_moments : 0;
  const std::size_t pressure = column("pressure_1"), slip = column("slip_rate_1"), stations = mesh.stations.size();
  FigureTable face{"block-face.csv", {{"time (s)", {}}, {"x (m)", {}}, {"pressure (Pa)", {}}, {"slip_rate (m/s)", {}}}};
  const auto add = [&](double t, double x, double p, double v) {
    face.columns[0].values.push_back(t), face.columns[1].values.push_back(x);
    face.columns[2].values.push_back(p), face.columns[3].values.push_back(v);
  };
  for (std::size_t i = first; i < run.time.size(); ++i, add(NAN, NAN, NAN, NAN))
    for (std::size_t s = 0; s < stations; ++s)
      add(run.time[i], mesh.stations[s].place, run.columns[pressure + s][i], run.columns[slip + s][i]);
  const auto pressures = Extent::of(face.columns[2].values), rates = Extent::of(face.columns[3].values);
  const double left = mesh.stations.front().place, right = mesh.stations.back().place;
  auto plane = figure_of(scene, "block-face", "Pressure and slip rate along the lower face of a block over time");
  plane.width = 860, plane.height = 240;
  const auto panel = [&](int column, ColourScale colours) {
    return Panel{.x = along("time", "s", {}, run.time[first], run.time.back()),
                 .y = along("x", "m", {0, mesh.block.length}, left, right),
                 .lines = {{.table = face.file, .how = How::surface, .z = {column}}},
                 .colours = std::move(colours),
                 .grid = false};
  };
  plane.panels = {panel(3, {along("pressure", "Pa", pressures, 0, unset), Palette::blue}),
                  panel(4, {along("slip rate", "m/s", rates, -rates.largest(), rates.largest()), Palette::signs})};
  plane.tables = {std::move(face)};
  for (auto& file : write(folder, plane)) files.push_back(std::move(file));
  return files;
}

}  // namespace rosin::app::output
