/// Scenes whose ending is known: each row of known.toml is asked its question, and ends as the row says.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <map>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/steady/stability.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/verb.hpp"
#include "tests/app/folder.hpp"

using namespace rosin;

namespace {

using Numbers = std::map<std::string, double, std::less<>>;

/// One row of the table.
struct Known {
  std::string name, question;
  app::scene::Scene scene;
  std::vector<double> tolerances = {1e-8};
  std::vector<std::string> endings;  ///< any of these
  std::string says;                  ///< is in the detail, the remark or the refusal; empty: anything
  std::optional<bool> stable;        ///< of the cycle
  std::string steady_sliding;        ///< "stable" or "unstable"; empty: either
  Numbers at_least, at_most;  ///< by the name of a metric of the cycle, of a column at the end of the run, "steps"
  bool slow = false;          ///< takes seconds
};

/// Puts what `row` does not say itself there from the row that it is like.
void complete(toml::table& row, const toml::table& like) {
  for (const auto& [key, node] : like) {
    auto* own = row.get(key);
    if (!own)
      row.insert(key, node);
    else if (own->is_table() && node.is_table())
      complete(*own->as_table(), *node.as_table());
  }
}

bool truth(const toml::node& node, std::string_view key) {
  if (!node.is_boolean()) app::scene::wrong_kind(node, key, "true or false");
  return *node.value<bool>();
}

Known read_row(const toml::table& row, const std::string& path) {
  Known known;
  app::Request request;
  app::scene::SceneReader reader{request, row, app::scene::Table(row, ""), known.scene, {}, {}};
  auto& table = reader.root;
  known.name = app::scene::text(table.required("name", "the mechanism, in a sentence"), "name");
  app::scene::text(table.required("why", "how it once failed, or what it guards"), "why");
  known.question = app::scene::choice(table.required("question", "run or cycle"), "question", {"run", "cycle"});
  known.endings = app::scene::texts(table.required("ending", "endings that are right"), "ending");
  if (const auto* node = table.find("tolerance"))
    known.tolerances = app::scene::numbers(*node, {"tolerance", "1", {1e-12, 0.1}, "relative accuracy"});
  if (const auto* node = table.find("says")) known.says = app::scene::text(*node, "says");
  if (const auto* node = table.find("stable")) known.stable = truth(*node, "stable");
  if (const auto* node = table.find("steady_sliding"))
    known.steady_sliding = app::scene::choice(*node, "steady_sliding", {"stable", "unstable"});
  if (const auto* node = table.find("slow")) known.slow = truth(*node, "slow");
  for (const auto& [key, bounds] : {std::pair{"at_least", &known.at_least}, std::pair{"at_most", &known.at_most}})
    if (const auto* node = table.find(key)) {
      const app::scene::Table of(*node, key);
      for (const auto& [quantity, bound] : *node->as_table())
        (*bounds)[std::string(quantity.str())] =
            app::scene::number(bound, {of.path(quantity.str()), "", {}, "a bound"});
    }
  if (const auto* node = table.find("most_steps"))
    known.scene.task<rosin::analysis::motion::RunOptions>().most_steps =
        app::scene::count(*node, "most_steps", 1, app::scene::most_points, "steps that a run may take");
  request.verb = known.question;
  app::verbs::find_verb(known.question).read(reader);
  known.scene.path = path;
  table.finish();
  return known;
}

/// \throws InputError with file, line and key for anything that the scene reader or the table does not know.
std::vector<Known> read_known(const std::string& path) {
  auto document = app::scene::read_toml(path);
  auto& rows = *document.get("known")->as_array();
  const auto named = [&](std::string_view name) -> const toml::table& {
    for (const auto& row : rows)
      if ((*row.as_table())["name"].value<std::string_view>() == name) return *row.as_table();
    throw InputError(fmt::format("{}: no row is named '{}'", path, name));
  };
  std::vector<Known> known;
  for (auto& node : rows) {
    auto& row = *node.as_table();
    if (const auto like = row["like"].value<std::string>()) {
      for (const char* table : {"law", "oscillator", "drive", "run", "solver"})
        if (const auto* settings = named(*like)[table].as_table()) complete(row, toml::table{{table, *settings}});
      row.erase("like");
    }
    known.push_back(read_row(row, path));
  }
  return known;
}

/// What is known of an answer.
struct Answer {
  std::string ending, words;
  std::optional<bool> stable;
  Numbers numbers;
};

Answer cycle(const app::scene::Scene& scene, double tolerance) {
  const auto found = analysis::cycles::find_cycle(scene.model, {.tolerance = tolerance});
  Answer answer{name(found.outcome.ending), found.outcome.detail, found.stable, {{"steps", found.cost.steps}}};
  for (const auto& metric : analysis::cycles::metric_names())
    answer.numbers[metric.name] = found.metrics.*metric.member;
  // Over a period the slider stays where it is: the mean of the slip rate is the drive's speed.
  if (found.outcome.complete()) {
    const double V = std::abs(scene.model.drive.speed.level());
    CHECK(std::abs(std::abs(found.metrics.slip_rate_mean) - V) <= std::max(found.error.slip_rate_mean, 1e-6 * V));
  }
  return answer;
}

Answer run(const app::scene::Scene& scene, double tolerance) {
  auto options = scene.task<rosin::analysis::motion::RunOptions>();
  options.tolerance = tolerance;
  const auto found = analysis::motion::run(scene.model, options);
  Answer answer{name(found.outcome.ending), found.outcome.detail + found.remark, {}, {{"steps", found.cost.steps}}};
  for (std::size_t c = 0; c < found.columns.size(); ++c)
    if (!found.columns[c].empty()) answer.numbers[found.column_names[c]] = found.columns[c].back();
  answer.numbers.insert(found.metrics.begin(), found.metrics.end());
  return answer;
}

Answer ask(const Known& known, double tolerance) {
  try {
    return known.question == "run" ? run(known.scene, tolerance) : cycle(known.scene, tolerance);
  } catch (const InputError& error) {
    return {"refused", error.what(), {}, {}};
  }
}

void check(const Known& known) {
  if (!known.steady_sliding.empty())
    CHECK(analysis::steady::stability(known.scene.model).stable == (known.steady_sliding == "stable"));
  for (const double tolerance : known.tolerances) {
    const auto answer = ask(known, tolerance);
    INFO(known.name << ", asked at " << tolerance << ": " << answer.ending << "; " << answer.words);
    CHECK_THAT(known.endings, Catch::VectorContains(answer.ending));
    CHECK_THAT(answer.words, Catch::Contains(known.says));
    if (known.stable) CHECK(answer.stable == known.stable);
    for (const auto& [quantity, bound] : known.at_least) {
      INFO(quantity);
      REQUIRE(answer.numbers.contains(quantity));
      CHECK(answer.numbers.at(quantity) >= bound);
    }
    for (const auto& [quantity, bound] : known.at_most) {
      INFO(quantity);
      REQUIRE(answer.numbers.contains(quantity));
      CHECK(answer.numbers.at(quantity) <= bound);
    }
  }
}

const std::vector<Known>& all() {
  static const auto known = read_known(ROSIN_SOURCE_DIR "/tests/scenes/known.toml");
  return known;
}

}  // namespace

