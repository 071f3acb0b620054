/// Events of stick–slip against the closed form of a block without damping, and fits that find what made them.
#include "analysis/inference/stick_slip.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/inference/fit.hpp"
#include "core/error.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;
using Event = Measurement::Event;

namespace {

constexpr double m = 2, k = 50, N = 10;

Model block(double mu_s, double mu_d) {
  Model model;
  model.law = laws::find_law("coulomb")->with("mu_s", mu_s)->with("mu_d", mu_d);
  model.slider.mass = m, model.slider.stiffness = k, model.slider.damping = 0;
  return model;
}

/// Without damping slip is a part of a circle about the spring's length under kinetic friction.
struct ClosedForm {
  double recurrence, force_drop, peak_slip_rate, force_range;
};
ClosedForm closed_form(double difference, double V) {
  const double omega = std::sqrt(k / m), lead = N * difference / k, radius = std::hypot(lead, V / omega);
  return {2 * lead / V + (std::numbers::pi + 2 * std::atan2(V, omega * lead)) / omega, 2 * N * difference,
          V + radius * omega, 2 * k * radius};
}

Measurement events(Event event, const std::vector<double>& speeds) {
  Measurement events;
  events.kind = Measurement::Kind::stick_slip;
  events.event = event, events.normal_load = N, events.name = "events";
  events.x = speeds;
  return events;
}

double value(const ClosedForm& form, Event event) {
  switch (event) {
    case Event::recurrence:
      return form.recurrence;
    case Event::force_drop:
      return form.force_drop;
    case Event::peak_slip_rate:
      return form.peak_slip_rate;
    case Event::force_range:
      return form.force_range;
  }
  return 0;
}

}  // namespace

TEST_CASE("events of a block without damping are those of the closed form, with their slopes", "[stick-slip-fit]") {
  const std::vector<double> speeds = {0.05, 0.2, 0.05, 1.0};
  for (const auto event : {Event::recurrence, Event::force_drop, Event::peak_slip_rate, Event::force_range}) {
    const auto said = predict_stick_slip(block(0.4, 0.3), events(event, speeds), {"law.mu_s"});
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      constexpr double h = 1e-5;
      const auto at = [&](double difference) { return value(closed_form(difference, speeds[i]), event); };
      INFO("event " << int(event) << " at " << speeds[i]);
      CHECK(said.y[i] == Approx(at(0.1)).epsilon(1e-7));
      CHECK(said.slopes[0][i] == Approx((at(0.1 + h) - at(0.1 - h)) / (2 * h)).epsilon(2e-3));
    }
  }
}

TEST_CASE("events of a machine of one coordinate are those of the closed form, with their slopes", "[stick-slip-fit]") {
  const auto own = block(0.4, 0.3);
  const auto structure = [own](const MachineNumbers& numbers) {
    auto model = own;
    for (const auto& [path, value] : numbers) model = model.with(path, value);
    analysis::motion::StructureModel one{oscillators::one_slider(model), {}};
    one.start.kind = analysis::motion::Start::Kind::rest;
    return one;
  };
  const auto machine =
      std::make_shared<const Machine>(Machine::Family{{},
                                                      structure,
                                                      [own](const std::string& path) { return own.describe(path); },
                                                      [own](const std::string& path) { return own.get(path); }},
                                      "events", "data.1.start.", std::vector<double>(), 1);
  const Subject subject(own, {machine});
  const std::vector<double> speeds = {0.05, 0.2, 1.0};
  for (const auto event : {Event::recurrence, Event::force_drop, Event::peak_slip_rate, Event::force_range}) {
    auto data = events(event, speeds);
    data.machine = 0;
    const auto said = predict(subject, data, {"law.mu_s"});
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      constexpr double h = 1e-5;
      const auto at = [&](double difference) { return value(closed_form(difference, speeds[i]), event); };
      INFO("event " << int(event) << " at " << speeds[i]);
      CHECK(said.y[i] == Approx(at(0.1)).epsilon(1e-7));
      CHECK(said.slopes[0][i] == Approx((at(0.1 + h) - at(0.1 - h)) / (2 * h)).epsilon(2e-3));
    }
  }
}

TEST_CASE("a fit of events finds the static coefficient and the machine's stiffness", "[stick-slip-fit]") {
  const std::vector<double> speeds = {0.05, 0.1, 0.2, 0.5, 1};
  std::vector<Measurement> data;
  for (const auto event : {Event::recurrence, Event::force_drop}) {
    data.push_back(events(event, speeds));
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      const double truth = value(closed_form(0.1, speeds[i]), event), part = i % 2 == 0 ? 1e-3 : -1e-3;
      data.back().y.push_back(truth * (1 + part));
      data.back().error.push_back(1e-3 * truth);
    }
  }
  auto start = block(0.45, 0.3);
  start.slider.stiffness = 70;
  FitOptions options;
  options.parameters = {"law.mu_s", "oscillator.stiffness"};
  const auto found = fit(start, data, options);
  REQUIRE(found.parameters.size() == 2);
  CHECK(found.parameters[0].value == Approx(0.4).margin(3 * found.parameters[0].standard_error));
  CHECK(found.parameters[1].value == Approx(k).margin(3 * found.parameters[1].standard_error));
  CHECK(found.parameters[0].standard_error < 1e-3);
}

TEST_CASE("a slider that slides steadily has no events", "[stick-slip-fit]") {
  CHECK_THROWS_AS(predict_stick_slip(block(0.3, 0.3), events(Event::recurrence, {0.1}), {}), InputError);
}
