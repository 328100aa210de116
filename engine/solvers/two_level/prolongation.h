// How the nodes of a mesh follow its corners: middles of edges in a line between the ends.
#pragma once

#include "engine/solvers/two_level/edge_nodes.h"

namespace isochor {

// Coarse vectors hold the unknowns of the corners, in the order of the fine ones, then the rows; fine vectors
// are those of SaddleMatrix.
class Prolongation {
 public:
  // The part that a node takes of a corner's displacement: a number, or a 3 x 3 block where directions or
  // scales differ.
  struct Part {
    Index node = 0, corner = 0;
    bool even = true;
    double factor = 1;
    std::array<double, 9> block{};
  };

  void analyze(const SaddleMatrix& matrix, EdgeNodes edges, std::span<const UnknownGeometry> geometry);
  // `scale` as LinearSolver::set_scale(): displacements are linear along edges, scaled unknowns are not.
  void weigh(std::span<const double> scale);

  Index corners() const { return corners_; }
  Index displacements() const { return displacements_; }  // coarse unknowns that are no rows
  Index size() const { return displacements_ + rows_; }
  const EdgeNodes& edges() const { return edges_; }
  bool is_middle(Index node) const { return corner_of_[at(node)] < 0; }
  Index corner_of(Index node) const { return corner_of_[at(node)]; }  // -1: a middle
  // Of three places a corner; -1: there is none.
  Index coarse_unknown(Index corner, int place) const { return coarse_unknown_[3 * at(corner) + at(place)]; }
  // Parts of a corner, and the one or two of a node (-1: no second).
  std::span<const Part> of_corner(Index corner) const {
    return std::span(part_).subspan(part_start_[at(corner)],
                                    part_start_[at(corner) + 1] - part_start_[at(corner)]);
  }
  const std::array<Index, 2>& of_node(Index node) const { return parts_of_[at(node)]; }
  const Part& part(Index k) const { return part_[at(k)]; }

  // coarse = (P^T, 1) fine, and fine += (P, 1) coarse.
  void restrict_to(const RowLoop& loop, std::span<const double> fine, std::span<double> coarse) const;
  void prolong(const RowLoop& loop, std::span<const double> coarse, std::span<double> fine) const;

 private:
  EdgeNodes edges_;
  std::vector<Index> unknown_at_;  // of each place of a fine node; -1: none
  std::vector<Vec3> direction_;    // of each unknown
  Index rows_ = 0, corners_ = 0, displacements_ = 0;
  std::vector<Index> corner_of_, coarse_unknown_;
  std::vector<Part> part_;  // by corner
  std::vector<std::size_t> part_start_;
  std::vector<std::array<Index, 2>> parts_of_;
};

}  // namespace isochor
