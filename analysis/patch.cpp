/// The refinement of a patch and its error estimate.
#include "analysis/patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosin::analysis {

namespace {

constexpr int most_intervals = 6;  ///< of a leaf along one axis
constexpr int sampling = 4;        ///< every fourth pixel along both axes is asked for its class
/// On the largest error at held-out pixels, which may not be the largest of all; more where the polynomial of one
/// degree less is nearly as good, as where a quantity has a root or a kink.
constexpr double safety = 2, safety_where_rough = 6, rough = 0.6;
constexpr std::uint8_t unasked = 255;  ///< class
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Lagrange's weights of the nodes at a place.
std::vector<double> weights(const std::vector<int>& nodes, int place) {
  std::vector<double> w(nodes.size(), 1.0);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != i) w[i] *= double(place - nodes[j]) / (nodes[i] - nodes[j]);
  return w;
}

}  // namespace

Patch::Lattice::Lattice(int pixels) : length(pixels - 1) {
  // As fine as the pixels, or up to twice as coarse: what lies between is computed directly where that is too coarse.
  intervals = std::min(length, most_intervals);
  coarsest = 1;
  while (length > 0 && intervals * coarsest * 2 <= length) coarsest *= 2;
  cells = std::max(1, intervals * coarsest);
}

/// A leaf in pixels.
struct Patch::Geometry {
  struct Test {
    int x, y;  ///< pixel
    enum { along_x, along_y, amid } shows;
  };
  int x0, x1, y0, y1;          ///< inclusive
  std::vector<int> x, y;       ///< of the nodes
  std::vector<Test> held_out;  ///< half way between nodes
};

Patch::Patch(Options options, std::function<Class(int, int)> classify)
    : options_(std::move(options)),
      classify_(std::move(classify)),
      all_(options_.quantities),
      lattice_x_(options_.width),
      lattice_y_(options_.height) {
  const std::size_t pixels = std::size_t(options_.width) * options_.height;
  class_.assign(pixels, unasked);
  origin_.assign(pixels, Origin::none);
  kind_.assign(pixels, 0);
  value_.assign(pixels * all_, nothing);
  error_.assign(pixels * all_, nothing);
  size_.assign(pixels * all_, nothing);
  open_.push_back({{0, lattice_x_.coarsest}, {0, lattice_y_.coarsest}});
}

Patch::Class Patch::class_of(int pixel) {
  auto& known = class_[pixel];
  if (known == unasked) known = classify_(pixel % options_.width, pixel / options_.width);
  return known;
}

void Patch::set(int pixel, int kind, PixelValues found) {
  if (known(pixel)) return;
  origin_[pixel] = Origin::computed;
  kind_[pixel] = std::int8_t(kind);
  ++computed_;
  const std::size_t at = std::size_t(pixel) * all_;
  std::copy(found.value.begin(), found.value.end(), value_.begin() + at);
  std::copy(found.error.begin(), found.error.end(), error_.begin() + at);
  std::copy(found.size.begin(), found.size.end(), size_.begin() + at);
}

