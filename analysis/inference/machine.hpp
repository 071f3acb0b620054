/// Machines whose recorded motion or stick–slip is fitted, and what a fit varies: a model, with the machines among the
/// data.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/run.hpp"
#include "oscillators/model.hpp"

namespace rosin::analysis::inference {

using oscillators::Model;

/// Numbers of a machine by their paths, in place of its own.
using MachineNumbers = std::map<std::string, double>;

/// An oscillator under its drive: run from one start and seen at the times of one record, or on the cycle that it
/// settles on. Motions and cycles that were computed are kept, because several columns of a record ask for the same
/// ones.
class Machine {
 public:
  /// Machines that differ in numbers.
  struct Family {
    /// The motion at times that ascend from 0 or later; null: none is among the data.
    /// \throws InputError where a scene with these numbers would
    std::function<motion::Run(const MachineNumbers&, const std::vector<double>& times)> run;
    /// The same of the structure whose cycle is searched for.
    std::function<motion::StructureModel(const MachineNumbers&)> structure;
    std::function<Quantity(const std::string& path)> describe;
    /// \throws InputError for a path that names no number, and for one that is left to its default
    std::function<double(const std::string& path)> value;
  };
  /// \param starts  what the paths of numbers of the start begin with: "data.1.start."
  /// \param times  of the record, s, ascending; empty where cycles are asked for
  Machine(Family, std::string name, std::string starts, std::vector<double> times, int threads);

  const Family& family() const { return family_; }
  const std::string& name() const { return name_; }
  const std::vector<double>& times() const { return times_; }
  int threads() const { return threads_; }
  /// False for numbers of the start of another machine.
  bool depends_on(const std::string& path) const;

  struct Motion {
    std::vector<double> time;  ///< s, ascending
    std::vector<std::string> names, units;
    std::vector<std::vector<double>> columns;
    long steps = 0;
    /// The column of this name. \throws InputError with the nearest name
    const std::vector<double>& column(const std::string& name) const;
    /// The sample at a time; before the start it is that of the start.
    std::size_t at(double t) const;
  };
  /// The motion at all times of the record, which the machine took `clock_offset` (s) earlier.
  /// \param beside  s; above 0: so much before and behind each of them, too
  /// \param computed  gains the steps of motions that were not kept from before
  /// \throws InputError where the motion does not reach the end
  std::shared_ptr<const Motion> motion(const MachineNumbers&, double clock_offset, double beside, long& computed) const;

  struct Cycle {
    oscillators::Structure structure;
    cycles::StructureCycle cycle;
  };
  /// The cycle that the structure settles on from its start, at a relative accuracy of 1e-9.
  std::shared_ptr<const Cycle> cycle(const MachineNumbers&) const;

 private:
  Family family_;
  std::string name_, starts_;
  std::vector<double> times_;
  int threads_;
  struct Key {
    MachineNumbers numbers;
    double clock_offset, beside;
    auto operator<=>(const Key&) const = default;
  };
  mutable std::mutex guard_;
  mutable std::map<Key, std::shared_ptr<const Motion>> kept_;
  mutable std::map<MachineNumbers, std::shared_ptr<const Cycle>> kept_cycles_;
};

/// The numbers that a fit varies: those of a model, and of the machines whose motions are among the data. A value.
struct Subject {
  Subject(Model of) : model(std::move(of)) {}
  Subject(Model of, std::vector<std::shared_ptr<const Machine>> with)
      : model(std::move(of)), machines(std::move(with)) {}

  Model model;
  std::vector<std::shared_ptr<const Machine>> machines;
  MachineNumbers changed = {};  ///< in the machines

  /// True for a number of the model itself.
  bool in_model(const std::string& path) const;
  /// \throws InputError for a path that names no number, with the nearest
  Quantity describe(const std::string& path) const;
  double get(const std::string& path) const;
  /// \throws InputError outside the number's range
  Subject with(const std::string& path, double value) const;

 private:
  /// The first machine with a number at a path, null: none.
  const Machine* owner(const std::string& path) const;
};

}  // namespace rosin::analysis::inference
