/// The pencil of structure and contacts, its eigenvalues with their errors, and the turns of its determinant along the
/// axis.
#include "analysis/response/structure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "analysis/steady/thresholds.hpp"
#include "core/characteristic.hpp"
#include "core/eigenpairs.hpp"
#include "core/error.hpp"
#include "core/linear_solve.hpp"
#include "core/random.hpp"

namespace rosin::analysis::response {

using Complex = std::complex<double>;
using Matrix = Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ComplexMatrix = Eigen::MatrixXcd;

namespace {

/// Structure and contacts with everything checked.
struct Assembly {
  int n;
  Matrix M, C, K;
  struct Direction {
    Eigen::VectorXd t, normal;
    bool pressed;
  };
  std::vector<Direction> contacts;
  FrictionResponse response;
  NormalContact normal;

  Assembly(const Structure& structure, const Model& model, const std::optional<NormalContact>& given)
      : n(structure.size()),
        M(structure.M),
        C(structure.C),
        K(structure.K),
        response(model),
        normal(given.value_or(NormalContact{})) {
    if (structure.contacts.empty()) throw InputError("a structure needs a contact");
    for (const auto& [name, matrix] : {std::pair{"M", &M}, {"C", &C}, {"K", &K}})
      if (matrix->rows() != n || matrix->cols() != n)
        throw InputError(fmt::format("{} has {} × {} entries, but {} coordinates need {} × {}", name, matrix->rows(),
                                     matrix->cols(), n, n, n));
    if (!M.allFinite() || !C.allFinite() || !K.allFinite()) throw InputError("M, C and K must be finite");
    if (Eigen::FullPivLU<Matrix>(M).rank() < n) throw InputError("M is singular: every coordinate needs a mass");
    for (const auto& contact : structure.contacts) {
      const bool pressed = contact.normal.size() > 0;
      if (pressed && !given)
        throw InputError("a contact with a normal direction needs the normal contact: stiffness and damping");
      if (contact.tangential.size() != n || (pressed && (contact.normal.rows() != n || contact.normal.cols() != 1)))
        throw InputError(fmt::format("the directions of a contact need an entry for each of {} coordinates", n));
      contacts.push_back(
          {contact.tangential, pressed ? contact.normal.col(0).eval() : Eigen::VectorXd::Zero(n).eval(), pressed});
    }
  }

  /// E ẏ = A y with y = (x, ẋ, z of each contact), and what each entry was summed from.
  struct Pencil {
    RowMajor E, A, E_sizes, A_sizes;

    explicit Pencil(int size) { E.setZero(size, size), A = E_sizes = A_sizes = E; }
    void add_to_E(int row, int column, const Matrix& block) { add(E, E_sizes, row, column, block); }
    void add_to_A(int row, int column, const Matrix& block) { add(A, A_sizes, row, column, block); }

