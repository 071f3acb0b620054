/// Patches of closed forms: errors below those stated, few points where it is smooth, all of them where it is not.
#include "analysis/planes/patch.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

using namespace rosin::analysis;
using namespace rosin::analysis::planes;

namespace {

struct Answer {
  int kind = 0;
  PixelValues values;
};

/// Drives a patch to its end.
void finish(Patch& patch, int width, const std::function<Answer(int, int)>& at) {
  for (auto wanted = patch.advance(); !wanted.empty(); wanted = patch.advance())
    for (const auto* list : {&wanted.nodes, &wanted.direct})
      for (const int pixel : *list) {
        auto answer = at(pixel % width, pixel / width);
        patch.set(pixel, answer.kind, std::move(answer.values));
      }
}

PixelValues one(double value, double error = 0) { return {{value}, {error}, {std::abs(value)}}; }

}  // namespace

TEST_CASE("a smooth function over decades is interpolated to the tolerance", "[patch]") {
  constexpr int width = 128, height = 101;
  for (const double tolerance : {1e-3, 1e-6}) {
    Patch patch({.width = width, .height = height, .tolerance = tolerance}, [](int, int) -> Patch::Class { return 1; });
    const auto f = [](int x, int y) { return std::exp(0.05 * x - 0.03 * y) * (2 + std::sin(0.06 * x + 0.04 * y)); };
    finish(patch, width, [&](int x, int y) { return Answer{0, one(f(x, y))}; });
    CHECK(patch.computed() < width * height / (tolerance > 1e-4 ? 12 : 6));
    int beyond = 0;
    for (int i = 0; i < width * height; ++i) {
      const double exact = f(i % width, i / width), off = std::abs(patch.value(i, 0) - exact);
      CHECK(off <= tolerance * exact);
      beyond += off > patch.error(i, 0);
    }
    CHECK(beyond * 100 <= width * height);
  }
}

TEST_CASE("errors of the nodes are carried on to what rests on them", "[patch]") {
  constexpr int width = 97;
  const auto noise = [](int x, int y) { return 1e-6 * std::sin(1e3 * x + 7e4 * y); };
  Patch patch({.width = width, .height = width, .tolerance = 1e-3}, [](int, int) -> Patch::Class { return 1; });
  finish(patch, width, [&](int x, int y) { return Answer{0, one(1 + 1e-3 * x + noise(x, y), 1e-6)}; });
  for (int i = 0; i < width * width; ++i) {
    CHECK(std::abs(patch.value(i, 0) - (1 + 1e-3 * (i % width))) <= patch.error(i, 0) + 1e-15);
    CHECK(patch.error(i, 0) >= 1e-6);
  }
  // Nodes too inexact for the tolerance: every pixel is computed.
  Patch rough({.width = width, .height = 13, .tolerance = 1e-3}, [](int, int) -> Patch::Class { return 1; });
  finish(rough, width, [&](int x, int) { return Answer{0, one(1 + 1e-3 * x, 5e-4)}; });
  for (int i = 0; i < width * 13; ++i) CHECK(rough.origin(i) == Patch::Origin::computed);
}

TEST_CASE("nothing is interpolated across a border", "[patch]") {
  constexpr int width = 120;
  const auto outside = [](int x, int y) { return x + 0.3 * y > 70; };
  const auto kink = [](int x, int y) { return y > 80 - 0.2 * x; };
  Patch patch({.width = width, .height = width, .tolerance = 1e-4},
              [&](int x, int y) -> Patch::Class { return outside(x, y) ? Patch::blank : 1; });
  const auto f = [&](int x, int y) { return 1 + 0.01 * x + (kink(x, y) ? 0.5 : 0.0); };
  finish(patch, width, [&](int x, int y) { return Answer{kink(x, y), one(f(x, y))}; });
  for (int i = 0; i < width * width; ++i) {
    const int x = i % width, y = i / width;
    CHECK((patch.origin(i) == Patch::Origin::blank) == outside(x, y));
    if (outside(x, y)) continue;
    CHECK(patch.kind(i) == kink(x, y));
    CHECK(std::abs(patch.value(i, 0) - f(x, y)) <= 1e-4 * f(x, y));
  }
  CHECK(patch.computed() < width * width / 4);
}

