/// Run time against true error for one cycle and for a plane: rosin, CVODE, Boost.odeint and SciPy, in one run.
///
/// Times are processor time of one thread, minima over repetitions. Errors are against a reference that two integrators
/// agree on. Prints tables; --json FILE keeps everything and draws FILE's picture beside it.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "analysis/map.hpp"
#include "analysis/return_map.hpp"
#include "bench/rivals.hpp"
#include "tests/bristol_board.hpp"

namespace {

using namespace bench;
using nlohmann::json;
using rosin::analysis::find_cycle;
using rosin::oscillators::Model;
using rosin::tests::bristol_board;

constexpr const char* whole_map = "rosin, whole map";

double now() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// A point of the plane with what is known to be true there.
struct Truth {
  double N, lambda;
  Reading value;
  double loop_size;  ///< slip_rate_max · friction_max
  Reading error;     ///< claimed by the reference
  Start section;     ///< a point of the cycle
  Problem problem() const {
    Problem p;
    p.N = N, p.lambda = lambda;
    return p;
  }
  Model model() const { return bristol_board(N / rosin::tests::gravity, lambda); }
};

struct Errors {
  double period, stick, loop;
  double worst() const { return std::max({period, stick, loop}); }
};
Errors errors_of(const Reading& r, const Truth& t) {
  return {std::abs(r.period / t.value.period - 1), std::abs(r.stick_fraction - t.value.stick_fraction),
          std::abs(r.loop_area - t.value.loop_area) / t.loop_size};
}

/// One solver at one tolerance.
struct Row {
  std::string solver;
  double tolerance;
  double seconds = 0;  ///< of all points, failures included
  int asked = 0, tried = 0, understated = 0;
  std::vector<Errors> errors = {};
  std::map<std::string, int> failures = {};
  std::string note = {};

