/// `rosin bench block`: an elastic block that sticks and slides on a slow belt, rosin's steps beside CVODE.
#include "oscillators/block.hpp"

#include <cmath>

#include "analysis/motion/stepped_run.hpp"
#include "analysis/motion/stepper.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "bench/block_rivals.hpp"
#include "bench/rows.hpp"
#include "laws/catalogue.hpp"
#include "laws/smoothing.hpp"

namespace bench {
namespace {

using namespace rosin;
using analysis::motion::Scheme, analysis::motion::Stepping;
using Eigen::VectorXd;

constexpr double start_tilt = 1e-2;

/// The flat block of the docs with a lumped mass, which explicit steps need, and CVODE for a sparse Jacobian.
struct Block {
  oscillators::BlockMesh mesh;
  BlockProblem problem;
  oscillators::Structure structure;

  explicit Block(int elements) : mesh(shape(elements)) {
    const BlockProblem& p = problem;
    const laws::PowerContact contact{.coefficient = p.coefficient,
                                     .exponent = 2,
                                     .damping = p.damping,
                                     .separation_damping = p.damping,
                                     .damping_exponent = 2,
                                     .bound_coefficient = p.coefficient,
                                     .bound_exponent = 2};
    oscillators::FrictionContact like;
    like.law = laws::smoothed(laws::find_law("coulomb")->with({p.friction, p.friction}),
                              {laws::Smoothing::Type::parabolic, p.width});
    like.speed = p.speed, like.normal_load = 0.5;
    structure = oscillators::block_on_belt(mesh, {p.spring, p.stiffness_damping, laws::normal_law(contact)}, like);
  }
  VectorXd start(const oscillators::StationForces& contacts) const {
    return analysis::steady::steady_sliding(structure, contacts) + mesh.rigid(0, 0, start_tilt);
  }

