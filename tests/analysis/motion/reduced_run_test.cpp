/// The motion of a reduced block beside that of its mesh, by the same steps.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/motion/stepped_run.hpp"
#include "analysis/steady/reduction_error.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::analysis;
using Eigen::VectorXd;

TEST_CASE("a reduced block swings as its mesh, as closely as its stated eigenvalues") {
  const oscillators::FlatBlock block{.elements = 2, .friction = 0.3};
  const auto whole = block.structure();
  const VectorXd tilted = block.mesh().rigid(0, 0, 1e-2);
  motion::RunOptions options;
  options.duration = 20, options.samples = 100;
  options.stepping = motion::Stepping{motion::Scheme::average_acceleration, 0.02};
  const auto tilt = [&](const oscillators::Structure& structure, const VectorXd& beside) {
    motion::StructureModel model{structure, {}};
    model.start.beside = beside;
    const auto run = motion::run_stepped(model, options);
    return run.columns[std::size_t(std::ranges::find(run.column_names, "tilt") - run.column_names.begin())];
  };
  const auto of_mesh = tilt(whole, tilted);
  for (const int modes : {4, 12, 40}) {
    const oscillators::Reduction reduction(whole, modes);
    const auto errors = steady::reduction_errors(reduction, steady::lowest_modes_of_sliding(reduction.reduced, 3));
    const auto of_reduced = tilt(reduction.reduced, reduction.coordinates(tilted));
    double apart = 0;
    for (std::size_t i = 0; i < of_mesh.size(); ++i) apart = std::max(apart, std::abs(of_mesh[i] - of_reduced[i]));
    // Eigenvalues that differ by δ let motions of the size a part by a δ t; the start is met to its spring's share.
    const double stated = 1e-2 * (*std::ranges::max_element(errors) * options.duration);
    INFO(modes << " modes: " << apart << " of " << stated);
    CHECK(apart <= 2 * stated + 1e-8);
  }
}
