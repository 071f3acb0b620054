/// Where a number stands in a verb's document: a path such as `hopf[parameter=drive.speed][0].value`.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

namespace rosin::app::verify {

/// Steps of a path: a name in a table (of a list: in each of its entries; in quotation marks if it has dots), an entry
/// of a list (−1: the last), a slice [from:to], or the entries of a list of tables where `key` has a value. A function
/// may stand around the path: max, min, mean or count of a list; modulus of a pair [re, im]; log of each number.
class Field {
 public:
  /// \throws InputError for what is no path, with the known functions.
  explicit Field(const std::string& text);

  const std::string& text() const { return text_; }
  /// \throws InputError that says which step leads nowhere, and what there is.
  nlohmann::ordered_json of(const nlohmann::ordered_json& document) const;
  /// The error that the document states of it: under the same name in the `error` beside it or in that of the whole
  /// document, or `error` itself beside a `value`; null if there is none. Of a maximum, minimum or mean it is the
  /// largest, of a logarithm it is relative.
  nlohmann::ordered_json error_of(const nlohmann::ordered_json& document) const;

 private:
  struct Name {
    std::string key;
  };
  struct Index {
    long at;
  };
  struct Slice {
    long from, to;  ///< from the end where negative
  };
  struct Match {
    std::string key, value;
  };
  using Step = std::variant<Name, Index, Slice, Match>;
  /// Without the function.
  nlohmann::ordered_json of_path(const nlohmann::ordered_json& document) const;
  static nlohmann::ordered_json follow(const nlohmann::ordered_json&, const Step&);

  std::string text_, function_;
  std::vector<Step> steps_;
};

}  // namespace rosin::app::verify
