#include "engine/step/admission.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"

namespace isochor {

namespace {

double tet_determinant(const Index* nodes, std::span<const Vec3> x) {
  const Vec3& a = x[at(nodes[0])];
  return dot(cross(x[at(nodes[1])] - a, x[at(nodes[2])] - a), x[at(nodes[3])] - a);
}

// Whether the energy has a value where a cell has turned over. Asked of a shape that no symmetry makes
// special.
bool lives_through_inversion(const Material& energy, Index element) {
  PointBatch batch;
  ResponseBatch response;
  const double F[9] = {0.9, 0.1, 0, 0, 1.05, -0.05, 0.02, 0, -0.8};
  for (int l = 0; l < kLanes; ++l) {
    for (int i = 0; i < 9; ++i) batch.F[i][l] = F[i];
    batch.element[l] = element;
    batch.J_before[l] = 1;
  }
  energy.evaluate(Want::value, batch, response);
  return std::isfinite(response.psi[0]);
}

// Rows over a logarithm of J have no value below zero.
bool has_logarithmic_rows(const BodyData& body, const RegionData& region) {
  for (std::size_t strain = 0; strain < kVolumeStrains; ++strain) {
    const bool logarithm = static_cast<VolumeStrain>(strain) != VolumeStrain::linear;
    if (logarithm && region.volume_pool[strain] >= 0) return true;
  }
  return std::any_of(body.spanning.begin(), body.spanning.end(), [&](const SpanningVolume& v) {
    return v.strain != VolumeStrain::linear &&
           std::any_of(region.cells.begin(), region.cells.end(),
                       [&](Index c) { return v.stencil_of_cell[at(c)] >= 0; });
  });
}

}  // namespace

Admission::Admission(const std::vector<BodyData>& bodies, const SystemParts& parts) : rest_(parts.rest) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyData& body = bodies[b];
    names_.push_back(body.name);
    if (!body.present()) continue;
    const bool tets = body.mesh.cell_type == CellType::tet4;
    for (const RegionData& region : body.regions) {
      Region r;
      r.body = static_cast<Index>(b);
      r.cells = region.cells;
      if (tets) {
        for (const Index c : region.cells) {
          const Index* nodes = body.global_cells.data() + 4 * at(c);
          r.tets.insert(r.tets.end(), nodes, nodes + 4);
          r.inverse_rest.push_back(1 / tet_determinant(nodes, parts.rest));
        }
      } else {
        r.points = parts.stencil_pools[at(region.elastic_pool)];
      }
      const bool log_rows = has_logarithmic_rows(body, region);
      for (std::size_t k = 0; k < region.cells.size(); ++k) {
        // Where a field varies the constants, what has a value does not vary with them.
        const bool needs = log_rows || !region.energy || !lives_through_inversion(*region.energy, 0) ||
                           (!region.guarded.empty() && region.guarded[k] != 0);
        r.stays.push_back(needs ? 1 : 0);
        if (region.guarded.empty() && k == 0) {
          r.stays.assign(region.cells.size(), r.stays[0]);
          break;
        }
      }
      regions_.push_back(std::move(r));
    }
  }
}

double Admission::determinant(const Region& region, std::size_t k, std::span<const Vec3> x) const {
  if (!region.tets.empty()) return tet_determinant(region.tets.data() + 4 * k, x) * region.inverse_rest[k];
  const auto& pool = static_cast<const SolidPool&>(*region.points);
  double smallest = std::numeric_limits<double>::infinity();
  for (int q = 0; q < pool.data().points; ++q) {
    double F[9], strain = 0;
    pool.deformation_gradient(static_cast<Index>(k), q, x, rest_, F, strain);
    smallest = std::min(smallest, 1 + strain);
  }
  return smallest;
}

Admission::Verdict Admission::judge(std::span<const Vec3> before, std::span<const Vec3> x) const {
  Verdict v;
  bool first = true;
  for (const Region& region : regions_) {
    for (std::size_t k = 0; k < region.cells.size(); ++k) {
      const double J = determinant(region, k, x);
      if (first || !(J >= v.min_J)) {
        v.min_J = J;
        v.body = region.body;
        v.cell = region.cells[k];
        first = false;
      }
      if (J >= crushed_below) continue;
      if (J > 0) {
        ++v.crushed;
        continue;
      }
      ++v.inverted;
      if (!region.stays[k] || !(determinant(region, k, before) > 0)) continue;
      if (v.forbidden++ > 0) continue;
      v.forbidden_body = region.body;
      v.forbidden_cell = region.cells[k];
      v.forbidden_J = J;
    }
  }
  return v;
}

std::string Admission::cell_name(Index body, Index cell) const {
  return "cell " + std::to_string(cell) + " of body \"" + names_[at(body)] + "\"";
}

std::string Admission::refusal(const Verdict& v) const {
  if (v.forbidden == 0) return {};
  return std::to_string(v.forbidden) + (v.forbidden == 1 ? " cell" : " cells") +
         " turned over where the law or the guard has no value: " +
         cell_name(v.forbidden_body, v.forbidden_cell) + " has J = " + number(v.forbidden_J);
}

std::string Admission::warning(const Verdict& v) const {
  if (v.inverted > 0) {
    return std::to_string(v.inverted) + (v.inverted == 1 ? " cell is" : " cells are") +
           " inverted (J <= 0), which the law allows: the smallest J is " + number(v.min_J) + " in " +
           cell_name(v.body, v.cell) +
           "; shorter steps, a finer mesh or a guard may keep them right side out";
  }
  if (v.crushed > 0) {
    return std::to_string(v.crushed) + (v.crushed == 1 ? " cell is" : " cells are") +
           " crushed to less than a hundredth of their volume: the smallest J is " + number(v.min_J) +
           " in " + cell_name(v.body, v.cell) + "; the load is more than the body can carry in good shape";
  }
  return {};
}

}  // namespace isochor
