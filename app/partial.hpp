/// The finished points of a map kept on disk while it is computed, so that an interrupted map goes on where it stopped.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/map.hpp"

namespace rosin::app {

/// A journal: a header (everything that determines the result), then one record a point with its checksum.
class Partial {
 public:
  /// Takes over the records of an earlier run with the same key, up to the first damaged one; else starts afresh.
  /// \throws InputError if another process is computing into the same file.
  Partial(std::filesystem::path path, const std::string& key, std::size_t points);
  ~Partial();
  Partial(const Partial&) = delete;

  /// The point as an earlier run left it, or nullptr.
  const analysis::MapPoint* known(std::size_t index) const;
  std::size_t known_count() const;
  /// Appends a point; it survives the end of the process from here on.
  void append(std::size_t index, const analysis::MapPoint& point);
  /// The map is written elsewhere: the journal is not needed any more.
  void remove();

 private:
  std::filesystem::path path_;
  int file_;
  std::vector<std::optional<analysis::MapPoint>> points_;
};

}  // namespace rosin::app
