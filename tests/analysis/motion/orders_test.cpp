/// Orders of convergence of the elastic block: steps, elements, and points of the face, as docs/block.md has them.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/motion/stepper.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using namespace rosin::oscillators;
using Eigen::VectorXd;

namespace {

/// The tilt at a time, and the mean friction over the mean load until then.
struct Found {
  double tilt = 0, friction = 0;
};
Found after(const FlatBlock& block, double tilt, double time, const Stepping& stepping) {
  const auto structure = block.structure();
  const auto mesh = block.mesh();
  const StationForces contacts(structure);
  const VectorXd start = analysis::steady::steady_sliding(structure, contacts) + mesh.rigid(0, 0, tilt);
  const auto stepper = make_stepper(structure, contacts, stepping, start, VectorXd::Zero(structure.size()));
  const auto forces = [&] {
    Eigen::Vector2d sum(0, 0);
    for (const auto& contact : contacts.contacts())
      sum += Eigen::Vector2d(stepper->forces().value[contact.slip], -stepper->forces().value[contact.first]);
    return sum;
  };
  Eigen::Vector2d sum = forces() / 2;
  const long steps = std::lround(time / stepping.step);
  for (long i = 0; i < steps; ++i) {
    REQUIRE(stepper->advance().complete());
    sum += (i + 1 == steps ? 0.5 : 1.0) * forces();
  }
  return {mesh.tilt.dot(stepper->coordinates()), sum[0] / sum[1]};
}

double order(double coarse, double middle, double fine) {
  return std::log2(std::abs((coarse - middle) / (middle - fine)));
}

}  // namespace

TEST_CASE("steps of each scheme converge with the second power of their length, and to the same motion") {
  constexpr double time = 8;
  const FlatBlock block{.lumped = true};
  std::vector<double> limits;
  for (const auto& [scheme, step] : {std::pair{Scheme::average_acceleration, 0.02},
                                     {Scheme::generalised_alpha, 0.02},
                                     {Scheme::explicit_steps, 0.01}}) {
    std::vector<double> tilt;
    for (const double part : {1.0, 0.5, 0.25}) tilt.push_back(after(block, 0.05, time, {scheme, part * step}).tilt);
    INFO("scheme " << int(scheme));
    CHECK(order(tilt[0], tilt[1], tilt[2]) == Approx(2).margin(0.1));
    limits.push_back(tilt[2] + (tilt[2] - tilt[1]) / 3);
  }
  for (const double limit : limits) CHECK(limit == Approx(limits.front()).margin(2e-7));
}

TEST_CASE("mean friction through stick converges, and to the same value by implicit and explicit steps") {
  const FlatBlock block{.lumped = true, .speed = 0.1, .width = 0.005};
  std::vector<double> limits;
  for (const Scheme scheme : {Scheme::average_acceleration, Scheme::explicit_steps}) {
    std::vector<double> friction;
    for (const double step : {0.0125, 0.00625, 0.003125, 0.0015625})
      friction.push_back(after(block, 0.3, 20, {scheme, step}).friction);
    CHECK(friction.back() < 0.48);  // it sticks
    INFO("scheme " << int(scheme));
    CHECK(order(friction[1], friction[2], friction[3]) > 1);  // kinks of smoothed friction lie anywhere in a step
    limits.push_back(friction.back());
  }
  CHECK(limits[0] == Approx(limits[1]).margin(1e-5));
}

TEST_CASE("steady sliding of a block converges with its elements, and at once with the points of its face") {
  const auto sinking = [](int elements, int points) {
    ElasticBlock block;
    block.elements = {elements, elements}, block.gauss_points = points;
    const BlockMesh mesh(block);
    FlatBlock like;
    const laws::PowerContact contact{
        .coefficient = 0.25, .exponent = 2, .bound_coefficient = 0.25, .bound_exponent = 2};
    FrictionContact of = like.structure().contacts.front();
    const auto structure = block_on_belt(mesh, {0.05, 0, laws::normal_law(contact)}, of);
    const StationForces contacts(structure);
    return mesh.centre_y.dot(analysis::steady::steady_sliding(structure, contacts));
  };
  // Tractions end at the lower corners: the order is that of the stress there, not that of the elements.
  std::vector<double> found;
  for (const int elements : {1, 2, 4, 8}) found.push_back(sinking(elements, 4));
  CHECK(order(found[0], found[1], found[2]) > 2.3);
  CHECK(order(found[1], found[2], found[3]) > 2.3);
  CHECK(found[2] == Approx(found[3]).margin(3e-7));
  const double exact = sinking(4, 8);
  CHECK(std::abs(sinking(4, 1) - exact) > 1e-5);
  CHECK(std::abs(sinking(4, 2) - exact) < 1e-6);
  CHECK(std::abs(sinking(4, 3) - exact) < 1e-10);
}
