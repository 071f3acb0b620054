/// Scripts of EQcycle: Bolotskaya, E., github.com/EkaterinaBolotskaya/EQcycle_failure_laws, a block with mass on a
/// spring,
///   M D'' = −(K (D − V_0 t) + mu Sn),   per unit area;   u = D − V_0 t.
/// They are MATLAB, their parameters assignments at the top; Python's assignments of the same names are read too.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "app/imports/format.hpp"
#include "app/imports/parameters.hpp"
#include "core/error.hpp"

namespace rosin::app::imports {

namespace {

Script read(const std::string& path, std::string_view text) {
  if (dialect_of(text) == Dialect::python) return read_python(path, text);
  return read_matlab(path, text, [](std::string_view, const std::vector<Value>&, int) { return Value{}; });
}

class Translation {
 public:
  Translation(const std::string& path, std::string_view text)
      : script_(read(path, text)),
        scene_(fmt::format("{}, a spring-slider of EQcycle", path.substr(path.rfind('/') + 1))) {}

  SceneText scene() {
    law();
    const auto mass = find({"M", "m", "mass"}).value_or(Parameter{0, 0, "M"});
    const auto stiffness = need({"K_s", "K", "k"}, "stiffness of the spring, Pa/m");
    scene_.table("oscillator");
    scene_.key("area", "1", {"EQcycle counts per unit area, m^2", 0});
    scene_.key("mass", quantity(mass.value, "kg/m^2"), mass.origin("kg/m^2"));
    scene_.key("stiffness", quantity(stiffness.value, "Pa/m"), stiffness.origin("Pa/m"));
    const auto load = need({"Sn", "S_n", "sigma_n", "sigma"}, "normal stress, Pa");
    scene_.table("drive");
    scene_.key("speed", number(speed_.value), speed_.origin("m/s, of the load point"));
    scene_.key("normal_load", quantity(load.value, "Pa"), load.origin("Pa"));
    run();
    return std::move(scene_);
  }

 private:
  /// The first of several names that the script gives.
  std::optional<Parameter> find(std::initializer_list<std::string_view> names) const {
    for (const auto name : names)
      if (auto found = parameter(script_, script_.variables, name, name)) return found;
    return std::nullopt;
  }
  Parameter need(std::initializer_list<std::string_view> names, std::string_view meaning) const {
    if (auto found = find(names)) return *found;
    throw InputError(fmt::format("{}: {} is not given ({})", script_.path(), *names.begin(), meaning));
  }
  /// One on which nothing depends.
  std::optional<Parameter> known(std::string_view name) const {
    const auto found = script_.variables.slots.find(name);
    const auto* value = found == script_.variables.slots.end() ? nullptr : found->second.value.as<double>();
    return value ? std::optional(Parameter{*value, found->second.line, std::string(name)}) : std::nullopt;
  }
  int line_of(std::initializer_list<std::string_view> names) const {
    for (const auto name : names)
      if (const auto found = script_.variables.slots.find(name); found != script_.variables.slots.end())
        return found->second.line;
    return 0;
  }

