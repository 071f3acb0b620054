/// Stick, slip and states of contacts under the bow, 32 at once.
#include "oscillators/bow_contact.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/instruction_set.hpp"
#include "core/maths.hpp"
#include "oscillators/contact_rows.hpp"

namespace rosin::oscillators {

namespace {

constexpr double within = 1e-8;  // of what a slip rate is looked for in: Newton's next step is then below rounding
constexpr int most_iterations = 100;

/// 1 or 0 of each lane.
ROSIN_INLINE Pack number(const Mask& mask) { return Pack(mask.truth); }
ROSIN_INLINE Mask truth(const Pack& number) { return number > Pack(0.5); }

bool any(const Pack& truths) {
  double sum = 0;
  for (int i = 0; i < pack_width; ++i) sum += truths.block[i];
  return sum != 0;
}

/// Solves a linear system in place, without pivoting: its matrices are 1 plus the length of a step times rates.
struct Elimination {
  static constexpr int capacity = Slopes<double>::capacity;
  int n = 0;
  Pack a[capacity * capacity];

  ROSIN_INLINE void factorise() {
    for (int k = 0; k < n; ++k) {
      const Pack pivot = 1.0 / a[k * n + k];
      a[k * n + k] = pivot;
      for (int i = k + 1; i < n; ++i) {
        const Pack m = a[i * n + k] * pivot;
        a[i * n + k] = m;
        for (int j = k + 1; j < n; ++j) a[i * n + j] = a[i * n + j] - m * a[k * n + j];
      }
    }
  }
  ROSIN_INLINE void solve(Pack* x) const {
    for (int i = 1; i < n; ++i)
      for (int k = 0; k < i; ++k) x[i] = x[i] - a[i * n + k] * x[k];
    for (int i = n - 1; i >= 0; --i) {
      for (int k = i + 1; k < n; ++k) x[i] = x[i] - a[i * n + k] * x[k];
      x[i] = x[i] * a[i * n + i];
    }
  }
};

}  // namespace

BowContacts::BowContacts(std::shared_ptr<const FrictionLaw> law, double lambda, double step)
    : setup_{.lambda = lambda, .unknowns = Unknowns::states}, step_(step) {
  contact_ = law->lanes(setup_);
  states_ = contact_->unknowns();
  set_valued_ = law->set_valued();
  odd_ = !law->deflects();
  for (auto& each : laws_) each = law;
  z_.assign(std::size_t(std::max(states_, 1)), Lanes(0.0));
  rate_ = scratch_ = z_;
  if (const auto flow = laws::heat_flow(*law); flow && states_ > 0) heat_.emplace(*flow);
  // What a law does not say of itself is seen where it has rested and where it has slid.
  limit_is_friction_ = set_valued_ && states_ > 0;
  one_friction_ = set_valued_;
  constexpr double slow = 1e-3, fast = 0.3;
  if (set_valued_)
    for (const auto& state : {law->rest(1), law->steady({slow, 1}), law->steady({fast, 1})}) {
      const double barely = law->friction({1e-300, 1}, state);
      one_friction_ =
          one_friction_ && law->friction({slow, 1}, state) == barely && law->friction({fast, 1}, state) == barely;
      limit_is_friction_ = limit_is_friction_ && law->static_limit(1, state) == barely;
    }
}

void BowContacts::set_load(int lane, double normal_load) {
  load_.set(lane, normal_load);
  if (heat_) return set_heat(lane, normal_load);
  if (!set_valued_ || states_ > 0) return;
  const auto& law = *laws_[lane];
  std::vector<double> still;
  if (law.has_states()) still = law.steady({0, normal_load});
  limit_.set(lane, normal_load * law.static_limit(normal_load, still));
}

void BowContacts::rest(int lane, std::shared_ptr<const FrictionLaw> law, double normal_load) {
  slide(lane, std::move(law), normal_load, 0);
}

void BowContacts::slide(int lane, std::shared_ptr<const FrictionLaw> given, double normal_load, double slip_rate) {
  const auto& law = *given;
  if (heat_) {
    const auto same =
        std::ranges::find_if(laws_, [&](const auto& other) { return other->values() == law.values(); }) - laws_;
    heat_->law[lane] = same < lane_count ? heat_->law[same] : *laws::heat_flow(law);
    heat_->curve[lane] = heat_->law[lane].friction.get();
  }
  laws_[lane] = std::move(given);
  contact_->load(lane, law.values(), setup_);
  unsolved_.set(lane, 0);
  drive_.set(lane, 0);
  answer_.set(lane, 0);
  set_load(lane, normal_load);
  slip_rate_.set(lane, slip_rate);
  direction_.set(lane, slip_rate == 0 ? 0 : std::copysign(1.0, slip_rate));
  if (states_ == 0) return;
  if (heat_) {
    const auto& flow = heat_->law[lane];
    const double v = std::abs(slip_rate);
    double rise = 0;
    if (v > 0) {
      const double mu = law.steady_friction({v, normal_load}).friction;
      rise = flow.crowding(normal_load) * mu * v / (flow.h0 + flow.h1 * v);
    }
    for (std::size_t k = 0; k < heat_->parts.size(); ++k) heat_->parts[k].set(lane, flow.modes[k].share * rise);
    heat_->heating.set(lane, flow.crowding(normal_load) * (*flow.friction)(rise)*v);
    return;
  }
  const auto state = slip_rate == 0 ? law.rest(normal_load) : law.steady({slip_rate, normal_load});
  for (int k = 0; k < states_; ++k) {
    z_[k].set(lane, to_unknown(law.states()[k], state[k]));
    rate_[k].set(lane, 0);
  }
}

std::vector<Lanes*> BowContacts::memory() {
  std::vector<Lanes*> all = {&direction_, &slip_rate_, &drive_, &answer_};
  if (heat_) {
    all.push_back(&heat_->heating);
    for (auto& part : heat_->parts) all.push_back(&part);
  } else {
    for (int k = 0; k < states_; ++k) all.push_back(&z_[k]), all.push_back(&rate_[k]);
  }
  return all;
}

std::vector<double> BowContacts::states(int lane) const {
  std::vector<double> state;
  if (heat_) {
    state.push_back(0);
    for (const auto& part : heat_->parts) state.back() += part[lane];
    return state;
  }
  for (int k = 0; k < states_; ++k) state.push_back(to_state(laws_[lane]->states()[k], z_[k][lane]));
  return state;
}

std::vector<Quantity> BowContacts::state_names(const FrictionLaw& law) {
  if (!laws::heat_flow(law)) return law.states();
  return {{"temperature_rise", "K", {0, 1e15}, "rise of the temperature of the contact"}};
}

void BowContacts::count_unsolved(const Lanes& open) {
  for (int p = 0; p < lane_packs; ++p) unsolved_.pack[p] = unsolved_.pack[p] + open.pack[p];
}

/// Forces that hold at rest (N).
void BowContacts::limits(const Lanes* z, Lanes& limit) {
  if (states_ == 0) {
    limit = limit_;
  } else if (limit_is_friction_) {
    contact_->evaluate(input(Lanes(0.0), Lanes(1.0)), z, scratch_.data(), limit);
  } else {
    std::vector<double> state(states_);
    for (int lane = 0; lane < lane_count; ++lane) {
      const auto& law = *laws_[lane];
      for (int k = 0; k < states_; ++k) state[k] = to_state(law.states()[k], z[k][lane]);
      limit.set(lane, load_[lane] * law.static_limit(load_[lane], state));
    }
  }
}

/// The largest slip rate at which friction is what the waves leave, by Newton's method from above. Where friction falls
/// ever less steeply, as almost all laws have it, no step passes a solution, and there is none where a step leads to
/// rest or meets a slope of the other sign. `s` is a guess; `trying`: where asked, then where found.
void BowContacts::slip(const Lanes& A, const Lanes& side, const Lanes& Z, const Lanes* z, Lanes& s, Lanes& trying) {
  Lanes g[capacity], F, open = trying, above, lost = 0.0, u;
  Slopes<Lanes> slopes;
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) above.pack[p] = number(!(s.pack[p] < A.pack[p]));
  });
  for (int i = 0; i < most_iterations && any(open); ++i) {
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) u.pack[p] = side.pack[p] * s.pack[p];
    });
    contact_->linearise(input(u, side), z, g, F, slopes);
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) {
        if (!any(open.pack[p])) continue;
        const Mask asked = truth(open.pack[p]);
        const Pack left = Z.pack[p] * (A.pack[p] - s.pack[p]) - side.pack[p] * F.pack[p];
        const Pack fall = Z.pack[p] + slopes.F_u.pack[p];
        const Pack next = min(s.pack[p] + left / fall, A.pack[p]);
        const Mask none = !((fall > 0.0) & (next > 0.0));
        const Mask again = none & !truth(above.pack[p]);  // the guess was below the solution
        answer_.pack[p] = select(asked, Pack(Z.pack[p] / fall), answer_.pack[p]);
        const Mask done = (none & !again) | ((!none) & !(abs(next - s.pack[p]) > within * A.pack[p]));
        lost.pack[p] = select(asked & none & !again, Pack(1.0), lost.pack[p]);
        s.pack[p] = select(asked & !none, next, select(asked & again, A.pack[p], s.pack[p]));
        above.pack[p] = select(again, Pack(1.0), above.pack[p]);
        open.pack[p] = select(done, Pack(0.0), open.pack[p]);
      }
    });
  }
  if (any(open)) count_unsolved(open);
  if (!any(lost)) return;
  // Friction that falls first slowly and then steeply may have a solution below: there is one if it is less at rest
  // than what the waves leave.
  contact_->evaluate(input(Lanes(0.0), side), z, g, F);
  Lanes low = 0.0, high = s, between = lost;
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p)
      between.pack[p] = number(truth(lost.pack[p]) & (Z.pack[p] * A.pack[p] > side.pack[p] * F.pack[p]));
  });
  constexpr int halvings = 60;
  for (int i = 0; i < halvings && any(between); ++i) {
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) u.pack[p] = side.pack[p] * (0.5 * (low.pack[p] + high.pack[p]));
    });
    contact_->evaluate(input(u, side), z, g, F);
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) {
        const Pack middle = 0.5 * (low.pack[p] + high.pack[p]);
        const Mask below = Z.pack[p] * (A.pack[p] - middle) > side.pack[p] * F.pack[p];
        low.pack[p] = select(below, middle, low.pack[p]);
        high.pack[p] = select(below, high.pack[p], middle);
      }
    });
  }
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      const Mask found = truth(between.pack[p]);
      s.pack[p] = select(found, low.pack[p], s.pack[p]);
      trying.pack[p] = select(truth(lost.pack[p]) & !found, Pack(0.0), trying.pack[p]);
    }
  });
}

