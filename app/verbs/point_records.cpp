/// Writing and reading records of points.
#include "app/verbs/point_records.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/planes/map.hpp"
#include "app/verbs/records.hpp"
#include "core/error.hpp"

namespace rosin::app::verbs {

using analysis::planes::MapPoint;
using analysis::planes::PartCost;
using Kind = Record::Kind;

RecordForm::RecordForm(std::vector<analysis::planes::PlaneMetric> metrics, std::size_t points)
    : metrics_(std::move(metrics)), points_(points) {}

void RecordForm::append(std::string& bytes, std::size_t index, const MapPoint& point) const {
  RecordWriter writer(bytes, Kind::point, index, static_cast<std::uint8_t>(point.regime),
                      static_cast<std::uint8_t>(point.origin));
  for (const auto& metric : metrics_) writer.number(metric.value(point));
  for (const auto& metric : metrics_) writer.number(metric.error(point));
  writer.finish(point.why);
}

void RecordForm::append(std::string& bytes, const PartCost& cost) const {
  RecordWriter writer(bytes, Kind::cost, cost.part);
  writer.number(cost.seconds);
  writer.finish();
}

Record RecordForm::record(std::string_view bytes) const {
  return record_at(bytes, [this](const Record& head, std::string_view) -> std::optional<std::size_t> {
    if (head.kind > Kind::cost || head.index >= points_ || !known_regime(head)) return std::nullopt;
    return head.kind == Kind::point ? 2 * metrics_.size() : 1;
  });
}

RecordForm::Found RecordForm::find(std::string_view bytes) const {
  const auto found = record(bytes);
  if (found.length == 0) return {};
  if (found.kind == Kind::cost) {
    if (!(found.number(0) >= 0) || std::isinf(found.number(0))) return {};
    return {found.length, 0, PartCost{found.index, found.number(0)}};
  }
  for (std::size_t k = 0; k < metrics_.size(); ++k)
    if (std::isinf(found.number(k)) || found.number(metrics_.size() + k) < 0) return {};
  return {found.length, found.index, {}};
}

MapPoint RecordForm::point(std::string_view bytes) const {
  const auto found = record(bytes);
  return point_of(found, metrics_, 0);
}

bool known_regime(const Record& record) {
  return record.regime <= static_cast<int>(analysis::planes::Regime::failed) &&
         record.origin <= static_cast<int>(analysis::planes::Origin::interpolated);
}

MapPoint point_of(const Record& record, const std::vector<analysis::planes::PlaneMetric>& metrics, std::size_t first) {
  MapPoint point = analysis::planes::undecided_point();
  point.done = true;
  point.regime = static_cast<analysis::planes::Regime>(record.regime);
  point.origin = static_cast<analysis::planes::Origin>(record.origin);
  std::size_t measures = 0;
  for (const auto& metric : metrics) measures += metric.member == nullptr;
  point.measures.resize(measures), point.measure_errors.resize(measures);
  for (const auto& metric : metrics) metric.value(point) = record.number(first++);
  for (const auto& metric : metrics) metric.error(point) = record.number(first++);
  point.why = std::string(record.text);
  return point;
}

std::size_t KnownPoints::take(std::string content, std::size_t begin, const std::filesystem::path& path,
                              bool to_agree) {
  const auto journal = static_cast<std::uint32_t>(journals_.size());
  journals_.push_back({path, std::move(content)});
  const std::string_view bytes = journals_.back().content;
  for (RecordForm::Found found; (found = form_.find(bytes.substr(begin))).length > 0; begin += found.length) {
    if (found.cost) {
      costs_.insert_or_assign(found.cost->part, found.cost->seconds);
    } else {
      const Place here{journal, static_cast<std::uint32_t>(found.length), begin};
      const auto [known, fresh] = places_.try_emplace(found.index, here);
      if (to_agree && !fresh && record(known->second) != record(here))
        throw InputError(
            fmt::format("{} and {} differ at point {}: they were computed by programs or on machines that round "
                        "differently; leave one of them away",
                        journals_[known->second.journal].path.string(), path.string(), found.index));
      known->second = here;
    }
  }
  return begin;
}

std::string_view KnownPoints::record(const Place& place) const {
  return std::string_view(journals_[place.journal].content).substr(place.begin, place.length);
}

std::optional<MapPoint> KnownPoints::point(std::size_t index) const {
  const auto it = places_.find(index);
  if (it == places_.end()) return std::nullopt;
  return form_.point(record(it->second));
}

}  // namespace rosin::app::verbs
