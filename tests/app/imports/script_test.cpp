/// What scripts assign, against what Python with NumPy 1.24 and GNU Octave 7 make of the same lines; what they may
/// change unseen is not known.
#include "app/imports/script.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "core/error.hpp"

using Catch::Matchers::Contains;
using namespace rosin;
namespace imports = rosin::app::imports;
using namespace rosin::app::imports;

namespace {

Script python(std::string_view text) { return read_python("script", text); }
Script matlab(std::string_view text) {
  return read_matlab("script", text,
                     [](std::string_view, const std::vector<imports::Value>&, int) { return imports::Value{}; });
}
const imports::Value& value(const Script& script, std::string_view name) {
  const auto found = script.variables.slots.find(name);
  REQUIRE(found != script.variables.slots.end());
  return found->second.value;
}
double number(const Script& script, std::string_view name) {
  INFO(name);
  const auto* number = value(script, name).as<double>();
  REQUIRE(number);
  return *number;
}
std::vector<double> vector(const Script& script, std::string_view name) {
  const auto* pointer = value(script, name).as<std::shared_ptr<Vector>>();
  REQUIRE(pointer);
  return (*pointer)->numbers;
}
bool unknown(const Script& script, std::string_view name) { return value(script, name).as<Unknown>() != nullptr; }
int changed(const Script& script, std::string_view name) {
  if (const auto record = record_of(value(script, name))) return record->changed.line;
  const auto* vector = value(script, name).as<std::shared_ptr<Vector>>();
  REQUIRE(vector);
  return (*vector)->changed.line;
}

}  // namespace

TEST_CASE("arithmetic of scripts is that of Python", "[imports]") {
  const auto script = python(
      "import math\n"
      "import numpy as np\n"
      "a = b = 1.5e-3; c = -2**2 + 7 // 2  # 7 // 2 is 3\n"
      "d = (1 +\n"
      "     2) * 3 % 5\n"
      "e = np.sqrt(2 * a) / \\\n"
      "    math.pi\n"
      "a += 1\n"
      "text = 'a # b'\n"
      "f = -7 % 3\n"
      "g: float = 2**-1\n"
      "if __name__ == '__main__':\n"
      "    h = 8\n");
  CHECK(number(script, "a") == 1.0015);
  CHECK(number(script, "b") == 1.5e-3);
  CHECK(number(script, "c") == -1);
  CHECK(number(script, "d") == 4);
  CHECK(number(script, "e") == Approx(0.0174345505).epsilon(1e-8));
  CHECK(number(script, "f") == 2);
  CHECK(number(script, "g") == 0.5);
  CHECK(number(script, "h") == 8);
  CHECK(*value(script, "text").as<std::string>() == "a # b");
}

TEST_CASE("vectors of scripts are those of NumPy, shared by their names", "[imports]") {
  const auto script = python(
      "import numpy as np\n"
      "t = np.arange(0, 40.01, 0.01)\n"
      "v = 10 * np.ones_like(t)\n"
      "w = v\n"
      "v[20*100:-1] = 0.\n"
      "v[t < 0.015] = 3\n"
      "n = len(t)\n"
      "last = t[-1]\n"
      "x = np.linspace(0, 1, 5)\n"
      "y = np.array([1.] * 2 + [10.] * 3)\n");
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
  CHECK(vector(script, "y") == std::vector<double>{1, 1, 10, 10, 10});
}

TEST_CASE("what a script in Python may change unseen is not known, by its line", "[imports]") {
  const std::string head =
      "import numpy as np\nfrom rsfmodel import rsf\nfrom lab import configure\nm = rsf.Model()\nm.a = 1\n";
  for (const char* change :
       {"configure(m)", "[configure][0]([m])", "m.__setattr__('a', 2)", "vars(m)['a'] = 2", "m.__dict__['a'] = 2",
        "setattr(m, 'a', 2)", "exec('m.a = 2')", "for s in [m]: s.a = 2", "while m.a < 2: m.a += 1",
        "[setattr(s, 'a', 2) for s in [m]]", "list(map(lambda s: setattr(s, 'a', 2), [m]))", "with configure(m): pass",
        "globals()['m'].a = 2", "x = {'m': m}; x['m'] = configure(x)", "if 1 > 0: m.a = 2", "del m.a",
        "print(configure(m))", "def f(x=configure(m)): pass", "import builtins; builtins.m = 3"}) {
    INFO(change);
    CHECK(changed(python(head + change + "\n"), "m") == 6);
  }
  const auto called = python(head + "def change():\n    m.a = 2\nother = change\n\nother()\n");
  CHECK(changed(called, "m") == 10);
  CHECK(changed(python(head + "def change():\n    m.a = 2\nprint(m.a, 'm.a = 3')\n"), "m") == 0);
  for (const char* change : {"v[np.where(t > 1)] = 3.", "v[[0, 1]] = 3.", "v.fill(2.)", "np.copyto(v, 3.)", "v += 1",
                             "np.multiply(v, 2, out=v)", "np.add(v, 1, v)", "w = v[1:2]; w[:] = 4.", "v.sort()"}) {
    INFO(change);
    CHECK(changed(python("import numpy as np\nt = np.arange(0., 4.)\nv = np.ones_like(t)\nu = v\n" +
                         std::string(change) + "\n"),
                  "u") == 5);
  }
  const auto names = python("k = 1\nif k > 2:\n    k = 5\nm = 3\nfor i in range(3): m = i\nn = 7\ns = stiffness()\n");
  for (const char* name : {"k", "m", "i", "s"}) CHECK(unknown(names, name));
  CHECK(number(names, "n") == 7);
}

