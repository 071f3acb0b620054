/// Scenes for `rosin fit` out of tables: columns say the kind of measurement, numbers the start of the search.
#include "app/verbs/fit_starter.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "app/scene/table_file.hpp"
#include "app/scene/toml_text.hpp"
#include "core/error.hpp"

namespace rosin::app::verbs {

namespace {

/// A column of measurements: rosin's name, the unit that tells it, and what instruments call it.
struct Quantity {
  const char *name, *si;
  std::vector<std::string_view> called;
};
const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> list = {
      {"time", "s", {"t", "elapsed", "zeit"}},
      {"frequency", "Hz", {"f", "freq"}},
      {"slip_rate", "m/s", {"v", "velocity", "speed", "slip_velocity", "sliding_velocity", "rate"}},
      {"displacement", "m", {"x", "d", "disp", "position", "slip", "load_point_displacement", "lp_disp", "angle"}},
      {"friction_force", "N", {"f", "ft", "force", "friction", "shear_force", "tangential_force", "torque"}},
      {"normal_load", "N", {"n", "fn", "load", "normal_force", "normal"}},
      {"friction_coefficient", "1", {"mu", "friction", "cof", "coefficient_of_friction", "apparent_friction"}},
      {"hold_time", "s", {"hold", "t_hold", "time_at_rest"}},
      {"real", "N s/m", {"re", "re_z", "real_part"}},
      {"imaginary", "N s/m", {"im", "im_z", "imaginary_part"}}};
  return list;
}

std::string plain(std::string_view name) {
  std::string text;
  for (const char c : name) text += c == ' ' || c == '-' ? '_' : char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool measures(const scene::HeaderCell& cell, const std::string& si) {
  if (cell.unit.empty()) return true;
  const bool turns = cell.unit == "rad" || cell.unit == "rad/s" || cell.unit == "N m";
  if (turns) return cell.unit == (si == "m" ? "rad" : si == "m/s" ? "rad/s" : si == "N" ? "N m" : "");
  try {
    scene::conversion_to_si(cell, {cell.name, "", si});
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// The column of each quantity that the table has: by rosin's name, by another's, then by a unit that no other shares.
std::map<std::string, std::size_t> columns_of(const scene::TableHead& head) {
  std::map<std::string, std::size_t> found;
  std::vector<bool> taken(head.columns.size());
  const auto take = [&](auto fits) {
    for (const auto& quantity : quantities()) {
      if (found.contains(quantity.name)) continue;
      std::vector<std::size_t> fitting;
      for (std::size_t c = 0; c < head.columns.size(); ++c)
        if (!taken[c] && fits(quantity, head.columns[c])) fitting.push_back(c);
      if (fitting.size() == 1) found[quantity.name] = fitting.front(), taken[fitting.front()] = true;
    }
  };
  take([](const Quantity& quantity, const scene::HeaderCell& cell) {
    return plain(cell.name) == quantity.name && measures(cell, quantity.si);
  });
  take([](const Quantity& quantity, const scene::HeaderCell& cell) {
    return std::ranges::find(quantity.called, plain(cell.name)) != quantity.called.end() && measures(cell, quantity.si);
  });
  take([](const Quantity& quantity, const scene::HeaderCell& cell) {
    return !cell.unit.empty() && cell.unit != "1" && measures(cell, quantity.si);
  });
  return found;
}

/// Numbers of columns in SI units, row by row.
std::vector<std::vector<double>> numbers_of(const std::filesystem::path& path,
                                            const std::vector<std::pair<std::size_t, std::string>>& columns) {
  scene::TableFile file(path, {});
  for (const auto& [column, si] : columns) {
    const auto& unit = file.head().columns[column].unit;
    const bool turns = unit.find("rad") != std::string::npos || unit == "N m";  // as if at a radius of 1 m
    file.need({"", turns ? si : "", si, int(column) + 1});
  }
  std::vector<std::vector<double>> numbers(columns.size());
  for (std::vector<double> cells; file.row(cells);)
    for (std::size_t c = 0; c < columns.size(); ++c) numbers[c].push_back(cells[columns[c].first]);
  return numbers;
}

/// Magnitudes: that which 2 % exceed, and that which half of them exceed.
struct Size {
  double largest = 0, median = 0;
};
Size size_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  std::ranges::sort(values, {}, [](double value) { return std::abs(value); });
  return {std::abs(values[values.size() * 98 / 100]), std::abs(values[values.size() / 2])};
}

/// Of a recorded displacement, over stretches long enough that its steps hardly matter.
Size speed_of(const std::vector<double>& time, const std::vector<double>& displacement) {
  const std::size_t stretch = std::max<std::size_t>(1, time.size() / 500);
  std::vector<double> speeds;
  for (std::size_t i = stretch; i < time.size(); ++i)
    speeds.push_back((displacement[i] - displacement[i - stretch]) / (time[i] - time[i - stretch]));
  return size_of(std::move(speeds));
}

double two_digits(double value) { return std::stod(fmt::format("{:.2g}", value)); }

}  // namespace

std::string fit_starter(const std::filesystem::path& path) {
  const scene::TableFile file(path, {});
  const auto& head = file.head();
  const auto found = columns_of(head);
  const auto has = [&](const char* name) { return found.contains(name); };
  const auto size = [&](const char* name, const char* si) {
    return size_of(numbers_of(path, {{found.at(name), si}}).front());
  };
  const bool in_force = !has("friction_coefficient") && has("friction_force"),
             friction = in_force || has("friction_coefficient");
  const char* answer = in_force ? "friction_force" : "friction_coefficient";
  const auto unit_of = [&](const char* name) { return has(name) ? head.columns[found.at(name)].unit : std::string(); };
  const bool turns = unit_of("displacement") == "rad" || unit_of("slip_rate") == "rad/s";

  std::string type;
  std::vector<std::string> used, keys;
  if (has("frequency") && has("real") && has("imaginary")) {
    type = "frequency-response", used = {"frequency", "real", "imaginary"};
    keys = {"standard_error = 1  # N s/m: yours, or the name of a column"};
  } else if (has("time") && (has("slip_rate") || has("displacement")) && friction) {
    type = "record", used = {"time", has("slip_rate") ? "slip_rate" : "displacement", answer};
    if (has("normal_load")) used.push_back("normal_load");
  } else if (has("hold_time") && has("friction_coefficient")) {
    type = "hold", used = {"hold_time", answer};
  } else if (has("slip_rate") && has("friction_coefficient")) {
    type = "steady-curve", used = {"slip_rate", answer};
  } else if (has("time") && has("friction_coefficient")) {
    type = "velocity-step", used = {"time", answer};
    keys = {"from = \"1 um/s\"  # yours", "to = \"10 um/s\"", "step_at = 0"};
  } else {
    std::vector<std::string> names;
    for (const auto& cell : head.columns) names.push_back(cell.text);
    throw InputError(fmt::format(
        "{}: no kind of measurement is told by its columns, {}; a record needs time, slip rate or displacement, and "
        "friction; other kinds stand in docs/fit.md",
        path.string(), fmt::join(names, ", ")));
  }

  Size force{0.4, 0.3}, speed{0.01, 0.005};
  if (friction) force = size(answer, in_force ? "N" : "1");
  double travel = speed.largest;
  if (has("slip_rate")) {
    travel = (speed = size("slip_rate", "m/s")).largest;
  } else if (has("displacement") && has("time")) {
    const auto columns = numbers_of(path, {{found.at("time"), "s"}, {found.at("displacement"), "m"}});
    speed = speed_of(columns[0], columns[1]), travel = size_of(columns[1]).largest;
  }
  // A load that is not recorded is one at which coefficients are of usual size.
  const bool loaded = type == "record" && has("normal_load");
  const double load = loaded                          ? size("normal_load", "N").median
                      : in_force && force.largest > 1 ? std::pow(10, std::ceil(std::log10(force.largest)))
                                                      : 1;
  std::string law, parameters;
  if (in_force || type == "steady-curve" || type == "frequency-response") {
    const bool bristles = type != "steady-curve";
    const double mu_s = two_digits(force.largest / load),
                 mu_d = two_digits(std::min(force.median, 0.9 * force.largest) / load);
    law = fmt::format("type = \"{}\"\nmu_s = {}\nmu_d = {}\nv_s = {}\n", bristles ? "lugre" : "stribeck", mu_s, mu_d,
                      two_digits(0.2 * speed.largest));
    if (bristles)
      law += fmt::format("sigma0 = {}\nsigma1 = {}\nsigma2 = {}\n", two_digits(100 * mu_s / travel),
                         two_digits(mu_s / speed.largest), two_digits(0.1 * mu_d / speed.largest));
    parameters = bristles ? R"("law.mu_s", "law.mu_d", "law.v_s", "law.sigma0", "law.sigma1", "law.sigma2")"
                          : R"("law.mu_s", "law.mu_d", "law.v_s")";
  } else {
    law = fmt::format("type = \"ageing\"\nmu0 = {}\na = 0.01\nb = 0.012\nL = \"10 um\"\nv0 = \"1 um/s\"\n",
                      two_digits(force.median));
    parameters = R"("law.mu0", "law.a", "law.b", "law.L")";
    if (type == "record") {
      law += "contact_stiffness = { per_load = 1000 }  # 1/m, of the machine\n";
      parameters += R"(, "law.contact_stiffness.per_load")";
    }
  }
  std::vector<std::string> columns;
  for (const auto& name : used)
    if (const auto& cell = head.columns[found.at(name)]; cell.name != name)
      columns.push_back(fmt::format("{} = {}", name, scene::toml_text(cell.name)));
  if (!columns.empty()) keys.push_back(fmt::format("columns = {{ {} }}", fmt::join(columns, ", ")));

  std::string scene = fmt::format("# rosin fit SCENE.toml\n# {}: {}\n", path.filename().string(), head.text());
  scene += fmt::format("title = {}\n\n[law]  # where the search starts; other laws: rosin laws\n{}\n[drive]\n",
                       scene::toml_text("Fit of " + path.filename().string()), law);
  scene += fmt::format("speed = {}\nnormal_load = {}  # N{}\n", type == "record" ? "0" : "\"1 um/s\"", two_digits(load),
                       in_force && !loaded ? "; put yours, over which coefficients are meant" : "");
  scene += fmt::format("\n[fit]\nparameters = [{}]\n[[fit.data]]\ntype = \"{}\"\nfile = {}\n", parameters, type,
                       scene::toml_text(path.string()));
  for (const auto& key : keys) scene += key + '\n';
  if (turns) scene += "[oscillator]\nradius = 1  # m; a joint: displacements are angles, forces are moments\n";
  return scene;
}

}  // namespace rosin::app::verbs