/// From the direction before, and states z.
void BowContacts::solve_set_valued(const Lanes& D, const Lanes& Z, const Lanes* z, Lanes& slip_rate, Lanes& direction,
                                   Lanes& f) {
  Lanes limit, slides, A, side, s, tries;
  limits(z, limit);
  slides = limit;
  if (one_friction_ && !limit_is_friction_)
    contact_->evaluate(input(Lanes(1.0), Lanes(1.0)), z, scratch_.data(), slides);
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      A.pack[p] = abs(D.pack[p]);
      side.pack[p] = select(D.pack[p] < 0.0, Pack(-1.0), Pack(1.0));
      const Pack before = direction_.pack[p];
      const Mask onward = before * side.pack[p] > 0.0, holds = !(Z.pack[p] * A.pack[p] > limit.pack[p]);
      tries.pack[p] = number(onward | !holds);
      // As the slip rate has answered to the drive before.
      const Pack guess = abs(slip_rate_.pack[p]) + answer_.pack[p] * (A.pack[p] - abs(drive_.pack[p]));
      s.pack[p] = select(onward & (guess > 0.0), min(guess, A.pack[p]), A.pack[p]);
    }
  });
  if (any(tries)) {
    if (one_friction_) {
      run_on_lanes([&] {
        for (int p = 0; p < lane_packs; ++p) {
          s.pack[p] = A.pack[p] - slides.pack[p] / Z.pack[p];
          tries.pack[p] = number(truth(tries.pack[p]) & (s.pack[p] > 0.0));
        }
      });
    } else {
      slip(A, side, Z, z, s, tries);
    }
  }
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      const Mask slips = truth(tries.pack[p]);
      direction.pack[p] = select(slips, side.pack[p], Pack(0.0));
      slip_rate.pack[p] = select(slips, Pack(side.pack[p] * s.pack[p]), Pack(0.0));
      f.pack[p] = Z.pack[p] * (D.pack[p] - slip_rate.pack[p]);
    }
  });
}

