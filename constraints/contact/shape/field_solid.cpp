#include "constraints/contact/shape/field_solid.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "constraints/contact/shape/mesh_solid.h"
#include "engine/base/text.h"

namespace isochor {

namespace {

// Weights of four neighboring coefficients at t in [0, 1] of an interval, with their derivatives.
struct Weights {
  double w[4], first[4], second[4];
};
Weights weights_at(double t) {
  const double u = 1 - t;
  return {{u * u * u / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * u * u + 3 * u * u * u) / 6,
           t * t * t / 6},
          {-0.5 * u * u, -2 * t + 1.5 * t * t, 2 * u - 1.5 * u * u, 0.5 * t * t},
          {u, 3 * t - 2, 3 * u - 2, t}};
}

// Coefficients of the spline through n values with zero second derivatives at its ends: c_{i-1} + 4 c_i +
// c_{i+1} = 6 f_i. On entry places 1 to n hold the values; on exit 0 to n + 1 hold the coefficients.
void fit_line(std::vector<double>& line, std::vector<double>& scratch) {
  const std::size_t n = line.size() - 2;
  // The first and the last coefficient are the values themselves.
  scratch.assign(n + 2, 0);
  for (std::size_t i = 2; i < n; ++i) {
    const double right = 6 * line[i] - line[i - 1] - (i == n - 1 ? line[n] : 0);
    const double pivot = 4 - (i == 2 ? 0 : scratch[i - 1]);
    scratch[i] = 1 / pivot;
    line[i] = right / pivot;
  }
  for (std::size_t i = n - 1; i-- > 2;) line[i] -= scratch[i] * line[i + 1];
  line[0] = 2 * line[1] - line[2];
  line[n + 1] = 2 * line[n] - line[n - 1];
}

Result<void> check(const DistanceGrid& g) {
  std::size_t points = 1;
  for (int k = 0; k < 3; ++k) {
    if (!(g.spacing[k] > 0) || !std::isfinite(g.spacing[k]) || !std::isfinite(g.origin[k])) {
      return Error{"the distance field has the origin " + number(g.origin[k]) + " m and the spacing " +
                   number(g.spacing[k]) + " m along axis " + std::to_string(k) +
                   "; both must be finite and the spacing positive"};
    }
    if (g.count[static_cast<std::size_t>(k)] < 4) {
      return Error{"the distance field has " + std::to_string(g.count[static_cast<std::size_t>(k)]) +
                   " points along axis " + std::to_string(k) + "; give at least 4"};
    }
    points *= at(g.count[static_cast<std::size_t>(k)]);
  }
  if (g.values.size() != points) {
    return Error{"the distance field has " + std::to_string(g.values.size()) + " values for " +
                 std::to_string(points) + " points; give one a point"};
  }
  bool inside = false;
  for (std::size_t i = 0; i < points; ++i) {
    if (!std::isfinite(g.values[i])) {
      return Error{"value " + std::to_string(i) +
                   " of the distance field is not finite; give distances everywhere"};
    }
    inside = inside || g.values[i] < 0;
  }
  if (!inside) {
    return Error{
        "the distance field is nowhere negative, so it has no inside; distances are negative inside, and "
        "the spacing must be smaller than the solid is thick"};
  }
  return {};
}

}  // namespace

Vec3 FieldSolid::last() const {
  Vec3 p = grid_.origin;
  for (int k = 0; k < 3; ++k) p[k] += grid_.spacing[k] * (grid_.count[static_cast<std::size_t>(k)] - 1);
  return p;
}

