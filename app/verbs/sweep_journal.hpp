/// The finished values of a sweep kept on disk while it is computed.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/planes/sweep.hpp"
#include "app/verbs/journal.hpp"

namespace rosin::app::verbs {

/// One record a value and direction: where the motion ended, so that the next value goes on from there, and what was
/// recorded.
class SweepJournal {
 public:
  /// Of so many values, with so many columns, or these metrics. \throws InputError as Journal does.
  SweepJournal(const std::filesystem::path&, const std::string& key, std::size_t values, std::size_t columns,
               std::vector<analysis::planes::PlaneMetric> metrics);
  std::optional<analysis::planes::SweepPoint> known(bool up, std::size_t value) const;
  std::size_t known_count() const { return known_; }
  const std::string& lost() const { return journal_.lost(); }
  void append(bool up, std::size_t value, const analysis::planes::SweepPoint&);
  void remove() { journal_.remove(); }

 private:
  Journal::Taken take(std::string_view content, std::size_t begin);

  std::size_t values_, columns_;
  std::vector<analysis::planes::PlaneMetric> metrics_;
  std::vector<std::optional<analysis::planes::SweepPoint>> points_;  ///< upwards, then downwards
  std::size_t known_ = 0;
  Journal journal_;
};

}  // namespace rosin::app::verbs
