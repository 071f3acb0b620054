/// Scripts for the wrappers of QDYN: dictionaries in Python (pyqdyn.py), fields of a structure in MATLAB (qdyn.m). What
/// a script leaves out has the wrapper's default, which is not the same in the two.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "app/imports/qdyn.hpp"
#include "core/error.hpp"

namespace rosin::app::imports {

namespace {

struct Default {
  const char* name;
  double value;
};
constexpr std::array python_defaults = {
    Default{"MESHDIM", 0}, Default{"V_PL", 1e-9},     Default{"L", 1},    Default{"SIGMA", 50e6}, Default{"VS", 3000},
    Default{"MU", 30e9},   Default{"TPER", 31536000}, Default{"APER", 0}, Default{"TMAX", 1000},  Default{"NSTOP", 0}};
constexpr std::array friction_defaults = {Default{"RNS_LAW", 0}, Default{"THETA_LAW", 1}, Default{"A", 0.0010},
                                          Default{"B", 0.0011},  Default{"DC", 1e-5},     Default{"MU_SS", 0.6},
                                          Default{"V_SS", 1e-6}, Default{"V_0", 1.01e-5}, Default{"TH_0", 1}};
/// Of qdyn.m, whose load point moves at V_SS, and whose V_0 and TH_0 are V_SS and DC/V_SS as they stand before changes.
constexpr std::array matlab_defaults = {Default{"MESHDIM", 1},        Default{"L", 2e3},
                                        Default{"SIGMA", 1e8},        Default{"VS", 3000},
                                        Default{"MU", 30e9},          Default{"TPER", 31536000},
                                        Default{"APER", 0},           Default{"TMAX", 6 * 30 * 86400.0},
                                        Default{"NSTOP", 0},          Default{"RNS_LAW", 0},
                                        Default{"THETA_LAW", 1},      Default{"A", 0.9e-2},
                                        Default{"B", 1e-2},           Default{"DC", 4e-4},
                                        Default{"MU_SS", 0.6},        Default{"V_SS", 1e-9},
                                        Default{"V_0", 1e-9},         Default{"TH_0", 4e-4 / 1e-9},
                                        Default{"TH_SS", 4e-4 / 1e-9}};
/// Names that say something of the slider.
constexpr std::array slider_names = {"MESHDIM",
                                     "V_PL",
                                     "L",
                                     "SIGMA",
                                     "VS",
                                     "MU",
                                     "TPER",
                                     "APER",
                                     "TMAX",
                                     "NSTOP",
                                     "ACC",
                                     "RNS_LAW",
                                     "THETA_LAW",
                                     "A",
                                     "B",
                                     "DC",
                                     "MU_SS",
                                     "V_SS",
                                     "V_0",
                                     "TH_0",
                                     "CO",
                                     "V1",
                                     "V2",
                                     "D",
                                     "HD",
                                     "SIGMA_CPL",
                                     "FEAT_STRESS_COUPL",
                                     "FEAT_TP",
                                     "FEAT_LOCALISATION",
                                     "FEAT_RESTART",
                                     "INV_VISC"};
/// Names that say nothing of it: meshes, output, steps, coupling, and dictionaries of other laws.
constexpr std::array other_names = {"FINITE",
                                    "FAULT_TYPE",
                                    "SOLVER",
                                    "W",
                                    "LAM",
                                    "DIP_W",
                                    "Z_CORNER",
                                    "FAULT_LABEL",
                                    "N_FAULTS",
                                    "N",
                                    "NX",
                                    "NW",
                                    "DW",
                                    "DTTRY",
                                    "DTMAX",
                                    "V_TH",
                                    "NTOUT",
                                    "NTOUT_OT",
                                    "NTOUT_OX",
                                    "NTOUT_LOG",
                                    "NXOUT",
                                    "NWOUT",
                                    "OX_SEQ",
                                    "OX_DYN",
                                    "NXOUT_DYN",
                                    "NWOUT_DYN",
                                    "DYN_TH_ON",
                                    "DYN_TH_OFF",
                                    "IC",
                                    "IOT",
                                    "IASP",
                                    "SUFFIX",
                                    "DYN_FLAG",
                                    "DYN_SKIP",
                                    "DYN_M",
                                    "NPROC",
                                    "MPI_PATH",
                                    "NAME",
                                    "X",
                                    "Y",
                                    "Z",
                                    "DIP",
                                    "NEQS",
                                    "TH_SS",
                                    "RESTART_TIME",
                                    "RESTART_SLIP",
                                    "SET_DICT_CNS",
                                    "SET_DICT_TP",
                                    "SET_DICT_LOCALISATION",
                                    "VERBOSE",
                                    "DEBUG",
                                    "FAULT_TYPE"};

template <class Defaults>
void fill(Record& record, const Defaults& defaults) {
  for (const auto& [name, value] : defaults) record.slots.try_emplace(name, Slot{{value}, 0});
}

std::shared_ptr<Record> python_settings() {
  auto settings = std::make_shared<Record>();
  fill(*settings, python_defaults);
  auto friction = std::make_shared<Record>();
  fill(*friction, friction_defaults);
  settings->slots["SET_DICT_RSF"] = {{friction}, 0};
  for (const char* name : {"SET_DICT_CNS", "SET_DICT_TP", "SET_DICT_LOCALISATION"})
    settings->slots[name] = {{std::make_shared<Record>()}, 0};
  settings->slots["FRICTION_MODEL"] = {{std::string("RSF")}, 0};
  return settings;
}

/// What p.settings(…) does: entries of dictionaries within are joined.
void join(Record& into, const Record& from) {
  for (const auto& [name, slot] : from.slots) {
    const auto inner = record_of(slot.value);
    const auto mine = into.slots.find(name);
    const auto outer = mine == into.slots.end() ? nullptr : record_of(mine->second.value);
    if (inner && outer && inner != outer) {
      for (const auto& [key, one] : inner->slots) outer->slots[key] = one;
      outer->handed_over = std::max(outer->handed_over, inner->handed_over);
    } else if (!outer || inner != outer) {
      into.slots[name] = slot;
    }
  }
  into.handed_over = std::max(into.handed_over, from.handed_over);
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

Value python_call(std::string_view name, const std::vector<Argument>& given, int) {
  if (name == "qdyn" && given.empty()) {
    auto object = std::make_shared<Record>();
    object->type = "qdyn";
    object->slots["set_dict"] = {{python_settings()}, 0};
    object->slots["mesh_dict"] = {{std::make_shared<Record>()}, 0};
    return {object};
  }
  if (name == "settings" && given.size() == 2) {
    const auto object = record_of(given[0].value), added = record_of(given[1].value);
    if (object && object->type == "qdyn") {
      const auto settings = record_of(object->slots["set_dict"].value);
      if (settings && added) {
        if (settings != added) join(*settings, *added);
        return {1.0};
      }
    }
  }
  return {Unknown{}};
}

/// qdyn('set'), qdyn('run', p, 'V_0', 1.01*p.V_SS): the structure with what is changed.
Value matlab_call(std::string_view name, const std::vector<Argument>& given, int line) {
  if (name == "struct") {
    auto record = std::make_shared<Record>();
    for (std::size_t i = 0; i + 1 < given.size(); i += 2)
      if (const auto* key = given[i].value.as<std::string>()) record->slots[*key] = {given[i + 1].value, line};
    return {record};
  }
  if (name != "qdyn" || given.empty() || !given[0].value.as<std::string>()) return {Unknown{}};
  auto record = std::make_shared<Record>();
  record->type = "qdyn";
  std::size_t first = 1;
  if (given.size() > 1)
    if (const auto before = record_of(given[1].value)) {
      for (const auto& [key, slot] : before->slots) record->slots[upper(key)] = slot;
      first = 2;
    }
  for (std::size_t i = first; i < given.size(); i += 2) {
    const auto* key = given[i].value.as<std::string>();
    if (!key) continue;
    record->slots[upper(*key)] = {i + 1 < given.size() ? given[i + 1].value : Value{}, line};
  }
  fill(*record, matlab_defaults);
  return {record};
}

/// Puts what a record says of the slider to the parameters. \throws InputError for a name of neither list
void collect(const Script& script, const Record& record, QdynParameters& into) {
  if (record.handed_over > 0)
    script.refuse(
        record.handed_over,
        "may change the parameters in a way that is not followed, as no script is run; write them as assignments");
  for (const auto& [key, slot] : record.slots) {
    const auto name = upper(key);
    if (name == "SET_DICT_RSF" || name == "FRICTION_MODEL") continue;
    if (std::ranges::find(other_names, std::string_view(name)) != other_names.end()) continue;
    if (std::ranges::find(slider_names, std::string_view(name)) == slider_names.end()) {
      std::vector<std::string> known(slider_names.begin(), slider_names.end());
      const auto near = nearest_name(name, known);
      script.refuse(slot.line, fmt::format("names '{}', which is no parameter of QDYN{}", key,
                                           near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
    into[name] = *parameter(script, record, key, name);
  }
}

/// The dictionary or structure that a run would take: that of the last qdyn object in which something was given, or the
/// variable set_dict, or the one that has most of QDYN's names.
std::shared_ptr<Record> settings_of(const Script& script, Dialect dialect, std::shared_ptr<Record>& mesh) {
  std::shared_ptr<Record> best;
  int latest = -1;
  const auto given = [](const Record& record) {
    bool any = std::ranges::any_of(record.slots, [](const auto& one) { return one.second.line > 0; });
    if (const auto inner = record.slots.find("SET_DICT_RSF"); inner != record.slots.end())
      if (const auto friction = record_of(inner->second.value))
        any = any || std::ranges::any_of(friction->slots, [](const auto& one) { return one.second.line > 0; });
    return any;
  };
  for (const auto& [name, slot] : script.variables().slots) {
    const auto record = record_of(slot.value);
    if (!record || record->type != "qdyn" || slot.line <= latest) continue;
    if (dialect == Dialect::matlab) {
      best = record, latest = slot.line;
      continue;
    }
    const auto settings = record->slots.find("set_dict");
    const auto dictionary = settings == record->slots.end() ? nullptr : record_of(settings->second.value);
    if (!dictionary || !given(*dictionary)) continue;
    best = dictionary, latest = slot.line;
    if (const auto found = record->slots.find("mesh_dict"); found != record->slots.end())
      mesh = record_of(found->second.value);
  }
  if (best) return best;
  std::size_t most = 0;
  for (const auto& [name, slot] : script.variables().slots) {
    const auto record = record_of(slot.value);
    if (!record || !given(*record)) continue;
    std::size_t count = name == "set_dict" ? 1000 : 0;
    for (const auto& [key, one] : record->slots)
      count += std::ranges::find(slider_names, std::string_view(upper(key))) != slider_names.end() ? 1 : 0;
    if (count > most) best = record, most = count;
  }
  return best;
}

}  // namespace

QdynParameters read_qdyn_script(const std::string& path, std::string_view text) {
  const auto dialect = dialect_of(text);
  Record known;
  if (dialect == Dialect::python) known.slots["set_dict"] = {{python_settings()}, 0};
  const Script script(path, text, dialect, dialect == Dialect::matlab ? matlab_call : python_call, std::move(known));
  std::shared_ptr<Record> mesh;
  const auto settings = settings_of(script, dialect, mesh);
  if (!settings) throw InputError(fmt::format("{}: gives no parameter of QDYN, such as V_PL or SIGMA", path));
  QdynParameters found;
  collect(script, *settings, found);
  if (const auto model = settings->slots.find("FRICTION_MODEL"); model != settings->slots.end()) {
    const auto* word = model->second.value.as<std::string>();
    if (!word || *word != "RSF")
      script.refuse(model->second.line, word && *word == "CNS"
                                            ? "asks for the law of Chen, Niemeijer and Spiers, which rosin has not"
                                            : "has to be \"RSF\"");
  }
  if (const auto inner = settings->slots.find("SET_DICT_RSF"); inner != settings->slots.end()) {
    const auto friction = record_of(inner->second.value);
    if (!friction) script.refuse(inner->second.line, "has to be a dictionary of friction's parameters");
    collect(script, *friction, found);
  }
  if (mesh) collect(script, *mesh, found);
  const auto fill_in = [&](const auto& defaults) {
    for (const auto& [name, value] : defaults) found.try_emplace(name, Parameter{value, 0, name});
  };
  if (dialect == Dialect::matlab) {
    fill_in(matlab_defaults);
    if (!found.contains("V_PL")) found["V_PL"] = found["V_SS"];
  } else {
    fill_in(python_defaults);
    fill_in(friction_defaults);
  }
  return found;
}

}  // namespace rosin::app::imports
