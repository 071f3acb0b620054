/// Includes point one way: core → laws → oscillators → analysis → bench → app and core → solvers → analysis, and from
/// room to room within solvers/ and analysis/; a folder is a namespace; and no folder but laws/ knows a particular law.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path root = ROSIN_SOURCE_DIR;

/// The folders that each folder may include from.
const std::map<std::string, std::set<std::string>> allowed = {
    {"core", {"core"}},
    {"laws", {"core", "laws"}},
    {"solvers", {"core", "solvers"}},
    {"oscillators", {"core", "laws", "oscillators"}},
    {"analysis", {"core", "laws", "solvers", "oscillators", "analysis"}},
    {"bench", {"core", "laws", "solvers", "oscillators", "analysis", "bench"}},
    {"app", {"core", "laws", "solvers", "oscillators", "analysis", "bench", "app"}},
};

/// The folders of solvers/ and analysis/, and the rooms before it that each may include from.
struct Room {
  std::string folder;
  std::vector<std::string> stands_on;
};
const std::vector<Room> rooms = {
    {"solvers/steps", {}},
    {"solvers/stick_slip", {"solvers/steps"}},
    {"solvers/lanes", {}},
    {"solvers/force_algorithms", {"solvers/stick_slip"}},
    {"analysis/steady", {}},
    {"analysis/motion", {"analysis/steady"}},
    {"analysis/cycles", {"analysis/motion", "analysis/steady"}},
    {"analysis/branches", {"analysis/cycles", "analysis/motion", "analysis/steady"}},
    {"analysis/basins", {"analysis/cycles", "analysis/motion", "analysis/steady"}},
    {"analysis/lanes", {"analysis/cycles", "analysis/motion", "analysis/steady"}},
    {"analysis/planes", {"analysis/lanes", "analysis/cycles", "analysis/motion", "analysis/steady"}},
    {"analysis/response", {"analysis/motion", "analysis/steady"}},
    {"analysis/strings", {"analysis/response", "analysis/cycles", "analysis/motion", "analysis/steady"}},
    {"analysis/lab",
     {"analysis/strings", "analysis/response", "analysis/cycles", "analysis/motion", "analysis/steady"}},
    {"analysis/inference",
     {"analysis/lab", "analysis/planes", "analysis/response", "analysis/cycles", "analysis/motion", "analysis/steady"}},
    {"analysis/studies", {"analysis/lanes", "analysis/cycles", "analysis/motion", "analysis/steady"}},
};

struct Include {
  fs::path from;     ///< relative to the root
  std::string what;  ///< "laws/law.hpp"
};

/// The sources of a folder and of those in it, relative to the root.
std::vector<fs::path> sources_of(const std::string& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const auto ending = entry.path().extension();
    if (ending == ".hpp" || ending == ".cpp") found.push_back(fs::relative(entry.path(), root));
  }
  return found;
}

/// Every #include "…" of a folder's sources.
std::vector<Include> includes_of(const std::string& folder) {
  std::vector<Include> found;
  for (const auto& source : sources_of(folder)) {
    std::ifstream file(root / source);
    for (std::string line; std::getline(file, line);) {
      const auto hash = line.find_first_not_of(" \t");
      if (hash == std::string::npos || line[hash] != '#' || line.find("include", hash) == std::string::npos) continue;
      const auto open = line.find('"'), close = line.rfind('"');
      if (open != close) found.push_back({source, line.substr(open + 1, close - open - 1)});
    }
  }
  return found;
}

std::string first_part(const std::string& path) { return path.substr(0, path.find('/')); }

/// "analysis/cycles" of "analysis/cycles/cycle.hpp".
std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/')); }

bool has_rooms(const std::string& folder) { return folder == "solvers" || folder == "analysis"; }

/// The name by which users include a room: "analysis/cycles/cycles.hpp".
std::string door_of(const std::string& room) { return room + room.substr(room.find('/')) + ".hpp"; }

/// The namespace of a folder; all that core/ holds is rosin's own.
std::string namespace_of(const std::string& folder) {
  if (folder == "core") return "rosin";
  std::string name = "rosin::" + folder;
  for (std::size_t at; (at = name.find('/')) != std::string::npos;) name.replace(at, 1, "::");
  return name;
}

