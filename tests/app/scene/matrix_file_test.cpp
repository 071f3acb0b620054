/// Matrices out of files are those of the rows in a scene; damaged files are refused with their line.
#include "app/scene/matrix_file.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "tests/app/command.hpp"
#include "tests/app/scene_of.hpp"

using Catch::Matchers::Contains;
using rosin::InputError;
using rosin::tests::Folder;

namespace {

/// A structure with this K, where M is a table in a file.
std::string scene(const std::string& K) {
  return "[law]\ntype = 'coulomb'\nmu_s = 2\nmu_d = 0.3\n[oscillator]\ntype = 'structure'\nM = 'M.csv'\nK = " + K +
         "\ncontacts = [{ tangential = [1, 0], normal = [0, 1], normal_contact = { stiffness = 3e7 } }]\n"
         "[drive]\nspeed = 1\nnormal_load = 1e3\n"
         "[stability]\nscan = { parameter = 'law.mu_d', from = 0, to = 0.6, points = 121 }\n";
}
Eigen::MatrixXd stiffness(const Folder& folder, const std::string& content, const std::string& name = "K.mtx",
                          const std::string& value = "'K.mtx'") {
  std::ofstream(folder.path / "M.csv") << "1,0\n0,1\n";
  std::ofstream(folder.path / name) << content;
  std::ofstream(folder.path / "scene.toml") << scene(value);
  return rosin::tests::scene_of((folder.path / "scene.toml").string(), {}, "stability").structure->structure.K;
}

const std::string head = "%%MatrixMarket matrix coordinate real symmetric\n% of a brake\n\n";

}  // namespace

TEST_CASE("tables and Matrix Market files of any storage are the matrix that they store", "[scene][matrix]") {
  const Folder folder;
  Eigen::Matrix2d K;
  K << 5.2e7, 1e7, 1e7, 2e7;
  CHECK(stiffness(folder, head + "2 2 3\n1 1 5.2e7\n2 1 1e7\n2 2 2e7\n") == K);
  CHECK(stiffness(folder, "%%MatrixMarket matrix array integer symmetric\n2 2\n52000000\n10000000\n20000000\n") == K);
  CHECK(stiffness(folder, "%%MatrixMarket matrix array real general\n2 2\n5.2e7\n1e7\n1e7\n2e7\n") == K);
  CHECK(stiffness(folder, "5.2e7,1e7\n1e7,2e7\n", "K.csv", "'K.csv'") == K);
  CHECK(stiffness(folder, "5,2e7;1e7\n1e7;2e7\n", "K.csv", "'K.csv'") == K);
  CHECK(stiffness(folder, "5.2e4 1e4\n1e4 2e4 # N/mm\n", "K.txt", "{ file = 'K.txt', unit = 'N/mm' }") == K);
  K << 5.2e7, 0, 1e7, 0;
  CHECK(stiffness(folder, "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 5.2e7\n2 1 1e7\n") == K);
  K << 0, -1e7, 1e7, 0;
  CHECK(stiffness(folder, "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 1e7\n") == K);
}

TEST_CASE("files that are no square matrix are refused with their line", "[scene][matrix]") {
  const Folder folder;
  struct Bad {
    std::string content, why;
  };
  for (const auto& [content, why] :
       {Bad{"", "K.mtx:1:"},
        {"1,0\n0,1\n", "K.mtx:1: is no head"},
        {"%%MatrixMarket matrix coordinate complex symmetric\n2 2 0\n", "K.mtx:1: holds entries that are complex"},
        {"%%MatrixMarket matrix coordinate real hermitian\n2 2 0\n", "K.mtx:1: says 'hermitian'"},
        {head + "2 3 0\n", "K.mtx:4: is not square: 2 rows, 3 columns"},
        {head + "3 3 0\n", "oscillator.K has 3 rows, but M has 2"},
        {head + "2 2 2\n1 1 1\n", "the file ends before entry 2 of 2"},
        {head + "2 2 1\n1 2 1\n", "K.mtx:5: the entry (1, 2) is not below the diagonal"},
        {head + "2 2 2\n1 1 1\n1 1 2\n", "K.mtx:6: gives the entry (1, 1) again"},
        {head + "2 2 1\n3 1 1\n", "K.mtx:5: row = 3 is not a whole number from 1 to 2"},
        {head + "2 2 1\n1 1 nan\n", "K.mtx:5: 'nan' is no finite number"},
        {head + "2 2 1\n1 1 1e16\n", "outside"},
        {head + "2 2 1\n1 1\n", "K.mtx:5: holds 2 numbers"},
        {head + "2 2 1\n1 1 1\n2 2 1\n", "K.mtx:6: stands behind the last entry"},
        {head + "1e9 1e9 0\n", "rows = 1000000000 is not a whole number from 1 to 4000"}}) {
    INFO(content);
    CHECK_THROWS_WITH(stiffness(folder, content), Contains(why));
  }
  CHECK_THROWS_WITH(stiffness(folder, "1,2\n", "K.csv", "'K.csv'"), Contains("is not square: 1 rows of 2 numbers"));
  CHECK_THROWS_WITH(stiffness(folder, "a,b\n1,2\n3,4\n", "K.csv", "'K.csv'"), Contains("K.csv:1: names stand"));
  CHECK_THROWS_WITH(stiffness(folder, "1,2\n,4\n", "K.csv", "'K.csv'"), Contains("K.csv:2: the number of column 1"));
  CHECK_THROWS_WITH(stiffness(folder, "1,2\n3,4\n", "K.csv", "'none.csv'"), Contains("none.csv"));
  CHECK_THROWS_WITH(stiffness(folder, "1,2\n3,4\n", "K.csv", "{ file = 'K.csv', unit = 'kg' }"), Contains("N/m"));
}

TEST_CASE("mode coupling of matrices out of files sets in at its closed form", "[scene][matrix]") {
  // Friction makes 1e7 of K(1, 2) into 1e7 - 3e7 mu; roots merge where (5.2e7 - 5e7)^2/4 + 1e7 (1e7 - 3e7 mu) = 0.
  const Folder folder;
  stiffness(folder, head + "2 2 3\n1 1 5.2e7\n2 1 1e7\n2 2 2e7\n");
  const auto ran = rosin::tests::run_rosin(folder, "stability scene.toml --json --no-pictures");
  REQUIRE(ran.status == 0);
  const auto found = nlohmann::json::parse(ran.out)["thresholds"];
  REQUIRE(found.size() == 1);
  CHECK(found[0]["value"].get<double>() == Approx(1.01 / 3).epsilon(1e-9));
}
