// A thin sheet that stretches, shears and bends: a membrane, hinges on its edges, and mass.
#include <algorithm>
#include <cmath>

#include "constraints/layer/sheet_fields.h"
#include "constraints/layer/sheet_pool.h"
#include "constraints/stencil/mesh_field.h"
#include "constraints/stencil/surface_nodes.h"
#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "isochor/effects/layer.h"

namespace isochor {

namespace {

// Which diagonal cuts a quadrangle, by places alone: the shorter one, and of equal ones that from the corner
// that comes first in x, y and z. True: from its first corner.
bool cut_from_first(std::span<const Index> q, std::span<const Vec3> rest) {
  const Vec3 one = rest[at(q[2])] - rest[at(q[0])], other = rest[at(q[3])] - rest[at(q[1])];
  const double difference = dot(one, one) - dot(other, other);
  if (std::abs(difference) > 1e-9 * dot(one, one)) return difference < 0;
  const auto before = [&](Index a, Index b) {
    const Vec3 &x = rest[at(a)], &y = rest[at(b)];
    return std::array{x.x, x.y, x.z} < std::array{y.x, y.y, y.z};
  };
  return (std::min_element(q.begin(), q.end(), before) - q.begin()) % 2 == 0;
}

// Flat triangles in place of faces: the four of six nodes, the two of a quadrangle.
std::vector<Index> flat_triangles(std::span<const Index> faces, std::size_t per, std::span<const Vec3> rest) {
  if (per == 3) return {faces.begin(), faces.end()};
  constexpr std::size_t kCurved[] = {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5}, kFirst[] = {0, 1, 2, 0, 2, 3},
                        kSecond[] = {0, 1, 3, 1, 2, 3};
  std::vector<Index> triangles;
  for (std::size_t f = 0; f < faces.size(); f += per) {
    const auto face = faces.subspan(f, per);
    const auto parts = per == 6                     ? std::span<const std::size_t>(kCurved)
                       : cut_from_first(face, rest) ? std::span<const std::size_t>(kFirst)
                                                    : std::span<const std::size_t>(kSecond);
    for (const std::size_t k : parts) triangles.push_back(face[k]);
  }
  return triangles;
}

bool any(const Selection& s) {
  return s.everything || !s.surfaces.empty() || !s.regions.empty() || !s.node_sets.empty() ||
         !s.nodes.empty() || !s.boxes.empty() || !s.nearest.empty();
}

class ShellInstance final : public EffectInstance {
 public:
  ShellInstance(std::string name, SheetRecovery sheet, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), sheet_(std::move(sheet)), amount_(std::move(amount)) {}
  Amount* amount() override { return amount_.get(); }
  bool amount_in_energy() const override { return true; }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    out.push_back({name_, "shell", "area", "m^2", sheet_.membrane->area(c.state.x, c.system.parts().rest)});
    double largest = 0;
    for (const SheetCell& cell : recover_sheet(sheet_, c)) largest = std::max(largest, cell.largest);
    out.push_back({name_, "shell", "largest_stress", "Pa", largest});
  }

 private:
  std::string name_;
  SheetRecovery sheet_;
  std::shared_ptr<Amount> amount_;  // of the prestretch; null: there is none
};

class ShellEffect final : public EffectSource {
 public:
  explicit ShellEffect(ShellDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    if (!(def_.young > 0) || !std::isfinite(def_.young)) {
      return Error{who() + "young = " + number(def_.young) + " Pa; it must be positive"};
    }
    if (!(def_.poisson >= 0) || !(def_.poisson <= 0.5)) {
      return Error{who() + "poisson = " + number(def_.poisson) +
                   "; it must lie between 0 and 0.5, 0.5 is an incompressible sheet"};
    }
    if (!(def_.thickness > 0) || !std::isfinite(def_.thickness)) {
      return Error{who() + "thickness = " + number(def_.thickness) + " m; it must be positive"};
    }
    if (!(def_.density >= 0) || !std::isfinite(def_.density)) {
      return Error{who() + "density = " + number(def_.density) +
                   " kg/m^3; it must be positive, or 0 for a layer without mass"};
    }
    if (!(def_.bending >= 0) || !std::isfinite(def_.bending)) {
      return Error{who() + "bending = " + number(def_.bending) +
                   " N m; it must be positive, or 0 for that of a solid sheet; one that does not resist "
                   "bending at all is a membrane"};
    }
    if (auto r = check_sheet(def_.prestretch, def_.amount, def_.fibers); !r) return Error{who() + r.error()};
    return {};
  }

