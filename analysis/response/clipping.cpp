/// Counting samples at the ends of a record.
#include "analysis/response/clipping.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace rosin::analysis::response {

void ClippingWatch::Top::add(double x) {
  constexpr long flat = 3;  // samples that make a run
  if (x > first) {
    second = first, of_second = of_first;
    first = x, of_first = run = 1, runs = 0;
  } else if (x == first) {
    ++of_first, ++run;
    runs += run == flat;
  } else {
    run = 0;
    if (x > second) second = x, of_second = 0;
    of_second += x == second;
  }
}

std::optional<ClippingWatch::End> ClippingWatch::Top::found(double sign) const {
  constexpr long several = 2, far_more = 8;
  if (runs < several || of_first < far_more * of_second) return std::nullopt;
  return End{sign * first, of_first};
}

std::string clipping_warning(const ClippingWatch& watch, std::string_view name, std::string_view unit, long samples) {
  std::string text;
  for (const auto& [end, which] : {std::pair{watch.high(), "largest"}, std::pair{watch.low(), "least"}})
    if (end)
      text += fmt::format("{}{} is flat at its {} value, {:.6g}{}, in {} of {} samples", text.empty() ? "" : "; ", name,
                          which, end->value, unit == "1" ? "" : fmt::format(" {}", unit), end->samples, samples);
  if (!text.empty())
    text += ": what lay beyond a sensor's limit is cut off (clipping), which biases what is read from it";
  return text;
}

}  // namespace rosin::analysis::response
