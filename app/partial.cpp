/// Reading and appending the journal of a map.
#include "app/partial.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <type_traits>

#include "core/error.hpp"

namespace rosin::app {

namespace {

using analysis::MapPoint;

/// A record as it stands in the file; metrics, their errors and the reason of a failure follow it.
struct Record {
  std::uint64_t checksum;  ///< of everything after it
  std::uint64_t index;
  std::uint32_t reason_length;
  std::uint8_t regime, origin, unused[2];
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

Partial::Partial(std::filesystem::path path, const std::string& key, std::size_t points,
                 const std::vector<std::string>& metrics)
    : path_(std::move(path)), file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  for (const auto& name : metrics) kept_.push_back(analysis::find_metric(name).member);
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
      const std::size_t numbers = 2 * sizeof(double) * kept_.size(),
                        length = sizeof record + numbers + record.reason_length;
      if (record.reason_length > longest_reason || content.size() - valid < length || record.index >= points) break;
      const std::string_view bytes(content.data() + valid, length);
      if (checksum(body(bytes)) != record.checksum) break;
      MapPoint& point = known_.insert_or_assign(record.index, analysis::undecided_point()).first->second;
      point.done = true;
      point.regime = static_cast<analysis::Regime>(record.regime);
      point.origin = static_cast<analysis::Origin>(record.origin);
      const char* at = bytes.data() + sizeof record;
      for (auto* numbers : {&point.metrics, &point.error})
        for (const auto member : kept_) std::memcpy(&(numbers->*member), at, sizeof(double)), at += sizeof(double);
      point.why = std::string(bytes.substr(length - record.reason_length));
      valid += length;
    }
  }
  if (::ftruncate(file_, static_cast<off_t>(valid)) != 0 || ::lseek(file_, 0, SEEK_END) < 0)
    throw std::runtime_error(fmt::format("{}: {}", path_.string(), std::strerror(errno)));
  if (valid == 0) write_all(file_, expected, path_);
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
    for (const auto* numbers : {&point.metrics, &point.error})
      for (const auto member : kept_) bytes.append(reinterpret_cast<const char*>(&(numbers->*member)), sizeof(double));
    bytes += reason;
    record.checksum = checksum(body(std::string_view(bytes).substr(begin)));
    std::memcpy(bytes.data() + begin, &record.checksum, sizeof record.checksum);
  }
  write_all(file_, bytes, path_);
}

void Partial::remove() { std::filesystem::remove(path_); }

}  // namespace rosin::app
