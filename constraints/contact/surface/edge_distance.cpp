#include "constraints/contact/surface/edge_distance.h"

#include <cmath>

#include "constraints/contact/surface/crossing.h"
#include "constraints/contact/surface/jet.h"

namespace isochor {

namespace {

// Where steps begin and how long they are.
struct Step {
  double from, length;

  double at(double v) const { return std::clamp((v - from) / length, 0.0, 1.0); }
  double value(double v) const {
    const double t = at(v);
    return t * t * t * (10 - 15 * t + 6 * t * t);
  }
  bool flat(double v) const { return at(v) == 0 || at(v) == 1; }
  template <class J>
  J of(const J& v) const {
    const double t = at(v.value), u = 1 - t;
    return v.through(value(v.value), 30 * t * t * u * u / length,
                     60 * t * u * (1 - 2 * t) / (length * length));
  }
};
constexpr Step kAcross{0, 0.05};   // of the squared sine between the edges
constexpr Step kEnd{0, 0.2};       // of the place on an edge, from either end
constexpr Step kFall{0.03, 0.1};   // of the sine by which a triangle falls away
constexpr double kNearly = -0.03;  // the same, of edges that go through each other

// Differences of nodes, which everything depends on: by number, that of its end and of its start.
constexpr std::size_t kDifferences = 7;
constexpr std::array<std::array<std::size_t, 2>, kDifferences> kDifference{
    {{1, 0}, {5, 4}, {0, 4}, {2, 0}, {3, 0}, {6, 4}, {7, 4}}};  // p, q, r; beside the first, the second edge

// Sine by which the triangle with corner v beside edge p falls away from a unit normal across p.
double falls(const Vec3& n, const Vec3& p, const Vec3& v) {
  const double length = norm(cross(p, v));
  return length > 0 ? dot(n, v) * norm(p) / length : 0;
}

// What a pair of edges is made of, from the differences and with derivatives in them; those beside the edges
// only where N says that they count.
template <std::size_t N, bool kCurved>
struct PairJets {
  using J = Jet<N, kCurved>;
  std::array<JetVec<J>, N / 3> d;
  JetVec<J> c;
  J square, one_over;
  double sign;  // of the normal against p x q

