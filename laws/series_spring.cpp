/// Any contact behind a spring and a damper.
#include "core/error.hpp"
#include "core/tower.hpp"
#include "laws/portion.hpp"
#include "laws/wrappers.hpp"

namespace rosin::laws {

namespace {

/// Of each lane the spring: F = k(N)·e + c(N)·ė.
template <class Real>
class Spring {
  using Part = Portion<Real>;
  using Scalar = typename Part::Scalar;

 public:
  explicit Spring(const SeriesSpring& s)
      : compliance_(s.compliance),
        compliance_per_load_(s.compliance_per_load),
        damping_(s.damping),
        damping_per_load_(s.damping_per_load) {}
  Spring(const SeriesSpring& s, const SeriesSpring& slopes) requires(std::is_same_v<Real, Tower>)
      : compliance_(across(s.compliance, 0, slopes.compliance)),
        compliance_per_load_(across(s.compliance_per_load, 0, slopes.compliance_per_load)),
        damping_(across(s.damping, 0, slopes.damping)),
        damping_per_load_(across(s.damping_per_load, 0, slopes.damping_per_load)) {}
  void load(int lane, const SeriesSpring& s) {
    detail::set_lane(compliance_, lane, s.compliance);
    detail::set_lane(compliance_per_load_, lane, s.compliance_per_load);
    detail::set_lane(damping_, lane, s.damping);
    detail::set_lane(damping_per_load_, lane, s.damping_per_load);
  }

  struct At {
    Scalar k, k_N, c, c_N;  ///< stiffness and damping at a load, and their slopes by it
  };
  ROSIN_INLINE At at(const Real& load, int p) const {
    const Scalar &s = Part::of(compliance_, p), &s_N = Part::of(compliance_per_load_, p), &N = Part::of(load, p);
    const Scalar carried = max(N, Scalar(1e-300));  // without load a spring that scales with it has no stiffness
    const Scalar k = 1.0 / (s + s_N / carried);
    const Scalar ratio = k / carried;
    return {k, ratio * ratio * s_N, Part::of(damping_, p) + Part::of(damping_per_load_, p) * N,
            Part::of(damping_per_load_, p)};
  }

 private:
  Real compliance_, compliance_per_load_, damping_, damping_per_load_;
};

/// Rows and force of a contact behind a spring. `law` has n unknowns; where it carries friction e follows as unknown n,
/// else v and e as n and n + 1.
template <class Real>
struct BehindSpring {
  using Part = Portion<Real>;
  using Scalar = typename Part::Scalar;
  Spring<Real> spring;
  bool with_friction;

  int added() const { return with_friction ? 1 : 2; }

  void mass(const ContactValues<Real>& law, const Real& N, Real* m) const {
    law.mass(N, m);
    const int n = law.unknowns();
    if (!with_friction) m[n] = 0.0;
    m[n + added() - 1] = 1.0;
  }

  /// Slip rate of the law; of a contact that carries friction also ė, free of the cancellation in u − v.
  void slip(const ContactInput<Real>& in, const Real* z, int n, Real& v, Real& stretching) const {
    on_lanes<Real>([&] {
      for (int p = 0; p < Part::count; ++p) {
        const Scalar& u = Part::of(in.slip_rate, p);
        if (with_friction) {
          const auto s = spring.at(in.normal_load, p);
          Part::of(stretching, p) = (Part::of(in.normal_load, p) * Part::of(z[0], p) - s.k * Part::of(z[n], p)) / s.c;
          Part::of(v, p) = u - Part::of(stretching, p);
        } else {
          Part::of(v, p) = Part::of(z[n], p);
          Part::of(stretching, p) = u - Part::of(z[n], p);
        }
      }
    });
  }

