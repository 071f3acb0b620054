/// SIMD elementary functions against 80-bit arithmetic, over random and special arguments.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <random>

#include "core/pack_cosine.hpp"
#include "core/pack_pair.hpp"

using namespace rosin;

namespace {

const double nan_value = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
const double tiniest = std::numeric_limits<double>::denorm_min(), least = std::numeric_limits<double>::min();
const double most = std::numeric_limits<double>::max();

/// Distance of a result from the exact value, in units in the last place of the exact value.
double ulps(double result, long double exact) {
  const double rounded = double(exact);
  if (std::isnan(rounded) || std::isnan(result)) return std::isnan(rounded) && std::isnan(result) ? 0 : inf;
  if (std::isinf(rounded) || std::isinf(result)) return rounded == result ? 0 : inf;
  const double ulp = std::max(std::nextafter(std::abs(rounded), inf) - std::abs(rounded), tiniest);
  return double(std::abs((long double)(result)-exact) / ulp);
}

/// Arguments spread over exponents (both signs), over a plain interval, and special ones.
std::vector<double> arguments(double low, double high, double least_exponent, double greatest_exponent) {
  std::mt19937_64 random(3);
  std::vector<double> list{0.0,
                           -0.0,
                           tiniest,
                           -tiniest,
                           least,
                           -least,
                           most,
                           -most,
                           inf,
                           -inf,
                           nan_value,
                           1.0,
                           -1.0,
                           0.5,
                           2.0,
                           40.0,
                           -40.0,
                           709.78,
                           710.0,
                           -745.2,
                           -708.5,
                           0.6931471805599453,
                           -0.6931471805599453,
                           0.34657359027997264,
                           1.4142135623730951,
                           0.7071067811865476,
                           1 + 2.220446049250313e-16,
                           1 - 1.1102230246251565e-16};
  std::uniform_real_distribution<double> plain(low, high), exponent(least_exponent, greatest_exponent);
  for (int i = 0; i < 200000; ++i) list.push_back(plain(random));
  for (int i = 0; i < 200000; ++i) list.push_back((i % 2 ? 1 : -1) * std::exp2(exponent(random)));
  while (list.size() % pack_width) list.push_back(1.0);
  return list;
}

struct Worst {
  double ulps = -1, at = 0, result = 0;
};
template <class Function, class Exact>
Worst worst_error(Function f, Exact exact, const std::vector<double>& x) {
  Worst worst;
  for (std::size_t i = 0; i < x.size(); i += pack_width) {
    Pack p;
    std::memcpy(&p.block, &x[i], sizeof p.block);
    const Pack y = f(p);
    for (int lane = 0; lane < pack_width; ++lane)
      if (const double e = ulps(y.block[lane], exact((long double)(x[i + lane]))); e > worst.ulps)
        worst = {e, x[i + lane], y.block[lane]};
  }
  return worst;
}

}  // namespace

TEST_CASE("pack functions are within 2 ulp of the exact value", "[core][pack]") {
  const auto check = [](Worst worst) {
    CAPTURE(worst.at, worst.result);
    CHECK(worst.ulps <= 2);
  };
  using L = long double;
  SECTION("exp") {
    check(worst_error([](const Pack& x) { return exp(x); }, [](L x) { return std::exp(x); },
                      arguments(-746, 710, -80, 12)));
  }
  SECTION("expm1") {
    check(worst_error([](const Pack& x) { return expm1(x); }, [](L x) { return std::expm1(x); },
                      arguments(-60, 60, -1070, 12)));
  }
  SECTION("log") {
    check(worst_error([](const Pack& x) { return log(x); }, [](L x) { return std::log(x); },
                      arguments(0, 3, -1073, 1023)));
  }
  SECTION("log1p") {
    check(worst_error([](const Pack& x) { return log1p(x); }, [](L x) { return std::log1p(x); },
                      arguments(-1, 3, -1073, 1023)));
  }
  SECTION("sqrt") {
    check(worst_error([](const Pack& x) { return sqrt(x); }, [](L x) { return std::sqrt(x); },
                      arguments(0, 1e6, -1073, 1023)));
  }
}

TEST_CASE("the cosine of packs is within 3e-16 of the exact value", "[core][pack]") {
  std::mt19937_64 random(4);
  double worst = 0;
  for (const double most : {1.0, 100.0, 1e7})
    for (int i = 0; i < 20'000; ++i) {
      const double x = std::uniform_real_distribution<double>(-most, most)(random);
      worst = std::max(worst, double(std::abs((long double)(cos(Pack(x)).block[0]) - std::cos((long double)x))));
    }
  CHECK(worst < 3e-16);
  CHECK(cos(Pack(0.0)).block[0] == 1);
}

TEST_CASE("pack comparisons, choices and signs act lane by lane", "[core][pack]") {
  Pack a, b;
  const double left[] = {1, -2, 0.0, -0.0, inf, -inf, nan_value, 3}, right[] = {2, -3, -0.0, 0.0, 1, 1, 1, nan_value};
  for (int i = 0; i < pack_width; ++i) a.block[i] = left[i], b.block[i] = right[i];
  const Pack chosen = select(a < b, Pack(10.0), Pack(20.0)), size = abs(a), high = max(a, b), low = min(a, b);
  for (int i = 0; i < pack_width; ++i) {
    CAPTURE(i);
    CHECK(chosen.block[i] == (left[i] < right[i] ? 10 : 20));
    CHECK(ulps(size.block[i], std::abs(left[i])) == 0);
    CHECK(ulps(high.block[i], std::max(left[i], right[i])) == 0);
    CHECK(ulps(low.block[i], std::min(left[i], right[i])) == 0);
    CHECK(ulps((-a).block[i], -left[i]) == 0);
    CHECK(ulps((a / b + a * b - a).block[i], left[i] / right[i] + left[i] * right[i] - left[i]) == 0);
  }
  CHECK_FALSE(std::signbit(abs(Pack(-0.0)).block[0]));
}

TEST_CASE("two packs side by side are two packs", "[core][pack]") {
  Pack a, b;
  for (int i = 0; i < pack_width; ++i) a.block[i] = 0.3 * i - 1.1, b.block[i] = 2.5 - 0.7 * i;
  const auto both = [](const auto& x, const auto& y) {
    const auto chosen = select((x < y) ^ !((x > y) | ((x < 0.5) & (y > 0.1))), exp(x) / expm1(y), sqrt(abs(x)));
    return max(min(chosen, log(abs(y))), -log1p(x * x)) - 2.0 * (x + y);
  };
  const PackPair pair = both(PackPair(a, b), PackPair(b, a));
  const Pack one = both(a, b), other = both(b, a);
  for (int i = 0; i < pack_width; ++i) {
    CHECK(ulps(pair.half[0].block[i], one.block[i]) == 0);
    CHECK(ulps(pair.half[1].block[i], other.block[i]) == 0);
  }
}

TEST_CASE("lanes are addressed one by one, on storage that wide loads may use", "[core][pack]") {
  Lanes lanes(1.5);
  for (int i = 0; i < lane_count; ++i) lanes.set(i, i);
  for (int i = 0; i < lane_count; ++i) CHECK(lanes[i] == i);
  STATIC_REQUIRE(alignof(Pack) == 64);
  for (std::size_t n = 1; n < 5; ++n)
    CHECK(reinterpret_cast<std::uintptr_t>(std::vector<Lanes>(n).data()) % alignof(Pack) == 0);
}
