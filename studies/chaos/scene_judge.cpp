#include "studies/chaos/scene_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "engine/base/text.h"
#include "engine/elements/material_model.h"
#include "scenes/body_parts.h"
#include "studies/chaos/distances.h"

namespace isochor::studies {

namespace {

double length(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

bool law_needs_J(MaterialLaw law) {
  return law == MaterialLaw::neo_hookean || law == MaterialLaw::neo_hookean_ogden ||
         law == MaterialLaw::isochoric_neo_hookean || law == MaterialLaw::ogden;
}

const MaterialDef& material_of(const SceneBody& body, const std::string& region) {
  for (const MaterialDef& m : body.materials) {
    if (m.region == region) return m;
  }
  for (const MaterialDef& m : body.materials) {
    if (m.region.empty()) return m;
  }
  return body.materials.front();
}

const VolumeRows* rows_of(const SceneDef& scene, std::size_t body) {
  static const VolumeRows nodal;
  if (!scene.volumes) return &nodal;
  for (const VolumeRows& rows : *scene.volumes) {
    if (static_cast<std::size_t>(rows.def.body) == body && !rows.none) return &rows;
  }
  return nullptr;
}

bool is_guarded(const SceneBody& body) {
  if (body.element != Element::tet4_edge_smoothed) return false;
  return body.guard_stiffness.value_or(1) > 0;
}

// Where kappa = 0, as in many laws at nu = 0, rows would carry no pressure and are none.
bool carries_rows(const VolumeRows& rows, const MaterialDef& material, const std::string& folder) {
  if (rows.def.hard) return true;
  const auto made = make_material(material, folder);
  return made && std::isfinite(made.value()->inverse_bulk());
}

// The largest modulus that energies of a material come from [Pa].
double stiffness_of(const MaterialDef& m, const std::string& folder) {
  const auto made = make_material(m, folder);
  double stiff = m.compression_penalty.modulus + (made ? std::abs(made.value()->shear_modulus()) : 0);
  for (const FiberFamily& f : m.fibers) stiff += f.k1;
  return stiff;
}

std::vector<BodyPromise> promises(const SceneDef& scene, const BuiltScene& built) {
  std::vector<BodyPromise> all;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const VolumeRows* rows = rows_of(scene, b);
    const bool log_rows = rows != nullptr && rows->def.strain == VolumeStrain::logarithmic &&
                          rows->def.space != VolumeSpace::zone;
    BodyPromise promise;
    promise.body = built.bodies[b];
    promise.element = body.element;
    auto regions = built.world.mesh(built.bodies[b]).regions;
    if (regions.empty()) regions = {""};
    for (const std::string& region : regions) {
      const MaterialDef& m = material_of(body, region);
      promise.law_needs_J.push_back(law_needs_J(m.law));
      promise.cell_needs_J.push_back(is_guarded(body) || (log_rows && carries_rows(*rows, m, scene.folder)));
    }
    all.push_back(std::move(promise));
  }
  return all;
}

// Nodes that a selection means, found in the mesh.
std::set<Index> selected(const Mesh& mesh, const Selection& where) {
  std::set<Index> nodes(where.nodes.begin(), where.nodes.end());
  for (const MeshSurface& s : mesh.surfaces) {
    if (std::find(where.surfaces.begin(), where.surfaces.end(), s.name) != where.surfaces.end())
      nodes.insert(s.faces.begin(), s.faces.end());
  }
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  for (std::size_t a = 0; a < mesh.cells.size(); ++a) {
    const std::size_t region =
        mesh.cell_region.empty() ? 0 : static_cast<std::size_t>(mesh.cell_region[a / per]);
    if (std::find(where.regions.begin(), where.regions.end(), mesh.regions[region]) != where.regions.end())
      nodes.insert(mesh.cells[a]);
  }
  for (Index i = 0; i < mesh.node_count(); ++i) {
    const Vec3& X = mesh.nodes[static_cast<std::size_t>(i)];
    const bool inside = std::any_of(where.boxes.begin(), where.boxes.end(), [&](const auto& box) {
      return X.x >= box[0].x && X.y >= box[0].y && X.z >= box[0].z && X.x <= box[1].x && X.y <= box[1].y &&
             X.z <= box[1].z;
    });
    if (inside || where.everything) nodes.insert(i);
  }
  for (const Vec3& p : where.nearest) {
    Index best = 0;
    for (Index i = 0; i < mesh.node_count(); ++i) {
      if (length(mesh.nodes[static_cast<std::size_t>(i)] - p) <
          length(mesh.nodes[static_cast<std::size_t>(best)] - p))
        best = i;
    }
    nodes.insert(best);
  }
  return nodes;
}

// Corner nodes of faces that one cell alone has.
std::set<Index> boundary_corners(const Mesh& mesh) {
  constexpr int kTet[4][4] = {{0, 1, 2, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 2, 3, -1}};
  constexpr int kHex[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                              {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  const bool hexahedra = mesh.cell_type == CellType::hex8;
  const auto per = static_cast<std::size_t>(nodes_per_cell(mesh.cell_type));
  std::map<std::vector<Index>, int> count;
  for (std::size_t c = 0; c + per <= mesh.cells.size(); c += per) {
    for (int f = 0; f < (hexahedra ? 6 : 4); ++f) {
      std::vector<Index> face;
      for (const int k : hexahedra ? kHex[f] : kTet[f]) {
        if (k >= 0) face.push_back(mesh.cells[c + static_cast<std::size_t>(k)]);
      }
      std::sort(face.begin(), face.end());
      ++count[face];
    }
  }
  std::set<Index> nodes;
  for (const auto& [face, times] : count) {
    if (times == 1) nodes.insert(face.begin(), face.end());
  }
  return nodes;
}

bool moves(const DirichletDef& d) {
  return !(d.displacement == Vec3{}) || d.angle != 0 || !d.bone.keys.empty();
}

Vec3 target_of(const DirichletDef& d, double t, const Vec3& X) {
  if (!d.bone.keys.empty()) return carried(d.bone, t, X);
  const double amount = evaluate(d.amount, t);
  Vec3 at = X + amount * d.displacement;
  if (d.angle != 0) {
    const Vec3 n = (1 / length(d.axis)) * d.axis, arm = X - d.axis_point;
    const double c = std::cos(amount * d.angle), s = std::sin(amount * d.angle);
    at += c * arm + s * cross(n, arm) + ((1 - c) * dot(n, arm)) * n - arm;
  }
  return at;
}

// Nothing but gravity works on the bodies, and they begin undeformed.
bool is_isolated(const SceneDef& s) {
  if (s.analysis.type != AnalysisType::dynamics) return false;
  if (!s.tractions.empty() || !s.forces.empty() || !s.cavities.empty() || !s.cables.empty()) return false;
  if (!s.pressures.empty() || !s.muscles.empty() || !s.growth.empty() || !s.springs.empty() ||
      !s.linear_constraints.empty() || !s.driven.empty() || !s.skins.empty() || s.analysis.static_until)
    return false;
  if (!(s.analysis.options.gravity == Vec3{}) &&
      (s.analysis.options.gravity_curve.points.size() != 1 || !s.rigid_bodies.empty()))
    return false;
  const bool driven = std::any_of(s.contacts.begin(), s.contacts.end(), [](const ContactDef& c) {
    return !c.obstacle.motion.keys.empty() || c.initial_overlap == InitialOverlap::resolve;
  });
  const bool squeezed =
      std::any_of(s.surface_contacts.begin(), s.surface_contacts.end(), [](const SurfaceContactDef& c) {
        return c.initial_overlap == InitialOverlap::resolve || c.thickness > 0;
      });
  // A winding that is longer than its way and may push does so from the start.
  const bool wound = std::any_of(s.windings.begin(), s.windings.end(),
                                 [](const WindingDef& w) { return w.slack != 0 && !w.pulls_only; });
  return !driven && !squeezed && !wound && std::none_of(s.dirichlet.begin(), s.dirichlet.end(), moves);
}

// Rest area of a surface of flat triangles; nothing for other faces.
std::optional<double> area_of(const Mesh& mesh, const std::string& surface) {
  if (mesh.cell_type != CellType::tet4) return {};
  double area = 0;
  for (const MeshSurface& s : mesh.surfaces) {
    if (s.name != surface) continue;
    for (std::size_t f = 0; f + 3 <= s.faces.size(); f += 3) {
      const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(s.faces[f + k])]; };
      area += 0.5 * length(cross(x(1) - x(0), x(2) - x(0)));
    }
  }
  return area;
}

bool is_carried_by_supports(const SceneDef& s, const BuiltScene& built) {
  if (s.analysis.type != AnalysisType::statics || !s.contacts.empty()) return false;
  const bool from_outside =
      std::any_of(s.cables.begin(), s.cables.end(), [](const CableDef& c) { return c.from || c.to; });
  // Chambers that are open push on one side more than on the other, and so does the weight of a liquid.
  if (from_outside || !s.cavities.empty() || !s.pressures.empty()) return false;
  // Muscles, growth and springs between points of bodies are forces inside.
  const bool outside = std::any_of(s.springs.begin(), s.springs.end(),
                                   [](const SpringDef& spring) { return !spring.to_body; });
  if (outside || !s.linear_constraints.empty() || !s.driven.empty() || !s.skins.empty()) return false;
  return std::all_of(s.tractions.begin(), s.tractions.end(), [&](const TractionDef& t) {
    const bool total = !(t.total_force == Vec3{});
    if (t.current_area) return false;
    return total ||
           area_of(built.world.mesh(built.bodies[static_cast<std::size_t>(t.body)]), t.surface).has_value();
  });
}

SceneDef with_poses(SceneDef scene, const BuiltScene& built) {
  for (DirichletDef& d : scene.dirichlet) {
    if (d.bone.file.empty()) continue;
    if (auto track = read_poses(path_in(scene.folder, d.bone.file))) d.bone = std::move(track).value();
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) scene.contacts[c].obstacle = built.obstacles[c];
  return scene;
}

}  // namespace

SceneJudge::SceneJudge(const SceneDef& scene, const BuiltScene& built)
    : scene_(with_poses(scene, built)), state_(built.world, promises(scene, built)) {
  const AnalysisDef& a = scene_.analysis;
  limits_.rows = std::max(1e-8, 10 * a.options.row_tolerance);
  if (a.options.method == Method::position_based) limits_.rows = HUGE_VAL;
  // Its rows are met in the middle of a step; what the end misses is of second order, and this is no more.
  if (a.type == AnalysisType::dynamics && a.scheme == SchemeWord::implicit_midpoint) limits_.rows = 0.1;
  isolated_ = is_isolated(scene_);
  carried_by_supports_ = is_carried_by_supports(scene_, built);
  Vec3 lower{HUGE_VAL, HUGE_VAL, HUGE_VAL}, upper = -lower;
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    watch_volume(b);
    watch_energy(built, b);
    const Mesh& mesh = built.world.mesh(built.bodies[b]);
    held_.emplace_back(mesh.nodes.size(), false);
    for (const Vec3& X : mesh.nodes) {
      for (int k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], X[k]);
        upper[k] = std::max(upper[k], X[k]);
      }
    }
  }
  length_ = length(upper - lower);
  start_energy_ = built.world.kinetic_energy() + built.world.elastic_energy();
  watch_supports(built);
  watch_contacts(built);
}

