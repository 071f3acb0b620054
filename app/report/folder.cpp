/// Reading results folders.
#include "app/report/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "app/output/document.hpp"
#include "app/verbs/verbs.hpp"
#include "core/error.hpp"
#include "core/files.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::report {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t largest = 500'000'000;  // bytes
constexpr std::string_view ending = ".manifest.json";

void require_this_version(const fs::path& path, const ordered_json& manifest) {
  const auto version = word(manifest, "version");
  if (version == ROSIN_VERSION) return;
  throw InputError(
      fmt::format("{}: was written by rosin {}, and this is {}; compute it again, or make the report with "
                  "that version",
                  path.string(), version.empty() ? "of an unknown version" : version, ROSIN_VERSION));
}

std::size_t place_of(const std::string& label) {
  const auto& list = verbs::verbs();
  const auto verb = label == "design" ? "compare" : label;
  return std::size_t(std::ranges::find(list, verb, [](const auto& v) { return std::string(v.name); }) - list.begin());
}

bool begins_with(const fs::path& path, std::string_view mark) {
  std::string begin(mark.size(), ' ');
  return std::ifstream(path, std::ios::binary).read(begin.data(), std::streamsize(begin.size())) && begin == mark;
}

/// Why a file is not what its name says, which rosin gives to regular files alone; empty where it is.
std::string foreign(const fs::directory_entry& entry) {
  std::error_code problem;
  const auto status = entry.symlink_status(problem);
  const auto extension = entry.path().extension();
  if (fs::is_symlink(status)) return "is a link, which is not followed";
  if (fs::is_directory(status) && extension != ".json" && extension != ".csv" && extension != ".png") return {};
  if (!fs::is_regular_file(status)) return "is no regular file";
  constexpr std::string_view mark = "\x89PNG\r\n\x1a\n";
  if (extension == ".png" && !begins_with(entry.path(), mark)) return "is no PNG";
  if (extension == ".wav" && !begins_with(entry.path(), "RIFF")) return "is no WAV";
  return {};
}

}  // namespace

Folder read_folder(const fs::path& path) {
  if (!fs::exists(path)) throw InputError(fmt::format("{}: no such folder", path.string()));
  if (!fs::is_directory(path))
    throw InputError(
        fmt::format("{}: is no folder; results of a scene stand in out/<scene>/, or where --out says", path.string()));
  Folder folder{path, {}, {}};
  std::vector<std::string> labels;
  for (const auto& entry : fs::directory_iterator(path)) {
    const auto name = entry.path().filename().string();
    if (const auto why = foreign(entry); !why.empty())
      folder.left_out[name] = why;
    else if (name.size() > ending.size() && name.ends_with(ending))
      labels.push_back(name.substr(0, name.size() - ending.size()));
  }
  std::erase_if(labels, [&](const auto& label) { return folder.left_out.contains(label + ".json"); });
  if (labels.empty())
    throw InputError(
        fmt::format("{}: holds no results (no <verb>{}); compute them first, such as with "
                    "'rosin run SCENE --out {}'",
                    (path / "").string(), ending, path.string()));
  std::ranges::sort(labels,
                    [](const auto& a, const auto& b) { return std::pair(place_of(a), a) < std::pair(place_of(b), b); });
  for (const auto& label : labels) {
    const auto manifest = path / (label + std::string(ending)), document = path / (label + ".json");
    Result result{label, {}, output::parse_document(manifest.string(), read_found(manifest, largest)), {}};
    require_this_version(manifest, result.manifest);
    const auto text = read_found(document, largest);
    result.document = output::parse_document(document.string(), text);
    require_this_version(document, result.document);
    result.checksum = fmt::format("{:016x}", rosin::checksum(text));
    folder.results.push_back(std::move(result));
  }
  return folder;
}

namespace {

std::vector<std::string> cells(std::string_view line) {
  std::vector<std::string> found;
  for (std::size_t from = 0;;) {
    const auto comma = line.find(',', from);
    found.emplace_back(line.substr(from, comma == line.npos ? comma : comma - from));
    if (comma == line.npos) return found;
    from = comma + 1;
  }
}

}  // namespace

std::vector<TableColumn> read_table(const fs::path& path) {
  std::error_code problem;
  if (!fs::is_regular_file(fs::symlink_status(path, problem))) return {};
  const auto text = read_found(path, largest);
  std::vector<TableColumn> table;
  for (std::size_t from = 0; from < text.size();) {
    const auto end = std::min(text.find('\n', from), text.size());
    const auto row = cells(std::string_view(text).substr(from, end - from));
    from = end + 1;
    if (table.empty()) {
      for (const auto& header : row) {
        const auto open = header.rfind(" (");
        const bool unit = open != header.npos && header.ends_with(')');
        table.push_back({header.substr(0, unit ? open : header.npos),
                         unit ? header.substr(open + 2, header.size() - open - 3) : "1",
                         {}});
      }
      continue;
    }
    const bool parted = row.size() == 1 && row[0].empty();  // what is before from what is behind
    if (row.size() != table.size() && !parted) return {};
    for (std::size_t c = 0; c < table.size(); ++c) {
      const auto cell = parted ? std::string() : row[c];
      double value = 0;
      const auto [rest, failure] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      const bool whole = failure == std::errc() && rest == cell.data() + cell.size();
      auto& column = table[c];
      const bool word = !column.texts.empty() || (column.values.empty() && !whole && !cell.empty());
      if (word) column.texts.push_back(cell);
      column.values.push_back(whole ? value : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return table;
}

const ordered_json& at(const ordered_json& object, std::string_view key) {
  static const ordered_json none;
  if (!object.is_object()) return none;
  const auto found = object.find(std::string(key));
  return found == object.end() ? none : *found;
}

double number(const ordered_json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::string word(const ordered_json& object, std::string_view key) {
  const auto& value = at(object, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

bool yes(const ordered_json& object, std::string_view key) {
  const auto& value = at(object, key);
  return value.is_boolean() && value.get<bool>();
}

std::vector<double> numbers(const ordered_json& list) {
  std::vector<double> found;
  if (list.is_array())
    for (const auto& value : list) found.push_back(number(value));
  return found;
}

}  // namespace rosin::app::report
