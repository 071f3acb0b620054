/// Loops over samples with scalars alone, as one writes them for one law.
#include "bench/string_rivals.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bench {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double frequency = 146.8, impedance = 0.55, beta = 0.0899, torsional = 1.8, ratio = 5.2;
constexpr double mu_inf = 0.35, mu_1 = 0.4, v_1 = 0.01, mu_2 = 0.45, v_2 = 0.1;

double friction_curve(double s) { return mu_inf + mu_1 * std::exp(-s / v_1) + mu_2 * std::exp(-s / v_2); }

struct End {
  std::vector<double> past;
  std::size_t mask = 0, at = 0;
  double weight[4], keep, gain, first = 0, second = 0;
  int base;
  End(double samples, double rounding, double step, double gain_) : keep(std::exp(-step / rounding)), gain(gain_) {
    const double delay = samples - 2 * keep / (1 - keep);
    base = int(delay) - 1;
    const double x = delay - base;
    for (int j = 0; j < 4; ++j) {
      weight[j] = 1;
      for (int i = 0; i < 4; ++i)
        if (i != j) weight[j] *= (x - i) / (j - i);
    }
    std::size_t size = 1;
    while (size < std::size_t(base) + 6) size *= 2;
    past.assign(size, 0.0);
    mask = size - 1;
  }
  double in() {
    const std::size_t n = at - std::size_t(base);
    const double x = weight[0] * past[n & mask] + weight[1] * past[(n - 1) & mask] + weight[2] * past[(n - 2) & mask] +
                     weight[3] * past[(n - 3) & mask];
    first += (1 - keep) * (x - first);
    second += (1 - keep) * (first - second);
    return -gain * second;
  }
  void out(double x) { past[at++ & mask] = x; }
};

/// bow(D, Z) answers with the force; slips() tells whether it slips.
template <class Bow>
StringMotion follow(const StringProblem& problem, Bow& bow) {
  const double step = 1 / problem.sample_rate, period = problem.sample_rate / frequency;
  End bridge(beta * period, 40e-6, step, 1), nut((1 - beta) * period, 40e-6, step, std::exp(-pi / 150)),
      bridge_torsion(beta * period / ratio, 10e-6, step, 1),
      nut_torsion((1 - beta) * period / ratio, 10e-6, step, std::exp(-pi / 34));
  const double Z = 1 / (1 / (2 * impedance) + 1 / (2 * torsional));
  StringMotion motion;
  long end = long(10 * problem.sample_rate), n = 0;
  int onsets = 0;
  bool slipped = false;
  for (; n < end; ++n) {
    const double a = bridge.in(), b = nut.in(), c = bridge_torsion.in(), d = nut_torsion.in();
    const double f = bow(problem.acceleration * double(n) * step - (a + b + c + d), Z);
    const double push = f / (2 * impedance), turn = f / (2 * torsional);
    bridge.out(b + push), nut.out(a + push), bridge_torsion.out(d + turn), nut_torsion.out(c + turn);
    const bool slips = bow.slips();
    if (slips && !slipped) {
      if (++onsets == 1) motion.first_slip = double(n) * step, end = n + std::lround(31 * period);
      if (onsets == 4) motion.fourth_slip = double(n) * step;
    }
    slipped = slips;
  }
  motion.samples = n;
  return motion;
}

struct CurveBow {
  double load, lowest = 0, side = 0;  ///< lowest speed D of slip
  bool slips() const { return side != 0; }
  CurveBow(double N, double Z) : load(N) {
    double low = 0, high = 10;  // where friction falls as steeply as the string answers
    for (int i = 0; i < 200; ++i) {
      const double s = 0.5 * (low + high);
      (N * (mu_1 / v_1 * std::exp(-s / v_1) + mu_2 / v_2 * std::exp(-s / v_2)) > Z ? low : high) = s;
    }
    lowest = low + N * friction_curve(low) / Z;
  }
  double operator()(double D, double Z) {
    const double A = std::abs(D), way = D < 0 ? -1 : 1;
    const bool stays = side == way ? A < lowest : Z * A <= load * friction_curve(0);
    if (stays) {
      side = 0;
      return Z * D;
    }
    side = way;
    double s = A;
    for (int i = 0; i < 50; ++i) {
      const double first = mu_1 * std::exp(-s / v_1), second = mu_2 * std::exp(-s / v_2);
      const double left = Z * (A - s) - load * (mu_inf + first + second);
      const double change = left / (Z - load * (first / v_1 + second / v_2));
      s += change;
      if (std::abs(change) < 1e-13 * (1 + s)) break;
    }
    return way * Z * (A - s);
  }
};

struct WarmBow {
  static constexpr double h0 = 1e-3, h1 = 8e-3, hottest = mu_inf / h1;
  static constexpr int parts = 5, points = 8192;
  double load, fade[parts], answer[parts], rise[parts] = {}, all = 0, heating = 0, speed = 0, side = 0;
  const std::vector<double>& table;
  bool slips() const { return side != 0; }
  WarmBow(double N, double step) : load(N), table(frictions()) {
    const double time[] = {2e-5, 1e-4, 4.64e-4, 2.155e-3, 1.5e-2}, share[] = {0.1156, 0.2667, 0.3234, 0.1465, 0.1478};
    for (int k = 0; k < parts; ++k) {
      fade[k] = std::exp(-step / time[k]);
      answer[k] = (1 - fade[k]) * share[k] / h0;
      all += answer[k];
    }
  }
  /// Of evenly spaced temperatures, made once.
  static const std::vector<double>& frictions() {
    static const std::vector<double> list = [] {
      std::vector<double> of(points + 2);
      for (int i = 0; i <= points; ++i) {
        double low = 0, high = 1e6;
        for (int j = 0; j < 100; ++j) {
          const double w = 0.5 * (low + high);
          (friction_curve(w) * w / (h0 + h1 * w) < hottest * i / points ? low : high) = w;
        }
        of[std::size_t(i)] = friction_curve(low);
      }
      of[points + 1] = of[points];
      return of;
    }();
    return list;
  }
  double friction(double T) const {
    const double at = std::min(std::max(T / hottest, 0.0), 1.0) * points;
    const int i = int(at);
    return table[i] + (at - i) * (table[i + 1] - table[i]);
  }
  double operator()(double D, double Z) {
    const double A = std::abs(D), way = D < 0 ? -1 : 1;
    double left = 0, before = 0, s = 0, mu = 0, mean = heating, drag = speed, stays = 0;
    for (int k = 0; k < parts; ++k) left += fade[k] * rise[k], before += rise[k];
    for (int pass = 0; pass < 3; ++pass) {
      const double swept = 0.5 * h1 * drag, in = mean - swept * before;
      const double T = (left + all * in) / (1 + all * swept);
      stays = in - swept * T;
      mu = friction(T);
      s = std::max(0.0, A - load * mu / Z);
      mean = 0.5 * (heating + mu * s), drag = 0.5 * (speed + s);
    }
    for (int k = 0; k < parts; ++k) rise[k] = fade[k] * rise[k] + answer[k] * stays;
    heating = mu * s, speed = s, side = s > 0 ? way : 0;
    return Z * (D - way * s);
  }
};

}  // namespace

StringMotion bow_by_hand_curve(const StringProblem& problem) {
  CurveBow bow(problem.load, 1 / (1 / (2 * impedance) + 1 / (2 * torsional)));
  return follow(problem, bow);
}
StringMotion bow_by_hand_temperature(const StringProblem& problem) {
  WarmBow bow(problem.load, 1 / problem.sample_rate);
  return follow(problem, bow);
}

}  // namespace bench
