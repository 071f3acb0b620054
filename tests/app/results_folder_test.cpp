/// Nothing of a results folder is believed or followed, and one process at a time writes it.
#include "core/results_folder.hpp"

#include <sys/file.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

namespace fs = std::filesystem;

namespace {

const std::string stick_slip = ROSIN_SOURCE_DIR "/examples/coulomb-stick-slip.toml";

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// A document of rosin's with one more entry.
void add(const fs::path& path, const std::string& entry) {
  auto text = content(path);
  text.resize(text.rfind('}'));
  write(path, text + ", " + entry + "}");
}

std::string deep() { return "\"more\": " + std::string(100'000, '[') + std::string(100'000, ']'); }

}  // namespace

TEST_CASE("a report leaves out links, pipes, and pictures that are none, and says so", "[results]") {
  const Folder folder;
  REQUIRE(run_rosin(folder, "curve '" + stick_slip + "' --no-pictures --out o").status == 0);
  const auto o = folder.path / "o";
  write(folder.path / "secret.txt", "TOP SECRET KEY");
  auto manifest = nlohmann::json::parse(content(o / "curve.manifest.json"));
  manifest["verb"] = "study", manifest["files"] = {"leak.png", "fake.png"};
  write(o / "study.manifest.json", manifest.dump());
  write(o / "study.json", manifest.dump());
  fs::create_symlink("../secret.txt", o / "leak.png");
  write(o / "fake.png", "TOP SECRET KEY");
  REQUIRE(mkfifo((o / "run.json").c_str(), 0600) == 0);
  write(o / "run.manifest.json", manifest.dump());
  fs::create_symlink("../secret.txt", o / "cycle.manifest.json");
  fs::create_symlink("../secret.txt", o / "cycle.csv");
  const auto report = run_rosin(folder, "report o");
  CHECK(report.status == 0);
  for (const char* note : {"leak.png is a link", "fake.png is no PNG", "run.json is no regular file",
                           "cycle.manifest.json is a link", "cycle.csv is a link"})
    CHECK_THAT(report.error, Contains(std::string("note: o/") + note));
  CHECK(content(o / "report.html").find("VE9QIFNFQ1JFV") == std::string::npos);
  // Nor does an export open what a link names, or a pipe.
  CHECK(run_rosin(folder, "export o --as qdyn").status == 2);
  fs::remove(o / "run.json");
  fs::create_symlink("../secret.txt", o / "run.json");
  CHECK_THAT(run_rosin(folder, "export o --as qdyn").error, Contains("run.json: is a link"));
}

TEST_CASE("documents that lie too deep are refused, and never cost a new result", "[results]") {
  const Folder folder;
  REQUIRE(run_rosin(folder, "curve '" + stick_slip + "' --no-pictures --out o").status == 0);
  add(folder.path / "o/curve.json", deep());
  const auto report = run_rosin(folder, "report o");
  CHECK(report.status == 2);
  CHECK_THAT(report.error, Contains("o/curve.json: lies more than 100 levels deep"));
  add(folder.path / "o/curve.manifest.json", deep());
  const auto again = run_rosin(folder, "curve '" + stick_slip + "' --no-pictures --out o --set law.mu_d=0.2");
  CHECK(again.status == 0);
  CHECK_THAT(again.error, Contains("curve.manifest.json: lies more than 100 levels deep"));
  CHECK(run_rosin(folder, "report o").status == 0);
}

TEST_CASE("shares that no plane has are taken for no journal", "[results]") {
  const Folder folder;
  const std::string plane = "'" ROSIN_SOURCE_DIR
                            "/examples/bristol-board-plane.toml' --exact --tolerance 1e-2 --set map.x.points=9 "
                            "--set map.y.points=3 --no-pictures ";
  write(folder.path / "map.1-of-2.partial", "rosin map, 0 bytes of key\n\n");
  for (const char* share : {"1-of-0", "0-of-0", "1-of--5", "1-of-2147483647", "1-of-99999999999", "3-of-2"}) {
    const auto o = folder.path / "o";
    fs::create_directories(o);
    fs::rename(folder.path / "map.1-of-2.partial", o / (std::string("map.") + share + ".partial"));
    const auto merged = run_rosin(folder, "merge " + plane + "--out o");
    CAPTURE(share, merged.error);
    CHECK(merged.status == 2);
    CHECK_THAT(merged.error, Contains("27 of 27 points are missing in no journal of a map"));
    fs::rename(o / (std::string("map.") + share + ".partial"), folder.path / "map.1-of-2.partial");
  }
  CHECK_THAT(run_rosin(folder, "map " + plane + "--out o --shard 1/99999999999").error,
             Contains("--shard 1/99999999999: must be K/N"));
}

TEST_CASE("one process at a time writes a folder", "[results]") {
  const Folder folder;
  const auto o = folder.path / "o";
  fs::create_directories(o);
  {
    const rosin::FolderClaim claim(o);
    const auto second = run_rosin(folder, "curve '" + stick_slip + "' --no-pictures --out o");
    CHECK(second.status == 2);
    CHECK_THAT(second.error, Contains("another rosin writes into o; use another --out"));
    CHECK(fs::is_empty(o));
  }
  CHECK(run_rosin(folder, "curve '" + stick_slip + "' --no-pictures --out o").status == 0);
}
