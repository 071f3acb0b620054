/// A structure drawn at random, as a scene that a user could have written and as numbers for equations of one's own.
#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace rosin::tests {

/// mean + amplitude · cos(rate · t + phase), or a mean that jumps once.
struct DrawnSignal {
  double mean = 0, amplitude = 0, rate = 0, phase = 0;
  double jump = 0, at = std::numeric_limits<double>::infinity();  ///< by how much and when, s

  bool constant() const { return amplitude == 0 && jump == 0; }
  double value(double t) const {
    return mean + (t >= at ? jump : 0) + (amplitude == 0 ? 0 : amplitude * std::cos(rate * t + phase));
  }
  double slope(double t) const { return amplitude == 0 ? 0 : -amplitude * rate * std::sin(rate * t + phase); }
  std::string text() const {
    if (jump != 0) return fmt::format("{{ steps = [[0, {}], [{}, {}]] }}", mean, at, mean + jump);
    if (amplitude == 0) return fmt::format("{}", mean);
    return fmt::format("{{ mean = {}, harmonics = [{{ amplitude = {}, angular_frequency = {}, phase = {} }}] }}", mean,
                       amplitude, rate, phase);
  }
};

struct DrawnContact {
  std::string law;
  std::vector<std::pair<std::string, double>> parameters;
  Eigen::VectorXd direction;
  DrawnSignal speed, load;
  std::optional<double> state;  ///< at the start; else that of steady sliding at the contact's slip rate

  double operator[](std::string_view name) const {
    for (const auto& [key, value] : parameters)
      if (key == name) return value;
    return std::numeric_limits<double>::quiet_NaN();
  }
  bool set_valued() const { return law == "coulomb" || law == "stribeck"; }
  const char* state_name() const {
    return set_valued() ? "" : law == "lugre" ? "z" : law == "spinodal" ? "psi" : "theta";
  }
};

struct DrawnStructure {
  Eigen::MatrixXd M, C, K;
  std::vector<DrawnSignal> force;
  std::vector<DrawnContact> contacts;
  Eigen::VectorXd coordinates, velocities;  ///< at the start
  double duration = 20;
  std::vector<double> times;  ///< of samples

  bool constant() const {
    for (const auto& one : force)
      if (!one.constant()) return false;
    for (const auto& contact : contacts)
      if (!contact.speed.constant() || !contact.load.constant()) return false;
    return true;
  }
  std::string scene() const;
};

inline std::string DrawnStructure::scene() const {
  const auto list = [](const auto& row) {
    return fmt::format("[{}]", fmt::join(std::vector<double>(row.begin(), row.end()), ", "));
  };
  const auto matrix = [&](const Eigen::MatrixXd& A) {
    std::vector<std::string> rows;
    for (Eigen::Index i = 0; i < A.rows(); ++i) rows.push_back(list(A.row(i)));
    return fmt::format("[{}]", fmt::join(rows, ", "));
  };
  const auto law = [](const DrawnContact& contact) {
    std::string text = fmt::format("{{ type = \"{}\"", contact.law);
    for (const auto& [key, value] : contact.parameters) text += fmt::format(", {} = {}", key, value);
    return text + " }";
  };
  std::vector<std::string> forces;
  for (const auto& one : force) forces.push_back(one.text());
  std::string text = fmt::format(
      "law = {}\n[drive]\nspeed = {}\nnormal_load = {}\n[oscillator]\ntype = \"structure\"\nM = {}\nC = {}\nK = {}\n"
      "force = [{}]\n",
      law(contacts[0]), contacts[0].speed.text(), contacts[0].load.text(), matrix(M), matrix(C), matrix(K),
      fmt::join(forces, ", "));
  for (const auto& contact : contacts)
    text += fmt::format("[[oscillator.contacts]]\ntangential = {}\nlaw = {}\nspeed = {}\nnormal_load = {}\n",
                        list(contact.direction), law(contact), contact.speed.text(), contact.load.text());
  std::string start = fmt::format("coordinates = {}, velocities = {}", list(coordinates), list(velocities));
  for (std::size_t j = 0; j < contacts.size(); ++j)
    if (contacts[j].state)
      start += fmt::format(", {}{} = {}", contacts[j].state_name(),
                           contacts.size() > 1 ? fmt::format("_{}", j + 1) : "", *contacts[j].state);
  return text + fmt::format("[run]\nduration = {}\ntimes = {}\nstart = {{ {} }}\n", duration, list(times), start);
}

