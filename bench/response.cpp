/// `rosin bench response`: friction frequency responses by linearisation, by swept sine and out of records.
#include <cmath>
#include <numbers>

#include "analysis/response/extraction.hpp"
#include "analysis/response/frf_simulation.hpp"
#include "bench/response_rivals.hpp"
#include "bench/rows.hpp"
#include "core/random.hpp"
#include "laws/catalogue.hpp"

namespace bench {
namespace {

using namespace rosin;
using Complex = std::complex<double>;

constexpr AgeingContact contact{0.6, 0.010, 0.015, 1e-5, 1e-6, 1e-5, 5};

oscillators::Model model_of(const AgeingContact& p) {
  oscillators::Model model;
  model.law = laws::find_law("ageing")->with({p.mu0, p.a, p.b, p.L, p.v0});
  model.drive = {p.V, p.N, 0.0};
  return model;
}

/// Z = N/V (a − b/(1 + iωL/V)).
std::complex<long double> closed_form(const AgeingContact& p, double frequency) {
  const std::complex<long double> s(0, 2 * std::numbers::pi_v<long double> * frequency);
  return (long double)(p.N) / p.V *
         ((long double)(p.a) - (long double)(p.b) / (1.0L + s * (long double)(p.L) / (long double)(p.V)));
}

/// Processor time of a prediction at many frequencies, for every law.
json every_law(const Settings& settings) {
  constexpr int count = 10000;
  std::vector<double> frequency;
  for (int i = 0; i < count; ++i) frequency.push_back(1e-3 * std::pow(1e7, i / (count - 1.0)));
  json list = json::array();
  double all = 0;
  for (const auto& law : laws::catalogue()) {
    oscillators::Model model;
    model.law = law;
    model.drive = {1e-4, 5.0, 0.0};
    const double begin = now();
    const analysis::response::FrictionResponse response(model);
    Complex sum = 0;
    for (const double f : frequency) sum += response.tangential({0, 2 * std::numbers::pi * f});
    const double seconds = now() - begin;
    if (!std::isfinite(std::abs(sum))) throw std::runtime_error(std::string(law->card().name) + ": not finite");
    all += seconds;
    list.push_back({{"law", law->card().name}, {"unknowns", response.linear().size()}, {"seconds", seconds}});
  }
  say(settings, "\n{} frequencies of each of {} laws: {:.3g} s in all\n", count, list.size(), all);
  return list;
}

/// Processor time of the cross-spectra of a long record of two channels, in blocks.
json long_record(const Settings& settings) {
  const long samples = settings.quick ? 1'000'000 : 10'000'000;
  constexpr std::size_t block = 1 << 16;
  std::vector<double> slip_rate(block), force(block);
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < block; ++i)
    slip_rate[i] = open_unit(splitmix(state += splitmix_step)),
    force[i] = slip_rate[i] + 0.1 * open_unit(splitmix(state += splitmix_step));
  const std::vector<std::span<const double>> channels = {slip_rate, force};
  analysis::response::CrossSpectra spectra(2, {.segment = 2000});
  const double begin = now();
  for (long done = 0; done < samples; done += long(block)) spectra.add(channels);
  const auto measured = analysis::response::extract_frf(spectra, {}, 1e4, {});
  const double seconds = now() - begin;
  say(settings, "a record of {} samples: {} bins in {:.3g} s\n", spectra.samples(), measured.frequency.size(), seconds);
  return {{"samples", spectra.samples()}, {"segment", 2000}, {"seconds", seconds}};
}

}  // namespace

Record bench_response(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  Record record;
  std::vector<double> frequency;  // two decades to either side of where the state turns
  const int count = settings.quick ? 4 : 12;
  for (int i = 0; i < count; ++i)
    frequency.push_back(contact.V / contact.L / (2 * std::numbers::pi) * 0.01 * std::pow(1e4, i / (count - 1.0)));
  const auto model = model_of(contact);
  std::vector<Row> rows;
  std::vector<SweptSine> found(frequency.size());
  const auto add = [&](const std::string& solver, const std::vector<double>& list,
                       const std::function<SweptSine(double frequency, double tolerance)>& solve) {
    const auto more = sweep(
        solver, count, list, settings,
        [&](int i, double tolerance) { found[std::size_t(i)] = solve(frequency[std::size_t(i)], tolerance); },
        [&](int i, Row& row) {
          const auto& [Z, failure] = found[std::size_t(i)];
          const auto truth = closed_form(contact, frequency[std::size_t(i)]);
          const double error =
              double(std::abs(std::complex<long double>(Z.real(), Z.imag()) - truth) / std::abs(truth));
          if (!failure.empty())
            ++row.failures[failure];
          else
            row.errors.push_back({error});
        });
    rows.insert(rows.end(), more.begin(), more.end());
  };
  add("rosin, prediction", {1e-15}, [&](double f, double) {
    return SweptSine{analysis::response::FrictionResponse(model).tangential({0, 2 * std::numbers::pi * f})};
  });
  const auto list = tolerances(settings, 4, 10);
  add("rosin, swept sine", list, [&](double f, double tolerance) {
    return SweptSine{
        analysis::response::simulate_sweep(model, {.frequencies = {f}, .tolerance = tolerance}).tangential[0]};
  });
  add("CVODE, swept sine", list, [](double f, double tolerance) { return swept_by_cvode(contact, f, tolerance); });
  for (const auto& row : rows)
    if (row.solver.starts_with("CVODE") && row.tolerance <= 1e-8 && !(row.quantile(1) < 1e-5))
      record.findings.push_back(
          fmt::format("CVODE at {:.0e} differs from the closed form by {:.1e}", row.tolerance, row.quantile(1)));
  say(settings, "Response of an ageing contact at {} frequencies, error relative to |Z|\n", count);
  print(settings, rows, {"Z"});
  record.content = {{"rows", as_json(rows, {"Z"})}};
  record.content["time_to_reach"] = times_to_reach(settings, rows, "One frequency");
  record.content["laws"] = every_law(settings);
  record.content["record"] = long_record(settings);
  write_curves(curves, rows);
  record.panels = {{curves, "Friction frequency response of an ageing contact",
                    "true error of Z over |Z|, met by nine frequencies in ten", "processor time per frequency (s)"}};
  return record;
}

}  // namespace bench
