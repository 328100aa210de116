// What an effect sees while a scene is compiled, and what it must provide. Extension header.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/elements/growth.h"
#include "engine/elements/material_model.h"
#include "engine/elements/reference_element.h"
#include "engine/scene/ids.h"
#include "engine/scene/live_pose.h"
#include "engine/system/state.h"
#include "engine/system/system.h"
#include "isochor/bodies.h"
#include "isochor/curves.h"
#include "isochor/export.h"
#include "isochor/ids.h"
#include "isochor/measures.h"
#include "isochor/selection.h"

namespace isochor {

class Builder;

// An amount over time: the curve of its definition until a host sets a value, which then ramps in over one
// increment.
class ISOCHOR_API Amount {
 public:
  explicit Amount(Curve curve) : curve_(std::move(curve)) {}
  double value(double t) const { return shift_ == 0 ? plain_value(t) : plain_value(t) + shift_; }
  void set(double value) { pending_ = value; }
  // Added to all values, for differences; zero otherwise.
  void shift(double by) { shift_ = by; }
  // Announces the increment [t0, t1]; a pending value ramps over it.
  void begin(double t0, double t1);
  // Whether a host has set it, and whether what was set is valid by now.
  bool set_by_host() const { return held_ || pending_; }
  bool held() const { return held_; }
  void forget() {
    held_ = false;
    pending_.reset();
  }
  void save(std::vector<double>& out) const;
  bool load(std::span<const double>& in);
  // Takes the numbers of one amount off a list; false where they are none.
  static bool take(std::span<const double>& in);

 private:
  double plain_value(double t) const;

