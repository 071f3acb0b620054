/// Writing and reading files by POSIX, whose errno says what went wrong.
#include "core/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/error.hpp"

namespace rosin {

namespace fs = std::filesystem;

namespace {

/// An open file, closed with it.
struct Descriptor {
  int number = -1;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

[[noreturn]] void cannot_write(const fs::path& path) {
  throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
}

}  // namespace

TemporaryFolder::TemporaryFolder(const fs::path& parent) {
  std::string name = (parent / ".rosin-XXXXXX").string();
  if (!::mkdtemp(name.data())) cannot_write(parent / "");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void write_whole(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const TemporaryFolder folder(path.has_parent_path() ? path.parent_path() : ".");
  const fs::path temporary = folder.path() / path.filename();
  write(temporary);
  if (::rename(temporary.c_str(), path.c_str()) != 0) cannot_write(path);
}

void write_whole(const fs::path& path, std::string_view content) {
  write_whole(path, [&](const fs::path& temporary) {
    Descriptor file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666)};
    if (file.number < 0) cannot_write(path);
    write_all(file.number, content, path);
    if (::close(std::exchange(file.number, -1)) != 0) cannot_write(path);
  });
}

void write_all(int file, std::string_view bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const auto written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) cannot_write(path);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::string read_whole(const fs::path& path, std::uintmax_t largest) {
  const auto shown = path.string();
  const auto refuse = [&](std::string_view why) { throw InputError(fmt::format("{}: {}", shown, why)); };
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY)};
  if (file.number < 0) refuse(errno == ENOENT ? "no such file" : std::strerror(errno));
  struct stat status {};
  if (::fstat(file.number, &status) != 0) refuse(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) refuse("is a folder, not a file");
  if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) refuse("is not a regular file or a pipe");
  const auto too_large = [&](double size) {
    refuse(fmt::format("has {:.1f} MB, more than the {} MB that are read", size / 1e6, largest / 1'000'000));
  };
  if (S_ISREG(status.st_mode) && std::uintmax_t(status.st_size) > largest) too_large(double(status.st_size));
  std::string content;
  while (true) {
    constexpr std::size_t block = 1 << 16;
    const auto before = content.size();
    content.resize(before + block);
    const auto got = ::read(file.number, content.data() + before, block);
    if (got < 0 && errno != EINTR) refuse(std::strerror(errno));
    content.resize(before + std::size_t(got > 0 ? got : 0));
    if (got == 0) return content;
    if (content.size() > largest) too_large(double(content.size()));
  }
}

std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  return hash;
}

}  // namespace rosin
