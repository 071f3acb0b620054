/// Finding and spawning programs by POSIX.
#include "core/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "core/files.hpp"
#include "core/stop.hpp"

extern char** environ;

namespace rosin {

namespace fs = std::filesystem;

namespace {

/// Two ends of a pipe, closed with this object.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ends = {-1, -1};
  }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  Pipe(const Pipe&) = delete;
  void close_writing() { ::close(std::exchange(ends[1], -1)); }
};

constexpr std::size_t longest_messages = 1 << 16;  // bytes

/// A file in memory that holds a text, to be read from its beginning; none for an empty one.
struct Memory {
  int file = -1;
  explicit Memory(const std::string& text) {
    if (text.empty() || (file = ::memfd_create("input", MFD_CLOEXEC)) < 0) return;
    write_all(file, text, "the input of a program");
    ::lseek(file, 0, SEEK_SET);
  }
  ~Memory() {
    if (file >= 0) ::close(file);
  }
  Memory(const Memory&) = delete;
};

/// Reads what waits there and keeps the first bytes of all. \returns false at the end.
bool take(int file, std::string& kept, std::size_t most) {
  std::array<char, 4096> buffer;
  const ssize_t got = ::read(file, buffer.data(), buffer.size());
  if (got < 0) return errno == EINTR;
  kept.append(buffer.data(), std::min(static_cast<std::size_t>(got), most - kept.size()));
  return got > 0;
}

}  // namespace

std::optional<fs::path> find_program(const std::string& name) {
  const auto runs = [](const fs::path& path) {
    std::error_code problem;
    return fs::is_regular_file(path, problem) && ::access(path.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) {
    const fs::path path = fs::absolute(name);
    return runs(path) ? std::optional(path) : std::nullopt;
  }
  const char* list = std::getenv("PATH");
  std::string_view rest = list ? list : "/usr/local/bin:/usr/bin:/bin";
  while (true) {
    const auto colon = rest.find(':');
    const fs::path path = fs::absolute(fs::path(rest.substr(0, colon)) / name);  // an empty entry is this folder
    if (runs(path)) return path;
    if (colon == std::string_view::npos) return std::nullopt;
    rest.remove_prefix(colon + 1);
  }
}

std::optional<Ran> run_program(const Command& command) {
  Pipe output, messages;
  const Memory input(command.input);
  if (output.ends[0] < 0 || messages.ends[0] < 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (!command.folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, command.folder.c_str());
  if (input.file >= 0)
    posix_spawn_file_actions_adddup2(&actions, input.file, STDIN_FILENO);
  else
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages.ends[1], STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, ignored_here;
  sigemptyset(&none);  // the command blocks signals, other programs must not
  sigemptyset(&ignored_here);
  for (const int signal : {SIGPIPE, SIGXFSZ}) sigaddset(&ignored_here, signal);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &ignored_here);
  // A program that stops with us is ended by us, not by the Ctrl-C of a terminal, which reaches a whole group.
  const int group = command.stops_with_us ? POSIX_SPAWN_SETPGROUP : 0;
  posix_spawnattr_setflags(&attributes, short(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | group));

  std::string program = command.program.string();
  auto arguments = command.arguments, added = command.environment;
  std::vector<char*> argv = {program.data()}, environment;
  for (auto& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const auto name_of = [](std::string_view entry) { return entry.substr(0, entry.find('=')); };
  // Each name once: of two, some programs take the first and some the last.
  for (auto& entry : added) environment.push_back(entry.data());
  for (char** entry = environ; *entry; ++entry)
    if (std::none_of(added.begin(), added.end(), [&](const auto& own) { return name_of(own) == name_of(*entry); }))
      environment.push_back(*entry);
  environment.push_back(nullptr);
  pid_t child = 0;
  const int problem = posix_spawn(&child, program.c_str(), &actions, &attributes, argv.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) return std::nullopt;
  for (auto* pipe : {&output, &messages}) pipe->close_writing();
  Ran ran{};
  bool stopped = false;
  std::array<pollfd, 2> open = {{{output.ends[0], POLLIN, 0}, {messages.ends[0], POLLIN, 0}}};
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    constexpr int glance = 50;  // ms, between two looks at the stop request
    if (command.stops_with_us && !stopped && Listening::stop_asked()) stopped = ::kill(child, SIGTERM) == 0;
    for (auto& file : open) file.revents = 0;
    if (::poll(open.data(), open.size(), command.stops_with_us ? glance : -1) < 0 && errno != EINTR) break;
    for (auto& file : open) {
      const bool out = file.fd == output.ends[0];
      if (file.revents != 0 &&
          !take(file.fd, out ? ran.output : ran.messages, out ? command.longest_output : longest_messages))
        file.fd = -1;  // which poll passes over
    }
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;
  if (stopped) throw Stopped{};
  ran.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return ran;
}

std::string shell_word(const std::string& text) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || std::string_view("/._-=+:,@%").find(char(c)) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, plain)) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

}  // namespace rosin