Patch::Geometry Patch::geometry(const Leaf& leaf) const {
  Geometry g;
  for (int i = 0; i <= lattice_x_.intervals; ++i) g.x.push_back(lattice_x_.pixel(leaf.x.begin + i * leaf.x.stride));
  for (int i = 0; i <= lattice_y_.intervals; ++i) g.y.push_back(lattice_y_.pixel(leaf.y.begin + i * leaf.y.stride));
  g.x0 = g.x.front(), g.x1 = g.x.back(), g.y0 = g.y.front(), g.y1 = g.y.back();
  // The error of evenly spaced nodes is largest in the outermost intervals. −1: no pixel in between.
  const auto half = [](const Lattice& lattice, const Side& side, int interval) {
    const int at = side.begin + interval * side.stride;
    const int a = lattice.pixel(at), b = lattice.pixel(at + side.stride);
    if (b - a < 2) return -1;
    return side.stride > 1 ? lattice.pixel(at + side.stride / 2) : a + 1;
  };
  const int nx = lattice_x_.intervals, ny = lattice_y_.intervals;
  std::vector<int> hx, hy;
  for (const int i : {0, nx - 1, nx / 2}) hx.push_back(nx > 0 ? half(lattice_x_, leaf.x, i) : -1);
  for (const int i : {0, ny - 1, ny / 2}) hy.push_back(ny > 0 ? half(lattice_y_, leaf.y, i) : -1);
  const auto add = [&](int x, int y, decltype(Geometry::Test::shows) what) {
    if (x >= 0 && y >= 0) g.held_out.push_back({x, y, what});
  };
  using Test = Geometry::Test;
  add(hx[0], g.y[ny / 3], Test::along_x);
  add(hx[1], g.y[ny - ny / 3], Test::along_x);
  add(g.x[nx - nx / 3], hy[0], Test::along_y);
  add(g.x[nx / 3], hy[1], Test::along_y);
  for (const int x : {hx[0], hx[1]})
    for (const int y : {hy[0], hy[1]}) add(x, y, Test::amid);
  add(hx[2], hy[2], Test::amid);
  return g;
}

Patch::Uniform Patch::uniform(const Geometry& g) {
  const Class first = class_of(g.y0 * options_.width + g.x0);
  const auto same = [&](int x, int y) { return class_of(y * options_.width + x) == first; };
  const auto line = [](int from, int to) {
    std::vector<int> places;
    for (int i = from; i < to; i += sampling) places.push_back(i);
    places.push_back(to);
    return places;
  };
  for (const int y : g.y)
    for (const int x : g.x)
      if (!same(x, y)) return Uniform::no;
  const auto columns = line(g.x0, g.x1);
  for (const int y : line(g.y0, g.y1))
    for (const int x : columns)
      if (!same(x, y)) return Uniform::no;
  for (const auto& test : g.held_out)
    if (!same(test.x, test.y)) return Uniform::no;
  return first == blank ? Uniform::blank : Uniform::yes;
}

bool Patch::divide(const Leaf& leaf, bool prefer_x) {
  const bool can_x = leaf.x.stride > 1, can_y = leaf.y.stride > 1;
  if (!can_x && !can_y) return false;
  const bool along_x = can_x && (prefer_x || !can_y);
  Leaf low = leaf, high = leaf;
  const auto halve = [](const Lattice& lattice, Side& a, Side& b) {
    a.stride /= 2;
    b = {a.begin + lattice.intervals * a.stride, a.stride};
  };
  if (along_x)
    halve(lattice_x_, low.x, high.x);
  else
    halve(lattice_y_, low.y, high.y);
  open_.push_back(low);
  open_.push_back(high);
  return true;
}

void Patch::compute_directly(const Geometry& g) {
  for (int y = g.y0; y <= g.y1; ++y)
    for (int x = g.x0; x <= g.x1; ++x) {
      const int pixel = y * options_.width + x;
      if (origin_[pixel] != Origin::none) continue;
      if (class_of(pixel) == blank)
        origin_[pixel] = Origin::blank;
      else
        direct_.push_back(pixel);
    }
}