/// States at the end of a step, of which slip rate and direction are those at its beginning.
void BowContacts::follow_states(const Lanes& D, const Lanes& Z, Lanes* z) {
  Lanes mass[capacity], g[capacity], F, stage[capacity], pushed[capacity], slip_rate, direction;
  Slopes<Lanes> slopes;
  contact_->mass(load_, mass);
  contact_->linearise(input(slip_rate_, direction_), z_.data(), g, F, slopes);
  const int n = states_;
  constexpr double gamma = 1 - 1 / std::numbers::sqrt2;
  Elimination left[lane_packs];
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      // In slip the slip rate answers to D by Z/(Z + F_s), to states by −F_ψ/(Z + F_s).
      const Pack slips = direction_.pack[p] * direction_.pack[p], answer = slips / (Z.pack[p] + slopes.F_u.pack[p]);
      const Pack driven = answer * Z.pack[p] * (D.pack[p] - drive_.pack[p]);
      Pack k[capacity];
      left[p].n = n;
      for (int i = 0; i < n; ++i) {
        const Pack length = step_ / mass[i].pack[p], by_slip = gamma * length * slopes.g_u[i].pack[p];
        for (int j = 0; j < n; ++j)
          left[p].a[i * n + j] = (i == j ? 1.0 : 0.0) - gamma * length * slopes.g_z[i * n + j].pack[p] +
                                 by_slip * answer * slopes.F_z[j].pack[p];
        pushed[i].pack[p] = by_slip * driven;
        k[i] = length * g[i].pack[p] + pushed[i].pack[p];
      }
      left[p].factorise();
      left[p].solve(k);
      for (int i = 0; i < n; ++i) stage[i].pack[p] = k[i], z[i].pack[p] = z_[i].pack[p] + k[i];
    }
  });
  Lanes f;
  solve_set_valued(D, Z, z, slip_rate, direction, f);
  contact_->evaluate(input(slip_rate, direction), z, g, F);
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      Pack k[capacity];
      for (int i = 0; i < n; ++i)
        k[i] = step_ / mass[i].pack[p] * g[i].pack[p] - 2.0 * stage[i].pack[p] - pushed[i].pack[p];
      left[p].solve(k);
      for (int i = 0; i < n; ++i) z[i].pack[p] = z_[i].pack[p] + 1.5 * stage[i].pack[p] + 0.5 * k[i];
    }
  });
}

