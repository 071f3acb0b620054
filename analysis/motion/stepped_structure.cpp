/// A structure of many coordinates as an oscillator followed by steps of a given length.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/motion/stepped_oscillator.hpp"
#include "analysis/motion/stepper.hpp"
#include "analysis/motion/structure_record.hpp"
#include "analysis/steady/sliding_modes.hpp"

namespace rosin::analysis::motion {

using Eigen::VectorXd;
using oscillators::StationForces, oscillators::Structure;

namespace {

/// The structure with the forces of its contacts, which refer to it.
struct Body {
  explicit Body(Structure of) : structure(std::move(of)), contacts(structure) {
    for (const auto& functional : structure.functionals) rows.push_back(functional.row.sparseView());
    for (const auto& contact : contacts.contacts())
      for (int s = contact.first; s < contact.first + contact.stations; ++s) area += contacts.area(s);
  }
  Structure structure;
  StationForces contacts;
  std::vector<Eigen::SparseVector<double>> rows;  ///< of the functionals
  double area = 0;                                ///< of all stations, m²
};

class StructureMotion final : public SteppedMotion {
 public:
  StructureMotion(std::shared_ptr<const Body> body, const Stepping& stepping, const VectorXd& q)
      : body_(std::move(body)),
        stick_width_(stepping.stick_width),
        stepper_(make_stepper(body_->structure, body_->contacts, stepping, q, VectorXd::Zero(q.size()))) {
    see(after_);
  }

  void start(double t, const std::vector<double>& state) override {
    stepper_->start(t, Eigen::Map<const VectorXd>(state.data(), Eigen::Index(state.size())));
    before_ = t;
    see(after_);
  }
  Outcome advance(double) override {
    before_ = stepper_->time();
    row_before_.swap(after_);
    const auto outcome = stepper_->advance();
    see(after_);
    return outcome;
  }
  double time_before() const override { return before_; }
  double time() const override { return stepper_->time(); }
  std::vector<double> state() const override {
    const VectorXd all = stepper_->state();
    return {all.begin(), all.end()};
  }
  int parts() const override { return 1; }
  /// Functionals by Hermite's cubic through their values and rates, which is of the order of the steps and beyond.
  void observe(double t, bool, double* row) override {
    const double h = time() - before_, s = h > 0 ? std::clamp((t - before_) / h, 0.0, 1.0) : 1;
    const std::size_t n = body_->rows.size();
    for (std::size_t i = 0; i < after_.size(); ++i) row[i] = std::lerp(row_before_[i], after_[i], s);
    for (std::size_t i = 0; i < n && h > 0; ++i) {
      const double a = row_before_[i], b = after_[i], va = h * row_before_[n + i], vb = h * after_[n + i];
      const double bend = va + vb - 2 * (b - a), slope = 3 * (b - a) - 2 * va - vb;
      row[i] = a + s * (va + s * (slope + s * bend));
      row[n + i] = (va + s * (2 * slope + 3 * s * bend)) / h;
    }
  }

 private:
  void see(std::vector<double>& row) const {
    row.clear();
    for (const auto& of : body_->rows) row.push_back(of.dot(stepper_->coordinates()));
    for (const auto& of : body_->rows) row.push_back(of.dot(stepper_->velocities()));
    const auto& contacts = body_->contacts;
    const VectorXd place = contacts.rows() * stepper_->coordinates(), rate = contacts.rows() * stepper_->velocities();
    const auto& force = stepper_->forces().value;
    double friction = 0, load = 0, sticks = 0, open = 0, power = 0;
    for (std::size_t j = 0; j < contacts.contacts().size(); ++j) {
      const auto& [slip, first, stations, area] = contacts.contacts()[j];
      const double u = contacts.speed(int(j), time()) - rate[slip];
      friction += force[slip], power += force[slip] * u;
      load += stations > 0 ? -force.segment(first, stations).sum() : contacts.load(int(j), time());
      for (int s = first; s < first + stations; ++s) {
        const double part = contacts.area(s) / body_->area;
        const bool is_open = contacts.approach(s, place) <= 0;
        open += is_open ? part : 0, sticks += !is_open && std::abs(u) < stick_width_ ? part : 0;
      }
    }
    row.insert(row.end(), {friction, load, sticks, open, power});
  }

