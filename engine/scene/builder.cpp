#include "engine/scene/builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "engine/base/available_memory.h"
#include "engine/base/text.h"
#include "engine/elements/volume_strain.h"
#include "engine/scene/scene_checks.h"
#include "engine/scene/supports.h"
#include "isochor/generate.h"
#include "isochor/mesh_io.h"

namespace isochor {

double Amount::plain_value(double t) const {
  if (!held_) return evaluate(curve_, t);
  if (t >= t1_ || t1_ <= t0_) return to_;
  if (t <= t0_) return from_;
  return from_ + (to_ - from_) * (t - t0_) / (t1_ - t0_);
}

void Amount::begin(double t0, double t1) {
  if (!pending_) return;
  from_ = value(t0);
  to_ = *pending_;
  t0_ = t0;
  t1_ = t1;
  held_ = true;
  pending_.reset();
}

void Amount::save(std::vector<double>& out) const {
  out.insert(out.end(),
             {held_ ? 1.0 : 0.0, from_, to_, t0_, t1_, pending_ ? 1.0 : 0.0, pending_.value_or(0)});
}

bool Amount::take(std::span<const double>& in) {
  const auto is_flag = [](double v) { return v == 0 || v == 1; };
  if (in.size() < 7 || !is_flag(in[0]) || !is_flag(in[5])) return false;
  in = in.subspan(7);
  return true;
}

bool Amount::load(std::span<const double>& in) {
  if (in.size() < 7) return false;
  held_ = in[0] != 0;
  from_ = in[1];
  to_ = in[2];
  t0_ = in[3];
  t1_ = in[4];
  pending_ = in[5] != 0 ? std::optional(in[6]) : std::nullopt;
  in = in.subspan(7);
  return true;
}

double evaluate(const Curve& curve, double t) {
  const auto& p = curve.points;
  if (p.empty()) return 0;
  if (t <= p.front()[0]) return p.front()[1];
  if (t >= p.back()[0]) return p.back()[1];
  const auto after =
      std::upper_bound(p.begin(), p.end(), t, [](double v, const auto& q) { return v < q[0]; });
  const auto& b = *after;
  const auto& a = *(after - 1);
  return a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]);
}

namespace {

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& n : names) text += (text.empty() ? "" : ", ") + ("\"" + n + "\"");
  return text.empty() ? "none" : text;
}

std::string unknown_name(const std::string& who, const std::string& what, const std::string& name,
                         const std::string& body, const std::vector<std::string>& known) {
  return who + ": body \"" + body + "\" has no " + what + " named \"" + name + "\"; it has " + join(known);
}

}  // namespace

Result<void> Builder::add_regions(const BodyDef& def, BodyData& body) const {
  const Mesh& mesh = body.mesh;
  if (mesh.cell_type == CellType::tri3) {
    if (def.materials.empty()) return {};
    return Error{
        "body \"" + def.name +
        "\": it is thin (element \"tri3\") and takes no materials; give it a shell, which has its own "
        "modulus, thickness and density"};
  }
  std::vector<std::string> names = mesh.regions;
  if (names.empty()) names = {"body"};
  for (std::size_t i = 0; i < def.materials.size(); ++i) {
    const RegionMaterial& m = def.materials[i];
    for (std::size_t k = 0; k < i; ++k) {
      if (def.materials[k].region != m.region) continue;
      return Error{"body \"" + def.name + "\": materials " + std::to_string(k) + " and " + std::to_string(i) +
                   (m.region.empty() ? " are both for all regions that no other names"
                                     : " are both for region \"" + m.region + "\"") +
                   "; keep one of them, or give each a region of its own"};
    }
    if (!m.region.empty() && std::find(names.begin(), names.end(), m.region) == names.end()) {
      return Error{unknown_name("body \"" + def.name + "\": materials", "region", m.region, def.name, names)};
    }
    if (!m.material)
      return Error{"body \"" + def.name + "\": a material is empty; make one with neo_hookean() or another"};
    if (!std::isfinite(m.density) || m.density <= 0) {
      return Error{"body \"" + def.name + "\": density = " + number(m.density) +
                   " kg/m^3; it must be a positive number"};
    }
  }
  for (std::size_t r = 0; r < names.size(); ++r) {
    RegionData region;
    region.name = names[r];
    const RegionMaterial* chosen = nullptr;
    for (const RegionMaterial& m : def.materials) {
      if (m.region == names[r]) chosen = &m;
      if (m.region.empty() && !chosen) chosen = &m;
    }
    for (Index c = 0; c < mesh.cell_count(); ++c) {
      const Index of = mesh.cell_region.empty() ? 0 : mesh.cell_region[at(c)];
      if (of == static_cast<Index>(r)) region.cells.push_back(c);
    }
    if (region.cells.empty()) continue;
    if (!chosen) {
      return Error{"body \"" + def.name + "\": region \"" + names[r] +
                   "\" has no material; add one for it, or one with an empty region name for all the rest"};
    }
    region.material = chosen->material;
    region.density = chosen->density;
    body.regions.push_back(std::move(region));
  }
  return {};
}