  int failed() const {
    int n = 0;
    for (const auto& [why, count] : failures) n += count;
    return n;
  }
  double microseconds() const { return 1e6 * seconds / std::max(1, tried); }
  double quantile(double q, double (*of)(const Errors&)) const {
    if (errors.empty()) return NAN;
    std::vector<double> e;
    for (const auto& x : errors) e.push_back(of(x));
    std::sort(e.begin(), e.end());
    return e[std::min(e.size() - 1, std::size_t(std::ceil(q * double(e.size())) - (q > 0 ? 1 : 0)))];
  }
  /// The error by which solvers are compared: nine points in ten are better, in all three readings.
  double error() const {
    return std::max(1e-15, quantile(0.9, [](const Errors& e) { return e.worst(); }));
  }
  void take(const Reading& r, const Truth& truth) {
    ++tried;
    const bool wrong = r.failure.empty() && r.steady;
    if (!r.failure.empty() || wrong)
      ++failures[wrong ? "called steady, but a cycle exists" : r.failure];
    else
      errors.push_back(errors_of(r, truth));
  }
};

using Solve = std::function<Reading(const Truth&, double tolerance)>;

Reading reading_of(const rosin::analysis::Metrics& m) {
  Reading r;
  r.period = m.period, r.stick_fraction = m.stick_fraction, r.loop_area = m.loop_area;
  return r;
}

Reading rosin_cycle(const Truth& at, double tolerance) {
  const auto cycle = find_cycle(at.model(), {.tolerance = tolerance, .multipliers = false});
  Reading r = reading_of(cycle.metrics);
  if (!cycle.outcome.complete())
    r.failure = cycle.outcome.ending == rosin::Ending::tolerance_not_met ? "says that the tolerance is not met"
                                                                         : cycle.outcome.detail;
  return r;
}

/// rosin's integrator without Newton's method: passages until two successive ones agree, as the rivals do.
Reading rosin_transient(const Truth& at, double tolerance) {
  rosin::analysis::ReturnMap map(at.model());
  auto y = map.stick(map.drive_speed());
  Reading r;
  const Problem problem = at.problem();
  Passage last{};
  while (true) {
    const auto passage = map.follow(y, tolerance, 1, r.passages > 0);
    ++r.passages;
    if (!passage.outcome.complete()) {
      r.failure = passage.outcome.detail;
      return r;
    }
    y = passage.end;
    const auto seen = map.system().observe(0, y.data());
    const Passage current{passage.duration, seen.displacement, seen.state[0]};
    if (r.passages > 2 && agrees(problem, current, last, tolerance)) break;
    if (r.passages >= most_passages) {
      r.failure = "not settled in 200 passages";
      return r;
    }
    last = current;
  }
  rosin::analysis::Recorder recorder(map.system(), tolerance, 0.1, false);
  const auto passage = map.follow(y, tolerance, 1, true, false, &recorder);
  const int passages = r.passages + 1;
  r = reading_of(recorder.finish(passage.duration));
  r.passages = passages;
  if (!passage.outcome.complete()) r.failure = passage.outcome.detail;
  return r;
}

struct Settings {
  bool quick = false;
  double limit = 60;  ///< s for all tolerances of one solver, repetitions not counted
  std::string python = "/usr/bin/python3", json_file;
};

/// Solves all points at one tolerance, several times where that is quick, and keeps the shortest time.
Row solve_all(const std::string& name, const Solve& solve, const std::vector<Truth>& points, double tolerance,
              const Settings& settings) {
  Row best;
  for (int repetition = 0;; ++repetition) {
    Row row{.solver = name, .tolerance = tolerance};
    row.asked = int(points.size());
    const double begin = now();
    std::vector<Reading> readings;
    for (const auto& at : points) {
      readings.push_back(solve(at, tolerance));
      if (now() - begin > settings.limit) break;
    }
    row.seconds = now() - begin;
    for (std::size_t i = 0; i < readings.size(); ++i) row.take(readings[i], points[i]);
    if (row.tried < row.asked) row.note = fmt::format("time limit: {} of {} points", row.tried, row.asked);
    if (repetition == 0 || row.seconds < best.seconds) best = row;
    const int most = settings.quick ? 1 : row.seconds < 0.05 ? 20 : row.seconds < 1 ? 5 : row.seconds < 6 ? 3 : 1;
    if (repetition + 1 >= most) return best;
  }
}

/// Sweeps tolerances; leaves those out that would exceed the limit.
std::vector<Row> sweep(const std::string& name, const Solve& solve, const std::vector<Truth>& points,
                       const std::vector<double>& tolerances, const Settings& settings) {
  std::vector<Row> rows;
  double spent = 0;
  for (const double tolerance : tolerances) {
    fmt::print(stderr, "{}, {} points, {:.0e}\n", name, points.size(), tolerance);
    if (const std::size_t n = rows.size(); n >= 2) {
      const double expected = rows[n - 1].seconds * std::max(1.0, rows[n - 1].seconds / rows[n - 2].seconds);
      if (spent + expected > settings.limit) {
        rows.back().note += fmt::format("{}left out: {:.0e} and below, which would take {:.0f} s",
                                        rows.back().note.empty() ? "" : "; ", tolerance, expected);
        break;
      }
    }
    rows.push_back(solve_all(name, solve, points, tolerance, settings));
    spent += rows.back().seconds;
  }
  return rows;
}

std::string run_and_read(const std::string& command) {
  std::string text;
  if (FILE* pipe = popen(command.c_str(), "r")) {
    char buffer[256];
    while (fgets(buffer, sizeof buffer, pipe)) text += buffer;
    if (pclose(pipe) != 0) text.clear();
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// The SciPy rivals, in one Python process for each method.
class SciPy {
 public:
  explicit SciPy(const Settings& settings) : settings_(settings) {
    version_ = run_and_read(settings.python + " -c 'import scipy; print(scipy.__version__)' 2>/dev/null");
  }
  bool found() const { return !version_.empty(); }
  const std::string& version() const { return version_; }
  std::vector<Row> sweep(const std::string& method, const std::vector<Truth>& points,
                         const std::vector<double>& tolerances, int repetitions) const {
    const auto folder = std::filesystem::temp_directory_path();
    const auto job = (folder / fmt::format("rosin-bench-{}.json", getpid())).string(), answer = job + ".out";
    json request{
        {"method", method}, {"tolerances", tolerances}, {"limit", settings_.limit}, {"repetitions", repetitions}};
    request["points"] = json::array();
    for (const auto& p : points) request["points"].push_back({p.N, p.lambda});
    std::ofstream(job) << request;
    const auto command =
        fmt::format("OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 {} '{}/scipy_rivals.py' '{}' '{}' >/dev/null 2>&1",
                    settings_.python, BENCH_FOLDER, job, answer);
    fmt::print(stderr, "SciPy {}, {} points\n", method, points.size());
    const int status = std::system(command.c_str());
    std::vector<Row> rows;
    if (status == 0) {
      const json result = json::parse(std::ifstream(answer));
      for (const auto& r : result["rows"]) {
        Row row{.solver = "SciPy " + method, .tolerance = r["tolerance"]};
        row.asked = int(points.size());
        for (std::size_t i = 0; i < r["points"].size(); ++i) {
          const auto& p = r["points"][i];
          Reading reading;
          reading.failure = p["failure"];
          if (reading.failure.empty())
            reading.period = p["period"], reading.stick_fraction = p["stick_fraction"],
            reading.loop_area = p["loop_area"], reading.steady = p["steady"];
          row.seconds += p["seconds"].get<double>();
          row.take(reading, points[i]);
        }
        if (row.tried < row.asked) row.note = fmt::format("time limit: {} of {} points", row.tried, row.asked);
        rows.push_back(row);
      }
    }
    std::filesystem::remove(job);
    std::filesystem::remove(answer);
    return rows;
  }

 private:
  const Settings& settings_;
  std::string version_;
};

/// rosin's plane as a user asks for it, on one thread. Points in the order of the map.
struct Plane {
  rosin::analysis::Map map;
  double seconds = 0, cycle_seconds = 0, stable_seconds = 0;
  std::vector<double> point_seconds;
};
Plane compute_plane(int points, double tolerance) {
  Plane plane;
  rosin::analysis::MapOptions options;
  options.x = rosin::analysis::make_axis("drive.normal_load", 9.81e-8, 9.81, points, true, {});
  options.y = rosin::analysis::make_axis("law.lambda", 1e-4, 1e2, points, true, {});
  options.metrics = {"stick_fraction", "loop_area"};
  options.tolerance = tolerance;
  options.threads = 1;
  rosin::analysis::MapHooks hooks;
  const double begin = now();
  double last = begin;
  hooks.finished = [&](std::size_t, const rosin::analysis::MapPoint& point) {
    const double t = now();
    const bool cycle = point.regime != rosin::analysis::Regime::stable;
    (cycle ? plane.cycle_seconds : plane.stable_seconds) += t - last;
    last = t;
  };
  plane.map = rosin::analysis::compute_map(bristol_board(1, 1), options, hooks);
  plane.seconds = now() - begin;
  return plane;
}
bool has_cycle(const rosin::analysis::MapPoint& p) {
  return p.regime == rosin::analysis::Regime::cycle || p.regime == rosin::analysis::Regime::bistable;
}

Truth truth_of(const Model& model, double tolerance) {
  const auto cycle = find_cycle(model, {.tolerance = tolerance});
  const auto& m = cycle.metrics;
  Truth t{model.drive.normal_load.level(),
          model.lambda,
          reading_of(m),
          m.slip_rate_max * m.friction_max,
          reading_of(cycle.error),
          {cycle.section_displacement, model.drive.speed.level(), 0}};
  if (!cycle.section_state.empty()) t.section.psi = cycle.section_state[0];
  if (!cycle.outcome.complete()) t.value.failure = cycle.outcome.detail;
  return t;
}

/// Reads as a table: one line a row.
void print(const std::vector<Row>& rows, bool plane) {
  fmt::print("{:<28} {:>6} {:>10} {:>11}   {:<27} {:<27} {}\n", "solver", "tol", "seconds", plane ? "us/point" : "us",
             plane ? "period error: median 90% max" : "period, stick, loop error",
             plane ? "worst of three: median 90% max" : "", "failures");
  for (const auto& r : rows) {
    const auto three = [&](double (*of)(const Errors&)) {
      return fmt::format("{:8.1e} {:8.1e} {:8.1e}", r.quantile(0.5, of), r.quantile(0.9, of), r.quantile(1, of));
    };
    std::string errors, worst;
    if (plane) {
      errors = three([](const Errors& e) { return e.period; });
      worst = three([](const Errors& e) { return e.worst(); });
    } else if (!r.errors.empty()) {
      errors = fmt::format("{:8.1e} {:8.1e} {:8.1e}", r.errors[0].period, r.errors[0].stick, r.errors[0].loop);
    }
    fmt::print("{:<28} {:6.0e} {:10.4g} {:11.1f}   {:<27} {:<27} {}/{} {}\n", r.solver, r.tolerance, r.seconds,
               r.microseconds(), errors, worst, r.failed(), r.tried, r.note);
    for (const auto& [why, n] : r.failures) fmt::print("{:<28}   {} x {}\n", "", n, why);
    if (r.understated > 0) fmt::print("{:<28}   {} points outside the error that it states\n", "", r.understated);
  }
  std::fflush(stdout);
}

/// Time of a solver at an error, from its curve of best points, interpolated in logarithms.
struct AtError {
  double microseconds;
  const char* relation;  ///< "": interpolated; "<": even its loosest result is better; ">": not reached
};
AtError time_at(std::vector<Row> rows, double error) {
  std::vector<std::pair<double, double>> curve;  // falling error, rising time
  std::erase_if(rows, [](const Row& r) { return r.errors.empty() || r.failed() > 0.1 * r.tried || r.tried < r.asked; });
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.microseconds() < b.microseconds(); });
  for (const auto& r : rows)
    if (curve.empty() || r.error() < curve.back().first) curve.emplace_back(r.error(), r.microseconds());
  if (curve.empty()) return {NAN, ">"};
  if (error > curve.front().first) return {curve.front().second, "<"};
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const auto [e0, t0] = curve[i - 1];
    const auto [e1, t1] = curve[i];
    if (error < e1) continue;
    const double w = std::log(error / e0) / std::log(e1 / e0);
    return {t0 * std::pow(t1 / t0, w), ""};
  }
  return {curve.back().second, error == curve.back().first ? "" : ">"};
}

