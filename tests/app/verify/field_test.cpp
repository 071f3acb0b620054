/// Paths lead to the numbers of a document and to the errors that it states of them.
#include "app/verify/field.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"

using nlohmann::ordered_json;
using rosin::InputError;
using rosin::app::verify::Field;

namespace {

const ordered_json document = ordered_json::parse(R"({
  "period": 3.5, "error": {"period": 1e-9, "slip_rate": 2e-7, "multipliers": [1e-3, 2e-3]},
  "columns": {"slip_rate": [1, 4, 2, 3]}, "multipliers": [[3, -4], [0, 1]],
  "hopf": [{"parameter": "drive.speed", "value": 7, "error": {"value": 0.1}},
           {"parameter": "law.lambda", "value": 8, "error": {"value": 0.2}},
           {"parameter": "law.lambda", "value": 9, "error": {"value": 0.3}}],
  "critical": [{"value": 5, "error": 0.5}, {"value": 6, "error": 0.6}],
  "fitted": {"law.b": {"value": 2, "standard_error": 1}},
  "study": {"error": {"maximum": 3}, "last": {"maximum": 4}},
  "stable": true})");

ordered_json of(const char* path) { return Field(path).of(document); }
ordered_json error_of(const char* path) { return Field(path).error_of(document); }

}  // namespace

TEST_CASE("a path is names, entries, slices and matches, and one function around them", "[verify]") {
  CHECK(of("period") == 3.5);
  CHECK(of("stable") == true);
  CHECK(of("columns.slip_rate[-1]") == 3);
  CHECK(of("columns.slip_rate[1:3]") == ordered_json::array({4, 2}));
  CHECK(of("columns.slip_rate[-2:]") == ordered_json::array({2, 3}));
  CHECK(of("hopf[parameter=law.lambda].value") == ordered_json::array({8, 9}));
  CHECK(of("hopf[parameter=law.lambda][1].value") == 9);
  CHECK(of("count(hopf[parameter=oscillator.mass])") == 0);
  CHECK(of("fitted.\"law.b\".value") == 2);
  CHECK(of("max(columns.slip_rate)") == 4);
  CHECK(of("min(columns.slip_rate[1:])") == 2);
  CHECK(of("mean(columns.slip_rate)") == 2.5);
  CHECK(of("modulus(multipliers)") == ordered_json::array({5, 1}));
  CHECK(of("log(columns.slip_rate[1])").get<double>() == std::log(4.0));
}

TEST_CASE("the stated error of a number is the nearest under its name", "[verify]") {
  CHECK(error_of("period") == 1e-9);
  CHECK(error_of("columns.slip_rate[-1]") == 2e-7);  // of the whole column
  CHECK(error_of("max(columns.slip_rate)") == 2e-7);
  CHECK(error_of("log(columns.slip_rate[1])") == 2e-7 / 4);
  CHECK(error_of("hopf[parameter=law.lambda][1].value") == 0.3);
  CHECK(error_of("hopf[parameter=law.lambda].value") == ordered_json::array({0.2, 0.3}));
  CHECK(error_of("critical[1].value") == 0.6);
  CHECK(error_of("critical.value") == ordered_json::array({0.5, 0.6}));
  CHECK(error_of("study.error.maximum").is_null());  // a result, and none that another has an error of
  CHECK(error_of("study.last.maximum").is_null());
  CHECK(error_of("modulus(multipliers[1])") == 2e-3);
  CHECK(error_of("count(hopf)").is_null());
  CHECK(error_of("stable").is_null());
}

TEST_CASE("a path that leads nowhere says where it ends, and what there is", "[verify]") {
  using Catch::Matchers::Contains;
  CHECK_THROWS_WITH(of("columns.speed"), Contains("no 'speed'") && Contains("slip_rate"));
  CHECK_THROWS_WITH(of("columns.slip_rate[9]"), Contains("[9]") && Contains("4"));
  CHECK_THROWS_WITH(of("period[0]"), Contains("lists only"));
  CHECK_THROWS_WITH(of("max(stable)"), Contains("no number"));
  for (const char* wrong : {"", "a..b", "a[", "a[x]", "a[1:x]", "[0]b", "maximum(a)", "max(a", "a.\"b"}) {
    INFO(wrong);
    CHECK_THROWS_AS(Field(wrong), InputError);
  }
}
