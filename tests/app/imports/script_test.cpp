/// What scripts assign, against what Python with NumPy 1.24 and GNU Octave 7 make of the same lines.
#include "app/imports/script.hpp"

#include <catch2/catch.hpp>

#include "core/error.hpp"

using Catch::Matchers::Contains;
using namespace rosin;
namespace imports = rosin::app::imports;
using namespace rosin::app::imports;

namespace {

Script read(std::string_view text, Dialect dialect = Dialect::python) {
  return Script("script", text, dialect,
                [](std::string_view, const std::vector<Argument>&, int) { return imports::Value{}; });
}
double number(const Script& script, std::string_view name) {
  const auto& slot = script.variables().slots.find(name)->second;
  REQUIRE(slot.value.as<double>());
  return *slot.value.as<double>();
}
std::vector<double> vector(const Script& script, std::string_view name) {
  const auto* pointer = script.variables().slots.find(name)->second.value.as<std::shared_ptr<Vector>>();
  REQUIRE(pointer);
  return (*pointer)->numbers;
}
bool unknown(const Script& script, std::string_view name) {
  return script.variables().slots.find(name)->second.value.as<Unknown>() != nullptr;
}

}  // namespace

TEST_CASE("arithmetic of scripts is that of Python", "[imports]") {
  const auto script = read(
      "a = b = 1.5e-3; c = -2**2 + 7 // 2  # 7 // 2 is 3\n"
      "d = (1 +\n"
      "     2) * 3 % 5\n"
      "e = np.sqrt(2 * a) / \\\n"
      "    math.pi\n"
      "a += 1\n"
      "text = 'a # b'\n"
      "f = -7 % 3\n");
  CHECK(number(script, "a") == 1.0015);
  CHECK(number(script, "b") == 1.5e-3);
  CHECK(number(script, "c") == -1);
  CHECK(number(script, "d") == 4);
  CHECK(number(script, "e") == Approx(0.0174345505).epsilon(1e-8));
  CHECK(number(script, "f") == 2);
  CHECK(*script.variables().slots.find("text")->second.value.as<std::string>() == "a # b");
}

TEST_CASE("vectors of scripts are those of NumPy, shared by their names", "[imports]") {
  const auto script = read(
      "t = np.arange(0, 40.01, 0.01)\n"
      "v = 10 * np.ones_like(t)\n"
      "w = v\n"
      "v[20*100:-1] = 0.\n"
      "v[t < 0.015] = 3\n"
      "n = len(t)\n"
      "last = t[-1]\n"
      "x = np.linspace(0, 1, 5)\n");
  CHECK(number(script, "n") == 4001);
  CHECK(number(script, "last") == 40);
  const auto w = vector(script, "w");
  CHECK(w[0] == 3);
  CHECK(w[1] == 3);
  CHECK(w[2] == 10);
  CHECK(w[1999] == 10);
  CHECK(w[2000] == 0);
  CHECK(w[3999] == 0);
  CHECK(w[4000] == 10);
  CHECK(vector(script, "x") == std::vector<double>{0, 0.25, 0.5, 0.75, 1});
}

TEST_CASE("spaces divide a matrix of MATLAB, quotes transpose, and comments end lines", "[imports]") {
  const auto script = read(
      "p.A = 2.*3; % two\n"
      "%{\n"
      "p.A = 100;\n"
      "%}\n"
      "y = [p.A/2 -1 2 - 1 (1+1)^2]';\n"
      "z = y(2) + ...\n"
      "    5;\n"
      "name = 'it''s';\n"
      "q = y(4);\n",
      Dialect::matlab);
  CHECK(number(script, "z") == 4);
  CHECK(number(script, "q") == 4);
}

TEST_CASE("what depends on running a script is not known", "[imports]") {
  const auto script = read(
      "k = 1\n"
      "if k > 2:\n"
      "    k = 5\n"
      "m = 3\n"
      "for i in range(3): m = i\n"
      "def stiffness():\n"
      "    n = 4\n"
      "    return n\n"
      "n = 7\n"
      "s = stiffness()\n"
      "part = np.ones(3)[0:2]\n"
      "lp = np.ones(5)\n"
      "slice = lp[1:3]\n"
      "slice[:] = 4\n"
      "ramp = np.ones(4)\n"
      "ramp[where(ramp)] = 2\n"
      "table = {'a': 1}\n"
      "table[key] = 2\n"
      "if __name__ == '__main__':\n"
      "    o = 8\n");
  CHECK(unknown(script, "k"));
  CHECK(unknown(script, "m"));
  CHECK(number(script, "n") == 7);
  CHECK(unknown(script, "s"));
  CHECK(vector(script, "lp").empty());  // changed through a slice, so that nothing agrees with it any more
  CHECK(unknown(script, "ramp"));
  CHECK(unknown(script, "table"));
  CHECK(number(script, "o") == 8);
}

TEST_CASE("a bracket or a text that does not end is refused with its line", "[imports]") {
  CHECK_THROWS_WITH(read("a = 1\nb = (2 +\nc = 3\n"), Contains("script:2: a bracket is opened"));
  CHECK_THROWS_WITH(read("a = 1\nb = 'two\n"), Contains("script:2: a text begins here"));
  CHECK_THROWS_WITH(read("\n\n\"\"\"prose"), Contains("script:3: a text begins here"));
}

TEST_CASE("lists, and the choice by and or or, are those of Python", "[imports]") {
  const auto script = read(
      "v = np.array([1.] * 2 + [10.] * 3)\n"
      "a = 0 or 0.006\n"
      "b = 0.006 or 1\n"
      "c = 2 and 0.5\n"
      "d = [1, 2] - 1\n");
  CHECK(vector(script, "v") == std::vector<double>{1, 1, 10, 10, 10});
  CHECK(number(script, "a") == 0.006);
  CHECK(number(script, "b") == 0.006);
  CHECK(number(script, "c") == 0.5);
  CHECK(unknown(script, "d"));
  const auto matlab = read("a = 3 || 0;\nb = [1 2] - 1;\n", Dialect::matlab);
  CHECK(number(matlab, "a") == 1);
  CHECK(vector(matlab, "b") == std::vector<double>{0, 1});
}

TEST_CASE("what a statement may change unseen is not known", "[imports]") {
  for (const char* change :
       {"(a) = 2", "[a, b] = [2, 3]", "globals()['a'] = 2", "exec('a = 2')", "b.c[0].d = a[1] = 2"}) {
    INFO(change);
    CHECK(unknown(read("a = 1\n" + std::string(change) + "\n"), "a"));
  }
  CHECK(number(read("a = 1\na: float = 2\n"), "a") == 2);
  CHECK(number(read("a = 1\nprint('a = 2')\nlabel = 'a'\n"), "a") == 1);
  CHECK(unknown(read("a = 1;\neval('a = 2;');\n", Dialect::matlab), "a"));
  const auto script = read("m = dict(x=1)\nl = [m]\nl[0].x = 2\n");
  CHECK(record_of(script.variables().slots.find("m")->second.value)->handed_over == 3);
}
