/// Cycles of neighbouring points in a tile of a parameter plane, interpolated to another point.
#pragma once
#include <Eigen/Core>
#include <array>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <vector>

namespace rosin::analysis::lanes {

/// A cycle as a search found it, in units of its slider's scales.
struct KnownCycle {
  Eigen::VectorXd fixed_point;  ///< on the section
  Eigen::MatrixXd derivative,
      sensitivity;              ///< derivatives of the return map and of the metrics by the point on the section
  double derivative_error = 0;  ///< rough error of `derivative`
  double amplitude = 1;         ///< |v − V|/V
  Eigen::VectorXd
      error_rate;  ///< relative errors of the metrics over the tolerance; empty: not smooth between neighbours
  double expected_rate = 0;  ///< estimate of the largest of them, from neighbours; 0: not known
};

class Tile;

/// The place of a slider in the grid. Cycles of a lower phase are searched for first and predict neighbouring ones.
struct GridPlace {
  Tile* tile = nullptr;  ///< keeps the cycles for later calls too
  int column = 0, row = 0, phase = 0;
};

/// Phase of the point at (column, row): first a coarse grid, then the midpoints of known points, along the axes and
/// then between those. `coarsest`: stride of the first grid, a power of two.
int phase_of(int column, int row, int coarsest);

/// Cycles known in one tile.
class Tile {
 public:
  /// A known point on the row or column of another, with its distance.
  struct Neighbour {
    int distance;  ///< signed
    int point;
  };
  struct Point {
    int column, row, phase;
    bool looked_for = false;  ///< in the present call
    long tries = 0;           ///< step attempts that its search took
    std::optional<KnownCycle> cycle = std::nullopt;
  };
  /// The point at a place, new if there is none.
  int place(const GridPlace&);
  /// Points that may predict another, on its row or column: at most two on either side, nearest first; known ones, and
  /// those of earlier phases in the present call.
  std::vector<Neighbour> line(int point, bool along_row) const;
  /// The cycle at a point, interpolated from the points of these lines; nothing where these are too few or too far
  /// away.
  /// Every third halving of the grid omits the error rates, so that they are measured anew and never inherited for
  /// long.
  std::optional<KnownCycle> advice(int point, std::span<const std::vector<Neighbour>> lines) const;
  Point& operator[](int point) { return points_[point]; }

 private:
  std::deque<Point> points_;
  std::map<int, std::map<int, int>> rows_, columns_;  ///< [row][column] and [column][row] → point
};

/// The order of the sliders of one call: each waits only for the neighbours that may predict its cycle.
class Neighbours {
 public:
  /// `members`: indices of the sliders; `places`: one for every slider of the call, or none.
  Neighbours(std::span<const std::size_t> members, std::span<const GridPlace> places);
  /// The first slider that waits for no other.
  std::optional<std::size_t> next();
  std::optional<KnownCycle> advice(std::size_t i) const;
  /// Releases the sliders that wait for this one. `cycle`: its cycle, if found; `tries`: step attempts it took.
  void finished(std::size_t i, std::optional<KnownCycle> cycle, long tries);

 private:
  struct Member {
    int point = 0;  ///< index in its tile
    std::array<std::vector<Tile::Neighbour>, 2>
        lines;                         ///< fixed beforehand, so that results do not depend on the order of completion
    int waits_for = 0;                 ///< number of sliders
    std::vector<std::size_t> waiting;  ///< sliders that wait for this one
  };
  void make_ready(std::size_t i);

  std::span<const GridPlace> places_;
  std::map<std::size_t, Member> members_;
  /// Order by phase, and within a phase the slider with the slowest neighbours first, so that no lane is left alone
  /// with a slow one at the end.
  struct Ready {
    int phase;
    long tries;
    std::size_t slider;
    bool operator<(const Ready& other) const {
      return std::tie(phase, other.tries, slider) < std::tie(other.phase, tries, other.slider);
    }
  };
  std::set<Ready> ready_;
};

}  // namespace rosin::analysis::lanes