TEST_CASE("scenes end as they are known to", "[known]") {
  for (const auto& known : all())
    if (!known.slow) check(known);
}

TEST_CASE("scenes that take seconds end as they are known to", "[known][long]") {
  for (const auto& known : all())
    if (known.slow) check(known);
}

TEST_CASE("a row of known scenes with an unknown key is refused with its place", "[known]") {
  const tests::Folder folder;
  const auto path = (folder.path / "known.toml").string();
  const auto refusal_of = [&](const std::string& line) {
    std::ofstream(path) << "[[known]]\nname = 'slip'\nwhy = 'a test'\nquestion = 'cycle'\nending = ['none exists']\n"
                        << line << "\nlaw.type = 'coulomb'\noscillator = { mass = 1, stiffness = 1 }\n"
                        << "drive = { speed = 1, normal_load = 1 }\n";
    return [path] { read_known(path); };
  };
  CHECK_NOTHROW(refusal_of("at_most = { steps = 1 }")());
  CHECK_THROWS_WITH(refusal_of("at_mots = { steps = 1 }")(),
                    Catch::Contains("known.toml:6:1") && Catch::Contains("did you mean 'at_most'?"));
  CHECK_THROWS_WITH(refusal_of("law.mu_x = 1")(), Catch::Contains("known.toml:6:") && Catch::Contains("mu_x"));
  CHECK_THROWS_WITH(refusal_of("stable = 'yes'")(),
                    Catch::Contains("known.toml:6:") && Catch::Contains("true or false"));
  CHECK_THROWS_WITH(refusal_of("like = 'another'")(), Catch::Contains("no row is named 'another'"));
}
