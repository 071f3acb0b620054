/// Values of a sweep as records: three sizes (returns after which the motion recurs, moments, unknowns), the columns
/// moment by moment, the unknowns, and the metrics with their errors.
#include "app/verbs/sweep_journal.hpp"

#include <cmath>

#include "app/verbs/point_records.hpp"
#include "app/verbs/records.hpp"

namespace rosin::app::verbs {

using analysis::planes::SweepPoint;

namespace {

constexpr std::size_t sizes = 3;

/// A size that a record names; nothing for a number that is none.
std::optional<std::size_t> size_of(double number) {
  constexpr double largest = 1e9;
  if (!(number >= 0 && number <= largest) || number != std::floor(number)) return std::nullopt;
  return std::size_t(number);
}

}  // namespace

SweepJournal::SweepJournal(const std::filesystem::path& path, const std::string& key, std::size_t values,
                           std::size_t columns, std::vector<analysis::planes::PlaneMetric> metrics)
    : values_(values),
      columns_(columns),
      metrics_(std::move(metrics)),
      points_(2 * values),
      journal_(path, "sweep", key,
               [&](const std::string& content, std::size_t begin) { return take(content, begin); }) {}

void SweepJournal::append(bool up, std::size_t value, const SweepPoint& point) {
  const auto& [done, why, columns, recurrence, metrics, end] = point;
  std::string bytes;
  RecordWriter writer(bytes, Record::Kind::value, value + (up ? 0 : values_), std::uint8_t(metrics.regime),
                      std::uint8_t(metrics.origin));
  const std::size_t moments = columns_ == 0 ? 0 : columns.front().size();
  for (const std::size_t size : {std::size_t(recurrence), moments, end.size()}) writer.number(double(size));
  for (std::size_t k = 0; k < moments; ++k)
    for (const auto& column : columns) writer.number(column[k]);
  for (const double unknown : end) writer.number(unknown);
  for (const auto& metric : metrics_) writer.number(metric.value(metrics));
  for (const auto& metric : metrics_) writer.number(metric.error(metrics));
  writer.finish(why);
  journal_.append(bytes);
}

std::optional<SweepPoint> SweepJournal::known(bool up, std::size_t value) const {
  return points_[value + (up ? 0 : values_)];
}

Journal::Taken SweepJournal::take(std::string_view content, std::size_t begin) {
  const auto count_of = [this](const Record& head, std::string_view bytes) -> std::optional<std::size_t> {
    if (head.kind != Record::Kind::value || head.index >= points_.size() || !known_regime(head) ||
        bytes.size() < sizes * sizeof(double))
      return std::nullopt;
    Record start;
    start.numbers = bytes.substr(0, sizes * sizeof(double));
    const auto recurrence = size_of(start.number(0)), moments = size_of(start.number(1)),
               end = size_of(start.number(2));
    if (!recurrence || !moments || !end) return std::nullopt;
    return sizes + *moments * columns_ + *end + 2 * metrics_.size();
  };
  for (Record record; (record = record_at(content.substr(begin), count_of)).length > 0; begin += record.length) {
    SweepPoint point;
    point.done = true;
    point.why = std::string(record.text);
    point.recurrence = int(record.number(0));
    const std::size_t moments = std::size_t(record.number(1)), unknowns = std::size_t(record.number(2));
    std::size_t at = sizes;
    point.columns.assign(columns_, std::vector<double>(moments));
    for (std::size_t k = 0; k < moments; ++k)
      for (auto& column : point.columns) column[k] = record.number(at++);
    for (std::size_t k = 0; k < unknowns; ++k) point.end.push_back(record.number(at++));
    point.metrics = point_of(record, metrics_, at);
    auto& known = points_[record.index];
    known_ += !known;
    known = std::move(point);
  }
  return {begin, known_};
}

}  // namespace rosin::app::verbs