void SceneJudge::watch_volume(std::size_t b) {
  const VolumeRows* rows = rows_of(scene_, b);
  bool exact = false;
  if (rows != nullptr) {
    const auto& materials = scene_.bodies[b].materials;
    const bool incompressible = std::all_of(materials.begin(), materials.end(), [](const MaterialDef& m) {
      return m.constants.poisson == 0.5 && !m.poisson_field.given();
    });
    const bool whole = rows->def.regions.empty() && rows->def.space != VolumeSpace::zone &&
                       rows->def.space != VolumeSpace::ring;
    const bool grows = std::any_of(scene_.growth.begin(), scene_.growth.end(),
                                   [&](const GrowthDef& g) { return static_cast<std::size_t>(g.body) == b; });
    exact = whole && !grows && (rows->def.hard || (rows->def.carries_bulk && incompressible));
  }
  exact_volume_.push_back(exact);
  log_volume_.push_back(rows != nullptr && rows->def.strain == VolumeStrain::logarithmic);
}

void SceneJudge::watch_energy(const BuiltScene& built, std::size_t b) {
  const auto& materials = scene_.bodies[b].materials;
  const double volume = state_.shape(built.world, b).rest_volume, density = materials.front().density;
  const bool one_density = std::all_of(materials.begin(), materials.end(),
                                       [&](const MaterialDef& m) { return m.density == density; });
  if (!one_density && !(scene_.analysis.options.gravity == Vec3{})) isolated_ = carried_by_supports_ = false;
  mass_.push_back(density * volume);
  center_.push_back(built.world.measures(built.bodies[b]).center_of_mass);
  const bool grows = std::any_of(scene_.growth.begin(), scene_.growth.end(),
                                 [&](const GrowthDef& g) { return static_cast<std::size_t>(g.body) == b; });
  for (const MaterialDef& m : materials) {
    const double stored = stiffness_of(m, scene_.folder) * volume;
    energy_noise_ += 1e-9 * stored;
    if (grows) grown_energy_ += stored;
  }
  if (scene_.analysis.type != AnalysisType::dynamics) return;
  // Positions are rounded where they are, and velocities are differences of positions.
  double far = 0;
  for (const Vec3& X : built.world.rest_positions(built.bodies[b])) far = std::max(far, length(X));
  const double h = plan_steps(scene_.analysis).h * scene_.analysis.options.smallest_fraction;
  const double v = 8 * std::numeric_limits<double>::epsilon() * far / h;
  energy_noise_ += mass_.back() * v * v;
}