  Curve curve_;
  bool held_ = false;  // from_/to_ replace the curve
  double from_ = 0, to_ = 0, t0_ = 0, t1_ = 0;
  double shift_ = 0;
  std::optional<double> pending_;
};

// What gauges may read.
struct GaugeContext {
  const System& system;
  const State& state;
};

// What presses on and rubs along the surfaces of bodies, by scene node.
struct SurfaceForces {
  std::vector<double> normal;    // [N]
  std::vector<Vec3> tangential;  // on the body [N]
  std::vector<double> area;      // at rest, that the node stands for [m^2]; 0: the effect is not there
};

// A point of a contact that presses; nodes are those of the scene.
struct PressingPoint {
  Index node = -1;        // where it is one
  Index of = -1;          // a node of the body that it is of, -1: a rigid body, whose name it is
  Index partner_of = -1;  // likewise
  std::string name, partner;
  Vec3 position{};
  double gap = 0;
  Vec3 normal{}, friction{};
  double force = 0, area = 0;
};

// What a gauge reads of the equations: the multiplier of a row, or its function, times a factor. What it has
// beside does not depend on positions or multipliers.
struct GaugeSource {
  std::string_view quantity;
  Index row_pool = -1, row = 0;
  bool multiplier = false;
  double factor = 1;
};

// The live part of an effect: what a host can set and read.
class EffectInstance {
 public:
  virtual ~EffectInstance() = default;
  virtual Amount* amount() { return nullptr; }
  // Energies read the amount themselves: it is not in targets, given multipliers or loads.
  virtual bool amount_in_energy() const { return false; }
  virtual LivePose* pose() { return nullptr; }
  virtual void gauges(const GaugeContext& context, std::vector<Gauge>& out) const {
    (void)context;
    (void)out;
  }
  // Of gauges that follow one row each.
  virtual std::vector<GaugeSource> gauge_sources() const { return {}; }
  // Force and moment about the origin by which it holds bodies with rows of its own; what prescribes
  // coordinates has residuals for that.
  virtual std::array<Vec3, 2> reaction(const GaugeContext& context) const {
    (void)context;
    return {};
  }
  virtual void pressing_points(const GaugeContext& context, std::vector<PressingPoint>& out) const {
    (void)context;
    (void)out;
  }
  // Pressure multipliers that live at nodes, by scene node [Pa]; others are left as they are.
  virtual void node_multipliers(const GaugeContext& context, std::span<double> pressure) const {
    (void)context;
    (void)pressure;
  }
  // Adds the forces that it exerts on surfaces, and fills in the areas of their nodes; false: it is of no
  // such kind.
  virtual bool surface_forces(const GaugeContext& context, SurfaceForces& forces) const {
    (void)context;
    (void)forces;
    return false;
  }
};

// The description of an effect, as a host adds it.
class EffectSource {
 public:
  virtual ~EffectSource() = default;
  virtual const std::string& name() const = 0;
  // Everything that its definition says: a saved state belongs to one definition.
  virtual void describe(Fingerprint& f) const = 0;
  // Parameters alone, before the scene is known.
  virtual Result<void> check() const { return {}; }
  // First pass: what it needs from bodies.
  virtual Result<void> declare(Builder& builder) const {
    (void)builder;
    return {};
  }
  // Second pass: pools, rows, supports, loads.
  virtual Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const = 0;
};

// Rest data of the stencils of a region, kept for when it is built again: of patches, and of cells by the
// kind of their volume functions. They hold scene nodes and are good for a body at one place.
struct RegionStencils {
  Index first_node = -1;
  std::shared_ptr<const SolidData> patches;
  std::array<std::shared_ptr<const SolidData>, 3> cells;  // by VolumeFunctions
};

inline constexpr std::size_t kVolumeStrains = static_cast<std::size_t>(VolumeStrain::by_law);

struct RegionData {
  std::string name;
  MaterialPtr material;
  double density = 0;
  std::vector<Index> cells;
  bool bulk_claimed = false;
  // Pools that were built for it.
  std::shared_ptr<const Material> energy;  // of elastic_pool
  Index elastic_pool = -1;
  std::vector<Index> memory_pools;                                    // on the stencils of elastic_pool
  bool remembers = false;                                             // its energy or what flows beside it
  Index guard_pool = -1;                                              // of edge-smoothed bodies
  std::array<Index, kVolumeStrains> volume_pool{-1, -1, -1, -1, -1};  // by VolumeStrain
  std::array<bool, kVolumeStrains> volume_wanted{};
  bool has_volume_pool(Index pool) const {
    return std::find(volume_pool.begin(), volume_pool.end(), pool) != volume_pool.end();
  }
  RegionStencils stencils;
  std::vector<std::uint8_t> guarded;     // by cell: 1 where the element guard acts; empty: nowhere
  std::shared_ptr<const Growth> growth;  // by cell of the mesh; null: none
};

// Volume functions over cells of several regions, beside those of each region.
struct SpanningVolume {
  Index pool = -1;
  VolumeStrain strain = VolumeStrain::linear;
  std::vector<Index> stencil_of_cell;  // -1 for cells that it does not hold
};

struct BodyData {
  std::string name;
  Mesh mesh;
  Element element = Element::tet4;
  const ReferenceElement* reference = nullptr;
  Index first_node = 0;
  std::vector<RegionData> regions;
  std::vector<SpanningVolume> spanning;
  double guard_threshold = 0.5;
  std::optional<double> guard_stiffness;
  std::vector<Index> global_cells;    // mesh.cells with scene node numbers
  double lent_modulus = 0;            // shear modulus of what makes a thin body stiff [Pa]
  std::vector<std::string> warnings;  // about its mesh