   private:
    static void add(RowMajor& sum, RowMajor& sizes, int row, int column, const Matrix& block) {
      sum.block(row, column, block.rows(), block.cols()) += block;
      sizes.block(row, column, block.rows(), block.cols()) += block.cwiseAbs();
    }
  };
  Pencil pencil() const {
    const auto& l = response.linear();
    const int nz = l.size();
    Pencil p(2 * n + nz * int(contacts.size()));
    const int velocity = n;  // first row and column of ẋ
    p.add_to_E(0, 0, Matrix::Identity(n, n));
    p.add_to_A(0, velocity, Matrix::Identity(n, n));
    p.add_to_E(velocity, velocity, M);
    p.add_to_A(velocity, 0, -K);
    p.add_to_A(velocity, velocity, -C);
    for (std::size_t j = 0; j < contacts.size(); ++j) {
      const auto& [t, normal_direction, pressed] = contacts[j];
      const int z = 2 * n + int(j) * nz;
      // δv = −tᵀẋ, δN = pᵀx + qᵀẋ; M ẍ = … + t δF − n δN with δF = c z + d_v v + d_N N + d_R Ṅ
      const Eigen::RowVectorXd slip = -t.transpose(), pressing = normal_direction.transpose(),
                               p_T = normal.stiffness * pressing, damping = normal.damping * pressing,
                               lift = (pressed ? normal.lift : 0.0) * slip;
      for (const Eigen::RowVectorXd& q_T : {damping, lift}) {
        p.add_to_A(velocity, velocity, t * l.d_N * q_T);
        p.add_to_A(velocity, velocity, -normal_direction * q_T);
        p.add_to_E(velocity, velocity, -t * l.d_R * q_T);
      }
      p.add_to_A(velocity, 0, t * l.d_N * p_T);
      p.add_to_A(velocity, 0, -normal_direction * p_T);
      p.add_to_A(velocity, velocity, t * l.d_R * p_T);
      p.add_to_A(velocity, velocity, t * l.d_v * slip);
      for (int i = 0; i < nz; ++i) {
        const auto k = std::size_t(i);
        p.add_to_E(z + i, z + i, Matrix::Constant(1, 1, l.mass[k]));
        for (int m = 0; m < nz; ++m)
          p.add_to_A(z + i, z + m, Matrix::Constant(1, 1, l.A[k * std::size_t(nz) + std::size_t(m)]));
        p.add_to_A(z + i, velocity, l.b_v[k] * slip);
        p.add_to_A(z + i, 0, l.b_N[k] * p_T);
        p.add_to_A(z + i, velocity, l.b_R[k] * p_T);
        for (const Eigen::RowVectorXd& q_T : {damping, lift}) {
          p.add_to_A(z + i, velocity, l.b_N[k] * q_T);
          p.add_to_E(z + i, velocity, -l.b_R[k] * q_T);
        }
        p.add_to_A(velocity, z + i, t * l.c[k]);
      }
    }
    return p;
  }