/// The namespaces of rosin's that a source opens: its own, and others that it declares a name of.
std::set<std::string> namespaces_of(const fs::path& source) {
  std::set<std::string> found;
  std::ifstream file(root / source);
  const std::string begin = "namespace ";
  for (std::string line; std::getline(file, line);)
    if (line.rfind(begin + "rosin", 0) == 0)
      found.insert(line.substr(begin.size(), line.find_first_of(" {", begin.size()) - begin.size()));
  return found;
}

}  // namespace

TEST_CASE("includes point from app towards core, never back") {
  for (const auto& [folder, reachable] : allowed) {
    const auto includes = includes_of(folder);
    CHECK(!includes.empty());
    for (const auto& [from, what] : includes) {
      INFO(from.string() << " includes " << what);
      CHECK(fs::exists(root / what));  // from the root: the folder of each file stands in the line
      CHECK(reachable.count(first_part(what)) == 1);
    }
  }
}

TEST_CASE("rooms include from the rooms that they stand on, and nothing lies beside the rooms") {
  std::map<std::string, std::set<std::string>> reachable;
  for (const auto& [room, stands_on] : rooms) {
    INFO(room);
    for (const auto& other : stands_on) CHECK(reachable.count(other) == 1);  // listed before: no circles
    reachable[room] = {stands_on.begin(), stands_on.end()};
    reachable[room].insert(room);
  }
  for (const std::string folder : {"solvers", "analysis"}) {
    for (const auto& [from, what] : includes_of(folder)) {
      INFO(from.string() << " includes " << what);
      const auto room = folder_of(from.string());
      REQUIRE(reachable.count(room) == 1);
      if (first_part(what) == folder) CHECK(reachable[room].count(folder_of(what)) == 1);
    }
  }
}

TEST_CASE("a folder is a namespace") {
  int named = 0;
  for (const auto& [folder, reachable] : allowed) {
    for (const auto& source : sources_of(folder)) {
      if (folder == "laws" && (source.stem() == "law" || source.filename() == "normal_law.hpp"))
        continue;  // FrictionLaw and NormalLaw are words of all rooms
      const auto opened = namespaces_of(source);
      if (opened.empty()) continue;  // a main(), a door, one line that makes a law
      INFO(source.string());
      CHECK(opened.count(namespace_of(folder_of(source.string()))) == 1);
      ++named;
    }
  }
  CHECK(named > 200);
}

TEST_CASE("each room has a door, through which users see all that the command and its benches use of it") {
  std::map<std::string, std::set<std::string>> behind;
  for (const auto& [room, stands_on] : rooms) {
    INFO(door_of(room));
    CHECK(fs::exists(root / door_of(room)));
    behind[room].insert(door_of(room));
  }
  for (const std::string folder : {"solvers", "analysis"})
    for (const auto& [from, what] : includes_of(folder))
      if (from == door_of(folder_of(from.string()))) behind[folder_of(from.string())].insert(what);
  for (const std::string folder : {"app", "bench"}) {
    for (const auto& [from, what] : includes_of(folder)) {
      if (!has_rooms(first_part(what))) continue;
      INFO(from.string() << " includes " << what << ", which " << door_of(folder_of(what)) << " does not show");
      CHECK(behind[folder_of(what)].count(what) == 1);
    }
  }
}

TEST_CASE("outside laws/ a friction law has no name") {
  for (const auto& [folder, reachable] : allowed) {
    if (folder == "laws") continue;
    for (const auto& [from, what] : includes_of(folder)) {
      if (first_part(what) != "laws") continue;
      INFO(from.string() << " includes " << what);
      CHECK((what == "laws/law.hpp" || what == "laws/normal_law.hpp" || what == "laws/frictionless.hpp" ||
             what == "laws/heat_flow.hpp" || what == "laws/regions.hpp" || what == "laws/plane_form.hpp" ||
             what == "laws/one_coefficient.hpp" || what == "laws/wrappers.hpp" || what == "laws/expression.hpp" ||
             what == "laws/tape.hpp" ||  // formulas
             ((folder == "app" || folder == "bench") && what == "laws/catalogue.hpp") ||
             (folder == "app" &&
              (what == "laws/formula.hpp" || what == "laws/heating.hpp" || what == "laws/smoothing.hpp" ||
               what == "laws/normal_catalogue.hpp")) ||  // laws that scenes spell
             (folder == "bench" && (what == "laws/adapter.hpp" || what == "laws/smoothing.hpp"))));
    }
  }
}