/// Time in which each solver reaches an error, from its best tolerances.
json times_to_reach(const std::vector<Row>& rows, const char* what) {
  std::vector<std::string> solvers;
  for (const auto& r : rows)
    if (std::find(solvers.begin(), solvers.end(), r.solver) == solvers.end()) solvers.push_back(r.solver);
  const std::vector<double> errors = {1e-3, 1e-4, 1e-6, 1e-8, 1e-10};
  fmt::print(
      "\n{}: milliseconds to reach an error (<: the loosest tolerance is better already; -: not reached, or more "
      "than one point in ten fails)\n  {:<28}",
      what, "");
  for (const double e : errors) fmt::print(" {:>9.0e}", e);
  json list = json::array();
  for (const auto& solver : solvers) {
    std::vector<Row> its;
    for (const auto& r : rows)
      if (r.solver == solver) its.push_back(r);
    fmt::print("\n  {:<28}", solver);
    for (const double e : errors) {
      const auto at = time_at(its, e);
      const bool reached = *at.relation != '>';
      fmt::print(" {:>9}", reached ? fmt::format("{}{:.2f}", at.relation, 1e-3 * at.microseconds) : "-");
      if (reached)
        list.push_back(
            {{"solver", solver}, {"error", e}, {"relation", at.relation}, {"microseconds", at.microseconds}});
    }
  }
  fmt::print("\n");
  return list;
}

