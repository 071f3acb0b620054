/// Symbols, units and meanings of what stands in documents.
#include "app/report/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "analysis/cycles/cycle.hpp"
#include "app/output/digits.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/symbols.hpp"
#include "app/report/folder.hpp"
#include "oscillators/model.hpp"

namespace rosin::app::report {

namespace {

/// Of metrics, unit and meaning come from their own list.
const std::map<std::string, Known, std::less<>>& table() {
  static const auto known = [] {
    std::map<std::string, Known, std::less<>> list = {
        {"time", {"", "s", "time"}},
        {"displacement", {"", "m", "of the slider from the unstretched spring, positive where friction pulls"}},
        {"velocity", {"", "m/s", "of the slider"}},
        {"acceleration", {"", "m/s^2", "of the slider"}},
        {"slip_rate", {"", "m/s", "V − ẋ, of the surfaces against each other"}},
        {"friction_force", {"", "N", "on the slider"}},
        {"friction_coefficient", {"", "1", "friction over normal load"}},
        {"normal_load", {"", "N", "normal force"}},
        {"theta", {"", "s", "mean age of the contacts"}},
        {"psi", {"", "1", "state of the interface"}},
        {"phi", {"", "1", "state of the interface"}},
        {"angular_frequency", {"", "rad/s", "of the oscillation"}},
        {"frequency", {"", "Hz", "of the oscillation"}},
        {"growth_rate", {"", "1/s", "of small motions; positive: they grow"}},
        {"damping_ratio", {"", "1", "decay over frequency; negative: it grows"}},
        {"first_lyapunov_coefficient",
         {"", "1/s", "sign of the cubic term at onset; negative: vibration sets in softly"}},
        {"criticality", {"", "", "supercritical: sets in softly; subcritical: with a jump"}},
        {"eigenvalues", {"", "1/s", "of small motions about steady sliding"}},
        {"multipliers", {"", "1", "factor of a small change after one period"}},
        {"exponents", {"", "1/s", "mean rate at which neighbouring motions part"}},
        {"growth", {"", "1", "logarithm of the amplitude's growth in one period"}},
        {"sum", {"", "1/s", "of all exponents"}},
        {"divergence", {"", "1/s", "mean divergence of the motion, equal to the sum of exponents"}},
        {"duration", {"", "s", "over which is averaged"}},
        {"transient", {"", "s", "left out before"}},
        {"switches", {"", "1", "number of changes between stick and slip"}},
        {"returns", {"", "1", "of the map until the motion recurred"}},
        {"stick_threshold", {"", "1", "slip slower than ε V counts as stick"}},
        {"tolerance", {"", "1", "relative accuracy asked for"}},
        {"share", {"", "1", "of starts that come here"}},
        {"standard_error", {"", "", "of the estimate"}},
        {"chi_square", {"", "1", "sum of squared residuals over their variance"}},
        {"points", {"", "1", "number of data"}},
        {"confidence", {"", "1", "probability that an interval is meant to hold"}},
        {"aic", {"", "1", "information criterion of Akaike; the lower the better"}},
        {"bic", {"", "1", "Bayesian information criterion; the lower the better"}},
        {"margin", {"", "1", "least distance of the loop to −1"}},
        {"margin_frequency", {"", "Hz", "at which the loop comes nearest to −1"}},
        {"coherence", {"", "1", "part of the answer that is linear in the input"}},
        {"recurrence", {"", "s", "from one slip event to the next"}},
        {"force_drop", {"", "N", "fall of the spring's force in a slip event"}},
        {"closed_form", {"", "", "whether the value is that of a formula"}},
        {"marginal", {"", "", "an eigenvalue lies on the imaginary axis within its error"}},
        {"stable", {"", "", "small disturbances die out"}},
        {"displacement_max", {"", "m", "largest displacement of the period"}},
        {"displacement_min", {"", "m", "least displacement of the period"}},
        {"amplitude", {"", "m", "half the range of the displacement"}},
        {"lyapunov", {"", "1/s", "largest Lyapunov exponent; positive: chaos"}},
        {"friction_work", {"", "J", "done by friction"}},
        {"wear_work_rate", {"", "W", "load times slip rate, mean"}},
        {"event_time_error", {"", "s", "largest error of the time of an event"}},
        {"choices", {"", "1", "switches in which the order that contacts give way in decides what follows"}},
        {"path_length", {"", "m", "of the slider's way"}},
        {"stick_time", {"", "s", "in which nothing slips"}},
        {"pressure", {"", "Pa", "of the contact"}},
        {"apparent_friction", {"", "1", "mean friction over mean normal load"}},
        {"profile_height", {"", "m", "of the surface under the contact, above its mean level"}},
        {"friction_drop", {"", "1", "mean friction less than in steady sliding on the mean level of the profile"}},
        {"open_fraction", {"", "1", "of the contact, lifted off"}},
        {"full_stick_fraction", {"", "1", "of the time in which the whole contact sticks"}},
        {"centre_x_period", {"", "s", "of the motion along the belt"}},
        {"centre_y_period", {"", "s", "of the motion normal to the belt"}},
        {"tilt_period", {"", "s", "of the tilting"}},
        {"low_frequency_limit", {"", "N s/m", "of the response, slope of the steady friction curve"}},
        {"high_frequency_limit", {"", "N s/m", "of the response, direct effect"}},
        {"high_frequency_stiffness", {"", "N/m", "of the response, friction over displacement"}},
        {"transient_length", {"", "1", "periods until Helmholtz motion"}},
        {"drive.normal_load", {"", "N", "normal load"}},
        {"drive.speed", {"", "m/s", "speed of the drive"}},
        {"drive.force", {"", "N", "force on the slider along its motion"}},
        {"oscillator.mass", {"", "kg", "mass of the slider"}},
        {"oscillator.stiffness", {"", "N/m", "stiffness of the spring"}},
        {"oscillator.damping", {"", "N s/m", "damping of the slider's motion"}},
        {"law.lambda", {"", "1", "clock factor of the states"}},
        {"law.mu_s", {"", "1", "largest coefficient at rest"}},
        {"law.mu_d", {"", "1", "coefficient in motion"}},
        {"law.v_s", {"", "m/s", "speed over which friction falls"}},
        {"law.mu0", {"", "1", "friction in steady sliding at v0"}},
        {"law.v0", {"", "m/s", "reference slip rate"}},
        {"law.a", {"", "1", "direct effect"}},
        {"law.b", {"", "1", "evolution effect"}},
        {"law.L", {"", "m", "slip that renews the contacts"}},
    };
    for (const auto& metric : analysis::cycles::metric_names()) list[metric.name] = {"", metric.unit, metric.meaning};
    for (auto& [name, of_name] : list) of_name.symbol = output::symbol_of(name);
    return list;
  }();
  return known;
}

bool is_number(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c); });
}

