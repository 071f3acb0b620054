/// What is done of the work for a plane, as far as is known while it goes on.
#include "analysis/planes/map_jobs.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace rosin::analysis;
using namespace rosin::analysis::planes;

TEST_CASE("work that takes what it usually takes is foretold exactly", "[map-jobs]") {
  Ledger ledger({10, 20, 30}, 2);
  CHECK(ledger.advance(1, 20) == Approx(20.0 / 120));
  CHECK(ledger.advance(0, 20) == Approx(40.0 / 120).epsilon(0.01));
  CHECK(ledger.finish(0) == Approx(40.0 / 120));
  ledger.advance(1, 20);
  CHECK(ledger.finish(1) == Approx(60.0 / 120));
  ledger.advance(2, 60);
  CHECK(ledger.finish(2) == 1);
}

TEST_CASE("groups that are finished teach how much the others will take", "[map-jobs]") {
  Ledger ledger(std::vector<double>(10, 1.0), 1);
  double before = 0;
  for (std::size_t k = 0; k < 10; ++k) {
    ledger.advance(k, 3);  // three times what is usual
    const double now = ledger.finish(k), true_part = double(k + 1) / 10;
    CHECK(now > before);
    CHECK(now >= true_part);  // too hopeful at first,
    if (k >= 4) CHECK(now <= 1.35 * true_part);
    before = now;
  }
  CHECK(before == 1);
}

TEST_CASE("more work than expected never looks finished", "[map-jobs]") {
  Ledger ledger({1, 1}, 1);
  ledger.advance(0, 50);
  CHECK(ledger.advance(1, 50) < 1);
  ledger.finish(0);
  CHECK(ledger.advance(1, 500) < 1);
  CHECK(ledger.finish(1) == 1);
}

TEST_CASE("every part is in one group, and groups take alike long", "[map-jobs]") {
  std::vector<std::size_t> parts;
  std::vector<double> expected;
  for (std::size_t k = 0; k < 12; ++k) parts.push_back(100 + k), expected.push_back(double(1 + k));
  const auto [groups, of_groups] = groups_of(parts, expected, 3, 1);
  REQUIRE(groups.size() == 4);
  std::set<std::size_t> seen;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    double all = 0;
    for (const std::size_t part : groups[g].parts) {
      CHECK(seen.insert(part).second);
      all += expected[part - 100];
    }
    CHECK(groups[g].number == g);
    CHECK(of_groups[g] == all);
    CHECK(std::abs(all - 19.5) <= 3);
  }
  CHECK(seen.size() == 12);
  // Two hands: the last two groups part by part.
  const auto [split, of_split] = groups_of(parts, expected, 3, 2);
  REQUIRE(split.size() == 8);
  std::set<std::size_t> again;
  for (std::size_t g = 0; g < split.size(); ++g) {
    CHECK(split[g].number == g);
    CHECK(split[g].parts.size() == (g < 2 ? 3u : 1u));
    for (const std::size_t part : split[g].parts) again.insert(part);
    if (g >= 2) CHECK(of_split[g] == expected[split[g].parts.front() - 100]);
  }
  CHECK(again == seen);
}
