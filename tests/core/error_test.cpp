/// Errors: which known name is suggested for an unknown one.
#include "core/error.hpp"

#include <catch2/catch.hpp>

#include "core/parameters.hpp"

using namespace rosin;

TEST_CASE("a name is suggested where half of it is known, whatever the case", "[core]") {
  const std::vector<std::string> ageing = {"mu0", "a", "b", "L", "v0", "lambda"};
  CHECK(nearest_name("l", ageing) == "L");
  CHECK(nearest_name("MU0", ageing) == "mu0");
  CHECK(nearest_name("lamda", ageing) == "lambda");
  CHECK(nearest_name("aa", ageing) == "a");
  CHECK(nearest_name("xy", ageing).empty());  // two changes make "a" of it, and of everything so short
  CHECK(nearest_name("theta", ageing).empty());
  for (const char* name : {"Dc", "D_c", "d_c"}) CHECK(nearest_name(name, ageing) == "L");
  CHECK(nearest_name("Dc", {"mu_s", "mu_d"}).empty());
}
