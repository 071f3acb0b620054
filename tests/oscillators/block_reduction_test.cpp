/// A reduced block against its mesh: what its face bears at rest, and all of it with all modes.
#include "oscillators/block_reduction.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "core/error.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::VectorXd;

TEST_CASE("a reduced block yields to forces on its face as its mesh does, with any number of modes") {
  const auto whole = FlatBlock{.elements = 2}.structure();
  for (const int modes : {0, 3, 40}) {
    const Reduction reduction(whole, modes);
    const auto& reduced = reduction.reduced;
    INFO(modes);
    REQUIRE(reduced.size() == 10 + modes);
    const auto all = whole.K.fullPivLu(), few = reduced.K.fullPivLu();
    for (std::size_t i = 0; i < whole.contacts.size(); ++i)
      for (std::size_t j = 0; j < whole.contacts.size(); ++j) {
        // The spring alone holds the block along the belt; nothing holds it upwards.
        const double wanted = whole.contacts[i].tangential.dot(all.solve(whole.contacts[j].tangential));
        CHECK(reduced.contacts[i].tangential.dot(few.solve(reduced.contacts[j].tangential)) ==
              Approx(wanted).epsilon(1e-9));
      }
    for (const VectorXd& rigid :
         {reduction.coordinates(VectorXd::Unit(50, 3)), VectorXd(VectorXd::Unit(10 + modes, 3))})
      CHECK((reduction.basis * rigid)[3] == Approx(1));
  }
}

TEST_CASE("a reduced block with all modes has the kinetic energy and the rigid displacements of its mesh") {
  const FlatBlock block{.elements = 2};
  const auto mesh = block.mesh();
  const Reduction reduction(block.structure(), 40);
  const VectorXd moved = mesh.rigid(0.3, -0.2, 0.1), q = reduction.coordinates(moved);
  CHECK((reduction.basis * q - moved).norm() < 1e-12);
  CHECK(q.dot(reduction.reduced.M * q) == Approx(moved.dot(mesh.M * moved)).epsilon(1e-12));
  for (const auto& functional : reduction.reduced.functionals)
    if (functional.name == "tilt") CHECK(functional.row.dot(q) == Approx(0.1).epsilon(1e-12));
}

TEST_CASE("a block has between none and all of its interior's modes") {
  for (const int modes : {-1, 41}) CHECK_THROWS_AS(Reduction(FlatBlock{.elements = 2}.structure(), modes), InputError);
}
