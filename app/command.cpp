/// The streams, signals and exit statuses of the `rosin` command.
#include "app/command.hpp"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include "app/command_line.hpp"
#include "app/verbs/mail.hpp"
#include "app/verbs/ranks.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verbs.hpp"
#include "core/console.hpp"
#include "core/error.hpp"

namespace rosin::app {

namespace {

/// A stream that the caller has closed is held open by a file that takes nothing, lest a results file gets its number;
/// a reader that went away and a file that grew too large are errors of a write, not the end of the process.
void keep_streams_apart() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0) _exit(verbs::ended_short);
  for (const int harmless : {SIGPIPE, SIGXFSZ}) signal(harmless, SIG_IGN);
}

/// The processes that a launcher has started together with this one, if the verb shares its work out to them. Who does
/// not lead prints nothing. \throws InputError where they would all do the same
std::unique_ptr<verbs::Ranks> ranks_of(Request& request, JoinProcesses join) {
  const auto launch = verbs::launched();
  if (!launch || !verbs::find_verb(request.verb).spreads) return nullptr;
  if (!join) {
    if (launch->rank > 0) _exit(verbs::wrong_input);  // the first has said it
    throw InputError(fmt::format(
        "{} processes were started, which would all compute the same plane: this rosin is built without MPI "
        "(libopenmpi-dev); start one with --threads, or shares of the plane by --shard K/N and 'rosin merge'",
        launch->size > 0 ? std::to_string(launch->size) : "several"));
  }
  auto ranks = std::make_unique<verbs::Ranks>(join());
  if (ranks->processes() == 1) return nullptr;
  request.ranks = ranks.get();
  if (!ranks->leads()) request.quiet = true, request.json = request.explain = false;
  return ranks;
}

int perform(int argc, char** argv, JoinProcesses join) {
  std::unique_ptr<verbs::Ranks> ranks;
  const auto say = [&](const std::string& why) {
    if (ranks && !ranks->leads())
      ranks->fail(why);
    else
      tell("{}\n", why);
  };
  try {
    auto parsed = parse_command_line(argc, argv);
    if (const int* status = std::get_if<int>(&parsed)) return *status;
    auto& request = std::get<Request>(parsed);
    const auto stop = verbs::watch_for_stop(request.time_limit);
    ranks = ranks_of(request, join);
    return verbs::execute_until(stop, request);
  } catch (const InputError& error) {
    say(error.what());
    return verbs::wrong_input;
  } catch (const std::bad_alloc&) {
    say("rosin: out of memory");
  } catch (const std::exception& error) {
    say(fmt::format("rosin: {}", error.what()));
  }
  return verbs::ended_short;
}

}  // namespace

int command(int argc, char** argv, JoinProcesses join) {
  keep_streams_apart();
  const int status = perform(argc, argv, join);
  if (const int problem = output_problem()) {
    if (problem != EPIPE)  // else whoever read it has seen enough
      tell("rosin: standard output cannot be written: {}\n", std::strerror(problem));
    if (status == verbs::done) return verbs::ended_short;
  }
  return status;
}

}  // namespace rosin::app
