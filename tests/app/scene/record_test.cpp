/// Measured records as files: what is read, and what is refused rather than interpolated.
#include "app/scene/record.hpp"

#include <netcdf.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "app/scene/header.hpp"
#include "core/error.hpp"
#include "tests/app/folder.hpp"

using namespace rosin;
using namespace rosin::app;
using Catch::Matchers::Contains;

namespace {

namespace fs = std::filesystem;
using rosin::tests::Folder;

struct Read {
  scene::RecordEnd end;
  std::vector<std::vector<double>> columns;
};
Read all_of(const scene::RecordSource& source) {
  Read read;
  read.columns.resize(source.columns.size());
  read.end = scene::read_record(source, [&](double, std::span<const std::span<const double>> block) {
    for (std::size_t c = 0; c < block.size(); ++c)
      read.columns[c].insert(read.columns[c].end(), block[c].begin(), block[c].end());
  });
  return read;
}

Read text(const std::string& content) {
  const Folder folder;
  std::ofstream(folder.path / "r.csv") << content;
  return all_of({folder.path / "r.csv", scene::RecordColumn{"t", "", "s"}, 0, {{"v", "", "m/s"}, {"F", "", "N"}}});
}

}  // namespace

TEST_CASE("columns are found by name and converted by the header's units", "[record]") {
  for (const std::string separator : {",", ";", "\t"}) {
    std::string content = "# a comment\nF (mN)" + separator + "t (ms)" + separator + "other" + separator + "v (mm/s)\n";
    for (int k = 0; k < 5; ++k)
      content += std::to_string(k) + separator + std::to_string(2 * k) + separator + "x" + separator + "7\r\n";
    const auto read = text(content);
    CHECK(read.end.samples == 5);
    CHECK(read.end.sample_rate == Approx(500));
    CHECK(read.columns[0] == std::vector<double>(5, 7.0 * 1e-3));
    CHECK(read.columns[1][3] == Approx(3e-3).epsilon(1e-15));
  }
  CHECK(text("t v F\n0 1 2\n1 1 2\n2  1 2").end.samples == 3);
}

TEST_CASE("a unit in the header counts in every way of writing it", "[record]") {
  struct Case {
    const char *text, *name, *unit;
  };
  for (const auto& [written, name, unit] : {Case{"Speed (mm/s)", "Speed", "mm/s"},
                                            {"Speed [mm/s]", "Speed", "mm/s"},
                                            {"Speed / mm/s", "Speed", "mm/s"},
                                            {"v/(mm/s)", "v", "mm/s"},
                                            {"response (Pa/(N s))", "response", "Pa/(N s)"},
                                            {"Speed, mm/s", "Speed", "mm/s"},
                                            {"\"Speed, mm/s\"", "Speed", "mm/s"},
                                            {"Speed mm/s", "Speed", "mm/s"},
                                            {"slip_rate_mm_s", "slip_rate", "mm/s"},
                                            {"speed_mm_per_s", "speed", "mm/s"},
                                            {"load [kN] filtered", "load", "kN"},
                                            {"load <kN>", "load", "kN"},
                                            {"load.kN", "load", "kN"},
                                            {"Z_N_s_m", "Z", "N s/m"},
                                            {"x [µm]", "x", "um"},
                                            {"mu [-]", "mu", "1"},
                                            {"load_kN", "load", "kN"},
                                            {"slip_rate", "slip_rate", ""},
                                            {"friction_force", "friction_force", ""},
                                            {"stick_fraction_001", "stick_fraction_001", ""}}) {
    const auto cell = scene::header_cell(written);
    CHECK(cell.name == name);
    CHECK(cell.unit == unit);
  }
  const auto scale = [](const char* header, const char* unit, const char* si) {
    return scene::conversion_to_si(scene::header_cell(header), {"", unit, si}).scale;
  };
  CHECK(scale("Speed [mm/s]", "", "m/s") == 1e-3);
  CHECK(scale("load_kN", "", "N") == 1e3);
  CHECK(scale("load_kN", "kN", "N") == 1e3);
  CHECK(scale("load (raw)", "mN", "N") == 1e-3);  // the file has no unit that is one
  CHECK(scale("mu_s", "", "1") == 1);             // a subscript, no second
  CHECK_THROWS_WITH(scale("load_kN", "mN", "N"), Contains("the file says kN, the scene mN"));
  CHECK_THROWS_WITH(scale("position_mm", "", "m/s"), Contains("'position_mm'") && Contains("mm"));
  CHECK_THROWS_WITH(scale("force (raw)", "", "N"), Contains("'raw' is not a known unit"));
  CHECK_THROWS_WITH(scale("T (degC)", "", "K"), Contains("another zero"));

  const auto read = text("t_ms;v [mm/s];F / kN\n0;1;2\n1;1;2\n2;1;2\n");
  CHECK(read.end.sample_rate == Approx(1000));
  CHECK(read.columns[0][0] == 1e-3);
  CHECK(read.columns[1][0] == 2e3);
  CHECK(text("t (ms) v (mm/s) F (N)\n0 1 2\n1 1 2\n2 1 2\n").columns[0][0] == 1e-3);
  CHECK(text("t,v,F\nms,mm/s,N\n0,1,2\n1,1,2\n").columns[0][1] == 1e-3);
  CHECK(text("t;v;F\n0;1,5;2\n1;1;2\n").columns[0][0] == 1.5);
  CHECK(text("Rig 2\nt,v,F\n0,1,2\n1,1,2\n").end.samples == 2);
}

