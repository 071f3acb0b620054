/// Ranks that compute a plane together, with letters carried within this process.
#include "app/verbs/ranks.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <mutex>
#include <thread>

#include "core/error.hpp"
#include "core/stop.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::app::verbs;
using namespace rosin::analysis::planes;
using Catch::Matchers::Contains;
using rosin::tests::bristol_board;

namespace {

/// Letter boxes of several ranks.
struct PostOffice {
  std::mutex mutex;
  std::vector<std::deque<Letter>> boxes;
};

class LocalMail : public Mail {
 public:
  LocalMail(PostOffice& office, int rank) : office_(office), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return int(office_.boxes.size()); }
  std::string machine() const override { return "here"; }
  void send(int to, int kind, std::string_view text) override {
    const std::scoped_lock lock(office_.mutex);
    office_.boxes[std::size_t(to)].push_back({rank_, kind, std::string(text)});
  }
  std::optional<Letter> receive() override {
    const std::scoped_lock lock(office_.mutex);
    auto& box = office_.boxes[std::size_t(rank_)];
    if (box.empty()) return std::nullopt;
    Letter letter = std::move(box.front());
    box.pop_front();
    return letter;
  }
  void leave() override {}
  [[noreturn]] void end_all(int) override { std::abort(); }

 private:
  PostOffice& office_;
  int rank_;
};

MapOptions small_plane() {
  MapOptions options;
  options.x = make_axis("drive.normal_load", 9.81e-8, 9.81, 34, true, {});
  options.y = make_axis("law.lambda", 1e-4, 1e2, 34, true, {0, 1e-5});
  options.metrics = {"stick_fraction"};
  options.tolerance = 1e-3;
  options.exact = true;
  return options;
}

RecordForm form() { return {metrics_of_slider(small_plane().metrics), 34 * 36}; }

/// Calls f(ranks) for each of three ranks, rank 0 in this thread.
template <class F>
void together(F f) {
  PostOffice office;
  office.boxes.resize(3);
  std::vector<std::jthread> others;
  for (int rank = 1; rank < 3; ++rank)
    others.emplace_back([&, rank] {
      Ranks ranks(std::make_unique<LocalMail>(office, rank));
      f(ranks, rank);
    });
  Ranks ranks(std::make_unique<LocalMail>(office, 0));
  f(ranks, 0);
}

}  // namespace

TEST_CASE("three ranks find what one process finds, and compute nothing twice", "[ranks]") {
  const auto model = bristol_board(1e-4, 10);
  const Map alone = compute_map(model, small_plane());
  std::array<std::atomic<int>, 3> computed{};
  Map found;
  together([&](Ranks& ranks, int rank) {
    ranks.begin("key", form());
    struct Counting : Crew {  // the groups that a rank has computed
      Counting(Crew& c, std::atomic<int>& n) : crew(c), number(n) {}
      bool leads() const override { return crew.leads(); }
      int processes() const override { return crew.processes(); }
      void work(Queue& whole, int threads, const std::function<void(Queue&)>& compute) override {
        crew.work(whole, threads, [&](Queue& queue) {
          struct Counted : Queue {
            Counted(Queue& q, std::atomic<int>& n) : queue(q), number(n) {}
            Group next() override {
              Group group = queue.next();
              number += !group.parts.empty();
              return group;
            }
            void take(Report report) override { queue.take(std::move(report)); }
            Queue& queue;
            std::atomic<int>& number;
          } counted(queue, number);
          compute(counted);
        });
      }
      Crew& crew;
      std::atomic<int>& number;
    } crew(ranks, computed[std::size_t(rank)]);
    MapHooks hooks;
    hooks.crew = &crew;
    Map map = compute_map(model, small_plane(), hooks);
    if (rank == 0) found = std::move(map);
  });
  REQUIRE(found.points.size() == alone.points.size());
  for (std::size_t i = 0; i < alone.points.size(); ++i) {
    CHECK(found.points[i].regime == alone.points[i].regime);
    CHECK(found.points[i].origin == alone.points[i].origin);
    const double a = alone.points[i].metrics.stick_fraction, b = found.points[i].metrics.stick_fraction;
    CHECK((a == b || (std::isnan(a) && std::isnan(b))));
  }
  CHECK(found.notes == alone.notes);
  CHECK(computed[0] + computed[1] + computed[2] == 8);  // parts, so few that each is a group
}

TEST_CASE("ranks of different scenes are told apart, and what fails at one is said by rank 0", "[ranks]") {
  const auto model = bristol_board(1e-4, 10);
  std::string why;
  const auto compute = [&](Ranks& ranks, int rank, const char* key) {
    ranks.begin(key, form());
    MapHooks hooks;
    hooks.crew = &ranks;
    try {
      compute_map(model, small_plane(), hooks);
    } catch (const InputError& error) {
      if (rank == 0) why = error.what();
    }
  };
  together([&](Ranks& ranks, int rank) { compute(ranks, rank, rank == 2 ? "another key" : "key"); });
  CHECK_THAT(why, Contains("rank 2 on here has another scene"));
  together([&](Ranks& ranks, int rank) {
    if (rank == 1) return ranks.fail("scene.toml: no such file");
    compute(ranks, rank, "key");
  });
  CHECK_THAT(why, Contains("rank 1 on here: scene.toml: no such file"));
}

TEST_CASE("a stop of rank 0 ends the others, and nothing that they finished is lost", "[ranks]") {
  const auto model = bristol_board(1e-4, 10);
  std::size_t kept = 0;
  together([&](Ranks& ranks, int rank) {
    ranks.begin("key", form());
    std::stop_source stop;
    MapHooks hooks;
    hooks.crew = &ranks;
    hooks.finished = [&](auto indices, const auto&) {
      kept += indices.size();
      stop.request_stop();
    };
    const Listening listening(rank == 0 ? stop.get_token() : std::stop_token());
    const Map map = compute_map(model, small_plane(), hooks);
    CHECK((rank != 0 || map.outcome.ending == Ending::interrupted));
    if (rank == 0) CHECK(std::size_t(std::ranges::count_if(map.points, &MapPoint::done)) == kept);
  });
  CHECK(kept > 0);
}
