/// JSON that is bounded while it is parsed.
#include "app/output/document.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"

namespace rosin::app::output {

using nlohmann::ordered_json;

ordered_json parse_document(const std::string& path, const std::string& text) {
  constexpr int deepest = 100;  // levels: copies, comparisons and texts of a document go as deep into the stack
  constexpr std::size_t most = 50'000'000;
  using Event = ordered_json::parse_event_t;
  int level = 0;
  std::size_t count = 0;
  const auto bounded = [&](int, Event event, ordered_json&) {
    const bool begins = event == Event::object_start || event == Event::array_start;
    level += begins ? 1 : event == Event::object_end || event == Event::array_end ? -1 : 0;
    count += begins || event == Event::value;
    if (level > deepest) throw InputError(fmt::format("{}: lies more than {} levels deep", path, deepest));
    if (count > most) throw InputError(fmt::format("{}: holds more than {} values", path, most));
    return true;
  };
  try {
    auto document = ordered_json::parse(text, bounded);
    if (!document.is_object()) throw InputError(fmt::format("{}: holds no results, but something else", path));
    return document;
  } catch (const ordered_json::parse_error& error) {
    const auto place = std::min(error.byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(place), '\n');
    throw InputError(fmt::format("{}:{}: is damaged, no JSON from byte {} of {} on; compute it again", path, line,
                                 place, text.size()));
  }
}

}  // namespace rosin::app::output
