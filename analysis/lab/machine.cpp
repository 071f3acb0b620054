/// What machines have in common.
#include "analysis/lab/machine.hpp"

#include <cmath>

namespace rosin::analysis::lab {

std::vector<double> CoordinateSum::over(const std::vector<std::vector<double>>& columns) const {
  std::vector<double> sum(columns.front().size(), 0.0);
  for (std::size_t c = 0; c < weights.size(); ++c)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weights[c] * columns[c][i];
  return sum;
}

double CoordinateSum::error(const std::vector<double>& column_errors) const {
  double error = 0;
  for (std::size_t c = 0; c < weights.size(); ++c)
    if (weights[c] != 0) error += std::abs(weights[c]) * column_errors[c];
  return error;
}

std::unique_ptr<const Machine> machine_of(const Task& task) {
  return task.structure ? structure_machine(*task.structure) : slider_machine(task.model);
}

}  // namespace rosin::analysis::lab