  /// The rows beyond the law's; F comes in as the law's and leaves as the spring's.
  void finish(const ContactInput<Real>& in, const Real* z, int n, const Real& stretching, Real* g, Real& F) const {
    on_lanes<Real>([&] {
      for (int p = 0; p < Part::count; ++p) {
        if (!with_friction) {
          const auto s = spring.at(in.normal_load, p);
          const Scalar force = s.k * Part::of(z[n + 1], p) + s.c * Part::of(stretching, p);
          Part::of(g[n], p) = force - Part::of(F, p);
          Part::of(F, p) = force;
        }
        Part::of(g[n + added() - 1], p) = Part::of(stretching, p);
      }
    });
  }

  void evaluate(const ContactValues<Real>& law, const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const {
    const int n = law.unknowns();
    Real v, stretching;
    slip(in, z, n, v, stretching);
    law.evaluate({v, in.normal_load, in.load_rate, in.direction}, z, g, F);
    finish(in, z, n, stretching, g, F);
  }
};

/// The contact of a law behind a spring, for one system or for 32.
template <class Real>
class SpringContact final : public Contact<Real> {
  using Part = Portion<Real>;
  using Scalar = typename Part::Scalar;

 public:
  SpringContact(std::unique_ptr<Contact<Real>> law, const ContactSetup& setup)
      : law_(std::move(law)), rows_{Spring<Real>(setup.spring), setup.unknowns == Unknowns::friction} {}

  int unknowns() const override { return law_->unknowns() + rows_.added(); }

  void evaluate(const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const override {
    rows_.evaluate(*law_, in, z, g, F);
  }

  void linearise(const ContactInput<Real>& in, const Real* z, Real* g, Real& F, Slopes<Real>& slopes) const override {
    const int n = law_->unknowns(), all = unknowns(), e = all - 1;
    Real v, stretching;
    Slopes<Real> of_law;
    rows_.slip(in, z, n, v, stretching);
    law_->linearise({v, in.normal_load, in.load_rate, in.direction}, z, g, F, of_law);
    rows_.finish(in, z, n, stretching, g, F);
    const bool with_friction = rows_.with_friction;
    on_lanes<Real>([&] {
      for (int p = 0; p < Part::count; ++p) {
        const auto part = [&](Real & x) __attribute__((always_inline))->Scalar& { return Part::of(x, p); };
        const auto& N = Part::of(in.normal_load, p);
        const auto s = rows_.spring.at(in.normal_load, p);
        // v by all unknowns, u and N.
        Scalar v_z[Slopes<Real>::capacity], v_u(0.0), v_N(0.0);
        for (int j = 0; j < all; ++j) v_z[j] = 0.0;
        if (with_friction) {
          v_z[0] = -N / s.c;
          v_z[e] = s.k / s.c;
          v_u = 1.0;
          v_N = (s.k_N * Part::of(z[e], p) - Part::of(z[0], p) + Part::of(stretching, p) * s.c_N) / s.c;
        } else {
          v_z[n] = 1.0;
        }
        for (int i = 0; i < n; ++i) {
          const Scalar g_v = part(of_law.g_u[i]);
          for (int j = 0; j < all; ++j)
            part(slopes.g_z[i * all + j]) = (j < n ? part(of_law.g_z[i * n + j]) : Scalar(0.0)) + g_v * v_z[j];
          part(slopes.g_u[i]) = g_v * v_u;
          part(slopes.g_N[i]) = part(of_law.g_N[i]) + g_v * v_N;
        }
        // ė = u − v; where the law carries friction it is (N μ − k e)/c, which does not know u.
        for (int j = 0; j < all; ++j) part(slopes.g_z[e * all + j]) = -v_z[j];
        part(slopes.g_u[e]) = 1.0 - v_u;
        part(slopes.g_N[e]) = -v_N;
        if (with_friction) {
          for (int j = 0; j < all; ++j) part(slopes.F_z[j]) = j < n ? part(of_law.F_z[j]) : Scalar(0.0);
          part(slopes.F_u) = 0.0;
          part(slopes.F_N) = part(of_law.F_N);
        } else {
          for (int j = 0; j < all; ++j) part(slopes.F_z[j]) = 0.0;
          part(slopes.F_z[n]) = -s.c;
          part(slopes.F_z[e]) = s.k;
          part(slopes.F_u) = s.c;
          part(slopes.F_N) = s.k_N * Part::of(z[e], p) + s.c_N * Part::of(stretching, p);
          for (int j = 0; j < all; ++j)
            part(slopes.g_z[n * all + j]) = part(slopes.F_z[j]) - (j < n ? part(of_law.F_z[j]) : Scalar(0.0));
          part(slopes.g_z[n * all + n]) = part(slopes.F_z[n]) - part(of_law.F_u);
          part(slopes.g_u[n]) = part(slopes.F_u);
          part(slopes.g_N[n]) = part(slopes.F_N) - part(of_law.F_N);
        }
      }
    });
  }

  void steady_friction(const Real& u, const Real& N, Real& mu) const override { law_->steady_friction(u, N, mu); }

  void mass(const Real& N, Real* m) const override { rows_.mass(*law_, N, m); }

  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    law_->load(lane, parameters, setup);
    rows_.spring.load(lane, setup.spring);
  }

