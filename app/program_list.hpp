/// Programs whose formats are read or written, as options and messages list them.
#pragma once
#include <fmt/format.h>

#include <string>
#include <vector>

namespace rosin::app {

/// "rsfmodel (scripts …), qdyn (…)": names with what of each program is meant.
template <class Format>
std::string listed(const std::vector<Format>& formats) {
  std::string list;
  for (const auto& format : formats)
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", format.name, format.what);
  return list;
}

}  // namespace rosin::app