namespace {

// Whether the cells of the mesh can carry the element.
Result<void> check_element(const BodyDef& def) {
  const bool triangles = def.mesh.cell_type == CellType::tri3;
  if (triangles && def.element != Element::tri3) {
    return Error{"body \"" + def.name +
                 "\": a mesh of triangles needs element \"tri3\", a thin body; give a mesh of tetrahedra or "
                 "hexahedra for a solid one"};
  }
  if (!triangles && def.element == Element::tri3) {
    return Error{
        "body \"" + def.name +
        "\": element \"tri3\" is for thin bodies and needs a mesh of triangles; read the file with its "
        "triangles as cells, or choose an element for solids"};
  }
  const bool hexahedra = def.mesh.cell_type == CellType::hex8;
  if (hexahedra && def.element != Element::hex8) {
    return Error{"body \"" + def.name +
                 "\": a mesh of hexahedra needs element \"hex8\"; give a mesh of tetrahedra for the others"};
  }
  if (!hexahedra && def.element == Element::hex8) {
    return Error{"body \"" + def.name +
                 "\": element \"hex8\" needs a mesh of 8-node hexahedra and this one has tetrahedra; "
                 "choose \"tet4_edge_smoothed\", \"tet4\" or \"tet10\""};
  }
  if (def.mesh.cell_type == CellType::tet10 && def.element != Element::tet10) {
    return Error{"body \"" + def.name +
                 "\": a Tet10 mesh needs element \"tet10\"; give a Tet4 mesh for linear tets"};
  }
  // Anything else would be an energy without bound below.
  if (def.guard_stiffness && !(*def.guard_stiffness >= 0))
    return Error{"body \"" + def.name + "\": guard_stiffness = " + number(*def.guard_stiffness) +
                 "; give 0 (off) or a positive number"};
  if (!(def.guard_threshold > 0))
    return Error{"body \"" + def.name + "\": guard_threshold = " + number(def.guard_threshold) +
                 "; it must be positive, the J below which the guard acts"};
  return {};
}

}  // namespace

