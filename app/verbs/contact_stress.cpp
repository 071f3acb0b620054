/// Random blocks and pins: drawing as TOML, judging by balances and by the normal law itself, and the counts.
#include "app/verbs/contact_stress.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis/motion/run.hpp"
#include "analysis/motion/stepped_run.hpp"
#include "analysis/motion/stepper.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "app/output/files.hpp"
#include "app/scene/scene.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verbs.hpp"
#include "core/console.hpp"
#include "core/random.hpp"
#include "core/stop.hpp"
#include "oscillators/block.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;
using analysis::motion::Run;
using Eigen::VectorXd;
using nlohmann::ordered_json;

/// Random numbers that depend on seed and index alone.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t index) : state_(splitmix(seed * splitmix_step) + index * splitmix_step) {}
  double uniform(double low, double high) { return low + (high - low) * open_unit(splitmix(state_ += splitmix_step)); }
  double decades(double from, double to) { return std::pow(10.0, uniform(from, to)); }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  template <class T, std::size_t n>
  T one_of(const T (&list)[n]) {
    return list[std::min(n - 1, std::size_t(uniform(0, double(n))))];
  }

 private:
  std::uint64_t state_;
};

/// A normal law as drawn, to be asked again by its formula.
struct DrawnLaw {
  double coefficient = 0, exponent = 1, damping = 0, separation_damping = 0, damping_exponent = 1;
  bool adhesion = false;
  std::string text = {};  ///< of normal_contact

  double pressure(double a, double rate) const {
    if (!(a > 0)) return 0;
    const double b = rate > 0 ? damping : separation_damping;
    const double p = coefficient * std::pow(a, exponent) + b * std::pow(a, damping_exponent) * rate;
    return adhesion ? p : std::max(p, 0.0);
  }
};

/// \param area  m², of the contact, which under `load` (N) gives way by `approach` and bears `mass`
DrawnLaw draw_law(Dice& dice, double load, double area, double approach, double mass) {
  DrawnLaw law;
  law.exponent = dice.one_of({1.0, 1.5, 2.0, 2.5, 3.3});
  law.coefficient = load / area / std::pow(approach, law.exponent);
  law.text = fmt::format("{{ coefficient = {:.6e}, exponent = {}", law.coefficient, law.exponent);
  if (dice.chance(0.6)) {
    const double stiffness = law.exponent * load / approach;
    law.damping_exponent = dice.chance(0.7) ? law.exponent : dice.one_of({0.0, 1.0, 3.0});
    const double all = 2 * dice.decades(-3, 0) * std::sqrt(stiffness * mass);  // N s/m
    law.damping = all / area / std::pow(approach, law.damping_exponent);
    law.separation_damping = law.damping * dice.one_of({1.0, 1.0, 0.3, 0.0});
    law.adhesion = dice.chance(0.3);
    law.text += fmt::format(", damping = {:.6e}, separation_damping = {:.6e}, damping_exponent = {}, adhesion = {}",
                            law.damping, law.separation_damping, law.damping_exponent, law.adhesion);
    if (dice.chance(0.2)) law.text += ", bound = \"pressure\"";
  } else if (dice.chance(0.3)) {
    const double of_bound = std::max(1.0, law.exponent + dice.one_of({-0.5, 0.5, 1.0}));
    law.text += fmt::format(", bound_coefficient = {:.6e}, bound_exponent = {}",
                            load / area / std::pow(approach, of_bound), of_bound);
  }
  law.text += " }";
  // As the scene's digits have them.
  const auto printed = [](double value) { return std::stod(fmt::format("{:.6e}", value)); };
  law.coefficient = printed(law.coefficient), law.damping = printed(law.damping);
  law.separation_damping = printed(law.separation_damping);
  return law;
}

struct Drawn {
  bool is_block = false;
  std::string text = {};  ///< of the scene
  DrawnLaw law;
};

/// A number of the scene, now and then one that nobody means.
struct Numbers {
  Dice& dice;
  std::string operator()(double value) {
    constexpr const char* extremes[] = {"0", "-1", "nan", "inf", "1e300", "1e-300", "-1e-9"};
    if (dice.chance(0.004)) return dice.one_of(extremes);
    const auto text = fmt::format("{:.6g}", value);
    return text;
  }
};

