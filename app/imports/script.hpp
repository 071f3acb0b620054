/// Values that a script in Python or MATLAB gives to names, each with its line. Scripts are read and never run:
/// numbers, texts, vectors and the arithmetic of parameters are understood; whatever is not becomes unknown, and is
/// refused where its value is needed.
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
/// Where a statement may have changed an object unseen; line 0: nowhere.
struct Changed {
  int line = 0;
  std::string why = {};
};
struct Vector {
  std::vector<double> numbers;
  Changed changed = {};
};
struct List {
  std::vector<Value> values;
  Changed changed = {};
};
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
  std::string type = {};  ///< the function that made it, "DieterichState"; empty: a dictionary
  std::string name = {};  ///< the first variable that it was given to
  std::map<std::string, Slot, std::less<>> slots = {};
  Changed changed = {};
  bool ran = false;  ///< made by a run, which takes the variables as they are
};

/// What a function of MATLAB that a format knows returns; Unknown for any other.
using Call = std::function<Value(std::string_view name, const std::vector<Value>&, int line)>;

class Script {
 public:
  Script(std::string path, std::string_view text);

  Record variables = {};
  const std::string& path() const { return path_; }
  /// A line of the text, trimmed.
  std::string line(int number) const;
  /// "script.py:7: 'model.k = stiffness()': " and why.
  [[noreturn]] void refuse(int line, std::string_view why) const;
  void refuse(const Changed& changed) const {
    if (changed.line > 0) refuse(changed.line, changed.why);
  }

 private:
  std::string path_;
  std::vector<std::string> lines_;
};

/// By Python's own parser, in a process that has little time and memory (python.py). \throws InputError with file and
/// line for what is no Python or too much, or where there is no python3
Script read_python(const std::string& path, std::string_view text);
/// \throws InputError with file and line for a text or a bracket that does not end
Script read_matlab(const std::string& path, std::string_view text, const Call&);

/// The record that a value is, or nullptr.
std::shared_ptr<Record> record_of(const Value&);

}  // namespace rosin::app::imports
