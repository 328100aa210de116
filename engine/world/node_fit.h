// Values at nodes from values at points around them: for every node a linear function fitted to the points of
// its cells (Zienkiewicz & Zhu 1992, with the weights of the points), evaluated at the node. Exact for linear
// fields, at the boundary too; where the points leave a direction open the mean stands for it.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "engine/base/base.h"

namespace isochor {

template <int Components>
class NodeFit {
 public:
  using Values = Eigen::Matrix<double, Components, 1>;

  // `node` are the rest positions of all nodes that samples will name.
  explicit NodeFit(std::span<const Vec3> node) : node_(node), sums_(node.size()) {}

  // A value at the rest position `point`, standing for a volume, for one of the nodes around it.
  void add(Index node, const Vec3& point, double volume, const Values& value) {
    Sums& s = sums_[at(node)];
    const Vec3 d = point - node_[at(node)];
    const Eigen::Vector3d x(d.x, d.y, d.z);
    s.volume += volume;
    s.first += volume * x;
    s.second += volume * x * x.transpose();
    s.value += volume * value;
    s.moment += volume * x * value.transpose();
  }

  double volume(Index node) const { return sums_[at(node)].volume; }

  // Zero for a node without samples.
  Values value(Index node) const {
    const Sums& s = sums_[at(node)];
    if (!(s.volume > 0)) return Values::Zero();
    const Eigen::Vector3d mean = s.first / s.volume;
    Eigen::Matrix3d spread = s.second - s.first * mean.transpose();
    // Directions without spread keep slope zero, also where rounding leaves some, as of a single point; the
    // others lose a millionth of theirs.
    spread.diagonal().array() += 1e-6 * spread.trace() + 1e-9 * s.second.trace() + 1e-300;
    const Eigen::Matrix<double, 3, Components> slope =
        spread.ldlt().solve(s.moment - mean * s.value.transpose());
    return s.value / s.volume - slope.transpose() * mean;
  }

 private:
  struct Sums {
    double volume = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    Values value = Values::Zero();
    Eigen::Matrix<double, 3, Components> moment = Eigen::Matrix<double, 3, Components>::Zero();
  };
  std::span<const Vec3> node_;
  std::vector<Sums> sums_;
};

}  // namespace isochor
