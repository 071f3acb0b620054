/// Spring-sliders of QDYN (Luo, Ampuero, Galvez, van den Ende and Idini 2017, github.com/ydluo/qdyn), all per unit
/// area:
///   dtau/dt = (MU/L) (V_PL − V) + d/dt[APER sin(2 π t/TPER)] − MU/(2 VS) dV/dt,   tau = SIGMA mu(V, theta).
#include "app/imports/qdyn.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "app/imports/format.hpp"
#include "core/error.hpp"

namespace rosin::app::imports {

namespace {

class Translation {
 public:
  Translation(const std::string& path, const QdynParameters& parameters)
      : path_(path),
        parameters_(parameters),
        scene_(fmt::format("{}, a spring-slider of QDYN", path.substr(path.rfind('/') + 1))) {}

  SceneText scene() {
    refuse_what_rosin_has_not();
    law();
    oscillator();
    drive();
    run();
    for (const auto& [name, why] : {std::pair{"ACC", "ask for it by --tolerance"}, std::pair{"FINITE", "of meshes"},
                                    std::pair{"W", "of meshes"}, std::pair{"LAM", "of meshes"}})
      if (const auto* one = find(name); one && one->line > 0) scene_.left_out(one->origin().was, why);
    for (const char* name : {"D", "HD"})
      if (const auto* one = find(name); one && one->value != 0)
        scene_.left_out(one->origin().was, "QDYN takes damage along a mesh alone");
    return std::move(scene_);
  }

 private:
  const Parameter* find(std::string_view name) const {
    const auto found = parameters_.find(name);
    return found == parameters_.end() ? nullptr : &found->second;
  }
  const Parameter& need(std::string_view name) const {
    if (const auto* found = find(name)) return *found;
    throw InputError(fmt::format("{}: {} is not given", path_, name));
  }
  double value(std::string_view name) const { return find(name) ? find(name)->value : 0; }

  [[noreturn]] void refuse(const Parameter& parameter, std::string_view why) const {
    throw InputError(fmt::format("{}{}: {} = {} {}", path_,
                                 parameter.line > 0 ? fmt::format(":{}", parameter.line) : "", parameter.name,
                                 number(parameter.value), why));
  }
  void require_range(const Parameter& parameter, double low, double high, std::string_view unit) const {
    if (!(parameter.value >= low && parameter.value <= high))
      refuse(parameter, fmt::format("is outside {} … {} ({})", number(low), number(high), unit));
  }

  void refuse_what_rosin_has_not() const {
    if (const auto& dimension = need("MESHDIM"); dimension.value != 0)
      refuse(dimension,
             "is a fault on a mesh (0: spring-slider; 1, 2: faults in two and three dimensions), and rosin has "
             "one slider");
    if (const auto* law = find("RNS_LAW")) {
      if (law->value == 1)
        refuse(*law,
               "bounds the direct effect by V1 and the evolution effect by V2, which no law of rosin does (0: "
               "classical, 2: regularised)");
      if (law->value == 3) refuse(*law, "is the microphysical law of Chen, Niemeijer and Spiers, which rosin has not");
      if (law->value != 0 && law->value != 2) refuse(*law, "is none of QDYN's laws (0: classical, 2: regularised)");
    }
    if (const auto* law = find("THETA_LAW")) {
      if (law->value == 0)
        refuse(*law, "never heals: no sliding is steady, and rosin's laws need one (1: ageing law, 2: slip law)");
      if (law->value != 1 && law->value != 2) refuse(*law, "is none of QDYN's laws (1: ageing law, 2: slip law)");
    }
    for (const auto& [name, what] :
         {std::pair{"SIGMA_CPL", "couples the normal stress to slip"},
          std::pair{"FEAT_STRESS_COUPL", "couples the normal stress to slip"},
          std::pair{"FEAT_TP", "is thermal pressurisation"}, std::pair{"FEAT_LOCALISATION", "localises shear"},
          std::pair{"FEAT_RESTART", "goes on from another simulation"}, std::pair{"CO", "is cohesion"},
          std::pair{"FEAT_COHESION", "is cohesion"}, std::pair{"INV_VISC", "is viscous creep beside friction"}})
      if (const auto* feature = find(name); feature && feature->value != 0)
        refuse(*feature, fmt::format("{}, which rosin has not", what));
  }