Result<std::shared_ptr<const FieldSolid>> FieldSolid::make(const DistanceGrid& grid) {
  if (auto r = check(grid); !r) return r.failure();
  auto solid = std::make_shared<FieldSolid>();
  solid->grid_ = grid;
  solid->low_ = solid->last();
  solid->high_ = grid.origin;
  const auto [nx, ny, nz] = grid.count;
  for (Index k = 0; k < nz; ++k) {
    for (Index j = 0; j < ny; ++j) {
      for (Index i = 0; i < nx; ++i) {
        if (solid->sample(i, j, k) >= 0) continue;
        if (i == 0 || j == 0 || k == 0 || i == nx - 1 || j == ny - 1 || k == nz - 1) {
          return Error{"the distance field is negative on the border of its grid, at point (" +
                       std::to_string(i) + ", " + std::to_string(j) + ", " + std::to_string(k) +
                       "); make the grid larger than the solid, by two spacings on every side"};
        }
        // The surface is within a spacing of a negative value.
        const Index place[3] = {i, j, k};
        constexpr double beyond = 1.1;
        for (int d = 0; d < 3; ++d) {
          solid->low_[d] = std::min(solid->low_[d], grid.origin[d] + grid.spacing[d] * (place[d] - beyond));
          solid->high_[d] = std::max(solid->high_[d], grid.origin[d] + grid.spacing[d] * (place[d] + beyond));
        }
      }
    }
  }
  solid->fit();
  const double slope = solid->slope_at_surface();
  if (!(slope > 0.8 && slope < 1.25)) {
    return Error{"the distance field rises by " + number(slope) +
                 " m a meter at the surface; a distance rises by 1: divide the values by their slope, or "
                 "compute distances from the surface"};
  }
  return std::shared_ptr<const FieldSolid>(std::move(solid));
}

void FieldSolid::fit() {
  for (std::size_t d = 0; d < 3; ++d) size_[d] = at(grid_.count[d]) + 2;
  coefficient_.assign(size_[0] * size_[1] * size_[2], 0);
  for (Index k = 0; k < grid_.count[2]; ++k) {
    for (Index j = 0; j < grid_.count[1]; ++j) {
      for (Index i = 0; i < grid_.count[0]; ++i)
        coefficient_[at(i + 1) + size_[0] * (at(j + 1) + size_[1] * at(k + 1))] = sample(i, j, k);
    }
  }
  const std::size_t stride[3] = {1, size_[0], size_[0] * size_[1]};
  std::vector<double> line, scratch;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t a = (d + 1) % 3, b = (d + 2) % 3;
    line.resize(size_[d]);
    for (std::size_t p = 0; p < size_[a]; ++p) {
      for (std::size_t q = 0; q < size_[b]; ++q) {
        double* const first = coefficient_.data() + p * stride[a] + q * stride[b];
        for (std::size_t i = 0; i < size_[d]; ++i) line[i] = first[i * stride[d]];
        fit_line(line, scratch);
        for (std::size_t i = 0; i < size_[d]; ++i) first[i * stride[d]] = line[i];
      }
    }
  }
}

Distance FieldSolid::spline(const Vec3& y, bool derivatives) const {
  std::size_t base[3];
  Weights w[3];
  for (int d = 0; d < 3; ++d) {
    const double u = (y[d] - grid_.origin[d]) / grid_.spacing[d];
    const double cells = grid_.count[static_cast<std::size_t>(d)] - 1;
    const double cell = std::clamp(std::floor(u), 0.0, cells - 1);
    base[d] = static_cast<std::size_t>(cell);
    w[d] = weights_at(std::clamp(u - cell, 0.0, 1.0));
  }
  Distance out;
  double g[3] = {0, 0, 0}, h[6] = {0, 0, 0, 0, 0, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double* c = coefficient_.data() + base[0] + size_[0] * (base[1] + j + size_[1] * (base[2] + k));
      double v = 0, v1 = 0, v2 = 0;
      for (std::size_t i = 0; i < 4; ++i) v += w[0].w[i] * c[i];
      out.value += w[1].w[j] * w[2].w[k] * v;
      if (!derivatives) continue;
      for (std::size_t i = 0; i < 4; ++i) {
        v1 += w[0].first[i] * c[i];
        v2 += w[0].second[i] * c[i];
      }
      g[0] += w[1].w[j] * w[2].w[k] * v1;
      g[1] += w[1].first[j] * w[2].w[k] * v;
      g[2] += w[1].w[j] * w[2].first[k] * v;
      h[0] += w[1].w[j] * w[2].w[k] * v2;
      h[1] += w[1].second[j] * w[2].w[k] * v;
      h[2] += w[1].w[j] * w[2].second[k] * v;
      h[3] += w[1].first[j] * w[2].w[k] * v1;
      h[4] += w[1].w[j] * w[2].first[k] * v1;
      h[5] += w[1].first[j] * w[2].first[k] * v;
    }
  }
  if (!derivatives) return out;
  constexpr int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  for (int i = 0; i < 3; ++i) {
    out.normal[i] = g[i] / grid_.spacing[i];
    for (int j = 0; j < 3; ++j) out.curvature(i, j) = h[place[i][j]] / (grid_.spacing[i] * grid_.spacing[j]);
  }
  return out;
}