json ratios(const std::vector<Row>& rows, const std::string& yardstick, const char* what) {
  std::vector<std::string> solvers;
  const Row* ours = nullptr;
  for (const auto& r : rows) {
    if (std::find(solvers.begin(), solvers.end(), r.solver) == solvers.end()) solvers.push_back(r.solver);
    if (r.solver == yardstick && std::abs(r.tolerance / 1e-6 - 1) < 1e-9) ours = &r;
  }
  json list = json::array();
  if (!ours) return list;
  fmt::print("\n{}: time over that of {} at tolerance 1e-6, which reaches {:.1e} in {:.1f} us\n", what, yardstick,
             ours->error(), ours->microseconds());
  for (const auto& solver : solvers) {
    if (solver == yardstick) continue;
    std::vector<Row> its;
    double best = INFINITY;
    for (const auto& r : rows)
      if (r.solver == solver) {
        its.push_back(r);
        if (!r.errors.empty()) best = std::min(best, r.error());
      }
    const auto at = time_at(its, ours->error());
    const double ratio = at.microseconds / ours->microseconds();
    fmt::print("  {:<28} {:>1} {:8.1f}{}\n", solver, at.relation, ratio,
               *at.relation == '>' ? fmt::format("   (does not reach it without failures; best {:.1e})", best) : "");
    list.push_back({{"solver", solver}, {"relation", at.relation}, {"ratio", ratio}});
  }
  return list;
}

