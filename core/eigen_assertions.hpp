/// Assertions of Eigen as exceptions: the command then says what was violated and ends in order, where an abort would
/// lose all results. Included before every file of the library and of what links it.
#pragma once
#ifdef __cplusplus
#include <stdexcept>

namespace rosin {
[[noreturn]] inline void fail_assertion(const char* what) { throw std::logic_error(what); }
}  // namespace rosin

#define eigen_assert(condition)                                                          \
  do {                                                                                   \
    if (!(condition)) ::rosin::fail_assertion("assertion of Eigen failed: " #condition); \
  } while (false)
#endif
