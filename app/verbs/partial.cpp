/// Reading and appending the journal of a map.
#include "app/verbs/partial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "analysis/planes/map.hpp"
#include "core/error.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::verbs {

using analysis::planes::MapPoint;

Partial::Partial(std::filesystem::path path, const std::string& key, std::size_t points,
                 const std::vector<analysis::planes::PlaneMetric>& metrics)
    : known_(RecordForm(metrics, points)),
      journal_(path, "map", key, [&](std::string content, std::size_t begin) -> Journal::Taken {
        const auto end = known_.take(std::move(content), begin, path, false);
        return {end, known_.count()};
      }) {}

void Partial::append(std::span<const std::size_t> indices, const std::vector<MapPoint>& points) {
  std::string bytes;
  for (const std::size_t index : indices) known_.form().append(bytes, index, points[index]);
  journal_.append(bytes);
}

void Partial::append(const std::vector<analysis::planes::PartCost>& costs) {
  std::string bytes;
  for (const auto& cost : costs) known_.form().append(bytes, cost);
  journal_.append(bytes);
}

std::string journal_name(analysis::planes::Share share) {
  return share.count == 1 ? "map.partial" : fmt::format("map.{}-of-{}.partial", share.index + 1, share.count);
}

std::optional<analysis::planes::Share> share_of(std::string_view text, std::string_view between, std::size_t parts) {
  analysis::planes::Share share;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, share.index);
  if (first.ec != std::errc{} || !std::string_view(first.ptr, end).starts_with(between)) return std::nullopt;
  const auto second = std::from_chars(first.ptr + between.size(), end, share.count);
  if (second.ec != std::errc{} || second.ptr != end) return std::nullopt;
  if (share.index < 1 || share.index > share.count || std::size_t(share.count) > parts) return std::nullopt;
  --share.index;
  return share;
}

std::optional<analysis::planes::Share> share_of_journal(const std::string& name, std::size_t parts) {
  if (name == journal_name({})) return analysis::planes::Share{};
  constexpr std::string_view begin = "map.", end = ".partial";
  if (!name.starts_with(begin) || !name.ends_with(end) || name.size() < begin.size() + end.size()) return std::nullopt;
  const auto share =
      share_of(std::string_view(name).substr(begin.size(), name.size() - begin.size() - end.size()), "-of-", parts);
  return share && name == journal_name(*share) ? share : std::nullopt;
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
  auto content = read_found(path, largest_journal);
  const auto refuse = [&](const std::string& why) { throw InputError(fmt::format("{}: {}", path.string(), why)); };
  const auto words = journal_words("map");
  if (!content.starts_with(words)) refuse("is not the journal of a map");
  const std::string expected = journal_header("map", key);
  if (!content.starts_with(expected)) {
    const auto begin = content.find('\n');
    const auto length = std::strtoull(content.c_str() + words.size(), nullptr, 10);
    const auto theirs = begin == std::string::npos ? std::string() : content.substr(begin + 1, length);
    refuse("is of another map: " + difference(theirs, key));
  }
  known.take(std::move(content), expected.size(), path, true);
}

}  // namespace rosin::app::verbs
