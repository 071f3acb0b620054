/// What a bench notes of each solver at each tolerance, and what is read off these rows: tables, times at equal error.
#pragma once
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/bench.hpp"
#include "core/console.hpp"

namespace bench {

using nlohmann::json;

/// Processor time of this process, s.
double now();

/// True errors of one result, each relative to a size of its own, by name of what is measured.
using Errors = std::vector<double>;

/// One solver at one tolerance, over all problems.
struct Row {
  std::string solver;
  double tolerance;
  double seconds = 0;  ///< of all problems, failures included
  int asked = 0, tried = 0, understated = 0;
  std::vector<Errors> errors = {};  ///< of each problem that was solved
  std::map<std::string, int> failures = {};
  std::string note = {};

  int failed() const;
  double microseconds() const { return 1e6 * seconds / std::max(1, tried); }
  /// A quantile over problems of the worst error of each.
  double quantile(double q) const;
  /// The error by which solvers are compared: nine problems in ten are better.
  double error() const { return std::max(1e-15, quantile(0.9)); }
  /// Too many failures, or not all problems tried: no point of the curve.
  bool counts() const { return !errors.empty() && failed() <= 0.1 * tried && tried == asked; }
};

/// Time of a solver at an error, from its curve of best points, interpolated in logarithms.
struct AtError {
  double microseconds;
  const char* relation;  ///< "": interpolated; "<": even its loosest result is better; ">": not reached
};
AtError time_at(const std::vector<Row>& rows, const std::string& solver, double error);

/// Solves all problems at one tolerance, several times where that is quick, and keeps the shortest time. `solve(i,
/// tolerance, row)` solves problem i; `judge` is called once afterwards, untimed, and enters errors and failures.
Row measure(const std::string& solver, int problems, double tolerance, const Settings&,
            const std::function<void(int i, double tolerance)>& solve, const std::function<void(int i, Row&)>& judge);
/// Over tolerances; leaves those out that would exceed the limit.
std::vector<Row> sweep(const std::string& solver, int problems, const std::vector<double>& tolerances, const Settings&,
                       const std::function<void(int i, double tolerance)>& solve,
                       const std::function<void(int i, Row&)>& judge);
/// 10^−first … 10^−last, a third of them if quick.
std::vector<double> tolerances(const Settings&, int first, int last);

void print(const Settings&, const std::vector<Row>&, const std::vector<std::string>& quantities);
json times_to_reach(const Settings&, const std::vector<Row>&, const std::string& what);
/// Time of the others over that of `yardstick` at `tolerance`, at the true error that it reaches.
json ratios(const Settings&, const std::vector<Row>&, const std::string& yardstick, double tolerance,
            const std::string& what);
json as_json(const std::vector<Row>&, const std::vector<std::string>& quantities);
/// One block a solver for gnuplot, "error seconds tolerance", headed by its name.
void write_curves(const std::filesystem::path&, const std::vector<Row>&);

/// A line of the terminal's tables, unless the record goes there.
template <class... Args>
void say(const Settings& settings, fmt::format_string<Args...> text, Args&&... args) {
  if (!settings.json) rosin::print(text, std::forward<Args>(args)...);
}
/// What is being computed, and since how many seconds the bench runs, a line on standard error.
void progress(const Settings&, const std::string& text);
/// How many of a stage's problems are done, and the time left, every ten seconds.
class Stage {
 public:
  Stage(const Settings& settings, std::string what, std::size_t total);
  void done(std::size_t problems);

 private:
  using Clock = std::chrono::steady_clock;
  const Settings& settings_;
  std::string what_;
  std::size_t total_;
  Clock::time_point begin_ = Clock::now(), told_ = begin_;
};
/// The rows that are finished, a line of JSON each, in a bench's folder: what is left of one that is stopped.
std::filesystem::path rows_file(const Settings&);
/// Adds rows to that file.
void keep(const Settings&, const std::vector<Row>&);

/// SciPy's solvers, in one Python process for each sweep.
class SciPy {
 public:
  explicit SciPy(const Settings&);
  bool found() const { return !version_.empty(); }
  const std::string& version() const { return version_; }
  /// `problems`: what the script takes for each. `judge(i, answer, row)` enters errors and failures.
  std::vector<Row> sweep(const std::string& kind, const std::string& method, const json& problems,
                         const std::vector<double>& tolerances, int repetitions,
                         const std::function<void(int i, const json& answer, Row&)>& judge) const;

 private:
  const Settings& settings_;
  std::filesystem::path python_;
  std::string version_;
};

/// A picture of times over errors.
struct Panel {
  std::filesystem::path curves;  ///< gnuplot data beside the script
  std::string title, error, time;
};
/// One bench's part of the record. Findings are faults: references that disagree, rivals set up wrongly.
struct Record {
  json content;
  std::vector<std::string> findings;
  std::vector<Panel> panels;
};
/// Time of one step of the ensemble solver in one lane, for every law with states, a contact spring, a user's law, and
/// each instruction set.
json lane_steps(const Settings&);
// A bench leaves its curves in the file `curves`; SciPy takes part where a bench asks it.
Record bench_block(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_branch(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_chain(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_cycle(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_history(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_plane(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_response(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_sections(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_stick_slip(const Settings&, const SciPy&, const std::filesystem::path& curves);
Record bench_string(const Settings&, const SciPy&, const std::filesystem::path& curves);

}  // namespace bench
