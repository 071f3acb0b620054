/// The SVG: paths whose points move on, marks of stations, and curves with a cursor.
#include "app/output/animation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/output/gnuplot.hpp"
#include "app/output/markup.hpp"

namespace rosin::app::output {

using analysis::motion::Touch;

namespace {

constexpr double width = 860, margin = 20, drawing_top = 58, most_height = 360, curve_height = 96;
constexpr double seconds_shown = 6;  // of one oscillation

/// One decimal, and none where it is 0: the file is mostly such numbers.
std::string px(double value) {
  auto text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

template <class List, class Of>
std::string values(const List& list, Of of) {
  std::string text;
  for (const auto& item : list) text += (text.empty() ? "" : ";") + of(item);
  return text;
}

class Drawing {
 public:
  explicit Drawing(const Animation& of) : of_(of) {
    scale_ = std::min((width - 2 * margin) / (of.right - of.left), most_height / (of.high - of.low));
    middle_ = (of.left + of.right) / 2;
  }

  std::string text() {
    const double bottom = y(of_.low);
    std::string body = surface(bottom);
    for (const auto& lines : of_.lines) body += moving(lines);
    for (const auto& station : of_.stations) body += marks(station);
    body += legend();
    double down = bottom + 14;
    if (!of_.curves.empty()) body += curves(down), down += curve_height + 40;
    for (const auto& line : of_.caption)
      body += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", px(margin), px(down += 18), escaped(line));
    const double height = down + 16;
    std::string all = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" "
        "font-family=\"sans-serif\" font-size=\"13\" fill=\"#222\">\n<title>{2}</title>\n",
        px(width), px(height), escaped(of_.title));
    all += "<desc>";
    for (const auto& line : of_.caption) all += escaped(line) + ' ';
    all += fmt::format(
        "</desc>\n<rect width=\"{}\" height=\"{}\" fill=\"#fff\"/>\n<text x=\"{}\" y=\"28\" "
        "font-size=\"16\">{}</text>\n",
        px(width), px(height), px(margin), escaped(of_.title));
    return all + body + "</svg>\n";
  }

 private:
  double x(double metres) const { return width / 2 + scale_ * (metres - middle_); }
  double y(double metres) const { return drawing_top + scale_ * (of_.high - metres); }
  std::string at(const Place& place) const { return px(x(place[0])) + ' ' + px(y(place[1])); }

  static std::string animate(const char* attribute, const std::string& values, bool steps = false) {
    return fmt::format("<animate attributeName=\"{}\" dur=\"{}s\" repeatCount=\"indefinite\"{} values=\"{}\"/>",
                       attribute, seconds_shown, steps ? " calcMode=\"discrete\"" : "", values);
  }

  std::string path(const std::vector<std::vector<Place>>& lines) const {
    std::string d;
    for (const auto& line : lines)
      for (std::size_t i = 0; i < line.size(); ++i) d += (i == 0 ? 'M' : 'L') + at(line[i]);
    return d;
  }
  std::string moving(const Animation::Lines& lines) const {
    return fmt::format("<path style=\"{}\" d=\"{}\">{}</path>\n", lines.style, path(lines.frames.front()),
                       animate("d", values(lines.frames, [&](const auto& frame) { return path(frame); })));
  }

  /// A square, a ring or a cross, of which one is seen at a time.
  static std::string mark(Touch touch) {
    switch (touch) {
      case Touch::sticks:
        return "<rect x=\"-4.5\" y=\"-4.5\" width=\"9\" height=\"9\" fill=\"#00336f\"";
      case Touch::slips:
        return "<circle r=\"4\" fill=\"#fff\" stroke=\"#b0560f\" stroke-width=\"2\"";
      case Touch::open:
        return "<path d=\"M-4 -4L4 4M-4 4L4 -4\" stroke=\"#777\" stroke-width=\"1.8\"";
    }
    return "";
  }
  std::string marks(const Animation::Station& station) const {
    const auto& touch = station.touch;
    std::string text = "<g>";
    text += fmt::format(
        "<animateTransform attributeName=\"transform\" type=\"translate\" dur=\"{}s\" repeatCount=\"indefinite\" "
        "values=\"{}\"/>",
        seconds_shown, values(station.place, [&](const Place& place) { return at(place); }));
    for (const Touch kind : {Touch::sticks, Touch::slips, Touch::open}) {
      // The last frame is the first of the next oscillation: as many intervals as there are others.
      const auto count = std::count(touch.begin(), touch.end() - 1, kind);
      if (count == 0) continue;
      if (count + 1 == std::ptrdiff_t(touch.size())) {
        text += mark(kind) + "/>";
        continue;
      }
      const std::vector<Touch> kept(touch.begin(), touch.end() - 1);
      const auto seen = [&](Touch now) { return std::string(now == kind ? "1" : "0"); };
      text += fmt::format("<g opacity=\"{}\">{}{}/></g>", seen(touch.front()),
                          animate("opacity", values(kept, seen), true), mark(kind));
    }
    return text + "</g>\n";
  }

  std::string surface(double bottom) const {
    const double solid = y(-of_.rough);
    std::string text = fmt::format(
        "<clipPath id=\"belt\"><rect x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\"/></clipPath>\n"
        "<rect x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" fill=\"#e4e4e4\"/>\n",
        px(margin), px(solid), px(width - 2 * margin), px(bottom - solid));
    if (of_.rough > 0)
      text += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#f3f0e8\"/>\n", px(margin),
                          px(y(0)), px(width - 2 * margin), px(solid - y(0)));
    // Strokes that come round to their own places, where they are neither too close nor too far.
    constexpr double usual = 40, least = 6;  // px
    const double way = scale_ * of_.belt, number = std::max(1.0, std::round(std::abs(way) / usual));
    const double apart = std::abs(way) >= least ? std::abs(way) / number : usual;
    std::string strokes;
    const double reach = std::abs(way) + apart;
    for (double at = margin - reach; at < width + reach; at += apart)
      strokes += fmt::format("M{} {}l-10 10", px(at), px(solid + 4));
    const std::string moves = std::abs(way) < least
                                  ? ""
                                  : fmt::format(
                                        "<animateTransform attributeName=\"transform\" type=\"translate\" "
                                        "dur=\"{}s\" repeatCount=\"indefinite\" values=\"0 0;{} 0\"/>",
                                        seconds_shown, px(way));
    return text +
           fmt::format("<g clip-path=\"url(#belt)\"><path d=\"{}\" stroke=\"#999\" fill=\"none\">{}</path></g>\n",
                       strokes, moves);
  }

