/// Reading and appending the journal of a map.
#include "app/verbs/partial.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/error.hpp"
#include "core/files.hpp"

namespace rosin::app::verbs {

namespace {

using analysis::planes::MapPoint;

constexpr std::string_view first_words = "rosin map, ";
std::string header(const std::string& key) {
  return fmt::format("{}{} bytes of key\n{}\n", first_words, key.size(), key);
}

}  // namespace

Partial::Partial(std::filesystem::path path, const std::string& key, std::size_t points,
                 const std::vector<analysis::planes::PlaneMetric>& metrics)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666)),
      known_(RecordForm(metrics, points)) {
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
    const auto size = content.size();
    valid = known_.take(std::move(content), expected.size(), path_, false);
    if (valid < size)
      lost_ = fmt::format("{}: damaged after {} whole records; what follows is computed again", path_.string(),
                          known_.count());
  } else if (content.size() > 0) {
    lost_ = fmt::format("{}: began another map, with other settings or by another version; it is begun afresh",
                        path_.string());
  }
  if (::ftruncate(file_, static_cast<off_t>(valid)) != 0 || ::lseek(file_, 0, SEEK_END) < 0)
    throw std::runtime_error(fmt::format("{}: {}", path_.string(), std::strerror(errno)));
  if (valid == 0) write_all(file_, expected, path_);
}

Partial::~Partial() { ::close(file_); }

void Partial::append(std::span<const std::size_t> indices, const std::vector<MapPoint>& points) {
  std::string bytes;
  for (const std::size_t index : indices) known_.form().append(bytes, index, points[index]);
  write_all(file_, bytes, path_);
}

void Partial::append(const std::vector<analysis::planes::PartCost>& costs) {
  std::string bytes;
  for (const auto& cost : costs) known_.form().append(bytes, cost);
  write_all(file_, bytes, path_);
}

void Partial::remove() { std::filesystem::remove(path_); }

std::string journal_name(analysis::planes::Share share) {
  return share.count == 1 ? "map.partial" : fmt::format("map.{}-of-{}.partial", share.index + 1, share.count);
}

std::optional<analysis::planes::Share> share_of_journal(const std::string& name) {
  analysis::planes::Share share;
  if (name == journal_name(share)) return share;
  if (std::sscanf(name.c_str(), "map.%d-of-%d.partial", &share.index, &share.count) != 2) return std::nullopt;
  --share.index;
  return name == journal_name(share) ? std::optional(share) : std::nullopt;
}

namespace {

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// The first line in which two keys differ, "tolerance 1e-06, this map has tolerance 0.001".
std::string difference(std::string_view theirs, std::string_view ours) {
  const auto a = lines_of(theirs), b = lines_of(ours);
  for (std::size_t k = 0; k < std::max(a.size(), b.size()); ++k) {
    const auto there = k < a.size() ? a[k] : "nothing more", here = k < b.size() ? b[k] : "nothing more";
    if (there != here) return fmt::format("there stands \"{}\", here \"{}\"", there, here);
  }
  return "nothing differs";
}

}  // namespace

void read_journal(const std::filesystem::path& path, const std::string& key, KnownPoints& known) {
  constexpr std::uintmax_t largest = 100'000'000'000;  // bytes
  auto content = read_whole(path, largest);
  const auto refuse = [&](const std::string& why) { throw InputError(fmt::format("{}: {}", path.string(), why)); };
  if (!content.starts_with(first_words)) refuse("is not the journal of a map");
  const std::string expected = header(key);
  if (!content.starts_with(expected)) {
    const auto begin = content.find('\n');
    const auto length = std::strtoull(content.c_str() + first_words.size(), nullptr, 10);
    const auto theirs = begin == std::string::npos ? std::string() : content.substr(begin + 1, length);
    refuse("is of another map: " + difference(theirs, key));
  }
  known.take(std::move(content), expected.size(), path, true);
}

}  // namespace rosin::app::verbs
