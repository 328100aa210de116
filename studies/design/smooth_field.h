// What is taken for granted of a field of numbers, one a cell: that it is smooth over a length.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <memory>
#include <span>

#include "isochor/mesh.h"

namespace isochor::design {

// The field m of cells with volumes V is B xi, where xi is white: B = s sqrt(8 pi / l) (V / l^2 + K)^-1
// V^1/2, K the graph Laplacian of cells that share a face, with area over distance of centers as weights.
// That is the equation of Whittle and Matern (Lindgren, Rue & Lindstroem 2011) for the covariance s^2 exp(-r
// / l), free at the boundary, where the variance is larger.
class SmoothField {
 public:
  // `length` l [m], `spread` s: the standard deviation of m.
  SmoothField(const Mesh& mesh, double length, double spread);
  Eigen::Index cells() const { return root_volume_.size(); }
  // B xi, and J B of a matrix with a column a cell.
  Eigen::VectorXd field(const Eigen::VectorXd& white) const;
  Eigen::MatrixXd times(const Eigen::MatrixXd& jacobian) const;
  // Standard deviations of m where data have been seen, by the Jacobian J of errors of variance 1 by m:
  // the diagonal of B (1 + B^T J^T J B)^-1 B^T.
  Eigen::VectorXd deviations(const Eigen::MatrixXd& jacobian) const;

 private:
  Eigen::VectorXd root_volume_;
  double factor_ = 1;
  std::shared_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> solver_;
};

// Corners of a cell, without mid-edge nodes.
int corners_of(CellType type);
double cell_volume(const Mesh& mesh, std::span<const Vec3> nodes, std::size_t cell);

}  // namespace isochor::design
