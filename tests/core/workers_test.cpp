/// Work that threads share: what one of them throws reaches the caller, and a request to end reaches all of them.
#include "core/workers.hpp"

#include <catch2/catch.hpp>
#include <stdexcept>

using namespace rosin;

TEST_CASE("all of the work is done, in any number of threads", "[workers]") {
  for (const int threads : {1, 3, 8}) {
    std::vector<int> done(100, 0);
    in_parallel(threads, done.size(), [&](std::size_t k) { ++done[k]; });
    CHECK(done == std::vector<int>(100, 1));
  }
}

TEST_CASE("what a worker throws ends the others and reaches the caller", "[workers]") {
  for (const int threads : {1, 2, 4}) {
    std::atomic<int> begun = 0;
    CHECK_THROWS_WITH(in_parallel(threads, 1000,
                                  [&](std::size_t k) {
                                    ++begun;
                                    if (k == 3) throw std::runtime_error("the fourth");
                                    while (k > 3) end_if_stopped();  // for as long as nobody asks it to end
                                  }),
                      "the fourth");
    CHECK(begun <= 4 + threads);
  }
}

TEST_CASE("a stop reaches the threads that work for whoever is asked to stop", "[workers]") {
  std::stop_source stop;
  const Listening listening(stop.get_token());
  CHECK_THROWS_AS(in_parallel(3, 1000,
                              [&](std::size_t k) {
                                if (k == 5) stop.request_stop();
                                while (k >= 5) end_if_stopped();
                              }),
                  Stopped);
  CHECK(Listening::stop_asked());
  {
    const Listening to_nobody{std::stop_token()};  // leaves the one before
    CHECK(Listening::stop_asked());
    const Listening to_another(std::stop_source().get_token());
    CHECK_FALSE(Listening::stop_asked());
  }
  CHECK_THROWS_AS(end_if_stopped(), Stopped);
}
