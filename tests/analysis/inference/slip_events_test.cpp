/// Slip events of made records: their number, time and size are known, whatever noise and spikes lie on them.
#include "analysis/inference/slip_events.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/random.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;

namespace {

struct Record {
  std::vector<double> time, force;
};
/// A sawtooth of period 2 s: 1.8 s up by `size`, 0.2 s down, begun within a fall and ended within a rise.
Record sawtooth(int samples, double spacing, double size) {
  Record record;
  for (int i = 0; i < samples; ++i) {
    const double t = spacing * i, phase = std::fmod(t + 1.9, 2);
    record.time.push_back(t);
    record.force.push_back((phase < 1.8 ? phase / 1.8 : (2 - phase) / 0.2) * size);
  }
  return record;
}

double mean_size(const SlipEvents& found) {
  double sum = 0;
  for (const auto& event : found.events) sum += event.size / double(found.events.size());
  return sum;
}

}  // namespace

TEST_CASE("slip events of a record without noise are whole, and of its samples", "[slip-events]") {
  const auto record = sawtooth(1001, 0.01, 3);
  const auto found = find_slip_events(record.time, record.force);
  REQUIRE(found.events.size() == 4);
  for (std::size_t i = 0; i < found.events.size(); ++i) {
    CHECK(found.events[i].onset == Approx(1.9 + 2.0 * double(i)).margin(0.011));
    CHECK(found.events[i].size == Approx(3).margin(1e-9));
    CHECK(found.events[i].duration == Approx(0.2).margin(0.011));
  }
  CHECK(find_slip_events(record.time, record.force, {.least_drop = 4}).events.empty());
  CHECK(find_slip_events({}, {}).events.empty());
  CHECK(find_slip_events({0, 1, 2}, {1, 1, 1}).events.empty());
}

TEST_CASE("a noisy record with spikes has one number of slip events over a decade of thresholds", "[slip-events]") {
  // Noise of an eighth of the drop, of which a half is correlated over 10 samples, and 1 sample of 500 lost by up to 20
  // times the drop, some of them for three samples.
  constexpr double size = 0.4;
  const auto samples = GENERATE(30'000, 750'000);
  auto record = sawtooth(samples, 0.002, size);
  const auto white = white_noise(std::size_t(samples), 1), slow = white_noise(std::size_t(samples), 2),
             chance = white_noise(std::size_t(samples), 3);
  double correlated = 0;
  for (std::size_t i = 0; i < record.force.size(); ++i) {
    correlated = 0.9 * correlated + std::sqrt(1 - 0.81) * slow[i];
    record.force[i] += size / 8 * std::sqrt(0.5) * (white[i] + correlated);
    constexpr double rare = 3.09;  // two sides of 1/1000
    for (std::size_t k = 0; k < 3; ++k)
      if (i >= k && std::abs(chance[i - k]) > rare + 0.3 * double(k))
        record.force[i] += 40 * size * (chance[i - k] - 3);
  }
  const auto wanted = std::size_t((samples * 0.002 - 0.1) / 2);
  const auto own = find_slip_events(record.time, record.force);
  REQUIRE(own.events.size() == wanted);
  const double recurrence = (own.events.back().onset - own.events.front().onset) / double(wanted - 1);
  CHECK(recurrence == Approx(2).epsilon(1e-3));
  CHECK(mean_size(own) == Approx(size).epsilon(0.02));
  CHECK(own.noise == Approx(size / 8).epsilon(0.25));
  CHECK(own.spikes > samples / 1000);
  CHECK(own.same_to > 5 * own.same_from);
  for (const double part : {0.08, 0.2, 0.4, 0.8}) {
    const auto found = find_slip_events(record.time, record.force, {.least_drop = part * size});
    INFO("least drop of " << part << " of the size");
    CHECK(found.events.size() == wanted);
    CHECK(mean_size(found) == Approx(size).epsilon(0.02));
  }
  CHECK(find_slip_events(record.time, record.force, {.least_time = 0.05}).events.size() == wanted);
}

TEST_CASE("few spikes on a clean record leave sizes and times as they are", "[slip-events]") {
  auto record = sawtooth(20'000, 0.002, 3);
  for (std::size_t i = 3; i < record.force.size(); i += 1777) record.force[i] += 50;
  const auto found = find_slip_events(record.time, record.force);
  REQUIRE(found.events.size() == 19);
  for (std::size_t i = 0; i < found.events.size(); ++i) {
    CHECK(found.events[i].onset == Approx(1.9 + 2.0 * double(i)).margin(0.02));
    CHECK(found.events[i].size == Approx(3).epsilon(0.05));
    CHECK(found.events[i].duration == Approx(0.2).margin(0.04));
  }
}
