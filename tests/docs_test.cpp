/// What the docs show is true: commands run, quoted output was printed, quoted code is compiled, links lead somewhere.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path root = ROSIN_SOURCE_DIR;

std::string content(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// README, CONTRIBUTING and everything in docs/.
std::vector<fs::path> pages() {
  std::vector<fs::path> found = {root / "README.md", root / "CONTRIBUTING.md"};
  for (const auto& entry : fs::recursive_directory_iterator(root / "docs"))
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

/// A fenced block of a page: ```language … ```.
struct Block {
  std::string language;
  std::vector<std::string> lines;
};
std::vector<Block> blocks_of(const fs::path& page) {
  std::vector<Block> blocks;
  bool inside = false;
  for (const auto& line : lines_of(content(page))) {
    if (line.rfind("```", 0) == 0) {
      inside = !inside;
      if (inside) blocks.push_back({line.substr(3), {}});
    } else if (inside) {
      blocks.back().lines.push_back(line);
    }
  }
  return blocks;
}

/// True if the pieces of `pattern` between "…" stand in one line of the output, in their order.
bool printed(const std::string& pattern, const std::vector<std::string>& output) {
  const std::string gap = "…";
  for (const auto& line : output) {
    std::size_t at = 0, begin = 0;
    while (at != std::string::npos && begin <= pattern.size()) {
      const auto end = std::min(pattern.find(gap, begin), pattern.size());
      const auto piece = pattern.substr(begin, end - begin);
      at = line.find(piece, at);
      if (at != std::string::npos) at += piece.size();
      begin = end + gap.size();
    }
    if (at != std::string::npos) return true;
  }
  return false;
}

void check_printed(const Block& quoted, const std::vector<std::string>& output) {
  for (const auto& line : quoted.lines) {
    INFO("not printed: " << line);
    CHECK(printed(line, output));
  }
}

/// What a line of shell prints, and its exit status (−1: none).
struct Ran {
  std::vector<std::string> output;
  int status;
};
Ran run(const std::string& command, const fs::path& folder) {
  const auto file = folder / "printed";
  const auto line = "cd '" + folder.string() + "' && (" + command + ") >'" + file.string() + "' 2>&1 </dev/null";
  const int status = std::system(line.c_str());
  return {lines_of(content(file)), WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

/// A new folder in which the commands of a page find the examples and leave their results.
struct Workplace {
  fs::path path = fs::temp_directory_path() / ("rosin-docs-" + std::to_string(getpid()));
  Workplace() {
    fs::remove_all(path);
    fs::create_directories(path);
    for (const char* folder : {"examples", "cases"}) fs::create_directory_symlink(root / folder, path / folder);
  }
  ~Workplace() { fs::remove_all(path); }
};

}  // namespace

#ifdef ROSIN_COMMAND
/// A line of shell that runs `rosin` or another program of build/release/, with those of this build; empty if it runs
/// none.
std::string command_of(const std::string& line) {
  const std::string rosin = "rosin ", build = "build/release/";
  if (line.rfind(rosin, 0) == 0) return "'" ROSIN_COMMAND "' " + line.substr(rosin.size());
  if (line.rfind(build, 0) == 0)
    return fs::path(ROSIN_COMMAND).parent_path().string() + "/" + line.substr(build.size());
  return {};
}

TEST_CASE("every command in the docs runs, and prints what is quoted below it", "[long]") {
  int commands = 0;
  for (const auto& page : pages()) {
    const Workplace workplace;
    std::vector<std::string> output;
    for (const auto& block : blocks_of(page)) {
      INFO(fs::relative(page, root).string());
      if (block.language == "text") {
        if (!output.empty()) check_printed(block, output);
        continue;
      }
      const std::string file = "# scene: ";  // a block of TOML that begins so is a file for the commands below it
      if (block.language == "toml" && !block.lines.empty() && block.lines[0].rfind(file, 0) == 0) {
        std::ofstream scene(workplace.path / block.lines[0].substr(file.size()));
        for (const auto& line : block.lines) scene << line << '\n';
      }
      output.clear();
      if (block.language != "sh") continue;
      for (const auto& line : block.lines) {
        const auto command = command_of(line);
        if (command.empty()) continue;
        INFO(line);
        const auto ran = run(command, workplace.path);
        CHECK(ran.status == 0);
        output.insert(output.end(), ran.output.begin(), ran.output.end());
        ++commands;
      }
    }
  }
  CHECK(commands > 10);
}
#endif

TEST_CASE("the README shows examples/readme.cpp as it is compiled, and what it prints") {
  const auto example = lines_of(content(root / "examples/readme.cpp"));
  int shown = 0;
  const auto blocks = blocks_of(root / "README.md");
  for (std::size_t i = 0; i + 1 < blocks.size(); ++i) {
    if (blocks[i].language != "cpp") continue;
    CHECK(blocks[i].lines == example);
    ++shown;
#ifdef ROSIN_COMMAND
    const auto program = fs::path(ROSIN_COMMAND).parent_path() / "examples/example_readme";
    if (!fs::exists(program)) continue;  // only the tests were built
    const Workplace workplace;
    const auto ran = run("'" + program.string() + "'", workplace.path);
    CHECK(ran.status == 0);
    check_printed(blocks[i + 1], ran.output);
#endif
  }
  CHECK(shown == 1);
}

TEST_CASE("the page of oscillators shows examples/your_own_oscillator.cpp as it is compiled") {
  const auto example = lines_of(content(root / "examples/your_own_oscillator.cpp"));
  const auto blocks = blocks_of(root / "docs/add-an-oscillator.md");
  CHECK(std::any_of(blocks.begin(), blocks.end(), [&](const Block& block) { return block.lines == example; }));
}

TEST_CASE("links within the docs lead to files") {
  for (const auto& page : pages()) {
    const auto text = content(page);
    for (std::size_t at = 0; (at = text.find("](", at)) != std::string::npos;) {
      at += 2;
      auto target = text.substr(at, text.find(')', at) - at);
      target.resize(std::min(target.size(), target.find('#')));
      if (target.empty() || target.find("://") != std::string::npos) continue;
      INFO(fs::relative(page, root).string() << " links to " << target);
      CHECK(fs::exists(page.parent_path() / target));
    }
  }
}

TEST_CASE("the sources that the docs name exist") {
  const std::string letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-/.*";
  int named = 0;
  for (const auto& page : pages()) {
    for (const auto& line : lines_of(content(page))) {
      if (line.rfind('+', 0) == 0) continue;  // what a reader is to add
      for (std::size_t end, at = line.find_first_of(letters); at != std::string::npos;
           at = line.find_first_of(letters, end)) {
        end = std::min(line.find_first_not_of(letters, at), line.size());
        fs::path path = line.substr(at, end - at);
        if (path.begin()->string() == "rosin") path = path.lexically_relative("rosin");  // <rosin/core/dual.hpp>
        const auto folder = path.begin()->string(), ending = path.extension().string();
        if (ending != ".hpp" && ending != ".cpp" && ending != ".*") continue;
        if (path.filename() == path || !std::isalpha(folder.front()) || !fs::exists(root / folder)) continue;
        if (path.stem().string().rfind("my_", 0) == 0) continue;  // what a reader is to write
        if (ending == ".*") path.replace_extension(".cpp");
        INFO(fs::relative(page, root).string() << " names " << path.string());
        CHECK(fs::exists(root / path));
        ++named;
      }
    }
  }
  CHECK(named > 50);
}
