/// The drawing of a block that moves: what the last oscillation of a run is, and what an SVG reader finds in the file.
#include "app/output/animation.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>

#include "analysis/motion/last_oscillation.hpp"
#include "tests/app/command.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using namespace rosin::tests;

namespace {

/// Names of the elements; fails where tags do not close each other, and where an attribute is not quoted.
std::vector<std::string> elements_of(const std::string& text) {
  std::vector<std::string> open, all;
  for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const auto end = text.find('>', at);
    REQUIRE(end != std::string::npos);
    const auto tag = text.substr(at + 1, end - at - 1);
    CHECK(tag.find('<') == std::string::npos);
    CHECK(std::ranges::count(tag, '"') == 2 * std::ranges::count(tag, '='));
    const bool closes = tag.front() == '/', alone = tag.back() == '/';
    const auto name = tag.substr(closes ? 1 : 0, tag.find_first_of(" /", 1) - (closes ? 1 : 0));
    if (closes) {
      REQUIRE(!open.empty());
      CHECK(open.back() == tag.substr(1));
      open.pop_back();
      continue;
    }
    all.push_back(name);
    if (!alone) open.push_back(name);
  }
  CHECK(open.empty());
  return all;
}

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> found;
  for (const char* at = text.c_str(); *at != 0;) {
    char* end;
    const double value = std::strtod(at, &end);
    if (end == at) {
      ++at;
      continue;
    }
    found.push_back(value), at = end;
  }
  return found;
}

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const auto begin = text.find(from);
  REQUIRE(begin != std::string::npos);
  const auto at = begin + from.size();
  return text.substr(at, text.find(to, at) - at);
}

}  // namespace

TEST_CASE("the last oscillation of a motion is that between its last two upward passages") {
  constexpr double period = 3.7, step = 0.001;
  LastOscillation oscillation;
  const auto phase = [&](double t) { return 2 * std::numbers::pi * t / period; };
  for (int i = 0; i * step < 20; ++i) {
    const double t = i * step;
    oscillation.add(std::sin(phase(t)), t, Eigen::VectorXd::Constant(1, std::cos(phase(t))),
                    {std::sin(phase(t)) > 0 ? Touch::sticks : Touch::open}, t, 2 * t);
  }
  const auto& whole = oscillation.whole();
  REQUIRE(!whole.empty());
  CHECK(whole.time.front() == Approx(4 * period).margin(step));
  CHECK(whole.time.back() == Approx(5 * period).margin(step));
  CHECK(whole.duration() == Approx(period).margin(2 * step));
  CHECK(whole.size() <= 257);
  const auto even = whole.evenly(33);
  REQUIRE(even.size() == 33);
  for (std::size_t i = 0; i < even.size(); ++i) {
    CHECK(even.coordinates[i][0] == Approx(std::cos(phase(even.time[i]))).margin(2e-3));
    CHECK(even.load[i] == Approx(2 * even.time[i]).margin(1e-9));
    if (i > 1 && i < 15) CHECK(even.touch[i][0] == Touch::sticks);
    if (i > 17 && i < 31) CHECK(even.touch[i][0] == Touch::open);
  }
  LastOscillation once;
  for (int i = 0; i < 1000; ++i) once.add(i - 500, i, Eigen::VectorXd::Zero(1), {}, 0, 0);
  CHECK(once.whole().empty());
}

TEST_CASE("a run of a block leaves a drawing that moves: well formed, small, on its own, and with the run's numbers") {
  const Folder folder;
  const std::string scene = std::string(ROSIN_SOURCE_DIR) + "/examples/elastic-block.toml";
  REQUIRE(run_rosin(folder, "run '" + scene +
                                "' --set run.duration=90 --set run.samples=1800 --set title='A block & <its> belt' "
                                "--out b --quiet")
              .status == 0);
  const auto text = content(folder.path / "b" / "motion.svg");
  CHECK(text.size() < 300'000);
  CHECK(text.find("script") == std::string::npos);
  CHECK(text.find("http", text.find("xmlns") + 40) == std::string::npos);
  CHECK(text.find("<title>A block &amp; &lt;its&gt; belt</title>") != std::string::npos);
  const auto elements = elements_of(text);
  CHECK(elements.front() == "svg");
  CHECK(std::ranges::count(elements, "animateTransform") == 12 + 2);  // stations, belt, cursor

  const auto result = nlohmann::json::parse(content(folder.path / "b" / "run.json"));
  const std::vector<double> time = result["time"], tilt = result["columns"]["tilt"];
  // Upward through the mean over the second quarter, twice.
  double level = 0, begin = 0, end = 0;
  long count = 0;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (time[i] > 22.5 && time[i] <= 45) level += tilt[i], ++count;
  level /= double(count);
  for (std::size_t i = 1; i < time.size(); ++i)
    if (time[i] > 45 && tilt[i - 1] < level && tilt[i] >= level) begin = end, end = time[i];
  const auto caption = numbers_in(between(text, "<desc>", "</desc>"));
  REQUIRE(caption.size() >= 6);
  CHECK(caption[0] == Approx(end - begin).margin(0.06));
  CHECK(caption[1] == Approx(begin).margin(0.06));
  CHECK(caption[2] == Approx(end).margin(0.06));
  CHECK(caption[4] == 0.1);  // m/s

  // Stations of the lower face are as far apart as on the face, and it turns by the tilt, as often as displacements are
  // drawn.
  std::vector<std::vector<double>> places;
  const std::string mark = "<g><animateTransform attributeName=\"transform\" type=\"translate\"";
  for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1))
    places.push_back(numbers_in(between(text.substr(at), "values=\"", "\"")));
  REQUIRE(places.size() == 12);
  const double gauss = std::sqrt(0.6) / 4;  // from the middle of an edge of half a metre
  CHECK((places[11][0] - places[0][0]) / (places[2][0] - places[0][0]) ==
        Approx((1.5 + 2 * gauss) / (2 * gauss)).epsilon(0.02));
  double most = -1, least = 1, highest = -1, lowest = 1;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (time[i] >= begin && time[i] <= end) highest = std::max(highest, tilt[i]), lowest = std::min(lowest, tilt[i]);
  REQUIRE(places[0].size() == places[11].size());
  for (std::size_t i = 0; i + 1 < places[0].size(); i += 2) {
    const double turned = -(places[11][i + 1] - places[0][i + 1]) / (places[11][i] - places[0][i]);
    most = std::max(most, turned), least = std::min(least, turned);
  }
  CHECK(most - least == Approx(caption[5] * (highest - lowest)).epsilon(0.05));

  const auto manifest = nlohmann::json::parse(content(folder.path / "b" / "run.manifest.json"));
  CHECK(std::ranges::count(manifest["files"], "motion.svg") == 1);
}
