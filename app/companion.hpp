/// Folders that come with the command: examples and cases.
#pragma once
#include <filesystem>
#include <string_view>

namespace rosin::app {

/// The folder `name` below share/rosin, which lies beside the folder of an installed command, and below that of the
/// build in which a command was compiled. No path is compiled in, so that both may be moved.
inline std::filesystem::path companion(std::string_view name) {
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const auto installed = folder / "../share/rosin" / name;
  std::error_code problem;
  return std::filesystem::is_directory(installed, problem) ? installed.lexically_normal()
                                                           : folder / "share/rosin" / name;
}

}  // namespace rosin::app
