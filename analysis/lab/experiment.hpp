/// The virtual laboratory: an experiment as it is done on a machine, its record, and what an experimenter reads off it.
///
/// An experiment is one file that defines one `Experiment` and one line in the list of experiment.cpp. It turns a model
/// and the settings of its protocol into a record, hands that to the sensor, and reads numbers off what was measured.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "analysis/lab/sensor.hpp"
#include "analysis/motion/run.hpp"
#include "oscillators/bowed_string.hpp"
#include "oscillators/structure.hpp"

namespace rosin::analysis::lab {

using oscillators::Model;

/// A key of an experiment's protocol. Without `value` the experiment chooses one that suits the law.
struct Setting {
  Quantity quantity;  ///< name, SI unit, range, meaning
  std::optional<Value> value = std::nullopt;
  bool whole = false;  ///< a whole number
};

/// The settings of one protocol by name, checked against their ranges.
class Settings {
 public:
  explicit Settings(const std::vector<Setting>& known);
  /// \throws InputError for an unknown name (with the nearest one), a value out of range or of the wrong kind.
  void set(std::string_view name, Value);
  bool given(std::string_view name) const { return values_.contains(std::string(name)); }
  /// Value of a key that has one. \throws InputError if neither the protocol nor the user gives it.
  double number(std::string_view name) const;
  const std::vector<double>& list(std::string_view name) const;
  double number_or(std::string_view name, double otherwise) const { return given(name) ? number(name) : otherwise; }
  int count(std::string_view name) const { return static_cast<int>(number(name)); }

 private:
  const Quantity& describe(std::string_view name) const;
  std::vector<Quantity> known_;
  std::map<std::string, Value> values_;
};

/// A number read off a record. NaN where there is none to read.
struct Reading {
  std::string name, unit, meaning;
  double value;
  double error = 0;  ///< absolute; how it is known is in docs/lab.md
};

/// Numbers in columns beside the record, such as one row for each hold.
struct Table {
  std::string name;
  std::vector<std::string> columns, units;
  std::vector<std::vector<double>> values;  ///< [column][row]
};

/// One diagram as the field draws it; drawing it is not this layer's business.
struct Panel {
  struct Curve {
    std::string label;
    std::vector<double> x, y;
    bool points = false;                      ///< marks instead of a line
    std::vector<double> low = {}, high = {};  ///< a band around y
  };
  std::string x_label, x_unit, y_label, y_unit;
  bool x_decades = false, y_decades = false;
  std::vector<Curve> curves;
  double y_error = 0;  ///< values that nowhere exceed it are drawn as 0
};

/// What an experiment returns.
struct Result {
  Outcome outcome;
  Record record;  ///< as measured
  std::vector<motion::RunEvent> events;
  std::vector<Reading> readings;
  std::vector<Table> tables;
  std::vector<Panel> panels;
  std::vector<std::string> warnings, plan;  ///< plan: what was computed how, for --explain

  /// \throws InputError if there is no such reading.
  const Reading& reading(std::string_view name) const;
};

/// Thrown out of a protocol whose run ended before there was anything to read off.
struct NothingRecorded {
  Result result;
};

/// All that an experiment needs.
struct Task {
  Model model;  ///< law, slider and drive; the protocol replaces what it prescribes
  std::optional<oscillators::Structure> structure = std::nullopt;  ///< in place of the slider; its speed is the drive's
  std::optional<oscillators::BowedStringModel> string = std::nullopt;  ///< in place of the slider
  Settings settings;
  Sensor sensor = {};
  std::optional<Signal::Table> motion = std::nullopt;  ///< a recorded motion, for experiments that take one
  /// Recorded forces of a string on its bridge and nut, N, at the same times.
  struct EndForces {
    Signal::Table bridge, nut;
  };
  std::optional<EndForces> end_forces = std::nullopt;
  double tolerance = 1e-8;
};

struct Experiment {
  std::string_view name, title;
  std::vector<Setting> settings;
  oscillators::Slider slider;              ///< for a scene without [oscillator]
  oscillators::Drive drive;                ///< for a scene without [drive]
  std::vector<std::string> extra_columns;  ///< of the record, beside those of a run
  std::vector<std::string> prescribed;     ///< paths of the model that the protocol sets, such as "drive.speed"
  bool takes_motion = false;
  bool takes_string = false;
  std::string_view only_slider = {};  ///< why it is not done on other machines; empty: it is
  Result (*protocol)(const Task&);    ///< may throw NothingRecorded

  /// \throws InputError for a machine on which it is not done
  void require_served(const Task&) const;
  /// \throws InputError for a wrong input. A record that nothing can be read off is a result whose outcome says why.
  Result perform(const Task&) const;
};

const std::vector<Experiment>& experiments();
/// \throws InputError for an unknown name, with the nearest one.
const Experiment& find_experiment(std::string_view name);
/// The experiment on a law, with the protocol, slider and drive that it has by itself.
Task task_for(const Experiment&, std::shared_ptr<const FrictionLaw>);
/// Names of the columns that the experiment's record will have.
std::vector<std::string> column_names(const Experiment&, const Task&);

// The experiments, each in a file of its name.
Experiment inclined_plane();
Experiment impulse();
Experiment velocity_step();
Experiment slide_hold_slide();
Experiment spring_pulled();
Experiment reciprocation();
Experiment ring_down();
Experiment frequency_response();
Experiment inverse();

}  // namespace rosin::analysis::lab
