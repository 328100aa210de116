#include <algorithm>
#include <cmath>
#include <cstdio>

#include "studies/chaos/draft.h"

namespace isochor::studies {

namespace {

BodyId id_of(std::size_t body) {
  return static_cast<BodyId>(body);
}

// A slab of a body at one of its ends: a box around the nodes there.
std::array<Vec3, 2> slab(const DraftBody& body, int axis, bool high, double share) {
  const Vec3 size = body.upper - body.lower, margin = 1e-3 * size;
  std::array<Vec3, 2> box{body.lower - margin, body.upper + margin};
  if (high)
    box[0][axis] = body.upper[axis] - share * size[axis];
  else
    box[1][axis] = body.lower[axis] + share * size[axis];
  return box;
}

// One end of a body, by the name of its side or by place.
Selection end_of(ChaosRandom& random, const ChaosDraft& draft, std::size_t b, int axis, bool high) {
  const DraftBody& body = draft.bodies[b];
  Selection where;
  where.body = id_of(b);
  const std::string side = std::string(1, "xyz"[axis]) + (high ? "1" : "0");
  const bool named = std::find(body.surfaces.begin(), body.surfaces.end(), side) != body.surfaces.end();
  const double share = random.pick({1e-3, 1e-3, 0.1, 0.3});
  if (named && random.chance(0.75)) {
    where.surfaces = {side};
    return where;
  }
  // As thick as it takes to hold three nodes; blocks may lean.
  for (const double thickness : {share, 0.1, 0.3, 0.5}) {
    where.boxes = {slab(body, axis, high, thickness)};
    const auto inside = [&](const Vec3& x) {
      const auto& box = where.boxes[0];
      return x.x >= box[0].x && x.y >= box[0].y && x.z >= box[0].z && x.x <= box[1].x && x.y <= box[1].y &&
             x.z <= box[1].z;
    };
    if (thickness >= share && std::count_if(body.nodes.begin(), body.nodes.end(), inside) >= 3) break;
  }
  return where;
}

void draw_treatment(ChaosRandom& random, const ChaosDraft& draft, DirichletDef& def) {
  if (random.chance(0.75)) return;
  if (random.chance(0.5)) {
    def.treatment = SupportTreatment::multiplier;
    return;
  }
  def.treatment = SupportTreatment::stiffness;
  def.stiffness = draft.young * draft.length * random.decades(-2, 3);
}

// True where another end of the body is free to be moved.
bool hold(ChaosRandom& random, ChaosDraft& draft, std::size_t b, int axis, bool high) {
  DirichletDef def;
  def.name = "hold" + std::to_string(b);
  def.where = end_of(random, draft, b, axis, high);
  const DraftBody& body = draft.bodies[b];
  const int kind = random.whole(0, 11);
  switch (kind) {
    case 0:
      def.where = {};
      def.where.body = id_of(b);
      def.where.nearest = {body.lower, body.upper, {body.upper.x, body.lower.y, body.lower.z}};
      break;
    case 1:
      if (body.regions.size() == 1 && !random.chance(0.1)) break;  // all of the body
      def.where = {};
      def.where.body = id_of(b);
      def.where.regions = {body.regions.back()};
      break;
    case 2:  // along one direction alone, which leaves other motions
      def.directions = {random.chance(0.5) ? random.direction() : Vec3{0, 0, 1}};
      break;
    case 3:  // points inside, as an attachment
      if (!body.tetrahedra) break;
      def.where = {};
      def.where.body = id_of(b);
      def.points = {body.middle(),
                    body.lower + 0.4 * (body.upper - body.lower),
                    {body.middle().x, body.lower.y + 0.3 * (body.upper.y - body.lower.y), body.middle().z}};
      def.treatment = random.chance(0.5) ? SupportTreatment::multiplier : SupportTreatment::stiffness;
      if (def.treatment == SupportTreatment::stiffness) def.stiffness = draft.young * draft.length;
      break;
    default:
      break;
  }
  if (def.points.empty()) draw_treatment(random, draft, def);
  draft.scene().dirichlet.push_back(std::move(def));
  return kind > 1;
}

void move(ChaosRandom& random, ChaosDraft& draft, std::size_t b, int axis, bool high) {
  DirichletDef def;
  def.name = "move" + std::to_string(b);
  def.where = end_of(random, draft, b, axis, high);
  const DraftBody& body = draft.bodies[b];
  const double extent = body.upper[axis] - body.lower[axis];
  const int kind = random.whole(0, 4);
  Vec3 along{};
  along[axis] = high ? 1 : -1;
  // Pressed, pulled or anywhere; by a part of its length or by far more than that.
  const double way = extent * (random.chance(0.75) ? random.decades(-2, 0) : random.decades(0, 2));
  if (kind == 0) {
    def.axis_point = body.middle();
    def.axis = along;
    def.angle = random.chance(0.8) ? random.between(-3, 3) : random.between(-20, 20);
  } else if (kind == 1) {
    def.displacement = way * random.direction();
  } else if (kind == 2 && random.chance(0.5)) {
    def.bone.file = draft.add_motion(random, def.name, way * random.direction());
  } else {
    def.displacement = (kind == 3 ? way : -std::min(way, random.between(0.5, 1.5) * extent)) * along;
  }
  if (def.bone.file.empty()) def.amount = draft.curve(random, 1);
  if (random.chance(0.1)) def.directions = {along};
  draw_treatment(random, draft, def);
  draft.scene().dirichlet.push_back(std::move(def));
}

Vec3 gravity_direction(ChaosRandom& random) {
  return random.chance(0.7) ? Vec3{0, 0, -1} : random.direction();
}

std::string random_surface(ChaosRandom& random, const DraftBody& body) {
  return body.surfaces.empty() ? "" : random.pick(body.surfaces);
}

}  // namespace

std::string ChaosDraft::add_motion(ChaosRandom& random, const std::string& name, const Vec3& way) {
  std::string text = "t,x,y,z,qw,qx,qy,qz\n";
  const int keys = random.whole(2, 3);
  const bool turns = random.chance(0.3);
  for (int k = 0; k < keys; ++k) {
    const double s = static_cast<double>(k) / (keys - 1);
    const double part = keys == 3 && k == 2 && random.chance(0.5) ? 0.2 : s;
    std::array<double, 4> q{1, 0, 0, 0};
    if (turns && k > 0) {
      const Vec3 d = random.between(0, 1) * random.direction();
      const double size_of = std::sqrt(1 + dot(d, d));
      q = {1 / size_of, d.x / size_of, d.y / size_of, d.z / size_of};
    }
    char line[300];
    std::snprintf(line, sizeof line, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", s * duration,
                  part * way.x, part * way.y, part * way.z, q[0], q[1], q[2], q[3]);
    text += line;
  }
  out.files.push_back({name + ".csv", text});
  return name + ".csv";
}

void draft_supports(ChaosDraft& draft) {
  ChaosRandom random = draft.random("supports");
  for (std::size_t b = 0; b < draft.bodies.size(); ++b) {
    const int axis = random.whole(0, 2);
    const bool high = random.chance(0.3);
    const double held = b == 0 ? 0.95 : (draft.dynamic ? 0.3 : 0.8);
    bool free_end = true;
    if (random.chance(held)) free_end = hold(random, draft, b, axis, high);
    if ((free_end || random.chance(0.05)) && random.chance(b == 0 ? 0.45 : 0.15))
      move(random, draft, b, axis, !high);
    const bool can_tie = b > 0 && draft.bodies[b].stands_on_last && draft.bodies[b - 1].tetrahedra;
    if (random.chance(can_tie ? 0.5 : 0.01) && b > 0) {
      TieDef tie;
      tie.name = "tie" + std::to_string(b);
      tie.where = end_of(random, draft, b, 2, false);
      tie.to = id_of(b - 1);
      if (random.chance(0.3)) tie.stiffness = draft.young * draft.length * random.decades(-1, 3);
      draft.scene().ties.push_back(tie);
    }
  }
}

void draft_loads(ChaosDraft& draft) {
  ChaosRandom random = draft.random("loads");
  SceneDef& s = draft.scene();
  if (random.chance(0.4)) {
    // The weight over the size, in units of the stiffness.
    const double g = draft.young / (draft.density * draft.length) * ChaosDraft::load_factor(random);
    s.analysis.options.gravity = g * gravity_direction(random);
    s.analysis.options.gravity_curve =
        draft.dynamic && random.chance(0.7) ? Curve::constant(1) : draft.curve(random, 1);
  }
  for (std::size_t b = 0; b < draft.bodies.size(); ++b) {
    const DraftBody& body = draft.bodies[b];
    if (!body.surfaces.empty() && random.chance(0.3)) {
      TractionDef def;
      def.name = "traction" + std::to_string(b);
      def.body = id_of(b);
      def.surface = random_surface(random, body);
      const Vec3 load = draft.young * ChaosDraft::load_factor(random) * random.direction();
      if (random.chance(0.8))
        def.traction = load;
      else
        def.total_force = draft.length * draft.length * load;
      def.amount = draft.curve(random, 1);
      s.tractions.push_back(def);
    }
    if (random.chance(0.2)) {
      PointForceDef def;
      def.name = "force" + std::to_string(b);
      def.where = end_of(random, draft, b, random.whole(0, 2), random.chance(0.5));
      if (random.chance(0.4)) {
        def.where = {};
        def.where.body = id_of(b);
        def.where.nearest = {body.upper};
      }
      const double load = draft.young * draft.length * draft.length * ChaosDraft::load_factor(random);
      def.force = 0.1 * load * random.direction();
      def.amount = draft.curve(random, 1);
      s.forces.push_back(def);
    }
    if (random.chance(draft.dynamic ? 0.2 : 0.03)) {
      DampingDef def;
      def.name = "damping" + std::to_string(b);
      def.body = id_of(b);
      if (random.chance(0.6)) def.viscosity = draft.young * draft.duration * random.decades(-4, 2);
      if (def.viscosity == 0 || random.chance(0.3)) def.mass_rate = random.decades(-2, 3) / draft.duration;
      s.damping.push_back(def);
    }
  }
}

void draft_cavities(ChaosDraft& draft) {
  ChaosRandom random = draft.random("cavities");
  SceneDef& s = draft.scene();
  for (std::size_t b = 0; b < draft.bodies.size(); ++b) {
    const DraftBody& body = draft.bodies[b];
    if (body.chamber.empty() || !random.chance(0.85)) continue;
    CavityDef def;
    def.name = "chamber" + std::to_string(b);
    def.body = id_of(b);
    def.surfaces = {body.chamber};
    def.control = static_cast<CavityControl>(random.whole(0, 4));
    def.cap_free_openings = random.chance(0.8);
    const double sign = random.chance(0.75) ? 1 : -1;
    const double share = random.chance(0.8) ? random.between(0, 1) : random.decades(0, 3);
    const Vec3 size = body.upper - body.lower;
    switch (def.control) {
      case CavityControl::pressure:
        def.amount = draft.curve(random, sign * draft.young * ChaosDraft::load_factor(random));
        break;
      case CavityControl::volume:
        def.amount =
            draft.curve(random, 0.05 * share * size.x * size.y * size.z, 0.02 * size.x * size.y * size.z);
        break;
      default:
        def.amount = draft.curve(random, sign > 0 ? 1 + share : 1 - 0.9 * std::min(share, 1.0), 1);
        break;
    }
    if (def.control == CavityControl::gas) {
      def.polytropic = random.pick({1.0, 1.0, 1.4});
      if (random.chance(0.4)) def.ambient = draft.young * random.decades(-3, 1);
    }
    if (random.chance(0.15)) def.density = draft.density;
    s.cavities.push_back(def);
  }
  for (std::size_t c = 0; c < s.cavities.size(); ++c) {
    const CavityDef& from = s.cavities[c];
    if (from.control != CavityControl::gas && from.control != CavityControl::liquid) continue;
    if (!random.chance(0.3)) continue;
    ValveDef valve;
    valve.name = "valve" + std::to_string(c);
    valve.from = from.name;
    if (c > 0 && s.cavities[c - 1].control == from.control) valve.to = s.cavities[c - 1].name;
    const double volume = draft.length * draft.length * draft.length;
    valve.conductance = volume / (draft.young * draft.duration) * random.decades(-3, 2);
    valve.amount = draft.curve(random, 1);
    s.valves.push_back(valve);
  }
}

namespace {

void draw_cable(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const DraftBody& body = draft.bodies[b];
  CableDef def;
  def.name = "cable" + std::to_string(b);
  def.body = id_of(b);
  const Vec3 size = body.upper - body.lower;
  const int points = random.whole(2, 4);
  const double y = random.between(0.1, 0.9), z = random.between(0.1, 0.9);
  for (int p = 0; p < points; ++p) {
    const double s = 0.05 + 0.9 * p / (points - 1);
    def.points.push_back(body.lower + Vec3{s * size.x, y * size.y, z * size.z});
  }
  if (random.chance(0.3)) def.from = body.lower - Vec3{size.x, 0, 0};
  def.control = static_cast<CableControl>(random.whole(0, 2));
  const double short_by = random.chance(0.8) ? random.between(0.3, 1.1) : random.between(0, 3);
  switch (def.control) {
    case CableControl::tension:
      def.amount = draft.curve(random, draft.young * size.y * size.z * ChaosDraft::load_factor(random));
      break;
    case CableControl::length:
      def.amount = draft.curve(random, 0.9 * size.x * short_by, 0.9 * size.x);
      break;
    case CableControl::length_ratio:
      def.amount = draft.curve(random, short_by, 1);
      break;
  }
  if (def.control != CableControl::tension && random.chance(0.5))
    def.stiffness = draft.young * draft.length * random.decades(-2, 3);
  draft.scene().cables.push_back(def);
}

void draw_winding(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const DraftBody& body = draft.bodies[b];
  const Vec3 size = body.upper - body.lower;
  WindingDef def;
  def.name = "winding" + std::to_string(b);
  def.body = id_of(b);
  constexpr double kRound[4][2] = {{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}, {0.2, 0.8}};
  std::vector<Vec3> path;
  for (int p = 0; p < random.whole(4, 9); ++p) {
    const auto& r = kRound[p % 4];
    path.push_back(body.lower + Vec3{(0.1 + 0.08 * p) * size.x, r[0] * size.y, r[1] * size.z});
  }
  def.paths = {path};
  if (random.chance(0.6)) def.stiffness = draft.young * draft.length * draft.length * random.decades(-2, 3);
  if (random.chance(0.3)) def.slack = random.between(0, 0.2);
  def.pulls_only = random.chance(0.8);
  draft.scene().windings.push_back(def);
}

void draw_skins(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const DraftBody& body = draft.bodies[b];
  const double line = draft.young * draft.length;
  if (random.chance(0.12)) {
    EpidermisDef def;
    def.name = "epidermis" + std::to_string(b);
    def.body = id_of(b);
    def.surfaces = {random_surface(random, body)};
    def.stiffness = random.chance(0.2) ? HUGE_VAL : line * random.decades(-3, 2);
    def.gamma = random.pick({0.0, 1.0, 100.0});
    draft.scene().epidermis.push_back(def);
  }
  if (random.chance(0.12)) {
    MembraneDef def;
    def.name = "membrane" + std::to_string(b);
    def.body = id_of(b);
    def.surfaces = {random_surface(random, body)};
    def.young = draft.young * random.decades(-1, 4);
    def.poisson = random.pick({0.0, 0.3, 0.5});
    def.thickness = draft.length * random.decades(-4, -1);
    draft.scene().membranes.push_back(def);
  }
  if (body.tetrahedra && random.chance(0.1)) {
    StrainLimitDef def;
    def.name = "layer" + std::to_string(b);
    def.body = id_of(b);
    def.surfaces = {random_surface(random, body)};
    def.stiffness = line * random.decades(-2, 3);
    if (random.chance(0.4)) def.slack = random.between(0, 0.3);
    def.pulls_only = random.chance(0.8);
    draft.scene().layers.push_back(def);
  }
}

// A sheet of paper or of rubber that bends on the surface of a body.
void draw_shell(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  ShellDef def;
  def.name = "shell" + std::to_string(b);
  def.body = id_of(b);
  def.surfaces = {random_surface(random, draft.bodies[b])};
  def.young = draft.young * random.decades(-1, 4);
  def.poisson = random.pick({0.0, 0.3, 0.5});
  def.thickness = draft.length * random.decades(-3, -1);
  if (random.chance(0.5)) def.density = 1000;
  draft.scene().shells.push_back(def);
}

}  // namespace

void draft_attachments(ChaosDraft& draft) {
  ChaosRandom random = draft.random("attachments"), shells = draft.random("shells");
  for (std::size_t b = 0; b < draft.bodies.size(); ++b) {
    const bool tetrahedra = draft.bodies[b].tetrahedra || random.chance(0.03);
    if (tetrahedra && random.chance(0.18)) draw_cable(random, draft, b);
    if (tetrahedra && random.chance(0.12)) draw_winding(random, draft, b);
    if (!draft.bodies[b].surfaces.empty()) draw_skins(random, draft, b);
    if (!draft.bodies[b].surfaces.empty() && shells.chance(0.08)) draw_shell(shells, draft, b);
  }
}

}  // namespace isochor::studies
