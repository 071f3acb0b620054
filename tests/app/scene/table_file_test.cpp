/// Tables as instruments write them: each is read as it was meant, or refused with its line.
#include "app/scene/table_file.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <random>

#include "core/error.hpp"
#include "tests/app/folder.hpp"

using namespace rosin;
using namespace rosin::app;
using Catch::Matchers::Contains;

namespace {

using rosin::tests::Folder;

struct Table {
  scene::TableHead head;
  std::vector<std::vector<double>> rows;
  std::vector<long> lines;
};
/// All columns, by number.
Table table(const std::filesystem::path& path, const scene::TableKeys& keys = {}) {
  scene::TableFile file(path, keys);
  Table read{file.head(), {}, {}};
  for (std::size_t c = 0; c < read.head.columns.size(); ++c) file.need({"", "", "", int(c) + 1});
  for (std::vector<double> row; file.row(row);) read.rows.push_back(row), read.lines.push_back(file.line());
  return read;
}
Table text(const std::string& content, const scene::TableKeys& keys = {}) {
  const Folder folder;
  std::ofstream(folder.path / "t.csv", std::ios::binary) << content;
  return table(folder.path / "t.csv", keys);
}
using Rows = std::vector<std::vector<double>>;

}  // namespace

TEST_CASE("separators, decimal signs, byte-order marks, line ends and quotes are found", "[table]") {
  const Rows wanted = {{0, 1.5}, {0.25, -2.5e-3}};
  for (const char* content :
       {"t,v\n0,1.5\n0.25,-2.5e-3\n", "t;v\n0;1.5\n0.25;-2.5e-3\n", "t;v\n0;1,5\n0,25;-2,5e-3\n",
        "t\tv\n0\t1,5\n0,25\t-2,5e-3\n", "t v\n0 1,5\n0,25 -2,5e-3\n", "  t   v\n  0   1.5\n .25 -2.5e-3\n",
        "\xef\xbb\xbft,v\r\n0,1.5\r\n0.25,-2.5e-3\r\n", "t v\r0 1.5\r0.25 -2.5e-3",
        "\"t\",\"v\"\n\"0\",\"1,5\"\n\"0,25\",\"-2,5e-3\"\n", "t,v,\n0,1.5,\n0.25,-2.5e-3,\n",
        "sep=;\nt;v\n\n# comment\n0;1,5\n% comment\n+0,25;-2,5e-3 # here\n"}) {
    INFO(content);
    auto read = text(content);
    for (auto& row : read.rows) row.resize(2);
    CHECK(read.rows == wanted);
    CHECK(read.head.columns[0].name == "t");
    CHECK(read.head.columns[1].name == "v");
  }
  CHECK_THROWS_WITH(text("\xff\xfet\0,\0v\0"), Contains("t.csv:1: is text of two bytes a letter"));
  CHECK(text("t v\n0 1\n", {}).head.text() ==
        "separated by blanks, decimal point; names in line 1, numbers from line 2 on");
}

TEST_CASE("a comma that may stand for decimals or for thousands is refused with the cure", "[table]") {
  const std::string doubtful = "t;F\n0;1,234\n1;2,345\n";
  CHECK_THROWS_WITH(text(doubtful), Contains("t.csv:2: '1,234' may be") && Contains("decimal = \",\""));
  CHECK(text(doubtful, {.decimal = ','}).rows[1][1] == 2.345);
  CHECK_THROWS_WITH(text(doubtful, {.decimal = '.'}), Contains("'1,234'"));
  CHECK(text("t;F\n0,5;1,234\n1;2,345\n").rows[1][1] == 2.345);  // a number elsewhere decides
  CHECK_THROWS_WITH(text("t;F\n0;1.5\n1;1,5\n2;2.5\n"),
                    Contains("t.csv:3: column 'F' is not a finite number here: '1,5'") && Contains("sign"));
  CHECK_THROWS_WITH(text("t;F\n0;1.234,5\n1;2,5\n2;2,5\n"), Contains("t.csv:2: column 'F'"));
  // between commas, a decimal comma makes two cells of one number
  CHECK_THROWS_WITH(text("t,F\n0,1,5\n1,2,5\n"), Contains("t.csv:1: has 2 cells, the rows below have 3"));
  CHECK_THROWS_WITH(text("F\n0,5\n1,5\n"), Contains("t.csv:1: has 1 cells") && Contains("decimal sign"));
}