  /// Dynamic stiffness at s of the structure whose contacts press and slide without friction.
  ComplexMatrix without_friction(Complex s) const {
    ComplexMatrix D = s * s * M.cast<Complex>() + s * C.cast<Complex>() + K.cast<Complex>();
    for (const auto& contact : contacts) {
      const ComplexMatrix pressing = contact.normal.cast<Complex>();
      D += pressing * ((normal.stiffness + normal.damping * s) * pressing.transpose());
    }
    return D;
  }
  /// The same with friction, Z = δF/δv as given: a measured one, or the law's.
  ComplexMatrix stiffness(Complex s, Complex Z) const {
    ComplexMatrix D = without_friction(s);
    const Complex Y = response.normal(s);
    for (const auto& [t, direction, pressed] : contacts) {
      const ComplexMatrix tangential = t.cast<Complex>(), pressing = direction.cast<Complex>();
      // F = −Z s tᵀx + Y N, N = (k_n + c_n s) nᵀx + lift, lift = −lift s tᵀx; on the structure t F − n N
      const ComplexMatrix lift = (pressed ? -normal.lift : 0.0) * s * tangential.transpose();
      const ComplexMatrix N = (normal.stiffness + normal.damping * s) * pressing.transpose() + lift;
      D += tangential * (Z * s * tangential.transpose() - Y * N) + pressing * lift;
    }
    return D;
  }
  ComplexMatrix stiffness(Complex s) const { return stiffness(s, response.tangential(s)); }
  /// 1 + L: what friction makes of the determinant; 1 + s Z H of one contact under a steady load.
  Complex distance(Complex s, Complex Z) const {
    return without_friction(s).partialPivLu().solve(stiffness(s, Z)).determinant();
  }
};

/// Angle by which f turns from a to b, by halving until each piece turns little. Nothing if it will not resolve.
template <class F>
std::optional<double> turn(const F& f, double a, Complex fa, double b, Complex fb, int depth) {
  const double middle = 0.5 * (a + b);
  const Complex fm = f(middle);
  const double first = std::arg(fm / fa), second = std::arg(fb / fm);
  constexpr double small = 0.4;
  if (std::abs(first) < small && std::abs(second) < small) return first + second;
  if (depth == 0 || !(middle > a && middle < b)) return std::nullopt;
  const auto left = turn(f, a, fa, middle, fm, depth - 1);
  if (!left) return left;
  const auto right = turn(f, middle, fm, b, fb, depth - 1);
  if (!right) return right;
  return *left + *right;
}

/// An eigenvalue (1/s), and the error of its real part.
struct Eigenvalue {
  Complex value;
  double real_error;
  /// The sign of the real part is beyond rounding.
  bool decided() const { return std::abs(value.real()) > 4 * real_error; }
  bool grows() const { return value.real() > 0 && decided(); }
};

/// By QR of (A − σE)⁻¹E with σ in the unit of the structure's frequencies, which sends the eigenvalues at infinity to
/// 0. Keeps the digits of close frequencies, and loses those of rates that lie many decades below σ. Nothing where no
/// iteration converges.
std::vector<Eigenvalue> eigenvalues_by_inversion(const Assembly& assembly, const Assembly::Pencil& pencil) {
  const double clock = std::max(1e-30, std::sqrt(assembly.K.cwiseAbs().maxCoeff() / assembly.M.cwiseAbs().maxCoeff()));
  for (const double shift : {1.0, 1.37, 0.61}) {  // one of them is no eigenvalue
    const double sigma = shift * clock;
    Matrix B = pencil.A - sigma * pencil.E, E = clock * pencil.E;
    for (int i = 0; i < B.rows(); ++i) {  // rows in their own sizes
      const double size = std::max(B.row(i).cwiseAbs().maxCoeff(), 1e-300);
      B.row(i) /= size, E.row(i) /= size;
    }
    const auto spectrum = spectrum_of(B.partialPivLu().solve(E));
    std::vector<Eigenvalue> list;
    bool finite = true;
    for (std::size_t i = 0; i < spectrum.values.size(); ++i) {
      const Complex inverse = spectrum.values[i];
      finite = finite && std::isfinite(std::abs(inverse));
      if (std::abs(inverse) <= 2 * spectrum.errors[i]) continue;  // an eigenvalue at infinity
      list.push_back({sigma + clock / inverse, clock * spectrum.errors[i] / std::norm(inverse)});
    }
    if (finite) return list;
  }
  return {};
}

/// By the characteristic polynomial of small structures: keeps the digits of rates many decades apart, and loses some
/// of close frequencies. Nothing where it is beyond the range of numbers.
std::vector<Eigenvalue> eigenvalues_by_expansion(const Assembly::Pencil& pencil) {
  const auto count = std::size_t(pencil.A.size());
  const auto roots = pencil_roots({pencil.A.data(), count}, {pencil.E.data(), count}, {pencil.A_sizes.data(), count},
                                  {pencil.E_sizes.data(), count});
  std::vector<Eigenvalue> list;
  for (std::size_t i = 0; i < roots.values.size(); ++i) {
    if (!std::isfinite(std::abs(roots.values[i])) || !std::isfinite(roots.real_errors[i])) return {};
    list.push_back({roots.values[i], roots.real_errors[i]});
  }
  return list;
}

/// Those that are finite, largest real part first; by expansion where that knows the first of them better.
std::vector<Eigenvalue> eigenvalues(const Assembly& assembly) {
  const auto sorted = [](std::vector<Eigenvalue> list) {
    std::ranges::sort(list, [](const Eigenvalue& a, const Eigenvalue& b) {
      return a.value.real() != b.value.real() ? a.value.real() > b.value.real() : a.value.imag() > b.value.imag();
    });
    return list;
  };
  const auto pencil = assembly.pencil();
  auto list = sorted(eigenvalues_by_inversion(assembly, pencil));
  constexpr double known_well = 1e-6;  // the root of rounding where two eigenvalues merge is
  const bool known = !list.empty() && list.front().real_error < known_well * std::abs(list.front().value);
  if (!known && std::size_t(pencil.A.rows()) <= most_expanded)
    if (auto expanded = sorted(eigenvalues_by_expansion(pencil));
        !expanded.empty() && (list.empty() || expanded.front().real_error < list.front().real_error))
      list = std::move(expanded);
  if (list.empty())
    throw InputError(
        "the eigenvalues of structure and contacts could not be computed: they are beyond the range of numbers, or no "
        "iteration converges");
  return list;
}

/// What a structure has of a contact here: where it slips, and along what it is pressed (empty: the load is given).
oscillators::FrictionContact directions(Eigen::VectorXd tangential, Eigen::MatrixXd normal = {}) {
  oscillators::FrictionContact contact;
  contact.tangential = std::move(tangential), contact.normal = std::move(normal);
  return contact;
}

}  // namespace

Structure modal(const std::vector<Mode>& modes) {
  const auto n = Eigen::Index(modes.size());
  Structure s;
  s.M = s.C = s.K = Matrix::Zero(n, n);
  auto contact = directions(Eigen::VectorXd(n), Eigen::VectorXd(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& mode = modes[std::size_t(i)];
    const double omega = 2 * std::numbers::pi * mode.frequency;
    s.M(i, i) = mode.mass;
    s.C(i, i) = 2 * mode.damping_ratio * omega * mode.mass;
    s.K(i, i) = omega * omega * mode.mass;
    contact.tangential[i] = mode.tangential, contact.normal(i, 0) = mode.normal;
  }
  if (contact.normal.isZero(0)) contact.normal.resize(0, 0);
  s.contacts.push_back(std::move(contact));
  return s;
}

Complex receptance(const Structure& structure, Complex s) {
  const ComplexMatrix D =
      s * s * structure.M.cast<Complex>() + s * structure.C.cast<Complex>() + structure.K.cast<Complex>();
  const ComplexMatrix t = structure.contacts.front().tangential.cast<Complex>();
  return (t.transpose() * D.partialPivLu().solve(t))(0, 0);
}

std::vector<double> loads_under_friction(const Structure& structure, const Model& model, const NormalContact& normal) {
  const Assembly assembly(structure, model, normal);
  if (std::ranges::none_of(assembly.contacts, &Assembly::Direction::pressed)) return {};
  const double V = model.drive.speed.level(), N = model.drive.normal_load.level();
  const double friction = (V < 0 ? -N : N) * model.law->steady_friction({std::abs(V), N}).friction;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(assembly.n);
  for (const auto& contact : assembly.contacts) force += friction * contact.t;
  const Eigen::FullPivLU<Matrix> stiffness(assembly.stiffness(0, 0).real());
  if (!stiffness.isInvertible()) return {};
  const Eigen::VectorXd x = stiffness.solve(force);
  std::vector<double> loads;
  for (const auto& contact : assembly.contacts) loads.push_back(N + normal.stiffness * contact.normal.dot(x));
  return loads;
}

ClosedLoop close_loop(const Structure& structure, const Model& model, const std::optional<NormalContact>& normal) {
  const Assembly assembly(structure, model, normal);
  for (const auto& pole : assembly.response.poles())
    if (pole.value.real() > 0)
      throw InputError(
          "the contact is unstable by itself, at an imposed slip rate: its spring is softer than friction "
          "weakens");
  ClosedLoop result;
  bool decided = true;
  for (const auto& eigenvalue : eigenvalues(assembly)) {
    result.eigenvalues.push_back(eigenvalue.value);
    result.unstable_by_eigenvalues += eigenvalue.grows();
    decided = decided && eigenvalue.decided();
  }
  result.marginal = result.unstable_by_eigenvalues == 0 && !decided;
  result.stable = result.unstable_by_eigenvalues == 0 && decided;

  // det D(s)/∏(s + ω₀) has 2n zeros, and poles only to the left: it turns by −π less along the axis for each zero to
  // the right. Frequencies near which it may turn fast: those of the structure, free and clamped by its contacts.
  const double highest = std::sqrt(assembly.K.cwiseAbs().maxCoeff() / assembly.M.cwiseAbs().minCoeff() > 0 &&
                                           std::isfinite(assembly.K.cwiseAbs().maxCoeff())
                                       ? (assembly.M.partialPivLu().solve(assembly.K)).cwiseAbs().maxCoeff()
                                       : 1.0);
  const double reference = std::max(highest, 1e-30);
  const int n = assembly.n;
  const auto characteristic = [&](double omega) {
    const Complex s(0, omega);
    return (assembly.M.partialPivLu().solve(Matrix::Identity(n, n)).cast<Complex>() * assembly.stiffness(s))
               .determinant() /
           std::pow(s + reference, 2 * n);
  };
  std::vector<double> grid{0};
  double fastest = reference;
  for (const auto& pole : assembly.response.poles()) fastest = std::max(fastest, std::abs(pole.value));
  const double size = assembly.contacts.size() * std::abs(assembly.response.limits().high) /
                      std::max(1e-300, assembly.M.cwiseAbs().minCoeff());
  fastest = std::max(fastest, std::isfinite(size) && size < 1e12 * reference ? size : fastest);
  constexpr int points = 1500;
  const double from = 1e-6 * reference, to = 1e6 * fastest;
  for (int i = 0; i <= points; ++i) grid.push_back(from * std::pow(to / from, double(i) / points));
  for (const auto& z : result.eigenvalues)  // where to look, not what to find there
    for (const double shift : {0.5, 2.0, -2.0})
      if (const double omega = std::abs(z.imag()) + shift * std::abs(z.real()); omega > 0) grid.push_back(omega);
  std::ranges::sort(grid);
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  double angle = 0;
  bool resolved = true;
  Complex before = characteristic(grid.front());
  for (std::size_t i = 1; resolved && i < grid.size(); ++i) {
    const Complex now = characteristic(grid[i]);
    const auto part = turn(characteristic, grid[i - 1], before, grid[i], now, 45);
    resolved = part.has_value() && std::isfinite(*part);
    if (resolved) angle += *part;
    before = now;
  }
  // With all zeros to the left the ratio ends with the phase it began with.
  result.unstable_by_nyquist = resolved && !result.marginal ? int(std::lround(-angle / std::numbers::pi)) : -1;

  result.margin = result.margin_frequency = std::nan("");
  if (assembly.contacts.size() == 1) {
    result.margin = infinity;
    for (const double omega : grid) {
      if (omega == 0) continue;
      const Complex s(0, omega);
      const double distance = std::abs(assembly.distance(s, assembly.response.tangential(s)));
      if (distance < result.margin) result.margin = distance, result.margin_frequency = omega;
    }
  }
  return result;
}

Structure SlidingStructure::structure() const {
  if (const auto* modes = std::get_if<std::vector<Mode>>(&form)) return modal(*modes);
  if (const auto* matrices = std::get_if<Structure>(&form)) return *matrices;
  const auto& slider = model.slider;
  if (!(slider.mass > 0)) throw InputError("the slider needs a mass (oscillator.mass, kg) to be a structure");
  const auto number = [](double x) { return Matrix::Constant(1, 1, x); };
  Structure structure;
  structure.M = number(slider.mass), structure.C = number(slider.damping), structure.K = number(slider.stiffness);
  structure.contacts = {directions(Eigen::VectorXd::Ones(1))};
  return structure;
}

std::vector<SlidingStructure::Entry> SlidingStructure::entries() const {
  std::vector<Entry> list;
  const auto add = [&](const auto& field, std::string path, const auto& object, auto set) {
    list.push_back({{std::move(path), std::string(field.unit), field.range, std::string(field.meaning)},
                    object.*field.member,
                    set});
  };
  if (const auto* modes = std::get_if<std::vector<Mode>>(&form))
    for (std::size_t k = 0; k < modes->size(); ++k)
      for (const auto& f : mode_fields)
        add(f, fmt::format("structure.modes.{}.{}", k + 1, f.name), (*modes)[k],
            [k, member = f.member](SlidingStructure& changed, double value) {
              std::get<std::vector<Mode>>(changed.form)[k].*member = value;
            });
  if (std::holds_alternative<Structure>(form))
    for (const auto& [name, member] : {std::pair{"M", &Structure::M}, {"C", &Structure::C}, {"K", &Structure::K}})
      list.push_back({{fmt::format("structure.{}", name), "1", {1e-12, 1e12}, "factor on the matrix"},
                      1,
                      [member = member](SlidingStructure& changed, double factor) {
                        std::get<Structure>(changed.form).*member *= factor;
                      }});
  if (normal)
    for (const auto& f : normal_contact_fields)
      add(f, fmt::format("normal_contact.{}", f.name), *normal,
          [member = f.member](SlidingStructure& changed, double value) { (*changed.normal).*member = value; });
  return list;
}

std::optional<SlidingStructure::Entry> SlidingStructure::find(const std::string& path) const {
  std::vector<std::string> names;
  for (auto& entry : entries()) {
    if (entry.quantity.name == path) return std::move(entry);
    names.push_back(entry.quantity.name);
  }
  if (!path.starts_with("structure.") && !path.starts_with("normal_contact.")) return std::nullopt;
  const auto near = nearest_name(path, names);
  throw InputError(fmt::format("unknown parameter '{}'{}", path,
                               near.empty() ? names.empty() ? std::string("; the structure is the model's oscillator")
                                                            : fmt::format(" (known: {})", fmt::join(names, ", "))
                                            : fmt::format("; did you mean '{}'?", near)));
}

Quantity SlidingStructure::describe(const std::string& path) const {
  const auto entry = find(path);
  return entry ? entry->quantity : model.describe(path);
}

double SlidingStructure::get(const std::string& path) const {
  const auto entry = find(path);
  return entry ? entry->value : model.get(path);
}

SlidingStructure SlidingStructure::with(const std::string& path, double value) const {
  SlidingStructure changed = *this;
  const auto entry = find(path);
  if (!entry) {
    changed.model = model.with(path, value);
    return changed;
  }
  const auto& quantity = entry->quantity;
  require(value, quantity.range, path, quantity.meaning, quantity.unit);
  entry->set(changed, value);
  return changed;
}

namespace {

Eigenvalue leading(const SlidingStructure& sliding) {
  return eigenvalues(Assembly(sliding.structure(), sliding.model, sliding.normal)).front();
}

/// Relative error of critical values by the rounding of a law's slopes.
constexpr double slope_rounding = 1e-12;

}  // namespace

std::vector<CriticalValue> critical_values(const SlidingStructure& sliding, const std::string& parameter, double low,
                                           double high, int points) {
  std::vector<double> values;
  for (int i = 0; i <= points; ++i)
    values.push_back(i == points ? high : low * std::pow(high / low, double(i) / points));
  const auto at = [&](double value) {
    const auto first = leading(sliding.with(parameter, value));
    return steady::Leading{first.value.real(), 4 * first.real_error, std::abs(first.value.imag())};
  };
  std::vector<CriticalValue> found;
  for (const auto& crossing : steady::crossings(at, values))
    found.push_back(
        {crossing.value, crossing.angular_frequency, crossing.error + slope_rounding * std::abs(crossing.value)});
  return found;
}

Uncertainty propagate(const SlidingStructure& sliding, const std::vector<Uncertain>& inputs, int samples,
                      std::uint64_t seed) {
  return propagate(sliding, inputs, samples, seed, [](const SlidingStructure& changed, int) {
    const auto growth = leading(changed);
    return Drawn{growth.grows(), growth.value.real()};
  });
}

Uncertainty propagate(const SlidingStructure& sliding, const std::vector<Uncertain>& inputs, int samples,
                      std::uint64_t seed, const std::function<Drawn(const SlidingStructure&, int)>& judge) {
  Uncertainty result;
  std::vector<double> measure;
  std::vector<std::vector<double>> drawn(inputs.size());
  const auto random = white_noise(inputs.size() * std::size_t(samples), seed);
  for (int s = 0; s < samples; ++s) {
    auto changed = sliding;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const auto& path = inputs[i].parameter;
      const double g = random[std::size_t(s) * inputs.size() + i];
      drawn[i].push_back(g);
      changed = changed.with(path, inputs[i].drawn(sliding.get(path), g));
    }
    const auto judged = judge(changed, s);
    measure.push_back(judged.measure);
    result.unstable += judged.unstable;
  }
  result.samples = samples;
  result.probability = double(result.unstable) / samples;
  result.standard_error = error_of_share(result.probability, samples);
  const auto ranks = [](const std::vector<double>& x) {
    std::vector<std::size_t> order(x.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::sort(order, {}, [&](std::size_t i) { return x[i]; });
    std::vector<double> rank(x.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = double(i) - (double(x.size()) - 1) / 2;
    return rank;
  };
  const auto by_measure = ranks(measure);
  double spread = 0;
  for (const double r : by_measure) spread += r * r;
  for (const auto& list : drawn) {
    const auto rank = ranks(list);
    result.influence.push_back(std::inner_product(rank.begin(), rank.end(), by_measure.begin(), 0.0) / spread);
  }
  std::ranges::sort(measure);
  const auto quantile = [&](double q) { return measure[std::size_t(q * (double(samples) - 1))]; };
  result.low = quantile(0.05), result.median = quantile(0.5), result.high = quantile(0.95);
  return result;
}

std::vector<Complex> friction_loop(const Structure& structure, const Model& model,
                                   const std::optional<NormalContact>& normal, const std::vector<double>& frequency,
                                   const std::vector<Complex>& friction) {
  const Assembly assembly(structure, model, normal);
  std::vector<Complex> loop;
  for (std::size_t k = 0; k < frequency.size(); ++k) {
    const Complex s(0, 2 * std::numbers::pi * frequency[k]);
    loop.push_back(assembly.distance(s, friction.empty() ? assembly.response.tangential(s) : friction[k]) - 1.0);
  }
  return loop;
}

namespace {

/// Friction between the frequencies at which it was measured.
class MeasuredFriction {
 public:
  MeasuredFriction(const std::vector<double>& frequency, const std::vector<Complex>& value)
      : frequency_(frequency), value_(value), doubt_(value.size()) {
    // A straight line errs by a quarter of what one twice as long errs by.
    for (std::size_t k = 1; k + 1 < value.size(); ++k)
      doubt_[k] = std::abs(value[k] - between(k - 1, k + 1, frequency[k])) / 4;
    if (value.size() > 2) doubt_.front() = doubt_[1], doubt_.back() = doubt_[value.size() - 2];
  }

  Complex operator()(double f) const {
    const auto k = interval(f);
    return f == frequency_[k] ? value_[k] : between(k, k + 1, f);
  }
  double doubt(double f) const {
    const auto k = interval(f);
    return f == frequency_[k] ? 0 : f == frequency_[k + 1] ? 0 : std::max(doubt_[k], doubt_[k + 1]);
  }

 private:
  std::size_t interval(double f) const {
    const auto above = std::ranges::upper_bound(frequency_, f) - frequency_.begin();
    return std::size_t(std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(frequency_) - 2));
  }
  Complex between(std::size_t i, std::size_t j, double f) const {
    const double share = (f - frequency_[i]) / (frequency_[j] - frequency_[i]);
    return (1 - share) * value_[i] + share * value_[j];
  }

  const std::vector<double>& frequency_;
  const std::vector<Complex>& value_;
  std::vector<double> doubt_;
};

/// Frequencies (Hz) about the resonances of a structure without friction, ever closer to them.
std::vector<double> about_resonances(const Structure& structure, double low, double high) {
  constexpr double closest = 1e-6;
  std::vector<double> found;
  for (const Complex square : eigenpairs(solve_columns(structure.M, structure.K)).values) {
    const double resonance = std::abs(std::sqrt(square)) / (2 * std::numbers::pi);
    if (!(resonance > low / 2) || !(resonance < 2 * high)) continue;
    found.push_back(resonance);
    for (double apart = 0.3; apart > closest; apart /= 2)
      for (const double sign : {-1.0, 1.0}) found.push_back(resonance * (1 + sign * apart));
  }
  std::erase_if(found, [&](double f) { return !(f > low) || !(f < high); });
  return found;
}

}  // namespace

LoopPath measured_friction_loop(const Structure& structure, const Model& model,
                                const std::optional<NormalContact>& normal, const std::vector<double>& frequency,
                                const std::vector<Complex>& friction) {
  if (frequency.size() != friction.size() || frequency.size() < 3)
    throw InputError("friction must be given at three frequencies or more");
  constexpr double largest_turn = 0.4, closest = 1e-9;  // rad; relative
  constexpr double probe = 1e-6;                        // of Z, by which its doubt becomes one of the loop
  const Assembly assembly(structure, model, normal);
  const MeasuredFriction measured(frequency, friction);
  LoopPath path;
  const auto add = [&](double f) {
    const Complex s(0, 2 * std::numbers::pi * f), Z = measured(f), distance = assembly.distance(s, Z);
    const double doubt = measured.doubt(f), size = std::abs(Z);
    const double slope =
        doubt > 0 && size > 0 ? std::abs(assembly.distance(s, Z * (1 + probe)) - distance) / (probe * size) : 0;
    path.frequency.push_back(f), path.loop.push_back(distance - 1.0), path.doubt.push_back(slope * doubt);
  };
  auto wanted = about_resonances(structure, frequency.front(), frequency.back());
  wanted.insert(wanted.end(), frequency.begin(), frequency.end());
  std::ranges::sort(wanted);
  wanted.erase(std::ranges::unique(wanted).begin(), wanted.end());
  // Towards each of them from the one before, halving the way while 1 + L turns far on it.
  for (const double target : wanted) {
    std::vector<double> ahead{target};
    while (!ahead.empty()) {
      add(ahead.back());
      const auto n = path.loop.size();
      const bool near = n < 2 || ahead.back() - path.frequency[n - 2] < closest * ahead.back();
      if (!near && std::abs(std::arg((1.0 + path.loop[n - 1]) / (1.0 + path.loop[n - 2]))) > largest_turn) {
        ahead.push_back(0.5 * (path.frequency[n - 2] + path.frequency[n - 1]));
        path.frequency.pop_back(), path.loop.pop_back(), path.doubt.pop_back();
      } else {
        ahead.pop_back();
      }
    }
  }
  return path;
}

TableLoop close_table(const LoopPath& path) {
  const auto& [frequency, loop, doubt] = path;
  if (frequency.size() != loop.size() || frequency.size() < 3)
    throw InputError("friction or receptance must be given at three frequencies or more");
  TableLoop result;
  result.margin = infinity;
  double angle = 0;
  for (std::size_t k = 0; k < frequency.size(); ++k) {
    const double distance = std::abs(1.0 + loop[k]);
    if (distance < result.margin) result.margin = distance, result.margin_frequency = frequency[k];
    if (!doubt.empty() && doubt[k] >= distance) result.resolved = false;
    if (k == 0) continue;
    const double step = std::arg((1.0 + loop[k]) / (1.0 + loop[k - 1]));
    angle += step;
    if (std::abs(step) > std::numbers::pi / 2) result.resolved = false;
  }
  result.turns = angle / (2 * std::numbers::pi);
  result.unstable = std::max(0, int(std::lround(-angle / std::numbers::pi)));
  return result;
}

std::vector<CriticalValue> critical_values(const std::function<TableLoop(double)>& at, double low, double high,
                                           int points) {
  std::vector<CriticalValue> found;
  // Halves the interval between a value for which `is_first` holds and one for which it does not.
  const auto divide = [&](double& first, double& second, const auto& is_first) {
    constexpr int halvings = 40;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (first + second);
      (is_first(at(middle)) ? first : second) = middle;
    }
  };
  const auto resolved = [](const TableLoop& loop) { return loop.resolved; };
  double before = low;
  TableLoop before_loop = at(low);
  for (int i = 1; i <= points; ++i) {
    const double now = i == points ? high : low * std::pow(high / low, double(i) / points);
    const TableLoop loop = at(now);
    if (loop.unstable != before_loop.unstable) {
      double first = before, second = now;
      divide(first, second, [&](const TableLoop& there) { return there.unstable == before_loop.unstable; });
      // Next to the crossing the loop passes −1 between two frequencies: there the count is not to be relied on.
      double left = before, right = now, inner = first, outer = second;
      if (before_loop.resolved) divide(left, inner, resolved);
      if (loop.resolved) divide(right, outer, resolved);
      found.push_back({second, 2 * std::numbers::pi * at(second).margin_frequency,
                       std::max({second - left, right - second, second - first})});
    }
    before = now, before_loop = loop;
  }
  return found;
}

}  // namespace rosin::analysis::response