 private:
  static oscillators::ElasticBlock shape(int elements) {
    oscillators::ElasticBlock block;
    block.elements = {elements, elements}, block.lumped_mass = true;
    return block;
  }
};

/// The same numbers for CVODE.
BlockProblem problem_of(const Block& block, double duration) {
  const auto& mesh = block.mesh;
  const oscillators::StationForces contacts(block.structure);
  BlockProblem p = block.problem;
  for (int i = 0; i < mesh.size(); ++i) {
    p.mass.push_back(mesh.M.coeff(i, i));
    p.row_start.push_back(int(p.column.size()));
    for (Eigen::SparseMatrix<double>::InnerIterator at(mesh.K, i); at; ++at)  // by columns, as K is symmetric
      p.column.push_back(int(at.row())), p.stiffness.push_back(at.value());
  }
  p.row_start.push_back(int(p.column.size()));
  const auto list = [](const VectorXd& values) { return std::vector<double>(values.begin(), values.end()); };
  p.spring_row = list(mesh.elongation), p.force = list(contacts.dead_load(0)), p.start = list(block.start(contacts));
  for (std::size_t k = 0; k < mesh.stations.size(); ++k) {
    auto& station = p.stations.emplace_back();
    station.area = mesh.stations[k].area;
    const int first = 2 * (int(k) / mesh.block.gauss_points);
    for (int c = 0; c < 3; ++c) {
      station.x[c] = 2 * (first + c), station.y[c] = station.x[c] + 1;
      station.shape[c] = mesh.stations[k].tangential[station.x[c]];
    }
  }
  p.from = duration / 2, p.duration = duration;
  return p;
}

/// One pass, without an error.
BlockMotion follow(const Block& block, Stepping stepping, double duration) {
  const oscillators::StationForces contacts(block.structure);
  stepping.stick_width = block.problem.width;
  const auto stepper = analysis::motion::make_stepper(block.structure, contacts, stepping, block.start(contacts),
                                                      VectorXd::Zero(block.mesh.size()));
  BlockMotion found;
  double friction = 0, load = 0;
  const long steps = std::lround(duration / stepping.step);
  for (; found.steps < steps; ++found.steps) {
    if (const auto outcome = stepper->advance(); !outcome.complete()) {
      found.failure = name(outcome.ending);
      return found;
    }
    if (found.steps < steps / 2) continue;
    for (const auto& contact : contacts.contacts()) {
      friction += stepper->forces().value[contact.slip];
      load -= stepper->forces().value[contact.first];
    }
  }
  found.friction = friction / load;
  return found;
}

/// Two passes, with averages of all kinds, their errors and the balance of energy.
BlockMotion whole_run(const Block& block, Stepping stepping, double duration) {
  analysis::motion::StructureModel model{block.structure, {}};
  model.start.beside = block.mesh.rigid(0, 0, start_tilt);
  stepping.stick_width = block.problem.width;
  analysis::motion::RunOptions options;
  options.duration = duration, options.samples = 100, options.stepping = stepping;
  const auto run = analysis::motion::run_stepped(model, options);
  BlockMotion found{.steps = run.cost.steps};
  if (!run.outcome.complete()) found.failure = name(run.outcome.ending);
  if (run.metrics.contains("apparent_friction")) found.friction = run.metrics.at("apparent_friction");
  return found;
}

}  // namespace

Record bench_block(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  Record record;
  const Block block(4);
  const double duration = settings.quick ? 20 : 600;
  const BlockProblem problem = problem_of(block, duration);
  if (const double defect = block_jacobian_defect(problem); !(defect < 1e-7))
    record.findings.push_back(fmt::format("CVODE's Jacobian differs from differences by {:.1e}", defect));

  // Errors of order 2, whose first term two steps remove.
  progress(settings, "reference");
  const double fine = settings.quick ? 0.003125 : 0.0015625;
  const double coarse = follow(block, {.step = 2 * fine}, duration).friction,
               finer = follow(block, {.step = fine}, duration).friction, truth = finer + (finer - coarse) / 3;
  const BlockMotion check = follow_cvode_block(problem, 1e-8);
  if (!(std::abs(check.friction - truth) < 5e-6))
    record.findings.push_back(fmt::format("CVODE at 1e-8 finds a mean friction of {:.8f}, rosin's finest steps {:.8f}",
                                          check.friction, truth));
  say(settings, "Mean friction over load of the second half of {} s: {:.7f} (CVODE at 1e-8: {:.7f})\n", duration, truth,
      check.friction);

  std::vector<Row> rows;
  const auto add = [&](const std::string& solver, std::vector<double> list, const auto& solve) {
    if (settings.quick) list.resize(2);
    BlockMotion found;
    const auto more = sweep(
        solver, 1, list, settings, [&](int, double tolerance) { found = solve(tolerance); },
        [&](int, Row& row) {
          row.note = fmt::format("{} steps of {:.3g} µs", found.steps, row.microseconds() / double(found.steps));
          if (found.failure.empty())
            row.errors.push_back({std::abs(found.friction - truth)});
          else
            ++row.failures[found.failure];
        });
    rows.insert(rows.end(), more.begin(), more.end());
  };
  const std::vector<double> steps = {0.1, 0.05, 0.025, 0.0125, 0.00625, 0.003125};
  const std::string implicit_steps = "rosin, average acceleration", explicit_steps = "rosin, explicit steps",
                    theirs = "CVODE BDF";
  add(implicit_steps, steps, [&](double step) { return follow(block, {.step = step}, duration); });
  add("rosin, generalised-alpha", steps,
      [&](double step) { return follow(block, {.scheme = Scheme::generalised_alpha, .step = step}, duration); });
  add("rosin, whole run", steps, [&](double step) { return whole_run(block, {.step = step}, duration); });
  add(explicit_steps, {0.0125, 0.00625, 0.003125, 0.0015625},
      [&](double step) { return follow(block, {.scheme = Scheme::explicit_steps, .step = step}, duration); });
  add(theirs, {1e-4, 1e-5, 1e-6, 1e-7}, [&](double tolerance) { return follow_cvode_block(problem, tolerance); });
  print(settings, rows, {"friction"});
  record.content["friction"] = truth;
  record.content["rows"] = as_json(rows, {"friction"});
  record.content["time_to_reach"] = times_to_reach(settings, rows, "An elastic block with short sticks");
  for (const auto& ours : {implicit_steps, explicit_steps})
    for (const double error : {1e-3, 1e-4, 3e-5, 1e-5}) {
      const auto mine = time_at(rows, ours, error), other = time_at(rows, theirs, error);
      if (*mine.relation == '>' || *other.relation == '>') continue;
      const double ratio = other.microseconds / mine.microseconds;
      record.content["cvode_over_rosin"][ours][fmt::format("{:.0e}", error)] = ratio;
      say(settings, "{} to {:.0e}: CVODE takes {}{:.3g} times as long\n", ours, error,
          *mine.relation    ? "at least "
          : *other.relation ? "up to "
                            : "",
          ratio);
    }

  say(settings, "\nOne implicit step of 0.0125 s\n{:<10} {:>10} {:>10} {:>10} {:>14}\n", "elements", "unknowns",
      "stations", "µs", "µs a station");
  for (const int elements : settings.quick ? std::vector{2, 4} : std::vector{2, 4, 8, 12}) {
    progress(settings, fmt::format("steps of {} × {} elements", elements, elements));
    const Block other(elements);
    constexpr double step = 0.0125;
    const double some = settings.quick ? 2 : 50;  // s
    const double begin = now();
    follow(other, {.step = step}, some);
    const double middle = now();
    follow(other, {.step = step}, 2 * some);
    // The difference leaves out what is done once.
    const double each = ((now() - middle) - (middle - begin)) / (some / step);
    const auto stations = other.mesh.stations.size();
    say(settings, "{0} × {0:<6} {1:>10} {2:>10} {3:>10.1f} {4:>14.2f}\n", elements, other.mesh.size(), stations,
        1e6 * each, 1e6 * each / double(stations));
    record.content["step"].push_back({{"elements", elements},
                                      {"coordinates", other.mesh.size()},
                                      {"stations", stations},
                                      {"microseconds", 1e6 * each}});
  }
  write_curves(curves, rows);
  record.panels = {{curves, "An elastic block that sticks and slides on a slow belt",
                    "true error of the mean friction over the load", "processor time (s)"}};
  return record;
}

}  // namespace bench
