/// The `rosin` command: signals, exit statuses, and nothing else.
#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <new>
#include <stdexcept>
#include <stop_token>
#include <thread>

#include "app/verbs.hpp"
#include "core/error.hpp"

namespace {

/// Takes SIGINT and SIGTERM in a thread of its own: the first asks for an orderly end, a second ends at once.
void watch_signals(std::stop_source stop, bool orderly) {
  sigset_t watched;
  sigemptyset(&watched);
  sigaddset(&watched, SIGINT);
  sigaddset(&watched, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &watched, nullptr);  // before any other thread starts, which inherits it
  std::thread([watched, stop, orderly]() mutable {
    int received = 0;
    sigwait(&watched, &received);
    if (orderly) {
      stop.request_stop();
      sigwait(&watched, &received);
    }
    _exit(rosin::app::interrupted);
  }).detach();
}

}  // namespace

int main(int argc, char** argv) {
  using namespace rosin::app;
  try {
    const auto parsed = parse_command_line(argc, argv);
    if (const int* status = std::get_if<int>(&parsed)) return *status;
    const auto& request = std::get<Request>(parsed);
    const std::stop_source stop;
    watch_signals(stop, can_stop(request));
    const Status status = execute(request, stop.get_token());
    if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
    return status;
  } catch (const rosin::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return wrong_input;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "rosin: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "rosin: {}\n", error.what());
  }
  return ended_short;
}
