/// A bowed string, and what is asked of it.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/planes/map.hpp"
#include "analysis/strings/strings.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::tasks {

struct Bowing {
  oscillators::BowedStringModel model;
  analysis::strings::BowingOptions options;
  int samples = 20'000;  ///< most that the record keeps
  /// What is heard of the force on the bridge: by the answer of body and room to an impulse of 1 N s.
  struct Sound {
    Signal::Table response;
    std::string unit;  ///< of the sound; the response has it per N s
  };
  std::optional<Sound> sound;
  double periods = 200;  ///< of the open string, after which a motion is periodic or not
  analysis::planes::Axis x, y;
  analysis::strings::PlaneOptions plane;
  double good = 5;  ///< periods: transients that are shorter are good
  struct Member {
    std::string name;
    std::shared_ptr<const scene::Family> family;
    std::vector<std::pair<std::string, double>> changed;  ///< numbers by their paths
  };
  std::vector<Member> members;  ///< of a comparison
};

}  // namespace rosin::app::tasks
