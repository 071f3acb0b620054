/// Responses and curves from the contact's derivatives; steps and holds as motion of the contact at a held slip rate.
#include "analysis/inference/measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/response/contact_slopes.hpp"
#include "analysis/response/frf.hpp"
#include "core/error.hpp"
#include "solvers/steps/collocation.hpp"

namespace rosin::analysis::inference {

namespace {

constexpr int most = Slopes<double>::capacity;

/// A contact at constant slip rate and load as a system, and what numbers of the model do to it. Lists of slopes S are
/// unknowns × numbers, row-major.
class HeldContact final : public System {
 public:
  /// \param contact,slopes of the model; kept by reference.
  /// \param typical the slip rate in whose steady sliding errors are measured.
  HeldContact(const Model& model, const Contact<double>& contact, const std::vector<response::ContactSlopes>& slopes,
              double slip_rate, double typical)
      : in_{slip_rate, model.drive.normal_load.level(), 0, double((slip_rate > 0) - (slip_rate < 0))},
        set_valued_(model.law->set_valued()),
        contact_(&contact),
        slopes_(slopes) {
    contact_->mass(in_.normal_load, mass_);
    double z[most];
    contact_->steady(0, along(typical), in_.normal_load, z, scale_);
    for (int i = 0; i < size(); ++i) scale_[i] = std::max(scale_[i], 1e-30);
  }

  int size() const override { return contact_->unknowns(); }
  bool autonomous() const override { return true; }
  void mass(double, double* m) const override {
    for (int i = 0; i < size(); ++i) m[i] = algebraic(i) ? 0 : 1;
  }
  void evaluate(double, const double* z, double* f) const override {
    double F;
    contact_->evaluate(in_, z, f, F);
    for (int i = 0; i < size(); ++i) f[i] /= divisor(i);
  }
  void linearise(double, const double* z, double* f, double* jacobian) const override {
    const int n = size();
    Slopes<double> slopes;
    double F;
    contact_->linearise(in_, z, f, F, slopes);
    for (int i = 0; i < n; ++i) {
      f[i] /= divisor(i);
      for (int j = 0; j < n; ++j) jacobian[i * n + j] = slopes.g_z[i * n + j] / divisor(i);
    }
  }
  void scale(const double*, double* s) const override { std::copy_n(scale_, size(), s); }
  std::string unknown(int i) const override { return fmt::format("unknown {} of the contact", i); }

  int numbers() const { return int(slopes_.size()); }
  /// Slopes of f by the numbers.
  void force(const double* z, double* f_p) const {
    double f[most];
    evaluate(0, z, f);
    for (int p = 0; p < numbers(); ++p) {
      const auto change = slopes_[std::size_t(p)].values(in_, z);
      for (int i = 0; i < size(); ++i)
        f_p[i * numbers() + p] = (change.g[std::size_t(i)] - f[i] * change.mass[std::size_t(i)]) / divisor(i);
    }
  }
  /// Unknowns of steady sliding, and their slopes.
  std::vector<double> steady(std::vector<double>& S) const {
    double z[most], weight[most], g[most], F;
    contact_->steady(0, along(in_.slip_rate), in_.normal_load, z, weight);
    const int n = size();
    Slopes<double> slopes;
    contact_->linearise(in_, z, g, F, slopes);
    const std::vector<double> A(slopes.g_z, slopes.g_z + n * n);
    S.assign(std::size_t(n * numbers()), 0.0);
    for (int p = 0; p < numbers(); ++p) {
      const auto shift = slopes_[std::size_t(p)].steady(in_, z, A);
      for (int i = 0; i < n; ++i) S[std::size_t(i * numbers() + p)] = shift[std::size_t(i)];
    }
    return {z, z + n};
  }
  /// Makes S consistent with an algebraic row at z, as a jump of the slip rate has left it.
  void settle(const double* z, std::vector<double>& S) const {
    const int n = size();
    double f[most], J[most * most];
    std::vector<double> f_p(std::size_t(n * numbers()));
    linearise(0, z, f, J);
    force(z, f_p.data());
    for (int i = 0; i < n; ++i) {
      if (!algebraic(i)) continue;
      for (int p = 0; p < numbers(); ++p) {
        double sum = f_p[std::size_t(i * numbers() + p)];
        for (int j = 0; j < n; ++j)
          if (j != i) sum += J[i * n + j] * S[std::size_t(j * numbers() + p)];
        S[std::size_t(i * numbers() + p)] = -sum / J[i * n + i];
      }
    }
  }
  /// dF/dt at z, on its way.
  double friction_rate(const double* z) const {
    const int n = size();
    Slopes<double> slopes;
    double f[most], rate[most] = {}, sum = 0, F;
    contact_->linearise(in_, z, f, F, slopes);
    for (int i = 0; i < n; ++i)
      if (!algebraic(i)) rate[i] = f[i] / mass_[i];
    for (int i = 0; i < n; ++i) {
      if (!algebraic(i)) continue;
      for (int j = 0; j < n; ++j)
        if (j != i) rate[i] -= slopes.g_z[i * n + j] * rate[j] / slopes.g_z[i * n + i];
    }
    for (int i = 0; i < n; ++i) sum += slopes.F_z[i] * rate[i];
    return sum;
  }
  double friction(const double* z) const {
    double g[most], F;
    contact_->evaluate(in_, z, g, F);
    return F;
  }
  /// Adds friction at these unknowns and its slopes to the prediction.
  void read(const double* z, const std::vector<double>& S, Prediction& prediction) const {
    Slopes<double> slopes;
    double g[most], F;
    contact_->linearise(in_, z, g, F, slopes);
    prediction.y.push_back(F / in_.normal_load);
    for (int p = 0; p < numbers(); ++p) {
      double change = slopes_[std::size_t(p)].values(in_, z).F;
      for (int i = 0; i < size(); ++i) change += slopes.F_z[i] * S[std::size_t(i * numbers() + p)];
      prediction.slopes[std::size_t(p)].push_back(change / in_.normal_load);
    }
  }

