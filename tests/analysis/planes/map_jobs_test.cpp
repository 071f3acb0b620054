/// What is done of the work for a plane, as far as is known while it goes on.
#include "analysis/planes/map_jobs.hpp"

#include <catch2/catch.hpp>
#include <mutex>
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

TEST_CASE("every job is done once, in groups of like work", "[map-jobs]") {
  std::vector<Job<int>> jobs;
  for (int k = 0; k < 12; ++k) jobs.push_back({k, double(1 + k)});
  std::mutex mutex;
  std::set<int> done;
  std::vector<double> of_groups;
  double told = 0;
  work_in_groups(
      jobs, 3, 2, 1.0,
      [&](FinishedPoints&, double part) {
        const std::scoped_lock lock(mutex);
        told = std::max(told, part);
      },
      [&](const std::vector<const Job<int>*>& group, const auto& advanced) {
        double all = 0;
        for (const auto* job : group) all += job->expected;
        advanced(all);
        const std::scoped_lock lock(mutex);
        for (const auto* job : group) CHECK(done.insert(job->what).second);
        of_groups.push_back(all);
        return FinishedPoints{};
      });
  CHECK(done.size() == 12);
  REQUIRE(of_groups.size() == 4);
  for (const double work : of_groups) CHECK(std::abs(work - 19.5) <= 3);
  CHECK(told == 1);
}
