// Outline:
//   1. where all unknowns are that are between their bounds: a plain least-squares problem by QR
//   2. on the way there the first bound that is met holds its unknown; from 1. until none is met
//   3. of unknowns at bounds that the gradient pulls inside, the one that it pulls most is let go; from 1.
//   until
//      there is none
// Every pass makes the sum smaller, so that no set of unknowns at bounds comes twice.
#include "studies/drive/bounded.h"

#include <algorithm>
#include <vector>

namespace isochor::drive {

namespace {

class ActiveSet {
 public:
  using Vector = Eigen::VectorXd;
  ActiveSet(const Eigen::MatrixXd& A, const Vector& b, const Vector& least, const Vector& most)
      : A_(A), b_(b), least_(least), most_(most), u_(Vector::Zero(A.cols()).cwiseMax(least).cwiseMin(most)) {
    for (Eigen::Index i = 0; i < u_.size(); ++i) free_.push_back(u_[i] > least[i] && u_[i] < most[i] ? 1 : 0);
  }

  bool solve() {
    const auto most_passes = 20 * (u_.size() + 1);
    for (Eigen::Index pass = 0; pass < most_passes; ++pass) {
      settle();
      if (!release()) return true;
    }
    return false;
  }
  const Vector& u() const { return u_; }

 private:
  // Where the free unknowns want to be, the others held.
  Vector wanted() const {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < u_.size(); ++i) {
      if (is_free(i)) free.push_back(i);
    }
    Vector out = u_;
    if (free.empty()) return out;
    Eigen::MatrixXd part(A_.rows(), static_cast<Eigen::Index>(free.size()));
    for (std::size_t k = 0; k < free.size(); ++k) part.col(static_cast<Eigen::Index>(k)) = A_.col(free[k]);
    const Vector way = part.colPivHouseholderQr().solve(b_ - A_ * u_);
    for (std::size_t k = 0; k < free.size(); ++k) out[free[k]] += way[static_cast<Eigen::Index>(k)];
    return out;
  }

  void settle() {
    for (;;) {
      const Vector goal = wanted();
      double part = 1;
      Eigen::Index first = -1;
      for (Eigen::Index i = 0; i < u_.size(); ++i) {
        if (!is_free(i) || (goal[i] >= least_[i] && goal[i] <= most_[i])) continue;
        const double bound = goal[i] < least_[i] ? least_[i] : most_[i];
        const double there = (bound - u_[i]) / (goal[i] - u_[i]);
        if (there < part || first < 0) part = std::min(part, there), first = i;
      }
      u_ = (u_ + part * (goal - u_)).cwiseMax(least_).cwiseMin(most_);
      if (first < 0) return;
      u_[first] = goal[first] < least_[first] ? least_[first] : most_[first];
      free_[static_cast<std::size_t>(first)] = 0;
    }
  }

  // False: no unknown wants to leave its bound.
  bool release() {
    const Vector off = A_ * u_ - b_, gradient = A_.transpose() * off;
    constexpr double rounding = 1e-13;
    double most_pull = 0;
    Eigen::Index which = -1;
    for (Eigen::Index i = 0; i < u_.size(); ++i) {
      if (is_free(i) || least_[i] == most_[i]) continue;
      const double inside = u_[i] <= least_[i] ? -gradient[i] : gradient[i];
      const double size = A_.col(i).norm() * (off.norm() + rounding * b_.norm());
      if (inside > rounding * size && inside > most_pull) most_pull = inside, which = i;
    }
    if (which < 0) return false;
    free_[static_cast<std::size_t>(which)] = 1;
    return true;
  }

  bool is_free(Eigen::Index i) const { return free_[static_cast<std::size_t>(i)] != 0; }

  const Eigen::MatrixXd& A_;
  const Vector& b_;
  const Vector &least_, &most_;
  Vector u_;
  std::vector<char> free_;
};

}  // namespace

Bounded least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& least,
                      const Eigen::VectorXd& most) {
  ActiveSet set(A, b, least, most);
  const bool converged = set.solve();
  return {converged, set.u()};
}

}  // namespace isochor::drive
