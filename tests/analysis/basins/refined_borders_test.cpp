/// Labels of grids whose borders are known in closed form.
#include "analysis/basins/refined_borders.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin::analysis::basins;

namespace {

constexpr int columns = 201, rows = 161;

/// Label of a place in 0 … 1 along both axes.
using Labels = int (*)(double x, double y);

struct Found {
  RefinedBorders borders{columns, rows};
  std::vector<int> labels;
  std::size_t asked = 0;
};

RefinedBorders::Follow follow(Labels label, Found& found) {
  return [label, &found](const std::vector<std::size_t>& starts, std::vector<int>& labels) {
    for (const std::size_t i : starts)
      labels[i] = label(double(i % columns) / (columns - 1), double(i / columns) / (rows - 1));
    found.asked += starts.size();
  };
}

std::size_t wrong(const Found& found, Labels label) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < found.labels.size(); ++i)
    count += found.labels[i] != label(double(i % columns) / (columns - 1), double(i / columns) / (rows - 1));
  return count;
}

int disc(double x, double y) { return std::hypot(x - 0.52, y - 0.47) < 0.31; }
int spiral(double x, double y) {
  const double turns = std::atan2(y - 0.5, x - 0.5) / M_PI + 9 * std::hypot(x - 0.5, y - 0.5);
  return int(std::floor(turns)) & 1;
}
int corner(double x, double y) { return x < 0.02 && y > 0.985 ? 2 : 0; }
int all_the_same(double, double) { return 3; }
int speck(double x, double y) { return std::hypot(x - 0.5337, y - 0.4671) < 0.02; }

}  // namespace

TEST_CASE("borders are found to the start, and few starts are followed", "[basin]") {
  for (const auto& [label, most] : {std::pair<Labels, double>{disc, 0.12}, {spiral, 0.85}, {corner, 0.03}}) {
    Found found;
    found.borders.find(follow(label, found), found.labels);
    CHECK(wrong(found, label) == 0);
    CHECK(found.asked == std::size_t(std::ranges::count(found.borders.followed(), true)));
    CHECK(double(found.asked) < most * columns * rows);
  }
  Found plain;
  plain.borders.find(follow(all_the_same, plain), plain.labels);
  CHECK(plain.asked == std::size_t(14 * 11));  // lines at every 16th start, and the last
}

TEST_CASE("an island within a cell is missed, and found whole once a start in it is followed", "[basin]") {
  Found found;
  found.borders.find(follow(speck, found), found.labels);
  const auto missed = wrong(found, speck);
  CHECK(missed > 0);
  std::vector<std::size_t> sample;
  for (const std::size_t i : found.borders.filled())
    if (found.labels[i] != speck(double(i % columns) / (columns - 1), double(i / columns) / (rows - 1)) &&
        sample.empty())
      sample.push_back(i);
  CHECK(found.borders.check(sample, follow(speck, found), found.labels) == 1);
  CHECK(wrong(found, speck) == 0);
}
