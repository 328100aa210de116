#include "constraints/contact/surface/surface_contact_pool.h"

#include <algorithm>
#include <cmath>

namespace isochor {

namespace {

constexpr double kSame = 1e-3;  // difference of distances over the size of a face that does not matter

}  // namespace

void SurfaceContactPool::accept(const StencilRequest& q, std::span<double> memory) const {
  keep_pairs(geometry().center(), friction_memory().per_point(), memory);
  FrictionalPool::accept(q, memory);
}

PatchPoint SurfaceContactPool::seen_from(Index s, Index center, std::span<const Vec3> x) const {
  const ContactSurface::Around around = setup().surface->around(center, s);
  std::array<Vec3, kPatchNodes> corner{};
  for (std::size_t k = 0; k < around.patch.nodes; ++k) corner[k] = x[at(around.node[k])];
  return nearest_on_patch(setup().surface->points()[at(s)].position(x),
                          std::span(corner).first(around.patch.nodes), around.patch);
}

// Whether the nearest place is beyond the patch by more than a quarter of a face, or by anything where the
// patch is not flat. Up to there what slides on a flat surface needs no new stencils, which cost an analysis.
bool SurfaceContactPool::reaches_out(const PatchPoint& near, Index s, Index center,
                                     std::span<const Vec3> x) const {
  constexpr double flat = 0.999;  // cosine of 2.5 degrees
  const ContactSurface::Around around = setup().surface->around(center, s);
  const auto normal = [&](const std::array<std::uint8_t, 3>& c) {
    const Vec3 a = x[at(around.node[c[0]])];
    return cross(x[at(around.node[c[1]])] - a, x[at(around.node[c[2]])] - a);
  };
  const Vec3 middle = normal(around.patch.corner[0]);
  for (std::size_t t = 1; t < around.patch.triangles; ++t) {
    const Vec3 n = normal(around.patch.corner[t]);
    if (!around.patch.side[t] && dot(n, middle) < flat * norm(n) * norm(middle)) return true;
  }
  return around.patch.face > 3 ||
         std::any_of(near.weight.begin(), near.weight.end(), [](double w) { return w < -0.25; });
}

Renewal SurfaceContactPool::renewed(const RenewalRequest& q) const {
  const ContactSurface& surface = *setup().surface;
  const double deep = 0.5 * surface.size();
  const std::vector<Index>& center = geometry().center();
  std::vector<ContactSurface::Finding> found(center.size());
  const std::vector<Index> base =
      q.memory.empty() ? center : pairs_in_memory(q.memory, friction_memory().per_point());
  surface.search(q.from, q.x, reach(), base, q.parallel, found);
  Renewal answer;
  bool needed = false;
  std::vector<Index> target(center.size(), -1);
  for (Index s = 0; s < stencils(); ++s) {
    const ContactSurface::Finding& f = found[at(s)];
    const Index c = base[at(s)];
    target[at(s)] = f.nearest;
    const bool seen = f.nearest >= 0 && surface.in_patch(c, f.nearest, s);
    if (f.crossed >= 0 && !(f.nearest >= 0 && std::abs(f.distance) < deep)) {
      // Through a triangle and far behind it, rather than a little into what is nearest now, or back in
      // front.
      target[at(s)] = f.crossed;
      if (!surface.in_patch(c, f.crossed, s)) {
        ++answer.crossed;
        needed = true;
        continue;
      }
      target[at(s)] = c;
      if (q.solved && center[at(s)] == c && geometry().nearest(s, q.x).distance >= 0) ++answer.passing;
      continue;
    }
    if (f.nearest < 0 && c >= 0 && center[at(s)] == c) {
      // Deeper than the search reaches; or beside, or turned away from, what it was close to.
      const double present = geometry().nearest(s, q.x).distance;
      const bool inside = present < setup().offset;
      if (present < -0.9 * reach() && surface.facing(s, c, q.x)) target[at(s)] = c;
      needed = needed || (inside && target[at(s)] != c);
    }
    if (f.nearest < 0 || seen) continue;
    // Beside a sharp edge the patch around it says that the point is outside; beyond a corner its planes may
    // be above a point that is not inside.
    const double distance = std::max(f.distance, seen_from(s, f.nearest, q.x).distance);
    const double gap = distance - setup().offset;
    if (c < 0) {
      needed = needed || gap < (q.solved ? 0 : 0.4 * reach());
      continue;
    }
    const PatchPoint here = seen_from(s, c, q.x);
    const bool differs = std::abs(distance - here.distance) > kSame * surface.size();
    if (q.solved)
      needed = needed || (std::min(distance, here.distance) < setup().offset && differs);
    else
      needed = needed || (gap < 0.4 * reach() && (differs || reaches_out(here, s, c, q.x)));
  }
  if (!needed) target = base;
  if (target != center)
    answer.pool = std::make_shared<SurfaceContactPool>(geometry().setup(), std::move(target));
  return answer;
}

Result<std::shared_ptr<const StencilPool>> SurfaceContactPool::restored(
    std::span<const double> memory) const {
  auto kept = checked_pairs(memory, friction_memory().per_point(), setup().surface->triangles(), setup().name,
                            "triangle");
  if (!kept) return kept.failure();
  return std::shared_ptr<const StencilPool>(
      std::make_shared<SurfaceContactPool>(geometry().setup(), std::move(kept).value()));
}

}  // namespace isochor
