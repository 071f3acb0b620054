/// The refinement of a patch and its error estimate.
#include "analysis/planes/patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "analysis/lanes/interpolant.hpp"
#include "analysis/lanes/neighbours.hpp"

namespace rosin::analysis::planes {

namespace {

constexpr int sampling = 4;  ///< every fourth pixel along both axes is asked for its class
/// On the largest error at held-out pixels, which may not be the largest of all; more where the polynomial of one
/// degree less is nearly as good, as where a quantity has a root or a kink.
constexpr double safety = 2, safety_where_rough = 6, rough = 0.6;
constexpr std::uint8_t unasked = 255;  ///< class
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double unbounded = std::numeric_limits<double>::infinity();

}  // namespace

int Patch::degree(double tolerance) {
  constexpr double small = 3e-5;
  return tolerance < small ? 6 : 4;
}

Patch::Lattice::Lattice(int pixels, int degree) : length(pixels - 1) {
  // As fine as the pixels, or up to twice as coarse: what lies between is computed directly where that is too coarse.
  intervals = std::min(length, degree);
  coarsest = 1;
  while (length > 0 && intervals * coarsest * 2 <= length) coarsest *= 2;
  cells = std::max(1, intervals * coarsest);
}

Patch::Patch(Options options, std::function<Class(int, int)> classify)
    : options_(std::move(options)),
      classify_(std::move(classify)),
      all_(options_.quantities),
      lattice_x_(options_.width, degree(options_.tolerance)),
      lattice_y_(options_.height, degree(options_.tolerance)) {
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

int Patch::phase(int pixel) const {
  // Half indices for what lies between the finest.
  const auto doubled = [](const Lattice& lattice, int at) {
    if (lattice.length == 0) return 0;
    const int index = lattice.index(at);
    return 2 * index + (lattice.pixel(index) != at);
  };
  const int x = pixel % options_.width, y = pixel / options_.width;
  return lanes::phase_of(doubled(lattice_x_, x), doubled(lattice_y_, y),
                         4 * std::max(lattice_x_.coarsest, lattice_y_.coarsest));
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
  const auto nodes = [](const Lattice& lattice, const Side& side) {
    if (side.line >= 0) return std::vector{side.line};
    std::vector<int> pixels;
    for (int i = 0; i <= lattice.intervals; ++i) pixels.push_back(lattice.pixel(side.begin + i * side.stride));
    return pixels;
  };
  g.x = nodes(lattice_x_, leaf.x);
  g.y = nodes(lattice_y_, leaf.y);
  g.x0 = g.x.front(), g.x1 = g.x.back(), g.y0 = g.y.front(), g.y1 = g.y.back();
  const int nx = int(g.x.size()) - 1, ny = int(g.y.size()) - 1;
  // The error of evenly spaced nodes is largest in the outermost intervals. −1: no pixel in between.
  const auto halves = [](const Lattice& lattice, const Side& side, int intervals) {
    std::vector<int> pixels;
    for (int i = 0; i < intervals; ++i) {
      const int at = side.begin + i * side.stride;
      const int low = lattice.pixel(at), high = lattice.pixel(at + side.stride);
      pixels.push_back(high - low < 2 ? -1 : side.stride > 1 ? lattice.pixel(at + side.stride / 2) : low + 1);
    }
    return pixels;
  };
  const auto hx = halves(lattice_x_, leaf.x, nx), hy = halves(lattice_y_, leaf.y, ny);
  using Test = Geometry::Test;
  const auto add = [&](int x, int y, Test::Shows what) {
    if (x >= 0 && y >= 0) g.held_out.push_back({x, y, what});
  };
  if (ny == 0) {
    for (const int x : hx) add(x, g.y0, Test::along_x);
    return g;
  }
  if (nx == 0) {
    for (const int y : hy) add(g.x0, y, Test::along_y);
    return g;
  }
  add(hx.front(), g.y[ny / 3], Test::along_x);
  add(hx.back(), g.y[ny - ny / 3], Test::along_x);
  add(g.x[nx - nx / 3], hy.front(), Test::along_y);
  add(g.x[nx / 3], hy.back(), Test::along_y);
  for (const int x : {hx.front(), hx.back()})
    for (const int y : {hy.front(), hy.back()}) add(x, y, Test::amid);
  return g;
}

Patch::Classes Patch::classes(const Geometry& g) {
  const auto class_at = [&](int x, int y) { return class_of(y * options_.width + x); };
  const auto line = [](int from, int to) {
    std::vector<int> places;
    for (int i = from; i < to; i += sampling) places.push_back(i);
    places.push_back(to);
    return places;
  };
  const auto columns = line(g.x0, g.x1), rows = line(g.y0, g.y1);
  const auto mixed = [](const std::vector<int>& lines, const std::vector<int>& along, const auto& at) {
    double count = 0;
    for (const int i : lines)
      count += !std::ranges::all_of(along, [&](int j) { return at(i, j) == at(i, along.front()); });
    return count / double(lines.size());
  };
  const double mixed_rows = mixed(rows, columns, [&](int y, int x) { return class_at(x, y); }),
               mixed_columns = mixed(columns, rows, [&](int x, int y) { return class_at(x, y); });
  // A border that follows an axis lies in few lines: to be cut off along the other.
  if (mixed_rows > 0 || mixed_columns > 0)
    return {Uniform::no, mixed_rows < 0.5 * mixed_columns   ? Direction::y
                         : mixed_columns < 0.5 * mixed_rows ? Direction::x
                                                            : g.longer()};
  const Class first = class_at(g.x0, g.y0);
  for (const int y : g.y)
    for (const int x : g.x)
      if (class_at(x, y) != first) return {Uniform::no, g.longer()};
  for (const auto& test : g.held_out)
    if (class_at(test.x, test.y) != first) return {Uniform::no, g.longer()};
  return {first == blank ? Uniform::blank : Uniform::yes};
}

void Patch::divide(const Leaf& leaf, const Geometry& g, Direction preferred) {
  const auto can_halve = [](const Side& side) { return side.line < 0 && side.stride > 1; };
  const auto halve = [&](const Lattice& lattice, Side Leaf::*side) {
    Leaf low = leaf, high = leaf;
    (low.*side).stride /= 2;
    (high.*side) = {(leaf.*side).begin + lattice.intervals * (low.*side).stride, (low.*side).stride};
    open_.push_back(low);
    open_.push_back(high);
  };
  const bool along_x = preferred == Direction::x;
  if (can_halve(along_x ? leaf.x : leaf.y)) return along_x ? halve(lattice_x_, &Leaf::x) : halve(lattice_y_, &Leaf::y);
  // Lines across the preferred axis, if they are long enough by themselves.
  const bool is_line = leaf.x.line >= 0 || leaf.y.line >= 0;
  if (!is_line && can_halve(along_x ? leaf.y : leaf.x)) {
    for (int i = along_x ? g.x0 : g.y0; i <= (along_x ? g.x1 : g.y1); ++i) {
      Leaf line = leaf;
      (along_x ? line.x : line.y).line = i;
      open_.push_back(line);
    }
    return;
  }
  compute_directly(g);
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
    const Classes found = classes(g);
    if (found.uniform == Uniform::no) {
      divide(leaf, g, found.divide);
      continue;
    }
    if (found.uniform == Uniform::blank) {
      for (int y = g.y0; y <= g.y1; ++y)
        for (int x = g.x0; x <= g.x1; ++x)
          if (auto& origin = origin_[y * options_.width + x]; origin == Origin::none) origin = Origin::blank;
      continue;
    }
    if (!g.pays()) {
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
    if (const auto direction = interpolate(g)) divide(leaf, g, *direction);
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

/// How one quantity is interpolated on a leaf.
struct Patch::Fit {
  std::optional<lanes::Interpolant> interpolant;  ///< nothing: the quantity exists nowhere
  double shown = 0, shown_along_x = 0,
         shown_along_y = 0;  ///< errors at held-out pixels, relative; the first with safety
  double size = 0;           ///< what relative errors refer to, where it is constant; 0: the value itself,
  std::optional<lanes::NodeValues> log_size;  ///< or this
  double size_at(const lanes::NodeWeights& place, double value) const {
    return log_size ? std::exp(log_size->at(place)) : size > 0 ? size : std::abs(value);
  }
};

/// A held-out pixel: weights there, and those with one node less along the axis that is tested.
struct Patch::HeldOut {
  int pixel;
  Geometry::Test::Shows shows;
  lanes::NodeWeights weights, fewer;
};

/// The held-out pixels with their weights.
std::vector<Patch::HeldOut> Patch::held_out(const Geometry& g) const {
  const auto one_less = [](std::vector<int> line, int place) {
    const bool drop_last = 2 * place < line.front() + line.back();  // the node farthest away
    const std::size_t dropped = drop_last ? line.size() - 1 : 0;
    line.erase(line.begin() + long(dropped));
    auto w = lanes::lagrange_weights(line, place);
    w.insert(w.begin() + long(dropped), 0.0);
    return w;
  };
  std::vector<HeldOut> tests;
  for (const auto& test : g.held_out) {
    const lanes::NodeWeights weights{lanes::lagrange_weights(g.x, test.x), lanes::lagrange_weights(g.y, test.y)};
    tests.push_back({test.y * options_.width + test.x, test.shows, weights, weights});
    if (test.shows == Geometry::Test::along_x) tests.back().fewer.x = one_less(g.x, test.x);
    if (test.shows == Geometry::Test::along_y) tests.back().fewer.y = one_less(g.y, test.y);
  }
  return tests;
}

/// Quantity q in the form that the held-out pixels bear out best. Nothing: none is of use.
std::optional<Patch::Fit> Patch::fit(const Geometry& g, const std::vector<HeldOut>& tests, const std::vector<Fit>& fits,
                                     int q) const {
  lanes::NodeValues values;
  std::vector<double> sizes;
  for (const int y : g.y)
    for (const int x : g.x) {
      const std::size_t at = std::size_t(y * options_.width + x) * all_ + q;
      values.value.push_back(value_[at]);
      values.error.push_back(error_[at]);
      sizes.push_back(size_[at]);
    }
  Fit fit;
  const auto missing = std::ranges::count_if(values.value, [](double v) { return std::isnan(v); });
  if (missing == std::ssize(values.value)) return fit;
  if (missing > 0) return std::nullopt;
  std::vector<lanes::Interpolant> candidates = {lanes::Interpolant::plain(values)};
  const bool helps = q >= options_.quantities - options_.helpers;  // as it is
  if (!helps && std::ranges::all_of(values.value, [](double v) { return v > 0; }))
    candidates.push_back(lanes::Interpolant::logarithm(values));
  for (const auto& root : options_.roots) {
    if (root.quantity != q) continue;
    const lanes::Interpolant& helper = *fits[root.helper].interpolant;
    const auto before = std::ranges::count_if(helper.nodes().value, [&](double h) { return h < root.threshold; });
    if (before == 0) continue;
    auto candidate = lanes::Interpolant::root(g.x, g.y, values, helper, root.threshold);
    // Only the root knows where it begins: held-out pixels may lie to either side of it.
    if (before < std::ssize(values.value)) candidates.clear();
    if (candidate) candidates.push_back(std::move(*candidate));
  }
  fit.shown = unbounded;
  for (auto& candidate : candidates) {
    double all = 0, x = 0, y = 0, coarser_x = 0, coarser_y = 0;
    const auto raise = [](double& largest, double value) {
      if (!(value <= largest)) largest = value;  // NaN too
    };
    for (const auto& test : tests) {
      const std::size_t at = std::size_t(test.pixel) * all_ + q;
      const double off = std::abs(candidate.at(test.weights) - value_[at]) / size_[at];
      raise(all, off);
      if (test.shows == Geometry::Test::amid) continue;
      const bool along_x = test.shows == Geometry::Test::along_x;
      raise(along_x ? x : y, off);
      raise(along_x ? coarser_x : coarser_y, std::abs(candidate.at(test.fewer) - value_[at]) / size_[at]);
    }
    all *= x > rough * coarser_x || y > rough * coarser_y ? safety_where_rough : safety;
    if (!(all < fit.shown)) continue;
    fit.shown = all, fit.shown_along_x = x, fit.shown_along_y = y;
    fit.interpolant = std::move(candidate);
  }
  if (!std::isfinite(fit.shown)) return std::nullopt;
  fit.interpolant->shown = fit.shown;
  for (const auto& test : tests) fit.interpolant->compared_at(test.weights);
  bool same = true, itself = true;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    same &= sizes[k] == sizes[0];
    itself &= sizes[k] == std::abs(values.value[k]);
  }
  if (itself) return fit;
  if (same) {
    fit.size = sizes[0];
  } else {
    for (double& size : sizes) size = std::log(size);
    fit.log_size = lanes::NodeValues{std::move(sizes), {}};
  }
  return fit;
}

std::optional<Patch::Direction> Patch::interpolate(const Geometry& g) {
  const int kind = kind_[g.y0 * options_.width + g.x0];
  const auto alike = [&](int x, int y) { return kind_[y * options_.width + x] == kind; };
  for (const int y : g.y)
    for (const int x : g.x)
      if (!alike(x, y)) return g.longer();
  for (const auto& test : g.held_out)
    if (!alike(test.x, test.y)) return g.longer();

  const auto tests = held_out(g);
  std::vector<Fit> fits(all_);
  const int interest = options_.quantities - options_.helpers;
  double worst_x = 0, worst_y = 0, worst = 0;
  for (int q = all_ - 1; q >= 0; --q) {  // helpers first
    auto found = fit(g, tests, fits, q);
    if (!found) return g.longer();
    fits[q] = std::move(*found);
    if (q >= interest) continue;
    worst = std::max(worst, fits[q].shown);
    worst_x = std::max(worst_x, fits[q].shown_along_x), worst_y = std::max(worst_y, fits[q].shown_along_y);
  }
  if (worst > options_.tolerance)
    return worst_x == worst_y ? g.longer() : worst_x > worst_y ? Direction::x : Direction::y;
  return fill(g, fits, kind) ? std::nullopt : std::optional(g.longer());
}

/// Every pixel, with what the errors of the nodes make of it. Few where that is too much, as beside the beginning of a
/// root, are computed themselves. \returns false if it is too much at many.
bool Patch::fill(const Geometry& g, const std::vector<Fit>& fits, int kind) {
  const int interest = options_.quantities - options_.helpers;
  std::vector<std::vector<double>> of_column, of_row;
  for (int x = g.x0; x <= g.x1; ++x) of_column.push_back(lanes::lagrange_weights(g.x, x));
  for (int y = g.y0; y <= g.y1; ++y) of_row.push_back(lanes::lagrange_weights(g.y, y));
  std::vector<int> filled, doubtful;
  lanes::NodeWeights place;
  for (int y = g.y0; y <= g.y1; ++y) {
    place.y = of_row[y - g.y0];
    for (int x = g.x0; x <= g.x1; ++x) {
      const int pixel = y * options_.width + x;
      if (origin_[pixel] != Origin::none) continue;
      place.x = of_column[x - g.x0];
      bool within = true;
      for (int q = 0; q < interest && within; ++q) {
        if (!fits[q].interpolant) continue;
        const std::size_t at = std::size_t(pixel) * all_ + q;
        value_[at] = fits[q].interpolant->at(place);
        const double size = fits[q].size_at(place, value_[at]);
        error_[at] = std::hypot(fits[q].interpolant->error_at(place), fits[q].shown * size);
        within = error_[at] <= options_.tolerance * size;
      }
      (within ? filled : doubtful).push_back(pixel);
    }
  }
  const bool good = 4 * doubtful.size() <= filled.size();
  const auto take_back = [&](const std::vector<int>& pixels) {
    for (const int pixel : pixels) {
      const long at = long(pixel) * all_;
      std::fill_n(value_.begin() + at, all_, nothing);
      std::fill_n(error_.begin() + at, all_, nothing);
    }
  };
  take_back(doubtful);
  if (!good) {
    take_back(filled);
    return false;
  }
  for (const int pixel : filled) {
    origin_[pixel] = Origin::interpolated;
    kind_[pixel] = std::int8_t(kind);
  }
  direct_.insert(direct_.end(), doubtful.begin(), doubtful.end());
  return true;
}

}  // namespace rosin::analysis::planes
