/// Layout of pictures by gnuplot itself, so that a script draws its picture for any width.
#include "app/output/sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "app/output/gnuplot.hpp"
#include "app/results/figure.hpp"

namespace rosin::app::output {

namespace {

/// Breaks a text at spaces where it is wider than the sheet: `text` becomes its rows, and `rows` counts them.
std::string wrapped(std::string_view text, std::string_view rows, const std::string& quoted, double character) {
  return fmt::format(R"({text} = ''; {rows} = 0; rest = {quoted}.' '; row = ''
while (strlen(rest) > 0) {{
  at = strstrt(rest, ' ')
  next = rest[1:at-1]
  rest = at < strlen(rest) ? rest[at+1:*] : ''
  if (strlen(row) > 0 && (strlen(row) + strlen(next) + 1) * {character} > wide - 30) {{ {text} = {text}.row."\n"; {rows} = {rows} + 1; row = '' }}
  row = strlen(row) > 0 ? row.' '.next : next
}}
{text} = {text}.row; {rows} = {rows} + (strlen(row) > 0)
)",
                     fmt::arg("text", text), fmt::arg("rows", rows), fmt::arg("quoted", quoted),
                     fmt::arg("character", character));
}

/// How many titles the plots of a script have, and the length of the longest.
std::pair<std::size_t, std::size_t> titles_of(std::string_view script) {
  std::set<std::string_view> titles;
  constexpr std::string_view word = " title '", apostrophe = "'.\"\\047\".'";
  for (std::size_t at = 0; (at = script.find(word, at)) != std::string_view::npos;) {
    const bool of_plot = !script.substr(0, at).ends_with("set");
    const std::size_t begin = at += word.size();
    while (at < script.size() && (script[at] != '\'' || script.substr(at).starts_with(apostrophe)))
      at += script[at] == '\'' ? apostrophe.size() : 1;
    if (of_plot) titles.insert(script.substr(begin, at - begin));
  }
  std::size_t longest = 0;
  for (const auto title : titles) longest = std::max(longest, title.size());
  return {titles.size(), longest};
}

std::string styles() {
  std::string text = "# Lines differ in dash as well as in colour: readable in grey and by the colour-blind.\n";
  for (std::size_t i = 0; i < std::size(results::line_styles); ++i) {
    const auto& [colour, dash, width] = results::line_styles[i];
    text += fmt::format("set style line {} linecolor '{}' linewidth {} dashtype {}\n", i + 1, colour, width,
                        *dash ? fmt::format("({})", dash) : "solid");
  }
  return text;
}

}  // namespace

