/// Includes point one way: core → laws → oscillators → analysis → bench → app and core → solvers → analysis; and no
/// folder but laws/ knows a particular law.
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

struct Include {
  fs::path from;     ///< relative to the root
  std::string what;  ///< "laws/law.hpp"
};

/// Every #include "…" of a folder's sources.
std::vector<Include> includes_of(const std::string& folder) {
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const auto ending = entry.path().extension();
    if (ending != ".hpp" && ending != ".cpp") continue;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      const auto hash = line.find_first_not_of(" \t");
      if (hash == std::string::npos || line[hash] != '#' || line.find("include", hash) == std::string::npos) continue;
      const auto open = line.find('"'), close = line.rfind('"');
      if (open != close) found.push_back({fs::relative(entry.path(), root), line.substr(open + 1, close - open - 1)});
    }
  }
  return found;
}

std::string first_part(const std::string& path) { return path.substr(0, path.find('/')); }

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

TEST_CASE("outside laws/ a friction law has no name") {
  for (const auto& [folder, reachable] : allowed) {
    if (folder == "laws") continue;
    for (const auto& [from, what] : includes_of(folder)) {
      if (first_part(what) != "laws") continue;
      INFO(from.string() << " includes " << what);
      CHECK(
          (what == "laws/law.hpp" || ((folder == "app" || folder == "bench") && what == "laws/catalogue.hpp") ||
           (folder == "app" && (what == "laws/formula.hpp" || what == "laws/heating.hpp")) ||  // laws that scenes spell
           (folder == "bench" && what == "laws/adapter.hpp")));
    }
  }
}
