/// Titles, captions and names of axes.
#include "app/output/scene_figure.hpp"

#include <algorithm>

#include "app/output/caption.hpp"
#include "app/output/files.hpp"
#include "app/output/symbols.hpp"

namespace rosin::app::output {

namespace {

/// "harmonics.1.amplitude" as "amplitude of harmonic 1".
std::string read_path(std::string_view path) {
  std::string words;
  std::size_t noun = 0;  // length of the first
  for (std::size_t begin = 0, end; begin < path.size(); begin = end + 1) {
    end = std::min(path.find('.', begin), path.size());
    const std::string key(path.substr(begin, end - begin));
    if (key.find_first_not_of("0123456789") == key.npos) {
      const std::size_t plural = noun > 0 && words[noun - 1] == 's' ? 1 : 0;
      words.replace(noun - plural, plural, ' ' + key);
    } else {
      words = key + (words.empty() ? "" : " of " + words);
      noun = key.size();
    }
  }
  std::ranges::replace(words, '_', ' ');
  return words;
}

}  // namespace

results::Figure figure_of(const scene::Scene& scene, std::string name, std::string what,
                          const std::vector<std::string>& varied) {
  return {.name = std::move(name), .what = std::move(what), .title = scene.title, .caption = caption(scene, varied)};
}

results::Axis axis_of(const std::string& column, const std::string& unit, results::Extent shown) {
  const auto [words, symbol] = in_words(column);
  return {.name = words, .unit = unit, .symbol = symbol, .shown = shown};
}

results::Axis axis_of(std::string_view path, const Quantity& quantity, bool decades) {
  // The symbol of the longest beginning of the path that has one: the rest says which of its numbers.
  auto of = path;
  while (!of.empty() && symbol_of(of).empty()) of = of.substr(0, of.find('.') == of.npos ? 0 : of.rfind('.'));
  auto symbol = symbol_of(of);
  std::string rest = symbol.empty() ? "" : read_path(path.substr(std::min(of.size() + 1, path.size())));
  if (symbol.empty()) {
    const auto table = path.find('.'), key = path.rfind('.');
    symbol = symbol_of(path.substr(key + 1));
    const auto between = key > table ? path.substr(table + 1, key - table - 1) : "";
    if (between.find_first_of("0123456789") != between.npos) rest = read_path(between);
  }
  return {.name = quantity.meaning.substr(0, quantity.meaning.find_first_of(",;")),
          .unit = quantity.unit,
          .symbol = symbol,
          .detail = rest,
          .decades = decades};
}

results::FigureTable::Column column_of(const std::string& name, const std::string& unit, std::vector<double> values) {
  return {column_header(name, unit), std::move(values)};
}

}  // namespace rosin::app::output