Drawn draw_block(Dice& dice) {
  Numbers number{dice};
  const double length = dice.decades(-3, 0), height = length * dice.decades(-1, 0.3), thickness = dice.decades(-3, 0);
  const double density = dice.decades(1, 4), E = dice.decades(5, 11.5), nu = dice.uniform(-0.3, 0.49);
  const double area = length * thickness, weight = area * dice.decades(1, 7), mass = density * area * height;
  const double approach = height * dice.decades(-8, -2);
  Drawn drawn{.is_block = true, .law = draw_law(dice, weight, area, approach, mass)};
  const double stiffness = drawn.law.exponent * weight / approach, bounce = std::sqrt(stiffness / mass);
  const double speed = approach * bounce * dice.decades(-2.5, 1.5), mu = dice.decades(-2, 0.5);
  const int elements = 1 + int(dice.uniform(0, 4)), upwards = 1 + int(dice.uniform(0, 4));
  const bool is_explicit = dice.chance(0.3), lumped = is_explicit || dice.chance(0.5);
  const double wave = std::sqrt(E * (1 - nu) / (density * (1 + nu) * (1 - 2 * nu)));
  const double step = is_explicit ? 0.4 * std::min(std::min(length / elements, height / upwards) / 4 / wave,
                                                   1 / (bounce * std::sqrt(6.0 * upwards)))
                                  : 2 * M_PI / bounce / dice.uniform(20, 200);
  const long steps = is_explicit ? 600 : 300;
  drawn.text = fmt::format(
      "[law]\ntype = \"coulomb\"\nmu_s = {0}\nmu_d = {0}\n\n[oscillator]\ntype = \"block\"\nlength = {1}\nheight = "
      "{2}\n"
      "thickness = {3}\nyoungs_modulus = {4}\npoisson_ratio = {5}\ndensity = {6}\nelements = [{7}, {8}]\n"
      "mass_matrix = \"{9}\"\nspring_stiffness = {10}\nstiffness_damping = {11}\ngauss_points = {12}\n",
      number(mu), number(length), number(height), number(thickness), number(E), number(nu), number(density), elements,
      upwards, lumped ? "lumped" : "consistent", number(stiffness * dice.decades(-5, 0)),
      number(dice.chance(0.4) ? 0 : dice.decades(-5, -1) / bounce), 1 + int(dice.uniform(0, 5)));
  drawn.text += fmt::format(
      "normal_contact = {}\n\n[drive]\nspeed = {}\nnormal_load = {}\n\n[run]\nduration = {:.6g}\nsamples = 50\n"
      "start = {{ tilt = {}, up = {} }}\n\n[solver]\nscheme = \"{}\"\nstep = {:.6g}\nsmoothing = {{ type = "
      "\"parabolic\", width = {} }}\n",
      drawn.law.text, number(speed), number(weight), double(steps) * step,
      number(approach / length * dice.decades(-2, 1)), number(dice.chance(0.5) ? 0 : approach * dice.uniform(-0.5, 2)),
      is_explicit        ? "explicit"
      : dice.chance(0.5) ? "average-acceleration"
                         : "generalised-alpha",
      step, number(speed * dice.decades(-2.5, -0.5)));
  return drawn;
}

Drawn draw_pin(Dice& dice) {
  Numbers number{dice};
  const double load = dice.decades(-0.5, 3), diameter = 5e-3 * dice.decades(-0.7, 0.7);
  const double area = M_PI * diameter * diameter / 4, mass = 4.5 * dice.decades(-1.5, 0.5);
  Drawn drawn{.law = draw_law(dice, load, area, dice.decades(-7, -4.5), mass)};
  const auto about = [&](double value, double reach) { return number(value * dice.decades(-reach, reach)); };
  const auto link = [&](double value) { return dice.chance(0.4) ? std::string("inf") : about(value, 1); };
  const std::string along = link(1.2e6), normal = about(2.057e6, 1), turning = link(600);
  const auto damper = [&](const std::string& spring, double value) {
    return spring == "inf" || dice.chance(0.3) ? std::string("0") : about(value, 1.5);
  };
  const double speed = dice.decades(-3, 1);
  drawn.text = fmt::format(
      "[law]\ntype = \"coulomb\"\nmu_s = {0}\nmu_d = {0}\n\n[oscillator]\ntype = \"pin-on-disk\"\npin_diameter = {1}\n"
      "block_mass = {2}\nblock_inertia = {3}\nlever = {4}\narm_stiffness = [{5}, {6}, {7}]\narm_damping = [{8}, {8}, "
      "0]\n"
      "pin_stiffness = [{9}, {10}, {11}]\npin_damping = [{12}, {13}, {14}]\nangle = {15}\nstations = {16}\n",
      number(dice.decades(-2, 0)), number(diameter), number(mass), about(6.9e-3, 1), about(0.03, 0.5), about(84560, 1),
      about(773900, 1), about(4325, 1), number(dice.chance(0.5) ? 0 : dice.decades(-1, 3)), along, normal, turning,
      damper(along, 100), damper(normal, 130), damper(turning, 0.01),
      number(dice.chance(0.4) ? 0 : dice.decades(-6, -2) * (dice.chance(0.5) ? 1 : -1)), dice.one_of({8, 16, 32}));
  if (dice.chance(0.3)) drawn.text += fmt::format("disk_stiffness = [inf, {}, inf]\n", about(1.5e7, 1));
  drawn.text += fmt::format(
      "normal_contact = {}\n\n[drive]\nspeed = {}\nnormal_load = {}\n\n[run]\nduration = {:.6g}\nsamples = 100\n"
      "start = {{ block_normal_velocity = {} }}\n",
      drawn.law.text, number(speed), number(load), 2 * M_PI * std::sqrt(6.9e-3 / 4325),
      number(speed * dice.decades(-3, 0.5)));
  return drawn;
}