struct Reading {
  const char* word;        ///< empty: none
  std::string_view whole;  ///< the series that is read
};
/// What "displacement_max" reads off a series.
Reading reading_of(std::string_view key) {
  for (const auto& [ending, word] : {std::pair<std::string_view, const char*>{"_max", "largest"},
                                     {"_min", "least"},
                                     {"_mean", "mean"},
                                     {"_amplitude", "half the range"}})
    if (key.ends_with(ending)) return {word, key.substr(0, key.size() - ending.size())};
  return {"", key};
}

}  // namespace

Known known(std::string_view key) {
  if (const auto found = table().find(key); found != table().end()) return found->second;
  if (const auto dot = key.rfind('.'); dot != key.npos) return known(key.substr(dot + 1));
  // "slip_rate_2_max" and "slip_rate_2": of one of several contacts
  for (std::size_t from = key.find('_'); from != key.npos; from = key.find('_', from + 1)) {
    const auto end = std::min(key.find('_', from + 1), key.size());
    const auto place = key.substr(from + 1, end - from - 1);
    if (!is_number(place)) continue;
    auto of_one = known(std::string(key.substr(0, from)) + std::string(key.substr(end)));
    if (!of_one.meaning.empty()) of_one.meaning += fmt::format(" ({})", place);
    of_one.symbol.clear();
    return of_one;
  }
  for (const auto& [ending, unit] :
       {std::pair<std::string_view, const char*>{"_work", "J"}, {"_time", "s"}, {"_fraction", "1"}})
    if (key.ends_with(ending)) return {"", unit, ""};
  if (const auto [word, whole] = reading_of(key); *word) {
    const auto of_whole = known(whole);
    return {"", of_whole.unit, of_whole.meaning.empty() ? "" : fmt::format("{}: {}", word, of_whole.meaning)};
  }
  return {};
}

std::string unit_of(std::string_view key, const nlohmann::ordered_json& units) {
  for (const auto name : {key, reading_of(key).whole})
    if (const auto stated = units.find(name); stated != units.end() && stated->is_string()) return *stated;
  return known(key).unit;
}

std::string unit_of_parameter(const nlohmann::ordered_json& document) {
  if (const auto stated = word(document, "unit"); !stated.empty()) return stated;
  return known(word(document, "parameter")).unit;
}

std::string readable(std::string key) {
  std::ranges::replace(key, '_', ' ');
  return key;
}

namespace {

std::string superscript(int n) {
  const char* const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = n < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(n))) text += digits[c - '0'];
  return text;
}

/// "-8.4507e-05" as −8.4507·10⁻⁵.
std::string typeset(std::string text) {
  std::string power;
  if (const auto e = text.find('e'); e != text.npos) {
    power = "10" + superscript(std::stoi(text.substr(e + 1)));
    text.resize(e);
    if (text == "1" || text == "-1")
      text.pop_back();
    else
      power = "·" + power;
  }
  if (text.starts_with('-')) text = "−" + text.substr(1);
  return text + power;
}

}  // namespace

std::string number_text(double value, int digits) {
  if (std::isnan(value)) return "none";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  return typeset(fmt::format("{:.{}g}", value, digits));
}

std::string number_text(double value, double error, int digits) {
  if (!std::isfinite(value) || !(error > 0)) return number_text(value, digits);
  if (std::isinf(error)) return number_text(value, digits) + ", of unknown error";
  return fmt::format("{} ± {}", typeset(output::digits_by_error(value, error)), typeset(fmt::format("{:.1g}", error)));
}

std::string amount(double value, std::string_view unit, double error, int digits) {
  const auto [factor, prefixed] = output::scaled(std::string(unit), std::abs(value));
  auto text = number_text(value * factor, error * factor, digits);
  const bool has_unit = std::isfinite(value) && !unit.empty() && unit != "1";
  if (has_unit && text.find(" ± ") != text.npos && prefixed != unit) text = "(" + text + ")";
  return has_unit ? text + " " + prefixed : text;
}

std::string amount(double value, std::string_view unit) { return amount(value, unit, std::nan(""), 4); }

}  // namespace rosin::app::report