Result<Index> Builder::add_body(const BodyDef& def) {
  for (const BodyData& other : bodies_) {
    if (other.present() && other.name == def.name)
      return Error{"body \"" + def.name + "\": another body has this name; names must differ"};
  }
  const CellType cells = def.element == Element::tet10 ? CellType::tet10 : def.mesh.cell_type;
  if (const auto why = too_large_for_memory(def.mesh.cell_count(), cells, MeshUse::simulate); !why.empty())
    return Error{"body \"" + def.name + "\": " + why, ErrorKind::no_memory};
  const MeshReport report = check_mesh(def.mesh);
  BodyData body;
  std::string doubtful_units;
  for (const MeshFinding& finding : report.findings) {
    if (finding.severity == Severity::error) {
      return Error{"body \"" + def.name + "\": mesh " + def.mesh.source + ": " + finding.message};
    }
    if (finding.severity == Severity::warning) {
      const std::string text = "body \"" + def.name + "\": mesh " + def.mesh.source + ": " + finding.message;
      if (finding.code == "units") doubtful_units += "; mind the units: " + text;
      body.warnings.push_back(text);
    }
  }
  if (auto r = check_element(def); !r) return r.failure();
  body.name = def.name;
  body.element = def.element;
  body.guard_stiffness = def.guard_stiffness;
  body.guard_threshold = def.guard_threshold;
  body.mesh = def.mesh;
  for (const BoundaryPart& part : report.boundary) {
    if (!part.taken) body.mesh.surfaces.push_back(part.surface);
  }
  if (def.element == Element::tet10) {
    body.mesh = to_tet10(body.mesh);
    body.reference = &tet10_element();
  } else {
    body.reference = def.element == Element::hex8   ? &hex8_element()
                     : def.element == Element::tri3 ? &tri3_element()
                                                    : &tet4_element();
  }
  if (auto r = add_regions(def, body); !r) return r.failure();
  return take_body(std::move(body), doubtful_units);
}

// Where memory runs out all is as it was.
Index Builder::take_body(BodyData body, const std::string& doubtful_units) {
  const std::size_t warnings = warnings_.size(), units = doubtful_units_.size(), nodes = parts_.rest.size();
  try {
    warnings_.insert(warnings_.end(), body.warnings.begin(), body.warnings.end());
    doubtful_units_ += doubtful_units;
    place_nodes(body);
    bodies_.reserve(at(slots_.size()) + 1);
    const Index place = slots_.take();
    bodies_.resize(at(slots_.size()));
    bodies_[at(place)] = std::move(body);
    return place;
  } catch (...) {
    warnings_.resize(warnings);
    doubtful_units_.resize(units);
    parts_.rest.resize(nodes);
    parts_.mass.resize(nodes);
    given_.resize(nodes);
    owners_.point.resize(nodes);
    throw;
  }
}

void Builder::place_nodes(BodyData& body) {
  body.first_node = static_cast<Index>(parts_.rest.size());
  parts_.rest.insert(parts_.rest.end(), body.mesh.nodes.begin(), body.mesh.nodes.end());
  parts_.mass.resize(parts_.rest.size(), 0);
  given_.resize(parts_.rest.size());
  owners_.point.resize(parts_.rest.size(), -1);
  body.global_cells = body.mesh.cells;
  for (Index& n : body.global_cells) n += body.first_node;
}

void Builder::move_nodes(BodyId id, std::span<const Vec3> by) {
  BodyData& body = bodies_[static_cast<std::size_t>(id)];
  for (std::size_t n = 0; n < by.size(); ++n) {
    body.mesh.nodes[n] += by[n];
    parts_.rest[at(body.first_node) + n] = body.mesh.nodes[n];
  }
  for (RegionData& region : body.regions) region.stencils = {};
}

Builder Builder::again() const {
  Builder next;
  next.slots_ = slots_;
  next.world_ = world_;
  next.quasi_static_ = quasi_static_;
  next.doubtful_units_ = doubtful_units_;
  next.bodies_.resize(bodies_.size());
  std::vector<std::size_t> order(bodies_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
    return bodies_[a].first_node < bodies_[b].first_node;
  });
  for (const std::size_t b : order) {
    const BodyData& old = bodies_[b];
    if (!old.present()) continue;
    BodyData& body = next.bodies_[b];
    body.name = old.name;
    body.mesh = old.mesh;
    body.element = old.element;
    body.reference = old.reference;
    body.guard_threshold = old.guard_threshold;
    body.guard_stiffness = old.guard_stiffness;
    body.warnings = old.warnings;
    for (const RegionData& region : old.regions) {
      RegionData& fresh = body.regions.emplace_back();
      fresh.name = region.name;
      fresh.material = region.material;
      fresh.density = region.density;
      fresh.cells = region.cells;
      fresh.stencils = region.stencils;
    }
    next.warnings_.insert(next.warnings_.end(), body.warnings.begin(), body.warnings.end());
    next.place_nodes(body);
  }
  return next;
}