Drawn draw(std::uint64_t seed, long index) {
  Dice dice(seed, std::uint64_t(index));
  auto drawn = dice.chance(0.5) ? draw_block(dice) : draw_pin(dice);
  drawn.text =
      fmt::format("# Drawn by: rosin stress contacts --seed {} --only {}\ntitle = \"contact {} of seed {}\"\n\n", seed,
                  index, index, seed) +
      drawn.text;
  return drawn;
}

/// What came of a scene.
struct Found {
  enum class Verdict { sound, less_exact, refused, failed, wrong, not_finite, crashed } verdict = Verdict::sound;
  std::string reason;
  double lowest_pressure = 0;  ///< over that of the load spread evenly
  bool opens = false, sticks = false, pulls = false, coarse = false;
};
using Verdict = Found::Verdict;

struct Fault {
  Verdict verdict;
  std::string reason;
};

void must_be_finite(double value, const char* what) {
  if (!std::isfinite(value)) throw Fault{Verdict::not_finite, what};
}

/// Part of what is compared, beyond which a balance is wrong.
constexpr double accuracy = 1e-6;

/// Forces of steady sliding against the load, the spring and the normal law.
void judge_steady(const scene::Scene& scene, const analysis::steady::StructureStability& found) {
  double normal = 0, friction = 0;
  for (const auto& contact : found.contacts) normal += contact.normal_load, friction += contact.friction_force;
  must_be_finite(normal + friction, "forces of steady sliding");
  for (const double q : found.coordinates) must_be_finite(q, "coordinates of steady sliding");
  for (const auto& mode : found.modes)
    must_be_finite(std::abs(mode.eigenvalue) + mode.growth_rate(), "eigenvalues of steady sliding");
  if (!scene.block) return;
  const double W = scene.model.drive.normal_load.level();
  if (std::abs(normal - W) > accuracy * W)
    throw Fault{Verdict::wrong, "the face does not bear the load in steady sliding"};
}

/// A motion by steps, at each of which stations press as the normal law says of their approach.
void judge_stations(const scene::Scene& scene, const DrawnLaw& law, Found& found) {
  const auto& structure = scene.structure->structure;
  const oscillators::StationForces contacts(structure);
  const VectorXd start = analysis::steady::steady_sliding(structure, contacts) + scene.structure->start.beside;
  const auto stepper =
      analysis::motion::make_stepper(structure, contacts, *scene.task<analysis::motion::RunOptions>().stepping, start,
                                     VectorXd::Zero(structure.size()));
  const double mean =
      scene.model.drive.normal_load.level() / (scene.block->block.length * scene.block->block.thickness);
  constexpr int steps = 100;
  for (int i = 0; i < steps; ++i) {
    if (!stepper->advance().complete()) return;  // which the run itself tells of
    const VectorXd place = contacts.rows() * stepper->coordinates(), rate = contacts.rows() * stepper->velocities();
    for (const auto& contact : contacts.contacts()) {
      const int s = contact.first;
      const double a = contacts.approach(s, place), p = -stepper->forces().value[s] / contacts.area(s);
      must_be_finite(p, "pressure");
      found.lowest_pressure = std::min(found.lowest_pressure, p / mean);
      found.opens = found.opens || a <= 0, found.pulls = found.pulls || p < 0;
      if (p < 0 && !law.adhesion) throw Fault{Verdict::wrong, "a station pulls without adhesion"};
      if (a <= 0 && p != 0) throw Fault{Verdict::wrong, "an open station presses"};
      // Approach and rate are known to the rounding of the displacements.
      const double asked = law.pressure(a, rate[s]);
      const double size = std::abs(asked) + law.coefficient * std::pow(std::abs(a), law.exponent) + 1e-12 * mean;
      if (std::abs(p - asked) > 1e-5 * size)
        throw Fault{Verdict::wrong, "a station presses otherwise than its normal law"};
    }
  }
}