TEST_CASE("names are the last line of texts before the numbers, units stand in them or below", "[table]") {
  struct Case {
    const char* content;
    long names, units;
    std::string first, second;
  };
  for (const auto& [content, names, units, first, second] :
       {Case{"Rig 2\nNumber of samples,12\nv (mm/s),mu\n1,2\n", 3, 0, "mm/s", ""},
        {"v,mu\nmm/s,-\n1,2\n", 1, 2, "mm/s", "1"},
        {"v,mu\nmm/s,1\n1,2\n", 1, 2, "mm/s", "1"},
        {"v,F\n# mm/s,kN\n1,2\n", 1, 2, "mm/s", "kN"},
        {"v,F\n[mm/s],[kN]\n1,2\n", 1, 2, "mm/s", "kN"},
        {"v, mm/s, F, kN\n1,2\n", 1, 0, "mm/s", "kN"},
        {"v_mm_s F_kN\n1 2\n", 1, 0, "mm/s", "kN"},
        {"mm/s,kN\nv,F\n1,2\n", 2, 1, "mm/s", "kN"},
        {"mm/s,kN\nspeed of the disc,load\nv,F\n1,2\n", 3, 1, "mm/s", "kN"},
        {"Rig 7\n\"mm/s\",\"-\"\nv,mu\n1,2\n", 3, 2, "mm/s", "1"},
        {"A,C\nleft,right\nv,F\n1,2\n", 3, 0, "", ""},
        {"# v (mm/s), F (kN)\nspeed,force\n1,2\n", 2, 1, "mm/s", "kN"},
        {"# rig (new), run (last)\nspeed,force\n1,2\n", 2, 0, "", ""},
        {"# v (mm/s) F [kN]\n1 2\n", 1, 0, "mm/s", "kN"},
        {"Rate,100\nOperator,Smith\nv,F\nmm/s,kN\n1,2\n", 3, 4, "mm/s", "kN"},
        {"***End***\nv\tF\n---\t---\n1\t2\n", 2, 0, "", ""},
        {"v;x [\xb5m]\n1;2\n", 1, 0, "", "um"},
        {"n / 1/min;w / °/s\n1;2\n", 1, 0, "1/min", "°/s"},
        {"n in 1/min;slip %\n1;2\n", 1, 0, "1/min", "%"},
        {"n;w\n1/min;°\n1;2\n", 1, 2, "1/min", "°"},
        {"Drehzahl [U/min];M Nm\n1;2\n", 1, 0, "U/min", "Nm"},
        {"n [min-1];RPM\n1;2\n", 1, 0, "min-1", "RPM"}}) {
    INFO(content);
    const auto read = text(content);
    CHECK(read.rows == Rows{{1, 2}});
    CHECK(read.head.names_line == names);
    CHECK(read.head.units_line == units);
    CHECK(read.head.columns[0].unit == first);
    CHECK(read.head.columns[1].unit == second);
  }
  const std::string two = "12,5\n13,6\nt,v\n0,1\n1,2\n2,3\n";
  CHECK_THROWS_WITH(text(two), Contains("t.csv:3: texts stand below numbers (line 1)"));
  CHECK(text(two, {.names_line = 3}).rows == Rows{{0, 1}, {1, 2}, {2, 3}});
  CHECK_THROWS_WITH(text(two, {.names_line = 9}), Contains("names_line = 9"));
  CHECK_THROWS_WITH(text("t,v\n0,1\n1,1\nx,y\n2,1\n3,1\n4,1\n"), Contains("t.csv:4: texts stand below numbers"));
  CHECK_THROWS_WITH(text("v (mm/s),F\nm/s,N\n1,2\n"), Contains("t.csv:2: says m/s of column 'v (mm/s)'"));
  CHECK_THROWS_WITH(text("x,1\n0,1\n1,2\n2,3\n"), Contains("t.csv:1: column 1 is not a finite number here: 'x'"));
}