void Builder::remove_body(Index place) {
  Slots slots = slots_;
  BodyData body = std::exchange(bodies_[at(place)], {});
  try {
    slots_.release(place);
    *this = again();
  } catch (...) {
    slots_ = std::move(slots);
    bodies_[at(place)] = std::move(body);
    throw;
  }
}

Result<std::vector<RegionData*>> Builder::regions_for(BodyId id, const std::string& region,
                                                      const std::string& who) {
  std::vector<std::string> names;
  if (!region.empty()) names.push_back(region);
  auto found = regions(id, names, who);
  if (!found) return found.failure();
  std::vector<RegionData*> all;
  for (const std::size_t r : found.value()) all.push_back(&bodies_[static_cast<std::size_t>(id)].regions[r]);
  return all;
}

Result<void> Builder::set_material(BodyId id, const std::string& region, const MaterialPtr& material) {
  if (!material) return Error{"set_material: the material is empty; make one with neo_hookean() or another"};
  auto all = regions_for(id, region, "set_material");
  if (!all) return all.failure();
  for (RegionData* r : all.value()) r->material = material;
  return {};
}

Result<void> Builder::set_density(BodyId id, const std::string& region, double density) {
  if (!std::isfinite(density) || density <= 0)
    return Error{"set_density: density = " + number(density) + " kg/m^3; it must be a positive number"};
  auto all = regions_for(id, region, "set_density");
  if (!all) return all.failure();
  for (RegionData* r : all.value()) r->density = density;
  return {};
}

double Builder::length() const {
  Vec3 lo{}, hi{};
  for (std::size_t i = 0; i < parts_.rest.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = i == 0 ? parts_.rest[i][k] : std::min(lo[k], parts_.rest[i][k]);
      hi[k] = i == 0 ? parts_.rest[i][k] : std::max(hi[k], parts_.rest[i][k]);
    }
  }
  return std::sqrt(dot(hi - lo, hi - lo));
}

bool Builder::grow(BodyId id, std::size_t region, std::shared_ptr<const Growth> growth) {
  auto& own = bodies_[static_cast<std::size_t>(id)].regions[region].growth;
  if (own) return false;
  own = std::move(growth);
  return true;
}

bool Builder::claim_bulk(BodyId id, std::size_t region) {
  bool& claimed = bodies_[static_cast<std::size_t>(id)].regions[region].bulk_claimed;
  const bool fresh = !claimed;
  claimed = true;
  return fresh;
}

Result<std::vector<std::size_t>> Builder::regions(BodyId id, std::span<const std::string> names,
                                                  const std::string& who) const {
  if (!has_body(id)) return Error{who + ": " + no_body(id)};
  const BodyData& b = body(id);
  if (b.thin())
    return Error{who + ": body \"" + b.name +
                 "\" is thin and has no regions with a volume; name a solid body"};
  std::vector<std::size_t> found;
  std::vector<std::string> known;
  for (const auto& r : b.regions) known.push_back(r.name);
  for (std::size_t r = 0; names.empty() && r < b.regions.size(); ++r) found.push_back(r);
  for (const std::string& name : names) {
    const auto it = std::find(known.begin(), known.end(), name);
    if (it == known.end()) return Error{unknown_name(who, "region", name, b.name, known)};
    found.push_back(static_cast<std::size_t>(it - known.begin()));
  }
  return found;
}

// Surfaces may share faces, and merged groups list some twice: nothing acts twice on one. The first of each
// stays where it is.
static void drop_repeated_faces(std::vector<Index>& faces, std::size_t per) {
  std::set<std::array<Index, 4>> seen;
  std::size_t kept = 0;
  for (std::size_t f = 0; f + per <= faces.size(); f += per) {
    std::array<Index, 4> corners{-1, -1, -1, -1};
    std::copy_n(faces.begin() + static_cast<std::ptrdiff_t>(f), per == 4 ? 4 : 3, corners.begin());
    std::sort(corners.begin(), corners.end());
    if (!seen.insert(corners).second) continue;
    for (std::size_t k = 0; k < per; ++k) faces[kept + k] = faces[f + k];
    kept += per;
  }
  faces.resize(kept);
}

