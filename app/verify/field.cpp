/// Paths through JSON documents.
#include "app/verify/field.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.hpp"

namespace rosin::app::verify {

using nlohmann::ordered_json;

namespace {

constexpr long to_the_end = std::numeric_limits<long>::max();

struct Function {
  const char* name;
  ordered_json (*of)(const ordered_json& value);
  ordered_json (*error)(const ordered_json& error, const ordered_json& value);
};

/// All numbers of a list, or of lists in it.
std::vector<double> numbers_in(const ordered_json& value) {
  if (value.is_number()) return {value.get<double>()};
  std::vector<double> all;
  if (value.is_array())
    for (const auto& entry : value)
      for (const double x : numbers_in(entry)) all.push_back(x);
  return all;
}
std::vector<double> some_numbers_in(const ordered_json& value) {
  auto all = numbers_in(value);
  if (all.empty()) throw InputError("there is no number to take it of");
  return all;
}
ordered_json largest(const ordered_json& value) { return std::ranges::max(some_numbers_in(value)); }
ordered_json smallest(const ordered_json& value) { return std::ranges::min(some_numbers_in(value)); }
ordered_json mean(const ordered_json& value) {
  const auto all = some_numbers_in(value);
  double sum = 0;
  for (const double x : all) sum += x;
  return sum / double(all.size());
}
ordered_json count(const ordered_json& value) {
  if (!value.is_array()) throw InputError("only entries of a list can be counted");
  return value.size();
}
ordered_json modulus(const ordered_json& value) {
  if (!value.is_array() || value.empty()) throw InputError("a modulus is that of a pair [re, im]");
  if (value.size() == 2 && value[0].is_number() && value[1].is_number())
    return std::hypot(value[0].get<double>(), value[1].get<double>());
  auto list = ordered_json::array();
  for (const auto& entry : value) list.push_back(modulus(entry));
  return list;
}
ordered_json logarithm(const ordered_json& value) {
  if (value.is_number()) return std::log(value.get<double>());
  if (!value.is_array()) throw InputError("there is no number to take it of");
  auto list = ordered_json::array();
  for (const auto& entry : value) list.push_back(logarithm(entry));
  return list;
}

ordered_json largest_error(const ordered_json& error, const ordered_json&) { return largest(error); }
ordered_json same_error(const ordered_json& error, const ordered_json&) { return error; }
ordered_json no_error(const ordered_json&, const ordered_json&) { return nullptr; }
ordered_json relative_error(const ordered_json& error, const ordered_json& value) {
  if (!value.is_array())
    return error.is_number() ? ordered_json(std::abs(error.get<double>() / value.get<double>())) : ordered_json();
  auto list = ordered_json::array();
  for (std::size_t i = 0; i < value.size(); ++i)
    list.push_back(relative_error(error.is_array() && i < error.size() ? error[i] : error, value[i]));
  return list;
}

constexpr Function functions[] = {
    {"max", largest, largest_error}, {"min", smallest, largest_error}, {"mean", mean, largest_error},
    {"count", count, no_error},      {"modulus", modulus, same_error}, {"log", logarithm, relative_error},
};
const Function* function_named(std::string_view name) {
  const auto* found = std::ranges::find_if(functions, [&](const Function& f) { return name == f.name; });
  return found == std::end(functions) ? nullptr : found;
}

std::optional<long> whole(std::string_view text) {
  long value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string keys_of(const ordered_json& table) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : table.items()) keys.push_back(key);
  return fmt::format("{}", fmt::join(keys, ", "));
}

}  // namespace

Field::Field(const std::string& text) : text_(text) {
  std::string_view path = text;
  if (const auto open = path.find('('); open != std::string_view::npos) {
    function_ = path.substr(0, open);
    if (!path.ends_with(')') || !function_named(function_)) {
      std::vector<std::string_view> names;
      for (const auto& f : functions) names.emplace_back(f.name);
      throw InputError(
          fmt::format("'{}' is no path to a number; functions around a path are {}", text, fmt::join(names, ", ")));
    }
    path = path.substr(open + 1, path.size() - open - 2);
  }
  const auto refuse = [&](std::string_view why) { throw InputError(fmt::format("'{}' is no path: {}", text, why)); };
  for (bool begins = true; !path.empty(); begins = false) {
    if (path.front() == '[') {
      const auto close = path.find(']');
      if (close == std::string_view::npos) refuse("a bracket is not closed");
      const auto inside = path.substr(1, close - 1);
      if (const auto equals = inside.find('='); equals != std::string_view::npos) {
        steps_.emplace_back(Match{std::string(inside.substr(0, equals)), std::string(inside.substr(equals + 1))});
      } else if (const auto colon = inside.find(':'); colon != std::string_view::npos) {
        const auto from = inside.substr(0, colon), to = inside.substr(colon + 1);
        const auto begin = from.empty() ? 0 : whole(from), end = to.empty() ? to_the_end : whole(to);
        if (!begin || !end) refuse("a slice is [from:to], with whole numbers or none");
        steps_.emplace_back(Slice{*begin, *end});
      } else if (const auto at = whole(inside)) {
        steps_.emplace_back(Index{*at});
      } else {
        refuse("in brackets stands a whole number, a slice [from:to], or [key=text]");
      }
      path.remove_prefix(close + 1);
      continue;
    }
    if (!begins) {
      if (path.front() != '.') refuse("names are joined by dots");
      path.remove_prefix(1);
    }
    const bool quoted = path.starts_with('"');
    if (quoted) path.remove_prefix(1);
    const auto end = quoted ? path.find('"') : std::min(path.find_first_of(".["), path.size());
    if (end == std::string_view::npos) refuse("a quotation mark is not closed");
    if (end == 0) refuse("a name is empty");
    steps_.emplace_back(Name{std::string(path.substr(0, end))});
    path.remove_prefix(end + (quoted ? 1 : 0));
  }
  if (steps_.empty()) refuse("it is empty");
}