 private:
  bool algebraic(int i) const { return mass_[i] == 0; }
  double divisor(int i) const { return algebraic(i) ? 1 : mass_[i]; }
  /// The slip rate that a law is asked at for its steady sliding.
  double along(double slip_rate) const { return set_valued_ ? std::abs(slip_rate) : slip_rate; }

  ContactInput<double> in_;
  bool set_valued_;
  const Contact<double>* contact_;
  const std::vector<response::ContactSlopes>& slopes_;
  double mass_[most] = {}, scale_[most] = {};
};

void respond(const Model& model, const std::vector<std::string>& paths, const Measurement& m, Prediction& prediction) {
  const response::FrictionResponse response(model);
  std::vector<response::ResponseSlope> slopes;
  for (const auto& path : paths) slopes.emplace_back(response, model, path);
  const auto add = [](std::vector<double>& list, std::complex<double> Z) {
    list.push_back(Z.real()), list.push_back(Z.imag());
  };
  for (const double f : m.x) {
    const auto passage = response.passage({0, 2 * std::numbers::pi * f});
    add(prediction.y, passage.force);
    for (std::size_t p = 0; p < paths.size(); ++p) add(prediction.slopes[p], slopes[p](passage).slope);
  }
}

/// Motion of a held contact, and its slopes by the numbers of the model.
class HeldMotion {
 public:
  HeldMotion(const HeldContact& held, const std::string& name, const std::vector<double>& start, std::vector<double> S)
      : held_(held), name_(name), solver_(held, 1e-10), S_(std::move(S)) {
    if (!solver_.start(0, start)) throw InputError(name_ + ": the motion cannot begin");
    held_.settle(solver_.state().data(), S_);
  }
  const std::vector<double>& state() const { return solver_.state(); }
  const std::vector<double>& slopes() const { return S_; }

  void to(double time) {
    while (solver_.time() < time) {
      step(time);
      propagate();
    }
  }
  /// To the first maximum of friction, or to where it does not rise any more.
  void to_peak() {
    double before = held_.friction_rate(state().data());
    std::vector<double> z(state().size());
    const auto rate_at = [&](double, const double* at) { return held_.friction_rate(at); };
    for (bool found = !(before > 0); !found; propagate()) {
      step(infinity);
      double low = 0;
      for (int i = 0; i < solvers::steps::Collocation::stages && !found; ++i) {
        solver_.stage(i, z.data());
        const double here = held_.friction_rate(z.data());
        if (here < 0) {
          const auto at = solver_.locate(rate_at, low, solver_.node(i), before, here);
          if (!at || !solver_.shorten(*at)) throw InputError(name_ + ": the peak could not be located");
          found = true;
        }
        low = solver_.node(i), before = here;
      }
      constexpr double settled = 1e-13;  // of friction, that it still rises by in as much time as has passed
      found = found || before * solver_.time() <= settled * std::abs(held_.friction(state().data()));
    }
  }

