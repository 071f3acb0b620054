/// The study of force algorithms: random oscillators that any machine draws alike, and counts found independently.
#include "analysis/studies/study.hpp"

#include <catch2/catch.hpp>

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::studies;

TEST_CASE("sticking cases and errors of a study are those of an independent implementation", "[study][long]") {
  // The first hundred of the thousand oscillators of seed 1; the whole thousand in docs/stick-slip-study.md.
  StudyOptions options;
  options.cases = 100;
  options.threads = 2;
  const auto result = study(options);
  REQUIRE(result.algorithms.size() == 4);
  CHECK(result.cases[0].inputs[0] == Approx(1.5355065760501305).epsilon(1e-15));
  const auto &window = result.algorithms[0], &revised = result.algorithms[1], &aabg = result.algorithms[2],
             &tr = result.algorithms[3];
  CHECK(window.sticking_cases > revised.sticking_cases);
  CHECK(window.alone > 0);
  CHECK(revised.sticking_cases >= aabg.sticking_cases);
  CHECK(aabg.sticking_cases == tr.sticking_cases);
  CHECK(window.smallest_error.maximum <= 0.25);  // by the choice of its window
  CHECK(window.smallest_error.median > revised.smallest_error.median);
  CHECK(revised.smallest_error.median > 10 * tr.smallest_error.median);
  REQUIRE(tr.weibull);
  CHECK(window.weibull->likelihood.fit.shape < -2);
  CHECK(revised.weibull->likelihood.fit.shape > tr.weibull->likelihood.fit.shape);
  // Spring and damper hold the mass; force balance lets it drift.
  CHECK(tr.drift.mean < 0.1 * revised.drift.mean);
  CHECK(result.shown.size() == 5);
  options.threads = 1;
  options.cases = 10;
  const auto few = study(options);
  for (int i = 0; i < 10; ++i)
    CHECK(few.cases[i].motions[3].smallest_error == result.cases[i].motions[3].smallest_error);
}

TEST_CASE("studies refuse what has no meaning", "[study]") {
  StudyOptions options;
  options.algorithms = {"tr-sdmf"};
  CHECK_THROWS_WITH(study(options), Catch::Contains("did you mean 'tr-sdfm'?"));
  options.algorithms = {"tr-sdfm"};
  options.start_factor = 0.5;
  CHECK_THROWS_WITH(study(options), Catch::Contains("study.start_factor"));
}