void SceneJudge::watch_supports(const BuiltScene& built) {
  std::map<std::pair<BodyId, Index>, int> times;
  for (const DirichletDef& d : scene_.dirichlet) {
    const auto b = static_cast<std::size_t>(d.where.body);
    const std::set<Index> nodes = selected(built.world.mesh(built.bodies[b]), d.where);
    supported_.emplace_back(nodes.begin(), nodes.end());
    for (const Index i : nodes) {
      held_[b][static_cast<std::size_t>(i)] = true;
      ++times[{d.where.body, i}];
    }
  }
  const auto also = [&](BodyId body, Index node) {
    held_[static_cast<std::size_t>(body)][static_cast<std::size_t>(node)] = true;
    ++times[{body, node}];
  };
  for (const SkinDef& skin : scene_.skins) {
    for (const Index i :
         selected(built.world.mesh(built.bodies[static_cast<std::size_t>(skin.where.body)]), skin.where))
      also(skin.where.body, i);
  }
  for (const DrivenDef& d : scene_.driven) {
    for (const Index i : d.nodes) also(d.body, i);
  }
  // Nodes that nothing else moves, by their place in the list.
  for (const DrivenDef& d : scene_.driven) {
    followed_.emplace_back();
    for (std::size_t k = 0; k < d.nodes.size(); ++k) {
      if (times[{d.body, d.nodes[k]}] == 1) followed_.back().push_back(k);
    }
  }
  // Where supports share a node, the first one has it or both agree; neither is asked about here.
  for (std::size_t d = 0; d < supported_.size(); ++d) {
    const BodyId body = scene_.dirichlet[d].where.body;
    std::erase_if(supported_[d], [&](Index i) { return times[{body, i}] > 1; });
  }
}

