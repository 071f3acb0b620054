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
/// Names that say something of the slider, each between blanks.
constexpr std::string_view slider_names =
    " "
    "MESHDIM V_PL L SIGMA VS MU TPER APER TMAX NSTOP ACC RNS_LAW THETA_LAW A B DC MU_SS V_SS V_0 TH_0 CO V1 V2 "
    "D HD SIGMA_CPL FEAT_STRESS_COUPL FEAT_TP FEAT_LOCALISATION FEAT_RESTART INV_VISC ";
/// Names that say nothing of it: meshes, output, steps, coupling, and dictionaries of other laws.
constexpr std::string_view other_names =
    " "
    "FINITE FAULT_TYPE SOLVER W LAM DIP_W Z_CORNER FAULT_LABEL N_FAULTS N NX NW DW DTTRY DTMAX V_TH NTOUT "
    "NTOUT_OT NTOUT_OX NTOUT_LOG NXOUT NWOUT OX_SEQ OX_DYN NXOUT_DYN NWOUT_DYN DYN_TH_ON DYN_TH_OFF IC IOT "
    "IASP SUFFIX DYN_FLAG DYN_SKIP DYN_M NPROC MPI_PATH NAME X Y Z DIP NEQS TH_SS RESTART_TIME RESTART_SLIP "
    "SET_DICT_CNS SET_DICT_TP SET_DICT_LOCALISATION VERBOSE DEBUG ";

bool holds(std::string_view names, std::string_view name) {
  return names.find(fmt::format(" {} ", name)) != std::string_view::npos;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// qdyn('set'), qdyn('run', p, 'V_0', 1.01*p.V_SS): the structure with what is changed.
Value matlab_call(std::string_view name, const std::vector<Value>& given, int line) {
  if (name == "struct") {
    auto record = std::make_shared<Record>();
    for (std::size_t i = 0; i + 1 < given.size(); i += 2)
      if (const auto* key = given[i].as<std::string>()) record->slots[*key] = {given[i + 1], line};
    return {record};
  }
  if (name != "qdyn" || given.empty() || !given[0].as<std::string>()) return {Unknown{}};
  auto record = std::make_shared<Record>();
  record->type = "qdyn";
  record->ran = *given[0].as<std::string>() == "run";
  std::size_t first = 1;
  if (given.size() > 1)
    if (const auto before = record_of(given[1])) {
      record->changed = before->changed;
      for (const auto& [key, slot] : before->slots) record->slots[upper(key)] = slot;
      first = 2;
    }
  for (std::size_t i = first; i < given.size(); i += 2) {
    const auto* key = given[i].as<std::string>();
    if (!key) continue;
    record->slots[upper(*key)] = {i + 1 < given.size() ? given[i + 1] : Value{}, line};
  }
  for (const auto& [name, value] : matlab_defaults) record->slots.try_emplace(name, Slot{{value}, 0});
  return {record};
}

/// Puts what a record says of the slider to the parameters. \throws InputError for a name of neither list
void collect(const Script& script, const Record& record, QdynParameters& into) {
  script.refuse(record.changed);
  for (const auto& [key, slot] : record.slots) {
    const auto name = upper(key);
    if (name == "SET_DICT_RSF" || name == "FRICTION_MODEL") continue;
    if (holds(other_names, name)) continue;
    if (!holds(slider_names, name)) {
      std::vector<std::string> known;
      for (std::string_view rest = slider_names; rest.size() > 1; rest.remove_prefix(known.back().size() + 1))
        known.emplace_back(rest.substr(1, rest.find(' ', 1) - 1));
      const auto near = nearest_name(name, known);
      script.refuse(slot.line, fmt::format("names '{}', which is no parameter of QDYN{}", key,
                                           near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
    into[name] = *parameter(script, record, key, name);
  }
}

/// The one qdyn object of a script in Python, which a run would take.
std::shared_ptr<Record> python_object(const Script& script) {
  std::shared_ptr<Record> found;
  for (const auto& [name, slot] : script.variables.slots) {
    const auto record = record_of(slot.value);
    if (!record || record->type != "qdyn") continue;
    script.refuse(record->changed);
    if (found && found != record)
      script.refuse(slot.line, fmt::format("is a second qdyn() beside '{}'; one scene is one model", found->name));
    found = record;
  }
  return found;
}

/// The structure of a script in MATLAB that a run would take: the last that qdyn made, or the one that has most of
/// QDYN's names.
std::shared_ptr<Record> matlab_structure(const Script& script) {
  std::shared_ptr<Record> best, largest;
  int latest = -1;
  long most = 0;
  for (const auto& [name, slot] : script.variables.slots) {
    const auto record = record_of(slot.value);
    if (!record) continue;
    if (record->type == "qdyn" && slot.line > latest) best = record, latest = slot.line;
    const auto count =
        std::ranges::count_if(record->slots, [](const auto& one) { return holds(slider_names, upper(one.first)); });
    if (count > most) largest = record, most = count;
  }
  return best ? best : largest;
}

}  // namespace

QdynParameters read_qdyn_script(const std::string& path, std::string_view text) {
  const auto dialect = dialect_of(text);
  const auto script = dialect == Dialect::matlab ? read_matlab(path, text, matlab_call) : read_python(path, text);
  std::shared_ptr<Record> settings, mesh;
  if (dialect == Dialect::matlab) {
    settings = matlab_structure(script);
  } else if (const auto object = python_object(script)) {
    settings = record_of(object->slots.at("set_dict").value);
    mesh = record_of(object->slots.at("mesh_dict").value);
  }
  if (!settings) throw InputError(fmt::format("{}: makes no qdyn object, and gives it no parameters", path));
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
  if (dialect == Dialect::matlab) {
    for (const auto& [name, value] : matlab_defaults) found.try_emplace(name, Parameter{value, 0, name});
    if (!found.contains("V_PL")) found["V_PL"] = found["V_SS"];
  }
  return found;
}

}  // namespace rosin::app::imports
