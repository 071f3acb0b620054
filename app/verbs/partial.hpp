/// The finished points of a map kept on disk while it is computed, so that an interrupted map goes on where it stopped.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "analysis/planes/map.hpp"

namespace rosin::app::verbs {

/// A journal: a header (everything that determines the result), then one record a point with its checksum.
class Partial {
 public:
  /// Takes over the records of an earlier run with the same key, up to the first damaged one; else starts afresh.
  /// `metrics`: those that are kept. \throws InputError if another process is computing into the same file,
  /// and if what stands there is no journal, which is left as it is.
  Partial(std::filesystem::path path, const std::string& key, std::size_t points,
          const std::vector<analysis::planes::PlaneMetric>& metrics);
  ~Partial();
  Partial(const Partial&) = delete;

  /// The point as an earlier run left it, or nullptr.
  const analysis::planes::MapPoint* known(std::size_t index) const;
  std::size_t known_count() const { return known_.size(); }
  /// What is not taken over of the journal that was there, and why; empty if nothing is lost.
  const std::string& lost() const { return lost_; }
  /// Appends some of the points; they survive the end of the process from here on.
  void append(std::span<const std::size_t> indices, const std::vector<analysis::planes::MapPoint>& points);
  /// The map is written elsewhere: the journal is not needed any more.
  void remove();

 private:
  std::size_t take(std::string_view bytes, std::size_t points);

  std::filesystem::path path_;
  int file_;
  std::vector<analysis::planes::PlaneMetric> kept_;
  std::unordered_map<std::size_t, analysis::planes::MapPoint> known_;
  std::string lost_;
};

}  // namespace rosin::app::verbs