void SceneJudge::watch_contacts(const BuiltScene& built) {
  for (const ContactDef& c : scene_.contacts) {
    touching_.emplace_back();
    planes_.emplace_back();
    if (!c.obstacle.file.empty()) {
      if (const auto read = read_surface(path_in(scene_.folder, c.obstacle.file), c.obstacle.scale))
        planes_.back() = planes_of(read.value());
    }
    if (!c.against.empty() || !c.rigid.empty() || c.compliance > 0 || !c.surfaces.empty()) continue;
    const auto b = static_cast<std::size_t>(c.body);
    for (const Index i : boundary_corners(built.world.mesh(built.bodies[b]))) {
      if (!held_[b][static_cast<std::size_t>(i)]) touching_.back().push_back(i);
    }
  }
}

SceneJudge::Inversion SceneJudge::inversion(const World& world) const {
  Inversion out{HUGE_VAL, 0, 0};
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    const JudgedShape s = state_.shape(world, b);
    out.min_J = std::min(out.min_J, s.min_J);
    out.inverted += s.inverted;
    out.flat += s.flat;
  }
  return out;
}

bool SceneJudge::Inversion::agrees(const StepReport& report) const {
  return report.inverted_cells >= inverted && report.inverted_cells <= inverted + flat &&
         std::abs(report.min_J - min_J) <= 1e-6 * (1 + std::abs(min_J));
}