 private:
  void step(double limit) {
    // Motion that parameters far off have made stiff or fast must not take for ever.
    constexpr long most_steps = 20'000;
    if (solver_.count().steps >= most_steps)
      throw InputError(
          fmt::format("{}: the motion takes more than {} steps to t = {:.3g} s", name_, most_steps, solver_.time()));
    if (const auto outcome = solver_.step(limit); !outcome.complete())
      throw InputError(fmt::format("{}: the motion could not be followed: {}", name_, outcome.detail));
  }
  void propagate() {
    if (held_.numbers() > 0)
      solver_.propagate(S_, held_.numbers(), [&](double, const double* z, double* f_p) { held_.force(z, f_p); });
  }

  const HeldContact& held_;
  const std::string& name_;
  solvers::steps::Collocation solver_;
  std::vector<double> S_;
};

/// What `reader` reads at each time of the motion of `held` from steady sliding in `before`. `reload`: where a spring
/// yields, it reads the peak of its own motion from there.
void follow(const HeldContact& held, const HeldContact& before, const HeldContact& reader, const Measurement& m,
            bool reload, Prediction& prediction) {
  std::vector<double> S;
  const auto start = before.steady(S);
  if (held.size() == 0) {
    for (std::size_t i = 0; i < m.x.size(); ++i) reader.read(start.data(), S, prediction);
    return;
  }
  HeldMotion motion(held, m.name, start, S);
  for (const double time : m.x) {
    motion.to(time);
    if (!reload) {
      reader.read(motion.state().data(), motion.slopes(), prediction);
      continue;
    }
    HeldMotion again(reader, m.name, motion.state(), motion.slopes());
    again.to_peak();
    reader.read(again.state().data(), again.slopes(), prediction);
  }
}

}  // namespace

Prediction predict(const Model& given, const Measurement& m, const std::vector<std::string>& paths) {
  using Kind = Measurement::Kind;
  Model model = given;
  model.drive = {m.slip_rate, m.normal_load, 0.0};
  // Steady sliding does not know the clock of the states, nor a spring.
  std::vector<std::string> own = paths;
  if (m.kind == Kind::hold && (!model.law->has_states() || model.lambda == 0))
    throw InputError(fmt::format("law '{}' without states does not remember a hold", model.law->card().name));
  const bool reload = m.kind == Kind::hold && model.contact_stiffness.present();
  if (reload && model.law->set_valued())
    throw InputError(
        fmt::format("{}: law '{}' sticks to its spring when sliding resumes, which a hold does not follow; leave "
                    "law.contact_stiffness out, or use 'rosin lab slide-hold-slide'",
                    m.name, model.law->card().name));
  if (m.kind == Kind::steady_curve) {
    model.contact_stiffness = {};
    std::erase_if(own, [](const std::string& path) { return path.starts_with("law.contact_stiffness."); });
    model.lambda = 0;
    std::erase(own, "law.lambda");
  }

  Prediction found{{}, std::vector<std::vector<double>>(own.size())};
  if (m.kind == Kind::frequency_response) {
    respond(model, own, m, found);
  } else {
    const auto setup = response::imposed_contact_setup(model);
    const auto contact = model.law->contact(setup);
    std::vector<response::ContactSlopes> slopes;
    for (const auto& path : own) slopes.emplace_back(model, setup, path);
    const auto held = [&](double slip_rate, double typical) {
      return HeldContact(model, *contact, slopes, slip_rate, typical);
    };
    if (m.kind == Kind::steady_curve) {
      for (const double v : m.x) {
        const auto sliding = held(v, v);
        std::vector<double> S;
        const auto z = sliding.steady(S);
        sliding.read(z.data(), S, found);
      }
    } else if (m.kind == Kind::velocity_step) {
      const auto after = held(m.next_slip_rate, m.next_slip_rate);
      follow(after, held(m.slip_rate, m.next_slip_rate), after, m, false, found);
    } else {
      const auto sliding = held(m.slip_rate, m.slip_rate);
      follow(held(0, m.slip_rate), sliding, sliding, m, reload, found);
    }
  }
  Prediction prediction{std::move(found.y), {}};
  for (const auto& path : paths) {
    const auto at = std::ranges::find(own, path);
    prediction.slopes.push_back(at == own.end() ? std::vector<double>(prediction.y.size(), 0.0)
                                                : found.slopes[std::size_t(at - own.begin())]);
  }
  return prediction;
}

}  // namespace rosin::analysis::inference