BowContacts::Heat::Heat(const laws::HeatFlow& like)
    : law(lane_count, like),
      curve(lane_count, like.friction.get()),
      parts(like.modes.size(), Lanes(0.0)),
      fades(parts),
      answers(parts) {}

void BowContacts::set_heat(int lane, double normal_load) {
  auto& heat = *heat_;
  const auto& flow = heat.law[lane];
  heat.crowding.set(lane, flow.crowding(normal_load));
  heat.h1.set(lane, flow.h1);
  for (std::size_t k = 0; k < heat.parts.size(); ++k) {
    const double fades = std::exp(-step_ / (setup_.lambda * flow.relaxation(k, normal_load)));
    heat.fades[k].set(lane, fades);
    heat.answers[k].set(lane, (1 - fades) * flow.modes[k].share / flow.h0);
  }
}

/// Parts of the rise of temperature, and all of it, after a step of steady heating (m/s times friction) at a speed, of
/// which the mean of the rise at both ends is swept away.
void BowContacts::Heat::flow(const Lanes& heating, const Lanes& speed, Lanes* after, Lanes& rise) const {
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      Pack before = 0.0, left = 0.0, answer = 0.0;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        before = before + parts[k].pack[p];
        left = left + fades[k].pack[p] * parts[k].pack[p];
        answer = answer + answers[k].pack[p];
      }
      const Pack swept = 0.5 * h1.pack[p] * speed.pack[p], in = heating.pack[p] - swept * before;
      rise.pack[p] = (left + answer * in) / (1.0 + answer * swept);
      const Pack stays = in - swept * rise.pack[p];
      for (std::size_t k = 0; k < parts.size(); ++k)
        after[k].pack[p] = fades[k].pack[p] * parts[k].pack[p] + answers[k].pack[p] * stays;
    }
  });
}

