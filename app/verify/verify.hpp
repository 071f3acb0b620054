/// `rosin verify`: numbers that others have printed or computed, asked of rosin again.
#pragma once
#include "app/verbs.hpp"

namespace rosin::app::verify {

/// Runs the cases, prints a table, writes verify.json, a page and a picture for each group. \returns `ended_short`
/// where an answer disagrees with its source or is missing, and nobody says why.
/// \throws InputError for cases that cannot be read, before any is run; Stopped where it was asked to end.
Status verify(const Request&);

}  // namespace rosin::app::verify