  std::shared_ptr<const Body> body_;
  double stick_width_, before_ = 0;
  std::unique_ptr<Stepper> stepper_;
  std::vector<double> row_before_, after_;  ///< channels at the ends of the last step
};

}  // namespace

SteppedOscillator stepped(const StructureModel& model, const Stepping& stepping, const StartShapes& shapes) {
  const auto body = std::make_shared<const Body>(model.structure);
  const auto& structure = body->structure;
  using Kind = Channel::Kind;
  SteppedOscillator oscillator;
  oscillator.drive_period = common_period(structure);
  structure.require_drive();
  for (const auto& functional : structure.functionals)
    oscillator.channels.push_back({functional.name, functional.unit});
  for (const auto& functional : structure.functionals)
    oscillator.channels.push_back({velocity_name(functional.name), functional.unit + "/s"});
  for (const char* force : {"friction_force", "normal_load"}) oscillator.channels.push_back({force, "N"});
  for (const char* part : {"stick_fraction", "open_fraction"}) oscillator.channels.push_back({part, "1", Kind::part});
  oscillator.channels.push_back({"friction_work", "J", Kind::rate});
  oscillator.coordinates = int(structure.functionals.size());
  oscillator.watched = oscillator.coordinates - 1;  // the tilt of a block
  oscillator.fixed_steps = true;

  const VectorXd sliding = steady::steady_sliding(structure, body->contacts);
  const auto n = sliding.size();
  // Of the motion by the first shape, a rigid one that the softest springs hold.
  const VectorXd along = shapes.columns.col(0);
  oscillator.natural_period =
      2 * std::numbers::pi * std::sqrt(along.dot(structure.M * along) / std::abs(along.dot(structure.K * along)));
  const double length = std::max(sliding.cwiseAbs().maxCoeff(), 1e-300);
  oscillator.size.assign(std::size_t(3 * n), infinity);
  std::fill_n(oscillator.size.begin(), n, length);
  std::fill_n(oscillator.size.begin() + n, n, length * 2 * std::numbers::pi / oscillator.natural_period);

  const auto state_of = [body, stepping](const VectorXd& q, double speed, const VectorXd& along_surface) {
    const auto stepper = make_stepper(body->structure, body->contacts, stepping, q, speed * along_surface);
    const VectorXd all = stepper->state();
    return std::vector<double>(all.begin(), all.end());
  };
  VectorXd q = sliding;
  double speed = 0;
  if (model.start.kind == Start::Kind::rest) {
    const auto& relaxed = structure.functionals.front().row;
    q -= relaxed.dot(q) / relaxed.dot(along) * along;
    speed = structure.contacts.front().speed.value(0);
  }
  if (model.start.beside.size() > 0) q += model.start.beside;
  oscillator.start = state_of(q, speed, along);
  oscillator.motion = [body, stepping, q](double, bool finer) {
    auto how = stepping;
    if (finer) how.step /= 2;
    return std::make_unique<StructureMotion>(body, how, q);
  };
  oscillator.starts = shapes.names;
  for (const auto& shape : shapes.columns.colwise())
    oscillator.start_sizes.push_back(length / shape.cwiseAbs().maxCoeff());
  oscillator.start_at = [state_of, shapes, sliding, along](std::span<const std::optional<double>> values) {
    VectorXd place = sliding;
    for (std::size_t i = 0; i < values.size(); ++i)
      place += values[i].value_or(0) * shapes.columns.col(Eigen::Index(i));
    return state_of(place, 0, along);
  };
  return oscillator;
}

}  // namespace rosin::analysis::motion
