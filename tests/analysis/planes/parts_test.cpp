/// Parts of a plane: shares that cost alike, and what is found whoever computes them.
#include "analysis/planes/parts.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "core/error.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::planes;
using rosin::tests::bristol_board;

namespace {

MapOptions plane_of(int points) {
  MapOptions options;
  options.x = make_axis("drive.normal_load", 9.81e-8, 9.81, points, true, {});
  options.y = make_axis("law.lambda", 1e-4, 1e2, points, true, {0});
  options.metrics = {"stick_fraction", "loop_area"};
  options.tolerance = 1e-3;
  options.exact = true;
  return options;
}

}  // namespace

TEST_CASE("shares of a plane have alike many parts, scattered over all of it", "[parts]") {
  const auto tiles = partition_of(plane_of(32 * 40), false);
  REQUIRE(tiles.count() == 40 * 41);
  for (const int count : {2, 7, 40, 41, 400}) {
    const auto shares = tiles.shares(count);
    std::map<int, int> sizes, in_corner;  // of the four quarters the first
    for (std::size_t part = 0; part < shares.size(); ++part) {
      ++sizes[shares[part]];
      in_corner[shares[part]] += part % 40 < 20 && part / 40 < 20;
    }
    INFO(count);
    CHECK(int(sizes.size()) == count);
    for (const auto& [share, size] : sizes) {
      CHECK(std::abs(size - double(tiles.count()) / count) < 1);
      // A column for each share, 41 parts, would be off by ten.
      CHECK(std::abs(in_corner[share] - size * 400.0 / 1640) <= 3 + 0.01 * size);
    }
  }
  CHECK_THROWS_WITH(tiles.shares(1641), Catch::Contains("1640 parts has no 1641 shares"));
}

TEST_CASE("every point of a plane lies in one part, be it tiles, patches or points", "[parts]") {
  auto options = plane_of(400);
  const auto check = [&](const Partition& partition) {
    std::vector<int> seen(partition.points(), 0);
    for (std::size_t part = 0; part < partition.count(); ++part)
      partition.for_each(part, [&](std::size_t i, int, int) { ++seen.at(i); });
    CHECK(seen == std::vector<int>(400 * 401, 1));
  };
  check(partition_of(options, false));
  check(partition_of(options, true));
  options.exact = false;
  REQUIRE(interpolates(options));
  check(partition_of(options, false));
}

TEST_CASE("shares of a plane are the plane, digit for digit", "[parts]") {
  const auto model = bristol_board(1e-4, 10);
  auto options = plane_of(34);
  const Map whole = compute_map(model, options);
  const auto partition = partition_of(options, false);
  REQUIRE(partition.count() == 6);
  std::map<std::size_t, MapPoint> found;
  std::set<std::size_t> timed;
  int twice = 0;
  for (int index = 0; index < 3; ++index) {
    options.share = {index, 3};
    MapHooks hooks;
    hooks.finished = [&](auto indices, const auto& points) {
      for (const std::size_t i : indices) twice += !found.emplace(i, points[i]).second;
    };
    hooks.costs = [&](const auto& costs) {
      for (const auto& cost : costs) CHECK((cost.seconds > 0 && timed.insert(cost.part).second));
    };
    const Map share = compute_map(model, options, hooks);
    CHECK(share.outcome.complete());
    CHECK(std::ranges::count_if(share.points, &MapPoint::done) > 0);
  }
  CHECK(timed.size() == 6);
  CHECK(twice == 0);
  REQUIRE(found.size() == whole.points.size());
  options.share = {};
  MapHooks hooks;
  hooks.known = [&](std::size_t i) { return std::optional(found.at(i)); };
  hooks.finished = [&](auto, const auto&) { FAIL("a known point was computed again"); };
  const Map merged = compute_map(model, options, hooks);
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(merged.points[i].regime == whole.points[i].regime);
    for (const auto& metric : whole.metrics) {
      const double a = metric.value(merged.points[i]), b = metric.value(whole.points[i]);
      CHECK((a == b || (std::isnan(a) && std::isnan(b))));
    }
  }
  CHECK(merged.threshold.x == whole.threshold.x);
  CHECK(merged.notes == whole.notes);
}
