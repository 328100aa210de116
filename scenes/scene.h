// A scene as plain data: bodies, effects, analysis, what to watch and what to compare with.
//
// The same data come from a C++ program (scenes/programs), from a scene file (scenes/scene.schema.json) or
// from a test; build() turns them into a world and run_scene() of run.h runs them. Nothing here throws.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "isochor/fiber_fields.h"
#include "isochor/generate.h"
#include "isochor/lattice.h"
#include "isochor/mesh_select.h"
#include "isochor/mullins.h"
#include "isochor/viscoelastic.h"
#include "isochor/world.h"
#include "scenes/effects/list.h"

namespace isochor {

enum class MaterialLaw : std::uint8_t {
  neo_hookean,
  neo_hookean_ogden,
  stable_neo_hookean,
  stable_neo_hookean_barrier,
  isochoric_neo_hookean,
  isochoric_extended,
  corotated,
  fixed_corotated,
  stvk,
  stvk_resistant,
  linear,
  mooney_rivlin,
  fung,
  arruda_boyce,
  ogden,
  yeoh,
  gent,
  veronda_westmann,
  holmes_mow,
  isochoric_mooney_rivlin,
  isochoric_fung,
  isochoric_arruda_boyce,
  isochoric_ogden,
  isochoric_yeoh,
  isochoric_gent,
  isochoric_veronda_westmann,
  isochoric_holmes_mow,
  named
};

// VolumeEnergy of a law, or what its function takes by itself.
enum class VolumeEnergyWord : std::uint8_t { by_law, quadratic, logarithmic, mixed };

// Constants of single laws; each is refused beside a law that does not know it. The functions of
// isochor/materials.h say what they are.
struct LawConstants {
  double c1 = 0, c2 = 0;               // mooney_rivlin [Pa], veronda_westmann [Pa, -]
  double c20 = 0, c11 = 0, c02 = 0;    // mooney_rivlin [Pa]
  double mu0 = 0, mu1 = 0, gamma = 0;  // fung [Pa, -, Pa]
  double beta1 = 0, beta2 = 0;         // arruda_boyce [-]
  double beta3 = 0, beta4 = 0, locking_stretch = 0;
  std::vector<OgdenTerm> terms;  // ogden
  std::vector<double> c;         // yeoh [Pa]
  double jm = 0;                 // gent [-]
  double beta = 0;               // holmes_mow [-]
  VolumeEnergyWord volume_energy = VolumeEnergyWord::by_law;
  std::string name;        // of a named material
  double resistance = 0;   // stvk_resistant [Pa]
  double threshold = 0.1;  // isochoric_extended [-]
};

// Fibers whose directions may be a field of the body's mesh: one with three components in cells, or at nodes,
// where a cell takes the axis that its nodes agree on best.
struct SceneFibers : FiberFamily {
  std::string field;
  std::optional<FiberSpread> spread;  // about the direction
};

// Directions from a Laplace problem, as a field of the mesh in its cells.
struct SceneFiberField : LaplaceFibers {
  std::string name;
};

// Numbers cell by cell, in the order of the cells of the body's mesh: in place or in a text file.
struct CellField {
  std::vector<double> values;
  std::string file;  // relative to SceneDef::folder
  bool given() const { return !values.empty() || !file.empty(); }
};

struct MaterialDef {
  std::string region;  // empty: every region not named elsewhere
  MaterialLaw law = MaterialLaw::neo_hookean;
  ElasticConstants constants;  // of laws with constants of their own, only Poisson's ratio counts
  LawConstants own;
  std::vector<PronyTerm> prony;             // beside it, none: an elastic material
  std::optional<MullinsSoftening> mullins;  // of the law
  StaticTime static_time = StaticTime::long_term;
  std::vector<SceneFibers> fibers;
  CompressionPenalty compression_penalty;  // as it is made: none
  CellField stiffness_field;               // factors on the stiffness of the material
  CellField poisson_field;                 // Poisson's ratios, in place of the one of `constants`
  double density = 1000;                   // [kg/m^3]
};

struct MeshFile {
  std::string path;  // relative to SceneDef::folder
  double scale = 1;  // multiplies coordinates: 1e-3 for a file in millimeters
  Vec3 turn{};       // turns the scaled coordinates about the origin: axis times angle [rad]
  Vec3 offset{};     // added then [m]
};

// Cubes around a closed surface, which is what results show.
struct LatticeMesh {
  std::string
      surface;  // Wavefront (.obj) or a volume mesh, whose boundary it is; relative to SceneDef::folder
  double scale = 1;
  Vec3 offset{};       // as for files [m]
  double spacing = 0;  // edge of a cube [m]
  int samples = 4;     // see LatticeDef
  bool keep_apart = true;
};

// Cells that are refined beyond their neighbors: those that fit all that is given.
struct RefinedPlace {
  std::optional<std::array<Vec3, 2>> box;  // lower and upper corner, with a node of the cell between them [m]
  std::optional<SpherePlace> sphere;       // with a node of the cell inside
  std::vector<std::string> surfaces;       // with a node of the cell on one of them
  std::vector<std::string> regions;
  CellField cells;       // by number, in the mesh as it is when their turn comes
  double tolerance = 0;  // of box, sphere and surfaces, as MeshSelection has it [m]
  int levels = 1;        // so many times, each time all that fit
};

struct SceneBody {
  std::string name = "body";
  std::variant<MeshFile, BoxMeshDef, LatticeMesh> mesh;
  // Named by where they are, beside those of the mesh file; in the placed mesh, after scale, turn and offset.
  std::vector<MeshSelection> surfaces, node_sets;
  // Then every cell is cut into eight, so often, and the cells of these places once more, one after the
  // other. Numbers cell by cell are those of the mesh before that.
  int refine = 0;
  std::vector<RefinedPlace> refine_where;
  std::vector<SceneFiberField> fiber_fields;  // made in the refined mesh
  Element element = Element::tet4_edge_smoothed;
  std::vector<MaterialDef> materials;
  std::optional<double> guard_stiffness;  // see BodyDef
  double guard_threshold = 0.5;
  // Dynamics: how the body moves at the start; it turns about its center of mass.
  Vec3 velocity{}, angular_velocity{};  // [m/s], [rad/s]
};

// When effects are there: in the steps between two times. What no entry names is always there; what several
// name is there while any of them says so.
struct ScheduleDef {
  std::vector<std::string> effects;  // by name
  double from = 0;                   // [s]; statics: load factor
  std::optional<double> to;          // absent: to the end
};

enum class AnalysisType : std::uint8_t { statics, dynamics };
enum class SchemeWord : std::uint8_t { implicit_euler, bdf2, generalized_alpha, newmark, implicit_midpoint };

struct AnalysisDef {
  AnalysisType type = AnalysisType::statics;
  SchemeWord scheme = SchemeWord::implicit_euler;  // dynamics
  double spectral_radius = 0.8;                    // of generalized_alpha, 0 to 1
  std::optional<double> static_until;              // [s], dynamics: equilibria before it
  double duration = 1;                             // [s]; statics: final load factor
  int steps = 10;                                  // results are reported this often
  std::optional<double> step;                      // [s], instead of steps
  // Statics along the path of equilibria, through limit points: length of a step as World::follow() counts it
  // [m]. `steps` is then the most steps taken, `duration` the load factor that ends the run.
  std::optional<double> path_step;
  // What the world is asked for. Its scheme comes from the above, its threads and log from who runs the
  // scene.
  WorldOptions options;
};

// A named material point: results are interpolated in the cell that holds it at rest.
struct ProbeDef {
  std::string name;
  BodyId body{};
  Vec3 point{};  // rest position [m]
};

// A face or another set of nodes whose turn, displacement and normal the scene reports (World::orientation).
struct OrientationDef {
  std::string name;
  Selection where;
};

struct OutputDef {
  int every = 1;     // a .vtu every so many steps and at the end; 0: none
  bool page = true;  // the HTML results page
  // A run that is killed goes on from its last checkpoint (RunOptions::resume): one every so many steps, and
  // one where so much wall time has passed since the last; 0: none for that reason.
  int checkpoint_steps = 0;
  double checkpoint_seconds = 60;  // [s]
};

enum class Quantity : std::uint8_t {
  displacement,     // of a probe or orientation [m]
  cavity_pressure,  // [Pa]
  cavity_volume,    // [m^3]
  cable_tension,    // [N]
  cable_length,     // [m]
  rigid_x,          // position of a free rigid body [m]
  rigid_y,
  rigid_z,
  contact_force,       // on the body, friction included [N]
  contact_area,        // [m^2]
  contact_pressure,    // the largest [Pa]
  contact_gap,         // the smallest [m]
  reaction_force,      // of a support [N]
  reaction_moment,     // of a support, about the origin [N m]
  orientation_angle,   // [deg]
  orientation_axis,    // unit vector
  orientation_normal,  // unit vector
  volume_row_residual,
  volume_change,  // of the scene, a body or "body.region": relative, negative where volume was lost
  volume,         // likewise [m^3]
  constitutive_residual,
  min_J,  // likewise
  max_J,
  elastic_energy,     // [J]
  kinetic_energy,     // [J]
  gravity_potential,  // [J], like all below as in Energies
  load_potential,     // of dead loads and given pressures and tensions [J]
  potential_energy,   // [J]
  total_energy,       // [J]
  linear_momentum,    // of the scene or a body [kg m/s]
  angular_momentum,   // about the origin [kg m^2/s]
  newton_iterations,  // of all steps up to then
};
enum class Component : std::uint8_t { magnitude, x, y, z };

// A number of the scene that has a name, where known with the reference it is held against.
struct MetricDef {
  std::string name;
  Quantity quantity = Quantity::displacement;
  std::string of;  // probe, cavity, support, body...
  Component component = Component::magnitude;
  double scale = 1;                 // multiplies the quantity: 4 for a quarter model, 1e3 for millimeters
  std::optional<double> time;       // of a reported step; absent: the end
  std::optional<double> reference;  // after scaling
  std::optional<double> tolerance;  // relative; of a reference 0: absolute
  std::string source;               // where the reference is from
  std::string unit;
};

struct SceneDef : SceneEffects {
  std::string name = "scene";  // names the outputs
  std::string title, description;
  std::string folder;  // relative mesh paths start here; not part of a scene file
  std::vector<SceneBody> bodies;
  AnalysisDef analysis;
  std::vector<ScheduleDef> schedule;
  std::vector<ProbeDef> probes;
  std::vector<OrientationDef> orientations;
  OutputDef outputs;
  std::vector<MetricDef> metrics;
};

// Steps of the analysis and their length [s].
struct StepPlan {
  int steps = 0;
  double h = 0;
};
StepPlan plan_steps(const AnalysisDef& analysis);

// Refuses what contradicts itself without looking at a mesh: names used twice, metrics of probes that do not
// exist, steps that do not divide. Messages start with the place, as in "metrics[2].of".
Result<void> check_scene(const SceneDef& scene);

// A surface that moves with the cells of a lattice.
struct DisplaySurface {
  std::vector<Index> triangles;
  std::vector<EmbeddedPoint> points;
};

// An effect that is not always there, and what takes its place when it is not.
struct ScheduledEffect {
  EffectId id{};
  std::string name;
  EffectPtr effect, idle;
  std::vector<std::array<double, 2>> times;  // from and to [s]
  bool there = true;
};

struct BuiltScene {
  World world;
  std::vector<BodyId> bodies = {};
  std::map<const EffectKind*, std::vector<EffectId>> effects = {};  // in the order of the scene's lists
  std::vector<DisplaySurface> surfaces = {};                        // by body; empty where its mesh is shown
  // By body: of each cell that of the mesh before it was refined; empty where it was not.
  std::vector<std::vector<Index>> parents = {};
  std::vector<Obstacle> obstacles = {};     // by contact, with what their files hold
  std::vector<Obstacle> rigid_shapes = {};  // by rigid body, likewise
  std::vector<ScheduledEffect> scheduled = {};
  std::vector<Gauge> gauge_columns = {};  // of scenes with a schedule: gauges that there are at any time

