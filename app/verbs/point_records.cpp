/// Writing and reading records of points.
#include "app/verbs/point_records.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <type_traits>

#include "core/error.hpp"
#include "core/files.hpp"

namespace rosin::app::verbs {

namespace {

using analysis::planes::MapPoint;
using analysis::planes::PartCost;

enum class Kind : std::uint8_t { point, cost };

/// A record as it stands in the file. Of a point its metrics, their errors and the reason of a failure follow, of a
/// part its time.
struct Record {
  std::uint64_t checksum;  ///< of everything after it
  std::uint64_t index;
  std::uint32_t reason_length;
  std::uint8_t regime, origin;
  Kind kind;
  std::uint8_t unused;
};
static_assert(std::is_trivially_copyable_v<Record>);

constexpr std::uint32_t longest_reason = 1000;

/// The checksummed part of a record.
std::string_view body(std::string_view bytes) { return bytes.substr(sizeof(Record::checksum)); }

void append_number(std::string& bytes, double number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// The record, whose rest stands behind `begin` of `bytes` already but for the head itself, is signed and put there.
void sign(std::string& bytes, std::size_t begin, Record& record) {
  std::memcpy(bytes.data() + begin, &record, sizeof record);
  record.checksum = checksum(body(std::string_view(bytes).substr(begin)));
  std::memcpy(bytes.data() + begin, &record.checksum, sizeof record.checksum);
}

}  // namespace

RecordForm::RecordForm(std::vector<analysis::planes::PlaneMetric> metrics, std::size_t points)
    : metrics_(std::move(metrics)), points_(points) {}

void RecordForm::append(std::string& bytes, std::size_t index, const MapPoint& point) const {
  const auto reason = std::string_view(point.why).substr(0, longest_reason);
  Record record{};
  record.index = index;
  record.reason_length = static_cast<std::uint32_t>(reason.size());
  record.regime = static_cast<std::uint8_t>(point.regime);
  record.origin = static_cast<std::uint8_t>(point.origin);
  const std::size_t begin = bytes.size();
  bytes.resize(begin + sizeof record);
  for (const auto& metric : metrics_) append_number(bytes, metric.value(point));
  for (const auto& metric : metrics_) append_number(bytes, metric.error(point));
  bytes += reason;
  sign(bytes, begin, record);
}

void RecordForm::append(std::string& bytes, const PartCost& cost) const {
  Record record{};
  record.index = cost.part;
  record.kind = Kind::cost;
  const std::size_t begin = bytes.size();
  bytes.resize(begin + sizeof record);
  append_number(bytes, cost.seconds);
  sign(bytes, begin, record);
}

RecordForm::Found RecordForm::find(std::string_view bytes) const {
  Record record;
  if (bytes.size() < sizeof record) return {};
  std::memcpy(&record, bytes.data(), sizeof record);
  const bool of_point = record.kind == Kind::point;
  const std::size_t numbers = of_point ? 2 * metrics_.size() : 1;
  const std::size_t length = sizeof record + sizeof(double) * numbers + record.reason_length;
  if (record.kind > Kind::cost || record.reason_length > longest_reason || bytes.size() < length ||
      record.index >= points_)
    return {};
  if (record.regime > static_cast<int>(analysis::planes::Regime::failed) ||
      record.origin > static_cast<int>(analysis::planes::Origin::interpolated))
    return {};
  bytes = bytes.substr(0, length);
  if (checksum(body(bytes)) != record.checksum) return {};
  const auto number = [&](std::size_t k) {
    double value = 0;
    std::memcpy(&value, bytes.data() + sizeof record + k * sizeof value, sizeof value);
    return value;
  };
  if (!of_point) {
    if (!(number(0) >= 0) || std::isinf(number(0))) return {};
    return {length, 0, PartCost{record.index, number(0)}};
  }
  for (std::size_t k = 0; k < metrics_.size(); ++k)
    if (std::isinf(number(k)) || number(metrics_.size() + k) < 0) return {};
  return {length, record.index, {}};
}

MapPoint RecordForm::point(std::string_view bytes) const {
  Record record;
  std::memcpy(&record, bytes.data(), sizeof record);
  MapPoint point = analysis::planes::undecided_point();
  point.done = true;
  point.regime = static_cast<analysis::planes::Regime>(record.regime);
  point.origin = static_cast<analysis::planes::Origin>(record.origin);
  const char* at = bytes.data() + sizeof record;
  std::size_t measures = 0;
  for (const auto& metric : metrics_) measures += metric.member == nullptr;
  point.measures.resize(measures), point.measure_errors.resize(measures);
  for (const auto& metric : metrics_) std::memcpy(&metric.value(point), at, sizeof(double)), at += sizeof(double);
  for (const auto& metric : metrics_) std::memcpy(&metric.error(point), at, sizeof(double)), at += sizeof(double);
  point.why = std::string(bytes.substr(bytes.size() - record.reason_length));
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
