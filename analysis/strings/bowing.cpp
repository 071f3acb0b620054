/// Bowed strings, lane by lane: when each begins to slip, how long it sounds, what has become of it.
#include "analysis/strings/bowing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/instruction_set.hpp"
#include "core/sampled_response.hpp"
#include "core/stop.hpp"
#include "core/workers.hpp"

namespace rosin::analysis::strings {

using oscillators::StringLanes;

double first_slip_of_slow_bow(const BowedStringModel& model) {
  const double acceleration = model.speed.approach
                                  ? (model.speed.approach->to - model.speed.approach->from) / model.speed.approach->time
                                  : model.speed.signal.rate(0);
  const double N = model.load.value(0);
  if (model.speed.value(0) != 0 || !(acceleration > 0) || !(N > 0)) return NAN;
  const auto& law = *model.law;
  const double limit = law.set_valued() ? law.static_limit(N, law.rest(N)) : law.steady_friction({1e-3, N}).friction;
  const auto& string = model.string;
  const double stiffness = 2 * string.impedance * string.frequency / (string.bow_position * (1 - string.bow_position));
  return std::sqrt(2 * limit * N / (stiffness * acceleration));
}

namespace {

/// Strings that sound in the lanes of one thread.
class Sounding {
 public:
  Sounding(const BowedStringModel& kind, const BowingOptions& options)
      : options_(options),
        strings_(kind.string, kind.law, kind.lambda),
        period_(kind.string.period() * kind.string.sample_rate) {}

  const StringLanes& strings() const { return strings_; }
  long sample() const { return sample_; }

  void begin(int lane, const BowedStringModel& model) {
    strings_.begin(lane, model);
    slipping_.set(lane, 0), distance_.set(lane, 0);
    go_on(lane, model);
  }
  /// What has become of a lane is told anew from here on; its motion goes on.
  void go_on(int lane, const BowedStringModel& model) {
    auto& voice = voices_[lane];
    voice = Voice{.model = &model, .begun = sample_};
    const double rate = model.string.sample_rate;
    const double due = options_.duration > 0
                           ? options_.duration
                           : 2 * first_slip_of_slow_bow(model) + options_.patience * model.string.period();
    plan(voice, std::max(1L, std::lround(due * rate)));
  }