void BowContacts::step_heated(const Lanes& D, const Lanes& Z, Lanes& f) {
  auto& heat = *heat_;
  Lanes rise, mu, slip_rate = slip_rate_, direction, heating = heat.heating, speed, after[capacity];
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) speed.pack[p] = abs(slip_rate_.pack[p]);
  });
  constexpr int corrections = 2;
  for (int pass = 0; pass <= corrections; ++pass) {
    heat.flow(heating, speed, after, rise);
    for (int lane = 0; lane < lane_count; ++lane) mu.set(lane, (*heat.curve[lane])(rise[lane]));
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) {
        const Pack A = abs(D.pack[p]), side = select(D.pack[p] < 0.0, Pack(-1.0), Pack(1.0));
        const Pack s = max(A - mu.pack[p] * load_.pack[p] / Z.pack[p], Pack(0.0));
        direction.pack[p] = select(s > 0.0, side, Pack(0.0));
        slip_rate.pack[p] = side * s;
        f.pack[p] = Z.pack[p] * (D.pack[p] - slip_rate.pack[p]);
        const Pack now = heat.crowding.pack[p] * mu.pack[p] * s;
        const bool last = pass == corrections;
        heating.pack[p] = last ? now : 0.5 * (heat.heating.pack[p] + now);
        speed.pack[p] = 0.5 * (abs(slip_rate_.pack[p]) + s);
      }
    });
  }
  for (std::size_t k = 0; k < heat.parts.size(); ++k) heat.parts[k] = after[k];
  heat.heating = heating;
  slip_rate_ = slip_rate;
  direction_ = direction;
}

void BowContacts::step(const Lanes& D, const Lanes& Z, Lanes& f) {
  if (heat_) return step_heated(D, Z, f);
  if (!set_valued_) return step_smooth(D, Z, f);
  Lanes slip_rate, direction, z[capacity];
  if (states_ > 0) follow_states(D, Z, z);
  solve_set_valued(D, Z, z, slip_rate, direction, f);
  for (int k = 0; k < states_; ++k) z_[k] = z[k];
  if (states_ > 0)
    for (int lane = 0; lane < lane_count; ++lane) {
      if (direction[lane] != 0 || direction_[lane] == 0) continue;
      const auto before = states(lane), after = laws_[lane]->after_stop(before);
      for (int k = 0; k < states_; ++k)
        if (after[k] != before[k]) z_[k].set(lane, to_unknown(laws_[lane]->states()[k], after[k]));
    }
  drive_ = D;
  slip_rate_ = slip_rate;
  direction_ = direction;
}

