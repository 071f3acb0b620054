/// A folder of its own for each test of the command, and what files in it hold.
#pragma once
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace rosin::tests {

/// Empty at the start, removed at the end.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("rosin-test-" + std::to_string(getpid()));
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

inline std::string content(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace rosin::tests