  void steady(int lane, double u, double N, double* z, double* weight) const override {
    law_->steady(lane, u, N, z, weight);
    const int n = law_->unknowns();
    const auto s = rows_.spring.at(Real(N), lane / pack_width);
    const double k = of_lane(s.k, lane);
    Real mu;
    law_->steady_friction(Real(u), Real(N), mu);
    const double F = N * of_lane(Part::of(mu, lane / pack_width), lane);
    // Deflections are measured by that of ten times the direct effect, as friction is.
    double force_size = 0.1 * N;
    if (rows_.with_friction) {
      force_size = N * weight[0];
    } else {
      z[n] = u;
      weight[n] = std::abs(u);
    }
    z[unknowns() - 1] = F / k;
    weight[unknowns() - 1] = max(force_size, 1e-300) / k;
  }

  void friction_slopes(int lane, double u, double N, double* slopes) const override {
    law_->friction_slopes(lane, u, N, slopes);
  }

  void change_load(double v, double N, double changed, double* z) const override {
    law_->change_load(v, N, changed, z);
  }

 private:
  static double of_lane(double x, int) { return x; }
  static double of_lane(const Pack& x, int lane) { return x.block[lane % pack_width]; }

  std::unique_ptr<Contact<Real>> law_;
  BehindSpring<Real> rows_;
};

class SpringTower final : public ContactValues<Tower> {
 public:
  SpringTower(std::unique_ptr<ContactValues<Tower>> law, const ContactSetup& setup, const SeriesSpring& slopes)
      : law_(std::move(law)), rows_{Spring<Tower>(setup.spring, slopes), setup.unknowns == Unknowns::friction} {}
  int unknowns() const override { return law_->unknowns() + rows_.added(); }
  void evaluate(const ContactInput<Tower>& in, const Tower* z, Tower* g, Tower& F) const override {
    rows_.evaluate(*law_, in, z, g, F);
  }
  void mass(const Tower& N, Tower* m) const override { rows_.mass(*law_, N, m); }

 private:
  std::unique_ptr<ContactValues<Tower>> law_;
  BehindSpring<Tower> rows_;
};

}  // namespace

std::unique_ptr<Contact<double>> behind_spring(std::unique_ptr<Contact<double>> law, const ContactSetup& setup) {
  return std::make_unique<SpringContact<double>>(std::move(law), setup);
}
std::unique_ptr<Contact<Lanes>> behind_spring(std::unique_ptr<Contact<Lanes>> law, const ContactSetup& setup) {
  return std::make_unique<SpringContact<Lanes>>(std::move(law), setup);
}
std::unique_ptr<ContactValues<Tower>> behind_spring(std::unique_ptr<ContactValues<Tower>> law,
                                                    const ContactSetup& setup, const SeriesSpring& slopes) {
  return std::make_unique<SpringTower>(std::move(law), setup, slopes);
}

}  // namespace rosin::laws
