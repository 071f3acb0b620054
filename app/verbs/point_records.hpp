/// Points of a plane, and what its parts took, as bytes: in journals, and between processes.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "analysis/planes/map.hpp"
#include "analysis/planes/parts.hpp"
#include "app/verbs/records.hpp"

namespace rosin::app::verbs {

/// How one plane's records look: each has its checksum; metrics and the reason of a failure follow.
class RecordForm {
 public:
  /// `metrics`: those that are kept of each of so many points.
  RecordForm(std::vector<analysis::planes::PlaneMetric> metrics, std::size_t points);

  void append(std::string& bytes, std::size_t index, const analysis::planes::MapPoint&) const;
  void append(std::string& bytes, const analysis::planes::PartCost&) const;

  /// The record that some bytes begin with.
  struct Found {
    std::size_t length = 0;                          ///< 0: none that such a plane writes
    std::size_t index = 0;                           ///< of the point
    std::optional<analysis::planes::PartCost> cost;  ///< it is of a part, not of a point
  };
  Found find(std::string_view bytes) const;
  /// The point of a record that was found.
  analysis::planes::MapPoint point(std::string_view record) const;

 private:
  Record record(std::string_view bytes) const;
  std::vector<analysis::planes::PlaneMetric> metrics_;
  std::size_t points_;
};

/// Whether regime and origin are such as points have.
bool known_regime(const Record&);
/// The point whose metrics, and behind them their errors, are the numbers of a record from `first` on.
analysis::planes::MapPoint point_of(const Record&, const std::vector<analysis::planes::PlaneMetric>&,
                                    std::size_t first);

/// What journals know of a plane.
class KnownPoints {
 public:
  explicit KnownPoints(RecordForm form) : form_(std::move(form)) {}
  /// Takes over the whole records of a journal from `begin` on. \returns where they end. `path`: for what is said.
  /// \throws InputError for a point that another journal has with other numbers, if these are `to_agree`.
  std::size_t take(std::string content, std::size_t begin, const std::filesystem::path& path, bool to_agree);
  std::optional<analysis::planes::MapPoint> point(std::size_t index) const;
  bool has(std::size_t index) const { return places_.contains(index); }
  std::size_t count() const { return places_.size(); }
  /// Processor time (s) of parts.
  const std::map<std::size_t, double>& costs() const { return costs_; }
  const RecordForm& form() const { return form_; }

 private:
  struct Journal {
    std::filesystem::path path;
    std::string content;
  };
  struct Place {
    std::uint32_t journal, length;
    std::size_t begin;
  };
  std::string_view record(const Place&) const;

  RecordForm form_;
  std::vector<Journal> journals_;
  std::unordered_map<std::size_t, Place> places_;
  std::map<std::size_t, double> costs_;
};

}  // namespace rosin::app::verbs