ordered_json Field::follow(const ordered_json& here, const Step& step) {
  if (const auto* name = std::get_if<Name>(&step)) {
    if (here.is_array()) {
      auto list = ordered_json::array();
      for (const auto& entry : here) list.push_back(follow(entry, step));
      return list;
    }
    if (!here.is_object()) throw InputError(fmt::format("there is no table in which to look for '{}'", name->key));
    if (!here.contains(name->key))
      throw InputError(fmt::format("there is no '{}'; there are {}", name->key, keys_of(here)));
    return here.at(name->key);
  }
  if (!here.is_array()) throw InputError("brackets go with lists only");
  const auto size = static_cast<long>(here.size());
  const auto from_start = [&](long at) { return at < 0 ? at + size : at; };
  if (const auto* index = std::get_if<Index>(&step)) {
    const long at = from_start(index->at);
    if (at < 0 || at >= size) throw InputError(fmt::format("there is no entry [{}] among {}", index->at, size));
    return here.at(static_cast<std::size_t>(at));
  }
  auto list = ordered_json::array();
  if (const auto* slice = std::get_if<Slice>(&step)) {
    const long begin = std::max(0L, from_start(slice->from));
    const long end = std::min(size, slice->to == to_the_end ? size : from_start(slice->to));
    for (long i = begin; i < end; ++i) list.push_back(here.at(static_cast<std::size_t>(i)));
    return list;
  }
  const auto& match = std::get<Match>(step);
  for (const auto& entry : here) {
    if (!entry.is_object() || !entry.contains(match.key))
      throw InputError(fmt::format("an entry of the list has no '{}'", match.key));
    const auto& value = entry.at(match.key);
    if ((value.is_string() ? value.get<std::string>() : value.dump()) == match.value) list.push_back(entry);
  }
  return list;
}

ordered_json Field::of_path(const ordered_json& document) const {
  auto value = document;
  for (const auto& step : steps_) value = follow(value, step);
  return value;
}

ordered_json Field::of(const ordered_json& document) const {
  try {
    const auto value = of_path(document);
    return function_.empty() ? value : function_named(function_)->of(value);
  } catch (const InputError& error) {
    throw InputError(fmt::format("'{}' leads nowhere: {}", text_, error.what()));
  }
}

ordered_json Field::error_of(const ordered_json& document) const {
  const auto last =
      std::find_if(steps_.rbegin(), steps_.rend(), [](const Step& step) { return std::holds_alternative<Name>(step); });
  if (last == steps_.rend()) return nullptr;
  const auto named = static_cast<std::size_t>(steps_.rend() - last) - 1;  // its place in the path
  const bool is_value = std::get<Name>(steps_[named]).key == "value";
  for (const std::size_t above : {named, std::size_t(0)}) {  // beside it, or that of the whole document
    try {
      auto error = document;
      for (std::size_t i = 0; i < above; ++i) error = follow(error, steps_[i]);
      error = follow(error, Name{"error"});
      const bool alone = is_value && above == named && numbers_in(error).size() == numbers_in(of_path(document)).size();
      if (!alone) error = follow(error, steps_[named]);
      for (std::size_t i = named + 1; i < steps_.size() && error.is_array(); ++i) error = follow(error, steps_[i]);
      if (function_.empty() || error.is_null()) return error;
      const auto& function = *function_named(function_);
      return function.error(error, function.of == logarithm ? of_path(document) : ordered_json());
    } catch (const InputError&) {  // none stated here: perhaps further up
    }
  }
  return nullptr;
}

}  // namespace rosin::app::verify
