/// Normal laws: their slopes, what they never do, and motion on them in closed form.
#include "laws/normal_law.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin;
using laws::normal_law;

TEST_CASE("slopes of a normal law's answer are those of differences") {
  const laws::PowerContact hertz{.coefficient = 3,
                                 .exponent = 1.5,
                                 .damping = 0.4,
                                 .separation_damping = 0.1,
                                 .damping_exponent = 2,
                                 .bound_coefficient = 3,
                                 .bound_exponent = 1.5};
  laws::PowerContact total = hertz, other_bound = hertz;
  total.bound_of_pressure = true;
  other_bound.bound_coefficient = 0.7, other_bound.bound_exponent = 2.5;
  for (const auto& law : {normal_law(hertz), normal_law(total), normal_law(other_bound),
                          normal_law(laws::LinearContact{2, 5, 0.3, true})})
    for (const double a : {0.3, 0.8})
      for (const double rate : {-0.5, 0.2}) {
        constexpr double h = 1e-6, preload = 1.5;
        const auto here = law->at(a, rate, preload), aside = law->at(a + h, rate, preload),
                   before = law->at(a - h, rate, preload), faster = law->at(a, rate + h, preload);
        INFO(law->card().name << " at " << a << ", " << rate);
        CHECK((aside.pressure - before.pressure) / (2 * h) == Approx(here.pressure_by_approach).epsilon(1e-7));
        CHECK((aside.bound - before.bound) / (2 * h) == Approx(here.bound_by_approach).epsilon(1e-7));
        CHECK((faster.pressure - here.pressure) / h == Approx(here.pressure_by_rate).margin(1e-7));
        CHECK((faster.bound - here.bound) / h == Approx(here.bound_by_rate).margin(1e-7));
      }
}

TEST_CASE("a power law: nothing where surfaces are apart, no pull unless adhesion is asked, bounds of two readings") {
  laws::PowerContact given{.coefficient = 2,
                           .exponent = 2,
                           .damping = 1,
                           .separation_damping = 1,
                           .damping_exponent = 2,
                           .bound_coefficient = 2,
                           .bound_exponent = 2};
  const auto elastic = normal_law(given);
  CHECK(elastic->at(-0.1, 5, 1).pressure == 0);
  CHECK(elastic->at(0, 5, 1).bound == 0);
  // p = 2 a² + a² ȧ falls below 0 at ȧ < −2.
  CHECK(elastic->at(0.5, -1, 1).pressure == Approx(0.25));
  CHECK(elastic->at(0.5, -3, 1).pressure == 0);
  CHECK(elastic->at(0.5, -3, 1).bound == Approx(0.5));  // of the penetration
  given.adhesion = true;
  CHECK(normal_law(given)->at(0.5, -3, 1).pressure == Approx(-0.25));
  given.bound_of_pressure = true;
  CHECK(normal_law(given)->at(0.5, -1, 1).bound == Approx(0.25));
  CHECK(normal_law(given)->at(0.5, -3, 1).bound == 0);  // what is pulled has no friction
  CHECK(elastic->approach_under(0.5) == Approx(0.5));
  CHECK(elastic->elastic_energy(0.5) == Approx(2.0 / 3 * 0.125));
  given.exponent = 0.5;
  CHECK_THROWS_WITH(normal_law(given), Catch::Contains("exponent"));
}

TEST_CASE("a linear contact lifts off about its preload") {
  const auto law = normal_law(laws::LinearContact{2, 0, 0, true}),
             both = normal_law(laws::LinearContact{2, 0, 0, false});
  CHECK(law->at(-0.4, 0, 1).pressure == Approx(0.2));
  CHECK(law->at(-0.6, 0, 1).pressure == 0);
  CHECK(law->at(-0.6, 0, 1).pressure_by_approach == 0);
  CHECK(both->at(-0.6, 0, 1).pressure == Approx(-0.2));
}
