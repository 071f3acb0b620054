/// The stated errors of a reduced block against its mesh.
#include "analysis/steady/reduction_error.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/steady/sliding_modes.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::analysis::steady;
using oscillators::FlatBlock, oscillators::Reduction;

namespace {

constexpr int followed = 3;  // the spring, bounce and pitch

StructureStability slowest(const oscillators::Structure& structure) {
  return lowest_modes_of_sliding(structure, followed);
}

Reduction reduction_at(double friction, int modes, bool damped) {
  return Reduction(FlatBlock{.damped = damped, .friction = friction}.structure(), modes);
}

Crossing critical_friction(int modes, bool damped) {
  const auto found = crossings(
      [&](double friction) {
        const auto fastest = slowest(reduction_at(friction, modes, damped).reduced).modes.front();
        return Leading{fastest.growth_rate(), fastest.error, fastest.eigenvalue.imag()};
      },
      {0.27, 0.31});
  REQUIRE(found.size() == 1);
  return found[0];
}

}  // namespace

TEST_CASE("with all modes a reduced block slides and flutters as its mesh") {
  const auto whole = FlatBlock{.elements = 2}.structure();
  const Reduction reduction(whole, 40);
  const auto mesh = stability(whole), reduced = stability(reduction.reduced);
  REQUIRE(reduced.modes.size() == mesh.modes.size());
  const auto errors = reduction_errors(reduction, reduced);
  for (const auto& mode : slowest(whole).modes) {
    const auto nearest = std::ranges::min_element(
        reduced.modes, {}, [&](const ComplexMode& other) { return std::abs(other.eigenvalue - mode.eigenvalue); });
    CHECK(std::abs(nearest->eigenvalue - mode.eigenvalue) < 1e-10);
    CHECK(errors[std::size_t(nearest - reduced.modes.begin())] < 1e-10);
  }
  for (std::size_t j = 0; j < mesh.contacts.size(); ++j)
    CHECK(reduced.contacts[j].normal_load == Approx(mesh.contacts[j].normal_load).epsilon(1e-10));
}

TEST_CASE("the stated error of a reduced block's eigenvalues covers their distance to those of the mesh") {
  const auto mesh = slowest(FlatBlock{}.structure());
  for (const int modes : {0, 2, 8, 16, 64}) {
    const auto reduction = reduction_at(0.5, modes, true);
    const auto reduced = slowest(reduction.reduced);
    const auto errors = reduction_errors(reduction, reduced);
    INFO(modes);
    for (int k = 0; k < followed; ++k) {
      const double distance = std::abs(reduced.modes[k].eigenvalue - mesh.modes[k].eigenvalue);
      CHECK(distance <= errors[k]);
      CHECK(errors[k] <= 1.01 * distance + 1e-12);
    }
  }
}

TEST_CASE("the stated error of a reduced block's critical friction covers its distance to that of the mesh", "[long]") {
  // By an independent code, and undamped by the growth that follows its root (cases/elastic-block).
  for (const auto& [damped, of_mesh] : {std::pair{true, 0.292091470}, {false, 0.290486215}})
    for (const int modes : {0, 2, 8, 16, 64}) {
      const auto found = critical_friction(modes, damped);
      const double error = reduction_error(
          found, [&](double friction) { return reduction_at(friction, modes, damped); }, slowest);
      const double distance = std::abs(found.value - of_mesh);
      INFO(damped << " " << modes << ": " << found.value << " ± " << error);
      CHECK(distance <= error + found.error + 2e-9);
      if (damped) CHECK(error < 3 * distance + 1e-8);
    }
}
