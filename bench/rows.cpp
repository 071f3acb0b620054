/// Timing, tables and times at equal error, the same for every bench.
#include "bench/rows.hpp"

#include <algorithm>
#include <bench_scripts.hpp>
#include <cmath>
#include <ctime>
#include <fstream>
#include <sstream>

#include "core/files.hpp"
#include "core/process.hpp"

namespace bench {

double now() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

void progress(const Settings& settings, const std::string& text) {
  using Clock = std::chrono::steady_clock;
  static const auto begin = Clock::now();
  if (settings.quiet) return;
  rosin::tell("[{:3.0f} s] {}\n", std::chrono::duration<double>(Clock::now() - begin).count(), text);
}

Stage::Stage(const Settings& settings, std::string what, std::size_t total)
    : settings_(settings), what_(std::move(what)), total_(total) {
  progress(settings_, fmt::format("{}: {}", what_, total_));
}

void Stage::done(std::size_t problems) {
  const auto now = Clock::now();
  if (problems == 0 || now - told_ < std::chrono::seconds(10)) return;
  told_ = now;
  const double spent = std::chrono::duration<double>(now - begin_).count();
  progress(settings_, fmt::format("{}: {} of {} done, {:.0f} s left", what_, problems, total_,
                                  spent * double(total_ - problems) / double(problems)));
}

std::filesystem::path rows_file(const Settings& settings) {
  return std::filesystem::path(settings.folder) / (settings.what + ".rows.jsonl");
}

void keep(const Settings& settings, const std::vector<Row>& rows) {
  std::ofstream file(rows_file(settings), std::ios::app);
  for (const auto& row : as_json(rows, {})) file << row.dump() << '\n';
}

int Row::failed() const {
  int n = 0;
  for (const auto& [why, count] : failures) n += count;
  return n;
}

double Row::quantile(double q) const {
  if (errors.empty()) return NAN;
  std::vector<double> worst;
  for (const auto& e : errors) worst.push_back(*std::max_element(e.begin(), e.end()));
  std::sort(worst.begin(), worst.end());
  return worst[std::min(worst.size() - 1, std::size_t(std::ceil(q * double(worst.size())) - (q > 0 ? 1 : 0)))];
}

namespace {
std::vector<std::string> solvers_of(const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const auto& r : rows)
    if (std::find(names.begin(), names.end(), r.solver) == names.end()) names.push_back(r.solver);
  return names;
}
}  // namespace

AtError time_at(const std::vector<Row>& all, const std::string& solver, double error) {
  std::vector<Row> rows;
  for (const auto& r : all)
    if (r.solver == solver && r.counts()) rows.push_back(r);
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.microseconds() < b.microseconds(); });
  std::vector<std::pair<double, double>> curve;  // falling error, rising time
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

Row measure(const std::string& solver, int problems, double tolerance, const Settings& settings,
            const std::function<void(int, double)>& solve, const std::function<void(int, Row&)>& judge) {
  Row row{.solver = solver, .tolerance = tolerance};
  row.asked = problems;
  row.seconds = INFINITY;
  int most = 1;
  for (int repetition = 0; repetition < most; ++repetition) {
    const double begin = now();
    int tried = 0;
    for (; tried < problems && (tried == 0 || now() - begin < settings.limit); ++tried) solve(tried, tolerance);
    const double seconds = now() - begin;
    row.tried = tried;
    row.seconds = std::min(row.seconds, seconds);
    if (repetition == 0 && !settings.quick) most = seconds < 0.05 ? 20 : seconds < 1 ? 5 : seconds < 6 ? 3 : 1;
  }
  if (row.tried < row.asked) row.note = fmt::format("time limit: {} of {}", row.tried, row.asked);
  for (int i = 0; i < row.tried; ++i) judge(i, row);
  return row;
}

