/// Locks on folders, and files opened without following links or waiting for pipes.
#include "core/results_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "core/error.hpp"

namespace rosin {

namespace fs = std::filesystem;

FolderClaim::FolderClaim(const fs::path& folder) : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ < 0 || ::flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(folder_);
  throw InputError(fmt::format("another rosin writes into {}; use another --out", folder.string()));
}

FolderClaim::~FolderClaim() {
  if (folder_ >= 0) ::close(folder_);
}

std::string read_found(const fs::path& path, std::uintmax_t largest) {
  const auto refuse = [&](std::string_view why) { throw InputError(fmt::format("{}: {}", path.string(), why)); };
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0)
    refuse(errno == ELOOP    ? "is a link, which is not followed"
           : errno == ENOENT ? "no such file"
                             : std::strerror(errno));
  const auto close = [](const int* open) { ::close(*open); };
  const std::unique_ptr<const int, decltype(close)> closed(&file, close);
  struct stat status {};
  if (::fstat(file, &status) != 0) refuse(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) refuse("is no regular file");
  if (std::uintmax_t(status.st_size) > largest)
    refuse(fmt::format("has {:.1f} MB, more than the {} MB that are read", double(status.st_size) / 1e6,
                       largest / 1'000'000));
  std::string content(std::size_t(status.st_size), '\0');
  for (std::size_t read = 0; read < content.size();) {
    const auto got = ::read(file, content.data() + read, content.size() - read);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::strerror(errno));
    if (got == 0) content.resize(read);  // it was cut meanwhile
    read += std::size_t(got);
  }
  return content;
}

}  // namespace rosin
