/// Ending before the work is done: on SIGINT and SIGTERM, or when the time limit has passed.
#pragma once
#include <optional>
#include <stop_token>

#include "app/verbs/verbs.hpp"
#include "core/error.hpp"

namespace rosin::app::verbs {

/// Starts to watch for signals and the clock, in a thread of its own; no other thread may have been started. The first
/// signal, or the end of the time (s), asks the work to end in order. A second signal, or work that does not look at
/// the request for 10 s and has no results to write, ends the process.
std::stop_token watch_for_stop(std::optional<double> time_limit);

/// From here on results are written, which is left to take its time.
void results_are_due();

/// The same outcome; one that is "interrupted" because the time limit had passed is spent budget, and says so.
Outcome why_stopped(Outcome);

/// Exit status of an outcome.
Status status_of(const Outcome&);

/// Says that the work was stopped, what is kept, and prints it as a document if that was asked for.
Status stopped_early(const Request&, const std::string& kept);

/// The work of a request, until the token asks it to end. \throws InputError
Status execute_until(const std::stop_token&, const Request&);

/// Where the clock is watched from elsewhere: from here on, an end before the work is done is due to this limit (s); 0:
/// it is due to somebody who asked.
void set_limit_passed(double seconds);

}  // namespace rosin::app::verbs