  bool present() const { return reference != nullptr; }  // false: a place that is free
  // Made of triangles: no regions, and no stiffness or mass but what effects give it.
  bool thin() const { return present() && mesh.cell_type == CellType::tri3; }
};

// A displacement over time, shared by the nodes it moves.
class Motion {
 public:
  virtual ~Motion() = default;
  virtual Vec3 displacement(double t, const Vec3& rest) const = 0;  // [m]
  virtual bool never_moves() const { return false; }
  // Angle that it turns from t0 to t1 [rad], all the way round where it goes round.
  virtual double turn(double t0, double t1) const {
    (void)t0;
    (void)t1;
    return 0;
  }
};

// A direction in which an effect holds a node; the directions of one node are orthonormal.
struct HeldDirection {
  Index node = -1;
  Vec3 direction{};
};

// Who made the parts of a scene: the numbers of effects, -1 for none.
struct Owners {
  std::vector<Index> point;  // of nodes without a body, by node; others: -1
  std::vector<Index> stencil_pool, row_pool;
};

class ISOCHOR_API Builder {
 public:
  // Bodies first; returns the place that one has.
  Result<Index> add_body(const BodyDef& def);
  // A builder that has the bodies of this one and nothing built on them: in it, bodies may change.
  Builder again() const;
  void remove_body(Index place);
  // The regions that a definition is for; empty: all. The error names those that there are.
  Result<void> set_material(BodyId id, const std::string& region, const MaterialPtr& material);
  Result<void> set_density(BodyId id, const std::string& region, double density);
  // Of a builder that has built nothing: moves the rest positions of a body, one vector a node.
  void move_nodes(BodyId id, std::span<const Vec3> by);

  const Slots& body_slots() const { return slots_; }
  // Places of bodies; those that are free hold none (BodyData::present()).
  Index body_count() const { return static_cast<Index>(bodies_.size()); }
  const BodyData& body(BodyId id) const { return bodies_[static_cast<std::size_t>(id)]; }
  bool has_body(BodyId id) const { return find(id) == WorldNumbers::Found::here; }
  // Why it has not: the end of a sentence.
  std::string no_body(BodyId id) const { return why_not(find(id), "body", id.number(), slots_.taken()); }
  // The number of its world; 0: ids are not asked whose they are.
  std::uint64_t world() const { return world_; }
  void set_world(std::uint64_t number) { world_ = number; }
  std::span<const Vec3> rest() const { return parts_.rest; }
  double length() const;  // diagonal of the scene's box [m]

  // Declarations about a region (index into body.regions). `strain` is not by_law.
  void want_volume(BodyId id, std::size_t region, VolumeStrain strain) {
    bodies_[static_cast<std::size_t>(id)].regions[region].volume_wanted[static_cast<std::size_t>(strain)] =
        true;
  }
  // Says that rows carry the bulk modulus of the region; false when other rows already do.
  bool claim_bulk(BodyId id, std::size_t region);
  // Says what its stress-free state is; false when somebody already has.
  bool grow(BodyId id, std::size_t region, std::shared_ptr<const Growth> growth);

  // After the declarations: elastic energies and volume functions of all bodies.
  Result<void> build_solids();
  const SolidPool& solid(Index pool) const {
    return static_cast<const SolidPool&>(*parts_.stencil_pools[at(pool)]);
  }

  // Names to indices; the message names what exists.
  Result<std::vector<std::size_t>> regions(BodyId id, std::span<const std::string> names,
                                           const std::string& who) const;
  Result<std::vector<Index>> select(const Selection& selection,
                                    const std::string& who) const;  // scene nodes, sorted
  // Faces of named surfaces, in scene node numbers, nodes_per_face each.
  Result<std::vector<Index>> faces(BodyId id, std::span<const std::string> surfaces,
                                   const std::string& who) const;

