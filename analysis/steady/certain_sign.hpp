#pragma once

namespace rosin::analysis::steady {

/// Errors are estimates: a normal form's coefficient has a sign where it is more than so many of them.
inline constexpr double certain_sign = 4;

}  // namespace rosin::analysis::steady
