/// A scene that is written from another program's input: above each key the source's own name, value and unit.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rosin::app::imports {

/// What a key was in the source.
struct Origin {
  std::string was;  ///< "model.k = 0.001, friction per um"
  int line = 0;     ///< 0: a default
};

class SceneText {
 public:
  explicit SceneText(std::string title);

  void table(std::string_view name);
  /// \param value as TOML: `number(…)`, `quantity(…)`, or any text.
  void key(std::string_view name, const std::string& value, Origin);
  /// Something of the source that the scene has not; `why` is a reason or what to do.
  void left_out(std::string what, std::string_view why);

  std::string text() const;
  const std::vector<std::string>& notes() const { return left_out_; }
  /// Of a line of `text()`, from 1.
  std::optional<Origin> origin(int line) const;

 private:
  std::string text_;
  int lines_ = 0;
  std::map<int, Origin> origins_;
  std::vector<std::string> left_out_;
};

/// Shortest digits that are read back as the same number.
std::string number(double);
/// "\"10 um\""
std::string quantity(double, std::string_view unit);
/// "\"…\""
std::string as_text(std::string_view);

}  // namespace rosin::app::imports
