#include "engine/scene/free_motions.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "engine/base/text.h"

namespace isochor {

namespace {

// All that is asked here, as other decompositions of small matrices would cost the compiler as much again
// each.
using Symmetric = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

// The directions of a space: axes where they span it, else vectors. Columns are orthonormal.
std::string directions(const Eigen::MatrixXd& space) {
  std::string axes, vectors;
  Eigen::Index found = 0;
  for (int k = 0; k < 3; ++k) {
    if (space.row(k).norm() < 1 - 1e-6) continue;
    axes += (found == 0 ? "" : (found + 1 == space.cols() ? " and " : ", ")) + std::string(1, "xyz"[k]);
    ++found;
  }
  if (found == space.cols()) return axes;
  for (Eigen::Index c = 0; c < space.cols(); ++c) {
    Vec3 v{space(0, c), space(1, c), space(2, c)};
    for (int k = 0; k < 3; ++k) {
      if (std::abs(v[k]) < 1e-9) v[k] = 0;
    }
    vectors += (c == 0 ? "" : " and ") + point_text(v);
  }
  return vectors;
}

// Columns for eigenvalues of a definite matrix up to the square of `small` (`zero`), or above it.
Eigen::MatrixXd space_of(const Eigen::MatrixXd& matrix, double small, bool zero) {
  const Symmetric eigen(matrix);
  Eigen::Index least = 0;
  while (least < matrix.rows() && eigen.eigenvalues()[least] <= small * small) ++least;
  if (zero) return eigen.eigenvectors().leftCols(least);
  return eigen.eigenvectors().rightCols(matrix.rows() - least);
}

}  // namespace

std::string point_text(const Vec3& v) {
  return std::string("(") + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")";
}

std::vector<double> free_motions(const std::array<double, 36>& gram) {
  const Symmetric eigen(Eigen::Map<const Eigen::MatrixXd>(gram.data(), 6, 6));
  const double largest = std::max(eigen.eigenvalues()[5], 1e-300);
  Eigen::Index free = 0;
  while (free < 6 && eigen.eigenvalues()[free] <= 1e-8 * largest) ++free;
  const double* const first = eigen.eigenvectors().data();
  return {first, first + 6 * free};
}

std::string describe_motions(std::span<const double> motions, const Vec3& around, double size) {
  constexpr double small = 1e-6;
  const Eigen::MatrixXd modes =
      Eigen::Map<const Eigen::MatrixXd>(motions.data(), 6, static_cast<Eigen::Index>(motions.size() / 6));
  const Eigen::MatrixXd turns = modes.bottomRows(3);
  // What turns nothing is a translation.
  const Eigen::MatrixXd shifts = modes.topRows(3) * space_of(turns.transpose() * turns, small, true);
  const Eigen::MatrixXd axes = space_of(turns * turns.transpose(), small, false);
  std::string text;
  if (shifts.cols() > 0) text = "translation along " + directions(shifts);
  if (axes.cols() == 0) return text;
  text += (text.empty() ? "" : " and ") + ("rotation about " + directions(axes));
  if (shifts.cols() > 0) return text;
  // The point that all of them leave where it is: t + w x (p - center) = 0, w = rotation / size; the nearest
  // one to the center.
  Eigen::MatrixXd crosses(3 * modes.cols(), 3), shift(3 * modes.cols(), 1);
  for (Eigen::Index c = 0; c < modes.cols(); ++c) {
    const Eigen::MatrixXd w = modes.col(c).tail(3);
    crosses.middleRows(3 * c, 3) << 0, -w(2), w(1), w(2), 0, -w(0), -w(1), w(0), 0;
    shift.middleRows(3 * c, 3) = -modes.col(c).head(3);
  }
  const Symmetric normal(crosses.transpose() * crosses);
  Eigen::MatrixXd arm = normal.eigenvectors().transpose() * (crosses.transpose() * shift);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double value = normal.eigenvalues()[k];
    arm(k) = value > small * small ? arm(k) / value : 0;
  }
  arm = (normal.eigenvectors() * arm).eval();
  if ((crosses * arm - shift).norm() > 1e-6) return text;
  Vec3 point = around;
  for (int k = 0; k < 3; ++k) {
    point[k] += size * arm(k);
    if (std::abs(point[k]) < 1e-9 * size) point[k] = 0;
  }
  return text + " through " + point_text(point) + " m";
}

}  // namespace isochor
