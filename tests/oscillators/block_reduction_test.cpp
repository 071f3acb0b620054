/// A reduced block against its mesh: what its face bears at rest, and all of it with all modes.
#include "oscillators/block_reduction.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "core/error.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::VectorXd;

TEST_CASE("a reduced block on springs yields to its weight and to forces on its face as its mesh does") {
  const auto whole = FlatBlock{.elements = 2}.structure();
  for (const int modes : {0, 3, 40}) {
    const Reduction reduction(whole, modes);
    const auto& reduced = reduction.reduced;
    INFO(modes);
    REQUIRE(reduced.size() == 10 + modes + (modes < 40 ? 1 : 0));  // and sinking
    const auto springs = [](const Structure& structure) {
      MatrixXd K = structure.K;
      for (const auto& contact : structure.contacts) K += contact.normal * contact.normal.transpose();
      return K.partialPivLu();
    };
    const auto of_whole = springs(whole), of_reduced = springs(reduced);
    for (std::size_t i = 0; i < whole.contacts.size(); ++i) {
      const VectorXd pulled = of_whole.solve(whole.contacts[i].tangential);
      CHECK((reduction.basis * of_reduced.solve(reduced.contacts[i].tangential) - pulled).norm() <
            1e-10 * pulled.norm());
    }
    const VectorXd sunk = of_whole.solve(whole.contacts[0].load_along);
    CHECK((reduction.basis * of_reduced.solve(reduced.contacts[0].load_along) - sunk).norm() < 1e-10 * sunk.norm());
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