/// One to five coordinates, one to three contacts, each with a law of its own; drives that are constant or vary.
inline DrawnStructure draw_structure(unsigned seed) {
  std::mt19937_64 random(seed);
  // The library's distributions differ from one standard library to the next.
  const auto real = [&](double low, double high) { return low + (high - low) * double(random() >> 11) * 0x1p-53; };
  const auto log = [&](double low, double high) { return std::exp(real(std::log(low), std::log(high))); };
  const auto whole = [&](int low, int high) { return low + int(random() % unsigned(high - low + 1)); };
  const auto chance = [&](double part) { return real(0, 1) < part; };

  DrawnStructure drawn;
  const int n = whole(1, 5), contacts = whole(1, std::min(n, 3));
  const auto positive = [&](double size, double spread) {
    Eigen::MatrixXd A(n, n);
    for (double& entry : A.reshaped()) entry = real(-spread, spread);
    return Eigen::MatrixXd(size * (Eigen::MatrixXd::Identity(n, n) + A * A.transpose()));
  };
  const bool shared = chance(0.5);  // masses
  drawn.M = positive(real(0.5, 2), shared ? 0.5 : 0), drawn.K = positive(real(0.5, 4), 0.6);
  drawn.C = positive(chance(0.2) ? 0 : log(0.003, 0.3), 0.5);
  const bool varies = chance(0.6);
  const auto swing = [&](double mean, double largest) {
    DrawnSignal signal;
    signal.mean = mean;
    if (!varies || chance(0.4)) return signal;
    if (mean != 0 && chance(0.25)) {
      signal.at = real(2, 15), signal.jump = real(-largest, largest);
      return signal;
    }
    signal.amplitude = real(0.05, 1) * largest, signal.rate = real(0.2, 3), signal.phase = real(0, 6);
    return signal;
  };
  for (int i = 0; i < n; ++i) {
    drawn.force.push_back(swing(chance(0.5) ? 0 : real(-0.3, 0.3), 0.8));
  }
  drawn.coordinates.resize(n), drawn.velocities.resize(n);
  for (int i = 0; i < n; ++i) drawn.coordinates[i] = real(-1, 1), drawn.velocities[i] = real(-0.5, 0.5);
  for (int j = 0; j < contacts; ++j) {
    DrawnContact contact;
    contact.direction = Eigen::VectorXd::Unit(n, j);
    if (shared)
      for (double& entry : contact.direction) entry += real(-0.5, 0.5);
    const char* laws[] = {"coulomb", "coulomb", "stribeck", "lugre", "ageing", "slip", "spinodal"};
    const int law = whole(0, 6);
    contact.law = laws[law];
    const double mu_d = real(0.1, 0.5);
    if (contact.law == "coulomb") {
      contact.parameters = {{"mu_s", law == 0 ? mu_d : mu_d * real(1.05, 2)}, {"mu_d", mu_d}};
    } else if (contact.law == "stribeck") {
      contact.parameters = {{"mu_s", mu_d * real(1.1, 2)},
                            {"mu_d", mu_d},
                            {"v_s", log(0.03, 0.5)},
                            {"exponent", double(whole(1, 2))},
                            {"viscous", chance(0.5) ? 0 : real(0, 0.1)}};
    } else if (contact.law == "lugre") {
      const double sigma0 = log(20, 1000);
      contact.parameters = {{"sigma0", sigma0},       {"sigma1", real(0.1, 2) * std::sqrt(sigma0)},
                            {"sigma2", real(0, 0.1)}, {"mu_s", mu_d * real(1, 2)},
                            {"mu_d", mu_d},           {"v_s", log(0.03, 0.5)}};
    } else {
      contact.parameters = {{"mu0", real(0.3, 0.8)}, {"a", log(0.008, 0.03)}};
      contact.parameters.emplace_back("b", contact["a"] * real(0.3, 2));
      contact.parameters.emplace_back("L", log(0.02, 0.3));
      contact.parameters.emplace_back("v0", log(0.01, 0.3));
      if (contact.law == "spinodal") {
        contact.parameters.emplace_back("c", log(1e-3, 0.1));
        contact.parameters.emplace_back("t_heal", log(1, 30));
      }
      if (chance(0.3)) contact.state = contact.law == "spinodal" ? real(0.1, 0.9) : log(0.1, 5);
    }
    const double load = real(0.5, 2.5);
    contact.load = swing(load, 0.7 * load);
    const double speed = (chance(0.5) ? 1 : -1) * real(0.05, 0.5);
    contact.speed = chance(contact.set_valued() ? 0.25 : 0.1) ? swing(0, 0.4) : swing(speed, 0.6 * speed);
    drawn.contacts.push_back(std::move(contact));
  }
  if (chance(0.1)) drawn.velocities.setZero();
  for (int i = 1; i <= 20; ++i) drawn.times.push_back(drawn.duration * i / 20);
  return drawn;
}

/// The same, whose drive is constant or has one period.
inline DrawnStructure draw_periodic_structure(unsigned seed) {
  auto drawn = draw_structure(seed);
  const double rate = 0.3 + 2.2 * double((seed * 2654435761u) >> 8) * 0x1p-24;
  const auto tune = [&](DrawnSignal& signal) {
    signal.jump = 0, signal.at = std::numeric_limits<double>::infinity();
    if (signal.amplitude != 0) signal.rate = rate;
  };
  for (auto& force : drawn.force) tune(force);
  for (auto& contact : drawn.contacts) tune(contact.speed), tune(contact.load);
  return drawn;
}

}  // namespace rosin::tests