TEST_CASE("a first cell that announces units belongs to no column", "[table]") {
  for (const char* head : {"\"Unit\",\"mm/s\",\"-\"\n\"Ch\",\"v\",\"mu\"\n", "Units:,mm/s,-\nlogger,7,x\nCh,v,mu\n",
                           "Ch,v,mu\nUnit,mm/s,-\n", "Ch,v,mu\nEinheit,mm/s,\n"}) {
    INFO(head);
    const auto read = text(std::string(head) + "1,2,3\n2,4,6\n");
    CHECK(read.head.columns[0].unit.empty());
    CHECK(read.head.columns[1].name == "v");
    CHECK(read.head.columns[1].unit == "mm/s");
    CHECK(read.rows == Rows{{1, 2, 3}, {2, 4, 6}});
  }
}

TEST_CASE("exports of xlook are read: counts, names and units in fixed widths, record numbers in front", "[table]") {
  const auto read = text(
      "number of records = 3\n"
      "    col 1       col 2       col 3       \n"
      "     LP Disp     Shr stress  Time        \n"
      "     micron      MPa         sec         \n"
      "     3recs       3recs       3recs       \n"
      "0 1.5 2.5 0\n1 1.6 2.4 0.1\n2 1.7 2.3 0.2\n");
  CHECK(read.head.columns[1].name == "LP Disp");
  CHECK(read.head.columns[2].name == "Shr stress");
  CHECK(read.head.columns[1].unit == "micron");
  CHECK(read.head.columns[2].unit == "MPa");
  CHECK(read.rows[2] == std::vector<double>{2, 1.7, 2.3, 0.2});
  // right-aligned, with counts apart from "recs", and in the units of the programme
  const auto other = text(
      "number of records = 5400\n"
      "            col 1       col 2       col 3\n"
      "           LP_Vel    LP_Disp         mu\n"
      "          mic/sec         mic           .\n"
      "        5400 recs   5400 recs   5400 recs\n"
      "   101         1000      5.89975      0.39975\n"
      "   102      1125.34      5.89968     0.399684\n");
  CHECK(other.head.columns[1].name == "LP_Vel");
  CHECK(other.head.columns[1].unit == "mic/sec");
  CHECK(other.head.columns[2].unit == "mic");
  CHECK(other.rows[1] == std::vector<double>{102, 1125.34, 5.89968, 0.399684});
}