  /// One sample; true if there is something to look at.
  bool step() {
    strings_.step();
    const int contacts = strings_.contacts();
    const double dt = strings_.sample_step(), share = 1.0 / contacts;
    Lanes changed;
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) {
        Pack slips = 0.0, rate = 0.0;
        for (int m = 0; m < contacts; ++m) {
          const Pack side = strings_.bow(m).direction().pack[p];
          slips = slips + side * side;
          rate = rate + abs(strings_.bow(m).slip_rate().pack[p]);
        }
        const Pack now = select(slips > Pack(0.5 * contacts), Pack(1.0), Pack(0.0));
        changed.pack[p] = now - slipping_.pack[p];
        slipping_.pack[p] = now;
        distance_.pack[p] = distance_.pack[p] + now * rate * (share * dt);
        const Pack force = strings_.bridge_force().pack[p];
        most_.pack[p] = max(most_.pack[p], force);
        least_.pack[p] = min(least_.pack[p], force);
      }
    });
    if (any(changed))
      for (int lane = 0; lane < lane_count; ++lane)
        if (changed[lane] != 0 && voices_[lane].model) turn(lane, changed[lane] > 0);
    return ++sample_ >= next_;
  }

  /// Calls done(lane) of each string that has come to its end.
  template <class Done>
  void look(const Done& done) {
    for (int lane = 0; lane < lane_count; ++lane) {
      auto& voice = voices_[lane];
      if (!voice.model) continue;
      const long n = sample_ - voice.begun;
      if (n >= voice.window && !voice.listening) {
        voice.listening = true;
        most_.set(lane, -INFINITY), least_.set(lane, INFINITY);
      }
      if (n >= voice.end) done(lane);
    }
    next_ = std::numeric_limits<long>::max();
    for (const auto& voice : voices_)
      if (voice.model) next_ = std::min(next_, voice.begun + (voice.listening ? voice.end : voice.window));
  }

  Bowing finish(int lane) {
    auto& voice = voices_[lane];
    const auto& model = *voice.model;
    const long samples = sample_ - voice.begun;
    if (!voice.slips.empty() && voice.slips.back().off < 0) voice.slips.back().distance = distance_[lane];
    Bowing bowing;
    bowing.transient = find_transient(voice.slips, samples, strings_.sample_step(), model.string.period(),
                                      model.string.bow_position, options_.transient);
    bowing.raw = std::move(voice.slips);
    bowing.first_slip = bowing.transient.first_slip * strings_.sample_step();
    bowing.bridge_force = most_[lane] - least_[lane];
    bowing.samples = samples;
    double unsolved = 0;
    bool finite = std::isfinite(strings_.bridge_force()[lane]);
    for (int m = 0; m < strings_.contacts(); ++m) {
      unsolved += strings_.bow(m).unsolved()[lane];
      finite = finite && std::isfinite(strings_.friction(m)[lane]) && std::isfinite(strings_.velocity(m)[lane]);
    }
    if (!finite)
      bowing.outcome = {Ending::not_finite,
                        "waves on the string are no longer finite: its damping and friction feed it"};
    else if (unsolved > 0)
      bowing.outcome = {
          Ending::tolerance_not_met,
          fmt::format("at {:.0f} samples no slip rate was found at which friction and waves agree", unsolved)};
    else if (bowing.raw.empty() && options_.duration == 0)
      bowing.outcome = {
          Ending::none_exists,
          fmt::format("the bow has not slipped by t = {:.4g} s, although a string without waves would have "
                      "let it go at {:.4g} s",
                      double(samples) * strings_.sample_step(), first_slip_of_slow_bow(model))};
    voice.model = nullptr;
    if (!options_.keep_slips) bowing.raw = {}, bowing.transient.slips = {};
    return bowing;
  }

 private:
  struct Voice {
    const BowedStringModel* model = nullptr;
    long begun = 0, end = 0, window = 0;
    bool listening = false;
    std::vector<SlipEpisode> slips = {};
  };

  void plan(Voice& voice, long end) {
    voice.end = end;
    voice.window = std::max(0L, end - std::lround(options_.transient.periods * period_));
    voice.listening = false;
    next_ = std::min(next_, voice.begun + voice.window);
  }
  void turn(int lane, bool slips) {
    auto& voice = voices_[lane];
    const long n = sample_ - voice.begun;
    if (slips) {
      if (voice.slips.empty() && options_.duration == 0) plan(voice, n + std::lround(options_.periods_after * period_));
      voice.slips.push_back({n, -1, 0, strings_.bow_speed()[lane]});
    } else if (!voice.slips.empty()) {
      voice.slips.back().off = n;
      voice.slips.back().distance = distance_[lane];
    }
    if (!slips) distance_.set(lane, 0);
  }

  BowingOptions options_;
  StringLanes strings_;
  double period_;  ///< samples
  long sample_ = 0, next_ = std::numeric_limits<long>::max();
  Voice voices_[lane_count];
  Lanes slipping_ = 0.0, distance_ = 0.0, most_ = -INFINITY, least_ = INFINITY;
};

/// The samples that a string sounds for, at most if it is to slip first.
/// \throws InputError where that is not known, or too many
double most_samples(const BowedStringModel& model, const BowingOptions& options) {
  const double rate = model.string.sample_rate, slips = first_slip_of_slow_bow(model);
  if (options.duration == 0 && std::isnan(slips))
    throw InputError(
        "a string sounds until some periods after its first slip only under a bow that speeds up from rest under "
        "load; give the duration (s)");
  const double samples = options.duration > 0 ? options.duration * rate
                                              : 2 * slips * rate + (options.patience + options.periods_after) * rate /
                                                                       model.string.frequency;
  if (constexpr double most = 1e8; samples > most)
    throw InputError(fmt::format("the string would sound for {:.3g} samples, more than {:.0e}: {}", samples, most,
                                 options.duration > 0 ? "take a shorter run.duration or a lower oscillator.sample_rate"
                                                      : "the bow speeds up too slowly, or run.periods are too many"));
  return samples;
}

}  // namespace

std::vector<Bowing> bow(std::span<const BowedStringModel> models, const BowingOptions& options, int threads,
                        const std::function<void(std::size_t)>& finished) {
  std::vector<Bowing> results(models.size());
  // Strings alike side by side, those that sound longest first.
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < models.size(); ++i) {
    most_samples(models[i], options);
    const auto alike = [&](const std::vector<std::size_t>& group) {
      const auto& first = models[group.front()];
      return first.string == models[i].string && first.law->card().name == models[i].law->card().name &&
             first.lambda == models[i].lambda;
    };
    const auto group = std::ranges::find_if(groups, alike);
    if (group == groups.end())
      groups.push_back({i});
    else
      group->push_back(i);
  }
  std::mutex reporting;
  for (auto& group : groups) {
    std::ranges::stable_sort(group, std::greater{}, [&](std::size_t i) {
      const double slip = first_slip_of_slow_bow(models[i]);
      return std::isnan(slip) ? 0 : slip;
    });
    std::atomic<std::size_t> next{0};
    const auto wanted = (group.size() + lane_count - 1) / lane_count;
    in_threads(int(std::min<std::size_t>(std::size_t(threads), wanted)), [&](int) {
      Sounding sounding(models[group.front()], options);
      std::size_t place[lane_count];
      int playing = 0;
      const auto take = [&](int lane) {
        const auto k = next.fetch_add(1);
        if (k >= group.size()) return;
        place[lane] = group[k];
        sounding.begin(lane, models[group[k]]);
        ++playing;
      };
      for (int lane = 0; lane < lane_count; ++lane) take(lane);
      while (playing > 0) {
        if (!sounding.step()) continue;
        end_if_stopped();
        sounding.look([&](int lane) {
          results[place[lane]] = sounding.finish(lane);
          --playing;
          if (finished) {
            const std::scoped_lock lock(reporting);
            finished(place[lane]);
          }
          take(lane);
        });
      }
    });
  }
  return results;
}