  std::string legend() const {
    std::string text;
    double right = margin + 6;
    for (const auto& [kind, word] :
         {std::pair{Touch::sticks, "sticks"}, {Touch::slips, "slips"}, {Touch::open, "open"}}) {
      text += fmt::format("<g transform=\"translate({} 45)\">{}/><text x=\"9\" y=\"4.5\">{}</text></g>\n", px(right),
                          mark(kind), word);
      right += 70;
    }
    if (of_.rough > 0)
      text += fmt::format(
          "<g transform=\"translate({} 45)\"><rect x=\"-5\" y=\"-5\" width=\"18\" height=\"10\" fill=\"#f3f0e8\" "
          "stroke=\"#bbb\"/><text x=\"18\" y=\"4.5\">roughness, which gives way by the approach</text></g>\n",
          px(right));
    return text;
  }

  std::string curves(double top) const {
    double low = 0, high = 0;
    for (const auto& curve : of_.curves)
      for (const double value : curve.values) low = std::min(low, value), high = std::max(high, value);
    if (!(high > low)) high = low + 1;
    const double left = margin + 60, right = width - margin - 90, bottom = top + curve_height;
    const auto down = [&](double value) { return bottom - curve_height * (value - low) / (high - low); };
    const auto unit = scaled(of_.curve_unit, std::max(std::abs(low), std::abs(high)));
    std::string text = fmt::format(
        "<path d=\"M{0} {1}V{2}M{0} {10}H{3}\" fill=\"none\" stroke=\"#999\"/>\n"
        "<text x=\"{4}\" y=\"{5}\" text-anchor=\"end\">{6:.3g} {7}</text>\n"
        "<text x=\"{4}\" y=\"{8}\" text-anchor=\"end\">{9:.3g}</text>\n",
        px(left), px(top), px(bottom), px(right), px(left - 6), px(top + 10), high * unit.factor, unit.unit, px(bottom),
        low * unit.factor, px(down(0)));
    const auto time = scaled("s", of_.begin + of_.period);
    text += fmt::format("<text x=\"{}\" y=\"{}\">{:.6g} {}</text>\n", px(left), px(bottom + 17),
                        of_.begin * time.factor, time.unit);
    text += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.6g} {}</text>\n", px(right), px(bottom + 17),
                        (of_.begin + of_.period) * time.factor, time.unit);
    double label = -std::numeric_limits<double>::infinity();
    auto sorted = of_.curves;
    std::ranges::sort(sorted, {}, [&](const auto& curve) { return down(curve.values.back()); });
    for (const auto& curve : sorted) {
      std::string d;
      for (std::size_t i = 0; i < curve.values.size(); ++i)
        d += (i == 0 ? 'M' : 'L') + px(left + (right - left) * double(i) / double(curve.values.size() - 1)) + ' ' +
             px(down(curve.values[i]));
      label = std::max(label + 15, down(curve.values.back()) + 4);
      text += fmt::format("<path d=\"{}\" style=\"{}\"/><text x=\"{}\" y=\"{}\">{}</text>\n", d, curve.style,
                          px(right + 6), px(label), curve.name);
    }
    return text + fmt::format(
                      "<path d=\"M{0} {1}V{2}\" stroke=\"#222\"><animateTransform attributeName=\"transform\" "
                      "type=\"translate\" dur=\"{3}s\" repeatCount=\"indefinite\" values=\"0 0;{4} 0\"/></path>\n",
                      px(left), px(top - 4), px(bottom), seconds_shown, px(right - left));
  }

  const Animation& of_;
  double scale_, middle_;
};

}  // namespace

int frames_for(std::size_t points) {
  constexpr double most_bytes = 200e3, bytes_a_point = 12;
  return int(std::clamp(most_bytes / (bytes_a_point * double(points)), 12.0, 48.0));
}

std::string svg(const Animation& animation) { return Drawing(animation).text(); }

}  // namespace rosin::app::output