Patch::Wanted Patch::advance() {
  Wanted wanted;
  std::vector<Leaf> waiting;
  while (!open_.empty()) {
    const Leaf leaf = open_.back();
    open_.pop_back();
    const Geometry g = geometry(leaf);
    const bool wider = g.x1 - g.x0 >= g.y1 - g.y0;
    const auto divided = [&](bool prefer_x) {
      if (!divide(leaf, prefer_x)) compute_directly(g);
    };
    const Uniform kind = uniform(g);
    if (kind == Uniform::no) {
      divided(wider);
      continue;
    }
    if (kind == Uniform::blank) {
      for (int y = g.y0; y <= g.y1; ++y)
        for (int x = g.x0; x <= g.x1; ++x)
          if (auto& origin = origin_[y * options_.width + x]; origin == Origin::none) origin = Origin::blank;
      continue;
    }
    // Where nodes are most of the pixels, nothing is gained.
    const long pixels = long(g.x1 - g.x0 + 1) * (g.y1 - g.y0 + 1);
    if (pixels < 2 * long(g.x.size() * g.y.size() + g.held_out.size())) {
      compute_directly(g);
      continue;
    }
    bool complete = true;
    const auto need = [&](int x, int y) {
      const int pixel = y * options_.width + x;
      if (known(pixel)) return;
      complete = false;
      wanted.nodes.push_back(pixel);
    };
    for (const int y : g.y)
      for (const int x : g.x) need(x, y);
    for (const auto& test : g.held_out) need(test.x, test.y);
    if (!complete) {
      waiting.push_back(leaf);
      continue;
    }
    switch (interpolate(g)) {
      case Verdict::accepted:
        break;
      case Verdict::split_x:
        divided(true);
        break;
      case Verdict::split_y:
        divided(false);
        break;
      case Verdict::hopeless:
        divided(wider);
        break;
    }
  }
  open_ = std::move(waiting);
  std::ranges::sort(wanted.nodes);
  wanted.nodes.erase(std::ranges::unique(wanted.nodes).begin(), wanted.nodes.end());
  if (open_.empty() && !direct_given_) {
    direct_given_ = true;
    std::ranges::sort(direct_);
    direct_.erase(std::ranges::unique(direct_).begin(), direct_.end());
    std::erase_if(direct_, [&](int pixel) { return origin_[pixel] != Origin::none; });
    wanted.direct = std::move(direct_);
  }
  return wanted;
}

namespace {

/// How a quantity is interpolated: as it is, as its logarithm, or divided by the root of (threshold − helper).
enum class Form : std::uint8_t { plain, logarithm, root };

/// One quantity on the nodes of a leaf, in one form: f with absolute error e.
struct Interpolant {
  Form form = Form::plain;
  std::vector<double> f, e;  ///< row by row
};

}  // namespace

