/// Watching signals and the clock by sigtimedwait.
#include "app/verbs/stopping.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <thread>

#include "app/results/manifest.hpp"
#include "app/verbs/ranks.hpp"
#include "core/console.hpp"
#include "core/stop.hpp"

namespace rosin::app::verbs {

namespace {

std::atomic<double> limit_passed = 0;  ///< s; 0: it has not
std::atomic<bool> writing = false;

/// False if the time (s) has passed before a signal came.
bool wait_for(const sigset_t& watched, std::optional<double> seconds) {
  if (!seconds) {
    int received = 0;
    return sigwait(&watched, &received) == 0;
  }
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  for (double left = *seconds; left > 0;
       left = *seconds - std::chrono::duration<double>(Clock::now() - begin).count()) {
    const double whole = std::floor(left);
    const timespec time{static_cast<time_t>(whole), static_cast<long>(1e9 * (left - whole))};
    if (sigtimedwait(&watched, nullptr, &time) > 0) return true;
    if (errno != EINTR) return false;  // a debugger or a checker of leaks has stopped the thread for a moment
  }
  return false;
}

}  // namespace

std::stop_token watch_for_stop(std::optional<double> time_limit) {
  sigset_t watched;
  sigemptyset(&watched);
  sigaddset(&watched, SIGINT);
  sigaddset(&watched, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &watched, nullptr);  // before any other thread starts, which inherits it
  const std::stop_source stop;
  std::thread([watched, stop, time_limit]() mutable {
    if (!wait_for(watched, time_limit)) set_limit_passed(*time_limit);
    stop.request_stop();
    constexpr double grace = 10;  // s
    if (!wait_for(watched, grace)) {
      if (writing)
        wait_for(watched, std::nullopt);
      else
        tell("rosin: the work does not end in order, so it is broken off\n");
    }
    _exit(status_of(why_stopped({Ending::interrupted, ""})));
  }).detach();
  return stop.get_token();
}

void set_limit_passed(double seconds) { limit_passed = seconds; }

void results_are_due() { writing = true; }

Outcome why_stopped(Outcome outcome) {
  if (outcome.ending != Ending::interrupted || limit_passed == 0) return outcome;
  return {Ending::budget_spent, fmt::format("the time limit of {} s has passed{}{}", limit_passed.load(),
                                            outcome.detail.empty() ? "" : "; ", outcome.detail)};
}

Status status_of(const Outcome& outcome) {
  return outcome.complete() ? done : outcome.ending == Ending::interrupted ? interrupted : ended_short;
}

Status stopped_early(const Request& request, const std::string& kept) {
  const Outcome outcome = why_stopped({Ending::interrupted, kept});
  tell("{}: {}\n", name(outcome.ending), outcome.detail);
  if (request.json) write_output(results::to_json(request.verb, outcome));
  return status_of(outcome);
}

Status execute_until(const std::stop_token& stop, const Request& request) {
  const Listening listening(stop);
  try {
    return execute(request);
  } catch (const Stopped&) {
    if (request.ranks && !request.ranks->leads()) return interrupted;
    return stopped_early(request, "nothing is kept");
  }
}

}  // namespace rosin::app::verbs
