/// Waves on a string and friction under its bow, against what is known in closed form.
#include "oscillators/bowed_string.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <map>

#include "core/error.hpp"
#include "laws/catalogue.hpp"

namespace {

using namespace rosin;
using namespace rosin::oscillators;

/// A string without losses, torsion or rounding, of whole delays: a period of `period` samples, `to_bridge` of them to
/// the bridge and back.
BowedStringModel raman(int period, int to_bridge, double rate = 1e5) {
  BowedStringModel model;
  auto& string = model.string;
  string.sample_rate = rate;
  string.frequency = rate / period;
  string.bow_position = double(to_bridge) / period;
  string.quality = BowedString::none;
  string.corner_rounding = 0;
  string.torsion.reset();
  string.delays = DelayLine::integer;
  model.law = laws::find_law("two-exponential");
  model.load.signal = Signal(1);
  return model;
}
std::shared_ptr<const FrictionLaw> coulomb(double at_rest, double sliding) {
  return laws::find_law("coulomb")->with("mu_s", at_rest)->with("mu_d", sliding);
}
StringLanes begun(const BowedStringModel& model) {
  StringLanes strings(model.string, model.law, model.lambda);
  strings.begin(0, model);
  return strings;
}

TEST_CASE("an impulse at the bow comes back as a comb", "[string]") {
  auto model = raman(50, 5);
  model.law = coulomb(1, 1);
  model.speed.signal = Signal(10);
  model.load.signal = Signal(Signal::Steps{{{0, 1}, {0.5 / model.string.sample_rate, 0}}});  // N, in the first sample
  auto strings = begun(model);
  // 2Z₀v at samples 5, 45, 50, …: reflections with the other sign from one end, with the same from both.
  const std::map<int, double> comb = {{0, 1},   {5, -1},  {45, -1},  {50, 2},   {55, -1},
                                      {95, -1}, {100, 2}, {105, -1}, {145, -1}, {150, 2}};
  for (int n = 0; n <= 150; ++n) {
    strings.step();
    const auto spike = comb.find(n);
    CHECK(strings.velocity(0)[0] * 2 * model.string.impedance ==
          Approx(spike == comb.end() ? 0 : spike->second).margin(1e-12));
  }
}

TEST_CASE("work of the bow becomes heat and motion of the string", "[string]") {
  auto model = raman(500, 50);
  model.speed.signal = Signal(Signal::Ramp{0, 1.5});
  auto strings = begun(model);
  double of_bow = 0, heat = 0, to_string = 0;
  for (int n = 0; n < 60 * 500; ++n) {
    strings.step();
    const double f = strings.friction(0)[0] * model.string.step();
    of_bow += f * strings.bow_speed()[0];
    heat += f * strings.bow(0).slip_rate()[0];
    to_string += f * strings.velocity(0)[0];
  }
  CHECK(of_bow == Approx(2.414249082044e-02).epsilon(1e-11));
  CHECK(heat == Approx(2.354194006170e-02).epsilon(1e-11));
  CHECK(to_string == Approx(6.005507587412e-04).epsilon(1e-11));
}

TEST_CASE("Helmholtz motion lasts for ever on a string without losses", "[string]") {
  auto model = raman(400, 40);
  model.speed.signal = Signal(0.1);
  model.load.signal = Signal(0.5);
  model.start = StringStart::helmholtz;
  auto strings = begun(model);
  std::vector<int> on, off;
  bool slips = false;
  for (int n = 0; n < 50 * 400; ++n) {
    strings.step();
    const bool now = strings.bow(0).direction()[0] != 0;
    if (now) CHECK(strings.velocity(0)[0] == Approx(-0.1 * (1 - 0.1) / 0.1).epsilon(1e-12));
    if (now != slips) (now ? on : off).push_back(n);
    slips = now;
  }
  REQUIRE(on.size() == 50);
  for (std::size_t k = 0; k < off.size(); ++k) {
    CHECK(off[k] - on[k] == 40);
    if (k > 0) CHECK(on[k] - on[k - 1] == 400);
  }
}

TEST_CASE("a bow that speeds up slowly slips at the sample that the string's stiffness says", "[string]") {
  const auto [acceleration, load, sample] = GENERATE(std::tuple{1.0, 1.0, 3480}, std::tuple{2.5, 0.4, 1390});
  auto model = raman(680, 61);
  model.speed.signal = Signal(Signal::Ramp{0, acceleration});
  model.load.signal = Signal(load);
  auto strings = begun(model);
  int n = 0;
  for (strings.step(); strings.bow(0).direction()[0] == 0 && n < 10'000; ++n) strings.step();
  CHECK(n == sample);
}

TEST_CASE("a contact lets go at its limit and is caught where no slip is left", "[string]") {
  struct Known {
    double load, release, capture, slip_after, slip_before;
  };
  const auto known = GENERATE(Known{0.1, 0.109090909091, 0.0899741394625, 0.0530160851674, 0.0171360060223},
                              Known{0.5, 0.545454545455, 0.330785848532, 0.381872690604, 0.0728206432931},
                              Known{1, 1.09090909091, 0.559058816834, 0.772546683345, 0.14087982526},
                              Known{2, 2.18181818182, 0.946555076658, 1.54545438659, 0.210191880252});
  const auto law = laws::find_law("two-exponential");
  BowContacts contact(law, 1, 1e-5);
  contact.rest(0, law, known.load);
  Lanes f;
  const Lanes Z = 2 * 0.55;
  const auto at = [&](double D) {
    contact.step(Lanes(D), Z, f);
    return contact.slip_rate()[0];
  };
  CHECK(at(known.release * (1 - 1e-9)) == 0);
  CHECK(at(known.release * (1 + 1e-9)) == Approx(known.slip_after).epsilon(1e-8));
  at(0.5 * (known.release + known.capture));
  CHECK(at(known.capture * (1 + 1e-11)) == Approx(known.slip_before).epsilon(1e-4));  // a root beside a double one
  CHECK(at(known.capture * (1 - 1e-10)) == 0);
  CHECK(f[0] == Approx(1.1 * known.capture));
}

TEST_CASE("a contact that warms slides steadily as its law does", "[string][laws]") {
  struct Known {
    const char* law;
    double speed, load, area_exponent, rise, friction;
  };
  const auto known = GENERATE(
      Known{"thermal", 0.1, 1, 1, 28.6424393, 0.515563908}, Known{"thermal", 0.01, 1, 1, 8.3734131, 0.904328615},
      Known{"thermal", 0.1, 2.5, 1, 28.6424393, 0.515563908}, Known{"thermal", 0.1, 2.5, 0, 48.6111111, 0.35},
      Known{"thermal-layer", 0.1, 1, 1, 28.6424393, 0.515563908},
      Known{"thermal-disc", 0.1, 1, 1, 28.6424393, 0.515563908});
  const auto law = laws::find_law(known.law)->with("area_exponent", known.area_exponent);
  BowContacts contact(law, 1, 1e-4);
  contact.slide(0, law, known.load, 1.3 * known.speed);
  const double Z = 200;  // steeper than friction falls: one motion alone
  Lanes f;
  // D at which that slip rate is the answer, held until even the slowest heat has come.
  const double D = known.speed + known.friction * known.load / Z;
  for (int n = 0; n < 60'000; ++n) contact.step(Lanes(D), Lanes(Z), f);
  CHECK(contact.states(0)[0] == Approx(known.rise).epsilon(1e-5));
  CHECK(f[0] == Approx(known.friction * known.load).epsilon(1e-6));
}

TEST_CASE("any law of the catalogue slides under a bow as it does steadily", "[string][laws]") {
  const double Z = 1.1, v = 0.2, N = 0.3;
  for (const auto& law : laws::catalogue()) {
    CAPTURE(law->card().name);
    if (law->states().size() > 5) continue;  // conduction is tested above
    BowContacts contact(law, 1, 1e-5);
    contact.slide(0, law, N, v);
    const double friction = N * law->steady_friction({v, N}).friction;
    Lanes f;
    for (int n = 0; n < 1000; ++n) contact.step(Lanes(v + friction / Z), Lanes(Z), f);
    CHECK(contact.slip_rate()[0] == Approx(v).epsilon(1e-6));
    CHECK(f[0] == Approx(friction).epsilon(1e-6).margin(1e-9));
    CHECK(contact.unsolved()[0] == 0);
  }
}

TEST_CASE("what is no number under the bow stays one lane's and ends nothing", "[string]") {
  const auto name = GENERATE("two-exponential", "thermal-layer", "ageing", "lugre");
  const auto law = laws::find_law(name);
  BowContacts contact(law, 1, 1e-5), alone(law, 1, 1e-5);
  for (auto* each : {&contact, &alone}) each->rest(0, law, 1), each->rest(1, law, 1);
  Lanes f, other, D = 0.3, broken = 0.3;
  broken.set(1, NAN);
  for (int n = 0; n < 5; ++n) {
    contact.step(broken, Lanes(1.1), f);
    alone.step(D, Lanes(1.1), other);
  }
  CHECK(f[0] == other[0]);
  CHECK(std::isnan(f[1]));
}

TEST_CASE("friction with states is of second order in the step", "[string][laws]") {
  const auto name = GENERATE("ageing", "lugre", "thermal-layer", "slip-weakening");
  CAPTURE(name);
  const auto law = laws::find_law(name);
  // A slip rate that swings about 0.1 m/s, by a drive that is smooth.
  const auto ends_at = [&](int steps) {
    constexpr double duration = 4e-3;
    BowContacts contact(law, 1, duration / steps);
    contact.slide(0, law, 1, 0.1);
    const double friction = law->steady_friction({0.1, 1}).friction;
    Lanes f;
    for (int n = 1; n <= steps; ++n) {
      const double t = duration * n / steps;
      contact.step(Lanes(0.1 + friction / 1.1 + 0.02 * (1 - std::cos(3000 * t))), Lanes(1.1), f);
    }
    return f[0];
  };
  const double coarse = ends_at(1600), middle = ends_at(3200), fine = ends_at(6400);
  CAPTURE(coarse, middle, fine);
  if (std::abs(coarse - fine) > 1e-12) CHECK((coarse - middle) / (middle - fine) == Approx(4).margin(0.7));
}

TEST_CASE("stiffness raises the partials of a string", "[string]") {
  auto model = raman(1309, 118, 192e3);
  model.string.delays = DelayLine::lagrange;
  model.string.inharmonicity = 5.6e-5;
  model.law = coulomb(1, 1);
  model.speed.signal = Signal(10);
  model.load.signal = Signal(Signal::Steps{{{0, 1}, {0.5 / model.string.sample_rate, 0}}});
  StringLanes strings(model.string, model.law, 1);
  strings.begin(0, model);
  const int samples = 120'000;
  std::vector<double> v(samples);
  for (auto& x : v) strings.step(), x = strings.velocity(0)[0];
  // The frequency at which the comb rings loudest, near each partial, under a window that hides the others.
  const double f0 = model.string.frequency, step = model.string.step();
  const auto loudness = [&](double frequency) {
    std::complex<double> sum = 0;
    const auto turn = std::polar(1.0, -2 * M_PI * frequency * step);
    std::complex<double> phase = 1;
    for (int n = 0; n < samples; ++n, phase *= turn)
      sum += v[n] * phase * (0.5 - 0.5 * std::cos(2 * M_PI * n / samples));
    return std::abs(sum);
  };
  for (const int n : {1, 10, 20}) {
    const double wanted = n * f0 * std::sqrt(1 + model.string.inharmonicity * n * n);
    double low = wanted - 1, high = wanted + 1;
    for (int i = 0; i < 16; ++i) {
      const double a = low + 0.4 * (high - low), b = low + 0.6 * (high - low);
      (loudness(a) < loudness(b) ? low : high) = loudness(a) < loudness(b) ? a : b;
    }
    CAPTURE(n, wanted);
    CHECK(0.5 * (low + high) == Approx(wanted).epsilon(2e-4));  // 0.3 cents
  }
}

TEST_CASE("a body that is heavy is a rigid bridge, and one that is light takes energy", "[string]") {
  auto model = raman(400, 40);
  model.speed.signal = Signal(0.1);
  model.load.signal = Signal(0.5);
  model.start = StringStart::helmholtz;
  model.string.body = {{250, 1e6, 30}};
  auto strings = begun(model);
  auto rigid = model;
  rigid.string.body.clear();
  auto other = begun(rigid);
  double largest = 0;
  for (int n = 0; n < 4000; ++n) {
    strings.step(), other.step();
    largest = std::max(largest, std::abs(strings.velocity(0)[0] - other.velocity(0)[0]));
  }
  CHECK(largest < 1e-4);
  model.string.body = {{250, 0.05, 30}};
  auto damped = begun(model);
  double work = 0;
  for (int n = 0; n < 4000; ++n) {
    damped.step();
    work += damped.friction(0)[0] * damped.velocity(0)[0] * model.string.step();
  }
  CHECK(work > 1e-6);
}

TEST_CASE("what a bow of hair does approaches a rigid one", "[string]") {
  auto model = raman(400, 40);
  model.string.torsion = BowedString::Torsion{};
  model.string.corner_rounding = 40e-6;
  model.string.delays = DelayLine::linear;
  model.string.quality = 150;
  model.speed.signal = Signal(Signal::Ramp{0, 1});
  const auto rigid = [&] {
    auto strings = begun(model);
    for (int n = 0; n < 2000; ++n) strings.step();
    return strings.friction(0)[0];
  }();
  const auto on_hair = [&](double stiffness) {
    auto soft = model;
    soft.string.bow.hair_stiffness = stiffness;
    auto strings = begun(soft);
    for (int n = 0; n < 2000; ++n) strings.step();
    return strings.friction(0)[0];
  };
  // Before the first slip the hair stretches in series with the string: forces fall by the ratio of both stiffnesses.
  const double of_string = 2 * model.string.impedance * model.string.frequency / (0.1 * 0.9);
  CHECK(on_hair(1e9) == Approx(rigid).epsilon(1e-4));
  CHECK(on_hair(of_string) == Approx(0.5 * rigid).epsilon(0.05));
}

/// −gain δ(t − at), as a triangle that is narrow for any sample rate.
BowedString::Reflection ideal_end(double at, double gain, double bow_position) {
  constexpr double half = 1e-12;
  return {{at - half, at, at + half}, {0, -gain / half, 0}, bow_position};
}

TEST_CASE("Helmholtz motion lasts between ideal ends from tables, as between those of numbers", "[string]") {
  auto model = raman(400, 40);
  const double step = model.string.step();
  model.string.bridge = ideal_end(40 * step, 1, 0.1);
  model.string.nut = ideal_end(360 * step, 1, 0.1);
  model.speed.signal = Signal(0.1);
  model.load.signal = Signal(0.5);
  model.start = StringStart::helmholtz;
  auto strings = begun(model);
  CHECK(strings.realised_frequency() == Approx(model.string.frequency));
  CHECK(strings.realised_bow_position() == Approx(0.1));
  std::vector<int> on, off;
  bool slips = false;
  for (int n = 0; n < 20 * 400; ++n) {
    strings.step();
    const bool now = strings.bow(0).direction()[0] != 0;
    if (now) CHECK(strings.velocity(0)[0] == Approx(-0.9).epsilon(1e-4));
    if (now != slips) (now ? on : off).push_back(n);
    slips = now;
  }
  REQUIRE(on.size() == 20);
  for (std::size_t k = 0; k < off.size(); ++k) CHECK(off[k] - on[k] == 40);
  // From another place of the bow the way is another one.
  model.string.bow_position = 0.2;
  CHECK(begun(model).realised_bow_position() == Approx(0.2));
}

TEST_CASE("ends from tables answer as those that the tables were made of, better by four at half the spacing",
          "[string]") {
  auto model = raman(1000, 90, 2e6);
  const double tau = 20e-6, gain = 0.95, period = model.string.period(), Z = model.string.impedance;
  const std::complex<double> s{0, 2 * M_PI * 3333};
  const auto end = [&](double way, double g) {
    return -g * std::exp(-s * (way - 2 * tau)) / std::pow(1.0 + s * tau, 2);
  };
  const auto left = end(0.09 * period, 1), right = end(0.91 * period, gain);
  const auto exact = 0.5 / Z * (1.0 + left) * (1.0 + right) / (1.0 - left * right);
  double before = 0;
  for (const double spacing : {16e-6, 8e-6, 4e-6}) {
    const auto table = [&](double way, double g) {
      BowedString::Reflection reflection{{}, {}, 0.09};
      for (double t = way - 2 * tau; t < way + 30 * tau; t += spacing) {
        const double x = t - way + 2 * tau;
        reflection.time.push_back(t), reflection.value.push_back(-g * x / (tau * tau) * std::exp(-x / tau));
      }
      return reflection;
    };
    model.string.bridge = table(0.09 * period, 0.999), model.string.nut = table(0.91 * period, gain);
    for (double& h : model.string.bridge->value) h /= 0.999 * (1 + 1e-9);
    // The trapezoidal rule of a table has not quite the integral of its function.
    const auto whole = [&](BowedString::Reflection& of, double integral) {
      double sum = 0;
      for (std::size_t i = 1; i < of.time.size(); ++i) sum -= 0.5 * spacing * (of.value[i] + of.value[i - 1]);
      for (double& h : of.value) h *= integral / sum;
    };
    whole(*model.string.bridge, 1), whole(*model.string.nut, gain);
    const double error = std::abs(begun(model).mobility(s).velocity(0, 0) / exact - 1.0);
    CAPTURE(spacing, error);
    if (before > 0) CHECK(before / error == Approx(4).margin(0.8));
    before = error;
  }
  CHECK(before < 5e-3);
}

TEST_CASE("measured ends that no end can have are refused with frequency and gain", "[string]") {
  auto model = raman(400, 40);
  const double step = model.string.step();
  const auto refused = [&](const BowedString::Reflection& end, const std::vector<std::string>& words) {
    model.string.bridge = end;
    try {
      begun(model);
      FAIL("not refused");
    } catch (const InputError& error) {
      for (const auto& word : words) CHECK_THAT(error.what(), Catch::Contains(word));
    }
  };
  refused(ideal_end(40 * step, 1.02, 0.1), {"oscillator.reflection.bridge", "1.02 times as high at 0 Hz"});
  auto ripple = ideal_end(40 * step, 0.9, 0.1), echo = ideal_end(104 * step, -0.3, 0.1);
  ripple.time.insert(ripple.time.end(), echo.time.begin(), echo.time.end());
  ripple.value.insert(ripple.value.end(), echo.value.begin(), echo.value.end());
  refused(ripple, {"1.2 times as high at 781.25 Hz", "divide"});
  refused(ideal_end(40 * step, -1, 0.1), {"its integral over time is 1", "sign"});
  refused(ideal_end(0.4 * step, 1, 0.1), {"less than a sample"});
  refused(ideal_end(90 * step, 1, 0.1), {"oscillator.frequency = 250 Hz", "222.2"});
}

TEST_CASE("strings that cannot be sampled are refused with what to do", "[string]") {
  BowedString string;
  const auto law = laws::find_law("two-exponential");
  const auto make = [&] { StringLanes(string, law, 1); };
  string.sample_rate = 16'000;
  CHECK_THROWS_WITH(make(), Catch::Contains("torsional waves from the bow to the bridge and back take 1.88 samples") &&
                                Catch::Contains("take about") && Catch::Contains("Hz or more"));
  string.sample_rate = 192'000;
  string.bow.contacts = 5;
  CHECK_THROWS_WITH(make(), Catch::Contains("between neighbouring contacts of the bow"));
  string.bow.width = 0.5;
  CHECK_THROWS_WITH(make(), Catch::Contains("beyond the ends of the string"));
}

}  // namespace