Patch::Verdict Patch::interpolate(const Geometry& g) {
  const int w = options_.width, columns = int(g.x.size()), rows = int(g.y.size()), nodes = columns * rows;
  std::vector<int> at;
  for (const int y : g.y)
    for (const int x : g.x) at.push_back(y * w + x);
  const int kind = kind_[at.front()];
  const auto alike = [&](int pixel) { return kind_[pixel] == kind; };
  if (!std::ranges::all_of(at, alike)) return Verdict::hopeless;
  for (const auto& test : g.held_out)
    if (!alike(test.y * w + test.x)) return Verdict::hopeless;
  const auto number = [&](const std::vector<double>& list, int pixel, int q) {
    return list[std::size_t(pixel) * all_ + q];
  };

  const auto sum_at = [&](const std::vector<double>& f, const std::vector<double>& wx, const std::vector<double>& wy,
                          bool absolute) {
    double sum = 0;
    for (int j = 0; j < rows; ++j) {
      double row = 0;
      for (int i = 0; i < columns; ++i) row += (absolute ? std::abs(wx[i]) : wx[i]) * f[j * columns + i];
      sum += (absolute ? std::abs(wy[j]) : wy[j]) * row;
    }
    return sum;
  };
  struct Place {
    std::vector<double> wx, wy;
  };
  std::vector<Place> places, lower;  // lower: with one node less along the axis that is tested
  const auto one_less = [](std::vector<int> line, int place) {
    const bool drop_last = 2 * place < line.front() + line.back();  // the node farthest away
    const std::size_t dropped = drop_last ? line.size() - 1 : 0;
    line.erase(line.begin() + long(dropped));
    auto w = weights(line, place);
    w.insert(w.begin() + long(dropped), 0.0);
    return w;
  };
  for (const auto& test : g.held_out) {
    places.push_back({weights(g.x, test.x), weights(g.y, test.y)});
    lower.push_back(places.back());
    if (test.shows == Geometry::Test::along_x) lower.back().wx = one_less(g.x, test.x);
    if (test.shows == Geometry::Test::along_y) lower.back().wy = one_less(g.y, test.y);
  }

  const int interest = options_.quantities - options_.helpers;
  std::vector<Interpolant> chosen(all_);
  std::vector<Interpolant> sizes(all_);     // logarithm of the size, where it is neither constant nor the value itself
  std::vector<double> shown(all_, 0.0);     // relative error of the interpolation, safety included
  std::vector<double> constant(all_, 0.0);  // size where constant; 0: the value itself; −1: by `sizes`
  double worst_x = 0, worst_y = 0, worst = 0;
  const auto plain = [&](int q) {
    Interpolant p;
    for (const int pixel : at) p.f.push_back(number(value_, pixel, q)), p.e.push_back(number(error_, pixel, q));
    return p;
  };
  const auto sqrt_of = [&](const Options::Root& root, double helper) {
    return std::sqrt(std::max(0.0, root.threshold - helper));
  };
  for (int q = all_ - 1; q >= 0; --q) {  // helpers first
    const Interpolant values = plain(q);
    if (std::ranges::any_of(values.f, [](double v) { return std::isnan(v); })) {
      if (std::ranges::all_of(values.f, [](double v) { return std::isnan(v); })) {
        chosen[q] = values;  // nowhere: nothing to interpolate
        continue;
      }
      return Verdict::hopeless;
    }
    std::vector<Interpolant> candidates = {values};
    if (std::ranges::all_of(values.f, [](double v) { return v > 0; })) {
      Interpolant p{Form::logarithm, values.f, values.e};
      for (int k = 0; k < nodes; ++k) p.e[k] /= p.f[k], p.f[k] = std::log(p.f[k]);
      candidates.push_back(std::move(p));
    }
    const Options::Root* root = nullptr;
    for (const auto& r : options_.roots)
      if (r.quantity == q) root = &r;
    const Interpolant helper = root ? plain(root->helper) : Interpolant{};
    if (root) {
      Interpolant p{Form::root, values.f, values.e};
      bool below = true;
      for (int k = 0; k < nodes && below; ++k) {
        const double d = root->threshold - number(value_, at[k], root->helper);
        below = d > 0;
        p.e[k] = p.e[k] / std::sqrt(d) + p.f[k] * number(error_, at[k], root->helper) / (2 * d * std::sqrt(d));
        p.f[k] /= std::sqrt(d);
      }
      if (below) candidates.push_back(std::move(p));
    }
    const auto value_at = [&](const Interpolant& candidate, const Place& place) {
      const double v = sum_at(candidate.f, place.wx, place.wy, false);
      if (candidate.form == Form::logarithm) return std::exp(v);
      if (candidate.form == Form::root) return v * sqrt_of(*root, sum_at(helper.f, place.wx, place.wy, false));
      return v;
    };
    double best = unbounded, best_x = 0, best_y = 0;
    for (auto& candidate : candidates) {
      double all = 0, x = 0, y = 0, coarser_x = 0, coarser_y = 0;
      const auto raise = [](double& largest, double value) {
        if (!(value <= largest)) largest = value;  // NaN too
      };
      for (std::size_t t = 0; t < places.size(); ++t) {
        const std::size_t pixel = std::size_t(g.held_out[t].y) * w + g.held_out[t].x;
        const double exact = number(value_, int(pixel), q), size = number(size_, int(pixel), q);
        const double off = std::abs(value_at(candidate, places[t]) - exact) / size;
        raise(all, off);
        if (g.held_out[t].shows == Geometry::Test::amid) continue;
        const bool along_x = g.held_out[t].shows == Geometry::Test::along_x;
        raise(along_x ? x : y, off);
        raise(along_x ? coarser_x : coarser_y, std::abs(value_at(candidate, lower[t]) - exact) / size);
      }
      all *= x > rough * coarser_x || y > rough * coarser_y ? safety_where_rough : safety;
      if (all < best) best = all, best_x = x, best_y = y, chosen[q] = std::move(candidate);
    }
    if (!std::isfinite(best)) return Verdict::hopeless;
    shown[q] = best;
    if (q >= interest) continue;
    worst = std::max(worst, best), worst_x = std::max(worst_x, best_x), worst_y = std::max(worst_y, best_y);
    bool same = true, itself = true;
    for (int k = 0; k < nodes; ++k) {
      const double s = number(size_, at[k], q);
      same &= s == number(size_, at[0], q);
      itself &= s == std::abs(values.f[k]);
    }
    constant[q] = itself ? 0 : same ? number(size_, at[0], q) : -1;
    if (constant[q] < 0)
      for (const int pixel : at) sizes[q].f.push_back(std::log(number(size_, pixel, q)));
  }
  if (worst > options_.tolerance)
    return worst_x == worst_y ? Verdict::hopeless : worst_x > worst_y ? Verdict::split_x : Verdict::split_y;

  // Every pixel, with what the errors of the nodes make of it; taken back if that is too much.
  std::vector<Place> of_column(g.x1 - g.x0 + 1), of_row(g.y1 - g.y0 + 1);
  for (int x = g.x0; x <= g.x1; ++x) of_column[x - g.x0].wx = weights(g.x, x);
  for (int y = g.y0; y <= g.y1; ++y) of_row[y - g.y0].wy = weights(g.y, y);
  struct Result {
    int pixel;
    std::vector<double> value, error;
  };
  std::vector<Result> results;
  for (int y = g.y0; y <= g.y1; ++y)
    for (int x = g.x0; x <= g.x1; ++x) {
      const int pixel = y * w + x;
      if (origin_[pixel] != Origin::none) continue;
      const auto &wx = of_column[x - g.x0].wx, &wy = of_row[y - g.y0].wy;
      Result result{pixel, std::vector<double>(all_, nothing), std::vector<double>(all_, nothing)};
      for (int q = 0; q < interest; ++q) {
        const auto& c = chosen[q];
        if (std::isnan(c.f[0])) continue;
        double v = sum_at(c.f, wx, wy, false), e = sum_at(c.e, wx, wy, true);
        if (c.form == Form::logarithm) v = std::exp(v), e *= v;
        if (c.form == Form::root) {
          const auto root = std::ranges::find(options_.roots, q, &Options::Root::quantity);
          const Interpolant helper = plain(root->helper);
          const double d = std::max(0.0, root->threshold - sum_at(helper.f, wx, wy, false));
          const double helper_error = sum_at(helper.e, wx, wy, true);
          e = std::sqrt(d) * e + (d > 0 ? std::abs(v) * helper_error / (2 * std::sqrt(d)) : 0);
          v *= std::sqrt(d);
        }
        const double size = constant[q] > 0    ? constant[q]
                            : constant[q] == 0 ? std::abs(v)
                                               : std::exp(sum_at(sizes[q].f, wx, wy, false));
        result.value[q] = v;
        result.error[q] = e + shown[q] * size;
        if (!(result.error[q] <= options_.tolerance * size)) return Verdict::hopeless;
      }
      results.push_back(std::move(result));
    }
  for (const auto& result : results) {
    origin_[result.pixel] = Origin::interpolated;
    kind_[result.pixel] = std::int8_t(kind);
    std::ranges::copy(result.value, value_.begin() + std::size_t(result.pixel) * all_);
    std::ranges::copy(result.error, error_.begin() + std::size_t(result.pixel) * all_);
  }
  return Verdict::accepted;
}

}  // namespace rosin::analysis
