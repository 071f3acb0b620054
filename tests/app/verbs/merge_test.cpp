/// Planes on many machines: shares that are merged, and processes of one launcher that are killed.
#include <signal.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using nlohmann::json;
using rosin::tests::content;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

namespace {

namespace fs = std::filesystem;

/// Six tiles of the plane of the examples.
const std::string plane = "'" ROSIN_SOURCE_DIR
                          "/examples/bristol-board-plane.toml' --set map.x.points=40 --set map.y.points=40 --set "
                          "map.y.extra=[0] --tolerance 1e-3 --exact --no-pictures ";

/// A document without what depends on the clock.
json timeless(const fs::path& path) {
  auto document = json::parse(content(path));
  document["cost"].erase("seconds");
  return document;
}

void check_same(const Folder& folder, const std::string& a, const std::string& b) {
  CHECK(content(folder.path / a / "map.nc") == content(folder.path / b / "map.nc"));
  CHECK(timeless(folder.path / a / "map.json") == timeless(folder.path / b / "map.json"));
}

/// A line of the shell in the folder, in which $ROSIN is the command.
int shell(const Folder& folder, const std::string& line) {
  const auto text = "cd '" + folder.path.string() + "' && ROSIN='" ROSIN_COMMAND "' && " + line;
  const int status = std::system(text.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace

TEST_CASE("four shares merged are the plane, byte for byte", "[merge]") {
  const Folder folder;
  REQUIRE(run_rosin(folder, "map " + plane + "--out whole").status == 0);
  for (const char* share : {"1/4", "2/4", "4/4"}) {
    const auto mapped = run_rosin(folder, "map " + plane + "--out parts --shard " + share);
    REQUIRE(mapped.status == 0);
    CHECK_THAT(mapped.out, Contains("rosin merge ") && Contains("--set map.x.points=40 ") &&
                               Contains(" --tolerance 0.001 --exact --out parts\n"));  // which finds the shares
  }
  CHECK(run_rosin(folder, "map " + plane + "--out parts --shard \"$NOT_SET\"").status == 2);
  const auto early = run_rosin(folder, "merge " + plane + "--out parts");
  CHECK(early.status == 2);
  CHECK_THAT(early.error, Contains("points are missing in 3 journals") && Contains("--exact --out parts --shard 3/4"));
  CHECK_THAT(early.error, !Contains("--shard 2/4"));
  CHECK_FALSE(fs::exists(folder.path / "parts/map.json"));
  REQUIRE(run_rosin(folder, "map " + plane + "--out elsewhere --shard 3/4").status == 0);  // with a disk of its own
  const auto merged = run_rosin(folder, "merge " + plane + "--out parts --from parts --from elsewhere");
  CHECK(merged.error.empty());
  REQUIRE(merged.status == 0);
  check_same(folder, "whole", "parts");
  CHECK(fs::exists(folder.path / "parts/map.2-of-4.partial"));

  const auto forecast = run_rosin(folder, "merge " + plane + "--out parts --forecast --json");
  REQUIRE(forecast.status == 0);
  const auto document = json::parse(forecast.out);
  CHECK(document["parts"] == 6);
  CHECK(document["computed"] < 6);  // the third share is elsewhere
  CHECK(document["forecast"][0]["efficiency"].get<double>() > 0.9);
  CHECK(document["forecast"][1]["seconds"].get<double>() >= document["longest"].get<double>());
}

TEST_CASE("a journal of another plane is refused, and what differs is said", "[merge]") {
  const Folder folder;
  REQUIRE(run_rosin(folder, "map " + plane + "--out parts --shard 1/2").status == 0);
  auto loose = plane;
  loose.replace(loose.find("1e-3"), 4, "1e-2");
  CHECK_THAT(
      run_rosin(folder, "merge " + loose + "--out parts").error,
      Contains("map.1-of-2.partial: is of another map: there stands \"tolerance 0.001\", here \"tolerance 0.01\""));
  CHECK_THAT(run_rosin(folder, "merge " + plane + "--out parts --set drive.speed=2e-5").error,
             Contains("is of another map") && Contains("drive.speed = 2e-05"));
  CHECK_THAT(run_rosin(folder, "merge " + plane + "--out nothing").error, Contains("in no journal of a map"));
  CHECK_THAT(run_rosin(folder, "map " + plane + "--out parts --shard 3/2").error, Contains("1 <= K <= N"));
  CHECK_THAT(run_rosin(folder, "map " + plane + "--out parts --shard 1/7").error, Contains("6 parts has no 7 shares"));
}

TEST_CASE("a job of a SLURM array computes its share, and says so", "[merge]") {
  const Folder folder;
  const std::string job = "SLURM_ARRAY_TASK_ID=5 SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_STEP=2 ";
  CHECK(shell(folder, job + "SLURM_ARRAY_TASK_COUNT=4 $ROSIN map " + plane + "--out parts 2>error.txt >out.txt") == 0);
  CHECK_THAT(content(folder.path / "error.txt"), Contains("--shard 3/4"));
  CHECK(fs::exists(folder.path / "parts/map.3-of-4.partial"));
  CHECK(shell(folder, job + "SLURM_ARRAY_TASK_COUNT=2 $ROSIN map " + plane + "--out parts 2>error.txt") == 2);
}

TEST_CASE("processes of a launcher compute the plane of one, also when they are killed", "[merge][mpi]") {
  const Folder folder;
  if (shell(folder, "command -v mpirun >/dev/null && ldd $ROSIN | grep -q libmpi") != 0) {
    WARN("no mpirun here, or a command without MPI: not tested");
    return;
  }
  const std::string launch =
      "mpirun --allow-run-as-root --oversubscribe --bind-to none -n 3 $ROSIN map " + plane + "--set map.x.points=130 ";
  const auto one = run_rosin(folder, "map " + plane + "--set map.x.points=130 --out one");
  REQUIRE(one.status == 0);
  // A rank is killed as soon as some points stand in the journal; then another.
  for (const char* rank : {"0", "2"})
    shell(folder, "(" + launch + "--out three >out.txt 2>error.txt & " +
                      "for k in $(seq 200); do sleep 0.02; s=$(stat -c %s three/map.partial 2>/dev/null || echo 0); " +
                      "[ $s -gt 20000 ] && break; done; " + "for p in $(pgrep -f \"^$ROSIN map .*--out three\"); do " +
                      "grep -qz ^OMPI_COMM_WORLD_RANK=" + rank + "$ /proc/$p/environ && kill -9 $p; done; wait)");
  CHECK(shell(folder, launch + "--out three >out.txt 2>error.txt") == 0);
  check_same(folder, "one", "three");
  CHECK_FALSE(fs::exists(folder.path / "three/map.partial"));
  const auto said = content(folder.path / "out.txt");
  CHECK(said.find(" x 41 points in ") == said.rfind(" x 41 points in "));  // by rank 0 alone
}
