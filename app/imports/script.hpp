/// Scripts in Python or MATLAB as a list of assignments: read, never run. Numbers, texts, vectors and the arithmetic of
/// parameters are understood; whatever is not becomes an `Unknown`, which is refused only where its value is needed.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rosin::app::imports {

enum class Dialect { python, matlab };
/// By the marks of comments and of ends of statements.
Dialect dialect_of(std::string_view text);

struct Record;
struct Value;
/// Why a value is not known.
struct Unknown {
  std::string why = "is not understood";
};
/// A vector; names of it share its numbers, as those of NumPy do.
struct Vector {
  std::vector<double> numbers;
  bool mask = false;                     ///< truth values, which choose elements
  std::shared_ptr<Vector> part_of = {};  ///< the vector of which this is a slice, and changes with it
};
using List = std::vector<Value>;
struct Value {
  std::variant<Unknown, double, std::string, std::shared_ptr<Vector>, std::shared_ptr<Record>, std::shared_ptr<List>>
      is;
  template <class T>
  const T* as() const {
    return std::get_if<T>(&is);
  }
};

/// A value and the line that gave it; 0: a default.
struct Slot {
  Value value;
  int line = 0;
};
/// An object, a structure or a dictionary: values by name.
struct Record {
  std::string type;  ///< the function that made it, "DieterichState"; empty: a dictionary
  std::map<std::string, Slot, std::less<>> slots;
  int handed_over = 0;  ///< line at which a function that may have changed it was called; 0: none was
};

struct Argument {
  std::string name;  ///< empty: by position
  Value value;
};
/// What a function that a format knows returns; Unknown for any other. The object of a method comes first.
using Call = std::function<Value(std::string_view name, const std::vector<Argument>&, int line)>;

class Script {
 public:
  /// \param known variables that are there before the first line.
  /// \throws InputError with file and line for text that cannot be divided into statements, or beyond all sizes.
  Script(std::string path, std::string_view text, Dialect, Call call, Record known = {});

  const Record& variables() const { return variables_; }
  const std::string& path() const { return path_; }
  /// A line of the text, trimmed.
  std::string line(int number) const;
  /// "script.py:7: 'model.k = stiffness()': " and why.
  [[noreturn]] void refuse(int line, std::string_view why) const;

 private:
  friend class Statements;
  std::string path_;
  std::vector<std::string> lines_;
  Record variables_;
};

/// The record that a value is, or nullptr.
std::shared_ptr<Record> record_of(const Value&);

}  // namespace rosin::app::imports
