/// The stress suite of elastic blocks and pins on disks.
#pragma once
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

/// `rosin stress contacts`: random blocks and pins over decades of their parameters, each a scene as a user would write
/// it. None may hold NaN, end without a reason, or open, pull or penetrate against its normal law.
Status stress_contacts(const Request&);

}  // namespace rosin::app::verbs
