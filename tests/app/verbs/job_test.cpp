/// Numbers of the terminal have the digits that their errors vouch for.
#include "app/verbs/job.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using rosin::app::verbs::justified, rosin::app::verbs::justified_above_zero;
using namespace rosin::tests;

TEST_CASE("a value has digits down to those of its error, zeros at the end included, and none below", "[app][digits]") {
  CHECK(justified(0.01, 1e-4, "1") == "0.0100 ± 1e-04");
  CHECK(justified(22.5870558, 3e-8, "s") == "22.58705580 ± 3e-08 s");
  CHECK(justified(1001.04, 4, "1/m") == "1001 ± 4e+00 1/m");
  CHECK(justified(1.5e-5, 2e-6, "m") == "1.5e-05 ± 2e-06 m");
  CHECK(justified(-3e-4, 4e-4, "1") == "-0.0003 ± 4e-04");
  CHECK(justified(-6e-27, 4e-25, "m/s") == "0 ± 4e-25 m/s");
  CHECK(justified(0, 1e-12, "1") == "0 ± 1e-12");
  CHECK(justified(0.3, 0, "1") == "0.3");  // exact
  CHECK(justified(0.3, std::numeric_limits<double>::infinity(), "1") == "0.3, of unknown error");
  // What cannot be negative has a range where the error is larger.
  CHECK(justified_above_zero(0, 8, "1") == "0 … 8");
  CHECK(justified_above_zero(0.5, 1.5, "s") == "0 … 2 s");
  CHECK(justified_above_zero(9.7393, 8e-4, "1") == "9.7393 ± 8e-04");
}

TEST_CASE("eigenvalues show no digits of rounding, and readings that are yes or no are words", "[app][digits]") {
  const Folder folder;
  const std::string examples = ROSIN_SOURCE_DIR "/examples/";
  // Two modes of this pin on a disk are undamped: their growth is rounding, 1e-18 of 28 kHz.
  CHECK_THAT(run_rosin(folder, "stability " + examples + "pin-on-disk.toml --no-pictures").out,
             Contains("       28162.433                0            0\n"));
  CHECK_THAT(run_rosin(folder, "lab spring-pulled " + examples + "lab-spring-pulled.toml --no-pictures").out,
             Contains("oscillates               yes\nstable                   no\n"));
}
