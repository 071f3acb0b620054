/// Properties of laws against closed forms, and laws adjusted to each other.
#include "analysis/inference/equalise.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::inference;

namespace {
Model under(const char* law, std::vector<Value> values) {
  Model model;
  model.law = laws::find_law(law)->with(std::move(values));
  model.drive.normal_load = 2.0;
  return model;
}
// mu0, a, b, L, v0
const std::vector<Value> usual{0.6, 0.010, 0.015, 1e-5, 1e-6};
}  // namespace

TEST_CASE("properties of rate-and-state laws are their closed forms", "[equalise]") {
  const double V = 3e-6, ratio = 10, hold = 400, L = 1e-5, a = 0.010, b = 0.015;
  for (const char* law : {"ageing", "slip"}) {
    const Model model = under(law, usual);
    CAPTURE(law);
    CHECK(value_of({"steady-friction", V}, model) == Approx(0.6 + (a - b) * std::log(3.0)).epsilon(1e-12));
    CHECK(value_of({"steady-slope", V}, model) == Approx(a - b).epsilon(1e-12));
    CHECK(value_of({"direct-effect", V}, model) == Approx(a).epsilon(1e-12));
  }
  // Slip law: mu − mu_ss = b ln(ratio) e^{−s/L}, so the area is b L ln(ratio). Ageing: w = v θ/L − 1 falls as e^{−s/L}
  // from ratio − 1, area b L ∫₀^{ratio−1} ln(1 + w)/w dw.
  CHECK(value_of({"fracture-energy", V, ratio}, under("slip", usual)) == Approx(b * L * std::log(ratio)).epsilon(1e-8));
  double area = 0;
  constexpr int panels = 20000;
  for (int i = 0; i < panels; ++i) {
    const double w = (ratio - 1) * (i + 0.5) / panels;
    area += std::log1p(w) / w * (ratio - 1) / panels;
  }
  CHECK(value_of({"fracture-energy", V, ratio}, under("ageing", usual)) == Approx(b * L * area).epsilon(1e-7));
  // At rest the ageing state grows by the hold, the slip state not at all.
  const double healed = 0.6 + a * std::log(V / 1e-6) + b * std::log((L / V + hold) * 1e-6 / L);
  CHECK(value_of({"static-peak", V, 10, hold}, under("ageing", usual)) == Approx(healed).epsilon(1e-9));
  CHECK(value_of({"static-peak", V, 10, hold}, under("slip", usual)) ==
        Approx(0.6 + (a - b) * std::log(3.0)).epsilon(1e-9));
}

TEST_CASE("laws are made equal in what is asked", "[equalise]") {
  const Model reference = under("ageing", usual), other = under("slip", {0.5, 0.02, 0.022, 3e-5, 1e-6});
  const double V = 1e-5;
  const std::vector<Property> properties{
      {"steady-friction", V}, {"steady-slope", V}, {"direct-effect", V}, {"fracture-energy", V}};
  const std::vector<std::string> adjust{"law.mu0", "law.a", "law.b", "law.L"};
  const auto equal = equalise(other, reference, properties, adjust);
  CHECK(equal.difference < 1e-9);
  for (const auto& property : properties)
    CHECK(value_of(property, equal.model) == Approx(value_of(property, reference)).epsilon(1e-9));
  // a and b are the reference's then, mu0 too; only L differs, by the ratio of the two areas.
  CHECK(equal.values[0] == Approx(0.6).epsilon(1e-8));
  CHECK(equal.values[1] == Approx(0.010).epsilon(1e-8));
  CHECK(equal.values[2] == Approx(0.015).epsilon(1e-8));
  CHECK(equal.values[3] ==
        Approx(value_of({"fracture-energy", V}, reference) / (0.015 * std::log(10.0))).epsilon(1e-8));

  // A whole curve by least squares: three branches cannot be had from two parameters of a straight one.
  const Model board = under("spinodal", laws::find_law("spinodal")->values());
  const std::vector<std::string> two{"law.mu0", "law.b"};
  const auto near = equalise(under("prz", usual), board, steady_curve(1e-7, 1e-5), two);
  CHECK(near.difference > 1e-3);
  CHECK(near.difference < 0.1);
}

TEST_CASE("what cannot be equal is refused", "[equalise]") {
  const Model ageing = under("ageing", usual), coulomb = under("coulomb", {0.4, 0.3});
  CHECK(value_of({"static-peak", 1e-3}, coulomb) == 0.4);
  CHECK_THROWS_WITH(value_of({"fracture-energy", 1e-3}, coulomb), Catch::Contains("coulomb"));
  CHECK_THROWS_WITH(value_of({"steady-slop", 1e-3}, ageing), Catch::Contains("steady-slope"));
  CHECK_THROWS_WITH(value_of({"steady-slope", 0}, ageing), Catch::Contains("slip_rate"));
  const std::vector<Property> one{{"steady-slope", 1e-5}};
  const std::vector<std::string> b{"law.b"}, mu0{"law.mu0"}, both{"law.a", "law.b"};
  CHECK_THROWS_WITH(equalise(ageing, coulomb, one, both), Catch::Contains("2 parameters"));
  // the slope does not depend on mu0
  CHECK_THROWS_WITH(equalise(under("ageing", {0.6, 0.02, 0.015, 1e-5, 1e-6}), ageing, one, mu0),
                    Catch::Contains("cannot be made equal"));
  CHECK(equalise(under("ageing", {0.6, 0.02, 0.015, 1e-5, 1e-6}), ageing, one, b).values[0] == Approx(0.025));
}
