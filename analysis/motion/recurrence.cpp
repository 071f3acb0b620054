/// Columns compared with themselves.
#include "analysis/motion/recurrence.hpp"

#include <algorithm>
#include <cmath>

namespace rosin::analysis::motion {

int recurrence_of(const std::vector<std::vector<double>>& columns, int longest) {
  constexpr double same = 1e-6;  // of the range of a column, or of its size where that is larger
  const int count = int(columns.front().size());
  if (count == 1) return 1;
  for (int period = 1; period <= longest; ++period) {
    const bool recurs = std::ranges::all_of(columns, [&](const std::vector<double>& column) {
      double size = 0, apart = 0;
      for (const double value : column) size = std::max(size, std::abs(value));
      for (int i = count - 1; i - period >= 0 && i >= count / 2; --i)
        apart = std::max(apart, std::abs(column[i] - column[i - period]));
      return apart <= same * size;
    });
    if (recurs) return period;
  }
  return 0;
}

}  // namespace rosin::analysis::motion
