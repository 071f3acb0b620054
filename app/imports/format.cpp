/// The list of formats, and which of them a text is.
#include "app/imports/format.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/program_list.hpp"
#include "core/error.hpp"

namespace rosin::app::imports {

#define ROSIN_FORMAT(name) Format name##_format();
#include "app/imports/formats.def"
#undef ROSIN_FORMAT

const std::vector<Format>& formats() {
  static const std::vector<Format> list = {
#define ROSIN_FORMAT(name) name##_format(),
#include "app/imports/formats.def"
#undef ROSIN_FORMAT
  };
  return list;
}

const Format& format_of(std::string_view name, const std::string& path, std::string_view text) {
  std::vector<std::string> names;
  for (const auto& format : formats()) {
    if (name == format.name) return format;
    names.emplace_back(format.name);
  }
  if (!name.empty()) {
    const auto near = nearest_name(name, names);
    throw InputError(fmt::format("--as {} is no format that is read{}; there are {}", name,
                                 near.empty() ? "" : fmt::format("; did you mean '{}'?", near), listed(formats())));
  }
  const auto likest =
      std::ranges::max_element(formats(), {}, [&](const Format& format) { return format.likeness(text); });
  if (likest->likeness(text) > 0) return *likest;
  throw InputError(fmt::format("{}: looks like no input of {}; say which by --as", path, listed(formats())));
}

}  // namespace rosin::app::imports
