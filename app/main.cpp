/// The `rosin` command: its streams and signals, exit statuses, and nothing else.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "app/verbs/stopping.hpp"
#include "app/verbs/verbs.hpp"
#include "core/console.hpp"
#include "core/error.hpp"

namespace {

/// A stream that the caller has closed is held open by a file that takes nothing, lest a results file gets its number;
/// a reader that went away and a file that grew too large are errors of a write, not the end of the process.
void keep_streams_apart() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0) _exit(rosin::app::verbs::ended_short);
  for (const int harmless : {SIGPIPE, SIGXFSZ}) signal(harmless, SIG_IGN);
}

int perform(int argc, char** argv) {
  using namespace rosin;
  using namespace rosin::app;
  try {
    const auto parsed = parse_command_line(argc, argv);
    if (const int* status = std::get_if<int>(&parsed)) return *status;
    const auto& request = std::get<Request>(parsed);
    return verbs::execute_until(verbs::watch_for_stop(request.time_limit), request);
  } catch (const InputError& error) {
    tell("{}\n", error.what());
    return verbs::wrong_input;
  } catch (const std::bad_alloc&) {
    tell("rosin: out of memory\n");
  } catch (const std::exception& error) {
    tell("rosin: {}\n", error.what());
  }
  return verbs::ended_short;
}

}  // namespace

int main(int argc, char** argv) {
  keep_streams_apart();
  const int status = perform(argc, argv);
  if (const int problem = rosin::output_problem()) {
    if (problem != EPIPE)  // else whoever read it has seen enough
      rosin::tell("rosin: standard output cannot be written: {}\n", std::strerror(problem));
    if (status == rosin::app::verbs::done) return rosin::app::verbs::ended_short;
  }
  return status;
}