  void law() {
    scene_.table("law");
    const auto theta = find("THETA_LAW") ? *find("THETA_LAW") : Parameter{1, 0, "THETA_LAW"};
    const auto friction = find("RNS_LAW") ? *find("RNS_LAW") : Parameter{0, 0, "RNS_LAW"};
    scene_.key("type", theta.value == 1 ? "\"ageing\"" : "\"slip\"",
               theta.origin(fmt::format(
                   "RNS_LAW = {}: {} law, {}", number(friction.value), theta.value == 1 ? "ageing" : "slip",
                   friction.value == 2 ? "regularised as rosin's" : "classical; rosin's is regularised by asinh")));
    const auto &a = need("A"), &mu = need("MU_SS");
    for (const auto& [key, name, meaning] :
         {std::tuple{"mu0", "MU_SS", "friction at V_SS"}, std::tuple{"a", "A", "direct effect"},
          std::tuple{"b", "B", "evolution effect"}, std::tuple{"L", "DC", "m, slip that renews the contacts"},
          std::tuple{"v0", "V_SS", "m/s, reference"}})
      scene_.key(key, number(need(name).value), need(name).origin(meaning));
    if (friction.value == 0)
      scene_.left_out(
          friction.origin().was,
          fmt::format("rosin's friction is regularised, which changes it by e^(-2 mu/a) of a, {:.0e} at MU_SS",
                      std::exp(-2 * mu.value / a.value)));
    for (const char* name : {"V1", "V2"})
      if (const auto* one = find(name); one && one->line > 0)
        scene_.left_out(one->origin("m/s").was, "of RNS_LAW = 1 alone");
  }

  void oscillator() {
    const auto &mu = need("MU"), &length = need("L"), &speed = need("VS");
    require_range(mu, 1e-6, 1e20, "Pa, shear modulus");
    require_range(length, 1e-12, 1e20, "m, which scales the stiffness MU/L");
    require_range(speed, 0, 1e12, "m/s, shear wave speed; 0: no radiation damping");
    scene_.table("oscillator");
    scene_.key("area", "1", {"QDYN counts per unit area, m^2", 0});
    scene_.key("mass", "0", {"QDYN is quasi-dynamic", 0});
    scene_.key(
        "stiffness", quantity(mu.value / length.value, "Pa/m"),
        {fmt::format("MU/L = {} Pa/{} m", number(mu.value), number(length.value)), std::max(mu.line, length.line)});
    scene_.key(
        "damping", quantity(speed.value > 0 ? mu.value / (2 * speed.value) : 0, "Pa s/m"),
        {speed.value > 0 ? fmt::format("MU/(2 VS) = {} Pa/(2 {} m/s), radiation", number(mu.value), number(speed.value))
                         : "VS = 0: no radiation damping",
         std::max(mu.line, speed.line)});
  }

  void drive() {
    const auto &load = need("SIGMA"), &speed = need("V_PL");
    scene_.table("drive");
    scene_.key("speed", number(speed.value), speed.origin("m/s"));
    scene_.key("normal_load", quantity(load.value, "Pa"), load.origin("Pa, effective normal stress"));
    const auto *amplitude = find("APER"), *period = find("TPER");
    if (!amplitude || amplitude->value == 0) return;
    const auto& duration = need("TPER");
    require_range(duration, 1e-12, 1e20, "s, period of the shear stress APER");
    // A load that drags is friction's adversary: −APER sin(ω t) along the drive.
    scene_.key("force",
               fmt::format("{{ mean = 0, harmonics = [{{ amplitude = {}, angular_frequency = {}, phase = {} }}] }}",
                           quantity(amplitude->value, "Pa"), number(2 * std::numbers::pi / period->value),
                           number(std::numbers::pi / 2)),
               amplitude->origin(fmt::format("Pa, times sin(2 pi t/TPER), TPER = {} s", number(period->value))));
  }

  void run() {
    const auto& end = need("TMAX");
    const auto stop = find("NSTOP") ? *find("NSTOP") : Parameter{0, 0, "NSTOP"};
    scene_.table("run");
    if (stop.value == 3)
      refuse(stop,
             fmt::format("ends at the slip rate TMAX = {} m/s; rosin runs to a time: give NSTOP = 0 and TMAX in s",
                         number(end.value)));
    if (stop.value != 0) scene_.left_out(stop.origin().was, "the scene runs to TMAX");
    scene_.key("duration", number(end.value), end.origin("s"));
    const auto &V = need("V_0"), &theta = need("TH_0");
    scene_.key("start", fmt::format("{{ slip_rate = {}, theta = {} }}", number(V.value), number(theta.value)),
               {fmt::format("V_0 = {} m/s, TH_0 = {} s{}", number(V.value), number(theta.value),
                            V.line == 0 && theta.line == 0 ? ", defaults" : ""),
                std::max(V.line, theta.line)});
  }

  std::string path_;
  const QdynParameters& parameters_;
  SceneText scene_;
};

int likeness(std::string_view text) {
  if (is_qdyn_input(text)) return 5;
  int found = 0;
  for (const char* word : {"qdyn", "set_dict", "V_PL", "MESHDIM", "RNS_LAW", "TH_SS", "V_SS"})
    found += text.find(word) != std::string_view::npos ? 2 : 0;
  return found;
}

SceneText translate(const std::string& path, std::string_view text) {
  return qdyn_scene(path, is_qdyn_input(text) ? read_qdyn_input(path, text) : read_qdyn_script(path, text));
}

}  // namespace

SceneText qdyn_scene(const std::string& path, const QdynParameters& parameters) {
  return Translation(path, parameters).scene();
}

Format qdyn_format() {
  return {"qdyn", "qdyn.in of QDYN, or a script for its wrapper in Python or MATLAB", likeness, translate};
}

}  // namespace rosin::app::imports
