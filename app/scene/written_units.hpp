/// Units in which the numbers of a scene are written: what is printed of its results has the same.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "app/scene/in_thread.hpp"

namespace rosin::app::scene {

struct WrittenUnit {
  std::string name;   ///< as it stands in the scene: "um/s"
  double factor = 1;  ///< one of it in SI

  bool operator==(const WrittenUnit& other) const { return factor == other.factor; }
  /// As it stands behind a number: nothing where that has no dimension.
  std::string behind() const { return name == "1" ? "" : " " + name; }
};
/// By SI unit; where a scene writes several units for one, or plain numbers beside them, there is none.
using WrittenUnits = std::map<std::string, WrittenUnit, std::less<>>;

/// While it lives, the units of numbers that are read in this thread are noted.
class UnitsRead : public InThread<UnitsRead> {
 public:
  /// A number as it is read. \param text "0.1 um/s", or nothing for a plain number
  static void note(const std::string& si, double value, std::optional<std::string_view> text);
  WrittenUnits written() const;

 private:
  std::map<std::string, std::optional<WrittenUnit>, std::less<>> units_;  ///< nothing: several
};

}  // namespace rosin::app::scene