std::optional<Finding> SceneJudge::volume(const World& world, std::size_t b) const {
  if (!exact_volume_[b] || std::isinf(limits_.rows)) return {};
  const JudgedShape s = state_.shape(world, b);
  const double change = log_volume_[b] ? s.log_volume / s.rest_volume : s.volume / s.rest_volume - 1;
  if (std::abs(change) <= limits_.rows) return {};
  return Finding{"volume", "body \"" + scene_.bodies[b].name + "\" is incompressible and its " +
                               (log_volume_[b] ? "mean log J" : "volume") + " changed by " + number(change)};
}

std::optional<Finding> SceneJudge::support(const World& world, std::size_t def) const {
  const DirichletDef& d = scene_.dirichlet[def];
  const AnalysisDef& a = scene_.analysis;
  const bool in_the_middle = a.type == AnalysisType::dynamics && a.scheme == SchemeWord::implicit_midpoint;
  if (d.treatment == SupportTreatment::stiffness || in_the_middle) return {};
  if (d.treatment == SupportTreatment::multiplier && a.options.method == Method::position_based) return {};
  const auto x = world.positions(BodyId{d.where.body.number()});
  const auto X = world.rest_positions(BodyId{d.where.body.number()});
  for (const Index i : supported_[def]) {
    const Vec3 target = target_of(d, world.time(), X[static_cast<std::size_t>(i)]);
    const Vec3 off = x[static_cast<std::size_t>(i)] - target;
    double away = d.directions.empty() ? length(off) : 0;
    for (const Vec3& n : d.directions) away = std::max(away, std::abs(dot(n, off)) / length(n));
    const double allowed = 1e-12 * length(target) +
                           length_ * (d.treatment == SupportTreatment::multiplier ? 10 * limits_.rows : 1e-9);
    if (away <= allowed) continue;
    return Finding{"support", "node " + std::to_string(i + 1) + " of support \"" + d.name + "\" is " +
                                  number(away) + " m from where it is put"};
  }
  return {};
}

// Linear between frames, written down again.
std::optional<Finding> SceneJudge::driven(const World& world, std::size_t def) const {
  const DrivenDef& d = scene_.driven[def];
  const auto x = world.positions(d.body);
  const double t = world.time();
  std::size_t next = 0;
  while (next + 1 < d.times.size() && d.times[next] < t) ++next;
  const std::size_t last = next > 0 ? next - 1 : 0;
  const double span = d.times[next] - d.times[last];
  const double s = span > 0 ? std::clamp((t - d.times[last]) / span, 0.0, 1.0) : 1;
  for (const std::size_t k : followed_[def]) {
    const Vec3 target = (1 - s) * d.positions[last][k] + s * d.positions[next][k];
    const double away = length(x[static_cast<std::size_t>(d.nodes[k])] - target);
    if (away <= 1e-9 * (length_ + length(target))) continue;
    return Finding{"driven", "node " + std::to_string(d.nodes[k] + 1) + " of \"" + d.name + "\" is " +
                                 number(away) + " m from where its data put it"};
  }
  return {};
}

std::optional<Finding> SceneJudge::obstacle(const BuiltScene& built, std::size_t contact) const {
  const ContactDef& c = scene_.contacts[contact];
  const World& world = built.world;
  if (c.initial_overlap == InitialOverlap::resolve && world.time() < c.resolve_time * (1 + 1e-9)) return {};
  if (std::isinf(limits_.rows)) return {};
  const auto x = world.positions(BodyId{c.body.number()});
  double deepest = 0;
  Index node = 0;
  for (const Index i : touching_[contact]) {
    const auto d = distance_to(c.obstacle, world.time(), x[static_cast<std::size_t>(i)], planes_[contact]);
    if (d && -*d > deepest) {
      deepest = -*d;
      node = i;
    }
  }
  // A field is as sharp as its spacing.
  if (deepest <= length_ * std::max(1e-7, 10 * limits_.rows) + c.obstacle.spacing) return {};
  return Finding{"penetration", "node " + std::to_string(node + 1) + " is " + number(deepest) +
                                    " m inside the obstacle of \"" + c.name + "\", which is hard"};
}

double SceneJudge::weight_gone_down(const World& world) const {
  double work = 0;
  if (scene_.analysis.options.gravity == Vec3{}) return 0;
  const double amount = evaluate(scene_.analysis.options.gravity_curve, world.time());
  for (std::size_t b = 0; b < mass_.size(); ++b) {
    const Vec3 way = world.measures(static_cast<BodyId>(b)).center_of_mass - center_[b];
    work += amount * mass_[b] * dot(scene_.analysis.options.gravity, way);
  }
  return work;
}

