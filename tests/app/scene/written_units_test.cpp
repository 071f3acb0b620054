/// Units of a scene's numbers, in which its results are printed.
#include "app/scene/written_units.hpp"

#include <catch2/catch.hpp>

using rosin::app::scene::UnitsRead;

TEST_CASE("results have the unit in which a scene writes all numbers of a kind", "[scene]") {
  const UnitsRead read;
  const auto note = [](const char* si, double value, const char* text) {
    UnitsRead::note(si, value, text ? std::optional<std::string_view>(text) : std::nullopt);
  };
  note("m/s", 1e-6, "1 um/s"), note("m/s", 2e-5, " 20 um/s ");
  note("1/m", 2e3, "2e-3 1/um");
  note("m", 2e-5, "20 um"), note("m", 1e-3, "1 mm");  // two
  note("N", 5, "5 N"), note("N", 3, nullptr);         // SI
  note("kg", 2e-3, "2 g"), note("kg", 1, nullptr);    // and plain numbers beside it
  note("s", 1e-3, "1 ms"), note("s", 0, nullptr);     // nothing is nothing in any unit
  note("K", 293.15, "20 degC");                       // counted from another zero
  const auto written = read.written();
  CHECK(written.at("m/s").name == "um/s");
  CHECK(written.at("m/s").factor == 1e-6);
  CHECK(written.at("1/m").name == "1/um");
  CHECK(written.at("1/m").factor == 1e6);
  CHECK(written.at("s").name == "ms");
  CHECK(written.at("N").factor == 1);
  CHECK(written.at("K").name == "K");
  CHECK_FALSE(written.contains("m"));
  CHECK_FALSE(written.contains("kg"));
}