TEST_CASE("missing numbers are NaN, rows of other lengths and infinite numbers are refused", "[table]") {
  const auto read = text("t,v\n0,1\n1,\n2,NaN\n3,n/a\n4,-\n5,#N/A\n6,7\n");
  CHECK(read.rows.size() == 7);
  for (std::size_t i = 1; i < 6; ++i) CHECK(std::isnan(read.rows[i][1]));
  // a text in a column that nobody asks for, and what it holds
  const Folder folder;
  std::ofstream(folder.path / "t.csv") << "what,v\n\"sample #3, new\",1\n\"sample #4, new\",2\n";
  scene::TableFile file(folder.path / "t.csv", {});
  std::vector<double> row;
  file.need({"v", "", "1"});
  CHECK((file.row(row) && file.row(row)));
  CHECK(row[1] == 2);
  const auto commas = text("t;v\n0,5;1\n1,5;n.a.\n2,5;1.#QNAN\n3,5;2,5\n");
  CHECK(std::isnan(commas.rows[1][1]));
  CHECK(std::isnan(commas.rows[2][1]));
  CHECK(text("t\tv\n\t1\n1\t2\n2\t3\n").rows[1] == std::vector<double>{1, 2});  // an empty first cell
  CHECK_THROWS_WITH(text("t,v\n0,1\n1,inf\n2,1\n"), Contains("t.csv:3: column 'v' is not a finite number"));
  CHECK_THROWS_WITH(text("t,v\n0,1\n1,1e999\n2,1\n"), Contains("t.csv:3: column 'v' is not a finite number"));
  CHECK_THROWS_WITH(text("t,v\n0,1\n1,2,3\n2,1\n3,1\n"), Contains("t.csv:3: has 3 cells, the names are 2"));
  CHECK_THROWS_WITH(text("a,b\n\"1,2\n3,4\n5,6\n"), Contains("t.csv:2: has a quotation mark without its other"));
  CHECK_THROWS_WITH(text("a,b\n1,\"2\n3,4\n5,6\n"), Contains("t.csv:2: column 'b' is not a finite number"));
  CHECK_THROWS_WITH(text("a,b\n1,\"2\"7\n3,4\n5,6\n"), Contains("t.csv:2: column 'b' is not a finite number"));
}