json as_json(const std::vector<Row>& rows) {
  json list = json::array();
  for (const auto& r : rows) {
    const auto three = [&](double (*of)(const Errors&)) {
      return json{r.quantile(0.5, of), r.quantile(0.9, of), r.quantile(1, of)};
    };
    list.push_back({{"solver", r.solver},
                    {"tolerance", r.tolerance},
                    {"seconds", r.seconds},
                    {"microseconds_per_point", r.microseconds()},
                    {"asked", r.asked},
                    {"tried", r.tried},
                    {"failures", r.failures},
                    {"note", r.note},
                    {"outside_stated_error", r.understated},
                    {"period_error", three([](const Errors& e) { return e.period; })},
                    {"stick_fraction_error", three([](const Errors& e) { return e.stick; })},
                    {"loop_area_error", three([](const Errors& e) { return e.loop; })},
                    {"worst_error", three([](const Errors& e) { return e.worst(); })}});
  }
  return list;
}

/// Curves for gnuplot: one block a solver, "error microseconds tolerance".
void write_curves(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::ofstream out(file);
  std::string solver;
  const bool plane = !rows.empty() && rows.front().solver == whole_map;
  for (const auto& r : rows) {
    if (plane && r.solver == "rosin") continue;  // in the picture, rosin's plane is the map
    if (r.solver != solver)
      out << (solver.empty() ? "" : "\n\n") << "# " << (r.solver == whole_map ? "rosin" : r.solver) << ";\n";
    solver = r.solver;
    if (!r.errors.empty() && r.tried == r.asked && r.failed() <= 0.1 * r.tried)
      out << fmt::format("{:.4e} {:.4e} {:.0e}\n", r.error(), 1e-6 * r.microseconds(), r.tolerance);
  }
}

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

