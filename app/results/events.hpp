/// Events of motions as lists of objects.
#pragma once
#include <string>

#include "app/results/result.hpp"

namespace rosin::app::results {

/// Time, kind and place of each, which contact or coordinate it is of where there are several, its error where that is
/// known, and the speed of an impact. \param of_plane  the place has two numbers
template <class Event>
ordered_json events(const std::vector<Event>& list, bool of_plane = false) {
  auto array = ordered_json::array();
  for (const auto& event : list) {
    Object one;
    one.add({"time", "s"}, event.time);
    one["kind"] = event.kind;
    one["displacement"] = event.displacement;
    if constexpr (requires { event.displacement_y; })
      if (of_plane) one["displacement"] = {event.displacement, event.displacement_y};
    auto json = one.entry();
    if constexpr (requires { event.error; }) json["error"] = event.error;
    if (event.contact > 0) json["contact"] = event.contact;
    if (event.coordinate > 0) json["coordinate"] = event.coordinate;
    if (event.kind == "impact") json["speed"] = event.speed;
    array.push_back(std::move(json));
  }
  return array;
}

}  // namespace rosin::app::results
