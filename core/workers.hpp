/// Threads that share work out among them. What is thrown in one of them ends the others and is thrown to the caller.
#pragma once
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <stop_token>
#include <system_error>
#include <thread>
#include <vector>

#include "core/stop.hpp"

namespace rosin {

/// Calls work(t) in each of `threads` threads, t = 0 in the caller's; in fewer where the system refuses more. All of
/// them answer to the caller's stop token.
template <class Work>
void in_threads(int threads, Work work) {
  std::stop_source end;
  const std::stop_callback on_request(Listening::token(), [&] { end.request_stop(); });
  std::mutex reporting;
  std::exception_ptr problem;
  const auto guarded = [&](int t) {
    const Listening listening(end.get_token());
    try {
      work(t);
    } catch (...) {
      const std::scoped_lock lock(reporting);
      if (!problem) problem = std::current_exception();
      end.request_stop();
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (int t = 1; t < threads; ++t) others.emplace_back(guarded, t);
    } catch (const std::system_error&) {  // the limit of threads: those that are there do all
    }
    guarded(0);
  }
  if (problem) std::rethrow_exception(problem);
}

/// Calls f(k) for k < count from several threads. \throws Stopped where it ends early.
template <class F>
void in_parallel(int threads, std::size_t count, F f) {
  std::atomic<std::size_t> next{0};
  in_threads(threads, [&](int) {
    for (std::size_t k; (k = next.fetch_add(1)) < count;) {
      end_if_stopped();
      f(k);
    }
  });
}

}  // namespace rosin