int run(const Settings& settings) {
  json record;
  const auto date = fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr)));
  const SciPy scipy(settings);
  record["date"] = date;
  record["machine"] = {{"processor", processor()},
                       {"compiler", "gcc " __VERSION__},
                       {"build", BUILD_FLAGS},
                       {"scipy", scipy.found() ? scipy.version() : "none"}};
  record["machine"]["threads"] = 1;
  fmt::print("{} · {} · gcc {} · {} · SciPy {}\n", date, processor(), __VERSION__, BUILD_FLAGS,
             scipy.found() ? scipy.version() : "not found, left out");
  std::vector<std::string> findings;
  if (const double defect = jacobian_defect(); defect > 1e-5)
    findings.push_back(fmt::format("the rivals' Jacobians differ from differences by {:.1e}", defect));

  const auto tolerances = [&](int first, int last) {
    std::vector<double> list;
    for (int e = first; e <= last; e += settings.quick ? 3 : 1) list.push_back(std::pow(10.0, -e));
    return list;
  };
  const std::vector<std::pair<std::string, Solve>> solvers = {
      {"rosin", rosin_cycle},
      {"rosin, transient only", rosin_transient},
      {"CVODE", [](const Truth& t, double r) { return run_cvode<Natural>(t.problem(), r, near_stick(t.problem())); }},
      {"CVODE, good variables",
       [](const Truth& t, double r) { return run_cvode<Good>(t.problem(), r, near_stick(t.problem())); }},
      {"odeint rosenbrock4",
       [](const Truth& t, double r) { return run_rosenbrock<Natural>(t.problem(), r, near_stick(t.problem())); }},
      {"odeint, good variables",
       [](const Truth& t, double r) { return run_rosenbrock<Good>(t.problem(), r, near_stick(t.problem())); }},
  };

  // One cycle: Fig 1 of Woodhouse, Putelat & McKay (2015).
  const Truth one = truth_of(bristol_board(1e-4, 10), 1e-12);
  constexpr double published = 22.58705579716;  // independent shooting, all digits sure
  if (std::abs(one.value.period - published) > 1e-11 + one.error.period)
    findings.push_back(fmt::format("period {:.14g} s is not {:.14g} s", one.value.period, published));
  fmt::print("\nOne cycle: N = 1e-4 m g, lambda = 10; period {:.13g} s (independent: {:.13g})\n", one.value.period,
             published);
  std::vector<Row> rows;
  const auto append = [](std::vector<Row>& to, const std::vector<Row>& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  for (const auto& [name, solve] : solvers)
    append(rows, sweep(name, solve, {one}, tolerances(3, settings.quick ? 6 : 11), settings));
  if (scipy.found())
    for (const char* method : {"Radau", "LSODA"})
      append(rows, scipy.sweep(method, {one}, tolerances(3, settings.quick ? 3 : 11), settings.quick ? 1 : 3));
  print(rows, false);
  record["cycle"] = {
      {"reference_period", one.value.period}, {"independent_period", published}, {"rows", as_json(rows)}};
  if (!settings.quick) record["cycle"]["time_to_reach"] = times_to_reach(rows, "One cycle");
  if (!settings.quick) record["cycle"]["ratios"] = ratios(rows, "rosin", "One cycle");

  // The plane.
  const int points = settings.quick ? 4 : 12;
  const auto survey = compute_plane(points, 1e-4);
  std::vector<Truth> cycles, stable;
  std::vector<std::size_t> index;
  int short_of_tolerance = 0;
  double largest = 0, largest_period = 0, at_N = 0, at_lambda = 0;
  int beyond = 0, unchecked = 0;
  std::map<std::string, int> unchecked_because;
  for (std::size_t i = 0; i < survey.map.points.size(); ++i) {
    const double N = survey.map.x.values[i % points], lambda = survey.map.y.values[i / points];
    const Model model = bristol_board(N / rosin::tests::gravity, lambda);
    if (!has_cycle(survey.map.points[i])) {
      if (survey.map.points[i].regime == rosin::analysis::Regime::failed)
        findings.push_back(
            fmt::format("no regime at N = {:.4g}, lambda = {:.4g}: {}", N, lambda, survey.map.points[i].why));
      stable.push_back({N, lambda, {}, 1, {}, {}});
      continue;
    }
    Truth truth = truth_of(model, settings.quick ? 1e-9 : 1e-11);
    short_of_tolerance += !truth.value.failure.empty();
    // A second way: CVODE in other variables, by other code, from the same point of the section.
    const double tight = settings.quick ? 1e-10 : 1e-12;
    const Problem p = truth.problem();
    std::vector<Reading> others;
    std::string why;
    for (const double t : {tight, 10 * tight, 100 * tight}) {
      const Reading r = run_cvode<Good>(p, t, truth.section, 4);
      if (r.failure.empty()) others.push_back(r);
      if (!r.failure.empty()) why = r.failure;
    }
    if (others.size() < 2) {
      ++unchecked;
      ++unchecked_because[why];
    } else {
      // How far CVODE is from itself: its loop area in long stick no longer improves with the tolerance.
      Truth other = truth;
      other.value = others.front();
      const Errors between = errors_of(others.front(), truth);
      Errors noise{0, 0, 0};
      for (const auto& r : others) {
        const Errors e = errors_of(r, other);
        noise = {std::max(noise.period, e.period), std::max(noise.stick, e.stick), std::max(noise.loop, e.loop)};
      }
      const Errors stated{truth.error.period / truth.value.period, truth.error.stick_fraction,
                          truth.error.loop_area / truth.loop_size};
      const bool agree = between.period <= stated.period + 3 * noise.period + 1e3 * tight &&
                         between.stick <= stated.stick + 3 * noise.stick + 1e3 * tight &&
                         between.loop <= stated.loop + 3 * noise.loop + 1e3 * tight;
      if (!agree) {
        ++beyond;
        findings.push_back(fmt::format(
            "N = {:.4g}, lambda = {:.4g}: rosin and CVODE differ by {:.1e}, {:.1e}, {:.1e} (stated {:.1e}, {:.1e}, "
            "{:.1e})",
            N, lambda, between.period, between.stick, between.loop, stated.period, stated.stick, stated.loop));
      }
      largest_period = std::max(largest_period, between.period);
      if (between.worst() > largest) largest = between.worst(), at_N = N, at_lambda = lambda;
    }
    cycles.push_back(truth);
    index.push_back(i);
  }
  fmt::print(
      "\nPlane: {0} x {0} points, N = 9.81e-8 ... 9.81 N, lambda = 1e-4 ... 1e2: {1} with a cycle, {2} stable.\n"
      "Reference against CVODE at its tightest: largest disagreement {3:.1e} (period {4:.1e}), at N = {5:.4g} N, "
      "lambda = "
      "{6:.4g}; {7} beyond the stated errors, {8} not checked\n",
      points, cycles.size(), stable.size(), largest, largest_period, at_N, at_lambda, beyond, unchecked);
  for (const auto& [why, n] : unchecked_because) fmt::print("  not checked at {} points: CVODE says {}\n", n, why);
  if (short_of_tolerance > 0)
    fmt::print("  the reference says at {} points that it is short of its tolerance\n", short_of_tolerance);

  std::vector<Row> plane_rows;
  json splits = json::array();
  std::vector<std::string> outside_points;
  for (const double tolerance : tolerances(3, settings.quick ? 6 : 10)) {
    Row row{.solver = whole_map, .tolerance = tolerance};
    for (int repetition = 0; repetition < (settings.quick ? 1 : 3); ++repetition) {
      const Plane plane = compute_plane(points, tolerance);
      if (repetition > 0 && plane.seconds >= row.seconds) continue;
      row = Row{.solver = whole_map, .tolerance = tolerance, .seconds = plane.seconds};
      row.asked = int(cycles.size());
      for (std::size_t i = 0; i < cycles.size(); ++i) {
        const auto& point = plane.map.points[index[i]];
        Reading reading = reading_of(point.metrics);
        if (!point.why.empty()) reading.failure = "said to be short of the tolerance, or failed";
        reading.steady = point.regime == rosin::analysis::Regime::stable;
        row.take(reading, cycles[i]);
        if (!has_cycle(point)) continue;
        const Reading stated = reading_of(point.error);
        const Errors e = errors_of(reading_of(point.metrics), cycles[i]);
        const Truth& t = cycles[i];
        const bool outside = e.period > (stated.period + t.error.period) / t.value.period ||
                             e.stick > stated.stick_fraction + t.error.stick_fraction ||
                             e.loop > (stated.loop_area + t.error.loop_area) / t.loop_size;
        row.understated += outside;
        if (outside && repetition == 0)
          outside_points.push_back(
              fmt::format("{:.0e}: N = {:.4g}, lambda = {:.4g}: true {:.1e} {:.1e} {:.1e}, stated {:.1e} {:.1e} {:.1e}",
                          tolerance, t.N, t.lambda, e.period, e.stick, e.loop, stated.period / t.value.period,
                          stated.stick_fraction, stated.loop_area / t.loop_size));
      }
      splits.push_back({{"tolerance", tolerance},
                        {"cycle_seconds", plane.cycle_seconds},
                        {"stable_seconds", plane.stable_seconds},
                        {"threshold_seconds", plane.seconds - plane.cycle_seconds - plane.stable_seconds}});
    }
    plane_rows.push_back(row);
  }
  for (const auto& [name, solve] : solvers)
    append(plane_rows, sweep(name, solve, cycles, tolerances(3, settings.quick ? 6 : 11), settings));
  if (scipy.found() && !settings.quick)
    for (const char* method : {"Radau", "LSODA"}) append(plane_rows, scipy.sweep(method, cycles, tolerances(3, 10), 1));
  print(plane_rows, true);
  record["plane"] = {{"points", points * points},
                     {"cycle_points", cycles.size()},
                     {"reference",
                      {{"largest_disagreement", largest},
                       {"largest_period_disagreement", largest_period},
                       {"beyond_stated_error", beyond},
                       {"unchecked", unchecked}}},
                     {"rows", as_json(plane_rows)},
                     {"rosin_map_split", splits}};
  if (!settings.quick) record["plane"]["time_to_reach"] = times_to_reach(plane_rows, "Plane, each cycle");
  if (!settings.quick) record["plane"]["ratios"] = ratios(plane_rows, whole_map, "Plane");

  // Stable points: what it costs to find out by integration that nothing oscillates.
  fmt::print("\n{} stable points, tolerance 1e-6, at most {} passages each\n", stable.size(), most_passages);
  json stable_rows = json::array();
  const auto report = [&](const std::string& name, double seconds, int tried, int steady, int wrong, int open) {
    fmt::print(
        "  {:<28} {:10.4g} s for {:3} points {:12.1f} us/point; called steady {}, called a cycle {}, undecided {}\n",
        name, seconds, tried, 1e6 * seconds / std::max(1, tried), steady, wrong, open);
    stable_rows.push_back({{"solver", name},
                           {"seconds", seconds},
                           {"tried", tried},
                           {"steady", steady},
                           {"called_cycle", wrong},
                           {"undecided", open}});
  };
  double ours = INFINITY;
  for (const auto& s : splits)
    if (std::abs(s["tolerance"].get<double>() / 1e-6 - 1) < 1e-9)
      ours = std::min(ours, s["stable_seconds"].get<double>());
  report(whole_map, ours, int(stable.size()), int(stable.size()), 0, 0);
  for (std::size_t s = 2; s < solvers.size() && !settings.quick; ++s) {
    int steady = 0, wrong = 0, open = 0, tried = 0;
    const double begin = now();
    for (const auto& at : stable) {
      const Reading r = solvers[s].second(at, 1e-6);
      ++tried;
      (!r.failure.empty() ? open : r.steady ? steady : wrong) += 1;
      if (now() - begin > settings.limit / 3) break;
    }
    report(solvers[s].first, now() - begin, tried, steady, wrong, open);
  }
  record["stable_points"] = stable_rows;
  record["findings"] = findings;
  record["outside_stated_error"] = outside_points;
  for (const auto& point : outside_points) fmt::print("outside the stated error (period, stick, loop), {}\n", point);

  for (const auto& finding : findings) fmt::print("FINDING: {}\n", finding);
  if (!settings.json_file.empty()) {
    const std::filesystem::path file = settings.json_file;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << record.dump(1) << '\n';
    const auto stem = (file.parent_path() / file.stem()).string();
    write_curves(stem + ".cycle.dat", rows);
    write_curves(stem + ".plane.dat", plane_rows);
    const auto plot = fmt::format("'{}' -c '{}/plot_work_precision.gp' '{}'", GNUPLOT, BENCH_FOLDER, stem);
    if (std::system(plot.c_str()) != 0) fmt::print(stderr, "the picture could not be drawn\n");
    fmt::print("\nwritten: {0}, {1}.svg, {1}.png\n", file.string(), stem);
  }
  return findings.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Run time against true error: rosin, CVODE, Boost.odeint and SciPy on one cycle and on a plane"};
  app.add_flag("--quick", settings.quick, "few points and tolerances, in seconds: checks that everything works");
  app.add_option("--json", settings.json_file, "keep the record in this file, and the picture beside it");
  app.add_option("--python", settings.python, "Python with SciPy")->capture_default_str();
  app.add_option("--limit", settings.limit, "seconds for all tolerances of one solver")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return run(settings);
}
