/// Files that appear whole or not at all, through no link, and reading that refuses what has no end.
#include "core/files.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <thread>

#include "core/error.hpp"
#include "tests/app/folder.hpp"

using namespace rosin;
using Catch::Matchers::Contains;
using rosin::tests::content;
using rosin::tests::Folder;

namespace fs = std::filesystem;

namespace {
std::size_t files_in(const fs::path& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}
}  // namespace

TEST_CASE("a file takes the place of a link, not of what the link names", "[files]") {
  const Folder folder;
  write_whole(folder.path / "victim", "kept");
  fs::create_symlink("victim", folder.path / "result");
  write_whole(folder.path / "result", "new");
  CHECK(content(folder.path / "victim") == "kept");
  CHECK(content(folder.path / "result") == "new");
  CHECK(files_in(folder.path) == 2);  // nothing temporary is left
}

TEST_CASE("what cannot be written says why, and leaves what was there", "[files]") {
  const Folder folder;
  write_whole(folder.path / "result", "old");
  CHECK_THROWS_WITH(write_whole(folder.path / "result", [](const fs::path&) { throw std::runtime_error("it failed"); }),
                    "it failed");
  CHECK(content(folder.path / "result") == "old");
  CHECK(files_in(folder.path) == 1);
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  REQUIRE(full >= 0);
  CHECK_THROWS_WITH(write_all(full, "something", "x.csv"), "x.csv: cannot be written: No space left on device");
  ::close(full);
  CHECK_THROWS_WITH(write_whole(folder.path / "none/result", "x"), Contains("No such file or directory"));
}

TEST_CASE("files and pipes are read to a bound, devices and folders not at all", "[files]") {
  const Folder folder;
  write_whole(folder.path / "text", std::string(100'000, 'x'));
  CHECK(read_whole(folder.path / "text", 100'000).size() == 100'000);
  CHECK_THROWS_WITH(read_whole(folder.path / "text", 99'999), Contains("has 0.1 MB, more than"));
  CHECK_THROWS_WITH(read_whole(folder.path, 10), Contains("is a folder"));
  CHECK_THROWS_WITH(read_whole("/dev/zero", 10), "/dev/zero: is not a regular file or a pipe");
  CHECK_THROWS_WITH(read_whole(folder.path / "none", 10), Contains("none: no such file"));
  const auto pipe = folder.path / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const auto before = ::signal(SIGPIPE, SIG_IGN);  // of the writer, whose reader goes away
  for (const std::size_t size : {1'000, 1'000'000}) {
    std::jthread writer([&] {
      const int file = ::open(pipe.c_str(), O_WRONLY | O_CLOEXEC);
      const std::string block(1'000, 'x');
      for (std::size_t written = 0; written < size; written += block.size())
        if (::write(file, block.data(), block.size()) < 0) break;
      ::close(file);
    });
    if (size == 1'000)
      CHECK(read_whole(pipe, 200'000).size() == size);
    else
      CHECK_THROWS_AS(read_whole(pipe, 100'000), InputError);
  }
  ::signal(SIGPIPE, before);
}
