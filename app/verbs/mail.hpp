/// Letters between the processes that a launcher has started.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace rosin::app::verbs {

struct Letter {
  int from = 0, kind = 0;
  std::string text;
};

/// One process's mail; used by one thread. Letters from one process to another arrive in their order.
class Mail {
 public:
  virtual ~Mail() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  virtual std::string machine() const = 0;
  virtual void send(int to, int kind, std::string_view text) = 0;
  /// The next letter that has arrived; nothing if none has.
  virtual std::optional<Letter> receive() = 0;
  /// All letters are delivered: leaves the others. If some of them do not answer any more, all are ended with `status`.
  virtual void leave() = 0;
  [[noreturn]] virtual void end_all(int status) = 0;
};

/// What a launcher (mpirun, srun) says of this process in its environment, before anything is initialised.
struct Launch {
  int rank = 0;
  int size = 0;  ///< 0: it does not say
};
/// Nothing where no launcher has started this process, or this one alone.
std::optional<Launch> launched();

}  // namespace rosin::app::verbs
