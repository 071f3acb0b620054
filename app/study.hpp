/// The verb study.
#pragma once
#include <stop_token>

#include "app/command_line.hpp"
#include "app/verbs.hpp"

namespace rosin::app {

Status study(const Request&, std::stop_token);

}  // namespace rosin::app