  PairJets(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap) {
    for (std::size_t k = 0; k < N / 3; ++k) {
      const Vec3 v = x[kDifference[k][0]] - x[kDifference[k][1]];
      for (std::size_t i = 0; i < 3; ++i) {
        d[k][i].value = v[static_cast<int>(i)];
        d[k][i].slope[3 * k + i] = 1;
      }
    }
    c = cross(d[0], d[1]);
    square = dot(c, c);
    one_over = inverse(root(square));
    sign = dot(gap.normal, cross(x[1] - x[0], x[5] - x[4])) > 0 ? 1 : -1;
  }
  J distance() const { return sign * (dot(c, d[2]) * one_over); }
  // Of the nearest places along the first and the second edge.
  std::array<J, 2> places() const {
    const J one_over_square = one_over * one_over;
    return {-1.0 * (dot(cross(d[2], d[1]), c) * one_over_square),
            -1.0 * (dot(cross(d[2], d[0]), c) * one_over_square)};
  }
  // Times every step that has a slope here.
  J faded(J out) const {
    const J pp = dot(d[0], d[0]), qq = dot(d[1], d[1]), sine = square * inverse(pp * qq);
    if (!kAcross.flat(sine.value)) out = out * kAcross.of(sine);
    for (const J& place : places()) {
      J rest = -1.0 * place;
      rest.value += 1;
      if (!kEnd.flat(place.value)) out = out * kEnd.of(place);
      if (!kEnd.flat(rest.value)) out = out * kEnd.of(rest);
    }
    if constexpr (N > 9) {
      for (std::size_t k = 3; k < kDifferences; ++k) {
        const bool first = k < 5;
        const JetVec<J> side = cross(first ? d[0] : d[1], d[k]);
        const J beside = inverse(root(dot(side, side) * inverse(first ? pp : qq)));
        const J fall = (first ? sign : -sign) * (dot(c, d[k]) * one_over * beside);
        if (!kFall.flat(fall.value)) out = out * kFall.of(fall);
      }
    }
    return out;
  }
};

template <std::size_t N, bool kCurved>
Jet<N, kCurved> value_of(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap, double offset) {
  const PairJets<N, kCurved> pair(x, gap);
  Jet<N, kCurved> out = pair.distance();
  out.value -= offset;
  return gap.plain ? out : pair.faded(out);
}

// Whether a triangle's fall has a slope.
bool tilts(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap) {
  for (std::size_t k = 3; k < kDifferences; ++k) {
    const Vec3 v = x[kDifference[k][0]] - x[kDifference[k][1]];
    const Vec3 edge = k < 5 ? x[1] - x[0] : x[5] - x[4];
    if (!kFall.flat(falls(k < 5 ? gap.normal : -gap.normal, edge, v))) return true;
  }
  return false;
}

// The part of a node in difference k.
int part(std::size_t k, std::size_t node) {
  return kDifference[k][0] == node ? 1 : (kDifference[k][1] == node ? -1 : 0);
}

template <std::size_t N>
std::array<Vec3, kPairNodes> slopes_with(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap,
                                         double offset) {
  const auto value = value_of<N, false>(x, gap, offset);
  std::array<Vec3, kPairNodes> out{};
  for (std::size_t k = 0; k < N / 3; ++k) {
    const Vec3 slope{value.slope[3 * k], value.slope[3 * k + 1], value.slope[3 * k + 2]};
    out[kDifference[k][0]] += slope;
    out[kDifference[k][1]] -= slope;
  }
  return out;
}

template <std::size_t N>
EdgeRates rates_with(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap) {
  using J = Jet<N, false>;
  const PairJets<N, false> pair(x, gap);
  const std::array<J, 2> places = pair.places();
  JetVec<J> normal;
  for (std::size_t i = 0; i < 3; ++i) normal[i] = pair.sign * (pair.c[i] * pair.one_over);
  J weight;
  weight.value = 1;
  if (!gap.plain) weight = pair.faded(weight);
  EdgeRates out;
  for (std::size_t k = 0; k < N / 3; ++k) {
    for (const std::size_t node : kDifference[k]) {
      const double f = part(k, node);
      for (std::size_t e = 0; e < 3; ++e) {
        const auto along = static_cast<int>(e);
        for (std::size_t i = 0; i < 3; ++i)
          out.normal[node](static_cast<int>(i), along) += f * normal[i].slope[3 * k + e];
        for (std::size_t t = 0; t < 2; ++t) out.place[t][node][along] += f * places[t].slope[3 * k + e];
        out.weight[node][along] += f * weight.slope[3 * k + e];
      }
    }
  }
  return out;
}

template <std::size_t N>
void add_curvature_with(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap, double offset,
                        double factor, Mat3* blocks) {
  const auto value = value_of<N, true>(x, gap, offset);
  const auto bend = [&](std::size_t i, std::size_t j) {
    return i < j ? value.bend[j * (j + 1) / 2 + i] : value.bend[i * (i + 1) / 2 + j];
  };
  for (std::size_t k = 0; k < N / 3; ++k) {
    for (std::size_t l = 0; l < N / 3; ++l) {
      for (const std::size_t a : kDifference[k]) {
        for (const std::size_t b : kDifference[l]) {
          if (b > a) continue;
          Mat3& block = blocks[a * (a + 1) / 2 + b];
          const double f = factor * part(k, a) * part(l, b);
          for (std::size_t e = 0; e < 9; ++e) block.m[e] += f * bend(3 * k + e / 3, 3 * l + e % 3);
        }
      }
    }
  }
}

}  // namespace

EdgeGap edge_gap(const std::array<Vec3, kPairNodes>& x, double offset) {
  EdgeGap gap;
  const Vec3 p = x[1] - x[0], q = x[5] - x[4], r = x[0] - x[4], c = cross(p, q);
  const double square = dot(c, c), lengths = dot(p, p) * dot(q, q);
  if (!(square > 1e-12 * lengths)) return gap;
  gap.normal = (1 / std::sqrt(square)) * c;
  gap.place = {-dot(cross(r, q), c) / square, -dot(cross(r, p), c) / square};
  std::array<double, 4> fall{falls(gap.normal, p, x[2] - x[0]), falls(gap.normal, p, x[3] - x[0]),
                             -falls(gap.normal, q, x[6] - x[4]), -falls(gap.normal, q, x[7] - x[4])};
  if (fall[0] + fall[1] + fall[2] + fall[3] < 0) {
    gap.normal = -gap.normal;
    for (double& f : fall) f = -f;
  }
  gap.distance = dot(gap.normal, r);
  // In a groove both triangles fall away from the normal into the body.
  const bool outward = dot(gap.normal, cross(p, x[2] - x[0]) - cross(p, x[3] - x[0])) < 0 &&
                       dot(gap.normal, cross(q, x[6] - x[4]) - cross(q, x[7] - x[4])) > 0;
  if (!outward) return gap;
  gap.facing = true;
  gap.weight = kAcross.value(square / lengths);
  gap.plain = kAcross.flat(square / lengths);
  for (const double f : fall) {
    gap.facing = gap.facing && f > kNearly;
    gap.weight *= kFall.value(f);
    gap.plain = gap.plain && kFall.flat(f);
  }
  for (const double t : gap.place) {
    gap.weight *= kEnd.value(t) * kEnd.value(1 - t);
    gap.plain = gap.plain && kEnd.flat(t) && kEnd.flat(1 - t);
  }
  gap.value = gap.weight * (gap.distance - offset);
  return gap;
}

std::array<Vec3, kPairNodes> edge_slopes(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap,
                                         double offset) {
  std::array<Vec3, kPairNodes> out{};
  if (gap.weight == 0) return out;
  if (gap.plain) {
    for (std::size_t i = 0; i < kPairNodes; ++i) out[i] = gap.share(i) * gap.normal;
    return out;
  }
  return tilts(x, gap) ? slopes_with<21>(x, gap, offset) : slopes_with<9>(x, gap, offset);
}

void add_edge_curvature(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap, double offset,
                        double factor, Mat3* blocks) {
  if (gap.weight == 0) return;
  if (!gap.plain && tilts(x, gap))
    add_curvature_with<21>(x, gap, offset, factor, blocks);
  else
    add_curvature_with<9>(x, gap, offset, factor, blocks);
}

EdgeRates edge_rates(const std::array<Vec3, kPairNodes>& x, const EdgeGap& gap) {
  if (gap.weight == 0) return {};
  return !gap.plain && tilts(x, gap) ? rates_with<21>(x, gap) : rates_with<9>(x, gap);
}

double edge_crossing_time(const std::array<Vec3, kPairNodes>& start,
                          const std::array<Vec3, kPairNodes>& end) {
  constexpr double slack = 1e-9;
  const auto within = [](double t) { return t >= -slack && t <= 1 + slack; };
  double first = kNever;
  // The normal may be p x q or its opposite.
  for (const bool along : {true, false}) {
    const std::array<std::size_t, 4> k =
        along ? std::array<std::size_t, 4>{0, 4, 1, 5} : std::array<std::size_t, 4>{0, 4, 5, 1};
    const double time = first_crossing(
        {start[k[0]], start[k[1]], start[k[2]], start[k[3]]}, {end[k[0]], end[k[1]], end[k[2]], end[k[3]]},
        [&](double t) {
          std::array<Vec3, kPairNodes> now;
          for (std::size_t i = 0; i < kPairNodes; ++i) now[i] = start[i] + t * (end[i] - start[i]);
          const EdgeGap gap = edge_gap(now, 0);
          const bool same = (dot(gap.normal, cross(now[1] - now[0], now[5] - now[4])) > 0) == along;
          return gap.facing && same && within(gap.place[0]) && within(gap.place[1]);
        });
    first = std::min(first, time);
  }
  return first;
}

}  // namespace isochor
