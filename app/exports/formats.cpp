/// The list of formats.
#include "app/exports/series.hpp"

namespace rosin::app::exports {

#define ROSIN_FORMAT(name) Format name##_format();
#include "app/exports/formats.def"
#undef ROSIN_FORMAT

const std::vector<Format>& formats() {
  static const std::vector<Format> list = {
#define ROSIN_FORMAT(name) name##_format(),
#include "app/exports/formats.def"
#undef ROSIN_FORMAT
  };
  return list;
}

}  // namespace rosin::app::exports