  std::span<const EffectId> ids(const EffectKind& kind) const {
    const auto found = effects.find(&kind);
    return found == effects.end() ? std::span<const EffectId>() : found->second;
  }
};

// What build() hands to the world.
struct SceneParts {
  std::vector<BodyDef> bodies;
  std::vector<EffectPtr> effects;
};

struct BuildOptions {
  int threads = 0;                       // 0: all the machine has
  SceneParts* parts = nullptr;           // where given: copies of bodies and effects are put here
  std::shared_ptr<const Ranks> ranks{};  // as Host::ranks
};

// The material of a definition; messages name the law and the constant. Files of fields are looked for in
// `folder`.
Result<MaterialPtr> make_material(const MaterialDef& def, const std::string& folder = "",
                                  const Mesh* mesh = nullptr);

// The time scheme that an analysis asks for.
SchemePtr make_scheme(const AnalysisDef& analysis);

// Reads meshes, makes materials and effects, compiles the world. Errors are those of bad input.
Result<BuiltScene> build(const SceneDef& scene, const BuildOptions& options = {});

// Has those effects there that the schedule wants in an increment around time t, and no others; true when
// that changed something. The world compiles then. Errors: what the world refuses, with the effects named.
Result<bool> follow_schedule(BuiltScene& built, double t);

}  // namespace isochor
