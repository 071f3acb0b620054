/// Files that appear under their names only when they are whole, and files that are read with care.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace rosin {

/// A folder of its own within `parent`, for nobody else, under a name that nobody foretells; gone with this object.
class TemporaryFolder {
 public:
  /// \throws std::runtime_error if it cannot be made.
  explicit TemporaryFolder(const std::filesystem::path& parent);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Lets `write` make a file under a temporary name, then moves it to `path`; both on the same disk.
/// \throws std::runtime_error if it cannot be written.
void write_whole(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);
void write_whole(const std::filesystem::path& path, std::string_view content);

/// Writes all bytes to an open file. \throws std::runtime_error with `path` and what the system says.
void write_all(int file, std::string_view bytes, const std::filesystem::path& path);

/// The content of a regular file or a pipe. \throws InputError for anything else, and for more than `largest` bytes.
std::string read_whole(const std::filesystem::path& path, std::uintmax_t largest);

/// 64 bits by which a damaged or changed text is told from what was written (FNV-1a; no guard against forgery).
std::uint64_t checksum(std::string_view bytes);

}  // namespace rosin
