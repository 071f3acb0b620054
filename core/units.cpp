/// Units by UDUNITS-2. The library keeps global parser state, so that one lock guards every call.
#include "core/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>

#include "core/error.hpp"
#include "core/turning.hpp"

namespace rosin {

namespace {

using Unit = std::unique_ptr<ut_unit, decltype(&ut_free)>;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t";
  const auto begin = text.find_first_not_of(blank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

/// Units of laboratories that UDUNITS does not know, or knows by another spelling. Whole texts, and whole words in
/// them.
struct Spelling {
  std::string_view written, meant;
};
constexpr Spelling text_spellings[] = {
    {"r/min", "turn/min"},    {"U/min", "turn/min"},    {"tr/min", "turn/min"},   {"r/s", "turn/s"},
    {"U/s", "turn/s"},        {"tr/s", "turn/s"},       {"r.p.m.", "rpm"},        {"kgm2", "kg m2"},
    {"kgm^2", "kg m2"},       {"kgm\u00b2", "kg m2"},   {"mm/mm", "1"},           {"m/m", "1"},
    {"\u00b5strain", "1e-6"}, {"\u00b5\u03b5", "1e-6"}, {"\u03bc\u03b5", "1e-6"}, {"u\u03b5", "1e-6"}};
constexpr Spelling word_spellings[] = {
    {"RPM", "rpm"},  {"Rpm", "rpm"},   {"Upm", "rpm"},    {"upm", "rpm"},      {"rev", "turn"},        {"revs", "turn"},
    {"Rev", "turn"}, {"Umdr", "turn"}, {"deg", "degree"}, {"Nm", "N m"},       {"mNm", "mN m"},        {"cNm", "cN m"},
    {"kNm", "kN m"}, {"MNm", "MN m"},  {"Ncm", "N cm"},   {"Nmm", "N mm"},     {"Ns", "N s"},          {"Nms", "N m s"},
    {"kNs", "kN s"}, {"mic", "um"},    {"mics", "um"},    {"kp", "kgf"},       {"KN", "kN"},           {"MPA", "MPa"},
    {"Mpa", "MPa"},  {"KPa", "kPa"},   {"kPA", "kPa"},    {"KHz", "kHz"},      {"HZ", "Hz"},           {"Sec", "s"},
    {"mins", "min"}, {"hrs", "h"},     {"strain", "1"},   {"ustrain", "1e-6"}, {"microstrain", "1e-6"}};

/// In UDUNITS' own words, with the powers \u207b\u00b9 and the dot that it does not know.
std::string spelt_for_udunits(std::string_view text) {
  for (const auto& [written, meant] : text_spellings)
    if (text == written) return std::string(meant);
  constexpr Spelling signs[] = {
      {"\u207b\u00b9", "-1"}, {"\u207b\u00b2", "-2"}, {"\u207b\u00b3", "-3"}, {"\u22c5", "."}};
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  std::string result;
  while (!text.empty()) {
    std::size_t length = 0;
    while (length < text.size() && is_letter(text[length])) ++length;
    const auto word = text.substr(0, length);
    text.remove_prefix(length);
    const auto* known = std::ranges::find(word_spellings, word, &Spelling::written);
    if (length > 0 && known != std::end(word_spellings)) {
      const auto power = text.substr(0, result.ends_with('/') ? text.find_first_of(" /*.") : 0);
      result += result.ends_with('/') ? fmt::format("({}{})", known->meant, power) : known->meant;  // N/Nm is 1/m
      text.remove_prefix(power.size());
      continue;
    }
    result += word;
    if (length > 0) continue;
    const auto* sign = std::ranges::find_if(signs, [&](const auto& one) { return text.starts_with(one.written); });
    const bool found = sign != std::end(signs);
    result += found ? sign->meant : text.substr(0, 1);
    text.remove_prefix(found ? sign->written.size() : 1);
  }
  return result;
}

/// The unit database, read once, and the lock that every use of it holds.
class Database {
 public:
  static Database& get() {
    static Database database;
    return database;
  }
  std::mutex lock;

  /// A null unit where the text is none.
  Unit parse(std::string_view text) const {
    const std::string copy(trimmed(text));
    Unit unit{ut_parse(system_.get(), copy.c_str(), UT_UTF8), &ut_free};
    if (!unit) unit.reset(ut_parse(system_.get(), spelt_for_udunits(copy).c_str(), UT_UTF8));
    return unit;
  }

 private:
  Database() : system_(nullptr, &ut_free_system) {
    ut_set_error_message_handler(ut_ignore);  // it would write warnings to standard error
    system_.reset(ut_read_xml(nullptr));
    if (!system_)
      throw InputError(
          "the unit database of UDUNITS-2 is missing: install the package libudunits2-data, or point the "
          "environment variable UDUNITS2_XML_PATH at udunits2.xml");
  }
  std::unique_ptr<ut_system, decltype(&ut_free_system)> system_;
};

/// UDUNITS also converts between reciprocal units (s and Hz); here only the same dimension counts.
bool same_dimension(const Unit& a, const Unit& b) {
  const Unit ratio{ut_divide(a.get(), b.get()), &ut_free};
  return ratio && ut_are_convertible(a.get(), b.get()) && ut_is_dimensionless(ratio.get());
}

/// `x` in the other unit. Decimal prefixes below one divide by a whole number, so that 10 um is 1e-5 m to the last bit.
double convert(double x, const Unit& from, const Unit& to) {
  const std::unique_ptr<cv_converter, decltype(&cv_free)> converter{ut_get_converter(from.get(), to.get()), &cv_free};
  const double factor = cv_convert_double(converter.get(), 1.0), whole = std::round(1 / factor);
  const bool offset = cv_convert_double(converter.get(), 0.0) != 0;
  if (!offset && factor < 1 && whole < 1e15 && std::abs(whole * factor - 1) < 1e-14) return x / whole;
  return cv_convert_double(converter.get(), x);
}

/// Where a power in the unit is no whole number, as in "Pa/m^2.5", which UDUNITS does not know.
bool has_decimal_power(std::string_view unit) {
  for (auto at = unit.find('^'); at != std::string_view::npos; at = unit.find('^', at + 1)) {
    const auto end = unit.find_first_not_of("+-0123456789", at + 1);
    if (end != std::string_view::npos && unit[end] == '.' && end + 1 < unit.size() &&
        std::isdigit(static_cast<unsigned char>(unit[end + 1])))
      return true;
  }
  return false;
}

/// Of factors to any powers, beside each other or divided one by one: "kg m^-0.5/s", "N s/m^3.5".
std::optional<TextUnit> parse_decimal_powers(std::string_view unit) {
  if (!has_decimal_power(unit)) return parse_unit(unit);
  TextUnit product;
  for (double side = 1; !unit.empty();) {
    const auto end = unit.find_first_of(" */");
    const auto factor = unit.substr(0, end);
    if (!factor.empty()) {
      const auto caret = factor.find('^');
      double power = 1;
      if (caret != std::string_view::npos) {
        const auto text = factor.substr(caret + 1);
        const auto [stop, problem] = std::from_chars(text.data(), text.data() + text.size(), power);
        if (problem != std::errc{} || stop != text.data() + text.size()) return std::nullopt;
      }
      const auto base = parse_unit(factor.substr(0, caret));
      if (!base || base->offset) return std::nullopt;
      product.dimension = product.dimension * base->dimension.power(side * power);
      product.factor *= std::pow(base->factor, side * power);
      side = 1;
    }
    if (end == std::string_view::npos) break;
    if (unit[end] == '/') side = -1;
    unit.remove_prefix(end + 1);
  }
  return product;
}

constexpr std::array<std::string_view, 7> base_units = {"m", "kg", "s", "A", "K", "mol", "cd"};

/// With the power of the radian, which is 1 of SI.
struct Parts : TextUnit {
  int angle = 0;
};

/// Takes a unit of UDUNITS apart.
ut_status take_basic(const ut_unit* unit, int power, Parts& taken) {
  const char* symbol = ut_get_symbol(unit, UT_ASCII);
  for (std::size_t i = 0; symbol && i < base_units.size(); ++i)
    if (base_units[i] == symbol) taken.dimension.exponent[i] += power;
  if (symbol && std::string_view(symbol) == "rad") taken.angle += power;
  return UT_SUCCESS;
}
constexpr ut_visitor unit_parts{
    .visit_basic = [](const ut_unit* unit, void* to) { return take_basic(unit, 1, *static_cast<Parts*>(to)); },
    .visit_product =
        [](const ut_unit*, int count, const ut_unit* const* basic, const int* powers, void* to) {
          for (int i = 0; i < count; ++i) take_basic(basic[i], powers[i], *static_cast<Parts*>(to));
          return UT_SUCCESS;
        },
    .visit_galilean =
        [](const ut_unit*, double scale, const ut_unit* underlying, double offset, void* to) {
          auto& taken = *static_cast<Parts*>(to);
          taken.factor *= scale;
          taken.offset |= offset != 0;
          return ut_accept_visitor(underlying, &unit_parts, to);
        },
    .visit_timestamp =
        [](const ut_unit*, const ut_unit*, double, void* to) {
          static_cast<Parts*>(to)->offset = true;
          return UT_SUCCESS;
        },
    .visit_logarithmic =
        [](const ut_unit*, double, const ut_unit*, void* to) {
          static_cast<Parts*>(to)->offset = true;
          return UT_SUCCESS;
        }};

std::optional<Parts> taken_apart(const Unit& unit) {
  Parts taken;
  if (!unit || ut_accept_visitor(unit.get(), &unit_parts, &taken) != UT_SUCCESS) return std::nullopt;
  return taken;
}

/// A rate of turning and a frequency differ by 2 pi, an angle and a bare number do where turns are counted; only rad/s
/// and 1/s are the same.
void require_clear_angle(std::string_view text, std::string_view unit, std::string_view si_unit, const Parts& given,
                         const Parts& wanted) {
  if ((given.angle != 0) == (wanted.angle != 0)) return;
  const bool rate = given.dimension == Dimension{.exponent = {0, 0, -1}};
  const bool in_hertz = (unit.find("Hz") != std::string_view::npos) || si_unit == "Hz";
  if (rate && given.factor == 1 && !in_hertz) return;
  if (rate && wanted.angle != 0)
    throw UnclearAngle(
        fmt::format("'{}' is a frequency, but an angular frequency is needed: rad/s is 2 pi times Hz; write rad/s, or "
                    "turns as rev/min or rev/s",
                    text));
  if (rate)
    throw UnclearAngle(
        fmt::format("'{}' is an angular frequency, but a frequency is needed: rad/s is 2 pi times Hz; write {}, or "
                    "turns a minute as 1/min",
                    text, si_unit));
  if (given.dimension == Dimension{} && wanted.angle != 0)
    throw UnclearAngle(fmt::format("'{}' may be radians, degrees or turns; write rad, deg or rev", text));
}

double converted(std::string_view text, std::string_view si_unit, bool rotates) {
  const std::string_view body = trimmed(text);
  const std::string_view digits = body.starts_with('+') ? body.substr(1) : body;
  double number = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (problem == std::errc::result_out_of_range)
    throw InputError(fmt::format("'{}' is too large or too small for a number", text));
  if (problem != std::errc{})
    throw InputError(fmt::format("'{}' is not a number with a unit, such as \"3 {}\"", text, si_unit));
  const std::string_view unit = trimmed(digits.substr(static_cast<std::size_t>(end - digits.data())));
  if (unit.empty()) return number;

  if (has_decimal_power(unit) || has_decimal_power(si_unit)) {
    const auto given = parse_decimal_powers(unit), wanted = parse_decimal_powers(si_unit);
    if (!given) throw InputError(fmt::format("'{}' is not a known unit (in '{}'; needed is {})", unit, text, si_unit));
    if (!wanted || !(given->dimension == wanted->dimension))
      throw InputError(fmt::format("'{}' is in {}, but needed is {}", text, unit, si_unit));
    return number * (given->factor / wanted->factor);
  }
  auto& database = Database::get();
  const std::lock_guard guard(database.lock);
  const Unit given = database.parse(unit), wanted = database.parse(si_unit);
  if (!wanted) throw InputError(fmt::format("'{}' is not a known unit", si_unit));
  // A second number ("2 3 m") would silently multiply; only a reciprocal may begin with a digit.
  const bool second_number = std::isdigit(static_cast<unsigned char>(unit.front())) && unit != "1" &&
                             !unit.starts_with("1/") && !unit.starts_with("1 /");
  if (!given || second_number)
    throw InputError(
        fmt::format("'{}' is not a known unit (in '{}'; needed is {})", unit, text, readable_unit(si_unit)));
  if (!same_dimension(given, wanted))
    throw InputError(fmt::format("'{}' is in {}, but needed is {}", text, unit, readable_unit(si_unit)));
  const auto parts = taken_apart(given), wanted_parts = taken_apart(wanted);
  if (rotates && parts && parts->angle == 0) {
    constexpr double per_minute = 1 / 60.0;
    if (unit.find("Hz") == std::string_view::npos && std::abs(parts->factor / per_minute - 1) < 1e-12)
      return convert(number, given, wanted) * 2 * std::numbers::pi;
    throw UnclearAngle(
        fmt::format("'{}' of something that rotates may count turns or radians; write rev/s or rad/s", text));
  }
  if (parts && wanted_parts) require_clear_angle(text, unit, si_unit, *parts, *wanted_parts);
  return convert(number, given, wanted);
}

double whole_if_near(double x) { return std::abs(x - std::round(x)) < 1e-12 ? std::round(x) : x; }

}  // namespace

double to_si(std::string_view text, std::string_view si_unit) { return converted(text, si_unit, false); }
double turning_to_si(std::string_view text) { return converted(text, "rad/s", true); }

bool unit_known(std::string_view unit) {
  auto& database = Database::get();
  const std::lock_guard guard(database.lock);
  return database.parse(unit) != nullptr;
}

Dimension Dimension::operator*(const Dimension& other) const {
  Dimension result;
  for (std::size_t i = 0; i < exponent.size(); ++i) result.exponent[i] = whole_if_near(exponent[i] + other.exponent[i]);
  return result;
}
Dimension Dimension::operator/(const Dimension& other) const { return *this * other.power(-1); }
Dimension Dimension::power(double p) const {
  Dimension result;
  for (std::size_t i = 0; i < exponent.size(); ++i) result.exponent[i] = whole_if_near(exponent[i] * p);
  return result;
}

std::string coherent_unit(const Dimension& dimension) {
  std::string above, below;
  int divisors = 0;
  for (std::size_t i = 0; i < base_units.size(); ++i) {
    const double power = dimension.exponent[i];
    if (power == 0) continue;
    auto& part = power > 0 ? above : below;
    divisors += power < 0;
    if (!part.empty()) part += ' ';
    part += base_units[i];
    if (std::abs(power) != 1) part += fmt::format("^{}", std::abs(power));
  }
  if (above.empty()) above = "1";
  if (divisors == 0) return above;
  return divisors == 1 ? above + '/' + below : above + "/(" + below + ')';
}

std::optional<TextUnit> parse_unit(std::string_view text) {
  auto& database = Database::get();
  const std::lock_guard guard(database.lock);
  return taken_apart(database.parse(text));
}

}  // namespace rosin
