/// Registers of what is read, without an argument for them in every reader.
#pragma once
#include <utility>

namespace rosin::app::scene {

/// While one lives, it is what `current` finds in its thread, but for one within it.
template <class Own>
class InThread {
 public:
  InThread(const InThread&) = delete;

 protected:
  InThread() : before_(std::exchange(current(), static_cast<Own*>(this))) {}
  ~InThread() { current() = before_; }
  static Own*& current() {
    static thread_local Own* now = nullptr;
    return now;
  }
  Own* before() const { return before_; }  ///< the one that this is within

 private:
  Own* before_;
};

}  // namespace rosin::app::scene