namespace {

/// A table of random numbers, written as some instrument might.
struct Written {
  std::string content;
  std::size_t body;  ///< where its rows begin
  Rows rows;
  std::vector<long> lines;  ///< of the rows
};
Written random_table(std::mt19937& dice) {
  const auto roll = [&](int n) { return int(dice() % unsigned(n)); };
  const char separator = ",;\t "[roll(4)];
  const bool comma = separator != ',' && roll(2) == 0, crlf = roll(2) == 0;
  const std::string end = crlf ? "\r\n" : "\n", sep(1, separator);
  Written file;
  long line = 1;
  const auto put = [&](const std::string& text) { file.content += text + end, ++line; };
  if (roll(4) == 0) file.content = "\xef\xbb\xbf";
  if (roll(3) == 0) put("Rig"), put("Samples" + sep + "12");
  const bool below = roll(2) == 0;
  put(below ? "time" + sep + "speed" + sep + "load"
            : "time (s)" + sep + "speed [mm/s]" + sep + (separator == ' ' ? "load_kN" : "load / kN"));
  if (below) put("s" + sep + "mm/s" + sep + "kN");
  file.body = file.content.size();
  const int rows = 4 + roll(12);
  for (int i = 0; i < rows; ++i) {
    std::vector<double> row = {i + 0.5, roll(100000) / 64.0 - 700, std::ldexp(roll(1000) + 1, -roll(30))};
    std::string text;
    for (std::size_t c = 0; c < row.size(); ++c) {
      auto number = fmt::format("{}", row[c]);
      if (comma) std::replace(number.begin(), number.end(), '.', ',');
      const bool missing = separator != ' ' && c == 2 && i > 0 && roll(8) == 0;
      if (missing) row[c] = std::nan(""), number = roll(2) == 0 ? "" : "NaN";
      text += (c > 0 ? sep : "") + number;
    }
    if (roll(10) == 0) put("# a remark");
    file.rows.push_back(row), file.lines.push_back(line);
    put(text);
  }
  return file;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

TEST_CASE("random tables are read right; damaged ones are read right where they are whole, or refused", "[table]") {
  const int memory = memfd_create("table", 0);  // a file that costs no disk
  REQUIRE(memory >= 0);
  const std::filesystem::path path = fmt::format("/proc/self/fd/{}", memory);
  std::mt19937 dice(1);
  int refused = 0, damaged_files = 0;
  for (int k = 0; k < 10000; ++k) {
    auto file = random_table(dice);
    const bool damages = k % 3 > 0, in_head = k % 6 == 1;
    std::size_t from = file.content.size(), to = from;  // bytes that differ from what was meant
    const auto whole = file.content;
    if (damages) {
      const std::string bytes = ",;\t .-+eE0159\"#%\nxN\r\0\xff";
      from = in_head ? dice() % file.body : file.body + dice() % (file.content.size() - file.body);
      const auto byte = bytes[dice() % bytes.size()];
      to = from + 1;
      if (const auto kind = dice() % 4; kind == 0)
        file.content[from] = byte;
      else if (kind == 1)
        file.content.erase(from, 1);
      else if (kind == 2)
        file.content.insert(from, 1, byte);
      else
        file.content.resize(from), to = whole.size();
      ++damaged_files;
    }
    REQUIRE(ftruncate(memory, 0) == 0);
    REQUIRE(pwrite(memory, file.content.data(), file.content.size(), 0) == long(file.content.size()));
    INFO(file.content);
    try {
      const auto read = table(path);
      if (in_head) {  // other names and units are as good as these, the rows are the same
        CHECK(std::ranges::equal(read.rows, file.rows,
                                 [](const auto& a, const auto& b) { return std::ranges::equal(a, b, same); }));
        continue;
      }
      // rows before the damaged line stand in their lines, rows behind it keep their order
      const auto damaged_line =
          1 + std::count(whole.begin(), whole.begin() + std::ptrdiff_t(std::min(from, whole.size())), '\n');
      const auto behind = std::count(whole.begin() + std::ptrdiff_t(std::min(to, whole.size())), whole.end(), '\n');
      const auto agree = [&](std::size_t a, std::size_t b) {
        return a < read.rows.size() && b < file.rows.size() && std::ranges::equal(read.rows[a], file.rows[b], same);
      };
      bool right = true;
      std::size_t i = 0;
      for (; i < file.rows.size() && file.lines[i] < damaged_line; ++i)
        right &= agree(i, i) && read.lines[i] == file.lines[i];
      for (std::size_t j = 1; j + 2 <= file.rows.size() - i && behind > 0; ++j)
        right &= agree(read.rows.size() - j, file.rows.size() - j);
      CHECK(right);
    } catch (const InputError& error) {
      CHECK_THAT(error.what(), Catch::StartsWith(path.string() + ":"));
      CHECK(damages);
      ++refused;
    }
  }
  close(memory);
  CHECK(refused > damaged_files / 10);
}

TEST_CASE("times of day are seconds, with and without a date", "[table]") {
  for (const char* content :
       {"time,v\n12:30:01.5,1\n12:30:02,2\n", "time;v\n12:30:01,5;1\n12:30:02,0;2\n",
        "time (hh:mm:ss)\tv\n12:30:01.5\t1\n12:30:02\t2\n", "time v\n12:30:01.5 1\n12:30:02 2\n"}) {
    INFO(content);
    const auto read = text(content);
    CHECK(read.rows == Rows{{45001.5, 1}, {45002, 2}});
    CHECK(read.head.columns[0].unit == "s");
  }
  // 2024-02-29 is day 19782 since 1970
  CHECK(text("t,v\n2024-02-29T23:59:59Z,1\n2024-03-01 00:00:00.25,2\n").rows ==
        Rows{{19783.0 * 86400 - 1, 1}, {19783.0 * 86400 + 0.25, 2}});
  CHECK(std::isnan(text("t,v\n12:30:01,1\n,2\n").rows[1][0]));
  for (const char* bad : {"t,v\n12:30:01,1\n12:60:00,2\n", "t,v\n12:30:01,1\n5,2\n", "t,v\n1,1\n12:30:01,2\n",
                          "t,v\n2023-02-29T12:30:01,1\n2023-03-01T12:30:01,1\n", "t,v\n12:30,1\n12:31,1\n"}) {
    INFO(bad);
    CHECK_THROWS_AS(text(bad), InputError);
  }
  CHECK_THROWS_WITH(text("t (mm),v\n12:30:01,1\n12:30:02,1\n"), Contains("t.csv:1") && Contains("times of day"));
}
