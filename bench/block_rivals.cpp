/// CVODE's side of the elastic block: rates, and their Jacobian by rows.
#include "bench/block_rivals.hpp"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sundials/sundials_context.hpp>

namespace bench {
namespace {

// Unknowns: displacements, velocities, impulses of friction and of the load.
struct Touch {
  double friction = 0, load = 0;  ///< N, of the station
  double friction_by_a = 0, friction_by_w = 0, load_by_a = 0, load_by_rate = 0;
};

Touch touch(const BlockProblem& p, const BlockProblem::Station& s, const double* q, const double* v) {
  double a = 0, rate = 0, w = -p.speed;
  for (int k = 0; k < 3; ++k) a -= s.shape[k] * q[s.y[k]], rate -= s.shape[k] * v[s.y[k]], w += s.shape[k] * v[s.x[k]];
  Touch t;
  if (!(a > 0)) return t;
  const double part = std::abs(w) / p.width, sign = w < 0 ? -1 : 1;
  const double psi = part < 1 ? (2 - part) * w / p.width : sign, slope = part < 1 ? 2 * (1 - part) / p.width : 0;
  const double bound = p.friction * p.coefficient * a * a, stiff = p.coefficient + p.damping * rate;
  t.load = s.area * stiff * a * a, t.load_by_a = s.area * 2 * stiff * a, t.load_by_rate = s.area * p.damping * a * a;
  t.friction = -s.area * bound * psi;  // on the block
  t.friction_by_a = -s.area * 2 * p.friction * p.coefficient * a * psi, t.friction_by_w = -s.area * bound * slope;
  return t;
}

int rate(realtype, N_Vector y, N_Vector f, void* data) {
  const auto& p = *static_cast<const BlockProblem*>(data);
  const int n = int(p.mass.size());
  const double *q = N_VGetArrayPointer(y), *v = q + n;
  double *dq = N_VGetArrayPointer(f), *dv = dq + n;
  double elongation = 0;
  for (int i = 0; i < n; ++i) elongation += p.spring_row[i] * q[i];
  for (int i = 0; i < n; ++i) {
    double force = p.force[i] - p.spring * elongation * p.spring_row[i];
    for (int e = p.row_start[i]; e < p.row_start[i + 1]; ++e)
      force -= p.stiffness[e] * (q[p.column[e]] + p.stiffness_damping * v[p.column[e]]);
    dq[i] = v[i], dv[i] = force;
  }
  dq[2 * n] = dq[2 * n + 1] = 0;
  for (const auto& s : p.stations) {
    const Touch t = touch(p, s, q, v);
    for (int k = 0; k < 3; ++k) dv[s.x[k]] += s.shape[k] * t.friction, dv[s.y[k]] += s.shape[k] * t.load;
    dq[2 * n] += t.friction, dq[2 * n + 1] += t.load;
  }
  for (int i = 0; i < n; ++i) dv[i] /= p.mass[i];
  return 0;
}

/// Columns of the rows of the Jacobian: of a velocity those of K and of the spring, for displacements and velocities.
class Pattern {
 public:
  explicit Pattern(const BlockProblem& p) : p_(p), n_(int(p.mass.size())) {
    std::vector<std::vector<int>> columns(n_);
    for (int i = 0; i < n_; ++i) {
      auto& row = columns[i];
      row.assign(p.column.begin() + p.row_start[i], p.column.begin() + p.row_start[i + 1]);
      if (p.spring_row[i] != 0)
        for (int j = 0; j < n_; ++j)
          if (p.spring_row[j] != 0) row.push_back(j);
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
    }
    const auto begin_row = [&] { start.push_back(int(column.size())); };
    for (int i = 0; i < n_; ++i) begin_row(), column.push_back(i), column.push_back(n_ + i);
    for (int i = 0; i < n_; ++i) {
      begin_row();
      for (const int shift : {0, n_})
        for (const int j : columns[i]) column.push_back(shift + j);
    }
    std::vector<int> touched;
    for (const auto& s : p.stations)
      for (int k = 0; k < 3; ++k)
        for (const int j : {s.x[k], s.y[k], n_ + s.x[k], n_ + s.y[k]}) touched.push_back(j);
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const int impulse : {2 * n_, 2 * n_ + 1}) {
      begin_row();
      column.insert(column.end(), touched.begin(), touched.end());
      column.push_back(impulse);
    }
    begin_row();
    constant_.assign(column.size(), 0.0);
    for (int i = 0; i < n_; ++i) {
      constant_[at(i, n_ + i)] = 1;
      for (int e = p.row_start[i]; e < p.row_start[i + 1]; ++e) {
        constant_[at(n_ + i, p.column[e])] -= p.stiffness[e] / p.mass[i];
        constant_[at(n_ + i, n_ + p.column[e])] -= p.stiffness_damping * p.stiffness[e] / p.mass[i];
      }
      for (int j = 0; j < n_; ++j)
        if (p.spring_row[i] * p.spring_row[j] != 0)
          constant_[at(n_ + i, j)] -= p.spring * p.spring_row[i] * p.spring_row[j] / p.mass[i];
    }
  }
  int size() const { return 2 * n_ + 2; }
  void fill(const double* y, double* values) const {
    std::copy(constant_.begin(), constant_.end(), values);
    for (const auto& s : p_.stations) {
      const Touch t = touch(p_, s, y, y + n_);
      for (int l = 0; l < 3; ++l) {
        const int along = n_ + s.x[l], down = s.y[l], sinking = n_ + s.y[l];
        for (int k = 0; k < 3; ++k) {
          const double x = s.shape[k] * s.shape[l] / p_.mass[s.x[k]], z = s.shape[k] * s.shape[l] / p_.mass[s.y[k]];
          values[at(n_ + s.x[k], along)] += x * t.friction_by_w;
          values[at(n_ + s.x[k], down)] -= x * t.friction_by_a;
          values[at(n_ + s.y[k], down)] -= z * t.load_by_a;
          values[at(n_ + s.y[k], sinking)] -= z * t.load_by_rate;
        }
        values[at(2 * n_, along)] += s.shape[l] * t.friction_by_w;
        values[at(2 * n_, down)] -= s.shape[l] * t.friction_by_a;
        values[at(2 * n_ + 1, down)] -= s.shape[l] * t.load_by_a;
        values[at(2 * n_ + 1, sinking)] -= s.shape[l] * t.load_by_rate;
      }
    }
  }
  std::size_t at(int row, int col) const {
    const auto first = column.begin() + start[row], last = column.begin() + start[row + 1];
    return std::size_t(std::lower_bound(first, last, col) - column.begin());
  }
  std::vector<int> start, column;

