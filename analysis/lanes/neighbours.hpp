/// What neighbours in a tile of a parameter plane know of their cycles, brought to the place of another.
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

/// What a search has learned of a cycle, in units of its slider's scales.
struct KnownCycle {
  Eigen::VectorXd fixed_point;              ///< on the section
  Eigen::MatrixXd derivative, sensitivity;  ///< of the return map and of the metrics by the point on the section
  double derivative_error = 0;              ///< of the first, guessed
  double amplitude = 1;                     ///< |v − V|/V
  Eigen::VectorXd error_rate;  ///< relative errors of the metrics over the tolerance; empty: not to be told
  double expected_rate = 0;    ///< about the largest of them, as neighbours had it; 0: not known
};

class Tile;

/// Where a slider lies among the others. Sliders of a lower phase are looked for first, and advise those beside them.
struct GridPlace {
  Tile* tile = nullptr;  ///< keeps what is found, for later calls as well
  int column = 0, row = 0, phase = 0;
};

/// When the point at (column, row) is worked on: first a coarse grid, then the points half way between those that are
/// done, along the axes and then amid them. `coarsest`: stride of the first grid, a power of two.
int phase_of(int column, int row, int coarsest);

/// Cycles known in one tile.
class Tile {
 public:
  /// A known point on the row or column of another, and how far off it lies.
  struct Neighbour {
    int distance;  ///< signed
    int point;
  };
  struct Point {
    int column, row, phase;
    bool looked_for = false;  ///< by the call that is being prepared
    long tries = 0;           ///< that it took
    std::optional<KnownCycle> cycle = std::nullopt;
  };
  /// The point there, new if need be.
  int place(const GridPlace&);
  /// Points that may advise another, on its row or column: at most two on either side, nearest first; those known, and
  /// those of earlier phases that are looked for.
  std::vector<Neighbour> line(int point, bool along_row) const;
  /// What the points of these lines expect at a point; nothing where there are too few or too far away. Without error
  /// rates at every third halving of the grid: they are found anew there, so that they are never passed on for long.
  std::optional<KnownCycle> advice(int point, std::span<const std::vector<Neighbour>> lines) const;
  Point& operator[](int point) { return points_[point]; }

 private:
  std::deque<Point> points_;
  std::map<int, std::map<int, int>> rows_, columns_;  ///< [row][column] and [column][row] → point
};

/// The order of the sliders of one call: each waits for the neighbours that may advise it, and for no others.
class Neighbours {
 public:
  /// Of the sliders of these indices; `places`: of all, or none.
  Neighbours(std::span<const std::size_t> members, std::span<const GridPlace> places);
  /// The first slider that waits for nobody.
  std::optional<std::size_t> next();
  std::optional<KnownCycle> advice(std::size_t i) const;
  /// Nobody waits for this slider any longer. `cycle`: what there is to tell; `tries`: what it has taken.
  void finished(std::size_t i, std::optional<KnownCycle> cycle, long tries);

 private:
  struct Member {
    int point = 0;  ///< of its tile
    std::array<std::vector<Tile::Neighbour>, 2>
        lines;                         ///< fixed beforehand: who else is done first is a matter of luck
    int waits_for = 0;                 ///< how many sliders
    std::vector<std::size_t> waiting;  ///< sliders that wait for this one
  };
  void make_ready(std::size_t i);

  std::span<const GridPlace> places_;
  std::map<std::size_t, Member> members_;
  /// By phase, and in one phase those first whose neighbours took long: no lane is then left with one of them alone.
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
