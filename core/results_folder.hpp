/// A results folder: written by one process at a time, and read with distrust.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace rosin {

/// A folder that one process at a time writes into: claimed for as long as this object lives.
class FolderClaim {
 public:
  /// \throws InputError while another process has it. A disk that knows no locks lets everybody have it.
  explicit FolderClaim(const std::filesystem::path& folder);
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;

 private:
  int folder_;
};

/// The content of a file that nobody has named, but that was found in a folder. \throws InputError for links, which are
/// not followed, for what is no regular file, and for more than `largest` bytes
std::string read_found(const std::filesystem::path&, std::uintmax_t largest);

}  // namespace rosin
