/// The Python module `_rosin`: the list of verbs, and one of them performed within Python.
#include <dlfcn.h>
#include <netcdf.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "app/command_line.hpp"
#include "app/report/quantities.hpp"
#include "app/scene/aliases.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/stopping.hpp"
#include "core/console.hpp"
#include "core/error.hpp"

namespace {

namespace py = pybind11;
using namespace rosin;
using namespace rosin::app;
using namespace std::chrono_literals;

/// The streams that are captured, NetCDF and the planner of FFTW are one for the whole process, so that verbs asked of
/// by several threads work one after the other.
std::timed_mutex one_at_a_time;

constexpr auto look = 50ms;  ///< how often signals are looked for: a person sees the work end at once

void raise_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// NetCDF keeps HDF5 silent in the thread that uses it first; in every other HDF5 prints what NetCDF looks for in vain,
/// which is no error. The HDF5 is the one that NetCDF is linked with, whose name differs between its builds.
void silence_hdf5() {
  Dl_info netcdf;
  if (dladdr(reinterpret_cast<void*>(&nc_strerror), &netcdf) == 0) return;
  void* library = dlopen(netcdf.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  if (library == nullptr) return;
  using SetAuto = int (*)(std::int64_t stack, void* print, void* data);
  if (const auto set_auto = reinterpret_cast<SetAuto>(dlsym(library, "H5Eset_auto2"))) set_auto(0, nullptr, nullptr);
  dlclose(library);
}

std::variant<Request, int> parse(std::vector<std::string> words) {
  std::vector<char*> line;
  for (auto& word : words) line.push_back(word.data());
  return parse_command_line(static_cast<int>(line.size()), line.data());
}

/// Performs a verb as the command line `words` asks for it. Python goes on meanwhile; what interrupts it, or what
/// `progress(part of the work)` raises, ends the work in order and then goes on its way.
/// \param text the scene, where it stands in no file
/// \returns the exit status of the command, what it prints, its messages, what is wrong with the input, and the results
/// folder that was asked for
py::tuple perform(std::vector<std::string> words, std::optional<std::string> text, const py::object& progress) {
  std::unique_lock lock(one_at_a_time, std::defer_lock);
  const auto locked = [&] {
    const py::gil_scoped_release released;
    return lock.try_lock_for(look);
  };
  while (!locked()) raise_signals();

  const Capture capture(!progress.is_none());
  const auto answer = [&](int status, const std::string& wrong, const std::filesystem::path& folder = {}) {
    return py::make_tuple(status, py::bytes(capture.output()), py::bytes(capture.messages()), py::bytes(wrong),
                          folder.string());
  };
  auto parsed = parse(std::move(words));
  if (const int* status = std::get_if<int>(&parsed)) return answer(*status, capture.messages());
  auto& request = std::get<Request>(parsed);
  request.text = std::move(text);

  std::stop_source stop;
  verbs::set_limit_passed(0);
  const auto begin = std::chrono::steady_clock::now();
  silence_hdf5();  // here as well, for who reads the files
  auto work = std::async(std::launch::async, [&]() -> int {
    silence_hdf5();
    return verbs::execute_until(stop.get_token(), request);
  });
  const auto finished = [&] {
    const py::gil_scoped_release released;
    return work.wait_for(look) == std::future_status::ready;
  };
  std::optional<py::error_already_set> raised;
  while (!finished()) {
    if (stop.stop_requested()) continue;
    try {
      raise_signals();
      if (!progress.is_none()) progress(capture.work());
    } catch (const py::error_already_set& error) {
      raised = error;
      stop.request_stop();
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    if (request.time_limit && spent.count() > *request.time_limit && stop.request_stop())
      verbs::set_limit_passed(*request.time_limit);
  }
  try {
    const int status = work.get();
    if (raised) throw py::error_already_set(*raised);
    return answer(status, "", request.out.empty() ? "" : verbs::results_folder(request));
  } catch (const InputError& error) {
    return answer(verbs::wrong_input, presentable(error.what()));
  }
}

/// Every verb as the command line has it.
py::list verb_list() {
  const auto described = [](const std::vector<ArgumentUsage>& usages) {
    py::list list;
    for (const auto& usage : usages) {
      py::dict one;
      one["name"] = usage.name, one["value"] = usage.value, one["help"] = usage.help;
      list.append(one);
    }
    return list;
  };
  py::list list;
  for (const auto& usage : verb_usages()) {
    py::dict one;
    one["name"] = usage.name, one["help"] = usage.help;
    one["arguments"] = described(usage.arguments), one["options"] = described(usage.options);
    list.append(one);
  }
  return list;
}

/// The unit of a number of a document, empty where none is known; what the document states goes first.
std::string unit_of(const std::string& name, const std::map<std::string, std::string>& stated) {
  return report::unit_of(name, stated);
}

/// What a path is called by rosin where another program's name is given, such as "drive.speed" for "drive.V".
std::string own_path(const std::string& text, const std::string& path) try {
  auto scene = scene::parse_toml(text, "");
  scene.insert_or_assign("asked", path);
  std::vector<std::string> notes;
  scene::resolve_aliases(scene, notes);
  return scene["asked"].value_or(path);
} catch (const InputError&) {  // which the verb that reads the scene tells
  return path;
}

}  // namespace

PYBIND11_MODULE(_rosin, module) {
  module.doc() = "Verbs of the command rosin, performed within Python; use the package rosin.";
  module.def("perform", &perform, py::arg("words"), py::arg("text") = py::none(), py::arg("progress") = py::none());
  module.def("verbs", &verb_list);
  module.def("unit_of", &unit_of, py::arg("name"), py::arg("stated"));
  module.def("own_path", &own_path, py::arg("text"), py::arg("path"));
}