/// True if each column is known to a hundredth of its largest value.
bool is_of_use(const Run& run) {
  constexpr double coarsest = 0.01;
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    double largest = 0;
    for (const double value : run.columns[c]) largest = std::max(largest, std::abs(value));
    if (!(run.column_error[c] <= coarsest * largest)) return false;
  }
  return true;
}

void judge_run(const scene::Scene& scene, const Run& run, Found& found) {
  const auto samples = std::size_t(scene.task<analysis::motion::RunOptions>().samples) + 1;
  // A record that reaches the end, with errors above the tolerance but of use, says so.
  const bool short_of = run.outcome.ending == Ending::tolerance_not_met && run.time.size() == samples && is_of_use(run);
  if (!run.outcome.complete() && !short_of) throw Fault{Verdict::failed, std::string(name(run.outcome.ending))};
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    for (const double value : run.columns[c]) must_be_finite(value, "columns of a run");
    must_be_finite(run.column_error[c], "errors of columns");
    if (run.column_names[c] == "open_fraction")
      for (const double part : run.columns[c]) found.opens = found.opens || part > 0;
    if (run.column_names[c] == "normal_load" && !scene.block)
      for (const double N : run.columns[c]) {
        found.lowest_pressure = std::min(found.lowest_pressure, N / scene.model.drive.normal_load.level());
        found.pulls = found.pulls || N < 0;
      }
  }
  for (const auto& [metric, value] : run.metrics) must_be_finite(value, "metrics of a run");
  if (scene.block && run.metrics.contains("pressure_min")) {
    const auto& block = scene.block->block;
    const double p = run.metrics.at("pressure_min");
    found.lowest_pressure =
        std::min(found.lowest_pressure, p * block.length * block.thickness / scene.model.drive.normal_load.level());
    found.pulls = found.pulls || p < 0;
  }
  for (const char* metric : {"stick_fraction", "stick_time"})
    if (run.metrics.contains(metric)) found.sticks = found.sticks || run.metrics.at(metric) > 0;
  if (short_of) throw Fault{Verdict::less_exact, run.outcome.detail};
  constexpr double open_balance = 0.01;
  if (run.metrics.contains("energy_residual")) found.coarse = run.metrics.at("energy_residual") > open_balance;
}

Found judge(const Drawn& drawn, const fs::path& file) {
  Found found;
  try {
    Request request;
    request.verb = "run", request.target = file.string();
    const auto scene = read_scene(request);
    const auto& structure = scene.structure->structure;
    constexpr int modes = 3;
    const auto steady = scene.block ? analysis::steady::lowest_modes_of_sliding(structure, modes)
                                    : analysis::steady::stability(structure);
    judge_steady(scene, steady);
    auto how = scene.task<analysis::motion::RunOptions>();
    how.tolerance = 1e-5, how.most_steps = 20'000;
    // The pin on its contact vibrates a thousand times as fast as the block on its arm.
    constexpr double most_periods = 40;
    double fastest = 0;
    for (const auto& value : steady.eigenvalues) fastest = std::max(fastest, std::abs(value.imag()));
    if (!scene.block && fastest > 0) how.duration = std::min(how.duration, most_periods * 2 * M_PI / fastest);
    if (scene.block) judge_stations(scene, drawn.law, found);
    judge_run(scene,
              scene.block ? analysis::motion::run_stepped(*scene.structure, how)
                          : analysis::motion::run_structure(*scene.structure, how),
              found);
    if (found.pulls && !drawn.law.adhesion) throw Fault{Verdict::wrong, "a contact pulls without adhesion"};
  } catch (const Fault& fault) {
    found.verdict = fault.verdict, found.reason = fault.reason;
  } catch (const InputError& error) {
    found.verdict = Verdict::refused, found.reason = error.what();
  } catch (const Stopped&) {
    throw;
  } catch (const std::exception& error) {
    found.verdict = Verdict::crashed, found.reason = error.what();
  }
  return found;
}

constexpr const char* words[] = {"sound",  "less exactly than asked", "refused", "failed", "wrong", "not finite",
                                 "crashed"};
constexpr int verdicts_in_all = std::size(words);

/// A refusal without its place and numbers, so that like ones are counted together.
std::string kind_of(const std::string& reason) {
  std::string kind;
  const auto begin = reason.rfind(".toml:");
  for (const char c : begin == std::string::npos ? reason : reason.substr(reason.find(' ', begin) + 1))
    if (std::isdigit(static_cast<unsigned char>(c)) || (c == '.' && kind.ends_with('#'))) {
      if (!kind.ends_with('#')) kind += '#';
    } else {
      kind += c;
    }
  return kind.substr(0, 110);
}