TEST_CASE("a sensor's calibration is a factor and an offset in the unit of what it measures", "[record]") {
  const Folder folder;
  std::ofstream(folder.path / "r.csv") << "load (V),other,load (V)\n0.5,1,2\n1.5,1,2\n";
  const auto read = [&](const scene::RecordColumn& column) {
    return all_of({folder.path / "r.csv", {}, 100, {column}}).columns[0];
  };
  scene::RecordColumn load{"", "kN", "N", 1, 2.0, 0.25};
  CHECK(read(load) == std::vector<double>{1250, 3250});
  load.unit = "";
  CHECK_THROWS_WITH(read(load), Contains("r.csv:1: column 'load (V)': '1 V' is in V") && Contains("unit = \"N\""));
  CHECK(read({"", "", "1", 2}) == std::vector<double>{1, 1});
  CHECK_THROWS_WITH(read({"", "", "1", 4}), Contains("has no column 4; its rows have 3"));
  CHECK_THROWS_WITH(read({"load", "", "V"}), Contains("r.csv:1: several columns are named 'load'"));
  CHECK_THROWS_WITH(read({"otter", "", "1"}), Contains("did you mean 'other'?"));
}

TEST_CASE("a missing sample is a gap, where the reader takes gaps", "[record]") {
  const Folder folder;
  std::ofstream(folder.path / "r.csv") << "t,v\n0,1\n1,\n2,n/a\n,4\n4,5\n";
  scene::RecordSource source{folder.path / "r.csv", scene::RecordColumn{"t", "", "s"}, 0, {{"v", "", "m/s"}}};
  CHECK_THROWS_WITH(all_of(source), Contains("r.csv:3: column 'v' is missing here"));
  source.gaps = true;
  const auto read = all_of(source);
  CHECK(read.end.samples == 5);
  CHECK(read.end.gaps == 3);
  CHECK(read.end.sample_rate == 1);
  CHECK(std::isnan(read.columns[0][1]));
  CHECK(read.columns[0][4] == 5);
  CHECK_THAT(read.end.understood, Contains("names in line 1") && Contains("5 rows, 3 with gaps, one each 1 s"));
}

TEST_CASE("rows that are not there are a gap, behind which the clock begins anew", "[record]") {
  // Of samples each 1 s one is missing, then three, then the logger goes on 0.4 s out of step, after a number was lost.
  const Folder folder;
  std::ofstream(folder.path / "r.csv") << "t,v\n0,1\n1,2\n2,3\n4,5\n5,6\n9,10\n10,\n11,12\n13.4,13\n14.4,14\n";
  scene::RecordSource source{folder.path / "r.csv", scene::RecordColumn{"t", "", "s"}, 0, {{"v", "", "m/s"}}};
  CHECK_THROWS_WITH(all_of(source), Contains("r.csv:5: a gap"));
  source.gaps = true;
  const auto read = all_of(source);
  CHECK(read.end.missing == 1 + 3 + 1);
  CHECK(read.end.gaps == 3 + 1);
  CHECK(read.end.sample_rate == Approx(1));
  const std::vector<double> seen = {1, 2, 3, 0, 5, 6, 0, 10, 0, 12, 0, 13, 14};
  REQUIRE(read.columns[0].size() == seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i)
    CHECK((seen[i] == 0 ? std::isnan(read.columns[0][i]) : read.columns[0][i] == seen[i]));
  CHECK_THAT(read.end.understood, Contains("5 rows missing"));
}

TEST_CASE("nothing is interpolated in silence", "[record]") {
  CHECK_THROWS_WITH(text("t,v,F\n0,1,2\n1,1,2\n2,1,2\n5,1,2\n"), Contains("r.csv:5: a gap"));
  CHECK_THROWS_WITH(text("t,v,F\n0,1,2\n1,1,2\n2.2,1,2\n3.2,1,2\n4.2,1,2\n"),
                    Contains("r.csv:4: samples are not even"));
  CHECK_THROWS_WITH(text("t,v,F\n0,1,2\n1,1,2\n2,1,2\n2,1,2\n"), Contains("r.csv:5: time does not ascend"));
  CHECK_THROWS_WITH(text("t,v,F\n0,1,2\n1,nan,2\n"), Contains("r.csv:3: column 'v' is missing here"));
  CHECK_THROWS_WITH(text("t,v,F\n0,1,2\n1,1,\n"), Contains("r.csv:3: column 'F' is missing"));
  CHECK_THROWS_WITH(text("t,v,F\n0,1,2\n1,1\n"), Contains("r.csv:3: has 2 cells, the names are 3"));
  CHECK_THROWS_WITH(text("t,v\n0,1\n1,1\n"), Contains("has no column 'F'"));
  CHECK_THROWS_WITH(text("t,v,F (kg)\n0,1,2\n"), Contains("column 'F (kg)': '1 kg' is in kg"));
  CHECK_THROWS_WITH(text("t,v,F\n"), Contains("has 0 samples"));
  CHECK_THROWS_WITH(text(""), Contains("is empty"));
  std::string drifting = "t,v,F\n";  // each step within a tenth, the whole far off
  for (int k = 0; k < 200000; ++k) drifting += std::to_string(k < 100000 ? k : 100000 + (k - 100000) * 1.05) + ",1,2\n";
  CHECK_THROWS_WITH(text(drifting), Contains("the clock runs unevenly"));
}

