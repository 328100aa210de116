#include "isochor/effects/cavity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "constraints/chamber/chamber_network.h"
#include "constraints/stencil/face_pool.h"
#include "engine/base/text.h"
#include "engine/mesh/cell_shape.h"
#include "engine/scene/builder.h"
#include "engine/scene/embedding.h"

namespace isochor {

namespace {

// A face turned so that its normal points from the cavity into the solid.
using Face = std::vector<Index>;

std::size_t corners_of(const Face& f) {
  return f.size() == 4 ? 4 : 3;
}

// Ascending; the first of a triangle is -1.
using FaceKey = std::array<Index, 4>;

FaceKey sorted_corners(std::span<const Index> corners) {
  FaceKey key{-1, -1, -1, -1};
  std::copy(corners.begin(), corners.end(), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}
FaceKey key_of(const Face& f) {
  return sorted_corners(std::span(f).first(corners_of(f)));
}

void flip(Face& f) {
  std::swap(f[1], f[corners_of(f) - 1]);
  if (f.size() == 6) std::swap(f[3], f[5]);
}

// Turns faces against the outward normals of the cells that own them; refuses faces that are not on the
// boundary.
Result<void> orient(const BodyData& body, std::vector<Face>& faces, std::span<const Vec3> rest,
                    const std::string& who) {
  const auto per = static_cast<std::size_t>(nodes_per_cell(body.mesh.cell_type));
  const CellShape& shape = cell_shape(body.mesh.cell_type);
  struct Owner {
    int cells = 0;
    Vec3 middle{};  // of the last cell
  };
  std::map<FaceKey, Owner> owners;
  for (const Face& f : faces) owners[key_of(f)] = {};
  for (std::size_t c = 0; c < body.global_cells.size(); c += per) {
    const Index* n = body.global_cells.data() + c;
    for (std::size_t side = 0; side < shape.sides; ++side) {
      std::array<Index, 4> corner{};
      for (std::size_t k = 0; k < shape.side_corners; ++k) corner[k] = n[shape.side[side][k]];
      const auto it = owners.find(sorted_corners(std::span(corner).first(shape.side_corners)));
      if (it == owners.end()) continue;
      ++it->second.cells;
      it->second.middle = {};
      for (std::size_t k = 0; k < shape.corners; ++k)
        it->second.middle += (1.0 / static_cast<double>(shape.corners)) * rest[at(n[k])];
    }
  }
  for (Face& f : faces) {
    const auto& [count, middle] = owners[key_of(f)];
    if (count != 1) {
      return Error{who + "face (" + std::to_string(f[0] - body.first_node + 1) + ", " +
                   std::to_string(f[1] - body.first_node + 1) + ", " +
                   std::to_string(f[2] - body.first_node + 1) + ") belongs to " + std::to_string(count) +
                   " cells; a cavity is bounded by faces of exactly one cell, name boundary surfaces only"};
    }
    // From the diagonals, where there are two.
    const std::size_t last = corners_of(f) - 1;
    const Vec3 a = rest[at(f[0])];
    const Vec3 normal = cross(rest[at(f[last - 1])] - a, rest[at(f[last])] - rest[at(f[last == 3 ? 1 : 0])]);
    if (dot(normal, middle - a) < 0) flip(f);
  }
  return {};
}

// Turns the faces of a thin body, which all go round one way, so that they look out of what they enclose.
Result<void> orient_sheet(const BodyData& body, std::vector<Face>& faces, std::span<const Vec3> rest,
                          const std::string& who) {
  Vec3 middle{};
  for (const Face& f : faces) {
    for (const Index n : f) middle += (1.0 / static_cast<double>(3 * faces.size())) * rest[at(n)];
  }
  double volume = 0, size = 0;
  for (const Face& f : faces) {
    const double cone = dot(cross(rest[at(f[0])] - middle, rest[at(f[1])] - middle), rest[at(f[2])] - middle);
    volume += cone;
    size += std::abs(cone);
  }
  if (!(std::abs(volume) > 1e-6 * size)) {
    return Error{
        who + "the faces of the thin body \"" + body.name +
        "\" are flat or as much bent one way as the other, so that it is not known which side of them "
        "the chamber is on; close the surface"};
  }
  if (volume < 0)
    for (Face& f : faces) flip(f);
  return {};
}

// Boundary loops of the oriented faces: corner nodes in order, with the mid-edge node after each corner for
// Tet10.
//
// A surface is closed where its oriented edges cancel, however many faces meet in one: the volume is a sum
// over faces, whichever of them are thought to be joined.
Result<std::vector<std::vector<Index>>> boundary_loops(const std::vector<Face>& faces,
                                                       const std::string& who) {
  struct Edge {
    int forward = 0, backward = 0;  // faces that run along it from the smaller node on, and against that
    Index middle = -1;
  };
  std::map<std::pair<Index, Index>, Edge> edges;
  for (const Face& f : faces) {
    for (std::size_t k = 0; k < corners_of(f); ++k) {
      const Index a = f[k], b = f[(k + 1) % corners_of(f)];
      Edge& edge = edges[std::minmax(a, b)];
      ++(a < b ? edge.forward : edge.backward);
      if (f.size() == 6) edge.middle = f[3 + k];
    }
  }
  std::map<Index, std::pair<Index, Index>> next;  // corner -> (next corner, mid)
  for (const auto& [ends, edge] : edges) {
    const int open = edge.forward - edge.backward;
    if (open == 0) continue;
    // The hole's loop runs against the faces.
    const Index from = open > 0 ? ends.second : ends.first, to = open > 0 ? ends.first : ends.second;
    if (std::abs(open) > 1 || !next.emplace(from, std::pair(to, edge.middle)).second) {
      return Error{who +
                   "two of its openings touch in one node; separate them in the mesh, or add the faces "
                   "between them to the cavity"};
    }
  }
  std::vector<std::vector<Index>> loops;
  while (!next.empty()) {
    std::vector<Index> loop;
    Index at_node = next.begin()->first;
    while (true) {
      const auto it = next.find(at_node);
      if (it == next.end()) break;
      loop.push_back(it->first);
      if (it->second.second >= 0) loop.push_back(it->second.second);
      at_node = it->second.first;
      next.erase(it);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

// Fan over a loop from the corner that comes first by its rest position: the cap of a free rim is then the
// same however the nodes are numbered.
void add_cap(EnclosedVolumePool& pool, std::vector<Index> loop, std::span<const Vec3> rest, bool curved) {
  const std::size_t stride = curved ? 2 : 1, corners = loop.size() / stride;
  std::size_t apex = 0;
  for (std::size_t i = 1; i < corners; ++i) {
    const Vec3 &a = rest[at(loop[i * stride])], &b = rest[at(loop[apex * stride])];
    if (std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z}) apex = i;
  }
  std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(apex * stride), loop.end());
  const auto corner = [&](std::size_t i) { return loop[(i % corners) * stride]; };
  const auto middle = [&](std::size_t i) { return loop[(i % corners) * stride + 1]; };
  if (!curved) {
    for (std::size_t i = 1; i + 1 < corners; ++i) {
      const Index tri[3] = {corner(0), corner(i), corner(i + 1)};
      pool.add_face(tri, triangle3_rule());
    }
    return;
  }
  // The fan meets the two edges at its apex along their chords; their bulges are added apart.
  for (std::size_t i = 1; i + 1 < corners; ++i) {
    const Index cap[4] = {corner(0), corner(i), corner(i + 1), middle(i)};
    pool.add_face(cap, cap4_rule());
  }
  for (const std::size_t i : {std::size_t{0}, corners - 1}) {
    const Index bulge[3] = {corner(i), corner(i + 1), middle(i)};
    pool.add_face(bulge, bulge3_rule());
  }
}

// An opening that lies on several symmetry planes, such as that of an eighth of a sphere. Its nodes slide in
// their planes, so a cap must stay in them too: a fan over nodes would cut the corner and pull on the rim.
// The volume is taken from a point that all planes share, where their caps add nothing; a plane that misses
// the point (the second of two parallel ones) gets a fan from a fixed apex.
class SymmetryCaps {
 public:
  SymmetryCaps(const Builder& builder, double length) : builder_(builder), length_(length) {}

  bool planar(const std::vector<Index>& loop) const {
    const auto rest = builder_.rest();
    Vec3 normal{};
    const Vec3 o = rest[at(loop[0])];
    for (std::size_t i = 0; i < loop.size(); ++i) {
      normal += cross(rest[at(loop[i])] - o, rest[at(loop[(i + 1) % loop.size()])] - o);
    }
    const double size = std::sqrt(dot(normal, normal));
    return size == 0 || std::all_of(loop.begin(), loop.end(), [&](Index n) {
             return std::abs(dot(normal, rest[at(n)] - o)) <= 1e-7 * length_ * size;
           });
  }

  // Finds the plane of every edge; false when an edge lies on none.
  bool add_loop(const std::vector<Index>& loop, std::size_t stride) {
    std::vector<std::size_t> planes;
    for (std::size_t i = 0; i < loop.size(); i += stride) {
      const Index a = loop[i], b = loop[(i + stride) % loop.size()];
      const auto plane = plane_of(a, b, stride == 2 ? loop[i + 1] : a);
      if (!plane) return false;
      planes.push_back(*plane);
    }
    loops_.push_back({loop, stride, std::move(planes)});
    return true;
  }

  // The common point nearest to `start`, and the apex of every plane.
  Vec3 place(const Vec3& start) {
    std::vector<std::size_t> active;
    for (std::size_t k = 0; k < planes_.size() && active.size() < 3; ++k) {
      Vec3 n = planes_[k].normal;
      for (const std::size_t j : active) n -= dot(n, frame_[j]) * frame_[j];
      frame_.resize(planes_.size());
      if (dot(n, n) < 1e-12) continue;
      frame_[k] = (1 / std::sqrt(dot(n, n))) * n;
      active.push_back(k);
    }
    const auto project = [&](Vec3 x, std::size_t dependent) {
      // Few planes, any angles: alternate until all hold.
      for (int sweep = 0; sweep < 200; ++sweep) {
        for (const std::size_t k : active) {
          const bool parallel = std::abs(dot(planes_[k].normal, planes_[dependent].normal)) > 1 - 1e-9;
          const Plane& p = planes_[parallel ? dependent : k];
          x -= (dot(p.normal, x) - p.offset) * p.normal;
        }
      }
      return x;
    };
    const Vec3 origin = planes_.empty() ? start : project(start, active[0]);
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      planes_[k].apex = on(k, origin) ? origin : project(origin, k);
    }
    return origin;
  }

  // What closes the gap between the fans of two planes must lie in a plane through the origin.
  bool fits(const Vec3& origin) const {
    for (const Loop& loop : loops_) {
      for (std::size_t e = 0; e < loop.planes.size(); ++e) {
        const std::size_t k = loop.planes[e], l = loop.planes[(e + 1) % loop.planes.size()];
        if (k == l || planes_[k].apex == planes_[l].apex) continue;
        if (!(on(k, origin) && on(k, planes_[l].apex)) && !(on(l, origin) && on(l, planes_[k].apex)))
          return false;
      }
    }
    return true;
  }

  void add_to(EnclosedVolumePool& pool, const Vec3& origin) const {
    for (const Loop& loop : loops_) {
      for (std::size_t e = 0; e < loop.planes.size(); ++e) {
        const Plane& plane = planes_[loop.planes[e]];
        if (plane.apex == origin) continue;
        const std::size_t i = e * loop.stride;
        const Index edge[3] = {loop.nodes[i], loop.nodes[(i + loop.stride) % loop.nodes.size()],
                               loop.nodes[(i + 1) % loop.nodes.size()]};
        const bool curved = loop.stride == 2;
        pool.add_face(std::span(edge, curved ? 3 : 2), curved ? fan3_rule() : fan2_rule(), plane.apex);
      }
    }
  }

 private:
  struct Plane {
    Vec3 normal{};
    double offset = 0;
    Vec3 apex{};
  };
  struct Loop {
    std::vector<Index> nodes;
    std::size_t stride;
    std::vector<std::size_t> planes;  // of each edge
  };

  bool on(std::size_t k, const Vec3& x) const {
    return std::abs(dot(planes_[k].normal, x) - planes_[k].offset) <= 1e-7 * length_;
  }

  // A direction in which both ends (and the middle) are held and along which the edge does not extend.
  std::optional<std::size_t> plane_of(Index a, Index b, Index middle) {
    const auto rest = builder_.rest();
    std::optional<Vec3> found;
    for (const Vec3& n : builder_.directions_given(a)) {
      const auto of_b = builder_.directions_given(b);
      const bool shared = std::any_of(of_b.begin(), of_b.end(),
                                      [&](const Vec3& m) { return std::abs(dot(n, m)) > 1 - 1e-9; });
      if (!shared || std::abs(dot(n, rest[at(b)] - rest[at(a)])) > 1e-7 * length_ ||
          std::abs(dot(n, rest[at(middle)] - rest[at(a)])) > 1e-7 * length_) {
        continue;
      }
      for (std::size_t k = 0; k < planes_.size(); ++k) {
        if (std::abs(dot(planes_[k].normal, n)) > 1 - 1e-9 && on(k, rest[at(a)])) return k;
      }
      found = n;
    }
    if (!found) return std::nullopt;
    planes_.push_back({*found, dot(*found, rest[at(a)]), {}});
    return planes_.size() - 1;
  }

  const Builder& builder_;
  double length_;
  std::vector<Plane> planes_;
  std::vector<Vec3> frame_;
  std::vector<Loop> loops_;
};

class CavityRow final : public RowPool {
 public:
  CavityRow(std::string name, CavityControl control, double rest_volume, std::shared_ptr<Amount> amount)
      : name_(std::move(name)), control_(control), rest_volume_(rest_volume), amount_(std::move(amount)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = amount_value(t); }

  // Multiplier -p for pressure control, target volume otherwise.
  double amount_value(double t) const {
    const double a = amount_->value(t);
    if (control_ == CavityControl::pressure) return -a;
    return control_ == CavityControl::volume ? a : a * rest_volume_;
  }

 private:
  std::string name_;
  CavityControl control_;
  double rest_volume_;
  std::shared_ptr<Amount> amount_;
};

// The weight of a liquid: its potential energy over density times gravity, as a row whose multiplier is
// given.
class WeightRow final : public RowPool {
 public:
  WeightRow(std::string name, double density_gravity, Curve curve)
      : name_(std::move(name)), weight_(density_gravity), curve_(std::move(curve)) {}
  std::string_view name() const override { return name_; }
  void update(double t, std::span<double> value) const override { value[0] = weight_ * evaluate(curve_, t); }

 private:
  std::string name_;
  double weight_;  // density times gravity [Pa/m]
  Curve curve_;
};

class CavityInstance final : public EffectInstance {
 public:
  CavityInstance(std::string name, std::shared_ptr<const EnclosedVolumePool> pool,
                 std::shared_ptr<CavityRow> row, Index row_pool, std::shared_ptr<Amount> amount)
      : name_(std::move(name)),
        pool_(std::move(pool)),
        row_(std::move(row)),
        row_pool_(row_pool),
        amount_(std::move(amount)) {}

  // Of a chamber in a network.
  std::shared_ptr<const ChamberNetwork> network;
  Index chamber = 0;

  Amount* amount() override { return amount_.get(); }
  void gauges(const GaugeContext& c, std::vector<Gauge>& out) const override {
    const bool given = !network && row_->law == RowLaw::prescribed;
    const double lambda =
        given ? row_->amount_value(c.state.t) : c.state.lambda[at(c.system.first_row(row_pool_) + chamber)];
    out.push_back({name_, "cavity", "pressure", "Pa", -lambda});
    out.push_back({name_, "cavity", "volume", "m^3", pool_->volume(c.state.x)});
    if (!network) return;
    const auto memory = c.system.row_memory(row_pool_, std::span<const double>(c.state.extra));
    out.push_back({name_, "cavity", "content", "m^3", ChamberNetwork::held(memory, chamber)});
  }
  std::vector<GaugeSource> gauge_sources() const override {
    return {{"pressure", row_pool_, chamber, true, -1}, {"volume", row_pool_, chamber, false, 1}};
  }

 private:
  std::string name_;
  std::shared_ptr<const EnclosedVolumePool> pool_;
  std::shared_ptr<CavityRow> row_;
  Index row_pool_;
  std::shared_ptr<Amount> amount_;
};

class CavityEffect final : public EffectSource {
 public:
  explicit CavityEffect(CavityDef def) : def_(std::move(def)) {}
  const std::string& name() const override { return def_.name; }
  void describe(Fingerprint& f) const override { f.add(def_); }

  Result<void> check() const override {
    for (const auto& p : def_.amount.points) {
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
        return Error{who() + "its amount has a value that is no number"};
      if (def_.control == CavityControl::gas && p[1] <= 0) {
        return Error{who() + "gas amount " + number(p[1]) +
                     "; some gas must stay in the chamber, give positive amounts"};
      }
      if (def_.control != CavityControl::pressure && p[1] <= 0) {
        return Error{who() + "volume amount " + number(p[1]) + "; a chamber's volume must stay positive"};
      }
    }
    if (def_.surfaces.empty())
      return Error{who() + "no surface named; name the faces that bound the chamber"};
    return check_content();
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto list = builder.faces(def_.body, def_.surfaces, def_.name);
    if (!list) return list.failure();
    const BodyData& body = builder.body(def_.body);
    const auto per = static_cast<std::size_t>(nodes_per_face(body.mesh.cell_type));
    std::vector<Face> faces;
    for (std::size_t f = 0; f < list.value().size(); f += per) {
      const auto first = list.value().begin() + static_cast<std::ptrdiff_t>(f);
      faces.emplace_back(first, first + static_cast<std::ptrdiff_t>(per));
    }
    if (auto r = body.thin() ? orient_sheet(body, faces, builder.rest(), who())
                             : orient(body, faces, builder.rest(), who());
        !r)
      return r.failure();
    Vec3 origin{};
    for (const Face& f : faces)
      origin += (1.0 / static_cast<double>(faces.size())) * builder.rest()[at(f[0])];
    auto loops = boundary_loops(faces, who());
    if (!loops) return loops.failure();
    SymmetryCaps symmetry(builder, builder.length());
    std::vector<const std::vector<Index>*> fans;
    for (const auto& loop : loops.value()) {
      if (auto r = check_opening(builder, body, loop); !r) return r.failure();
      const bool flat = symmetry.planar(loop);
      if (flat || !symmetry.add_loop(loop, per == 6 ? 2 : 1)) fans.push_back(&loop);
    }
    warn_of_lids(builder, faces, loops.value());
    origin = symmetry.place(origin);
    if (!symmetry.fits(origin)) {
      return Error{who() +
                   "an opening runs over symmetry planes that do not meet in one point; model more of the "
                   "body, or close the surface"};
    }
    auto pool = std::make_shared<EnclosedVolumePool>(def_.name, origin);
    for (const Face& f : faces) pool->add_face(f, face_rule(per));
    for (const auto* loop : fans) add_cap(*pool, *loop, builder.rest(), per == 6);
    symmetry.add_to(*pool, origin);
    pool->finish();
    return finish(builder, pool);
  }

 private:
  std::string who() const { return "cavity \"" + def_.name + "\": "; }
  bool has_law() const { return def_.control == CavityControl::gas || def_.control == CavityControl::liquid; }

  Result<void> check_content() const {
    if (!(def_.polytropic >= 1) || !std::isfinite(def_.polytropic)) {
      return Error{who() + "polytropic = " + number(def_.polytropic) +
                   "; it is 1 for an isothermal gas and 1.4 for air without heat exchange"};
    }
    if (!(def_.ambient > 0) || !std::isfinite(def_.ambient)) {
      return Error{who() + "ambient = " + number(def_.ambient) +
                   " Pa; the absolute pressure outside must be positive, 101325 Pa at sea level"};
    }
    if (!(def_.density >= 0) || !std::isfinite(def_.density) ||
        !std::isfinite(dot(def_.gravity, def_.gravity))) {
      return Error{who() + "density = " + number(def_.density) +
                   " kg/m^3; density and gravity of the liquid must be finite, the density not negative"};
    }
    return {};
  }

  Result<void> check_opening(const Builder& builder, const BodyData& body,
                             const std::vector<Index>& loop) const {
    if (def_.cap_free_openings) return {};
    for (const Index n : loop) {
      if (builder.given_directions(n) > 0) continue;
      const Vec3& X = builder.rest()[at(n)];
      return Error{who() + "it has an opening of " + std::to_string(loop.size()) +
                   " nodes that nothing caps: node " + std::to_string(n - body.first_node + 1) + " at (" +
                   number(X.x) + ", " + number(X.y) + ", " + number(X.z) +
                   ") is free; close the surface, hold the rim with a dirichlet support added before the "
                   "cavity, or set "
                   "cap_free_openings for a membrane that seals it and pulls on its rim. For a load on faces "
                   "that bound no "
                   "chamber take a pressure (it follows them) or a traction"};
    }
    return {};
  }

  // A cap hands the force on it to its rim. Over faces that point one way it is as large as that on them, and
  // what was meant as a load ends as a pinch of the rim.
  void warn_of_lids(Builder& builder, const std::vector<Face>& faces,
                    const std::vector<std::vector<Index>>& loops) const {
    const auto is_free = [&](const std::vector<Index>& loop) {
      return std::any_of(loop.begin(), loop.end(), [&](Index n) { return builder.given_directions(n) == 0; });
    };
    if (std::none_of(loops.begin(), loops.end(), is_free)) return;
    const auto rest = builder.rest();
    Vec3 sum{};
    double area = 0;
    for (const Face& f : faces) {
      const std::size_t last = corners_of(f) - 1;
      const Vec3 n = 0.5 * cross(rest[at(f[last - 1])] - rest[at(f[0])],
                                 rest[at(f[last])] - rest[at(f[last == 3 ? 1 : 0])]);
      sum += n;
      area += std::sqrt(dot(n, n));
    }
    const double net = std::sqrt(dot(sum, sum));
    if (net < 0.3 * area) return;
    builder.warn(who() +
                 "its surface is mostly open, and the cap over its free rim cancels the load: of the force "
                 "on the faces, " +
                 number(net) +
                 " m^2 times the pressure, nothing reaches the supports; "
                 "take a pressure (or a traction) for a load on faces that bound no chamber");
  }

  Result<std::unique_ptr<EffectInstance>> finish(Builder& builder,
                                                 const std::shared_ptr<EnclosedVolumePool>& pool) const {
    const double rest_volume = pool->volume(builder.rest());
    const bool needs_chamber = def_.control != CavityControl::pressure || def_.density > 0;
    if (needs_chamber && rest_volume <= 0) {
      return Error{who() + "its surface encloses the body rather than a chamber (signed volume " +
                   number(rest_volume) +
                   " m^3); volume control needs a chamber, use pressure control outside"};
    }
    auto amount = std::make_shared<Amount>(def_.amount);
    const double metric = std::abs(rest_volume) / stiffest(builder.body(def_.body));
    add_weight(builder, *pool);
    if (has_law()) {
      auto network = chamber_network(builder);
      ChamberContent content{
          def_.name, def_.control == CavityControl::gas, def_.polytropic, def_.ambient, rest_volume, amount};
      const Index chamber = network->add_chamber(std::move(content), *pool, metric, builder.owner());
      auto instance =
          std::make_unique<CavityInstance>(def_.name, pool, nullptr, network->row_pool, std::move(amount));
      instance->network = network;
      instance->chamber = chamber;
      return std::unique_ptr<EffectInstance>(std::move(instance));
    }
    auto row = std::make_shared<CavityRow>(def_.name, def_.control, rest_volume, amount);
    row->stencil_pool = builder.add_stencils(pool);
    row->law = def_.control == CavityControl::pressure ? RowLaw::prescribed : RowLaw::compliant;
    push_row(*row, *pool, metric, std::abs(rest_volume));
    const Index row_pool = builder.add_rows(row);
    return std::unique_ptr<EffectInstance>(
        std::make_unique<CavityInstance>(def_.name, pool, row, row_pool, std::move(amount)));
  }

  // One row over all faces.
  static void push_row(RowPool& row, const StencilPool& pool, double metric, double measure) {
    for (Index f = 0; f < pool.stencils(); ++f) {
      row.map.item.push_back(f);
      row.weight.push_back(1);
    }
    row.map.offset.push_back(pool.stencils());
    row.metric.push_back(metric);
    row.measure.push_back(measure);
  }

  // The pressure that the liquid's own weight adds, density gravity . (x - datum): minus the gradient of its
  // potential energy.
  void add_weight(Builder& builder, const EnclosedVolumePool& surface) const {
    const double g = std::sqrt(dot(def_.gravity, def_.gravity));
    if (def_.density == 0 || g == 0) return;
    const Vec3 datum = def_.datum.value_or(middle(builder, surface));
    auto moment = std::make_shared<EnclosedVolumePool>(def_.name + "/weight", surface.origin(),
                                                       (-1 / g) * def_.gravity, datum);
    moment->add_faces(surface);
    moment->finish();
    auto row = std::make_shared<WeightRow>(def_.name + "/weight", def_.density * g, def_.gravity_curve);
    row->stencil_pool = builder.add_stencils(moment);
    row->law = RowLaw::prescribed;
    const double volume = surface.volume(builder.rest()), length = std::cbrt(volume);
    push_row(*row, *moment, volume * length * length / stiffest(builder.body(def_.body)), volume * length);
    builder.add_rows(row);
  }

  // Of the box around the surface.
  static Vec3 middle(const Builder& builder, const EnclosedVolumePool& surface) {
    Vec3 lower = builder.rest()[at(surface.nodes().item.front())], upper = lower;
    for (const Index n : surface.nodes().item) {
      for (int k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], builder.rest()[at(n)][k]);
        upper[k] = std::max(upper[k], builder.rest()[at(n)][k]);
      }
    }
    return 0.5 * (lower + upper);
  }

  CavityDef def_;
};

}  // namespace

EffectPtr cavity(CavityDef def) {
  return std::make_shared<CavityEffect>(std::move(def));
}

}  // namespace isochor