std::optional<Finding> SceneJudge::energy(const World& world) {
  if (!isolated_) return {};
  const double fallen = weight_gone_down(world);
  most_gone_down_ = std::max(most_gone_down_, fallen);
  const double now = world.kinetic_energy() + world.elastic_energy() - fallen;
  const double scale = start_energy_ + most_gone_down_;
  const bool promised = scene_.analysis.scheme == SchemeWord::implicit_euler &&
                        scene_.analysis.options.method != Method::position_based;
  if (now - start_energy_ <= (promised ? 0.05 : 0.5) * scale + energy_noise_) return {};
  return Finding{"energy", "nothing but gravity works, and the energy grew from " + number(start_energy_) +
                               " J to " + number(now) + " J (weights went down by " + number(fallen) + " J)"};
}

// The forces of all supports add up to those of all loads.
std::optional<Finding> SceneJudge::balance(const BuiltScene& built) const {
  if (!carried_by_supports_ || std::isinf(limits_.rows)) return {};
  const World& world = built.world;
  const double t = world.time();
  Vec3 sum{};
  double scale = 0;
  const auto add = [&](const Vec3& force) {
    sum += force;
    scale += length(force);
  };
  for (const EffectId id : built.ids(dirichlet_kind)) add(world.reaction(id)[0]);
  for (std::size_t b = 0; b < mass_.size(); ++b)
    add(evaluate(scene_.analysis.options.gravity_curve, t) * mass_[b] * scene_.analysis.options.gravity);
  for (const ShellDef& s : scene_.shells) {
    const Mesh& mesh = world.mesh(built.bodies[static_cast<std::size_t>(s.body)]);
    double area = 0;
    for (const std::string& surface : s.surfaces) {
      const auto one = area_of(mesh, surface);
      if (!one && s.density > 0) return {};
      area += one.value_or(0);
    }
    add(evaluate(scene_.analysis.options.gravity_curve, t) * s.density * s.thickness * area *
        scene_.analysis.options.gravity);
  }
  for (const PointForceDef& f : scene_.forces) add(evaluate(f.amount, t) * f.force);
  for (const TractionDef& d : scene_.tractions) {
    const Mesh& mesh = world.mesh(built.bodies[static_cast<std::size_t>(d.body)]);
    const bool total = !(d.total_force == Vec3{});
    add(evaluate(d.amount, t) * (total ? d.total_force : area_of(mesh, d.surface).value_or(0) * d.traction));
  }
  // Forces inside may be far larger than what goes in and out; their rounding is left over.
  const double inside = energy_noise_ / length_;
  // Growth makes such forces without any load, and a tolerance is relative to all of them.
  const double tolerance = std::max(1e-6, 100 * scene_.analysis.options.force_tolerance);
  if (length(sum) <= tolerance * (scale + grown_energy_ / length_) + inside) return {};
  return Finding{"balance", "supports and loads add up to " + number(length(sum)) + " N, of forces of " +
                                number(scale) + " N in all"};
}

std::optional<Finding> SceneJudge::numbers(const BuiltScene& built) const {
  if (auto wrong = state_.numbers(built.world)) return wrong;
  for (std::size_t d = 0; d < scene_.dirichlet.size(); ++d) {
    for (const Vec3& v : built.world.reaction(built.ids(dirichlet_kind)[d])) {
      if (!std::isfinite(length(v)))
        return Finding{"not finite", "the reaction of \"" + scene_.dirichlet[d].name + "\""};
    }
  }
  return {};
}

std::optional<Finding> SceneJudge::accepted(const BuiltScene& built, std::span<const std::string> said) {
  if (auto wrong = state_.accepted(built.world, said, limits_)) return wrong;
  if (auto wrong = numbers(built)) return wrong;
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (auto wrong = volume(built.world, b)) return wrong;
  }
  for (std::size_t d = 0; d < scene_.dirichlet.size(); ++d) {
    if (auto wrong = support(built.world, d)) return wrong;
  }
  for (std::size_t d = 0; d < scene_.driven.size(); ++d) {
    if (auto wrong = driven(built.world, d)) return wrong;
  }
  for (std::size_t c = 0; c < scene_.contacts.size(); ++c) {
    if (auto wrong = obstacle(built, c)) return wrong;
  }
  if (auto wrong = balance(built)) return wrong;
  return energy(built.world);
}

}  // namespace isochor::studies
