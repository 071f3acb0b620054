/// Reading and appending the journal of a map.
#include "app/partial.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <type_traits>

#include "core/error.hpp"

namespace rosin::app {

namespace {

using analysis::MapPoint;

/// A record as it stands in the file; the reason of a failure follows it.
struct Record {
  std::uint64_t checksum;  ///< of everything after it
  std::uint64_t index;
  std::uint32_t reason_length;
  std::uint8_t regime, integrated, done, unused;
  analysis::Metrics metrics, error;
};
static_assert(std::is_trivially_copyable_v<Record>);

constexpr std::uint32_t longest_reason = 1000;

std::uint64_t checksum(std::string_view bytes) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  return hash;
}

/// The checksummed part of a record.
std::string_view body(std::string_view bytes) { return bytes.substr(sizeof(Record::checksum)); }

std::string header(const std::string& key) { return fmt::format("rosin map, {} bytes of key\n{}\n", key.size(), key); }

void write_all(int file, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const auto written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0)
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

Partial::Partial(std::filesystem::path path, const std::string& key, std::size_t points)
    : path_(std::move(path)), file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)), points_(points) {
  if (file_ < 0) throw InputError(fmt::format("{}: cannot be opened: {}", path_.string(), std::strerror(errno)));
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    ::close(file_);
    throw InputError(
        fmt::format("{}: another rosin computes this map; wait for it or use another --out", path_.string()));
  }
  std::ostringstream text;
  text << std::ifstream(path_, std::ios::binary).rdbuf();
  const std::string content = std::move(text).str(), expected = header(key);
  std::size_t valid = 0;
  if (content.starts_with(expected)) {
    valid = expected.size();
    while (content.size() - valid >= sizeof(Record)) {
      Record record;
      std::memcpy(&record, content.data() + valid, sizeof record);
      const std::size_t length = sizeof record + record.reason_length;
      if (record.reason_length > longest_reason || content.size() - valid < length || record.index >= points) break;
      const std::string_view bytes(content.data() + valid, length);
      if (checksum(body(bytes)) != record.checksum) break;
      points_[record.index] = MapPoint{static_cast<analysis::Regime>(record.regime),
                                       record.integrated != 0,
                                       record.done != 0,
                                       record.metrics,
                                       record.error,
                                       std::string(bytes.substr(sizeof record))};
      valid += length;
    }
  }
  if (::ftruncate(file_, static_cast<off_t>(valid)) != 0 || ::lseek(file_, 0, SEEK_END) < 0)
    throw std::runtime_error(fmt::format("{}: {}", path_.string(), std::strerror(errno)));
  if (valid == 0) write_all(file_, expected, path_);
}

Partial::~Partial() { ::close(file_); }

const MapPoint* Partial::known(std::size_t index) const { return points_[index] ? &*points_[index] : nullptr; }

std::size_t Partial::known_count() const {
  return static_cast<std::size_t>(std::ranges::count_if(points_, [](const auto& point) { return point.has_value(); }));
}

void Partial::append(std::size_t index, const MapPoint& point) {
  const auto reason = std::string_view(point.why).substr(0, longest_reason);
  Record record{};
  record.index = index;
  record.reason_length = static_cast<std::uint32_t>(reason.size());
  record.regime = static_cast<std::uint8_t>(point.regime);
  record.integrated = point.integrated;
  record.done = point.done;
  record.metrics = point.metrics;
  record.error = point.error;
  std::string bytes(reinterpret_cast<const char*>(&record), sizeof record);
  bytes += reason;
  record.checksum = checksum(body(bytes));
  std::memcpy(bytes.data(), &record.checksum, sizeof record.checksum);
  write_all(file_, bytes, path_);
}

void Partial::remove() { std::filesystem::remove(path_); }

}  // namespace rosin::app