std::vector<Row> sweep(const std::string& solver, int problems, const std::vector<double>& tolerances,
                       const Settings& settings, const std::function<void(int, double)>& solve,
                       const std::function<void(int, Row&)>& judge) {
  std::vector<Row> rows;
  double spent = 0;
  for (const double tolerance : tolerances) {
    progress(settings, fmt::format("{}, {} problem{}, {:.0e}", solver, problems, problems == 1 ? "" : "s", tolerance));
    // Loose tolerances at which a solver flounders say nothing of the time that tighter ones take.
    if (const std::size_t n = rows.size(); n >= 2 && rows[n - 1].counts() && rows[n - 2].counts()) {
      const double expected = rows[n - 1].seconds * std::max(1.0, rows[n - 1].seconds / rows[n - 2].seconds);
      if (spent + expected > settings.limit) {
        rows.back().note += fmt::format("{}left out: {:.0e} and below, which would take {:.0f} s",
                                        rows.back().note.empty() ? "" : "; ", tolerance, expected);
        break;
      }
    }
    rows.push_back(measure(solver, problems, tolerance, settings, solve, judge));
    keep(settings, {rows.back()});
    if (rows.back().counts()) spent += rows.back().seconds;
  }
  return rows;
}

std::vector<double> tolerances(const Settings& settings, int first, int last) {
  std::vector<double> list;
  for (int e = first; e <= last; e += settings.quick ? 3 : 1) list.push_back(std::pow(10.0, -e));
  return list;
}

void print(const Settings& settings, const std::vector<Row>& rows, const std::vector<std::string>& quantities) {
  const bool many = std::any_of(rows.begin(), rows.end(), [](const Row& r) { return r.asked > 1; });
  say(settings, "{:<34} {:>6} {:>11}   {:<36} {}\n", "solver", "tol", many ? "us/problem" : "us",
      many ? "worst true error: median 90% max" : fmt::format("true errors: {}", fmt::join(quantities, ", ")),
      "failures");
  for (const auto& r : rows) {
    std::string errors;
    if (many)
      errors = fmt::format("{:8.1e} {:8.1e} {:8.1e}", r.quantile(0.5), r.quantile(0.9), r.quantile(1));
    else if (!r.errors.empty())
      for (const double e : r.errors[0]) errors += fmt::format("{:8.1e} ", e);
    say(settings, "{:<34} {:6.0e} {:11.1f}   {:<36} {}/{} {}\n", r.solver, r.tolerance, r.microseconds(), errors,
        r.failed(), r.tried, r.note);
    for (const auto& [why, n] : r.failures) say(settings, "{:<34}   {} x {}\n", "", n, why);
    if (r.understated > 0) say(settings, "{:<34}   {} outside the error that it states\n", "", r.understated);
  }
}

json times_to_reach(const Settings& settings, const std::vector<Row>& rows, const std::string& what) {
  const std::vector<double> errors = {1e-3, 1e-4, 1e-6, 1e-8, 1e-10};
  say(settings,
      "\n{}: milliseconds to reach an error (<: the loosest tolerance is better already; -: not reached, or more than "
      "one in ten fails)\n  {:<34}",
      what, "");
  for (const double e : errors) say(settings, " {:>9.0e}", e);
  json list = json::array();
  for (const auto& solver : solvers_of(rows)) {
    say(settings, "\n  {:<34}", solver);
    for (const double e : errors) {
      const auto at = time_at(rows, solver, e);
      const bool reached = *at.relation != '>';
      say(settings, " {:>9}", reached ? fmt::format("{}{:.3g}", at.relation, 1e-3 * at.microseconds) : "-");
      if (reached)
        list.push_back(
            {{"solver", solver}, {"error", e}, {"relation", at.relation}, {"microseconds", at.microseconds}});
    }
  }
  say(settings, "\n");
  return list;
}

json ratios(const Settings& settings, const std::vector<Row>& rows, const std::string& yardstick, double tolerance,
            const std::string& what) {
  json list = json::array();
  const auto ours = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
    return r.solver == yardstick && std::abs(r.tolerance / tolerance - 1) < 1e-9;
  });
  if (ours == rows.end() || ours->errors.empty()) return list;
  say(settings, "\n{}: time over that of {} at tolerance {:.0e}, at the error {:.1e} that it reaches in {:.1f} us\n",
      what, yardstick, tolerance, ours->error(), ours->microseconds());
  for (const auto& solver : solvers_of(rows)) {
    if (solver == yardstick) continue;
    double best = INFINITY;
    for (const auto& r : rows)
      if (r.solver == solver && r.counts()) best = std::min(best, r.error());
    const auto at = time_at(rows, solver, ours->error());
    const double ratio = at.microseconds / ours->microseconds();
    say(settings, "  {:<34} {:>1} {:8.2f}{}\n", solver, at.relation, ratio,
        *at.relation == '>' ? fmt::format("   (does not get there; best {:.1e})", best) : "");
    list.push_back({{"solver", solver}, {"error", ours->error()}, {"relation", at.relation}, {"ratio", ratio}});
  }
  return list;
}