  Index add_stencils(std::shared_ptr<const StencilPool> pool);
  Index add_rows(std::shared_ptr<const RowPool> pool);
  void add_load(std::shared_ptr<const LoadPool> load) { parts_.loads.push_back(std::move(load)); }
  Result<void> prescribe(Index node, const Vec3& direction, std::shared_ptr<const Motion> motion,
                         const std::string& who);
  // Number of directions in which a node is given so far.
  int given_directions(Index node) const;
  std::vector<Vec3> directions_given(Index node) const;  // unit vectors
  // What each effect holds; directions that depend on earlier ones belong to the earlier effect.
  std::vector<std::vector<HeldDirection>> held_directions(std::size_t effects) const;
  void set_owner(Index effect) { owner_ = effect; }
  Index owner() const { return owner_; }
  const Owners& owners() const { return owners_; }
  // What effects share while they are built, made by the first that asks: chambers that are connected live in
  // one pool.
  template <class T>
  std::shared_ptr<T> shared(const std::string& key) {
    auto& slot = shared_[key];
    if (!slot) slot = std::make_shared<T>();
    return std::static_pointer_cast<T>(slot);
  }
  // Before build_solids(): inertia by the consistent mass matrix.
  void use_consistent_mass() { consistent_mass_ = true; }
  // A node that belongs to no body, with its mass [kg]; for effects with unknowns of their own.
  Index add_point(const Vec3& rest, double mass);
  // Mass that an effect lends to a node [kg], beside that of the body.
  void add_mass(Index node, double mass);
  // Says, while effects declare, what a thin body is made of; the stiffest counts.
  void lend_modulus(BodyId id, double shear_modulus) {
    double& mu = bodies_[static_cast<std::size_t>(id)].lent_modulus;
    mu = std::max(mu, shear_modulus);
  }
  // All that add_mass() was given, by node; empty: nothing.
  std::span<const double> lent_mass() const { return lent_mass_; }
  // Whether the scene is for statics, where nothing has inertia.
  bool quasi_static() const { return quasi_static_; }
  void set_quasi_static(bool on) { quasi_static_ = on; }
  void warn(std::string text) { warnings_.push_back(std::move(text)); }
  // What the meshes say of their units, to end a message with; empty where the sizes are plausible.
  const std::string& doubtful_units() const { return doubtful_units_; }

  // Merges supports, checks the scene and hands the parts over.
  Result<SystemParts> finish(bool needs_anchors);
  std::vector<std::string>& warnings() { return warnings_; }
  std::vector<BodyData>& bodies() { return bodies_; }
  const std::vector<BodyData>& bodies() const { return bodies_; }

 private:
  // A definition that names no body is about the first.
  WorldNumbers::Found find(BodyId id) const {
    const auto found = WorldNumbers::look_up(id, slots_, world_);
    if (found != WorldNumbers::Found::unsaid || slots_.size() == 0) return found;
    return slots_.holds(0) ? WorldNumbers::Found::here : WorldNumbers::Found::removed;
  }
  Result<void> add_regions(const BodyDef& def, BodyData& body) const;
  Result<std::vector<RegionData*>> regions_for(BodyId id, const std::string& region, const std::string& who);
  Index take_body(BodyData body, const std::string& doubtful_units);
  void place_nodes(BodyData& body);
  Result<void> build_region(BodyData& body, RegionData& region);
  void add_memory(const BodyData& body, RegionData& region, const std::shared_ptr<const SolidData>& data);
  Result<std::shared_ptr<const SolidData>> patches_of(const BodyData& body, RegionData& region) const;
  Result<std::shared_ptr<const SolidData>> cells_of(const BodyData& body, RegionData& region,
                                                    VolumeFunctions kind) const;

  Slots slots_;
  std::vector<BodyData> bodies_;  // by place
  SystemParts parts_;
  // The effect that each part is of, -1: none; by node, stencil pool and row pool.
  Owners owners_;
  struct Given {
    Vec3 direction;
    std::shared_ptr<const Motion> motion;
    std::string who;
    Index owner;
  };
  friend class SupportPrescriber;
  std::vector<std::vector<Given>> given_;
  std::vector<std::string> warnings_;
  std::string doubtful_units_;
  std::map<std::string, std::shared_ptr<void>> shared_;
  Index owner_ = -1;  // effect being built
  std::uint64_t world_ = 0;
  std::vector<double> lent_mass_;
  bool consistent_mass_ = false;
  bool quasi_static_ = false;
};

}  // namespace isochor
