// The keys of a scene file, said once: the same descriptions read a file, write one and list what the schema
// must hold. `Io` is Reader, Writer or KeyList; its functions take a key, the value and the default that a
// writer leaves out.
#pragma once

#include <cmath>

#include "scenes/json/names.h"

namespace isochor::scene_json {

// How a number given for a curve is meant: statics ramps to it, dynamics has it from the start.
enum class CurveStart : std::uint8_t { zero, one, constant };

inline Vec3 rotation_vector(const std::array<double, 4>& q) {
  const Vec3 axis{q[1], q[2], q[3]};
  const double sine = std::sqrt(dot(axis, axis));
  return sine > 0 ? (2 * std::atan2(sine, q[0]) / sine) * axis : Vec3{};
}
inline std::array<double, 4> quaternion(const Vec3& turn) {
  const double angle = std::sqrt(dot(turn, turn));
  const double s = angle > 0 ? std::sin(0.5 * angle) / angle : 0.5;
  return {std::cos(0.5 * angle), s * turn.x, s * turn.y, s * turn.z};
}

template <class Io>
void describe(Io& io, OgdenTerm& t) {
  io.number("mu", t.mu, 0.0);
  io.number("alpha", t.alpha, 0.0);
}

template <class Io>
void describe(Io& io, FiberFamily& f) {
  io.vector("direction", f.direction, Vec3{1, 0, 0});
  io.points("directions", f.directions);
  io.number("k1", f.k1, 0.0);
  io.number("k2", f.k2, 0.0);
  io.number("dispersion", f.dispersion, 0.0);
}

template <class Io>
void describe(Io& io, CompressionPenalty& p) {
  io.number("modulus", p.modulus, 0.0);
  io.number("beta", p.beta, CompressionPenalty{}.beta);
}

template <class Io>
void describe(Io& io, CellField& f) {
  io.numbers("values", f.values);
  io.text("file", f.file);
}

template <class Io>
void describe(Io& io, MaterialDef& m) {
  io.text("region", m.region);
  io.word("law", m.law, MaterialLaw::neo_hookean);
  io.number("young", m.constants.young, 0.0);
  io.number("poisson", m.constants.poisson, 0.0);
  io.number("mu", m.constants.mu, 0.0);
  io.number_or_inf("lambda", m.constants.lambda, -1.0);
  io.number_or_inf("bulk", m.constants.bulk, -1.0);
  io.word("bulk_choice", m.constants.bulk_choice, BulkChoice::consistent);
  io.number("c1", m.own.c1, 0.0);
  io.number("c2", m.own.c2, 0.0);
  io.number("mu0", m.own.mu0, 0.0);
  io.number("mu1", m.own.mu1, 0.0);
  io.number("gamma", m.own.gamma, 0.0);
  io.number("beta1", m.own.beta1, 0.0);
  io.number("beta2", m.own.beta2, 0.0);
  io.list("terms", m.own.terms);
  io.number("resistance", m.own.resistance, 0.0);
  io.number("threshold", m.own.threshold, 0.1);
  io.list("fibers", m.fibers);
  io.optional_object("compression_penalty", m.compression_penalty, m.compression_penalty.modulus != 0);
  io.optional_object("stiffness_field", m.stiffness_field, m.stiffness_field.given());
  io.optional_object("poisson_field", m.poisson_field, m.poisson_field.given());
  io.number("density", m.density, 1000.0);
}

template <class Io>
void describe(Io& io, BoxMeshDef& b) {
  io.vector("lower", b.lower, Vec3{});
  io.vector("upper", b.upper, Vec3{1, 1, 1});
  io.integers("divisions", b.divisions);
  io.word("cell_type", b.cell_type, CellType::tet4);
}

template <class Io>
void describe(Io& io, LatticeMesh& l) {
  io.required_text("surface", l.surface);
  io.number("scale", l.scale, 1.0);
  io.vector("offset", l.offset, Vec3{});
  io.number("spacing", l.spacing, 0.0);
  io.integer("samples", l.samples, 4);
  io.flag("keep_apart", l.keep_apart, true);
}

// A file with its scale, a generated box, or a lattice.
struct MeshSource {
  std::variant<MeshFile, BoxMeshDef, LatticeMesh>& mesh;
};
template <class Io>
void describe(Io& io, MeshSource& m) {
  io.either("file", "box", "lattice", m.mesh);
  if (auto* file = std::get_if<MeshFile>(&m.mesh)) {
    io.required_text("file", file->path);
    io.number("scale", file->scale, 1.0);
    io.vector("turn", file->turn, Vec3{});
    io.vector("offset", file->offset, Vec3{});
  }
  if (auto* box = std::get_if<BoxMeshDef>(&m.mesh)) io.object("box", *box);
  if (auto* lattice = std::get_if<LatticeMesh>(&m.mesh)) io.object("lattice", *lattice);
}

template <class Io>
void describe(Io& io, PlanePlace& p) {
  io.vector("point", p.point, Vec3{});
  io.required_vector("normal", p.normal);
}

template <class Io>
void describe(Io& io, SpherePlace& s) {
  io.required_vector("center", s.center);
  io.number("radius", s.radius, 0.0);
}

template <class Io>
void describe(Io& io, SeedPlace& s) {
  io.required_vector("point", s.point);
  io.optional_angle("angle", "angle_deg", s.angle, SeedPlace{}.angle);
}

template <class Io>
void describe(Io& io, FacingPlace& f) {
  io.required_vector("direction", f.direction);
  io.optional_angle("angle", "angle_deg", f.angle, FacingPlace{}.angle);
}

template <class Io>
void describe(Io& io, MeshSelection& s) {
  io.required_text("name", s.name);
  io.names("of", s.of);
  io.optional_box("box", s.box);
  io.maybe_object("plane", s.plane);
  io.maybe_object("sphere", s.sphere);
  io.maybe_object("facing", s.facing);
  io.maybe_object("seed", s.seed);
  io.text("file", s.file);
  io.number("scale", s.scale, 1.0);
  io.number("tolerance", s.tolerance, 0.0);
}

template <class Io>
void describe(Io& io, SceneBody& b) {
  io.required_text("name", b.name);
  MeshSource mesh{b.mesh};
  io.object("mesh", mesh);
  io.list("surfaces", b.surfaces);
  io.list("node_sets", b.node_sets);
  io.word("element", b.element, Element::tet4_edge_smoothed);
  io.list("materials", b.materials);
  io.optional_number("guard_stiffness", b.guard_stiffness);
  io.number("guard_threshold", b.guard_threshold, 0.5);
  io.vector("velocity", b.velocity, Vec3{});
  io.vector("angular_velocity", b.angular_velocity, Vec3{});
}

template <class Io>
void describe(Io& io, VolumeZone& z) {
  io.required_text("name", z.name);
  io.names("regions", z.regions);
  io.indices("cells", z.cells);
  io.boxes("boxes", z.boxes);
  io.text("field", z.field);
  io.number_or_inf("compliance", z.compliance, 1.0);
}

template <class Io>
void describe(Io& io, VolumeRows& v) {
  io.text("name", v.def.name);
  io.body("body", v.def.body);
  auto space = v.none ? VolumeSpaceWord::none : static_cast<VolumeSpaceWord>(v.def.space);
  io.word("space", space, VolumeSpaceWord::node);
  v.none = space == VolumeSpaceWord::none;
  if (!v.none) v.def.space = static_cast<VolumeSpace>(space);
  io.word("strain", v.def.strain, VolumeStrain::linear);
  io.names("regions", v.def.regions);
  io.integer("rings", v.def.rings, 1);
  io.list("zones", v.def.zones);
  io.word("unpainted", v.def.unpainted, UnpaintedCells::none);
  io.names("painted_surfaces", v.def.painted_surfaces);
  io.flag("across_regions", v.def.across_regions, false);
  io.number("stabilization", v.def.stabilization, 1.0);
  io.flag("hard", v.def.hard, false);
  io.flag("carries_bulk", v.def.carries_bulk, true);
  io.word("treatment", v.def.treatment, RowTreatment::automatic);
  io.flag("lumped_compliance", v.def.lumped_compliance, false);
}

template <class Io>
void describe(Io& io, Selection& s) {
  io.body("body", s.body);
  io.names("surfaces", s.surfaces);
  io.names("regions", s.regions);
  io.names("node_sets", s.node_sets);
  io.indices("nodes", s.nodes);
  io.boxes("boxes", s.boxes);
  io.points("nearest", s.nearest);
  io.flag("everything", s.everything, false);
}

struct Rotation {
  DirichletDef& def;
};
template <class Io>
void describe(Io& io, Rotation& r) {
  io.vector("point", r.def.axis_point, Vec3{});
  io.required_vector("axis", r.def.axis);
  io.angle("angle", "angle_deg", r.def.angle);
}

template <class Io>
void describe(Io& io, DirichletDef& d) {
  io.required_text("name", d.name);
  io.object("where", d.where);
  io.directions("directions", d.directions);
  io.vector("displacement", d.displacement, Vec3{});
  Rotation rotation{d};
  io.optional_object("rotation", rotation, d.angle != 0);
  io.text("bone", d.bone.file);
  io.word("treatment", d.treatment, SupportTreatment::eliminated);
  io.number("stiffness", d.stiffness, 0.0);
  io.points("points", d.points);
  const bool moves = d.angle != 0 || !(d.displacement == Vec3{});
  io.curve("amount", d.amount, CurveStart::zero, moves);
}

template <class Io>
void describe(Io& io, CavityDef& c) {
  io.required_text("name", c.name);
  io.body("body", c.body);
  io.names("surfaces", c.surfaces);
  io.word("control", c.control, CavityControl::pressure);
  constexpr CurveStart kStart[] = {CurveStart::zero, CurveStart::constant, CurveStart::one, CurveStart::one,
                                   CurveStart::one};
  io.required_curve("amount", c.amount, kStart[static_cast<std::size_t>(c.control)]);
  io.number("polytropic", c.polytropic, 1.0);
  io.number("ambient", c.ambient, 101325.0);
  io.number("density", c.density, 0.0);
  io.flag("cap_free_openings", c.cap_free_openings, false);
}

template <class Io>
void describe(Io& io, ValveDef& v) {
  io.required_text("name", v.name);
  io.required_text("from", v.from);
  io.text("to", v.to);
  io.number("conductance", v.conductance, 0.0);
  io.curve("amount", v.amount, CurveStart::constant, true);
}

// The rotation of a keyframe as a vector: axis times angle [rad].
template <class Io>
void describe(Io& io, Pose& p) {
  io.number("t", p.t, 0.0);
  io.vector("position", p.position, Vec3{});
  Vec3 turn = rotation_vector(p.rotation);
  io.vector("turn", turn, Vec3{});
  p.rotation = quaternion(turn);
}

template <class Io>
void describe(Io& io, Obstacle& o) {
  io.word("shape", o.shape, ObstacleShape::plane);
  io.vector("position", o.position, Vec3{});
  io.vector("axis", o.axis, Vec3{0, 0, 1});
  io.vector("side", o.side, Vec3{1, 0, 0});
  io.number("radius", o.radius, 0.0);
  io.number("length", o.length, 0.0);
  io.vector("size", o.size, Vec3{});
  io.number("rounding", o.rounding, 0.0);
  io.text("file", o.file);
  io.number("scale", o.scale, 1.0);
  io.number("spacing", o.spacing, 0.0);
  io.text("motion", o.motion.file);
  io.list("keyframes", o.motion.keys);
}

template <class Io>
void describe(Io& io, RigidBodyDef& r) {
  io.required_text("name", r.name);
  io.optional_object("shape", r.shape, true);
  io.number("density", r.density, 1000.0);
}

template <class Io>
void describe(Io& io, ContactDef& c) {
  io.required_text("name", c.name);
  io.body("body", c.body);
  io.names("surfaces", c.surfaces);
  io.text("rigid", c.rigid);
  io.text("against", c.against);
  io.optional_object("obstacle", c.obstacle, c.against.empty());
  io.number("compliance", c.compliance, 0.0);
  io.number("friction", c.friction, 0.0);
  io.number("static_friction", c.static_friction, 0.0);
  io.number("stick_stiffness", c.stick_stiffness, 0.0);
  io.word("coupling", c.coupling, FrictionCoupling::lagged);
  io.number("restitution", c.restitution, 0.0);
  io.number("restitution_speed", c.restitution_speed, 0.05);
  io.word("initial_overlap", c.initial_overlap, InitialOverlap::report);
  io.number("resolve_time", c.resolve_time, 1.0);
}

template <class Io>
void describe(Io& io, SurfaceContactDef& c) {
  io.required_text("name", c.name);
  io.body("body", c.body);
  io.names("surfaces", c.surfaces);
  io.optional_body("against", c.against);
  io.names("against_surfaces", c.against_surfaces);
  io.optional_number("compliance", c.compliance);
  io.number("thickness", c.thickness, 0.0);
  io.number("friction", c.friction, 0.0);
  io.number("static_friction", c.static_friction, 0.0);
  io.number("stick_stiffness", c.stick_stiffness, 0.0);
  io.word("coupling", c.coupling, FrictionCoupling::lagged);
  io.word("initial_overlap", c.initial_overlap, InitialOverlap::report);
  io.number("resolve_time", c.resolve_time, 1.0);
}

template <class Io>
void describe(Io& io, CableDef& c) {
  io.required_text("name", c.name);
  io.body("body", c.body);
  io.points("points", c.points);
  io.optional_vector("from", c.from);
  io.optional_vector("to", c.to);
  io.word("control", c.control, CableControl::length_ratio);
  constexpr CurveStart kStart[] = {CurveStart::zero, CurveStart::constant, CurveStart::one};
  io.required_curve("amount", c.amount, kStart[static_cast<std::size_t>(c.control)]);
  io.number("stiffness", c.stiffness, 0.0);
}

template <class Io>
void describe(Io& io, WindingDef& w) {
  io.required_text("name", w.name);
  io.body("body", w.body);
  io.paths("paths", w.paths);
  io.number("stiffness", w.stiffness, 0.0);
  io.number("slack", w.slack, 0.0);
  io.flag("pulls_only", w.pulls_only, true);
}

template <class Io>
void describe(Io& io, StrainLimitDef& l) {
  io.required_text("name", l.name);
  io.body("body", l.body);
  io.names("surfaces", l.surfaces);
  io.number("stiffness", l.stiffness, 0.0);
  io.number("slack", l.slack, 0.0);
  io.flag("pulls_only", l.pulls_only, true);
}

template <class Io>
void describe(Io& io, TieDef& t) {
  io.required_text("name", t.name);
  io.object("where", t.where);
  io.body("to", t.to);
  io.number("stiffness", t.stiffness, 0.0);
}

template <class Io>
void describe(Io& io, TractionDef& t) {
  io.required_text("name", t.name);
  io.body("body", t.body);
  io.required_text("surface", t.surface);
  io.vector("traction", t.traction, Vec3{});
  io.vector("total_force", t.total_force, Vec3{});
  io.curve("amount", t.amount, CurveStart::zero, true);
}

template <class Io>
void describe(Io& io, PressureDef& p) {
  io.required_text("name", p.name);
  io.body("body", p.body);
  io.names("surfaces", p.surfaces);
  io.required_curve("amount", p.amount, CurveStart::zero);
  io.flag("lagged", p.lagged, false);
}

template <class Io>
void describe(Io& io, PointForceDef& f) {
  io.required_text("name", f.name);
  io.object("where", f.where);
  io.required_vector("force", f.force);
  io.curve("amount", f.amount, CurveStart::zero, true);
}

template <class Io>
void describe(Io& io, DampingDef& d) {
  io.text("name", d.name);
  io.body("body", d.body);
  io.names("regions", d.regions);
  io.number("viscosity", d.viscosity, 0.0);
  io.number("mass_rate", d.mass_rate, 0.0);
}

template <class Io>
void describe(Io& io, EpidermisDef& e) {
  io.text("name", e.name);
  io.body("body", e.body);
  io.names("surfaces", e.surfaces);
  io.number("young", e.young, 0.0);
  io.number("poisson", e.poisson, 0.0);
  io.number("thickness", e.thickness, 0.0);
  io.number_or_inf("stiffness", e.stiffness, 0.0);
  io.number("gamma", e.gamma, 0.0);
}

template <class Io>
void describe(Io& io, MembraneDef& m) {
  io.text("name", m.name);
  io.body("body", m.body);
  io.names("surfaces", m.surfaces);
  io.number("young", m.young, 0.0);
  io.number("poisson", m.poisson, 0.5);
  io.number("thickness", m.thickness, 0.0);
}

template <class Io>
void describe(Io& io, AnalysisDef& a) {
  io.word("type", a.type, AnalysisType::statics);
  io.word("scheme", a.scheme, SchemeWord::implicit_euler);
  io.number("spectral_radius", a.spectral_radius, 0.8);
  io.number("duration", a.duration, 1.0);
  io.not_both("steps", "step");
  io.integer("steps", a.steps, a.step ? a.steps : 10);
  io.optional_number("step", a.step);
  io.optional_number("path_step", a.path_step);
  io.word("method", a.method, Method::automatic);
  io.integer("sweeps", a.sweeps, 20);
  io.word("solver", a.solver, Solver::automatic);
  io.integer("max_iterations", a.max_iterations, 60);
  io.word("definiteness", a.definiteness, Definiteness::exact);
  io.number("force_tolerance", a.force_tolerance, 1e-9);
  io.number("row_tolerance", a.row_tolerance, 1e-10);
  io.number("smallest_fraction", a.smallest_fraction, 1.0 / 64);
  io.flag("transient_rescue", a.transient_rescue, true);
  io.number("time_error", a.time_error, 0.0);
  io.flag("consistent_mass", a.consistent_mass, false);
}

template <class Io>
void describe(Io& io, ProbeDef& p) {
  io.required_text("name", p.name);
  io.body("body", p.body);
  io.required_vector("point", p.point);
}

template <class Io>
void describe(Io& io, OrientationDef& o) {
  io.required_text("name", o.name);
  io.object("where", o.where);
}

template <class Io>
void describe(Io& io, OutputDef& o) {
  io.integer("every", o.every, 1);
  io.flag("page", o.page, true);
  io.integer("checkpoint_steps", o.checkpoint_steps, 0);
  io.number("checkpoint_seconds", o.checkpoint_seconds, 60);
}

template <class Io>
void describe(Io& io, MetricDef& m) {
  io.required_text("name", m.name);
  io.word("quantity", m.quantity, Quantity::displacement);
  io.text("of", m.of);
  io.word("component", m.component, Component::magnitude);
  io.number("scale", m.scale, 1.0);
  io.optional_number("time", m.time);
  io.optional_number("reference", m.reference);
  io.optional_number("tolerance", m.tolerance);
  io.text("source", m.source);
  io.text("unit", m.unit);
}

// Bodies and the analysis come first: names of bodies and the meaning of plain numbers depend on them.
template <class Io>
void describe(Io& io, SceneDef& s) {
  io.note("$schema");
  io.text("name", s.name);
  io.text("title", s.title);
  io.text("description", s.description);
  io.list("bodies", s.bodies);
  io.bodies_known(s.bodies);
  io.object("analysis", s.analysis);
  io.analysis_known(s.analysis);
  io.optional_list("volumes", s.volumes);
  io.list("dirichlet", s.dirichlet);
  io.list("cavities", s.cavities);
  io.list("tractions", s.tractions);
  io.list("pressures", s.pressures);
  io.list("forces", s.forces);
  io.list("damping", s.damping);
  io.list("epidermis", s.epidermis);
  io.list("membranes", s.membranes);
  io.list("ties", s.ties);
  io.list("cables", s.cables);
  io.list("windings", s.windings);
  io.list("layers", s.layers);
  io.list("valves", s.valves);
  io.list("rigid_bodies", s.rigid_bodies);
  io.list("contacts", s.contacts);
  io.list("surface_contacts", s.surface_contacts);
  io.vector("gravity", s.gravity, Vec3{});
  io.curve("gravity_amount", s.gravity_amount, CurveStart::zero, !(s.gravity == Vec3{}));
  io.list("probes", s.probes);
  io.list("orientations", s.orientations);
  io.object("outputs", s.outputs);
  io.list("metrics", s.metrics);
}

}  // namespace isochor::scene_json