json as_json(const std::vector<Row>& rows, const std::vector<std::string>& quantities) {
  json list = json::array();
  for (const auto& r : rows) {
    json row = {{"solver", r.solver},
                {"tolerance", r.tolerance},
                {"seconds", r.seconds},
                {"microseconds_per_problem", r.microseconds()},
                {"asked", r.asked},
                {"tried", r.tried},
                {"failures", r.failures},
                {"note", r.note},
                {"outside_stated_error", r.understated}};
    if (!r.errors.empty()) {
      row["worst_error"] = {{"median", r.quantile(0.5)}, {"nine_in_ten", r.quantile(0.9)}, {"largest", r.quantile(1)}};
      for (std::size_t q = 0; q < quantities.size(); ++q) {
        double largest = 0;
        for (const auto& e : r.errors) largest = std::max(largest, e[q]);
        row["largest_error"][quantities[q]] = largest;
      }
    }
    list.push_back(row);
  }
  return list;
}

void write_curves(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::ostringstream out;
  for (const auto& solver : solvers_of(rows)) {
    out << "\n\n# " << solver << ";\n";
    for (const auto& r : rows)
      if (r.solver == solver && r.counts())
        out << fmt::format("{:.4e} {:.4e} {:.0e}\n", r.error(), 1e-6 * r.microseconds(), r.tolerance);
  }
  rosin::write_whole(file, out.str());
}

// ---------------------------------------------------------------- SciPy

SciPy::SciPy(const Settings& settings) : settings_(settings) {
  const auto python = rosin::find_program(settings.python);
  if (!python) return;
  python_ = *python;
  const auto ran = rosin::run_program({python_, {"-c", "import scipy; print(scipy.__version__)"}});
  if (ran && ran->status == 0) version_ = ran->output.substr(0, ran->output.find('\n'));
}

std::vector<Row> SciPy::sweep(const std::string& kind, const std::string& method, const json& problems,
                              const std::vector<double>& tolerances, int repetitions,
                              const std::function<void(int, const json&, Row&)>& judge) const {
  namespace fs = std::filesystem;
  std::vector<Row> rows;
  if (!found()) return rows;
  const rosin::TemporaryFolder folder(fs::temp_directory_path());
  const auto script = folder.path() / "rivals.py", job = folder.path() / "job.json", answer = folder.path() / "answer";
  rosin::write_whole(script, scipy_script);
  const json asked{{"kind", kind},
                   {"method", method},
                   {"tolerances", tolerances},
                   {"limit", settings_.limit},
                   {"repetitions", repetitions},
                   {"problems", problems}};
  rosin::write_whole(job, asked.dump());
  progress(settings_, fmt::format("SciPy {}, {} problems", method, problems.size()));
  const auto ran = rosin::run_program(
      {python_, {script.string(), job.string(), answer.string()}, {}, {"OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1"}});
  if (ran && ran->status == 0) {
    const json result = json::parse(std::ifstream(answer));
    for (const auto& r : result["rows"]) {
      Row row{.solver = "SciPy " + method, .tolerance = r["tolerance"]};
      row.asked = int(problems.size());
      for (std::size_t i = 0; i < r["problems"].size(); ++i) {
        const auto& p = r["problems"][i];
        row.seconds += p["seconds"].get<double>();
        ++row.tried;
        judge(int(i), p, row);
      }
      if (row.tried < row.asked) row.note = fmt::format("time limit: {} of {}", row.tried, row.asked);
      rows.push_back(row);
    }
    keep(settings_, rows);
  }
  return rows;
}

}  // namespace bench