/// Counts of one type of contact.
struct Counts {
  long scenes = 0, verdicts[verdicts_in_all] = {}, lift_off = 0, stick = 0, adhesion = 0, coarse = 0;
  double lowest_pressure = 0;
  std::map<std::string, std::pair<long, long>> reasons;  ///< "failed: budget spent": how many, and the first of them

  void add(const Found& found, long index) {
    ++scenes, ++verdicts[int(found.verdict)];
    lift_off += found.opens, stick += found.sticks, adhesion += found.pulls, coarse += found.coarse;
    lowest_pressure = std::min(lowest_pressure, found.lowest_pressure);
    if (found.verdict == Verdict::sound) return;
    auto& [count, first] = reasons[fmt::format("{}: {}", words[int(found.verdict)], kind_of(found.reason))];
    if (count++ == 0) first = index;
  }
  ordered_json json() const {
    ordered_json all{{"scenes", scenes}};
    all["sound"] = verdicts[0], all["less_exact"] = verdicts[1], all["refused"] = verdicts[2];
    all["failed"] = verdicts[3], all["wrong"] = verdicts[4], all["not_finite"] = verdicts[5];
    all["crashed"] = verdicts[6];
    all["lift_off"] = lift_off, all["stick"] = stick, all["adhesion"] = adhesion;
    all["lowest_pressure"] = lowest_pressure, all["energy_residual_above_0.01"] = coarse;
    auto& list = all["reasons"] = ordered_json::object();
    for (const auto& [reason, tally] : reasons) list[reason] = {{"count", tally.first}, {"example", tally.second}};
    return all;
  }
  bool passed() const { return verdicts[4] + verdicts[5] + verdicts[6] == 0; }
};

void say(const char* what, const Counts& counts) {
  print("{}: {} scenes", what, counts.scenes);
  for (int v = 0; v < verdicts_in_all; ++v) print("{} {} {}", v == 0 ? ":" : ",", counts.verdicts[v], words[v]);
  print(
      "\n  {} lift off, {} stick, {} pull (adhesion), lowest pressure {:.3g} of that of the load; energy open by more "
      "than 1 % in {}\n",
      counts.lift_off, counts.stick, counts.adhesion, counts.lowest_pressure, counts.coarse);
  for (const auto& [reason, tally] : counts.reasons)
    print("  {:6}  {} (such as {})\n", tally.first, reason, tally.second);
}

}  // namespace

Status stress_contacts(const Request& request) {
  const fs::path folder =
      request.out.empty() ? fs::path("out") / fmt::format("stress-contacts-{}", request.seed) : fs::path(request.out);
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) throw InputError(fmt::format("--out {}: cannot be made: {}", folder.string(), problem.message()));
  const bool single = request.only >= 0;
  const long first = single ? request.only : 0, end = first + (single ? 1 : long(request.scenes));
  Counts blocks, pins;
  {
    Progress progress(request.quiet);
    for (long i = first; i < end; ++i) {
      end_if_stopped();
      const Drawn drawn = draw(request.seed, i);
      const auto file = folder / fmt::format("scene-{}.toml", i);
      write_whole(file, drawn.text);
      if (request.draw) continue;
      const Found found = judge(drawn, file);
      (drawn.is_block ? blocks : pins).add(found, i);
      if (found.verdict <= Verdict::refused && !single) fs::remove(file);
      if (found.verdict > Verdict::refused && !request.quiet && !progress.visible())
        tell("{}: {}: {}\n", file.string(), words[int(found.verdict)], found.reason);
      progress.show(std::size_t(i - first + 1), std::size_t(end - first));
    }
  }
  if (request.draw) {
    if (!request.quiet) print("{} scenes in {}\n", end - first, (folder / "").string());
    return done;
  }
  const ordered_json document{{"verb", "stress"},     {"version", ROSIN_VERSION},
                              {"seed", request.seed}, {"blocks", blocks.json()},
                              {"pins", pins.json()},  {"passed", blocks.passed() && pins.passed()}};
  const auto text = document.dump(1, ' ', false, ordered_json::error_handler_t::replace) + '\n';
  write_whole(folder / "result.json", text);
  if (request.json)
    write_output(text);
  else if (!request.quiet)
    say("blocks", blocks), say("pins", pins);
  return blocks.passed() && pins.passed() ? done : ended_short;
}

}  // namespace rosin::app::verbs
