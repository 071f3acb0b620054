/// A rectangle of pixels whose quantities are computed at few of them and interpolated at the others, refined until
/// held-out pixels show the error that was asked.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace rosin::analysis::planes {

/// What one pixel holds: quantities with their absolute errors, and the sizes that relative errors refer to.
struct PixelValues {
  std::vector<double> value, error, size;
};

/// Refines itself step by step: compute what is `wanted`, give it with `set`, ask again until nothing is wanted. Knows
/// pixels and numbers, nothing of friction; the order of answers makes no difference.
///
/// The pixels are divided into leaves by bisection along either axis. A leaf has at most 5 × 5 nodes, of small
/// tolerances 7 × 7, evenly spaced (so that both halves use them again) and through them the polynomial of degree 4 or
/// 6 in both coordinates. Held-out pixels half way between nodes show its error along either axis; they are nodes of
/// the halves. Along borders and kinks that follow an axis a leaf ends as single lines of pixels, each interpolated by
/// itself.
class Patch {
 public:
  /// Of the polynomials, at most: to a moderate tolerance a low one spares nodes, most of them beside borders and
  /// kinks.
  static int degree(double tolerance);
  /// Pixels of one class may share a leaf; a leaf with several classes is divided.
  using Class = std::uint8_t;
  static constexpr Class blank = 0;  ///< nothing to compute: known from the class alone

  struct Options {
    int width = 1, height = 1;  ///< pixels
    double tolerance = 1e-3;    ///< of every quantity of interest, relative to its size
    int quantities = 1;         ///< the first ones are of interest, others only help
    int helpers = 0;            ///< how many of the quantities only help
    /// Quantities that vanish as a square root: q ∝ √(threshold − helper), or nothing.
    struct Root {
      int quantity, helper;
      double threshold;
    };
    std::vector<Root> roots = {};
  };
  /// `classify(ix, iy)`: the class of a pixel; asked once at most for each.
  Patch(Options, std::function<Class(int, int)> classify);

  enum class Origin : std::uint8_t { none, blank, computed, interpolated };
  struct Wanted {
    std::vector<int> nodes;   ///< pixels [iy * width + ix] on which others will rest: to a fraction of the tolerance
    std::vector<int> direct;  ///< pixels for their own sake, asked for once, at the end
    bool empty() const { return nodes.empty() && direct.empty(); }
  };
  /// What is to be computed next; nothing: the patch is finished.
  Wanted advance();
  /// `kind`: what was found there, such as a regime; only pixels of one kind are interpolated. Empty values: none
  /// exist.
  void set(int pixel, int kind, PixelValues);

  Origin origin(int pixel) const { return origin_[pixel]; }
  int kind(int pixel) const { return kind_[pixel]; }
  Class class_of(int pixel);
  /// When a node is looked at in the order of its lattice, from the coarsest to the finest; see `phase_of`.
  int phase(int pixel) const;
  /// Quantity q, with its absolute error; NaN where there is none.
  double value(int pixel, int q) const { return value_[std::size_t(pixel) * all_ + q]; }
  double error(int pixel, int q) const { return error_[std::size_t(pixel) * all_ + q]; }
  long computed() const { return computed_; }

 private:
  /// One axis: pixels, and the lattice of possible nodes, which is halved again and again.
  struct Lattice {
    Lattice(int pixels, int degree);
    int pixel(int index) const { return int((2L * index * length + cells) / (2L * cells)); }  // rounded
    int index(int pixel) const { return int((2L * pixel * cells + length) / (2L * length)); }
    int length, cells, intervals, coarsest;  ///< pixels − 1; indices − 1; of a leaf; stride of the whole
  };
  struct Side {
    int begin, stride;  ///< lattice indices
    int line = -1;      ///< if not negative: this one row or column of pixels
  };
  struct Leaf {
    Side x, y;
  };
  enum class Direction : std::uint8_t { x, y };
  /// A leaf in pixels.
  struct Geometry {
    struct Test {
      int x, y;  ///< pixel
      enum Shows : std::uint8_t { along_x, along_y, amid } shows;
    };
    int x0, x1, y0, y1;          ///< inclusive
    std::vector<int> x, y;       ///< of the nodes
    std::vector<Test> held_out;  ///< half way between nodes
    int width() const { return x1 - x0 + 1; }
    int height() const { return y1 - y0 + 1; }
    Direction longer() const { return width() >= height() ? Direction::x : Direction::y; }
    /// Fewer pixels than that are not worth their nodes.
    bool pays() const { return long(width()) * height() >= 2 * long(x.size() * y.size() + held_out.size()); }
  };
  Geometry geometry(const Leaf&) const;
  enum class Uniform : std::uint8_t { no, blank, yes };
  /// Whether one class fills it; if not, along which axis it is better divided.
  struct Classes {
    Uniform uniform;
    Direction divide = Direction::x;
  };
  Classes classes(const Geometry&);
  void divide(const Leaf&, const Geometry&, Direction preferred);
  void compute_directly(const Geometry&);
  struct Fit;
  struct HeldOut;
  std::vector<HeldOut> held_out(const Geometry&) const;
  std::optional<Fit> fit(const Geometry&, const std::vector<HeldOut>&, const std::vector<Fit>& helpers, int q) const;
  bool fill(const Geometry&, const std::vector<Fit>&, int kind);
  /// \returns along which axis to divide; nothing: it is done.
  std::optional<Direction> interpolate(const Geometry&);
  bool known(int pixel) const { return origin_[pixel] == Origin::computed; }

  Options options_;
  std::function<Class(int, int)> classify_;
  int all_;  ///< quantities with the helpers
  Lattice lattice_x_, lattice_y_;
  std::vector<Leaf> open_;
  std::vector<std::uint8_t> class_;  ///< 255: not asked yet
  std::vector<Origin> origin_;
  std::vector<std::int8_t> kind_;
  std::vector<double> value_, error_, size_;
  std::vector<int> direct_;
  bool direct_given_ = false;
  long computed_ = 0;
};

}  // namespace rosin::analysis::planes