  // What else is tied to a thin body measures itself by its stiffness.
  Result<void> declare(Builder& builder) const override {
    if (builder.has_body(def_.body) && builder.body(def_.body).thin())
      builder.lend_modulus(def_.body, def_.young / (2 * (1 + def_.poisson)));
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto triangles = sheet(builder);
    if (!triangles) return triangles.failure();
    BentSheet bent;
    bent.triangles = std::move(triangles).value();
    bent.bending = def_.bending > 0 ? def_.bending
                                    : def_.young * def_.thickness * def_.thickness * def_.thickness /
                                          (12 * (1 - def_.poisson * def_.poisson));
    bent.poisson = def_.poisson;
    bent.flat = def_.flat;
    if (any(def_.clamped)) {
      auto nodes = builder.select(def_.clamped, def_.name);
      if (!nodes) return nodes.failure();
      bent.clamped.insert(nodes.value().begin(), nodes.value().end());
    }
    auto bending = make_bending(def_.name, bent, builder.rest());
    if (!bending) return Error{who() + bending.error()};
    if (any(def_.clamped) && bending.value().clamped_edges == 0) {
      return Error{who() +
                   "clamped holds no edge of its rim; select both ends of edges that only one of its "
                   "faces has"};
    }
    auto membrane = stretching(builder, bent.triangles);
    if (!membrane) return membrane.failure();
    SheetRecovery sheet;
    sheet.membrane = membrane.value().pool;
    builder.add_stencils(sheet.membrane);
    if (bending.value().rows->rows() > 0) {
      bending.value().rows->stencil_pool = builder.add_stencils(bending.value().hinges);
      sheet.row_pool = builder.add_rows(bending.value().rows);
    }
    for (Index t = 0; def_.density > 0 && t < sheet.membrane->stencils(); ++t) {
      for (const Index n : sheet.membrane->nodes()[t])
        builder.add_mass(n, def_.density * def_.thickness * sheet.membrane->rest_area(t) / 3);
    }
    sheet.bending = std::move(bending).value();
    sheet.thickness = def_.thickness;
    sheet.solid = def_.bending == 0;
    return std::unique_ptr<EffectInstance>(
        std::make_unique<ShellInstance>(def_.name, std::move(sheet), membrane.value().amount));
  }

 private:
  std::string who() const { return "shell \"" + def_.name + "\": "; }

  struct Stretching {
    std::shared_ptr<const MembranePool> pool;
    std::shared_ptr<Amount> amount;
  };
  // With the directions that a field of the mesh has for them.
  Result<std::vector<FiberFamily>> fibers_in(const Mesh& mesh) const {
    std::vector<FiberFamily> fibers = def_.fibers;
    if (def_.fiber_field.empty()) return fibers;
    if (fibers.empty()) return Error{"fiber_field is given without fibers; give their constants, or drop it"};
    auto directions = cell_directions(mesh, def_.fiber_field);
    if (!directions) return directions.failure();
    for (FiberFamily& f : fibers) {
      if (!f.directions.empty()) return Error{"directions and fiber_field are given; give one of them"};
      f.directions = directions.value();
    }
    if (auto r = check_sheet(def_.prestretch, def_.amount, fibers); !r) return r.failure();
    return fibers;
  }
  Result<Stretching> stretching(const Builder& builder, std::span<const Index> triangles) const {
    auto fibers = fibers_in(builder.body(def_.body).mesh);
    if (!fibers) return Error{who() + fibers.error()};
    for (std::size_t k = 0; k < fibers.value().size(); ++k) {
      const std::size_t count = fibers.value()[k].directions.size();
      const bool whole = builder.body(def_.body).thin() && def_.surfaces.empty();
      if (count == 0 || (whole && 3 * count == triangles.size())) continue;
      return Error{who() + "fibers[" + std::to_string(k) + "]: directions has " + std::to_string(count) +
                   " entries; " +
                   (whole ? "it takes one a cell of the thin body, which has " +
                                std::to_string(triangles.size() / 3) + " cells"
                          : "a shell on named surfaces takes one direction for all, or leave surfaces out")};
    }
    Stretching out;
    Sheet sheet;
    sheet.mu = def_.young / (2 * (1 + def_.poisson));
    sheet.poisson = def_.poisson;
    sheet.thickness = def_.thickness;
    sheet.prestretch = def_.prestretch;
    sheet.fibers = std::move(fibers).value();
    if (sheet.prestretched()) sheet.amount = out.amount = std::make_shared<Amount>(def_.amount);
    std::string undirected;
    out.pool = make_sheet(def_.name, 3, triangles, builder.rest(), sheet, undirected);
    if (undirected.empty()) return out;
    return Error{who() + "the direction of its " + undirected +
                 " stands across one of its faces; give one that lies in the sheet"};
  }

  Result<std::vector<Index>> sheet(const Builder& builder) const {
    if (!builder.has_body(def_.body)) return Error{who() + builder.no_body(def_.body)};
    const BodyData& body = builder.body(def_.body);
    if (!body.thin() && def_.surfaces.empty()) {
      return Error{who() + "surfaces is empty; name the surfaces of the solid body \"" + body.name +
                   "\" that carry the shell"};
    }
    if (body.thin() && !(def_.density > 0)) {
      return Error{who() + "density = 0 kg/m^3, and the thin body \"" + body.name +
                   "\" has no other mass; give the density of the sheet"};
    }
    if (def_.surfaces.empty()) return body.global_cells;
    auto outward = outward_faces(builder, def_.body, def_.surfaces, "shell \"" + def_.name + "\"");
    if (!outward) return outward.failure();
    return flat_triangles(outward.value(), static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type)),
                          builder.rest());
  }

  ShellDef def_;
};

}  // namespace

EffectPtr shell(ShellDef def) {
  def.clamped.body = def.body;
  return std::make_shared<ShellEffect>(std::move(def));
}

}  // namespace isochor