  void law() {
    struct Foreign {
      const char *name, *what;
    };
    for (const auto& [name, what] : {Foreign{"D_1", "a cohesive zone"}, Foreign{"D1", "a cohesive zone"},
                                     Foreign{"D_w1", "double slip weakening"}, Foreign{"mu_t", "double slip weakening"},
                                     Foreign{"s_sh", "a cohesive zone"}, Foreign{"s_str", "a cohesive zone"}})
      if (const int line = line_of({name}); line > 0)
        script_.refuse(line,
                       fmt::format("is a parameter of {}, for which rosin has no law of its own; write it as a law "
                                   "from text, docs/formula-laws.md",
                                   what));
    speed_ = need({"V_pl", "V_lp", "vpl", "V_0", "V0"}, "velocity of the load point, m/s");
    rate_and_state_ = line_of({"a"}) > 0 && line_of({"b"}) > 0;
    scene_.table("law");
    if (rate_and_state_) {
      const auto a = need({"a"}, "direct effect"), b = need({"b"}, "evolution effect");
      const auto L = need({"L", "D_c", "Dc"}, "slip that renews the contacts, m");
      const auto mu0 = need({"mu_d_rs", "mu_0", "mu0", "mu_star"}, "friction at V_0");
      const auto V0 = need({"V_0", "V0", "V_star"}, "reference slip rate, m/s");
      scene_.key("type", "\"ageing\"",
                 {"rate-and-state friction with the ageing law; rosin's is regularised by asinh", 0});
      scene_.key("mu0", number(mu0.value), mu0.origin("friction at V_0"));
      scene_.key("a", number(a.value), a.origin("direct effect"));
      scene_.key("b", number(b.value), b.origin("evolution effect"));
      scene_.key("L", number(L.value), L.origin("m"));
      scene_.key("v0", number(V0.value), V0.origin("m/s, reference"));
      for (const char* name : {"mu_s", "mu_d", "mu_i"})
        if (const auto unused = known(name); unused && unused->name != mu0.name)
          scene_.left_out(unused->origin().was, "of the other laws, for scales of pictures");
      return;
    }
    if (line_of({"mu_s"}) == 0 || line_of({"mu_d"}) == 0)
      throw InputError(fmt::format(
          "{}: gives neither a and b (rate-and-state friction) nor mu_s and mu_d (slip weakening)", script_.path()));
    if (const int line = line_of({"mu_i"}); line > 0)
      script_.refuse(line, "is an initial friction below the static one, which slip weakening has not");
    const auto mu_s = need({"mu_s"}, "static friction"), mu_d = need({"mu_d"}, "dynamic friction");
    const auto D_c = need({"D_c", "Dc"}, "slip over which friction falls, m");
    scene_.key("type", "\"slip-distance\"", {"slip weakening that is whole again after each stop", 0});
    scene_.key("mu_s", number(mu_s.value), mu_s.origin("static friction"));
    scene_.key("mu_d", number(mu_d.value), mu_d.origin("dynamic friction"));
    scene_.key("d_c", number(D_c.value), D_c.origin("m"));
    if (const auto least = known("V_ei"))
      scene_.left_out(least->origin("m/s").was, "below it EQcycle takes the block to stick; rosin's stick is exact");
  }

  /// theta of the start: theta_0, or the first of y_in in units of 1/A, as the scripts make it dimensionless.
  std::optional<Parameter> first_state() const {
    if (auto given = find({"theta_0", "theta0", "theta_in"})) return given;
    const auto found = script_.variables.slots.find("y_in");
    const auto A = find({"A"});
    if (found == script_.variables.slots.end() || !A) return std::nullopt;
    const auto* list = found->second.value.as<std::shared_ptr<List>>();
    const auto* first = list && (*list)->values.size() == 3 ? (*list)->values.front().as<double>() : nullptr;
    if (!first)
      script_.refuse(found->second.line, "gives y_in, of which the first, theta, is not understood; add theta_0 = …");
    return Parameter{A->value * *first, found->second.line, "A y_in(1)"};
  }

  void run() {
    scene_.table("run");
    if (const auto end = find({"tf", "t_f", "tmax", "t_end"})) {
      scene_.key("duration", number(end->value), end->origin("s"));
    } else {
      const double duration = 100 * speed_scale();
      scene_.key("duration", number(duration),
                 {"tf is not given: 100 times the slip that friction needs, over V_0", 0});
    }
    const auto speed = find({"V_in", "v_in"}).value_or(speed_);
    auto start = fmt::format("slip_rate = {}", number(speed.value));
    auto was = fmt::format("{} = {} m/s", speed.name, number(speed.value));
    if (const auto u = find({"u_0", "u0"})) {
      start += fmt::format(", displacement = {}", number(-u->value));
      was += fmt::format(", {} = {} m, D - V_0 t, against the slider's displacement", u->name, number(u->value));
    }
    if (!rate_and_state_) {
      start += ", s = 0";
    } else if (const auto theta = first_state()) {
      start += fmt::format(", theta = {}", number(theta->value));
      was += fmt::format(", {} = {} s", theta->name, number(theta->value));
    }
    scene_.key("start", fmt::format("{{ {} }}", start), {was, speed.line});
  }

  double speed_scale() const {
    const auto slip = find({"L", "D_c", "Dc"});
    return slip && speed_.value > 0 ? slip->value / speed_.value : 1;
  }

  Script script_;
  SceneText scene_;
  Parameter speed_;
  bool rate_and_state_ = false;
};

int likeness(std::string_view text) {
  int found = 0;
  for (const char* word : {"K_s", "Sn ", "Sn=", "mu_d_rs", "V_in", "u_0", "spring-slider", "EQcycle"})
    found += text.find(word) != std::string_view::npos ? 1 : 0;
  return found > 1 ? found : 0;
}

SceneText translate(const std::string& path, std::string_view text) { return Translation(path, text).scene(); }

}  // namespace

Format eqcycle_format() { return {"eqcycle", "a spring-slider script of EQcycle in MATLAB", likeness, translate}; }

}  // namespace rosin::app::imports
