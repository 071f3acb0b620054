/// Structures, and sliders without mass, each with its own record of a period.
#include "analysis/branches/oscillator.hpp"

#include <cmath>

#include "analysis/cycles/period_record.hpp"
#include "analysis/cycles/return_map.hpp"

namespace rosin::analysis::branches {

using motion::Follower;
using oscillators::Model;
using oscillators::Structure;
using oscillators::StructureSystem;

namespace {

class OfStructure final : public Oscillator {
 public:
  OfStructure(Structure structure, double stick_threshold)
      : system_(std::move(structure)), stick_threshold_(stick_threshold) {
    drive_period_ = common_period(system_.structure());
  }
  SwitchingSystem& system() override { return system_; }
  Follower follower(double tolerance) override { return {system_, tolerance}; }
  bool has_stops() const override { return system_.stops() > 0; }
  std::vector<double> steady() override {
    system_.slide();
    return system_.steady(0);
  }
  std::vector<double> slip_rates(const std::vector<double>& y) const override {
    std::vector<double> rates;
    for (int j = 0; j < system_.friction_contacts(); ++j) rates.push_back(system_.slip_rate(j, 0, y.data()));
    return rates;
  }
  std::unique_ptr<Record> record(double tolerance) const override {
    struct OfPeriod final : Record {
      OfPeriod(const StructureSystem& system, double tolerance, double stick_threshold)
          : period(system, tolerance, stick_threshold) {}
      void add(Follower::Step& step, std::span<const Follower::Event> switches) override { period.add(step, switches); }
      std::map<std::string, double> finish(double duration) override {
        period.finish(duration);
        std::map<std::string, double> values;
        for (const auto& [name, measure] : period.metrics) values[name] = measure.value;
        return values;
      }
      cycles::PeriodRecord period;
    };
    return std::make_unique<OfPeriod>(system_, tolerance, stick_threshold_);
  }

 private:
  StructureSystem system_;
  double stick_threshold_;
};

/// Without mass: its displacement and friction do not pass through a speed of its own.
class OfMasslessSlider final : public Oscillator {
 public:
  OfMasslessSlider(const Model& model, double stick_threshold) : system_(model), stick_threshold_(stick_threshold) {
    Structure drives;  // the drives alone
    drives.force = {model.drive.force};
    drives.contacts = {contact_of(model)};
    drive_period_ = common_period(drives);
    system_.mark_reversals(true);
    if (!model.drive.constant()) return;
    steady_ = system_.steady(0);
    system_.measure_from_balance(steady_);
  }
  SwitchingSystem& system() override { return system_; }
  Follower follower(double tolerance) override { return {system_, tolerance}; }
  std::vector<double> slip_rates(const std::vector<double>& y) const override {
    return {system_.slip_rate(0, y.data())};
  }
  std::vector<double> steady() override { return steady_.empty() ? system_.steady(0) : steady_; }
  std::unique_ptr<Record> record(double tolerance) const override {
    struct OfPeriod final : Record {
      OfPeriod(const oscillators::SliderSystem& system, double tolerance, double stick_threshold)
          : recorder(system, tolerance, stick_threshold, false) {}
      void add(Follower::Step& step, std::span<const Follower::Event>) override { recorder.step(step); }
      std::map<std::string, double> finish(double duration) override {
        const auto metrics = recorder.finish(duration);
        std::map<std::string, double> values;
        for (const auto& metric : cycles::metric_names()) values[metric.name] = metrics.*metric.member;
        return values;
      }
      cycles::Recorder recorder;
    };
    return std::make_unique<OfPeriod>(system_, tolerance, stick_threshold_);
  }

 private:
  oscillators::SliderSystem system_;
  double stick_threshold_;
  std::vector<double> steady_;  ///< under a constant drive, the origin of displacement
};

}  // namespace

std::unique_ptr<Oscillator> oscillator_of(Structure structure, double stick_threshold) {
  return std::make_unique<OfStructure>(std::move(structure), stick_threshold);
}

std::unique_ptr<Oscillator> oscillator_of(const Model& model, double stick_threshold) {
  if (model.slider.mass > 0) return oscillator_of(oscillators::one_slider(model), stick_threshold);
  return std::make_unique<OfMasslessSlider>(model, stick_threshold);
}

}  // namespace rosin::analysis::branches