Result<std::vector<Index>> Builder::faces(BodyId id, std::span<const std::string> surfaces,
                                          const std::string& who) const {
  if (!has_body(id)) return Error{who + ": " + no_body(id)};
  const BodyData& b = body(id);
  std::vector<std::string> known;
  for (const auto& s : b.mesh.surfaces) known.push_back(s.name);
  const auto per = static_cast<std::size_t>(nodes_per_face(b.mesh.cell_type));
  std::vector<Index> found;
  for (const std::string& name : surfaces) {
    const auto it = std::find(known.begin(), known.end(), name);
    if (it == known.end()) return Error{unknown_name(who, "surface", name, b.name, known)};
    for (const Index n : b.mesh.surfaces[static_cast<std::size_t>(it - known.begin())].faces) {
      found.push_back(n + b.first_node);
    }
  }
  drop_repeated_faces(found, per);
  if (found.empty()) return Error{who + ": no faces selected; name at least one surface that has faces"};
  return found;
}

Result<std::vector<Index>> Builder::select(const Selection& s, const std::string& who) const {
  if (!has_body(s.body)) return Error{who + ": " + no_body(s.body)};
  const BodyData& b = body(s.body);
  std::vector<Index> found;
  if (!s.surfaces.empty()) {
    auto f = faces(s.body, s.surfaces, who);
    if (!f) return f.failure();
    found = f.value();
  }
  if (!s.regions.empty()) {
    auto r = regions(s.body, s.regions, who);
    if (!r) return r.failure();
    for (const std::size_t region : r.value()) {
      const auto per = static_cast<std::size_t>(nodes_per_cell(b.mesh.cell_type));
      for (const Index c : b.regions[region].cells) {
        for (std::size_t k = 0; k < per; ++k) found.push_back(b.global_cells[at(c) * per + k]);
      }
    }
  }
  std::vector<std::string> sets;
  for (const auto& set : b.mesh.node_sets) sets.push_back(set.name);
  for (const std::string& name : s.node_sets) {
    const auto it = std::find(sets.begin(), sets.end(), name);
    if (it == sets.end()) return Error{unknown_name(who, "node set", name, b.name, sets)};
    for (const Index n : b.mesh.node_sets[static_cast<std::size_t>(it - sets.begin())].nodes) {
      found.push_back(n + b.first_node);
    }
  }
  for (const Index n : s.nodes) {
    if (n < 0 || n >= b.mesh.node_count()) {
      return Error{who + ": node " + std::to_string(n) + " is not in body \"" + b.name +
                   "\", which has nodes 0 to " + std::to_string(b.mesh.node_count() - 1)};
    }
    found.push_back(n + b.first_node);
  }
  for (Index n = 0; n < b.mesh.node_count(); ++n) {
    const Vec3& X = b.mesh.nodes[at(n)];
    for (const auto& [lo, hi] : s.boxes) {
      if (X.x >= lo.x && X.y >= lo.y && X.z >= lo.z && X.x <= hi.x && X.y <= hi.y && X.z <= hi.z) {
        found.push_back(n + b.first_node);
      }
    }
    if (s.everything) found.push_back(n + b.first_node);
  }
  for (const Vec3& point : s.nearest) {
    Index best = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (Index n = 0; n < b.mesh.node_count(); ++n) {
      const Vec3 d = b.mesh.nodes[at(n)] - point;
      if (dot(d, d) < distance) {
        distance = dot(d, d);
        best = n;
      }
    }
    found.push_back(best + b.first_node);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  if (found.empty()) {
    return Error{who + ": the selection on body \"" + b.name +
                 "\" holds no nodes; name a surface, region, node set, box, nearest point or nodes"};
  }
  return found;
}

Index Builder::add_stencils(std::shared_ptr<const StencilPool> pool) {
  parts_.stencil_pools.push_back(std::move(pool));
  owners_.stencil_pool.push_back(owner_);
  return static_cast<Index>(parts_.stencil_pools.size()) - 1;
}

Index Builder::add_point(const Vec3& rest, double mass) {
  parts_.rest.push_back(rest);
  parts_.mass.push_back(mass);
  given_.emplace_back();
  owners_.point.push_back(owner_);
  return static_cast<Index>(parts_.rest.size()) - 1;
}

void Builder::add_mass(Index node, double mass) {
  parts_.mass[at(node)] += mass;
  lent_mass_.resize(parts_.mass.size(), 0);
  lent_mass_[at(node)] += mass;
}

Index Builder::add_rows(std::shared_ptr<const RowPool> pool) {
  parts_.row_pools.push_back(std::move(pool));
  owners_.row_pool.push_back(owner_);
  return static_cast<Index>(parts_.row_pools.size()) - 1;
}

int Builder::given_directions(Index node) const {
  return static_cast<int>(given_[at(node)].size());
}

std::vector<Vec3> Builder::directions_given(Index node) const {
  std::vector<Vec3> directions;
  for (const Given& g : given_[at(node)]) directions.push_back(g.direction);
  return directions;
}

std::vector<std::vector<HeldDirection>> Builder::held_directions(std::size_t effects) const {
  std::vector<std::vector<HeldDirection>> held(effects);
  for (Index i = 0; i < static_cast<Index>(given_.size()); ++i) {
    std::vector<Vec3> frame;
    for (const Given& g : given_[at(i)]) {
      Vec3 d = g.direction;
      for (const Vec3& f : frame) d -= dot(d, f) * f;
      frame.push_back((1 / std::sqrt(dot(d, d))) * d);
      held[at(g.owner)].push_back({i, frame.back()});
    }
  }
  return held;
}

Result<void> Builder::prescribe(Index node, const Vec3& direction, std::shared_ptr<const Motion> motion,
                                const std::string& who) {
  auto& list = given_[at(node)];
  // Independent of what is given already?
  Vec3 rest_of = direction;
  std::vector<Vec3> frame;
  for (const Given& g : list) {
    Vec3 d = g.direction;
    for (const Vec3& f : frame) d -= dot(d, f) * f;
    frame.push_back((1 / std::sqrt(dot(d, d))) * d);
  }
  for (const Vec3& f : frame) rest_of -= dot(rest_of, f) * f;
  if (dot(rest_of, rest_of) > 1e-12) {
    list.push_back({direction, std::move(motion), who, owner_});
    return {};
  }
  for (const Given& g : list) {
    const bool same = g.motion == motion || (g.motion->never_moves() && motion->never_moves());
    if (!same) {
      return Error{who + ": node " + std::to_string(node) + " is already given in this direction by \"" +
                   g.who + "\" with another motion; select disjoint nodes or directions"};
    }
  }
  return {};
}

Result<SystemParts> Builder::finish(bool needs_anchors) {
  if (slots_.taken() == 0) return Error{"the scene has no body; add one"};
  auto supports = std::make_shared<SupportPrescriber>();
  for (Index i = 0; i < static_cast<Index>(given_.size()); ++i) {
    std::vector<SupportPrescriber::Term> terms;
    for (const Given& g : given_[at(i)]) terms.push_back({g.direction, g.motion});
    if (!terms.empty()) supports->add(i, parts_.rest[at(i)], std::move(terms));
  }
  SceneFacts facts{bodies_, parts_, *supports, {}};
  for (Index i = 0; i < static_cast<Index>(given_.size()); ++i) {
    for (const Given& g : given_[at(i)]) {
      auto& nodes = facts.held_by[g.who];
      if (nodes.empty() || nodes.back() != i) nodes.push_back(i);
    }
  }
  if (auto r = check_thin_bodies(facts); !r) return r.failure();
  if (needs_anchors) {
    if (auto r = check_anchored(facts); !r) return r.failure();
  }
  if (auto r = check_hard_rows(facts); !r) return r.failure();
  if (!supports->nodes.empty()) parts_.prescribers.push_back(supports);
  return std::move(parts_);
}

}  // namespace isochor
