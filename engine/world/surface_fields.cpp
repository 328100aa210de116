#include "engine/world/surface_fields.h"

#include <algorithm>

#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

// A node's place between the two corners a and b of a Tet10.
std::size_t middle_of(std::size_t a, std::size_t b) {
  for (std::size_t e = 0; e < kTetShape.edges; ++e) {
    const auto& edge = kTetShape.edge[e];
    if ((edge[0] == a && edge[1] == b) || (edge[0] == b && edge[1] == a)) return kTetShape.corners + e;
  }
  return 0;
}

// On faces of six nodes a uniform pressure pushes at the middles of edges alone. Each face takes the mean of
// its nodes, corners counting a third of what the middles do where they have an area at all, and each node
// the mean of its faces.
void even_out(const Mesh& mesh, std::span<const double> area, std::vector<Vec3>& traction,
              std::vector<double>& pressure) {
  std::vector<Vec3> traction_sum(traction.size());
  std::vector<double> pressure_sum(pressure.size(), 0), faces(pressure.size(), 0);
  for (std::size_t first = 0; first + 10 <= mesh.cells.size(); first += 10) {
    for (std::size_t side = 0; side < kTetShape.sides; ++side) {
      const auto& corner = kTetShape.side[side];
      std::array<std::size_t, 6> node{};
      for (std::size_t k = 0; k < 3; ++k) {
        node[k] = at(mesh.cells[first + corner[k]]);
        node[3 + k] = at(mesh.cells[first + middle_of(corner[k], corner[(k + 1) % 3])]);
      }
      if (!std::all_of(node.begin() + 3, node.end(), [&](std::size_t n) { return area[n] > 0; })) continue;
      // A face that is pressed along one edge only has a neighbor around it that is pressed.
      if (std::count_if(node.begin() + 3, node.end(), [&](std::size_t n) { return pressure[n] > 0; }) < 2)
        continue;
      double weight = 0, p = 0;
      Vec3 t{};
      for (std::size_t k = 0; k < 6; ++k) {
        if (!(area[node[k]] > 0)) continue;
        const double w = k < 3 ? 1.0 / 12 : 0.25;
        weight += w;
        p += w * pressure[node[k]];
        t += w * traction[node[k]];
      }
      for (const std::size_t n : node) {
        faces[n] += 1;
        pressure_sum[n] += p / weight;
        traction_sum[n] += (1 / weight) * t;
      }
    }
  }
  for (std::size_t n = 0; n < pressure.size(); ++n) {
    if (faces[n] == 0) continue;
    pressure[n] = pressure_sum[n] / faces[n];
    traction[n] = (1 / faces[n]) * traction_sum[n];
  }
}

}  // namespace

void add_surface_fields(std::span<const std::unique_ptr<EffectInstance>> effects, const GaugeContext& context,
                        const BodyData& body, BodyFields& fields) {
  const std::size_t nodes = at(body.mesh.node_count()), first = at(body.first_node);
  std::vector<double> pressure, area;
  std::vector<Vec3> traction;
  for (const auto& effect : effects) {
    if (!effect) continue;
    SurfaceForces f;
    if (!effect->surface_forces(context, f)) continue;
    const auto of_body = std::span<const double>(f.area).subspan(first, nodes);
    if (std::all_of(of_body.begin(), of_body.end(), [](double a) { return !(a > 0); })) continue;
    pressure.resize(nodes, 0);
    area.resize(nodes, 0);
    traction.resize(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
      pressure[i] += f.normal[first + i];
      traction[i] += f.tangential[first + i];
      // Several effects may be about one surface: it is there once all the same.
      area[i] = std::max(area[i], f.area[first + i]);
    }
  }
  if (area.empty()) return;
  for (std::size_t i = 0; i < nodes; ++i) {
    const double share = area[i] > 0 ? 1 / area[i] : 0;
    pressure[i] *= share;
    traction[i] = share * traction[i];
  }
  if (body.mesh.cell_type == CellType::tet10) even_out(body.mesh, area, traction, pressure);
  for (const Vec3& t : traction) {
    for (int k = 0; k < 3; ++k) fields.node_friction.push_back(t[k]);
  }
  fields.node_contact_pressure = std::move(pressure);
}

}  // namespace isochor
