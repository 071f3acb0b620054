/// Reading and appending the journal of a map.
#include "app/verbs/partial.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "core/error.hpp"
#include "core/files.hpp"

namespace rosin::app::verbs {

namespace {

using analysis::planes::MapPoint;

/// A record as it stands in the file; metrics, their errors and the reason of a failure follow it.
struct Record {
  std::uint64_t checksum;  ///< of everything after it
  std::uint64_t index;
  std::uint32_t reason_length;
  std::uint8_t regime, origin, unused[2];
};
static_assert(std::is_trivially_copyable_v<Record>);

constexpr std::uint32_t longest_reason = 1000;

/// The checksummed part of a record.
std::string_view body(std::string_view bytes) { return bytes.substr(sizeof(Record::checksum)); }

constexpr std::string_view first_words = "rosin map, ";
std::string header(const std::string& key) {
  return fmt::format("{}{} bytes of key\n{}\n", first_words, key.size(), key);
}

}  // namespace

Partial::Partial(std::filesystem::path path, const std::string& key, std::size_t points,
                 const std::vector<analysis::planes::PlaneMetric>& metrics)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666)) {
  kept_ = metrics;
  const auto refuse = [&](std::string_view why) {
    if (file_ >= 0) ::close(file_);
    throw InputError(fmt::format("{}: {}", path_.string(), why));
  };
  if (file_ < 0)
    refuse(errno == ELOOP ? "is a link; no journal of a map is written through one"
                          : fmt::format("cannot be opened: {}", std::strerror(errno)));
  struct stat status {};
  if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) refuse("is no regular file");
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0)
    refuse("another rosin computes this map; wait for it or use another --out");
  std::string content(static_cast<std::size_t>(status.st_size), '\0');
  for (std::size_t read = 0; read < content.size();) {
    const auto got = ::pread(file_, content.data() + read, content.size() - read, static_cast<off_t>(read));
    if (got <= 0) content.resize(read);
    if (got > 0) read += static_cast<std::size_t>(got);
  }
  if (!content.empty() && !content.starts_with(first_words.substr(0, content.size())))
    refuse("is not the journal of a map, and is left as it is; move it away or use another --out");
  const std::string expected = header(key);
  std::size_t valid = 0;
  if (content.starts_with(expected)) {
    valid = expected.size();
    while (const auto length = take(std::string_view(content).substr(valid), points)) valid += length;
    if (valid < content.size())
      lost_ = fmt::format("{}: damaged after {} whole records; what follows is computed again", path_.string(),
                          known_.size());
  } else if (content.size() > 0) {
    lost_ = fmt::format("{}: began another map, with other settings or by another version; it is begun afresh",
                        path_.string());
  }
  if (::ftruncate(file_, static_cast<off_t>(valid)) != 0 || ::lseek(file_, 0, SEEK_END) < 0)
    throw std::runtime_error(fmt::format("{}: {}", path_.string(), std::strerror(errno)));
  if (valid == 0) write_all(file_, expected, path_);
}

/// Takes over the record that `bytes` begin with. \returns its length; 0 if it is none that such a map writes.
std::size_t Partial::take(std::string_view bytes, std::size_t points) {
  Record record;
  if (bytes.size() < sizeof record) return 0;
  std::memcpy(&record, bytes.data(), sizeof record);
  const std::size_t length = sizeof record + 2 * sizeof(double) * kept_.size() + record.reason_length;
  if (record.reason_length > longest_reason || bytes.size() < length || record.index >= points) return 0;
  if (record.regime > static_cast<int>(analysis::planes::Regime::failed) ||
      record.origin > static_cast<int>(analysis::planes::Origin::interpolated))
    return 0;
  bytes = bytes.substr(0, length);
  if (checksum(body(bytes)) != record.checksum) return 0;
  MapPoint point = analysis::planes::undecided_point();
  point.done = true;
  point.regime = static_cast<analysis::planes::Regime>(record.regime);
  point.origin = static_cast<analysis::planes::Origin>(record.origin);
  const char* at = bytes.data() + sizeof record;
  point.measures.resize(kept_.size()), point.measure_errors.resize(kept_.size());
  for (const auto& metric : kept_) std::memcpy(&metric.value(point), at, sizeof(double)), at += sizeof(double);
  for (const auto& metric : kept_) std::memcpy(&metric.error(point), at, sizeof(double)), at += sizeof(double);
  for (const auto& metric : kept_)
    if (std::isinf(metric.value(point)) || metric.error(point) < 0) return 0;
  point.why = std::string(bytes.substr(length - record.reason_length));
  known_.insert_or_assign(record.index, std::move(point));
  return length;
}

Partial::~Partial() { ::close(file_); }

const MapPoint* Partial::known(std::size_t index) const {
  const auto it = known_.find(index);
  return it == known_.end() ? nullptr : &it->second;
}

void Partial::append(std::span<const std::size_t> indices, const std::vector<MapPoint>& points) {
  std::string bytes;
  for (const std::size_t index : indices) {
    const MapPoint& point = points[index];
    const auto reason = std::string_view(point.why).substr(0, longest_reason);
    Record record{};
    record.index = index;
    record.reason_length = static_cast<std::uint32_t>(reason.size());
    record.regime = static_cast<std::uint8_t>(point.regime);
    record.origin = static_cast<std::uint8_t>(point.origin);
    const std::size_t begin = bytes.size();
    bytes.append(reinterpret_cast<const char*>(&record), sizeof record);
    const auto append = [&](double number) { bytes.append(reinterpret_cast<const char*>(&number), sizeof number); };
    for (const auto& metric : kept_) append(metric.value(point));
    for (const auto& metric : kept_) append(metric.error(point));
    bytes += reason;
    record.checksum = checksum(body(std::string_view(bytes).substr(begin)));
    std::memcpy(bytes.data() + begin, &record.checksum, sizeof record.checksum);
  }
  write_all(file_, bytes, path_);
}

void Partial::remove() { std::filesystem::remove(path_); }

}  // namespace rosin::app::verbs
