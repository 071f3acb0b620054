/// Scenes that differ from one in numbers: any number that a scene may hold is a parameter, by its path.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/motion/stepped_oscillator.hpp"
#include "app/scene/reader.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::app::scene {

class Family {
 public:
  /// Of the scene that is being read, whose structure (and start of [cycle]) is read anew for each value.
  /// \param varied_by  the table that gives the values, "stability.scan", by which errors at one of them begin
  /// \param as_slider  of a scene whose oscillator is a slider, which then may have no mass: for slider_with()
  Family(const SceneReader&, std::string varied_by, bool as_slider = false);
  /// The same of scenes of which `read` reads what is asked of each.
  using Read = std::function<void(SceneReader&)>;
  Family(const SceneReader&, std::string varied_by, Read read);

  /// The number at a path: name (in full), unit, range, meaning. Lists are numbered from 1; "drive.force.amplitude" is
  /// that of the first harmonic. \throws InputError for a path that holds no number, with the nearest.
  Quantity describe(const std::string& path) const;
  /// The number that the scene has there. \throws InputError where it leaves it to the default
  double value(const std::string& path) const;
  /// The scene with numbers in place of its own, as far as it is read. \throws InputError as it would.
  Scene with_numbers(const std::vector<std::pair<std::string, double>>& values) const;
  /// The structure with numbers in place of those of the scene. \throws InputError as a scene with them would.
  analysis::motion::StructureModel with(const std::vector<std::pair<std::string, double>>& values) const;
  /// The same of a bowed string, which is read as a slider is.
  oscillators::BowedStringModel string_with(const std::vector<std::pair<std::string, double>>& values) const;
  oscillators::Model slider_with(const std::vector<std::pair<std::string, double>>& values) const;
  /// The same of an oscillator that is followed by steps.
  analysis::motion::SteppedOscillator stepped_with(const std::vector<std::pair<std::string, double>>& values) const;

 private:
  std::string in_full(const std::string& path) const;
  Scene scene_with(const std::vector<std::pair<std::string, double>>& values, const Read& read) const;

  Request request_;
  toml::table document_;
  std::filesystem::path folder_;
  std::string varied_by_;
  Read read_;
  std::vector<Quantity> known_;
};

}  // namespace rosin::app::scene
