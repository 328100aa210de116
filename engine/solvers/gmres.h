// The generalized minimal residual method on few vectors, preconditioned from the right (Saad & Schultz 1986;
// each direction as it comes: Saad 1993). It takes all its memory once and does not restart by itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "engine/base/row_loop.h"

namespace isochor {

class Gmres {
 public:
  // Of a preconditioner that rounds, its directions are kept; of one that is linear to the last digits they
  // need not be, for half the memory and one more application.
  enum class Directions : std::uint8_t { kept, made_again };

  Gmres(std::size_t size, int most, Directions directions = Directions::kept);

  void set_loop(const RowLoop& loop) { loop_ = loop; }

  int room() const { return most_; }
  double norm(std::span<const double> v) { return std::sqrt(dot(v, v)); }
  // Of one solve: residual of x = 0, in the Euclidean norm, and what is left of it.
  double start_norm() const { return start_; }
  double left() const { return left_; }
  // Whether A M^-1, as far as the directions saw it, has an odd number of negative eigenvalues: the sign of
  // the determinant of the Hessenberg matrix.
  bool odd() const { return odd_; }

  // From x = 0 until the residual is `tolerance` of the right-hand side, or for as many directions as there
  // is room for. apply(v, w): w = A v; precondition(v): v := M^-1 v in place, false when it cannot. Returns
  // the number of directions, and -1 when there was no preconditioner or a number was not finite.
  template <class Apply, class Precondition>
  int solve(std::span<const double> b, std::span<double> x, double tolerance, const Apply& apply,
            const Precondition& precondition) {
    begin(b);
    int k = 0;
    while (k < most_ && left_ > tolerance * start_) {
      const std::span<double> z = direction(k);
      const auto v = basis(k);
      std::copy(v.begin(), v.end(), z.begin());
      if (!precondition(z)) return -1;
      apply(std::span<const double>(z), basis(k + 1));
      if (!extend(k)) return -1;
      ++k;
      if (exhausted_) break;
    }
    combine(k, x);
    return kept_ || k == 0 || precondition(x) ? k : -1;
  }

 private:
  void begin(std::span<const double> b);
  bool extend(int k);
  void combine(int k, std::span<double> x);
  double dot(std::span<const double> a, std::span<const double> b) { return dot_(loop_, a, b); }
  void add(double factor, std::span<const double> v, std::span<double> w) const;
  void set(double factor, std::span<const double> v, std::span<double> w) const;
  std::span<double> basis(int k) { return std::span(basis_).subspan(at(k) * size_, size_); }
  std::span<double> direction(int k) {
    return std::span(direction_).subspan(kept_ ? at(k) * size_ : 0, size_);
  }
  double& h(int row, int column) { return hessenberg_[at(column) * (at(most_) + 1) + at(row)]; }

  std::size_t size_;
  int most_;
  bool kept_;
  RowLoop loop_;
  BlockedDot dot_;
  double start_ = 0, left_ = 0;
  bool odd_ = false;
  bool exhausted_ = false;  // the space does not grow any more: what is there is exact
  std::vector<double> basis_, direction_, hessenberg_, cosine_, sine_, right_;
};

}  // namespace isochor