Distance FieldSolid::distance(const Vec3& y) const {
  Vec3 near = y;
  const Vec3 end = last();
  for (int d = 0; d < 3; ++d) near[d] = std::clamp(y[d], grid_.origin[d], end[d]);
  Distance out = spline(near, true);
  const Vec3 b = y - near;
  if (b == Vec3{}) return out;
  // Along clamped axes the nearest point stays where it is.
  bool free[3];
  for (int d = 0; d < 3; ++d) {
    free[d] = b[d] == 0;
    if (!free[d]) out.normal[d] = 0;
  }
  const double s = out.value, v = std::sqrt(s * s + dot(b, b));
  const Vec3 slope = out.normal, up = (1 / v) * (s * slope + b);
  Mat3 H;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double own = free[i] && free[j] ? slope[i] * slope[j] + s * out.curvature(i, j) : 0;
      H(i, j) = (own + (i == j && !free[i] ? 1 : 0) - up[i] * up[j]) / v;
    }
  }
  return {v, up, H};
}

double FieldSolid::value(const Vec3& y) const {
  Vec3 near = y;
  const Vec3 end = last();
  for (int d = 0; d < 3; ++d) near[d] = std::clamp(y[d], grid_.origin[d], end[d]);
  const double s = spline(near, false).value;
  const Vec3 b = y - near;
  return b == Vec3{} ? s : std::sqrt(s * s + dot(b, b));
}

double FieldSolid::slope_at_surface() const {
  std::vector<double> slopes;
  for (Index k = 0; k + 1 < grid_.count[2]; ++k) {
    for (Index j = 0; j + 1 < grid_.count[1]; ++j) {
      for (Index i = 0; i + 1 < grid_.count[0]; ++i) {
        int inside = 0;
        Vec3 rise{};
        for (int corner = 0; corner < 8; ++corner) {
          const int step[3] = {corner & 1, (corner >> 1) & 1, corner >> 2};
          const double v = sample(i + step[0], j + step[1], k + step[2]);
          inside += v < 0;
          for (int d = 0; d < 3; ++d) rise[d] += (step[d] ? 0.25 : -0.25) * v / grid_.spacing[d];
        }
        if (inside > 0 && inside < 8) slopes.push_back(norm(rise));
      }
    }
  }
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  return *middle;
}