TEST_CASE("a quantity that begins as a square root is interpolated up to its beginning", "[patch]") {
  constexpr int width = 128;
  // q = √(0.1 − h) times something smooth, for h up to nearly 0.1.
  const auto helper = [](int x) { return 0.0999 - 0.0007 * x; };
  const auto f = [&](int x, int y) { return std::sqrt(0.1 - helper(x)) * (1 + 0.002 * y); };
  const auto count = [&](std::vector<Patch::Options::Root> roots) {
    const bool helped = !roots.empty();
    Patch patch({width, width, 1e-4, 2, 1, std::move(roots)}, [](int, int) -> Patch::Class { return 1; });
    finish(patch, width, [&](int x, int y) { return Answer{0, {{f(x, y), helper(x)}, {0, 0}, {1, 1}}}; });
    int beyond = 0;
    for (int i = 0; i < width * width; ++i) beyond += std::abs(patch.value(i, 0) - f(i % width, i / width)) > 1e-4;
    CHECK(beyond * 50 <= (helped ? 0 : width * width));
    return patch.computed();
  };
  const long with = count({{0, 1, 0.1}}), without = count({});
  CHECK(with < 100);
  CHECK(without > 3 * with);
}

TEST_CASE("a root may begin amid a patch, along any curve", "[patch]") {
  constexpr int width = 128;
  const auto helper = [](int x, int y) { return 0.1 + 1e-5 * (x - 40 - 0.4 * y) * (60 + 0.2 * x + 0.1 * y); };
  const auto f = [&](int x, int y) {
    return std::sqrt(std::max(0.0, 0.1 - helper(x, y))) * (2 + 0.01 * y + 1e-4 * x * x);
  };
  Patch patch({width, width, 1e-4, 2, 1, {{0, 1, 0.1}}}, [](int, int) -> Patch::Class { return 1; });
  finish(patch, width, [&](int x, int y) { return Answer{0, {{f(x, y), helper(x, y)}, {0, 0}, {1, 1}}}; });
  int beyond = 0;
  for (int i = 0; i < width * width; ++i) {
    const double off = std::abs(patch.value(i, 0) - f(i % width, i / width));
    beyond += off > patch.error(i, 0);
    CHECK(off <= 1e-4);
  }
  CHECK(beyond * 100 <= width * width);
  CHECK(patch.computed() < 1500);  // of 16384
}

TEST_CASE("a border that follows an axis is cut off in lines", "[patch]") {
  constexpr int width = 128;
  for (const bool transposed : {false, true}) {
    const auto border = [](int x) { return 90.3 + 4 * std::sin(0.02 * x); };
    const auto outside = [&](int x, int y) { return transposed ? x > border(y) : y > border(x); };
    // It grows as the root of the distance from the border: no polynomial.
    const auto f = [&](int x, int y) { return transposed ? std::sqrt(border(y) - x) : std::sqrt(border(x) - y); };
    Patch patch({.width = width, .height = width, .tolerance = 1e-3},
                [&](int x, int y) -> Patch::Class { return outside(x, y) ? Patch::blank : 1; });
    finish(patch, width, [&](int x, int y) { return Answer{0, {{f(x, y)}, {0}, {1}}}; });
    for (int i = 0; i < width * width; ++i) {
      CHECK((patch.origin(i) == Patch::Origin::blank) == outside(i % width, i / width));
      if (patch.origin(i) != Patch::Origin::blank) CHECK(std::abs(patch.value(i, 0) - f(i % width, i / width)) <= 1e-3);
    }
    CHECK(patch.computed() < 1100);  // of some 11 600
  }
}

TEST_CASE("the order of the nodes goes from coarse to fine", "[patch]") {
  Patch patch({.width = 97, .height = 97, .tolerance = 1e-6}, [](int, int) -> Patch::Class { return 1; });
  const auto phase = [&](int x, int y) { return patch.phase(y * 97 + x); };
  CHECK(phase(0, 0) == 0);
  CHECK(phase(32, 64) == 0);
  CHECK(phase(32, 32) < phase(16, 32));
  CHECK(phase(16, 32) < phase(16, 16));
  CHECK(phase(16, 16) < phase(8, 16));
  CHECK(phase(2, 2) < phase(1, 2));
  CHECK(phase(1, 2) < phase(1, 1));
}

TEST_CASE("patches of one row, and tiny ones", "[patch]") {
  for (const auto& [width, height] : {std::pair{100, 1}, {1, 100}, {5, 3}, {1, 1}}) {
    Patch patch({.width = width, .height = height, .tolerance = 1e-6}, [](int, int) -> Patch::Class { return 1; });
    finish(patch, width, [&](int x, int y) { return Answer{0, one(std::exp(0.01 * (x + y)))}; });
    for (int i = 0; i < width * height; ++i)
      CHECK(patch.value(i, 0) == Approx(std::exp(0.01 * (i % width + i / width))).epsilon(1e-6));
    if (width * height == 100) CHECK(patch.computed() < 30);
  }
}
