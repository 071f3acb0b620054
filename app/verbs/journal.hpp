/// What is finished of a long computation, kept on disk while it goes on, so that an interrupted one goes on where it
/// stopped.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/scene/scene.hpp"

namespace rosin::app::scene {
struct Scene;
}

namespace rosin::app::verbs {

inline constexpr std::uintmax_t largest_journal = 2'000'000'000;  ///< bytes

/// The first line of the journal of a verb, and everything that determines its result.
std::string journal_header(std::string_view verb, const std::string& key);
/// The same words that any journal of a verb begins with: "rosin map, ".
std::string journal_words(std::string_view verb);
/// Version, tolerance, the scene as resolved, the numbers of files that it names, and `how`, such as "exact": two runs
/// with the same have the same result.
std::string journal_key(const scene::Scene&, double tolerance, std::string_view how);

/// A header (everything that determines the result), then records with checksums.
class Journal {
 public:
  /// Takes the whole records over that stand in a journal from `begin` on, and says where they end and how many are.
  struct Taken {
    std::size_t end, count;
  };
  using Take = std::function<Taken(std::string content, std::size_t begin)>;
  /// Lets `take` have the records of an earlier run with the same key, up to the first damaged one; else starts afresh.
  /// \throws InputError if another process is computing into the same file, and if what stands there is no journal of
  /// the verb, which is left as it is.
  Journal(std::filesystem::path path, std::string_view verb, const std::string& key, const Take& take);
  ~Journal();
  Journal(const Journal&) = delete;

  /// What is not taken over of the journal that was there, and why; empty if nothing is lost.
  const std::string& lost() const { return lost_; }
  /// Whole records; they survive the end of the process from here on.
  void append(std::string_view records);
  /// The result is written elsewhere: the journal is not needed any more.
  void remove();

 private:
  std::filesystem::path path_;
  int file_;
  std::string lost_;
};

}  // namespace rosin::app::verbs
