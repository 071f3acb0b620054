/// Times of planes on many processes, against schedules that are known.
#include "analysis/planes/schedule.hpp"

#include <catch2/catch.hpp>
#include <numeric>

using namespace rosin::analysis::planes;

TEST_CASE("equal groups take as long as the process that has most of them", "[schedule]") {
  const std::vector<double> groups(10, 2.0);
  CHECK(schedule(groups, 1, 0, 0).seconds == Approx(20));
  CHECK(schedule(groups, 5, 0, 0).seconds == Approx(4));
  CHECK(schedule(groups, 5, 0, 0).efficiency == Approx(1));
  CHECK(schedule(groups, 6, 0, 0).seconds == Approx(4));
  CHECK(schedule(groups, 1000, 0, 0).seconds == Approx(2));
  CHECK(schedule(groups, 1000, 0, 0).efficiency == Approx(0.01));
  CHECK(schedule(groups, 5, 0, 0.5).seconds == Approx(5));    // each process waits twice
  CHECK(schedule(groups, 1000, 3, 0).seconds == Approx(32));  // the tenth is handed out after 30 s
}

TEST_CASE("a list is at worst Graham's bound from the best schedule, and his example attains it", "[schedule]") {
  // R. L. Graham, SIAM J. Appl. Math. 17, 416 (1969): m(m − 1) tasks of 1 and then one of m on m processes, for which m
  // would do, take 2m − 1.
  constexpr int m = 7;
  std::vector<double> groups(m * (m - 1), 1.0);
  groups.push_back(m);
  CHECK(schedule(groups, m, 0, 0).seconds == Approx(2 * m - 1));
  std::rotate(groups.begin(), groups.end() - 1, groups.end());  // the longest first
  CHECK(schedule(groups, m, 0, 0).seconds == Approx(m));
}

TEST_CASE("parts that were not computed take what those that were take in the mean", "[schedule]") {
  const auto seconds = filled_up({{0, 1.0}, {5, 3.0}}, 10);
  CHECK(seconds[0] == 1);
  CHECK(seconds[5] == 3);
  CHECK(std::accumulate(seconds.begin(), seconds.end(), 0.0) == Approx(20));
}
