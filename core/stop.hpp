/// A request to end, as it reaches a computation from outside: each thread knows the token that it answers to.
#pragma once
#include <stop_token>
#include <utility>

namespace rosin {

/// Thrown where a computation sees that it is to end. Not a std::exception: whoever makes a failure a result must not
/// take this for one.
struct Stopped {};

/// While it lives, computations of this thread end when the token is asked to stop. A token that can never be asked
/// leaves the one before it.
class Listening {
 public:
  explicit Listening(std::stop_token token) : before_(current()) {
    if (token.stop_possible()) current() = std::move(token);
  }
  ~Listening() { current() = std::move(before_); }
  Listening(const Listening&) = delete;
  Listening& operator=(const Listening&) = delete;

  /// What this thread answers to, for threads that work for it.
  static std::stop_token token() { return current(); }
  static bool stop_asked() { return current().stop_requested(); }

 private:
  static std::stop_token& current() {
    static thread_local std::stop_token token;
    return token;
  }
  std::stop_token before_;
};

/// Stands in every loop that may take long: once a step, a period, or a point. \throws Stopped
inline void end_if_stopped() {
  if (Listening::stop_asked()) throw Stopped{};
}

}  // namespace rosin
