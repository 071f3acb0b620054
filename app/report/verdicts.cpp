/// Verdicts and assumptions of documents.
#include "app/report/verdicts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "app/report/quantities.hpp"

namespace rosin::app::report {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

const ordered_json& list(const ordered_json& document, std::string_view key) {
  static const ordered_json empty = ordered_json::array();
  const auto& found = at(document, key);
  return found.is_array() ? found : empty;
}

/// "one cycle", "3 cycles"
std::string count(std::size_t n, const std::string& what) {
  return n == 1 ? "one " + what : fmt::format("{} {}s", n, what);
}

double parameter(const Result& result, std::string_view path) {
  return number(at(at(result.manifest, "parameters"), path), "value");
}

std::string unit_of(const Result& result, std::string_view path) {
  if (word(result.document, "parameter") == path) return unit_of_parameter(result.document);
  const auto unit = word(at(at(result.manifest, "parameters"), path), "unit");
  return unit.empty() ? known(path).unit : unit;
}

/// A value with its error and no more digits than anybody reads in a sentence.
std::string decisive(double value, const std::string& unit, double error) {
  constexpr double least = 1e-10;  // relative
  return error < least * std::abs(value) ? amount(value, unit, NAN, 7) : amount(value, unit, error);
}

/// "N = 981 µN"
std::string setting(std::string_view path, double value, const std::string& unit, double error = NAN) {
  const auto symbol = known(path).symbol;
  return fmt::format("{} = {}", symbol.empty() ? std::string(path) : symbol,
                     std::isnan(error) ? amount(value, unit) : decisive(value, unit, error));
}

/// " at N = 981 µN, V = 10 µm/s": what the model says of them.
std::string operating_point(const Result& result) {
  std::string text;
  for (const auto* path : {"drive.normal_load", "drive.speed"})
    if (const double value = parameter(result, path); std::isfinite(value))
      text += (text.empty() ? " at " : ", ") + setting(path, value, unit_of(result, path));
  return text;
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

std::string sentences(const std::vector<std::string>& parts) {
  return fmt::format("{}{}", fmt::join(parts, "; "), parts.empty() ? "" : ".");
}

// ---------------------------------------------------------------- the verbs

std::string of_stability(const Result& result) {
  const auto& document = result.document;
  const auto& values = list(document, "eigenvalues");
  double growth = NAN, frequency = NAN;
  if (!values.empty() && values[0].is_array() && values[0].size() == 2)
    growth = number(values[0][0]), frequency = std::abs(number(values[0][1]));
  std::vector<std::string> parts;
  const auto how = yes(document, "marginal") ? "neither stable nor unstable within errors"
                   : yes(document, "stable") ? "stable"
                                             : "unstable";
  parts.push_back(fmt::format("Steady sliding{} is {}", operating_point(result), how));
  if (std::isfinite(growth)) {
    auto& text = parts.back();
    text += fmt::format(": small motions {} at {}", growth > 0 ? "grow" : "decay", amount(std::abs(growth), "1/s"));
    if (frequency > 0)
      text += fmt::format(" and oscillate at {}, by a factor {} a period", amount(frequency / two_pi, "Hz"),
                          number_text(std::exp(growth * two_pi / frequency), 4));
  }
  const auto border = [&](const ordered_json& point, const std::string& path, double error, const char* verb) {
    const auto unit = unit_of(result, path);
    auto text = fmt::format("it {} at {}", verb, setting(path, number(point, "value"), unit, error));
    const auto kind = word(point, "criticality");
    if (kind == "supercritical") text += ", where vibration sets in softly (supercritical)";
    if (kind == "subcritical") text += ", where vibration sets in with a jump (subcritical)";
    parts.push_back(text);
  };
  for (const auto& point : list(document, "hopf"))
    if (parts.size() < 6)
      border(point, word(point, "parameter"), number(at(point, "error"), "value"), "changes stability");
  for (const auto& point : list(document, "thresholds"))
    if (parts.size() < 6)
      border(point, word(document, "parameter"), number(point, "error"),
             word(point, "kind") == "onset" ? "loses stability" : "becomes stable again");
  return sentences(parts);
}

std::string of_cycle(const Result& result) {
  const auto& document = result.document;
  const auto& error = at(document, "error");
  const double period = number(document, "period");
  if (const auto regime = word(document, "regime"); regime == "chaotic" || regime == "quasi-periodic") {
    auto text = fmt::format("The motion{} is {}", operating_point(result), regime);
    if (const double until = number(document, "known_until"); std::isfinite(until))
      text += fmt::format(": from its start it is known for {}, and then by averages", amount(until, "s"));
    if (const double stick = number(document, "stick_fraction"); std::isfinite(stick))
      text += fmt::format("; it sticks for {} of the time", percent(stick));
    return text + ".";
  }
  if (!(period > 0))
    return fmt::format("No periodic motion was found{}: {}{}.", operating_point(result), word(document, "outcome"),
                       word(document, "outcome_detail").empty() ? "" : ", " + word(document, "outcome_detail"));
  auto text = fmt::format("A periodic motion{} has the period {}", operating_point(result),
                          decisive(period, "s", number(error, "period")));
  const auto fastest = number(document, "slip_rate_max");
  if (std::isfinite(fastest))
    text += fmt::format(" and slips at up to {}", decisive(fastest, "m/s", number(error, "slip_rate_max")));
  if (const double stick = number(document, "stick_fraction"); std::isfinite(stick))
    text += stick > 0 ? fmt::format(", sticking for {} of it", percent(stick)) : ", never sticking";
  const auto& stable = at(document, "stable");
  const auto& multipliers = list(document, "multipliers");
  if (stable.is_boolean()) {
    text += stable.get<bool>() ? "; it attracts neighbouring motions" : "; it is unstable";
    if (!multipliers.empty() && multipliers[0].is_array() && multipliers[0].size() == 2)
      text += fmt::format(" (largest multiplier {})",
                          number_text(std::hypot(number(multipliers[0][0]), number(multipliers[0][1])), 4));
  }
  return text + ".";
}

std::string of_run(const Result& result) {
  const auto& document = result.document;
  const auto time = numbers(at(document, "time"));
  if (time.empty()) return "Nothing was recorded.";
  std::vector<std::string> parts{
      fmt::format("The motion was followed for {}", amount(time.back() - time.front(), "s"))};
  const auto& columns = at(document, "columns");
  for (const auto* name : {"slip_rate", "slip_rate_1", "bow_slip_rate", "velocity"}) {
    const auto values = numbers(at(columns, name));
    if (values.empty()) continue;
    const auto [least, largest] = std::ranges::minmax_element(values);
    const auto unit = word(at(document, "units"), name);
    parts.push_back(
        fmt::format("the {} lies between {} and {}", readable(name), amount(*least, unit), amount(*largest, unit)));
    break;
  }
  std::map<std::string, std::size_t> kinds;
  for (const auto& event : list(document, "events")) ++kinds[word(event, "kind")];
  if (kinds["stick"] > 0)
    parts.push_back(
        fmt::format("it comes to stick {}", kinds["stick"] == 1 ? "once" : fmt::format("{} times", kinds["stick"])));
  if (const auto drops = numbers(at(at(document, "stick_slip"), "force_drop")); !drops.empty()) {
    const auto recurrence = numbers(at(at(document, "stick_slip"), "recurrence"));
    auto text = fmt::format("{}, with force drops of up to {}", count(drops.size(), "slip event"),
                            amount(*std::ranges::max_element(drops), "N"));
    if (!recurrence.empty() && std::isfinite(recurrence.back()))
      text += fmt::format(", the last after {}", amount(recurrence.back(), "s"));
    parts.push_back(text);
  }
  if (const auto regime = word(document, "regime"); !regime.empty()) parts.push_back("its last regime is " + regime);
  return sentences(parts);
}

std::string range_text(const ordered_json& axis) {
  const auto values = numbers(at(axis, "values"));
  if (values.empty()) return word(axis, "parameter");
  const auto [least, largest] = std::ranges::minmax_element(values);
  const auto name = word(axis, "parameter").empty() ? word(axis, "start") : word(axis, "parameter");
  return fmt::format("{} = {} … {}", name, amount(*least, word(axis, "unit")), amount(*largest, word(axis, "unit")));
}

std::string of_map(const Result& result) {
  const auto& document = result.document;
  std::map<std::string, std::size_t> regimes;
  std::size_t total = 0;
  for (const auto& row : list(document, "regime"))
    for (const auto& value : row.is_array() ? row : ordered_json::array())
      if (value.is_string()) ++regimes[value.get<std::string>()], ++total;
  const std::map<std::string, std::string> words = {{"stable", "slide steadily"},
                                                    {"cycle", "vibrate"},
                                                    {"bistable", "slide steadily or vibrate, by the start"},
                                                    {"failed", "failed"}};
  std::vector<std::string> shares;
  for (const auto& [regime, n] : regimes) {
    const auto found = words.find(regime);
    shares.push_back(fmt::format("{} ({}) {}", n, percent(double(n) / double(total)),
                                 found == words.end() ? "show " + regime : found->second));
  }
  std::vector<std::string> parts{fmt::format("Of {} points over {} and {}, {}", total, range_text(at(document, "x")),
                                             range_text(at(document, "y")), fmt::join(shares, ", "))};
  for (const auto& [key, name] :
       {std::pair{"threshold", "steady sliding loses stability"}, {"fold", "cycles end in a fold"}}) {
    const auto xs = numbers(at(at(document, key), "x"));
    std::vector<double> known_xs;
    for (const double x : xs)
      if (std::isfinite(x)) known_xs.push_back(x);
    if (known_xs.empty()) continue;
    const auto [least, largest] = std::ranges::minmax_element(known_xs);
    const auto& axis = at(document, "x");
    parts.push_back(fmt::format("{} along a line between {} = {} and {}", name, word(axis, "parameter"),
                                amount(*least, word(axis, "unit")), amount(*largest, word(axis, "unit"))));
  }
  return sentences(parts);
}

std::string of_curve(const Result& result) {
  const auto& document = result.document;
  const auto rate = numbers(at(document, "slip_rate")), friction = numbers(at(document, "friction_coefficient"));
  if (rate.empty() || friction.size() != rate.size()) return "Nothing was sampled.";
  std::vector<std::string> parts{fmt::format("Steady friction goes from {} at {} to {} at {}",
                                             number_text(friction.front(), 5), amount(rate.front(), "m/s"),
                                             number_text(friction.back(), 5), amount(rate.back(), "m/s"))};
  for (const auto& extremum : list(document, "extrema"))
    parts.push_back(fmt::format(
        "a {} of {} at v = {}", word(extremum, "kind"), number_text(number(extremum, "friction_coefficient"), 5),
        decisive(number(extremum, "slip_rate"), "m/s", number(at(extremum, "error"), "slip_rate"))));
  const bool weakens = std::ranges::adjacent_find(friction, std::greater()) != friction.end();
  parts.push_back(weakens ? "where it falls with slip rate, steady sliding can lose stability"
                          : "it falls nowhere with slip rate");
  return sentences(parts);
}

std::string of_branch(const Result& result) {
  const auto& document = result.document;
  const auto path = word(document, "parameter");
  std::vector<double> values;
  for (const auto& point : list(document, "points")) values.push_back(number(point, "value"));
  if (values.empty()) return "No branch was found.";
  const auto [least, largest] = std::ranges::minmax_element(values);
  const auto unit = unit_of(result, path);
  std::vector<std::string> parts{fmt::format(
      "Along {} = {} … {} rosin followed steady sliding{}", path, amount(*least, unit), amount(*largest, unit),
      list(document, "branches").empty() ? ""
                                         : " and " + count(list(document, "branches").size(), "branch of cycles"))};
  if (list(document, "branches").size() > 1)
    parts.back() = parts.back().substr(0, parts.back().rfind("branch")) + "branches of cycles";
  const std::map<std::string, std::string> words = {{"hopf", "steady sliding changes stability"},
                                                    {"divergence", "steady sliding diverges"},
                                                    {"fold", "a stable and an unstable cycle meet and end (fold)"},
                                                    {"period-doubling", "the period doubles"},
                                                    {"torus", "a second frequency enters (torus)"},
                                                    {"grazing", "the motion just touches stick or a stop (grazing)"}};
  std::size_t more = 0;
  for (const auto& event : list(document, "events")) {
    if (parts.size() > 7) {
      ++more;
      continue;
    }
    const auto kind = word(event, "kind");
    const auto found = words.find(kind);
    parts.push_back(fmt::format("at {} {}", setting(path, number(event, "value"), unit, number(event, "error")),
                                found == words.end() ? "lies: " + kind : found->second));
  }
  if (more > 0) parts.push_back(fmt::format("{} more changes stand in the table", more));
  return sentences(parts);
}

std::string of_sweep(const Result& result) {
  const auto& document = result.document;
  const auto values = numbers(at(document, "values"));
  if (values.empty()) return "Nothing was swept.";
  const auto path = word(document, "parameter"), unit = unit_of(result, path);
  std::vector<std::string> parts{fmt::format("{} values of {} between {} and {} were passed", values.size(), path,
                                             amount(values.front(), unit), amount(values.back(), unit))};
  const auto directions = {at(document, "up").empty() ? "" : "upwards",
                           at(document, "down").empty() ? "" : "downwards"};
  for (const std::string direction : directions)
    if (!direction.empty()) parts[0] += (parts[0].ends_with("wards") ? " and " : " ") + direction;
  const auto& up = list(at(document, "recurrence"), "up");
  std::size_t periodic = 0, done = 0;
  for (const auto& period : up)
    if (period.is_number()) ++done, periodic += number(period) > 0;
  if (done > 0)
    parts.push_back(fmt::format("upwards, the motion recurs within the recorded periods at {} of {}", periodic, done));
  for (const auto& threshold : list(document, "thresholds"))
    parts.push_back(fmt::format("steady sliding {} at {}",
                                word(threshold, "kind") == "onset" ? "loses stability" : "becomes stable again",
                                setting(path, number(threshold, "value"), unit, number(threshold, "error"))));
  return sentences(parts);
}

std::string of_basin(const Result& result) {
  const auto& document = result.document;
  std::vector<std::string> parts;
  const auto& attractors = list(document, "attractors");
  if (attractors.size() == 1)
    parts.push_back("All starts come to one motion");
  else
    parts.push_back(fmt::format("Starts come to {} different motions", attractors.size()));
  int which = 0;
  for (const auto& attractor : attractors)
    if (const double share = number(attractor, "share"); std::isfinite(share))
      parts.push_back(fmt::format("({}) % to motion {}, {}",
                                  number_text(100 * share, 100 * number(attractor, "standard_error")), ++which,
                                  readable(word(attractor, "kind"))));
  if (const auto& threshold = at(document, "threshold"); threshold.is_object())
    parts.push_back(fmt::format("steady sliding is left for good by a disturbance of {} times basin.direction",
                                amount(number(threshold, "value"), "1", number(threshold, "error"))));
  return sentences(parts);
}

std::string of_lyapunov(const Result& result) {
  const auto& document = result.document;
  const auto exponents = numbers(at(document, "exponents")), errors = numbers(at(document, "standard_error"));
  if (exponents.empty() || !std::isfinite(exponents[0])) return "No Lyapunov exponent is known.";
  const double error = errors.empty() ? NAN : errors[0];
  const bool positive = exponents[0] > 3 * error, none = std::abs(exponents[0]) <= 3 * error;
  return fmt::format("The largest Lyapunov exponent is {}: {}.", amount(exponents[0], "1/s", error),
                     positive ? "neighbouring motions part, the motion is chaotic"
                     : none   ? "it does not differ from 0 within three standard errors"
                              : "neighbouring motions come together, the motion is regular");
}

std::string of_compare(const Result& result) {
  const auto& document = result.document;
  std::vector<std::string> names;
  for (const auto& member : list(document, "members")) names.push_back(word(member, "name"));
  std::vector<std::string> parts{fmt::format("{} were compared", fmt::join(names, ", "))};
  if (const auto protocol = word(document, "protocol"); !protocol.empty()) parts[0] += " by " + protocol;
  const auto& best = at(document, "best");
  if (best.is_object()) {
    auto text =
        fmt::format("the measurement that tells them apart best is at {} = {}, {} = {}",
                    word(at(document, "x"), "parameter"), amount(number(best, "x"), word(at(document, "x"), "unit")),
                    word(at(document, "y"), "parameter"), amount(number(best, "y"), word(at(document, "y"), "unit")));
    if (const double repeats = number(best, "repeats"); std::isfinite(repeats))
      text += fmt::format(", {} for {} confidence",
                          repeats <= 1 ? "once" : fmt::format("repeated {} times", number_text(std::ceil(repeats), 6)),
                          percent(number(document, "confidence")));
    parts.push_back(text);
  }
  std::vector<std::pair<double, std::string>> apart;  // relative to their size
  if (const auto& differences = at(document, "differences"); differences.is_object())
    for (const auto& [metric, row] : differences.items()) {
      const auto values = numbers(at(row, "values"));
      if (values.empty()) continue;
      const auto [least, largest] = std::ranges::minmax_element(values);
      std::vector<std::string> texts;
      for (const double value : values) texts.push_back(amount(value, word(row, "unit")));
      const double spread = (*largest - *least) / std::max(std::abs(*largest), std::abs(*least));
      if (spread > 1e-6) apart.emplace_back(spread, fmt::format("{} {}", readable(metric), fmt::join(texts, ", ")));
    }
  std::ranges::stable_sort(apart, std::greater(), &std::pair<double, std::string>::first);
  for (std::size_t i = 0; i < std::min<std::size_t>(apart.size(), 4); ++i)
    parts.push_back((i == 0 ? "they differ most in " : "") + apart[i].second);
  return sentences(parts);
}

std::string of_frf(const Result& result) {
  const auto& document = result.document;
  std::vector<std::string> parts;
  const auto frequency = numbers(at(document, "frequency"));
  const auto& answer = list(document, "tangential");
  if (!frequency.empty() && answer.size() == frequency.size()) {
    const auto size = [&](std::size_t i) {
      return answer[i].is_array() && answer[i].size() == 2 ? std::hypot(number(answer[i][0]), number(answer[i][1]))
                                                           : NAN;
    };
    parts.push_back(fmt::format("Friction answers small changes of the slip rate by {} at {} and by {} at {}",
                                amount(size(0), "N s/m"), amount(frequency.front(), "Hz"),
                                amount(size(answer.size() - 1), "N s/m"), amount(frequency.back(), "Hz")));
  }
  if (const auto& stability = at(document, "stability"); stability.is_object()) {
    parts.push_back(fmt::format("the structure on this friction is {}", yes(stability, "marginal") ? "marginal"
                                                                        : yes(stability, "stable")
                                                                            ? "stable"
                                                                            : "unstable: it squeals"));
    if (const double margin = number(stability, "margin"); std::isfinite(margin))
      parts.back() += fmt::format(", the loop passing −1 at a distance of {}", number_text(margin, 4));
  }
  return sentences(parts);
}

std::string of_fit(const Result& result) {
  const auto& document = result.document;
  std::vector<std::string> parts;
  const auto& ranking = list(document, "ranking");
  std::vector<std::string> undecided;
  for (const auto& law : list(document, "undecided"))
    if (law.is_string()) undecided.push_back(law.get<std::string>());
  if (!undecided.empty())
    parts.push_back(
        fmt::format("Of {} laws, the data do not decide between {}", ranking.size(), fmt::join(undecided, ", ")));
  else if (ranking.size() > 1)
    parts.push_back(fmt::format("Of {} laws, {} explains the data best, ahead of {} by {} in AIC", ranking.size(),
                                word(ranking[0], "law"), word(ranking[1], "law"),
                                number_text(number(ranking[1], "aic") - number(ranking[0], "aic"), 3)));
  for (const auto& fit : ranking) {  // the best law first
    std::vector<std::string> texts;
    for (const auto& [path, fitted] : at(fit, "parameters").items())
      texts.push_back(setting(path, number(fitted, "value"), word(fitted, "unit"), number(fitted, "standard_error")));
    parts.push_back(fmt::format("{} {}: {}", parts.empty() ? "Fitted parameters of" : "fitted parameters of",
                                word(fit, "law"), fmt::join(texts, ", ")));
  }
  return sentences(parts);
}

std::string of_lab(const Result& result) {
  const auto& document = result.document;
  std::vector<std::string> texts;
  if (const auto& readings = at(document, "readings"); readings.is_object())
    for (const auto& [name, value] : readings.items())
      if (value.is_number() && texts.size() < 5)
        texts.push_back(fmt::format(
            "{} = {}", readable(name),
            word(at(document, "meaning"), name).starts_with("1 if ")
                ? std::string(number(value) > 0 ? "yes" : "no")
                : decisive(number(value), word(at(document, "units"), name), number(at(document, "error"), name))));
  return fmt::format("The experiment {} reads {}.", word(document, "experiment"),
                     texts.empty() ? "what its tables hold" : fmt::format("{}", fmt::join(texts, ", ")));
}

std::string of_study(const Result& result) {
  const auto& document = result.document;
  std::string best, worst;
  double least = INFINITY, largest = 0;
  if (const auto& algorithms = at(document, "algorithms"); algorithms.is_object())
    for (const auto& [name, algorithm] : algorithms.items()) {
      const double median = number(at(algorithm, "error"), "median");
      if (median < least) least = median, best = name;
      if (median > largest) largest = median, worst = name;
    }
  auto text = fmt::format("{} random oscillators were followed exactly and by the published algorithms",
                          number_text(number(document, "cases")));
  if (!best.empty())
    text += fmt::format("; half of the errors of {} are below {}, of {} below {}", best, number_text(least, 2), worst,
                        number_text(largest, 2));
  return text + ".";
}

std::string of_verify(const Result& result) {
  std::map<std::string, std::size_t> verdicts;
  for (const auto& answer : list(result.document, "cases")) ++verdicts[word(answer, "verdict")];
  std::vector<std::string> counts;
  for (const auto& [verdict, n] : verdicts) counts.push_back(fmt::format("{}: {}", verdict, n));
  return fmt::format("{} numbers of others were asked for again. {}.", list(result.document, "cases").size(),
                     fmt::join(counts, ", "));
}

}  // namespace

std::string verdict_of(const Result& result) {
  const std::map<std::string, std::string (*)(const Result&)> by_label = {{"stability", of_stability},
                                                                          {"cycle", of_cycle},
                                                                          {"run", of_run},
                                                                          {"map", of_map},
                                                                          {"curve", of_curve},
                                                                          {"branch", of_branch},
                                                                          {"sweep", of_sweep},
                                                                          {"basin", of_basin},
                                                                          {"lyapunov", of_lyapunov},
                                                                          {"compare", of_compare},
                                                                          {"design", of_compare},
                                                                          {"frf", of_frf},
                                                                          {"fit", of_fit},
                                                                          {"lab", of_lab},
                                                                          {"study", of_study},
                                                                          {"verify", of_verify}};
  const auto found = by_label.find(result.label);
  const auto text = found == by_label.end() ? std::string() : found->second(result);
  if (!text.empty()) return text;
  const auto outcome = word(result.document, "outcome");
  return outcome == "reached the end" ? "The work reached the end." : fmt::format("The work ended short: {}.", outcome);
}

std::vector<std::string> assumptions_of(const Result& result) {
  const auto& document = result.document;
  std::vector<std::string> list;
  const auto is = [&](std::string_view path, double value) { return parameter(result, path) == value; };
  if (result.label == "map") {
    const auto& cost = at(document, "cost");
    const double integrated = number(cost, "integrated"), between = number(cost, "interpolated"),
                 skipped = number(cost, "skipped");
    if (std::isfinite(integrated))
      list.push_back(
          fmt::format("{:.0f} points were integrated{}{}.", integrated,
                      between > 0 ? fmt::format(", {:.0f} interpolated between them to the tolerance", between) : "",
                      skipped > 0 ? fmt::format(", and {:.0f} left out, because steady sliding is stable there "
                                                "and no cycle can exist beside it",
                                                skipped)
                                  : ""));
  }
  if (is("law.lambda", 0))
    list.emplace_back("λ = 0: the states of friction are in equilibrium at any time, a friction curve.");
  if (is("oscillator.mass", 0)) list.emplace_back("The slider has no mass: inertia is left out.");
  const auto& parameters = at(result.manifest, "parameters");
  bool spring = false;
  if (parameters.is_object())
    for (const auto& [path, value] : parameters.items())
      spring = spring || (path.starts_with("law.contact_stiffness") && number(value, "value") > 0 &&
                          std::isfinite(number(value, "value")));
  if (parameters.is_object() && !parameters.empty() && !spring)
    list.emplace_back("The contact is rigid: no spring stands in series with the law (law.contact_stiffness).");
  if (const auto approximation = word(document, "approximation"); !approximation.empty())
    list.push_back("The law is computed only nearly: " + approximation + ".");
  if (const auto& tolerance = at(result.manifest, "tolerance"); number(tolerance, "asked") > 0) {
    list.push_back(
        fmt::format("Numbers were asked for to a relative accuracy of {}", number_text(number(tolerance, "asked"), 2)));
    if (const double reached = number(tolerance, "reached"); reached > 0 && reached < 1)  // else of a number near 0
      list.back() += fmt::format("; the largest that is estimated is {}", number_text(reached, 2));
    list.back() += ".";
  }
  for (const auto* from : {&document, &result.manifest})
    for (const auto& note : report::at(*from, "notes").is_array() ? report::at(*from, "notes") : ordered_json::array())
      if (note.is_string() && std::ranges::find(list, note.get<std::string>()) == list.end())
        list.push_back(note.get<std::string>());
  return list;
}

}  // namespace rosin::app::report