std::string Sheet::with(std::string panels) const {
  const auto& l = layout;
  const auto [all, longest] = titles_of(panels);
  const auto titles = l.key == Layout::Key::own ? 0 : all;
  const bool key_below = l.key == Layout::Key::below;
  const std::string set_key =
      titles == 0 ? ""
      : key_below
          ? "set key at screen 20/wide,rows_top top left Left reverse horizontal maxcols key_columns\n"
          : fmt::format("set key at screen 1-{}/wide,1-above_key/high top right horizontal maxcols key_columns\n",
                        l.right);
  std::string script = fmt::format(
      R"(# {what}. Redraw with: gnuplot {name}.gp   or   gnuplot -e "format='pdf'; width=85" {name}.gp for a column of 85 mm
if (!exists("format")) format = 'svg'
if (!exists("output")) output = '{name}.'.format
if (!exists("width")) width = 0 # millimetres; 0: a screen
if (format ne 'png' && format ne 'pdf' && format ne 'svg') {{ exit message "format is 'svg', 'png' or 'pdf'" }}
set encoding utf8
# Lengths are pixels of a picture whose text is 13 pixels high; in print it is 7 or 8 points high.
points = width == 0 ? 9.75 : width < 130 ? 7. : 8.
wide = width == 0 ? {width}. : width / 25.4 * 72 * 13 / points
narrow = width > 0 && width < 130
frame = (narrow ? 0.75 : 1) * {panel}
)",
      fmt::arg("what", what), fmt::arg("name", name), fmt::arg("width", l.width), fmt::arg("panel", l.panel));
  script += wrapped("title_text", "title_rows", single_quoted(title), 7.5);
  script += wrapped("caption_text", "caption_rows", single_quoted(caption), 5.7);
  script += fmt::format(
      R"(left = {left} > 0.62 * wide ? 0.62 * wide : {left}
columns = {columns}
while (columns > 1 && (wide - left - {right} - (columns - 1) * {between_columns}) / columns < 195) {{ columns = columns - 1 }}
rows = ceil({panels}. / columns)
side = (wide - left - {right} - (columns - 1) * {between_columns}) / columns # width of a panel
key_columns = {key} < 1 ? 1 : floor(side / (7.3 * {longest} + 62))
if (key_columns < 1) {{ key_columns = 1 }}
if (key_columns > {key}) {{ key_columns = {key} }}
key_rows = {key} > 0 ? ceil({key}. / key_columns) : 0
own_rows = ceil(1. * {own_titles} / (side > 7.3 * {longest} + 55 ? floor(side / (7.3 * {longest} + 55)) : 1))
own_above = own_rows > 1 ? 19 * (own_rows - 1) : 0 # beside the one row that the layout has room for
between_rows = {between_rows} + own_above
above_key = 10 + 16 * title_rows
above = above_key + {above} + own_above + 19 * {above_has_key}
below_rows = 6 + 12 * caption_rows + 19 * ((narrow ? {narrow_rows_below} : {rows_below}) + {below_has_key})
below = {below} + below_rows
high = 1. * above + below + rows * frame + (rows - 1) * between_rows
rows_top = below_rows / high
# Pixels of the file to one of the layout: 96 to the inch of an SVG, 300 of a PNG in print.
svg = width == 0 ? 1 : points * 96 / 72 / 13
png = width == 0 ? 1 : points * 300 / 72 / 13
# Terminal svg lays out for lines 1.5 times as high as its font before fontscale; those of a font are 1.16 times as high.
wider = 1.5 / 1.16
size = format eq 'svg' ? 13*svg/wider : format eq 'png' ? 9.75*png : points
font = sprintf('%s,%.4g', format eq 'svg' ? 'sans-serif' : 'sans', size); small = sprintf(',%.4g', 0.75*size)
if (format eq 'svg') {{ set terminal svg size wide*svg,high*svg font font fontscale wider linewidth svg background 'white' }}
if (format eq 'png') {{ set terminal pngcairo size wide*png,high*png font font linewidth png pointscale png background 'white' }}
if (format eq 'pdf') {{ set terminal pdfcairo size (wide*points/13/72)in,(high*points/13/72)in font font fontscale 0.75 linewidth points/6.5 pointscale points/13 background 'white' }}
set output output
set datafile separator ','
set datafile missing 'nan'
set border linewidth 0.8
set tics nomirror out
if (narrow) {{ set ylabel font sprintf(',%.4g', 0.86*size) }}
# A font in which a label is no longer than a side of a panel, and a title of the key no wider than a panel.
fitted(length, part, room) = sprintf(',%.4g', size * (part * length > room ? room / length : part))
fitted_x(text) = fitted(7.5 * strlen(text), 1., side)
fitted_y(text) = fitted(7.5 * strlen(text), narrow ? 0.86 : 1., frame + 20)
key_font = fitted(7.3 * {longest} + 1, 1., side - 55)
set key samplen 2.5 spacing 1.1 font key_font
set grid linetype 1 linecolor '#CCCCCC' linewidth 0.5; unset grid # its look, for pictures that set it
{styles}{set_key}set multiplot layout rows,columns title title_text margins left/wide,1-{right}/wide,below/high,1-above/high spacing {between_columns}/wide,between_rows/high
)",
      fmt::arg("above", l.above), fmt::arg("below", l.below), fmt::arg("key", titles), fmt::arg("longest", longest),
      fmt::arg("above_has_key", key_below ? "0" : "key_rows"), fmt::arg("below_has_key", key_below ? "key_rows" : "0"),
      fmt::arg("rows_below", l.rows_below), fmt::arg("narrow_rows_below", std::max(l.rows_below, l.narrow_rows_below)),
      fmt::arg("between_rows", l.between_rows), fmt::arg("own_titles", l.own_titles),
      fmt::arg("between_columns", l.between_columns), fmt::arg("columns", l.columns), fmt::arg("panels", l.panels),
      fmt::arg("left", l.left), fmt::arg("right", l.right), fmt::arg("set_key", set_key), fmt::arg("styles", styles()));
  // Before the last plot: each of several would draw it again, and bolder.
  if (const auto last = std::max(panels.rfind("\nplot ") + 1, panels.rfind("\nsplot ") + 1); last > 0)
    panels.insert(last,
                  "set label 99 caption_text at screen 0.5,screen (12*caption_rows)/high center font small textcolor "
                  "'#555555'\n");
  return script + panels + "unset multiplot\n";
}

}  // namespace rosin::app::output
