/// Numbers per unit area, and those of rotating joints. A scene that gives the area of its contact, or the radius at
/// which it rubs, may give loads, stiffnesses, dampings and masses as its field tabulates them: stresses in MPa,
/// moments of inertia in kg m². They are brought to the contact as they are read; everything after that is in N, m and
/// kg.
#pragma once
#include <toml++/toml.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/scene/in_thread.hpp"

namespace rosin::app::scene {

/// While it lives, numbers that are read in this thread may refer to the area and the radius of a scene.
class Reference : public InThread<Reference> {
 public:
  /// oscillator.area (m²) and oscillator.radius (m), where they are there. \throws InputError
  explicit Reference(const toml::table& document);
  ~Reference();

  /// The number in `text` in `si_unit`: as it stands; where its unit is one per area, times oscillator.area; where it
  /// is that of a turning joint, times a power of oscillator.radius. \throws InputError that names the key that is
  /// missing, where that is all
  static double to_si(std::string_view text, std::string_view si_unit);

  std::optional<double> area() const { return values_[0]; }  ///< m²

  /// Of each key that is there although no number needed it.
  std::vector<std::string> unused() const;

  static constexpr std::array<const char*, 2> keys = {"area", "radius"};  ///< of [oscillator]

 private:
  std::array<std::optional<double>, keys.size()> values_;
  std::array<bool, keys.size()> used_{};
};

}  // namespace rosin::app::scene
