// Small saddle-point matrices for the linear solvers: tridiagonal stiffness with constraint rows.
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "engine/base/base.h"
#include "engine/solvers/linear_solver.h"

namespace test {

using isochor::Index;
using isochor::SymmetricPattern;

struct Matrix {
  SymmetricPattern pattern;
  std::vector<double> values;

  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(pattern.size, pattern.size);
    for (Index c = 0; c < pattern.size; ++c) {
      for (auto k = pattern.column_start[isochor::at(c)]; k < pattern.column_start[isochor::at(c) + 1]; ++k) {
        const Index r = pattern.row[static_cast<std::size_t>(k)];
        a(r, c) = a(c, r) = values[static_cast<std::size_t>(k)];
      }
    }
    return a;
  }
};

// The lower triangle of a dense symmetric matrix; zeros off the diagonal are left out.
inline Matrix sparse(const Eigen::MatrixXd& a) {
  Matrix m;
  m.pattern.size = static_cast<Index>(a.rows());
  m.pattern.column_start = {0};
  for (Eigen::Index c = 0; c < a.cols(); ++c) {
    for (Eigen::Index r = c; r < a.rows(); ++r) {
      if (r != c && a(r, c) == 0) continue;
      m.pattern.row.push_back(static_cast<Index>(r));
      m.values.push_back(a(r, c));
    }
    m.pattern.column_start.push_back(static_cast<std::int64_t>(m.values.size()));
  }
  return m;
}

struct Saddle {
  Index nodes = 0;         // three unknowns each, coupled along a chain and across it
  Index rows = 0;          // constraint rows, each over a few neighboring nodes
  bool dense_row = false;  // one more row over every node
  double compliance = 0;   // of the rows
  int negative_nodes = 0;  // nodes whose stiffness is turned negative
};

inline Matrix saddle(const Saddle& s, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  const Eigen::Index n = 3 * s.nodes, m = s.rows + (s.dense_row ? 1 : 0);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n + m, n + m);
  for (Index i = 0; i < s.nodes; ++i) {
    for (Index j : {i, i + 1, i + 7}) {
      if (j >= s.nodes) continue;
      for (int p = 0; p < 3; ++p) {
        for (int q = 0; q < 3; ++q) {
          const double v = i == j ? (p == q ? 8.0 : 0.0) : -u(random);
          a(3 * j + q, 3 * i + p) = v;
          a(3 * i + p, 3 * j + q) = v;
        }
      }
    }
  }
  for (int k = 0; k < s.negative_nodes; ++k) {
    for (int p = 0; p < 3; ++p) a(9 * k + p, 9 * k + p) = -40;
  }
  for (Eigen::Index r = 0; r < m; ++r) {
    const bool dense = s.dense_row && r == m - 1;
    const Eigen::Index first = dense ? 0 : 3 * (r * s.nodes / std::max<Eigen::Index>(s.rows, 1));
    const Eigen::Index last = dense ? n : std::min<Eigen::Index>(n, first + 9);
    for (Eigen::Index c = first; c < last; ++c) a(n + r, c) = a(c, n + r) = u(random);
    a(n + r, n + r) = -s.compliance;
  }
  Matrix out = sparse(a);
  for (Eigen::Index i = 0; i < n + m; ++i) out.pattern.multiplier.push_back(i >= n);
  for (Eigen::Index i = 0; i < n + m; ++i) {
    out.pattern.group.push_back(static_cast<Index>(i < n ? i / 3 : s.nodes + (i - n)));
  }
  out.pattern.groups = s.nodes + static_cast<Index>(m);
  return out;
}

inline std::vector<double> random_vector(Index n, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> v(isochor::at(n));
  for (double& x : v) x = u(random);
  return v;
}

}  // namespace test
