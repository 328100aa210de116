// A tree of axis-aligned boxes over numbered things that are extended in space: built once, refitted where
// they move.
#pragma once

#include <algorithm>
#include <limits>
#include <numeric>

#include "engine/base/base.h"

namespace isochor {

struct Box {
  Vec3 low{}, high{};

  explicit Box(const Vec3& p = {}) : low(p), high(p) {}
  void add(const Vec3& p) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  void add(const Box& b) {
    add(b.low);
    add(b.high);
  }
  Box grown(double by) const {
    Box b = *this;
    for (int k = 0; k < 3; ++k) {
      b.low[k] -= by;
      b.high[k] += by;
    }
    return b;
  }
  bool meets(const Box& b) const {
    for (int k = 0; k < 3; ++k) {
      if (low[k] > b.high[k] || high[k] < b.low[k]) return false;
    }
    return true;
  }
  double square_distance(const Vec3& y) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double d = std::max({low[k] - y[k], 0.0, y[k] - high[k]});
      sum += d * d;
    }
    return sum;
  }
};

class BoxTree {
 public:
  // `box_of(i)`: the box of thing i of `count`.
  template <class BoxOf>
  void build(Index count, BoxOf box_of) {
    std::vector<Box> own;
    for (Index i = 0; i < count; ++i) own.push_back(box_of(i));
    order_.resize(at(count));
    std::iota(order_.begin(), order_.end(), 0);
    parts_.assign(1, {0, count, -1});
    for (std::size_t b = 0; b < parts_.size(); ++b) {
      const Part part = parts_[b];
      if (part.count <= kLeaf) continue;
      Box box = own[at(order_[at(part.first)])];
      for (Index i = part.first; i < part.first + part.count; ++i) box.add(own[at(order_[at(i)])]);
      const Vec3 size = box.high - box.low;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
      const auto from = order_.begin() + part.first;
      const Index half = part.count / 2;
      std::nth_element(from, from + half, from + part.count, [&](Index p, Index q) {
        const double u = own[at(p)].low[axis] + own[at(p)].high[axis];
        const double v = own[at(q)].low[axis] + own[at(q)].high[axis];
        return u < v || (u == v && p < q);
      });
      parts_[b].left = static_cast<Index>(parts_.size());
      parts_.push_back({part.first, half, -1});
      parts_.push_back({part.first + half, part.count - half, -1});
    }
  }

  // The boxes of the tree for things as they are now.
  template <class BoxOf>
  std::vector<Box> fitted(BoxOf box_of) const {
    std::vector<Box> boxes(parts_.size());
    for (std::size_t b = parts_.size(); b-- > 0;) {
      const Part& part = parts_[b];
      if (part.left >= 0) {
        boxes[b] = boxes[at(part.left)];
        boxes[b].add(boxes[at(part.left) + 1]);
        continue;
      }
      if (part.count == 0) continue;
      boxes[b] = box_of(order_[at(part.first)]);
      for (Index i = part.first + 1; i < part.first + part.count; ++i) boxes[b].add(box_of(order_[at(i)]));
    }
    return boxes;
  }

  // Calls look(i) for the things in leaves whose boxes, and all around them, enter(box) says yes to.
  template <class Enter, class Look>
  void visit(std::span<const Box> boxes, Enter enter, Look look) const {
    std::array<Index, kStack> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const auto b = at(stack[--size]);
      if (!enter(boxes[b])) continue;
      const Part& part = parts_[b];
      if (part.left >= 0) {
        stack[size++] = part.left;
        stack[size++] = part.left + 1;
        continue;
      }
      for (Index i = part.first; i < part.first + part.count; ++i) look(order_[at(i)]);
    }
  }

  // Calls look(i) for things near y, near boxes first; leaves out those of boxes that are no closer than the
  // square root of what look last returned.
  template <class Look>
  void visit_near(std::span<const Box> boxes, const Vec3& y, Look look) const {
    struct Waiting {
      Index part;
      double square;
    };
    std::array<Waiting, kStack> stack;
    std::size_t size = 0;
    double best = std::numeric_limits<double>::infinity();
    stack[size++] = {0, 0};
    while (size > 0) {
      const Waiting next = stack[--size];
      if (next.square >= best) continue;
      const Part& part = parts_[at(next.part)];
      if (part.left < 0) {
        for (Index i = part.first; i < part.first + part.count; ++i) best = look(order_[at(i)]);
        continue;
      }
      Waiting near{part.left, boxes[at(part.left)].square_distance(y)};
      Waiting far{part.left + 1, boxes[at(part.left) + 1].square_distance(y)};
      if (far.square < near.square) std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
    }
  }

 private:
  static constexpr Index kLeaf = 4;
  static constexpr std::size_t kStack = 128;  // the tree is halved, so its depth is far below
  struct Part {
    Index first = 0, count = 0;  // in order_
    Index left = -1;             // of an inner one; the other half comes right behind it
  };
  std::vector<Part> parts_;
  std::vector<Index> order_;
};

}  // namespace isochor