TEST_CASE("a script's values count as they are when it runs them", "[imports]") {
  const std::string text =
      "from rsfmodel import rsf, plot\nm = rsf.Model()\nm.a = 1\nm.solve()\nm.a = 2\nplot.dispPlot(m)\n";
  const auto a = [](const Script& script) { return *record_of(value(script, "m"))->slots.at("a").value.as<double>(); };
  CHECK(a(python(text)) == 1);
  CHECK(changed(python(text), "m") == 0);
  const auto twice = python(text + "m.solve()\n");
  CHECK(changed(twice, "m") == 7);
  CHECK_THAT(record_of(value(twice, "m"))->changed.why, Contains("second run, beside that in line 4"));
}

TEST_CASE("scripts in Python that are none, or too much, are refused with their line", "[imports]") {
  CHECK_THROWS_WITH(python("a = 1\nb = (2 +\nc = 3\n"), Contains("script:2: 'b = (2 +'"));
  CHECK_THROWS_WITH(python("a = 1\nb = 'two\n"), Contains("script:2:"));
  CHECK_THROWS_WITH(python("a = 1\nprint 'two'\n"), Contains("script:2:") && Contains("is no Python"));
  std::string doubled = "a = []\n", long_one = "a = 1\n", lists, nested = "a = 1\nb = ";
  for (int i = 0; i < 60; ++i) doubled += "a = [a, a]\n";
  for (int i = 0; i < 20000; ++i) long_one += "a = [a]\n";
  for (int i = 0; i < 40; ++i) lists += fmt::format("l{} = [1] * 1000000\n", i);
  nested += std::string(20000, '-') + "1\n";
  CHECK_NOTHROW(python(doubled + "f(a)\n"));
  CHECK_THROWS_WITH(python(long_one), Contains("becomes longer than 65536 bytes"));
  CHECK_THROWS_WITH(python(lists), Contains("script:3:") && Contains("too many numbers"));
  CHECK_THROWS_WITH(python(nested), Contains("script:1:"));
  CHECK(unknown(python("a = 9**9**9\n"), "a"));
}

TEST_CASE("spaces divide a row of MATLAB, quotes transpose, powers go from the left, and commas end statements",
          "[imports]") {
  const auto script = matlab(
      "p.A = 2.*3; % two\n"
      "%{\n"
      "p.A = 100;\n"
      "%}\n"
      "y = [p.A/2 -1 2 - 1 (1+1)^2]';\n"
      "z = y(2) + ...\n"
      "    5;\n"
      "name = 'it''s';\n"
      "q = y(4);\n"
      "a = 0.0144, b = 0.02312\n"
      "c = 2^3^2, d = -2^2, e = 2^-1, f = 1d3, g = [1 - 2]; h = 6/2*3\n"
      "p2 = p; p2.A = 7;\n"
      "i = p.A;\n");
  CHECK(number(script, "z") == 4);
  CHECK(number(script, "q") == 4);
  CHECK(number(script, "a") == 0.0144);
  CHECK(number(script, "b") == 0.02312);
  CHECK(number(script, "c") == 64);
  CHECK(number(script, "d") == -4);
  CHECK(number(script, "e") == 0.5);
  CHECK(number(script, "f") == 1000);
  CHECK(number(script, "g") == -1);
  CHECK(number(script, "h") == 9);
  CHECK(number(script, "i") == 6);
  CHECK_THROWS_WITH(matlab("a = 1;\nb = [2 +\nc = 3\n"), Contains("script:2: a bracket is opened"));
  CHECK_THROWS_WITH(matlab("a = 1;\nb = 'two\n"), Contains("script:2: a text begins here"));
}

TEST_CASE("what a script in MATLAB may change unseen is not known", "[imports]") {
  for (const char* change : {"set_parameters",
                             "set_parameters;",
                             "load('x.mat')",
                             "load x.mat",
                             "run('x.m')",
                             "clear",
                             "clear a",
                             "eval('a = 2;')",
                             "x = evalin('base', 'a');",
                             "if 1 > 0, a = 2; end",
                             "for a = 1:3, end",
                             "a(1) = 2;",
                             "[a, x] = deal(2);",
                             "a += 1;",
                             "assignin('base', 'a', 2)",
                             "a = a == 1;",
                             "a = int32(2);",
                             "a = 2i;",
                             "a = [1; 2];",
                             "a = 1:3;"}) {
    INFO(change);
    CHECK(unknown(matlab("a = 1;\n" + std::string(change) + "\n"), "a"));
  }
  for (const char* harmless :
       {"close all", "figure(1)", "disp(a)", "a", "plot(x, a)", "hold on", "x = foo(a);", "a'"}) {
    INFO(harmless);
    CHECK(number(matlab("a = 1;\n" + std::string(harmless) + "\n"), "a") == 1);
  }
  CHECK(unknown(matlab("global a\na = 1;\nx = foo(2);\n"), "a"));
  // what follows a run is about its results
  CHECK(number(matlab("a = 1;\n[T, Y] = ode45(f, [0 1], y0);\nset_parameters\na = 2;\n"), "a") == 1);
  CHECK(changed(matlab("p.A = 1;\np(2).A = 3;\n"), "p") == 2);
  CHECK(changed(matlab("p.A = 1;\nset_parameters\n"), "p") == 2);
}
