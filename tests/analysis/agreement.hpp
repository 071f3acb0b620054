/// Cycles of one slider that were found in two ways differ by no more than the errors that they state.
#pragma once
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "analysis/cycles/cycle.hpp"

namespace rosin::tests {

/// \param one, other with metrics and their errors. \param members of the metrics that are compared; none: all
template <class One, class Other>
void check_agreement(const One& one, const Other& other,
                     std::vector<double analysis::cycles::Metrics::*> members = {}) {
  for (const auto& metric : analysis::cycles::metric_names()) {
    if (!members.empty() && std::ranges::find(members, metric.member) == members.end()) continue;
    INFO(metric.name << " " << one.metrics.*metric.member << " and " << other.metrics.*metric.member);
    CHECK(std::abs(one.metrics.*metric.member - other.metrics.*metric.member) <=
          one.error.*metric.member + other.error.*metric.member);
  }
}

}  // namespace rosin::tests