 private:
  const BlockProblem& p_;
  int n_;
  std::vector<double> constant_;
};

struct Data {
  const BlockProblem* problem;  ///< first: rates see this alone
  const Pattern* pattern;
};
int rate_of(realtype t, N_Vector y, N_Vector f, void* data) {
  return rate(t, y, f, const_cast<BlockProblem*>(static_cast<Data*>(data)->problem));
}
int jacobian(realtype, N_Vector y, N_Vector, SUNMatrix J, void* data, N_Vector, N_Vector, N_Vector) {
  const Pattern& pattern = *static_cast<Data*>(data)->pattern;
  std::copy(pattern.start.begin(), pattern.start.end(), SM_INDEXPTRS_S(J));
  std::copy(pattern.column.begin(), pattern.column.end(), SM_INDEXVALS_S(J));
  pattern.fill(N_VGetArrayPointer(y), SM_DATA_S(J));
  return 0;
}

N_Vector start_of(const BlockProblem& p, SUNContext context) {
  const int n = int(p.mass.size());
  N_Vector y = N_VNew_Serial(2 * n + 2, context);
  N_VConst(0, y);
  for (int i = 0; i < n; ++i) NV_Ith_S(y, i) = p.start[std::size_t(i)];
  return y;
}

}  // namespace