// Looked for at half spacings: a field shows nothing thinner. Each is then found by halving.
std::size_t FieldSolid::crossings(const Vec3& y0, const Vec3& y1, std::span<double> out) const {
  const Vec3 way = y1 - y0;
  // The piece of the way inside the box of the solid.
  double from = 0, to = 1;
  for (int k = 0; k < 3; ++k) {
    if (way[k] == 0) {
      if (y0[k] < low_[k] || y0[k] > high_[k]) return 0;
      continue;
    }
    const double a = (low_[k] - y0[k]) / way[k], b = (high_[k] - y0[k]) / way[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (!(from < to)) return 0;
  const double fine = 0.5 * std::min({grid_.spacing.x, grid_.spacing.y, grid_.spacing.z});
  const int pieces = 1 + static_cast<int>((to - from) * norm(way) / fine);
  std::size_t found = 0;
  double before = value(y0 + from * way);
  for (int i = 1; i <= pieces && found < out.size(); ++i) {
    const double end = from + (to - from) * i / pieces;
    const double now = value(y0 + end * way);
    if ((before < 0) != (now < 0)) {
      double low = from + (to - from) * (i - 1) / pieces, high = end;
      for (int step = 0; step < 50; ++step) {
        const double middle = 0.5 * (low + high);
        ((value(y0 + middle * way) < 0) == (before < 0) ? low : high) = middle;
      }
      out[found++] = 0.5 * (low + high);
    }
    before = now;
  }
  return found;
}

// Six tetrahedra a cell around its diagonal; each is cut where its edges change sign.
TriangleSurface FieldSolid::outline() const {
  TriangleSurface s;
  std::map<std::pair<std::size_t, std::size_t>, Index> cut;
  const auto id = [&](const std::array<Index, 3>& p) {
    return at(p[0]) + at(grid_.count[0]) * (at(p[1]) + at(grid_.count[1]) * at(p[2]));
  };
  const auto place = [&](const std::array<Index, 3>& p) {
    return grid_.origin + Vec3{grid_.spacing.x * p[0], grid_.spacing.y * p[1], grid_.spacing.z * p[2]};
  };
  const auto crossing = [&](const std::array<Index, 3>& in, const std::array<Index, 3>& outside) {
    const auto [it, fresh] = cut.try_emplace({id(in), id(outside)}, static_cast<Index>(s.points.size()));
    if (fresh) {
      const double a = grid_.values[id(in)], b = grid_.values[id(outside)];
      s.points.push_back(place(in) + (a / (a - b)) * (place(outside) - place(in)));
    }
    return it->second;
  };
  constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  // The triangle with the inside behind it.
  const auto add = [&](Index a, Index b, Index c, const Vec3& inside) {
    const Vec3 n = cross(s.points[at(b)] - s.points[at(a)], s.points[at(c)] - s.points[at(a)]);
    if (dot(n, s.points[at(a)] - inside) < 0) std::swap(b, c);
    s.triangles.insert(s.triangles.end(), {a, b, c});
  };
  for (Index k = 0; k + 1 < grid_.count[2]; ++k) {
    for (Index j = 0; j + 1 < grid_.count[1]; ++j) {
      for (Index i = 0; i + 1 < grid_.count[0]; ++i) {
        for (const auto& order : orders) {
          std::array<Index, 3> corner{i, j, k};
          std::vector<std::array<Index, 3>> in, beyond;
          for (int step = 0; step < 4; ++step) {
            (grid_.values[id(corner)] < 0 ? in : beyond).push_back(corner);
            if (step < 3) ++corner[static_cast<std::size_t>(order[step])];
          }
          if (in.empty() || beyond.empty()) continue;
          const Vec3 inside = place(in[0]);
          if (in.size() == 2) {
            const Index a = crossing(in[0], beyond[0]), b = crossing(in[0], beyond[1]),
                        c = crossing(in[1], beyond[0]), d = crossing(in[1], beyond[1]);
            add(a, b, c, inside);
            add(b, d, c, inside);
          } else if (in.size() == 1) {
            add(crossing(in[0], beyond[0]), crossing(in[0], beyond[1]), crossing(in[0], beyond[2]), inside);
          } else {
            add(crossing(in[0], beyond[0]), crossing(in[1], beyond[0]), crossing(in[2], beyond[0]), inside);
          }
        }
      }
    }
  }
  return s;
}

Result<SolidPtr> field_solid(const DistanceGrid& grid) {
  auto solid = FieldSolid::make(grid);
  if (!solid) return solid.failure();
  return SolidPtr(std::move(solid).value());
}

Result<DistanceGrid> sampled_distances(const TriangleSurface& surface, double spacing) {
  auto solid = MeshSolid::make(surface);
  if (!solid) return solid.failure();
  const auto [low, high] = solid.value()->box();
  constexpr double margin = 2, most = 1e8;
  DistanceGrid g;
  double points = 1;
  for (int k = 0; k < 3; ++k) {
    if (!(spacing > 0) || !std::isfinite(spacing)) {
      return Error{"the spacing = " + number(spacing) + " m of the distance field; give a positive one"};
    }
    const double cells = std::ceil((high[k] - low[k]) / spacing) + 2 * margin;
    points *= cells + 1;
    if (!(points < most)) {
      return Error{"the spacing = " + number(spacing) + " m makes a distance field of more than " +
                   number(most) + " points; take a larger one"};
    }
    g.count[static_cast<std::size_t>(k)] = static_cast<Index>(cells) + 1;
    g.spacing[k] = spacing;
    g.origin[k] = 0.5 * (low[k] + high[k] - cells * spacing);
  }
  g.values.reserve(static_cast<std::size_t>(points));
  for (Index k = 0; k < g.count[2]; ++k) {
    for (Index j = 0; j < g.count[1]; ++j) {
      for (Index i = 0; i < g.count[0]; ++i)
        g.values.push_back(solid.value()->value(g.origin + spacing * Vec3{double(i), double(j), double(k)}));
    }
  }
  return g;
}

}  // namespace isochor
