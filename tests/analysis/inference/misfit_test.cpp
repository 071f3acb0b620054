/// Misfit told from noise: records of a law that is not fitted are warned of, those of the right law are not.
#include "analysis/inference/misfit.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/inference/fit.hpp"
#include "core/random.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;
using oscillators::Model;

namespace {

Model layer(const char* law, double a, double b, double L, double stiffness) {
  auto model = tests::slider_under(law, {0.63, a, b, L, 1e-5}, tests::any_slider, 1e-5, 1);
  model.contact_stiffness.per_load = stiffness;
  return model;
}
const Model slip_law = layer("slip", 0.0072, 0.0098, 14e-6, 2100);
const std::vector<std::string> paths = {"law.mu0", "law.a", "law.b", "law.L", "law.contact_stiffness.per_load"};

/// Sliding at 10 um/s with holds of 10 s and 60 s.
Measurement holds() {
  Measurement m{Measurement::Kind::record, "holds", 0, 0, 1, {}, {}, {}};
  std::vector<double> displacement = {0};
  for (int k = 0; k < 400; ++k) {
    const double t = 0.3 * k;
    const bool rests = (t >= 15 && t < 25) || (t >= 40 && t < 100);
    m.x.push_back(t);
    displacement.push_back(displacement.back() + (rests ? 0 : 0.3e-5));
  }
  displacement.pop_back();
  m.history = {m.x, {}, std::vector<double>(m.x.size(), 1)};
  m.history.recorded = recorded_motion(m.x, displacement);
  m.history.slip_rate = m.history.recorded.after;
  return m;
}
/// Friction of a law under that motion, with noise of 3e-4 whose neighbours are correlated.
Measurement recorded(const Model& law, double correlation, std::uint64_t seed) {
  auto m = holds();
  m.y = predict(law, m).y;
  const auto independent = white_noise(m.y.size(), seed);
  double last = independent.front();
  for (std::size_t k = 0; k < m.y.size(); ++k) {
    if (k > 0) last = correlation * last + std::sqrt(1 - correlation * correlation) * independent[k];
    m.y[k] += 3e-4 * last;
  }
  return m;
}

struct Counted {
  int warned = 0, without_interval = 0;
  double cross_validation = 0;  ///< mean
};
Counted count(const Model& start, const Model& truth, double correlation, int records, int folds = 0) {
  Counted counted;
  for (int r = 1; r <= records; ++r) {
    const auto found = fit(start, {recorded(truth, correlation, std::uint64_t(r))},
                           {.parameters = paths, .starts = 1, .profiles = false, .folds = folds});
    counted.warned += found.measurements[0].misfit.has_value();
    counted.without_interval += std::isnan(found.parameters[2].low);
    counted.cross_validation += found.cross_validation / records;
  }
  return counted;
}

}  // namespace

TEST_CASE("a wrong law is warned of and gets no interval, the right one is not, whatever the noise", "[misfit]") {
  const auto wrong = fit(layer("ageing", 0.01, 0.015, 20e-6, 2000), {recorded(slip_law, 0, 1)}, {.parameters = paths});
  REQUIRE(wrong.measurements[0].misfit);
  CHECK(wrong.measurements[0].misfit->probability < 1e-6);
  CHECK(wrong.parameters[2].withheld);
  CHECK(std::isnan(wrong.parameters[2].low));
  CHECK(wrong.parameters[2].value < 0.006);  // far from 0.0098: noise was found correlated
  CHECK(wrong.measurements[0].noise.correlation > 0.3);
  REQUIRE_FALSE(wrong.warnings.empty());
  CHECK_THAT(wrong.warnings.back(), Catch::Contains("residuals are no noise"));
  for (const double correlation : {0.0, 0.6}) {
    const auto right = fit(slip_law, {recorded(slip_law, correlation, 2)}, {.parameters = paths});
    CHECK_FALSE(right.measurements[0].misfit);
    CHECK(right.warnings.empty());
    CHECK(right.parameters[2].low < 0.0098);
    CHECK(right.parameters[2].high > 0.0098);
  }
}

TEST_CASE("points left out of a right law are 1 under correlated noise too", "[misfit][long]") {
  for (const double correlation : {0.0, 0.6}) {
    const auto found = count(slip_law, slip_law, correlation, 4, 5);
    INFO(correlation);
    CHECK(found.cross_validation == Approx(1).margin(0.15));
  }
}

TEST_CASE("of 100 records of a wrong law 95 are warned of at least, of the right law few", "[misfit][.][long]") {
  constexpr int records = 100;
  for (const double correlation : {0.0, 0.5}) {
    const auto wrong = count(layer("ageing", 0.0075, 0.004, 4.5e-6, 2150), slip_law, correlation, records);
    const auto right = count(slip_law, slip_law, correlation, records, 5);
    WARN(fmt::format("correlation {}: {} of a wrong law, {} of the right law, left-out points {:.3f}", correlation,
                     wrong.warned, right.warned, right.cross_validation));
    CHECK(wrong.warned >= (correlation == 0 ? 95 : 40));  // correlated noise hides more of a misfit
    CHECK(wrong.without_interval == wrong.warned);
    CHECK(right.warned <= 2);
    CHECK(right.cross_validation == Approx(1).margin(0.05));
  }
}
