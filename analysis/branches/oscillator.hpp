/// An oscillator as branches of its motion need it: what follows it, steady sliding, and what is told of a period.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/motion/follower.hpp"
#include "analysis/steady/linearised.hpp"
#include "oscillators/model.hpp"

namespace rosin::analysis::branches {

class Oscillator {
 public:
  virtual ~Oscillator() = default;
  virtual SwitchingSystem& system() = 0;
  virtual motion::Follower follower(double tolerance) = 0;
  /// Whether it has end stops, whose impacts are not differentiated with respect to parameters.
  virtual bool has_stops() const { return false; }
  double drive_period() const { return drive_period_; }  ///< s; 0: the drive is constant
  /// Steady sliding, in the modes of slip along the drives. \throws InputError where there is none.
  virtual std::vector<double> steady() = 0;
  /// The equations of small motions about that. \throws as steady()
  steady::Linearised linearised() {
    auto y = steady();
    return steady::linearise(system(), std::move(y));
  }
  /// Slip rates of the contacts (m/s) at the time 0.
  virtual std::vector<double> slip_rates(const std::vector<double>& y) const = 0;

  /// Takes the steps of a period, and tells what it shows, by the names of a cycle's metrics.
  class Record {
   public:
    virtual ~Record() = default;
    virtual void add(motion::Follower::Step&, std::span<const motion::Follower::Event>) = 0;
    virtual std::map<std::string, double> finish(double duration) = 0;
  };
  virtual std::unique_ptr<Record> record(double tolerance) const = 0;

 protected:
  double drive_period_ = 0;
};

/// \param stick_threshold  |v| over V below which a contact under a smooth law counts as stuck
/// \throws InputError for a drive without a period, and what cannot move.
std::unique_ptr<Oscillator> oscillator_of(oscillators::Structure, double stick_threshold = 0.1);
/// With a mass, a structure of one coordinate.
std::unique_ptr<Oscillator> oscillator_of(const oscillators::Model&, double stick_threshold = 0.1);

/// The oscillator at a value of the parameter.
using Family = std::function<std::unique_ptr<Oscillator>(double p)>;

}  // namespace rosin::analysis::branches