/// Laws without a limit at rest: slip rate s and states together, by Newton's method.
void BowContacts::step_smooth(const Lanes& D, const Lanes& Z, Lanes& f) {
  const int n = states_;
  Lanes g[capacity], F, mass[capacity], z[capacity], s = slip_rate_, low, high, open = 1.0;
  Slopes<Lanes> slopes;
  contact_->mass(load_, mass);
  constexpr double far = 1e9;
  run_on_lanes([&] {
    for (int k = 0; k < n; ++k) z[k] = z_[k];
    for (int p = 0; p < lane_packs; ++p) {
      // Friction against slip alone lies between rest and what the waves would do; that of a deflection need not.
      low.pack[p] = odd_ ? min(D.pack[p], Pack(0.0)) : Pack(-far);
      high.pack[p] = odd_ ? max(D.pack[p], Pack(0.0)) : Pack(far);
      s.pack[p] = min(max(s.pack[p], low.pack[p]), high.pack[p]);
    }
  });
  for (int i = 0; i < most_iterations && any(open); ++i) {
    contact_->linearise(input(s, Lanes(1.0)), z, g, F, slopes);
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) {
        Elimination left;
        left.n = n;
        Pack y[capacity], w[capacity];
        for (int i = 0; i < n; ++i) {
          const Pack half = 0.5 * step_ / mass[i].pack[p];
          for (int j = 0; j < n; ++j) left.a[i * n + j] = (i == j ? 1.0 : 0.0) - half * slopes.g_z[i * n + j].pack[p];
          y[i] = z_[i].pack[p] - z[i].pack[p] + half * (rate_[i].pack[p] + g[i].pack[p]);
          w[i] = half * slopes.g_u[i].pack[p];
        }
        left.factorise();
        left.solve(y);
        left.solve(w);
        const Pack at = s.pack[p];
        Pack over = Z.pack[p] * (D.pack[p] - at) - F.pack[p], fall = Z.pack[p] + slopes.F_u.pack[p];
        for (int i = 0; i < n; ++i) {
          over = over - slopes.F_z[i].pack[p] * y[i];
          fall = fall + slopes.F_z[i].pack[p] * w[i];
        }
        const Mask asked = truth(open.pack[p]), upward = over > 0.0;
        const Pack bottom = select(upward, at, low.pack[p]), top = select(upward, high.pack[p], at);
        const Pack newton = at + over / fall;
        const Mask outside = (newton < bottom) | (newton > top) | !(abs(newton) < far) | (fall < 0.0);
        // Between ends of one sign slip rates differ by decades.
        const Pack middle = select(bottom * top > 0.0,
                                   Pack(select(top > 0.0, Pack(1.0), Pack(-1.0)) * sqrt(max(bottom * top, Pack(0.0)))),
                                   Pack(0.5 * (bottom + top)));
        const Pack next = select(outside, middle, newton);
        const Mask moved = abs(next - at) > within * abs(next) + 1e-16 * abs(D.pack[p]) + 1e-30;
        low.pack[p] = select(asked, bottom, low.pack[p]);
        high.pack[p] = select(asked, top, high.pack[p]);
        s.pack[p] = select(asked, next, at);
        for (int i = 0; i < n; ++i)
          z[i].pack[p] = select(asked, Pack(z[i].pack[p] + y[i] + w[i] * (next - at)), z[i].pack[p]);
        open.pack[p] = select(moved, open.pack[p], Pack(0.0));
      }
    });
  }
  if (any(open)) count_unsolved(open);
  if (n > 0) contact_->evaluate(input(s, Lanes(1.0)), z, rate_.data(), F);
  for (int k = 0; k < n; ++k) z_[k] = z[k];
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      slip_rate_.pack[p] = s.pack[p];
      f.pack[p] = Z.pack[p] * (D.pack[p] - s.pack[p]);
      const Pack side = select(s.pack[p] < 0.0, Pack(-1.0), Pack(1.0));
      direction_.pack[p] = select(abs(s.pack[p]) > creep * abs(D.pack[p]), side, Pack(0.0));
    }
  });
}

}  // namespace rosin::oscillators
