/// Pictures of an elastic block: steady sliding and the leading mode drawn on the mesh, and forces of a motion.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/motion/run.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "app/output/caption.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "oscillators/block.hpp"

namespace rosin::app::output {

namespace {

using Eigen::VectorXcd, Eigen::VectorXd;
using oscillators::BlockMesh;

/// Edges of elements through all their nodes, a block of rows each: columns of places as the functions give them.
template <class Row>
std::string edges(const BlockMesh& mesh, Row row) {
  const int columns = 2 * mesh.block.elements[0] + 1, rows = 2 * mesh.block.elements[1] + 1;
  std::string text;
  for (int j = 0; j < rows; j += 2, text += '\n')
    for (int i = 0; i < columns; ++i) text += row(j * columns + i);
  for (int i = 0; i < columns; i += 2, text += '\n')
    for (int j = 0; j < rows; ++j) text += row(j * columns + i);
  return text;
}

/// What makes the largest displacement about the centre a visible part of the height.
double scale_of(const BlockMesh& mesh, const VectorXd& size) {
  constexpr double visible = 0.18;
  const double largest = size.cwiseAbs().maxCoeff();
  return largest > 0 ? visible * mesh.block.height / largest : 0;
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
  std::string data =
      "x (m),y (m),x of steady sliding (m),y of steady sliding (m),x of the mode (m),y of the mode (m),"
      "x of the mode a quarter later (m),y of the mode a quarter later (m)\n";
  data += edges(mesh, [&](int k) {
    const double x = mesh.nodes(0, k), y = mesh.nodes(1, k);
    const auto later = std::complex<double>(0, 1);
    return fmt::format("{},{},{},{},{},{},{},{}\n", x, y, x + of_bent * bent[2 * k], y + of_bent * bent[2 * k + 1],
                       x + of_shape * shape[2 * k].real(), y + of_shape * shape[2 * k + 1].real(),
                       x + of_shape * (later * shape[2 * k]).real(), y + of_shape * (later * shape[2 * k + 1]).real());
  });
  write_whole(folder / "block-mesh.csv", data);

  std::vector<double> place, pressure, friction, approach, slip;
  for (std::size_t s = 0; s < mesh.stations.size(); ++s) {
    const auto& station = mesh.stations[s];
    place.push_back(station.place);
    pressure.push_back(stability.contacts[s].normal_load / station.area);
    friction.push_back(stability.contacts[s].friction_force / station.area);
    approach.push_back(std::abs((station.normal.cast<std::complex<double>>().transpose() * shape)(0)));
    slip.push_back(std::abs((station.tangential.cast<std::complex<double>>().transpose() * shape)(0)));
  }
  write_csv(folder / "block-face.csv", {{"x (m)", place},
                                        {"pressure (Pa)", pressure},
                                        {"friction (Pa)", friction},
                                        {"approach of the mode", approach},
                                        {"slip of the mode", slip}});
  const auto metres = scaled("m", std::max(mesh.block.length, mesh.block.height));
  const auto pascal = scaled("Pa", *std::ranges::max_element(pressure));
  const auto hertz = scaled("Hz", mode.frequency());
  const Sheet sheet{"block",
                    "Steady sliding and the leading mode of an elastic block on its mesh",
                    {.width = 960,
                     .panels = 4,
                     .columns = 2,
                     .panel = 205,
                     .above = 32,
                     .between_rows = 100,
                     .key = Layout::Key::own},
                    scene.title,
                    caption(scene)};
  std::string script = fmt::format("X = {}\nset grid\n", metres.factor);
  // Room for the key above, and as much beside as fills the panel at equal scales.
  const double half = mesh.block.length / 2 * metres.factor, height = mesh.block.height * metres.factor;
  constexpr double below = 0.35, above = 1.75, panel = 1.85;  // parts of the height; width over height
  const double tall = std::max((below + above) * height, 2.4 * half / panel);
  const auto limits =
      fmt::format("set xrange [{0}:{1}]\nset yrange [{2}:{3}]\nset xlabel 'x ({4})'\nset ylabel 'y ({4})'\n",
                  -panel * tall / 2, panel * tall / 2, -below * height, tall - below * height, metres.unit);
  const auto lines = [](int x, int y, const char* style, const char* title) {
    return fmt::format("'block-mesh.csv' using (${}*X):(${}*X) skip 1 with lines {} {}", x, y, style,
                       *title ? fmt::format("title '{}'", title) : "notitle");
  };
  const char *grey = "linecolor '#BBBBBB' linewidth 1", *blue = "linecolor '#00336F' linewidth 1.5",
             *brown = "linecolor '#B0560F' linewidth 1.2 dashtype (6,3)";
  script += "set key top right horizontal\nset size ratio -1\n" + limits;
  script += fmt::format("set title 'steady sliding about the centre, × {:.3g}'\nplot {}, \\\n     {}\n", of_bent,
                        lines(1, 2, grey, "at rest"), lines(3, 4, blue, "sliding"));
  script += fmt::format("set title 'leading mode: {:.4g} {}, growth {:+.3g} 1/s'\nplot {}, \\\n     {}, \\\n     {}\n",
                        mode.frequency() * hertz.factor, hertz.unit, mode.growth_rate(), lines(1, 2, grey, ""),
                        lines(5, 6, blue, "mode"), lines(7, 8, brown, "a quarter period later"));
  script +=
      "set size noratio\nset title 'lower face in steady sliding'\nset yrange [0:*]\nset offsets 0,0,graph 0.18,0\n";
  script += fmt::format("set xrange [{}:{}]\n", -half, half);
  script += fmt::format(
      "P = {}\nset ylabel 'traction ({})'\n"
      "plot 'block-face.csv' using ($1*X):($2*P) with linespoints linestyle 1 pointtype 7 pointsize 0.5 title "
      "'pressure', \\\n     'block-face.csv' using ($1*X):($3*P) with linespoints linestyle 2 pointtype 5 pointsize "
      "0.5 title 'friction'\n",
      pascal.factor, pascal.unit);
  script +=
      "set title 'lower face in the leading mode'\nset ylabel 'amplitude over the largest'\n"
      "plot 'block-face.csv' using ($1*X):4 with linespoints linestyle 1 pointtype 7 pointsize 0.5 title 'approach', "
      "\\\n     'block-face.csv' using ($1*X):5 with linespoints linestyle 2 pointtype 5 pointsize 0.5 title 'slip'\n";
  write_whole(folder / "block.gp", sheet.with(std::move(script)));
  return {"block-mesh.csv", "block-face.csv", "block.gp"};
}

std::vector<std::string> write_block_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                             const analysis::motion::Run& run) {
  const BlockMesh& mesh = *scene.block;
  const auto column = [&](const std::string& name) {
    return std::size_t(std::ranges::find(run.column_names, name) - run.column_names.begin());
  };
  // Pressure and slip along the face, over the last part of the run.
  std::string face = "time (s),x (m),pressure (Pa),slip_rate (m/s)\n";
  constexpr std::size_t most_moments = 400;
  const std::size_t first = run.time.size() > most_moments ? run.time.size() - most_moments : 0;
  const std::size_t pressure = column("pressure_1"), slip = column("slip_rate_1"), stations = mesh.stations.size();
  double largest_pressure = 0, fastest = 0;
  for (std::size_t i = first; i < run.time.size(); ++i, face += '\n')
    for (std::size_t s = 0; s < stations; ++s) {
      face += fmt::format("{},{},{},{}\n", run.time[i], mesh.stations[s].place, run.columns[pressure + s][i],
                          run.columns[slip + s][i]);
      largest_pressure = std::max(largest_pressure, run.columns[pressure + s][i]);
      fastest = std::max(fastest, std::abs(run.columns[slip + s][i]));
    }
  write_whole(folder / "block-face.csv", face);
  const auto metres = scaled("m", mesh.block.length),
             newton = scaled("N", run.metrics.contains("normal_load_max") ? run.metrics.at("normal_load_max")
                                                                          : scene.model.drive.normal_load.level());
  const auto pascal = scaled("Pa", largest_pressure), speed = scaled("m/s", fastest);

  const Sheet sheet{"run",
                    "Forces on a block, what sticks and what is open, and its motion",
                    {.width = 860, .panels = 4, .panel = 140, .key = Layout::Key::own},
                    scene.title,
                    caption(scene)};
  std::string script = "set grid x\nset key top right horizontal\nset format x ''\n";
  script += "set offsets 0,0,graph 0.35,graph 0.04\n";
  script += fmt::format("set xrange [{}:{}]\n", run.time.front(), run.time.back());
  const auto curve = [&](const std::string& name, double factor, int style, const char* title) {
    return fmt::format("'run.csv' using 1:(${}*{}) with lines linestyle {} {}", column(name) + 2, factor, style,
                       *title ? fmt::format("title '{}'", title) : "notitle");
  };
  script += fmt::format("set ylabel 'force ({})'\nplot {}, \\\n     {}\n", newton.unit,
                        curve("normal_load", newton.factor, 1, "normal"),
                        curve("friction_force", newton.factor, 2, "friction"));
  script += fmt::format(
      "set ylabel 'part of the face'\nset yrange [0:1.35]\nset ytics 0,0.5,1\n"
      "plot 'run.csv' using 1:{} with filledcurves y1=0 linecolor '#9DB4CC' title 'sticks', \\\n"
      "     'run.csv' using 1:{} with filledcurves y1=0 linecolor '#D9A273' title 'open'\nset autoscale y\n",
      column("stick_fraction") + 2, column("open_fraction") + 2);
  const auto panel = [&](const std::string& name, const char* title) {
    const auto& values = run.columns[column(name)];
    const auto [low, high] = std::ranges::minmax(values);
    const auto drawn = drawn_range(title, run.column_units[column(name)], low, high);
    script += fmt::format("set ylabel {}\nset ytics {:g}\nplot 'run.csv' using 1:{} with lines linestyle 1 notitle\n",
                          drawn.label, 2 * tick_step(drawn.low, drawn.high), drawn.column(int(column(name)) + 2));
  };
  script += "set offsets 0,0,graph 0.05,graph 0.05\n";
  panel("elongation", "elongation");
  script += "set format x '%g'\nset xlabel 'time (s)'\n";
  panel("tilt", "tilt");
  write_whole(folder / "run.gp", sheet.with(std::move(script)));

  const Sheet plane{"block-face",
                    "Pressure and slip rate along the lower face of a block over time",
                    {.width = 860, .panels = 2, .panel = 240, .right = 125, .below = 62},
                    scene.title,
                    caption(scene)};
  std::string map = fmt::format("X = {}\nset pm3d map corners2color c1\nset ylabel 'x ({})'\nset format x ''\n",
                                metres.factor, metres.unit);
  map += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", run.time[first], run.time.back(),
                     mesh.stations.front().place * metres.factor, mesh.stations.back().place * metres.factor);
  map += fmt::format(
      "set palette defined (0 '#FFFFFF', 0.001 '#EAF1F7', 1 '#00336F')\nset cbrange [0:*]\nset cblabel 'pressure "
      "({})'\n"
      "splot 'block-face.csv' using 1:($2*X):($3*{}) skip 1 notitle\n",
      pascal.unit, pascal.factor);
  map += fmt::format(
      "set format x '%g'\nset xlabel 'time (s)'\n"
      "set palette defined (-1 '#B0560F', 0 '#FFFFFF', 1 '#3A8F5C')\nset cbrange [{}:{}]\nset cblabel 'slip rate "
      "({})'\n"
      "splot 'block-face.csv' using 1:($2*X):($4*{}) skip 1 notitle\n",
      -fastest * speed.factor, fastest * speed.factor, speed.unit, speed.factor);
  write_whole(folder / "block-face.gp", plane.with(std::move(map)));
  return {"run.gp", "block-face.csv", "block-face.gp"};
}

}  // namespace rosin::app::output
