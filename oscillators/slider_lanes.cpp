/// Mechanics of 32 sliders around one batch of contacts.
#include "oscillators/slider_lanes.hpp"

#include "core/error.hpp"
#include "core/instruction_set.hpp"
#include "core/maths.hpp"

namespace rosin::oscillators {

/// Applies an operation to each pack of the lanes in use.
template <class Kernel>
void SliderLanes::for_each_pack(const Kernel& kernel) const {
  run_on_lanes([&] {
    for (int p = 0; p < packs_; ++p) kernel(p);
  });
}

SliderLanes::SliderLanes(const SliderSystem& pattern)
    : law_(pattern.model().law),
      setup_(pattern.contact_setup()),
      mechanics_(pattern.mechanics()),
      rigid_(pattern.rigid()),
      switches_(law_->set_valued()),
      forgives_(mechanics_ == Mechanics::inertial && rigid_ && pattern.carries_friction()),
      contact_slip_rate_(pattern.contact_slip_rate_index()),
      contact_(law_->lanes(setup_)) {
  if (!pattern.autonomous()) throw InputError("sliders in lanes need a drive that is constant in time");
  mechanical_ = pattern.size() - contact_->unknowns();
  scale_.resize(size());
  for (int lane = 0; lane < lane_count; ++lane) load(lane, pattern);
}

void SliderLanes::use_packs(int packs) {
  LaneWork::use_packs(packs);
  if (auto* work = dynamic_cast<LaneWork*>(contact_.get())) work->use_packs(packs);
}

bool SliderLanes::fits(const SliderSystem& slider) const {
  const auto& setup = slider.contact_setup();
  if (!slider.autonomous() || slider.mechanics() != mechanics_ || setup.unknowns != setup_.unknowns ||
      slider.size() != size() || slider.rigid() != rigid_ || setup.spring.present() != setup_.spring.present())
    return false;
  const auto& law = *slider.model().law;
  if (&law.card() != &law_->card()) return false;        // laws from text share their name
  for (std::size_t i = 0; i < law.values().size(); ++i)  // lists are shared by all lanes
    if (law.parameters()[i].is_list && law.values()[i] != law_->values()[i]) return false;
  return true;
}

void SliderLanes::load(int lane, const SliderSystem& slider) {
  const auto& model = slider.model();
  contact_->load(lane, model.law->values(), slider.contact_setup());
  mass_.set(lane, model.slider.mass);
  stiffness_.set(lane, model.slider.stiffness);
  damping_.set(lane, model.slider.damping);
  speed_.set(lane, model.drive.speed.level());
  load_.set(lane, model.drive.normal_load.level());
  force_.set(lane, model.drive.force.level());
  direction_.set(lane, 1);
  double s[capacity];
  slider.relevance_scale(s);  // speeds are measured by the drive's, or their own
  // What errors cost and bring, by measurement: friction follows from slip rate and states, which are asked for more.
  // Where errors that are soon forgotten are forgiven, the others count for more: those of displacement are kept for
  // good.
  const double displacement = forgives_ ? 0.03 : 1, slip_rate = forgives_ ? 0.1 : 0.3, friction = 5, state = 0.3;
  for (int i = 0; i < size(); ++i) {
    const bool speed = (mechanical_ > 1 && i == 1) || i == contact_slip_rate_;
    const bool carried = slider.carries_friction() && i == mechanical_;
    scale_[i].set(lane, s[i] * (speed ? slip_rate : carried ? friction : i < mechanical_ ? displacement : state));
  }
  if (forgives_)
    loading_time_.set(lane, slider.direct_effect() * model.drive.normal_load.level() /
                                (model.slider.stiffness * model.drive.speed.level()));
}

void SliderLanes::mass(Lanes* m) const {
  if (mechanical_ > 0) m[0] = 1.0;
  if (mechanical_ > 1) m[1] = mass_;
  contact_->mass(load_, m + mechanical_);
}

void SliderLanes::imposed_slip_rate(const Lanes* y, Lanes& u) const {
  if (mechanics_ == Mechanics::inertial) {
    u = y[1];
  } else if (mechanics_ == Mechanics::elastic) {
    u = speed_;
  } else {
    for_each_pack([&](int p) __attribute__((always_inline)) {
      const Pack F = load_.pack[p] * y[1].pack[p];
      u.pack[p] = speed_.pack[p] - (F + force_.pack[p] - stiffness_.pack[p] * y[0].pack[p]) / damping_.pack[p];
    });
  }
}

/// The rows of displacement and slip rate.
void SliderLanes::mechanics(const Lanes* y, const Lanes& F, Lanes* f) const {
  if (mechanics_ != Mechanics::inertial) return;
  for_each_pack([&](int p) __attribute__((always_inline)) {
    const Pack velocity = speed_.pack[p] - y[1].pack[p];
    f[0].pack[p] = velocity;
    f[1].pack[p] = stiffness_.pack[p] * y[0].pack[p] + damping_.pack[p] * velocity - F.pack[p] - force_.pack[p];
    if (switches_) f[1].pack[p] = slips(p) * f[1].pack[p];  // in stick the contact bears what is left
  });
}

void SliderLanes::evaluate(const Lanes* y, Lanes* f) const {
  Lanes u, F;
  imposed_slip_rate(y, u);
  contact_->evaluate({u, load_, none_, direction_}, y + mechanical_, f + mechanical_, F);
  mechanics(y, F, f);
  if (mechanics_ == Mechanics::damped)
    for_each_pack([&](int p) __attribute__((always_inline)) { f[0].pack[p] = speed_.pack[p] - u.pack[p]; });
}

void SliderLanes::linearise(const Lanes* y, Lanes* f, Lanes* jacobian) const {
  const int n = size(), nz = contact_->unknowns(), first = mechanical_;
  Lanes u, F;
  Slopes<Lanes> slopes;
  imposed_slip_rate(y, u);
  contact_->linearise({u, load_, none_, direction_}, y + first, f + first, F, slopes);
  mechanics(y, F, f);
  for_each_pack([&](int p) __attribute__((always_inline)) {
    const auto J = [&](int i, int j) __attribute__((always_inline))->Pack& { return jacobian[i * n + j].pack[p]; };
    for (int i = 0; i < nz; ++i)
      for (int j = 0; j < nz; ++j) J(first + i, first + j) = slopes.g_z[i * nz + j].pack[p];
    if (mechanics_ == Mechanics::inertial) {
      J(0, 0) = 0.0;
      J(0, 1) = -1.0;
      J(1, 0) = stiffness_.pack[p];
      J(1, 1) = -damping_.pack[p] - slopes.F_u.pack[p];
      for (int j = 0; j < nz; ++j) {
        J(0, first + j) = 0.0;
        J(1, first + j) = -slopes.F_z[j].pack[p];
        J(first + j, 0) = 0.0;
        J(first + j, 1) = slopes.g_u[j].pack[p];
      }
      if (switches_)
        for (int j = 0; j < n; ++j) J(1, j) = slips(p) * J(1, j);
    } else if (mechanics_ == Mechanics::damped) {
      // u = V − (N μ + f − k x)/c
      const Pack u_x = stiffness_.pack[p] / damping_.pack[p], u_mu = -load_.pack[p] / damping_.pack[p];
      f[0].pack[p] = speed_.pack[p] - u.pack[p];
      J(0, 0) = -u_x;
      J(0, 1) = -u_mu;
      for (int j = 2; j < n; ++j) J(0, j) = 0.0;
      for (int i = 0; i < nz; ++i) {
        J(first + i, 0) = slopes.g_u[i].pack[p] * u_x;
        J(first + i, first) = J(first + i, first) + slopes.g_u[i].pack[p] * u_mu;
      }
    }
  });
}

void SliderLanes::scale(const Lanes* y, const Lanes* jacobian, Lanes* s) const {
  for (int i = 0; i < size(); ++i) s[i] = scale_[i];
  for (const int speed : {mechanical_ > 1 ? 1 : -1, contact_slip_rate_})
    if (speed >= 0)
      for_each_pack([&](int p) __attribute__((always_inline)) {
        s[speed].pack[p] = max(s[speed].pack[p], abs(y[speed].pack[p]));
      });
  if (forgives_) forgive_states(jacobian, s);
}

/// The error of a state pushes the slip rate, against inertia and the direct effect, for as long as the state remembers
/// it. Where that is too short to matter, and to last until the drive has loaded the contact, larger ones will do:
/// states that follow slip closely, and contacts that have only begun to heal.
void SliderLanes::forgive_states(const Lanes* jacobian, Lanes* s) const {
  constexpr double soon = 0.1, most = 100;
  const int n = size(), friction = mechanical_;
  Lanes m[capacity];
  mass(m);
  for_each_pack([&](int p) __attribute__((always_inline)) {
    // Row `friction` is u − v(μ, states): ∂v/∂μ, which is the inverse of the direct effect, and ∂v/∂state.
    const Pack v_mu = abs(jacobian[friction * n + friction].pack[p]);
    const Pack inertia_over_load = mass_.pack[p] / load_.pack[p];
    for (int i = friction + 1; i < n; ++i) {
      const Pack forgets = abs(jacobian[i * n + i].pack[p]) / m[i].pack[p];
      const Pack v_state = abs(jacobian[friction * n + i].pack[p]) * s[i].pack[p];
      const Pack harmless = s[1].pack[p] * (1.0 + inertia_over_load * forgets * v_mu) / max(v_state, Pack(1e-300));
      const Pack forgotten = soon * forgets * loading_time_.pack[p];
      // In this order, in which what is no number forgives nothing.
      s[i].pack[p] = s[i].pack[p] * min(max(Pack(1.0), min(forgotten, harmless)), Pack(most));
    }
  });
}

void SliderLanes::contact_slip_rate(const Lanes* y, Lanes& v) const {
  if (contact_slip_rate_ >= 0) {
    v = y[contact_slip_rate_];
    return;
  }
  imposed_slip_rate(y, v);
  if ((rigid_ && mechanics_ == Mechanics::inertial) || setup_.unknowns != Unknowns::friction) return;
  // The friction row is g₀ = u − v, or u − ė − v behind a damped spring, whose ė is the last row.
  Lanes f[Slopes<double>::capacity], F;
  contact_->evaluate({v, load_, none_, direction_}, y + mechanical_, f, F);
  const int stretching = contact_->unknowns() - 1;
  for_each_pack([&](int p) __attribute__((always_inline)) {
    v.pack[p] = v.pack[p] - f[0].pack[p];
    if (setup_.spring.present()) v.pack[p] = v.pack[p] - f[stretching].pack[p];
  });
}

void SliderLanes::friction_coefficient(const Lanes* y, Lanes& mu) const {
  if (setup_.unknowns == Unknowns::friction) {
    mu = y[mechanical_];
    return;
  }
  Lanes u, F, f[Slopes<double>::capacity];
  imposed_slip_rate(y, u);
  contact_->evaluate({u, load_, none_, direction_}, y + mechanical_, f, F);
  for_each_pack([&](int p) __attribute__((always_inline)) {
    if (switches_) {
      const Pack holds = stiffness_.pack[p] * y[0].pack[p] + damping_.pack[p] * speed_.pack[p] - force_.pack[p];
      F.pack[p] = select(slips(p) > Pack(0.0), F.pack[p], holds);
    }
    mu.pack[p] = F.pack[p] / load_.pack[p];
  });
}

void SliderLanes::pace(const Lanes* y, Lanes& growth_rate, Lanes& acceleration) const {
  const int n = size();
  Lanes f[capacity], jacobian[capacity * capacity], m[capacity];
  linearise(y, f, jacobian);
  mass(m);
  growth_rate = 0.0;
  for_each_pack([&](int p) __attribute__((always_inline)) {
    Pack& rate = growth_rate.pack[p];
    acceleration.pack[p] = f[1].pack[p] / m[1].pack[p];
    for (int i = 1; i < n; ++i) {
      const Pack own = jacobian[i * n + i].pack[p] / m[i].pack[p];
      rate = max(rate, own);
      for (int j = 1; j < i; ++j) {
        const Pack feedback = jacobian[i * n + j].pack[p] * jacobian[j * n + i].pack[p] / (m[i].pack[p] * m[j].pack[p]);
        const Pack together = greater_eigenvalue(own, Pack(jacobian[j * n + j].pack[p] / m[j].pack[p]), feedback);
        rate = select(feedback > Pack(0.0), max(rate, together), rate);
      }
    }
  });
}

}  // namespace rosin::oscillators