BlockMotion follow_cvode_block(const BlockProblem& p, double tolerance) {
  BlockMotion found;
  sundials::Context context;
  const Pattern pattern(p);
  Data data{&p, &pattern};
  const int n = int(p.mass.size()), size = pattern.size();
  N_Vector y = start_of(p, context), absolute = N_VNew_Serial(size, context);
  // Approaches and their rates are of size 1, impulses of that of the load over the run.
  N_VConst(tolerance, absolute);
  NV_Ith_S(absolute, 2 * n) = NV_Ith_S(absolute, 2 * n + 1) = tolerance * p.duration;
  void* memory = CVodeCreate(CV_BDF, context);
  CVodeInit(memory, rate_of, 0, y);
  CVodeSetErrHandlerFn(
      memory, [](int, const char*, const char*, char*, void*) {}, nullptr);
  CVodeSetUserData(memory, &data);
  CVodeSVtolerances(memory, tolerance, absolute);
  SUNMatrix matrix = SUNSparseMatrix(size, size, sunindextype(pattern.column.size()), CSR_MAT, context);
  SUNLinearSolver linear = SUNLinSol_KLU(y, matrix, context);
  CVodeSetLinearSolver(memory, linear, matrix);
  CVodeSetJacFn(memory, jacobian);
  CVodeSetMaxNumSteps(memory, 100'000'000);
  double friction = 0, load = 0;
  for (const double end : {p.from, p.duration}) {
    CVodeSetStopTime(memory, end);
    double t = 0;
    const int flag = CVode(memory, end, y, &t, CV_NORMAL);
    if (flag < 0) {
      char* name = CVodeGetReturnFlagName(flag);
      found.failure = name;
      std::free(name);
      break;
    }
    friction = NV_Ith_S(y, 2 * n) - friction, load = NV_Ith_S(y, 2 * n + 1) - load;
  }
  found.friction = friction / load;
  CVodeGetNumSteps(memory, &found.steps);
  CVodeFree(&memory);
  SUNLinSolFree(linear);
  SUNMatDestroy(matrix);
  N_VDestroy(absolute);
  N_VDestroy(y);
  return found;
}

double block_jacobian_defect(const BlockProblem& p) {
  sundials::Context context;
  const Pattern pattern(p);
  const int n = int(p.mass.size()), size = pattern.size();
  N_Vector y = start_of(p, context), up = N_VNew_Serial(size, context), down = N_VNew_Serial(size, context);
  for (int i = 0; i < n; ++i) NV_Ith_S(y, n + i) = p.speed + 0.3 * p.width * std::sin(2.3 * i);  // sticks in part
  std::vector<double> values(pattern.column.size());
  pattern.fill(N_VGetArrayPointer(y), values.data());
  double worst = 0, largest = 0;
  for (int j = 0; j < size; ++j) {
    const double h = 1e-7, at = NV_Ith_S(y, j);
    BlockProblem copy = p;
    NV_Ith_S(y, j) = at + h, rate(0, y, up, &copy);
    NV_Ith_S(y, j) = at - h, rate(0, y, down, &copy);
    NV_Ith_S(y, j) = at;
    for (int i = 0; i < size; ++i) {
      const auto e = pattern.at(i, j);
      const bool there = e < std::size_t(pattern.start[i + 1]) && pattern.column[e] == j;
      const double slope = (NV_Ith_S(up, i) - NV_Ith_S(down, i)) / (2 * h);
      largest = std::max(largest, std::abs(slope));
      worst = std::max(worst, std::abs(slope - (there ? values[e] : 0)));
    }
  }
  for (N_Vector v : {y, up, down}) N_VDestroy(v);
  return worst / largest;
}

}  // namespace bench
