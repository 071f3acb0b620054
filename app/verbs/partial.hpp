/// The finished points of a map kept on disk while it is computed, so that an interrupted map goes on where it stopped,
/// and shares of a map that several processes compute are put together.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/planes/map.hpp"
#include "app/verbs/journal.hpp"
#include "app/verbs/point_records.hpp"

namespace rosin::app::verbs {

/// "map.partial", or of a share "map.2-of-8.partial".
std::string journal_name(analysis::planes::Share);
/// "2/8", with 1 <= K <= N <= parts; nothing for any other text.
std::optional<analysis::planes::Share> share_of(std::string_view text, std::string_view between, std::size_t parts);
/// The share of a plane of so many parts that a journal of such a name holds; nothing for any other name.
std::optional<analysis::planes::Share> share_of_journal(const std::string& name, std::size_t parts);

/// The journal of a map: one record a point.
class Partial {
 public:
  /// Takes over the records of an earlier run with the same key, up to the first damaged one; else starts afresh.
  /// `metrics`: those that are kept. \throws InputError if another process is computing into the same file,
  /// and if what stands there is no journal, which is left as it is.
  Partial(std::filesystem::path path, const std::string& key, std::size_t points,
          const std::vector<analysis::planes::PlaneMetric>& metrics);

  /// The point as an earlier run left it, or nothing.
  std::optional<analysis::planes::MapPoint> known(std::size_t index) const { return known_.point(index); }
  std::size_t known_count() const { return known_.count(); }
  /// What is not taken over of the journal that was there, and why; empty if nothing is lost.
  const std::string& lost() const { return journal_.lost(); }
  /// Appends some of the points; they survive the end of the process from here on.
  void append(std::span<const std::size_t> indices, const std::vector<analysis::planes::MapPoint>& points);
  void append(const std::vector<analysis::planes::PartCost>&);
  /// The map is written elsewhere: the journal is not needed any more.
  void remove() { journal_.remove(); }

 private:
  KnownPoints known_;
  Journal journal_;
};

/// Takes over a journal as it stands on disk, be it finished or not, and leaves it alone. \throws InputError if it
/// is of a map with another key, and says what differs.
void read_journal(const std::filesystem::path&, const std::string& key, KnownPoints&);

}  // namespace rosin::app::verbs
