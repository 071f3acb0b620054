/// Cycles by multiple shooting, through stick: arcs from node to node, each followed by the one loop with its
/// derivative.
#pragma once
#include <complex>
#include <optional>
#include <vector>

#include "analysis/branches/oscillator.hpp"
#include "analysis/branches/problem.hpp"

namespace rosin::analysis::branches {

/// The test of slip that just comes to rest.
inline constexpr const char* grazing_of_landing = "grazing of a landing";
/// As it is told: slip that just touches rest, and slip that just comes to rest, graze alike.
inline std::string shown_kind(const std::string& kind) { return kind == grazing_of_landing ? "grazing" : kind; }

/// Unknowns: under a constant drive the period and the parts of it after which the nodes come; then the moving unknowns
/// at the nodes of the cycle. Each arc ends on the next node; under a constant drive no node moves along the cycle, so
/// that those of a relaxation cycle stay where they are on it while its long rest grows. Nodes stand so close that no
/// disturbance grows beyond 1e3 between two of them: cycles whose multipliers are 1e10 are closed as well as others.
class CycleProblem final : public Problem {
 public:
  /// \param turns  periods of the drive in a period; 1 where it is constant
  CycleProblem(Family family, int turns) : family_(std::move(family)), turns_(turns) {}

  /// A cycle through y, all unknowns of the system. \returns the unknowns of the problem there
  Eigen::VectorXd begin(const std::vector<double>& y, double period, double p);
  /// The cycle of two turns of one, and the direction of the branch that doubles: where a multiplier is −1.
  struct Doubled {
    std::unique_ptr<CycleProblem> problem;
    Eigen::VectorXd x, direction;
  };
  std::optional<Doubled> doubled(const Eigen::VectorXd& x, double p, double tolerance);
  /// Small cycles about steady sliding y where an eigenvector q oscillates with ω: unknowns at no amplitude, and the
  /// direction to one.
  struct Born {
    Eigen::VectorXd x, direction;
  };
  /// \param amplitude  of the unknowns, over their natural sizes
  Born born(const std::vector<double>& y, const Eigen::VectorXcd& q, double angular_frequency, double amplitude,
            double p);

  Residual residual(const Eigen::VectorXd& x, double p, double tolerance, bool slopes) override;
  const Eigen::VectorXd& scale() const override { return scale_; }
  View view(const Solved&, const Solved& looser) override;
  bool refer_to(Eigen::VectorXd& x, double p, double tolerance) override;
  int in_common() const override { return is_driven_ ? int(moving_.size()) : 1; }

  bool driven() const { return is_driven_; }
  int turns() const { return turns_; }
  /// Under a drive that varies, that of the drive at p, which may scale its time.
  double period(const Eigen::VectorXd& x, double p);
  /// Half the range of the cycle as a part of the unknowns' natural sizes.
  double amplitude() const { return amplitude_; }
  /// All unknowns at the first node.
  std::vector<double> start(const Eigen::VectorXd& x) const { return full(x, 0); }
  const std::vector<int>& moving() const { return moving_; }
  Oscillator& oscillator(double p);
  /// Where the family has changed beside its parameter.
  void forget_oscillator() { at_ = NAN, turn_.reset(); }
  long steps = 0;

 private:
  Residual residual_at(const Eigen::VectorXd& x, double p, double tolerance, bool slopes);
  struct Node {
    double part;            ///< of the period, since the first: under a constant drive a guess
    std::vector<double> y;  ///< unknowns there, of which those without rates of their own are a guess
  };
  struct Arc {
    std::vector<double> begin, end;  ///< all unknowns, those without rates of their own as they follow
  };
  using Observer = decltype(motion::Follower::observe);
  /// \param tangent  columns by the moving unknowns, then by the parameter where there are no stops
  Outcome follow_arc(int arc, const Eigen::VectorXd& x, double p, double tolerance, Arc&, const Observer& observe = {},
                     std::vector<double>* tangent = nullptr);
  /// A turn of the cycle step by step, with the derivative of each step in natural units.
  struct Turn {
    struct Step {
      double part;  ///< of the period, at its end
      std::vector<double> y;
      Eigen::MatrixXd by_start;      ///< moving × moving
      Eigen::VectorXd by_parameter;  ///< empty: there are stops
      Eigen::VectorXd rate;
      bool slips;
    };
    Eigen::VectorXd x;
    double p, tolerance;
    std::vector<std::vector<double>> begins;  ///< of arcs
    std::vector<Step> steps;
    std::vector<std::size_t> ends;  ///< of arcs, among the steps
  };
  Outcome follow_turn(const Solved&, const Observer&, Turn&);
  /// The turn that was followed last, if it is this one at least as accurately, else that followed now.
  Outcome keep_turn(const Solved&);
  /// Factors whose product is the derivative of the turn, in sizes, and across the motion where the drive is constant.
  std::vector<Eigen::MatrixXd> factors_of(const Turn&) const;
  Eigen::MatrixXd in_sizes(const Eigen::MatrixXd& derivative) const {
    return size_.cwiseInverse().asDiagonal() * derivative * size_.asDiagonal();
  }
  Oscillator& vary(double p);
  std::vector<double> full(const Eigen::VectorXd& x, int node) const;
  Eigen::VectorXd rates(double t, const std::vector<double>& y, double p);
  double start_of(int arc, const Eigen::VectorXd& x, double p) { return is_driven_ ? part(arc, x) * period(x, p) : 0; }
  double end_of(int arc, const Eigen::VectorXd& x, double p);
  double part(int node, const Eigen::VectorXd& x) const;
  Eigen::Index place(int node) const {
    return (is_driven_ ? 0 : Eigen::Index(nodes_.size())) + node * Eigen::Index(moving_.size());
  }
  Eigen::VectorXd unknowns(const std::vector<Node>&, double period) const;
  void set_scale(double period);
  void set_sizes(const Eigen::VectorXd& half_range, const std::vector<double>& y, double p);
  double accuracy(double tolerance) const;

  Family family_;
  int turns_;
  std::unique_ptr<Oscillator> oscillator_, larger_, smaller_;
  double at_ = NAN;   ///< the parameter of the oscillator
  double aside_ = 0;  ///< by which that of the two others differs
  bool is_driven_ = false;
  double drive_period_ = 0;  ///< last known: a drive whose amplitude is 0 has none
  std::vector<int> moving_;  ///< unknowns with a rate of their own
  std::vector<Node> nodes_;
  std::optional<Turn> turn_;  ///< followed last
  Eigen::VectorXd size_;      ///< of the moving unknowns in this cycle
  double amplitude_ = 1;
  Eigen::VectorXd scale_;
  /// Under a constant drive: where the nodes are, and the cycle's direction there, in sizes.
  struct Reference {
    Eigen::VectorXd node, along;
  };
  std::vector<Reference> references_;
};

}  // namespace rosin::analysis::branches
