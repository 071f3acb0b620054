/// The parts of a plane, each of which is computed in one piece, and who computes them: threads of this process, its
/// share of a plane, or several processes.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// Points [row by row] with what was found there.
using FinishedPoints = std::vector<std::pair<std::size_t, MapPoint>>;

/// A plane cut into rectangles of points. Nothing that is found in one depends on the others, nor on who computes it.
class Partition {
 public:
  using Pieces = std::vector<std::pair<int, int>>;  ///< [first, end) along one axis
  /// How many of so many open parts one of so many threads, of all processes, best computes at a time.
  using Together = std::size_t (*)(std::size_t open, std::size_t threads);
  Partition(Pieces columns, Pieces rows, Together together);

  std::size_t count() const { return columns_.size() * rows_.size(); }
  std::size_t points() const { return width_ * std::size_t(rows_.back().second); }
  /// Columns and rows of a part.
  std::array<int, 2> size(std::size_t part) const;
  /// Calls f(index of the point, column, row) for each point of a part.
  template <class F>
  void for_each(std::size_t part, F f) const {
    const auto [x0, x1] = columns_[part % columns_.size()];
    const auto [y0, y1] = rows_[part / columns_.size()];
    for (int iy = y0; iy < y1; ++iy)
      for (int ix = x0; ix < x1; ++ix) f(std::size_t(iy) * width_ + std::size_t(ix), ix - x0, iy - y0);
  }
  /// The share, 0 … count − 1, that each part belongs to. Shares have alike many parts, which lie scattered over the
  /// whole plane, so that they cost alike. \throws InputError for more shares than parts.
  std::vector<int> shares(int count) const;
  std::size_t together(std::size_t open, std::size_t threads) const { return together_(open, threads); }

 private:
  Pieces columns_, rows_;
  Together together_;
  std::size_t width_;
};

/// How a plane is cut: patches that are interpolated, tiles whose points help each other to a start, or, of
/// structures, points by themselves; many at a time where lanes follow them.
Partition partition_of(const MapOptions&, bool structure, bool in_lanes = false);
/// Pieces whose last value belongs to the next as well; given without it, but for the last.
Partition::Pieces patches_along(const Axis&);

struct PartCost {
  std::size_t part;
  double seconds;  ///< of one processor
};

/// Parts that are computed together.
struct Group {
  std::size_t number = 0;
  std::vector<std::size_t> parts;
};

/// What came of a group since the report before.
struct Report {
  std::size_t group = 0;
  FinishedPoints points;
  double work = 0;  ///< step attempts
  bool finished = false;
  std::vector<PartCost> costs;  ///< once it is finished
};

/// Groups as they are handed out to whoever computes them; for several threads.
class Queue {
 public:
  virtual ~Queue() = default;
  /// What to compute next; no parts: nothing is left.
  virtual Group next() = 0;
  virtual void take(Report) = 0;
};

/// The processes that compute one plane.
class Crew {
 public:
  virtual ~Crew() = default;
  /// True of the process that hands groups out, and comes to know all points.
  virtual bool leads() const = 0;
  virtual int processes() const = 0;
  /// Calls compute(queue) in each of `threads` threads. Where it leads, the queue is `whole`, whose groups are handed
  /// to the other processes too, and it returns when all is done; elsewhere `whole` is empty, and the queue is that of
  /// the process that leads. \throws Stopped
  virtual void work(Queue& whole, int threads, const std::function<void(Queue&)>& compute) = 0;
};

/// Takes over what the computation of one group finds, as it is found.
class Desk {
 public:
  Desk(Queue& queue, const Group& group) : queue_(queue), group_(group) {}
  /// Hands points over, which leaves none, and says what work was done since before.
  void points(FinishedPoints&);
  /// A part has taken so many more step attempts.
  void work(std::size_t part, double attempts);
  /// All is handed over. The time (s) is shared out to the parts by their attempts, and by their points, each of which
  /// was judged.
  void finish(const Partition&, double seconds);

 private:
  Queue& queue_;
  const Group& group_;
  std::map<std::size_t, double> attempts_;
  double work_ = 0;  ///< not told yet
};

/// Step attempts that parts are expected to take, where somebody watches, and how much of it they usually take.
struct Expectation {
  std::function<double(std::size_t part)> attempts = nullptr;  ///< none: all take alike
  double usual = 1;
};

/// Computes what is missing of a plane, or of a share of it, whose points are blank: takes over those that are known,
/// and calls compute(parts, desk) for groups of the others. \throws Stopped
void compute_parts(const Partition&, const Expectation&, const MapOptions&, const MapHooks&, Map&,
                   const std::function<void(const std::vector<std::size_t>& parts, Desk&)>& compute);

}  // namespace rosin::analysis::planes