Bowing bow(const BowedStringModel& model, const BowingOptions& options) {
  return bow(std::span(&model, 1), options, 1).front();
}

std::vector<std::vector<Bowing>> bow_in_stages(std::span<const BowedStringModel> models, const BowingOptions& options,
                                               int stages) {
  if (models.size() > std::size_t(lane_count)) throw InputError("more strings than lanes sound in stages");
  Sounding sounding(models.front(), options);
  std::vector<std::vector<Bowing>> results(models.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    auto all = options;
    all.duration *= stages;
    most_samples(models[i], all);
    sounding.begin(int(i), models[i]);
  }
  for (std::size_t sounds = models.size(); sounds > 0;) {
    if (!sounding.step()) continue;
    end_if_stopped();
    sounding.look([&](int lane) {
      auto& done = results[std::size_t(lane)];
      done.push_back(sounding.finish(lane));
      if (int(done.size()) < stages)
        sounding.go_on(lane, models[std::size_t(lane)]);
      else
        --sounds;
    });
  }
  return results;
}

BowedStringModel finer(BowedStringModel model, double factor) {
  model.string.sample_rate *= factor;
  return model;
}

StringRecord record(const BowedStringModel& model, const BowingOptions& options) {
  constexpr double kept = 5e6;  // samples, of each column
  const long every = 1 + long(most_samples(model, options) / kept);
  Sounding sounding(model, options);
  StringRecord record;
  const auto& strings = sounding.strings();
  const int contacts = strings.contacts();
  record.states.resize(strings.bow(0).states(0).size());
  if (contacts > 1) {
    record.contact_velocity.resize(contacts);
    record.contact_friction.resize(contacts);
  }
  sounding.begin(0, model);
  for (bool playing = true; playing;) {
    const long n = sounding.sample();
    const bool look = sounding.step();
    record.sound.push_back(strings.bridge_force()[0]);
    if (n % every == 0) {
      record.time.push_back(double(n) * model.string.step());
      record.bow_speed.push_back(strings.bow_speed()[0]);
      record.normal_load.push_back(strings.load(0));
      record.bridge_force.push_back(strings.bridge_force()[0]);
      record.nut_force.push_back(strings.nut_force(0));
      double velocity = 0, friction = 0, slip_rate = 0, stuck = 0;
      for (int m = 0; m < contacts; ++m) {
        velocity += strings.velocity(m)[0] / contacts;
        friction += strings.friction(m)[0];
        slip_rate += strings.bow(m).slip_rate()[0] / contacts;
        stuck += strings.bow(m).direction()[0] == 0 ? 1.0 / contacts : 0;
        if (contacts == 1) continue;
        record.contact_velocity[m].push_back(strings.velocity(m)[0]);
        record.contact_friction[m].push_back(strings.friction(m)[0]);
      }
      record.velocity.push_back(velocity);
      record.friction.push_back(friction);
      record.slip_rate.push_back(slip_rate);
      record.stick.push_back(stuck);
      const auto states = strings.bow(0).states(0);
      for (std::size_t k = 0; k < states.size(); ++k) record.states[k].push_back(states[k]);
    }
    if (!look) continue;
    end_if_stopped();
    sounding.look([&](int lane) {
      record.bowing = sounding.finish(lane);
      playing = false;
    });
  }
  return record;
}

double hear(StringRecord& record, const Signal::Table& response, const BowedStringModel& model, int periods) {
  const double step = model.string.step();
  record.sound = convolved(record.sound, sampled(response, 0, step));
  for (const double t : record.time) record.heard.push_back(record.sound[std::size_t(std::lround(t / step))]);
  const auto last = std::min(record.sound.size(), std::size_t(std::lround(periods * model.string.period() / step)));
  const auto end = std::span(record.sound).last(last);
  double mean = 0, squares = 0;
  for (const double x : end) mean += x / double(last);
  for (const double x : end) squares += (x - mean) * (x - mean);
  return std::sqrt(squares / double(last));
}

}  // namespace rosin::analysis::strings