TEST_CASE("NetCDF records, with their units and their missing values", "[record]") {
  const Folder folder;
  const auto path = folder.path / "r.nc";
  const auto write = [&](double bad) {
    int file, dimension, other, v, F, odd;
    REQUIRE(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &file) == NC_NOERR);
    nc_def_dim(file, "sample", 100000, &dimension);
    nc_def_dim(file, "few", 3, &other);
    nc_def_var(file, "v", NC_DOUBLE, 1, &dimension, &v);
    nc_def_var(file, "F", NC_FLOAT, 1, &dimension, &F);
    nc_def_var(file, "odd", NC_DOUBLE, 1, &other, &odd);
    nc_put_att_text(file, v, "units", 4, "mm/s");
    nc_enddef(file);
    std::vector<double> values(100000, 2.0);
    nc_put_var_double(file, F, values.data());
    values[70000] = bad;
    nc_put_var_double(file, v, values.data());
    nc_close(file);
  };
  const scene::RecordSource source{path, {}, 1e4, {{"v", "", "m/s"}, {"F", "kN", "N"}}};
  write(3);
  const auto read = all_of(source);
  CHECK(read.end.samples == 100000);
  CHECK(read.end.sample_rate == 1e4);
  CHECK(read.columns[0][70000] == 3e-3);
  CHECK(read.columns[1][5] == 2e3);
  auto mismatched = source;
  mismatched.columns.push_back({"odd", "", "1"});
  CHECK_THROWS_WITH(all_of(mismatched), Contains("'odd' has 3 samples, 'v' has 100000"));
  write(std::nan(""));
  CHECK_THROWS_WITH(all_of(source), Contains("sample 70000: column 'v' is missing here"));
  write(NC_FILL_DOUBLE);
  CHECK_THROWS_AS(all_of(source), InputError);
}

TEST_CASE("attributes of a NetCDF record are taken only where they are what they should be", "[record]") {
  const Folder folder;
  const auto path = folder.path / "r.nc";
  const auto write = [&](auto add) {
    int file, dimension, v;
    REQUIRE(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &file) == NC_NOERR);
    nc_def_dim(file, "sample", 4, &dimension);
    nc_def_var(file, "v", NC_DOUBLE, 1, &dimension, &v);
    add(file, v);
    nc_enddef(file);
    const double values[] = {1, 2, 3, 4};
    nc_put_var_double(file, v, values);
    nc_close(file);
  };
  const scene::RecordSource source{path, {}, 1, {{"v", "", "m/s"}}};
  const std::vector<double> many(1000, 1.0);
  write([&](int file, int v) { nc_put_att_double(file, v, "units", NC_DOUBLE, many.size(), many.data()); });
  CHECK_THROWS_WITH(all_of(source), Contains("'v': its units must be a text"));
  const char* unit = "mm/s";
  write([&](int file, int v) { nc_put_att_string(file, v, "units", 1, &unit); });
  CHECK(all_of(source).columns[0][0] == 1e-3);
  write([&](int file, int) {
    int text;
    nc_def_var(file, "text", NC_CHAR, 0, nullptr, &text);
  });
  auto other = source;
  other.columns[0].name = "text";
  CHECK_THROWS_AS(all_of(other), InputError);
}

TEST_CASE("a fill value is one number", "[record]") {
  const scene::RecordSource source{ROSIN_SOURCE_DIR "/tests/records/fill-values.nc", {}, 100, {{"time", "", "s"}}};
  CHECK_THROWS_WITH(all_of(source), Contains("'time': its _FillValue must be one number, not 8 values"));
}

TEST_CASE("a file that crashes the library that reads it is damaged, and nothing else", "[record]") {
  const scene::RecordSource source{ROSIN_SOURCE_DIR "/tests/records/damaged.nc", {}, 100, {{"slip_rate", "", "m/s"}}};
  CHECK_THROWS_WITH(all_of(source), Contains("damaged.nc: is damaged"));
}

TEST_CASE("the first line of a file that is no record is not shown", "[record]") {
  CHECK_THROWS_WITH(text("root:$6$secret:19000:0:99999:7:::\n"), Contains("has 0 samples") && !Contains("secret"));
  CHECK_THROWS_WITH(text("root:$6$secret:19000:0:99999:7:::\n1 2\n"),
                    Contains("these are no names of columns") && !Contains("secret"));
  CHECK_THROWS_WITH(text("time,speed,force\n0,1,2\n"), Contains("has no column 'v'; it has time, speed, force"));
}
