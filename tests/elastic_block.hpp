/// The flat block on a belt that the tests of elastic blocks share: mass 1, stiffness of the contact 1, weight 1/2.
#pragma once
#include "laws/catalogue.hpp"
#include "laws/smoothing.hpp"
#include "oscillators/block.hpp"

namespace rosin::oscillators {

struct FlatBlock {
  int elements = 4;
  bool lumped = false, damped = true;
  double youngs_modulus = 20, friction = 0.5, speed = 1, width = 0.01;

  BlockMesh mesh() const {
    ElasticBlock block;
    block.elements = {elements, elements};
    block.lumped_mass = lumped, block.youngs_modulus = youngs_modulus;
    return BlockMesh(block);
  }
  Structure structure() const {
    laws::PowerContact contact{.coefficient = 0.25, .exponent = 2, .bound_coefficient = 0.25, .bound_exponent = 2};
    if (damped) contact.damping = contact.separation_damping = 0.01, contact.damping_exponent = 2;
    FrictionContact like;
    like.law = laws::smoothed(laws::find_law("coulomb")->with({friction, friction}),
                              {laws::Smoothing::Type::parabolic, width});
    like.speed = speed, like.normal_load = 0.5;
    return block_on_belt(mesh(), {0.05, damped ? 1e-3 : 0, laws::normal_law(contact)}, like);
  }
};

}  // namespace rosin::oscillators
