/// What a verb has found, in no format: each writer in writers.def writes all of it.
#pragma once
#include <complex>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/results/table.hpp"
#include "core/error.hpp"
#include "laws/law.hpp"

namespace rosin::app::scene {
struct Scene;
}

namespace rosin::app::results {

using nlohmann::ordered_json;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// Values by name and, under the same names in "error", "units" and "meaning", what is known of them.
class Object {
 public:
  /// A number and its absolute error; infinite: of unknown size, 0: exact to rounding, not_known: there is none.
  void add(const Channel&, double value, double error = not_known);
  /// Values and their errors, one for all or one for each. \param list  lists, or lists of lists, of numbers
  void add(const Channel&, ordered_json list, ordered_json error = nullptr);
  /// A motion: its first column, such as time, the others in "columns", and their errors.
  void add_record(const Table&);
  /// What is known of a number that stands in an object within this one, such as "metrics".
  void describe(const Channel&, ordered_json error);
  /// A fact, a word, a list of objects. The reference holds until another name is added.
  ordered_json& operator[](const std::string& name) { return values_[name]; }
  bool contains(const std::string& name) const { return values_.contains(name); }
  ordered_json json() const;
  /// Values and errors alone: an entry of a list, whose units are those of its kind.
  ordered_json entry() const;

 private:
  ordered_json values_ = ordered_json::object(), error_, units_, meaning_;
};

/// The document's numbers, tables for files, notes, and how the work ended.
class Result : public Object {
 public:
  Result(const scene::Scene&, std::string verb, Outcome = {});

  const scene::Scene& scene;
  Outcome outcome;
  std::vector<Table> tables;       ///< the main one first
  std::vector<std::string> notes;  ///< beside those of the scene
  ordered_json cost;

  /// The whole document, as docs/results.md describes it.
  ordered_json document() const;

 private:
  std::string verb_;
};

/// Parameters by name.
ordered_json values(const std::vector<Quantity>& names, const std::vector<Value>& list);

/// What every document of a scene begins with.
ordered_json head(const scene::Scene&, const std::string& verb, const Outcome&);

/// Columns of a table as lists by name, with errors of those that have one for all values.
ordered_json lists_of(const Table&);

/// The text of a document. What is not finite is null.
std::string text(const ordered_json&);

ordered_json pair(std::complex<double>);
ordered_json pairs(const std::vector<std::complex<double>>&);

}  // namespace rosin::app::results
