#include "studies/chaos/scene.h"

#include <filesystem>
#include <set>

#include "scenes/run/outputs.h"
#include "scenes/scene_file.h"
#include "studies/chaos/draft.h"

namespace isochor::studies {

namespace {

constexpr const char* kElements[] = {"tet4", "tet4_edge_smoothed", "tet10", "hex8"};
constexpr const char* kSchemes[] = {"implicit_euler", "bdf2", "generalized_alpha", "newmark",
                                    "implicit_midpoint"};
constexpr const char* kLaws[] = {"neo_hookean",
                                 "neo_hookean_ogden",
                                 "stable_neo_hookean",
                                 "stable_neo_hookean_barrier",
                                 "isochoric_neo_hookean",
                                 "isochoric_extended",
                                 "corotated",
                                 "fixed_corotated",
                                 "stvk",
                                 "stvk_resistant",
                                 "linear",
                                 "mooney_rivlin",
                                 "fung",
                                 "arruda_boyce",
                                 "ogden",
                                 "yeoh",
                                 "gent",
                                 "veronda_westmann",
                                 "holmes_mow",
                                 "isochoric_mooney_rivlin",
                                 "isochoric_fung",
                                 "isochoric_arruda_boyce",
                                 "isochoric_ogden",
                                 "isochoric_yeoh",
                                 "isochoric_gent",
                                 "isochoric_veronda_westmann",
                                 "isochoric_holmes_mow",
                                 "named"};
constexpr const char* kSpaces[] = {"node", "element", "body", "ring", "zone"};
constexpr const char* kControls[] = {"pressure", "volume", "volume_ratio", "gas", "liquid"};
constexpr const char* kShapes[] = {"plane", "sphere", "capsule", "cylinder", "box", "mesh", "distance_field"};

template <class E>
std::string word(const char* const* words, E value) {
  return words[static_cast<std::size_t>(value)];
}

void add_body_parts(const SceneDef& s, std::set<std::string>& parts) {
  for (const SceneBody& body : s.bodies) {
    parts.insert("element " + word(kElements, body.element));
    for (const MaterialDef& m : body.materials) {
      parts.insert("law " + word(kLaws, m.law));
      if (!m.fibers.empty()) parts.insert("fibers");
      if (!m.prony.empty()) parts.insert("memory");
      if (m.mullins) parts.insert("Mullins softening");
      if (m.compression_penalty.modulus > 0) parts.insert("compression penalty");
      if (m.stiffness_field.given() || m.poisson_field.given()) parts.insert("fields of constants");
    }
    if (std::holds_alternative<LatticeMesh>(body.mesh)) parts.insert("lattice");
    if (!(body.velocity == Vec3{}) || !(body.angular_velocity == Vec3{})) parts.insert("starts in motion");
  }
  if (s.bodies.size() > 1) parts.insert("several bodies");
  if (!s.volumes) {
    parts.insert("volume rows, node");
    return;
  }
  for (const VolumeRows& v : *s.volumes) {
    parts.insert("volume rows, " + (v.none ? "none" : word(kSpaces, v.def.space)));
    if (!v.none && v.def.strain == VolumeStrain::logarithmic) parts.insert("volume rows, log J");
  }
}

void add_effect_parts(const SceneDef& s, std::set<std::string>& parts) {
  const auto note = [&parts](const char* name, bool present) {
    if (present) parts.insert(name);
  };
  for (const DirichletDef& d : s.dirichlet) {
    const bool moves = !(d.displacement == Vec3{}) || d.angle != 0 || !d.bone.file.empty();
    note("prescribed motion", moves);
    note("support", !moves);
    note("support as rows", d.treatment != SupportTreatment::eliminated);
  }
  for (const CavityDef& c : s.cavities) parts.insert("cavity, " + word(kControls, c.control));
  note("valve", !s.valves.empty());
  note("traction", !s.tractions.empty());
  for (const TractionDef& t : s.tractions) note("traction, current area", t.current_area);
  note("pressure on faces", !s.pressures.empty());
  note("muscle", !s.muscles.empty());
  note("growth", !s.growth.empty());
  note("spring", !s.springs.empty());
  note("linear constraint", !s.linear_constraints.empty());
  note("nodes that follow data", !s.driven.empty());
  note("skin", !s.skins.empty());
  note("statics, then dynamics", s.analysis.static_until.has_value());
  note("point force", !s.forces.empty());
  note("damping", !s.damping.empty());
  note("epidermis", !s.epidermis.empty());
  note("membrane", !s.membranes.empty());
  note("shell", !s.shells.empty());
  note("tie", !s.ties.empty());
  note("cable", !s.cables.empty());
  note("winding", !s.windings.empty());
  note("layer", !s.layers.empty());
  note("rigid body", !s.rigid_bodies.empty());
  note("gravity", !(s.analysis.options.gravity == Vec3{}));
  for (const ContactDef& c : s.contacts) {
    if (c.against.empty()) parts.insert("contact, " + word(kShapes, c.obstacle.shape));
    note("contact, friction", c.friction > 0);
    note("contact, coupled friction", c.coupling == FrictionCoupling::coupled);
    note("contact, compliant", c.compliance > 0);
    note("contact, restitution", c.restitution > 0);
    note("contact, initial overlap", c.initial_overlap == InitialOverlap::resolve);
  }
  for (const SurfaceContactDef& c : s.surface_contacts)
    parts.insert(c.against ? "surface contact" : "self-contact");
}

}  // namespace

ChaosScene chaos_scene(std::uint64_t seed, const ChaosSize& size) {
  ChaosDraft draft;
  draft.size = size;
  draft.out.seed = seed;
  draft.scene().name = "chaos_" + std::to_string(seed);
  draft_analysis(draft);
  draft_bodies(draft);
  draft_volumes(draft);
  draft_supports(draft);
  draft_loads(draft);
  draft_cavities(draft);
  draft_attachments(draft);
  draft_contacts(draft);
  draft_active(draft);
  draft_drive(draft);
  return std::move(draft.out);
}

std::vector<std::string> parts_of(const SceneDef& scene) {
  std::set<std::string> parts;
  const AnalysisDef& a = scene.analysis;
  parts.insert(a.type == AnalysisType::statics ? (a.path_step ? "scheme continuation" : "scheme statics")
                                               : "scheme " + word(kSchemes, a.scheme));
  add_body_parts(scene, parts);
  add_effect_parts(scene, parts);
  return {parts.begin(), parts.end()};
}

Result<SceneDef> write_chaos_scene(const ChaosScene& chaos, const std::string& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) return Error{folder + ": cannot be made: " + code.message()};
  for (const ChaosFile& file : chaos.files) {
    if (auto r = write_text(folder + "/" + file.name, file.text); !r) return r.failure();
  }
  const std::string path = folder + "/scene.json";
  if (auto r = write_text(path, to_json(chaos.scene)); !r) return r.failure();
  return read_scene_file(path);
}

}  // namespace isochor::studies
