/// `rosin bench string`: bowed strings in lanes beside a loop written for one law.
#include <cmath>

#include "analysis/strings/strings.hpp"
#include "bench/rows.hpp"
#include "bench/string_rivals.hpp"
#include "laws/catalogue.hpp"

namespace bench {
namespace {

using namespace rosin;
using analysis::strings::BowedStringModel;

/// Strings of Guettler's diagram, of `points` accelerations and forces each.
std::vector<StringProblem> diagram(int points, double rate) {
  std::vector<StringProblem> list;
  for (int j = 1; j <= points; ++j)
    for (int i = 1; i <= points; ++i) list.push_back({3.0 * i / points, 2.5 * j / points, rate});
  return list;
}
BowedStringModel model_of(const StringProblem& problem, const char* law) {
  BowedStringModel model;
  model.law = laws::find_law(law);
  model.string.sample_rate = problem.sample_rate;
  model.speed.signal = Signal(Signal::Ramp{0, problem.acceleration});
  model.load.signal = Signal(problem.load);
  return model;
}

}  // namespace

Record bench_string(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  struct Contender {
    const char *law, *name;
    StringMotion (*by_hand)(const StringProblem&);
  };
  const Contender contenders[] = {{"two-exponential", "friction curve", bow_by_hand_curve},
                                  {"thermal-layer", "temperature", bow_by_hand_temperature}};
  const int points = settings.quick ? 6 : 20;
  const std::vector<double> rates =
      settings.quick ? std::vector<double>{96e3} : std::vector<double>{48e3, 96e3, 192e3, 384e3};
  Record record;
  std::vector<Row> rows;
  json speeds = json::array();
  for (const auto& [law, what, by_hand] : contenders) {
    // The onset of the fourth slip, against rosin at four times the highest rate.
    const auto finest = diagram(points, 4 * rates.back());
    std::vector<BowedStringModel> models;
    for (const auto& problem : finest) models.push_back(model_of(problem, law));
    progress(settings, fmt::format("{}: reference", what));
    const auto fourth = [](const analysis::strings::Bowing& bowing, double step) {
      const auto& slips = bowing.raw;
      return slips.size() > 3 ? double(slips[3].on) * step : NAN;
    };
    std::vector<double> reference;
    for (const auto& bowing : analysis::strings::bow(models, {}, 2))
      reference.push_back(fourth(bowing, 1 / (4 * rates.back())));
    for (const double rate : rates) {
      const auto problems = diagram(points, rate);
      models.clear();
      for (const auto& problem : problems) models.push_back(model_of(problem, law));
      std::vector<analysis::strings::Bowing> of_rosin;
      std::vector<StringMotion> of_hand(problems.size());
      const auto time = [&](const auto& work) {
        double least = INFINITY;
        for (int i = 0; i < (settings.quick ? 1 : 3); ++i) {
          const double begin = now();
          work();
          least = std::min(least, now() - begin);
        }
        return least;
      };
      const double lanes = time([&] { of_rosin = analysis::strings::bow(models, {}, 1); });
      const double loop = time([&] {
        for (std::size_t i = 0; i < problems.size(); ++i) of_hand[i] = by_hand(problems[i]);
      });
      double steps = 0;
      int differ = 0;
      Row in_lanes{fmt::format("rosin, {}", what), 1 / rate, lanes, int(problems.size()), int(problems.size())};
      Row in_loop{fmt::format("loop by hand, {}", what), 1 / rate, loop, int(problems.size()), int(problems.size())};
      const double period = models[0].string.period();
      for (std::size_t i = 0; i < problems.size(); ++i) {
        steps += double(of_rosin[i].samples);
        const double here = fourth(of_rosin[i], 1 / rate);
        differ += std::abs(of_hand[i].first_slip - of_rosin[i].first_slip) > 0.5 / rate;
        if (std::isfinite(reference[i]) && std::isfinite(here))
          in_lanes.errors.push_back({std::abs(here - reference[i]) / period});
        if (std::isfinite(reference[i]) && of_hand[i].fourth_slip > 0)
          in_loop.errors.push_back({std::abs(of_hand[i].fourth_slip - reference[i]) / period});
      }
      if (differ > 0)
        record.findings.push_back(
            fmt::format("{} at {} Hz: first slips of {} strings differ from the loop's", what, rate, differ));
      say(settings,
          "{:<15} {:>7.0f} Hz: rosin {:.3g} s, {:.3g} steps/s; loop by hand {:.3g} s, {:.3g} steps/s; ratio {:.2f}\n",
          what, rate, lanes, steps / lanes, loop, steps / loop, loop / lanes);
      speeds.push_back({{"law", law},
                        {"sample_rate", rate},
                        {"strings", problems.size()},
                        {"steps", steps},
                        {"seconds", lanes},
                        {"seconds_by_hand", loop},
                        {"ratio", loop / lanes}});
      rows.push_back(std::move(in_lanes)), rows.push_back(std::move(in_loop));
    }
  }
  print(settings, rows, {"onset of the fourth slip, periods"});
  record.content = {{"rows", as_json(rows, {"fourth slip"})}, {"speeds", std::move(speeds)}};
  write_curves(curves, rows);
  record.panels = {{curves, "400 cello strings under a bow that speeds up",
                    "true error of the onset of the fourth slip in periods, met by nine strings in ten",
                    "processor time per string (s)"}};
  return record;
}

}  // namespace bench
