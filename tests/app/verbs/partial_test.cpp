/// The journal of a map: what it takes over, and what it leaves alone or says that it loses.
#include "app/verbs/partial.hpp"

#include <catch2/catch.hpp>
#include <cstring>

#include "analysis/planes/map.hpp"
#include "analysis/planes/map_point.hpp"
#include "core/error.hpp"
#include "core/files.hpp"
#include "tests/app/folder.hpp"

using namespace rosin;
using namespace rosin::app;
using Catch::Matchers::Contains;
using rosin::tests::content;
using rosin::tests::Folder;

namespace {

namespace fs = std::filesystem;
const auto metrics = analysis::planes::metrics_of_slider({"period"});

/// A journal with three of four points.
fs::path journal(const Folder& folder) {
  const auto path = folder.path / "map.partial";
  std::vector<analysis::planes::MapPoint> points(4, analysis::planes::undecided_point());
  for (std::size_t i = 0; i < 3; ++i) {
    points[i].done = true;
    points[i].regime = analysis::planes::Regime::cycle;
    points[i].metrics.period = 1.0 + double(i), points[i].error.period = 1e-9;
  }
  verbs::Partial partial(path, "key", 4, metrics);
  const std::size_t written[] = {0, 1, 2};
  partial.append(written, points);
  return path;
}

/// Replaces bytes of the last record, counted from its checksum, and signs it anew.
void forge(const fs::path& path, std::size_t at, const void* bytes, std::size_t length) {
  auto text = content(path);
  constexpr std::size_t record = 24 + 2 * sizeof(double);
  const auto begin = text.size() - record;
  std::memcpy(text.data() + begin + at, bytes, length);
  const auto sum = checksum(std::string_view(text).substr(begin + 8));
  std::memcpy(text.data() + begin, &sum, sizeof sum);
  write_whole(path, text);
}

}  // namespace

TEST_CASE("a journal gives back its points, and no point to a map of other settings", "[partial]") {
  const Folder folder;
  const auto path = journal(folder);
  {
    const verbs::Partial again(path, "key", 4, metrics);
    CHECK(again.known_count() == 3);
    CHECK(again.known(1)->metrics.period == 2);
    CHECK(again.lost().empty());
  }
  const verbs::Partial other(path, "another key", 4, metrics);
  CHECK(other.known_count() == 0);
  CHECK_THAT(other.lost(), Contains("began another map"));
}

TEST_CASE("forged and damaged records are dropped, and that is said", "[partial]") {
  const std::uint64_t far = 1'000'000;
  const std::uint8_t no_regime = 9;
  const double endless = INFINITY, negative = -1;
  struct Forgery {
    std::size_t at;
    const void* bytes;
    std::size_t length;
  };
  for (const auto& [at, bytes, length] :
       {Forgery{8, &far, 8}, {20, &no_regime, 1}, {21, &no_regime, 1}, {24, &endless, 8}, {32, &negative, 8}}) {
    const Folder folder;
    const auto path = journal(folder);
    forge(path, at, bytes, length);
    const verbs::Partial again(path, "key", 4, metrics);
    INFO(at);
    CHECK(again.known_count() == 2);
    CHECK_THAT(again.lost(), Contains("damaged after 2 whole records"));
  }
  const Folder folder;
  const auto path = journal(folder);
  std::ofstream(path, std::ios::app | std::ios::binary) << "torn record";
  CHECK_THAT(verbs::Partial(path, "key", 4, metrics).lost(), Contains("damaged after 3 whole records"));
}

TEST_CASE("what is no journal is refused and left as it is", "[partial]") {
  const Folder folder;
  write_whole(folder.path / "notes.txt", "my notes");
  CHECK_THROWS_WITH(verbs::Partial(folder.path / "notes.txt", "key", 4, metrics),
                    Contains("is not the journal of a map"));
  fs::create_symlink("notes.txt", folder.path / "map.partial");
  CHECK_THROWS_WITH(verbs::Partial(folder.path / "map.partial", "key", 4, metrics), Contains("is a link"));
  CHECK(content(folder.path / "notes.txt") == "my notes");
  CHECK_THROWS_AS(verbs::Partial(folder.path, "key", 4, metrics), InputError);
}
