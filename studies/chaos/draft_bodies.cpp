#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "isochor/mesh_io.h"
#include "scenes/library.h"
#include "studies/chaos/draft.h"
#include "studies/chaos/mesh.h"

namespace isochor::studies {

namespace {

constexpr double kPoissons[] = {0, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.499999};

struct LibraryMesh {
  const char* name;
  CellType type;
  int cells;  // at least as many as it has
  const char* chamber;
};
constexpr LibraryMesh kLibraryMeshes[] = {
    {"thick_tube_coarse", CellType::tet4, 150, ""},
    {"thick_tube_coarse_tet10", CellType::tet10, 100, ""},
    {"thick_tube_coarse_hex", CellType::hex8, 40, ""},
    {"thick_sphere_coarse_tet10", CellType::tet10, 100, ""},
    {"torsion_cylinder_coarse_tet10", CellType::tet10, 60, ""},
    {"cook_plane_grid_1", CellType::tet4, 150, ""},
    {"cook3d_1_hex", CellType::hex8, 150, ""},
    {"ball_small", CellType::tet4, 600, ""},
};

void draw_own_constants(ChaosRandom& random, MaterialDef& m, double young) {
  const double mu = young / 3;
  switch (m.law) {
    case MaterialLaw::mooney_rivlin:
      m.own.c1 = random.pick({0.0, 0.25, 0.4, 0.5}) * mu;
      m.own.c2 = 0.5 * mu - m.own.c1;
      break;
    case MaterialLaw::fung:
      m.own.mu0 = random.between(0.1, 1) * mu;
      m.own.mu1 = random.decades(-2, 1);
      m.own.gamma = mu * random.between(0, 0.5);
      break;
    case MaterialLaw::arruda_boyce:
      m.own.beta1 = random.between(0, 0.2);
      m.own.beta2 = random.between(0, 0.03);
      break;
    case MaterialLaw::ogden:
      m.own.terms = {{mu, 2}};
      if (random.chance(0.7)) m.own.terms = {{0.6 * mu, 1.3}, {0.01 * mu, 5}, {-0.1 * mu, -2}};
      if (random.chance(0.1)) m.own.terms = {{mu / 8, 16}, {-mu / 10, -10}};
      break;
    case MaterialLaw::stvk_resistant:
      m.own.resistance = mu * random.decades(-1, 3);
      break;
    case MaterialLaw::isochoric_extended:
      m.own.threshold = random.pick({0.1, 0.3, 0.01});
      break;
    default:
      break;
  }
}

void draw_constants_of_invariants(ChaosRandom& random, LawConstants& c, MaterialLaw law, double mu) {
  switch (law) {
    case MaterialLaw::yeoh:
    case MaterialLaw::isochoric_yeoh:
      c.c = {0.5 * mu};
      if (random.chance(0.7)) c.c.push_back(mu * random.pick({-0.02, -0.001, 0.01, 0.1}));
      if (c.c.size() == 2 && random.chance(0.7)) c.c.push_back(mu * random.pick({0.0, 1e-4, 1e-2}));
      break;
    case MaterialLaw::gent:
    case MaterialLaw::isochoric_gent:
      c.jm = random.pick({0.5, 5.0, 50.0, 500.0});
      break;
    case MaterialLaw::veronda_westmann:
    case MaterialLaw::isochoric_veronda_westmann:
      c.c2 = random.pick({0.01, 0.5, 5.0});
      c.c1 = mu / c.c2;
      break;
    case MaterialLaw::holmes_mow:
    case MaterialLaw::isochoric_holmes_mow:
      c.beta = random.pick({0.0, 0.1, 1.0});
      break;
    case MaterialLaw::isochoric_mooney_rivlin:
      c.c1 = random.pick({-0.1, 0.25, 0.5, 0.7}) * mu;
      c.c2 = 0.5 * mu - c.c1;
      if (random.chance(0.4)) c.c20 = mu * random.pick({-0.01, 0.01, 0.1});
      if (random.chance(0.3)) c.c11 = 0.01 * mu;
      if (random.chance(0.3)) c.c02 = 0.01 * mu;
      break;
    case MaterialLaw::isochoric_fung:
      c.mu0 = random.between(0.1, 1) * mu;
      c.mu1 = random.decades(-2, 1);
      c.gamma = mu * random.between(0, 0.5);
      break;
    case MaterialLaw::isochoric_arruda_boyce:
      c.locking_stretch = random.pick({1.2, 2.0, 5.0});
      break;
    case MaterialLaw::isochoric_ogden:
      c.terms = {{mu / 4, 2}, {mu / 6, random.pick({-3.0, 1.3, 8.0})}};
      break;
    default:
      break;
  }
}

// Laws of invariants, which came later: drawn by a sequence of their own, which leaves other draws as they
// were.
void draw_law_of_invariants(ChaosRandom& random, MaterialDef& m, double young) {
  double poisson = m.constants.poisson;
  m.law = static_cast<MaterialLaw>(
      random.whole(static_cast<int>(MaterialLaw::yeoh), static_cast<int>(MaterialLaw::isochoric_holmes_mow)));
  const bool full = m.law < MaterialLaw::isochoric_mooney_rivlin;
  if (full && poisson < 0.45) poisson = random.pick({0.45, 0.49, 0.5});
  m.constants = {};
  m.constants.poisson = poisson;
  m.own = {};
  using enum MaterialLaw;
  const bool by_mu = m.law == gent || m.law == isochoric_gent || m.law == holmes_mow ||
                     m.law == isochoric_holmes_mow || m.law == isochoric_arruda_boyce;
  if (by_mu) m.constants.mu = young / 3;
  if (m.law != holmes_mow) {
    m.own.volume_energy =
        random.pick({VolumeEnergyWord::by_law, VolumeEnergyWord::by_law, VolumeEnergyWord::quadratic,
                     VolumeEnergyWord::logarithmic, VolumeEnergyWord::mixed});
  }
  draw_constants_of_invariants(random, m.own, m.law, young / 3);
}

MaterialDef draw_material(ChaosRandom& random, const ChaosDraft& draft, DraftBody& body, double poisson) {
  MaterialDef m;
  if (random.chance(0.7)) m.law = static_cast<MaterialLaw>(random.whole(0, 14));
  // Their own constants leave no room for smaller ratios.
  if ((m.law == MaterialLaw::fung || m.law == MaterialLaw::mooney_rivlin ||
       m.law == MaterialLaw::arruda_boyce) &&
      poisson < 0.49)
    poisson = random.pick({0.49, 0.5});
  const double contrast = random.chance(0.8) ? random.between(0.5, 2) : random.decades(-4, 4);
  const double young = draft.young * contrast;
  m.constants.young = young;
  m.constants.poisson = poisson;
  const bool own =
      m.law == MaterialLaw::mooney_rivlin || m.law == MaterialLaw::fung || m.law == MaterialLaw::ogden;
  if (own || m.law == MaterialLaw::arruda_boyce) m.constants.young = 0;
  if (m.law == MaterialLaw::arruda_boyce) m.constants.mu = young / 3;
  draw_own_constants(random, m, young);
  if (!own && m.law != MaterialLaw::arruda_boyce && random.chance(0.05))
    m.constants.bulk_choice = BulkChoice::bulk_modulus;
  if (random.chance(0.12)) {
    SceneFibers fibers;
    fibers.direction = random.direction();
    fibers.k1 = young * random.decades(-2, 2);
    fibers.k2 = random.pick({0.0, 1.0, 10.0});
    fibers.dispersion = random.pick({0.0, 0.0, 0.1, 0.333});
    m.fibers = {fibers};
  }
  if (random.chance(0.1)) {
    m.compression_penalty.modulus = young * random.decades(-2, 2);
    m.compression_penalty.beta = random.pick({0.0, 9.0, 100.0});
  }
  m.density = draft.density * (random.chance(0.9) ? 1 : random.decades(-2, 2));
  body.young = std::min(body.young, young);
  return m;
}

// By a sequence of its own, as laws of invariants.
void draw_memory(const ChaosDraft& draft, const std::string& region, MaterialDef& m) {
  ChaosRandom random = draft.random("memory " + std::to_string(draft.bodies.size()) + " " + region);
  const bool isochoric =
      m.law == MaterialLaw::isochoric_neo_hookean ||
      (m.law >= MaterialLaw::isochoric_mooney_rivlin && m.law <= MaterialLaw::isochoric_holmes_mow);
  if (!isochoric || m.poisson_field.given()) return;
  if (!random.chance(0.4)) {
    // Softening has a sequence of its own.
    ChaosRandom later = draft.random("softening " + std::to_string(draft.bodies.size()) + " " + region);
    if (later.chance(0.5))
      m.mullins =
          MullinsSoftening{later.between(1.05, 4), later.chance(0.5) ? draft.young * later.decades(-3, 1) : 0,
                           later.between(0.01, 1)};
    return;
  }
  const int terms = random.whole(1, 3);
  for (int i = 0; i < terms; ++i)
    m.prony.push_back({random.between(0.01, 0.9) / terms, draft.duration * random.decades(-3, 3)});
  if (random.chance(0.5)) m.static_time = StaticTime::seconds;
}

void draw_materials(ChaosRandom& random, const ChaosDraft& draft, SceneBody& def, DraftBody& body) {
  const bool same = random.chance(0.7);
  const double poisson = random.chance(0.45) ? 0.5 : kPoissons[random.whole(0, 6)];
  body.young = draft.young * 1e6;
  body.incompressible = true;
  for (const std::string& region : body.regions) {
    double own = same ? poisson : (random.chance(0.45) ? 0.5 : kPoissons[random.whole(0, 6)]);
    MaterialDef m = draw_material(random, draft, body, own);
    ChaosRandom later =
        draft.random("law of invariants " + std::to_string(draft.bodies.size()) + " " + region);
    if (later.chance(0.3)) draw_law_of_invariants(later, m, draft.young);
    m.region = body.regions.size() > 1 ? region : "";
    const bool fields = body.regions.size() == 1 && body.cells > 0;
    if (fields && random.chance(0.08)) {
      for (int c = 0; c < body.cells; ++c) m.stiffness_field.values.push_back(random.decades(-1, 1));
    }
    if (fields && m.constants.young > 0 && random.chance(0.06)) {
      for (int c = 0; c < body.cells; ++c)
        m.poisson_field.values.push_back(random.pick({0.3, 0.45, 0.49, 0.4999}));
      m.constants.poisson = 0;
      own = 0.4999;
    }
    draw_memory(draft, region, m);
    body.incompressible = body.incompressible && own == 0.5;
    def.materials.push_back(std::move(m));
  }
}

void describe(const Mesh& mesh, DraftBody& body) {
  body.lower = body.upper = mesh.nodes.front();
  for (const Vec3& x : mesh.nodes) {
    for (int k = 0; k < 3; ++k) {
      body.lower[k] = std::min(body.lower[k], x[k]);
      body.upper[k] = std::max(body.upper[k], x[k]);
    }
  }
  body.regions = mesh.regions;
  body.cells = mesh.cell_count();
  body.nodes = mesh.nodes;
}

CellType cells_of(Element element, ChaosRandom& random) {
  if (element == Element::hex8) return CellType::hex8;
  return element == Element::tet10 && random.chance(0.6) ? CellType::tet10 : CellType::tet4;
}

Vec3 draw_size(ChaosRandom& random, double length) {
  if (random.chance(0.15))
    return {length, length * random.between(0.05, 0.3), length * random.between(0.05, 0.3)};
  if (random.chance(0.1)) return {length, length, length * random.between(0.05, 0.2)};
  return {length, length * random.between(0.4, 1.2), length * random.between(0.4, 1.2)};
}

void generated_box(ChaosRandom& random, const ChaosDraft& draft, SceneBody& def, DraftBody& body,
                   const Vec3& at) {
  BoxMeshDef box;
  box.lower = at;
  box.upper = at + draw_size(random, draft.length);
  box.cell_type = def.element == Element::hex8 ? CellType::hex8 : CellType::tet4;
  const int per = box.cell_type == CellType::hex8 ? 1 : 6;
  for (int tries = 0; tries < 8; ++tries) {
    auto larger = box.divisions;
    ++larger[static_cast<std::size_t>(random.whole(0, 2))];
    if (per * larger[0] * larger[1] * larger[2] <= draft.size.largest_cells) box.divisions = larger;
  }
  def.mesh = box;
  body.lower = box.lower;
  body.upper = box.upper;
  body.regions = {"body"};
  body.surfaces = {"x0", "x1", "y0", "y1", "z0", "z1"};
  body.cells = per * box.divisions[0] * box.divisions[1] * box.divisions[2];
  if (const auto mesh = box_mesh(box)) body.nodes = mesh.value().nodes;
}

void random_mesh(ChaosRandom& random, ChaosDraft& draft, SceneBody& def, DraftBody& body, const Vec3& at) {
  ChaosMeshKind kind;
  kind.cell_type = cells_of(def.element, random);
  kind.largest_cells = draft.size.largest_cells;
  kind.size = draw_size(random, draft.length);
  kind.chamber = random.chance(0.4);
  const ChaosMesh made = chaos_mesh(kind, random);
  describe(made.mesh, body);
  body.lower += at;
  body.upper += at;
  for (Vec3& x : body.nodes) x += at;
  body.surfaces = made.surfaces;
  const bool walls = std::find(made.surfaces.begin(), made.surfaces.end(), "chamber") != made.surfaces.end();
  if (made.chamber && walls) body.chamber = "chamber";
  MeshFile file;
  file.path = def.name + ".msh";
  file.offset = at;
  def.mesh = file;
  draft.out.files.push_back({file.path, gmsh_text(made.mesh)});
}

// A mesh of the library, scaled to the length of the scene. False: none fits.
bool library_mesh(ChaosRandom& random, ChaosDraft& draft, SceneBody& def, DraftBody& body, const Vec3& at) {
  const CellType wanted = cells_of(def.element, random);
  std::vector<const LibraryMesh*> fitting;
  for (const LibraryMesh& m : kLibraryMeshes) {
    if (m.type == wanted && m.cells <= 4 * draft.size.largest_cells) fitting.push_back(&m);
  }
  if (fitting.empty()) return false;
  const std::string path = scenes_folder() + "/meshes/" + random.pick(fitting)->name + ".msh";
  const auto mesh = read_mesh(path);
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!mesh || text.empty()) return false;
  describe(mesh.value(), body);
  MeshFile file;
  file.path = def.name + ".msh";
  const double extent = body.upper.x - body.lower.x;
  file.scale = extent > 0 ? draft.length / extent : 1;
  file.offset = at - file.scale * body.lower;
  for (Vec3& x : body.nodes) x = at + file.scale * (x - body.lower);
  body.upper = at + file.scale * (body.upper - body.lower);
  body.lower = at;
  for (const MeshSurface& s : mesh.value().surfaces) body.surfaces.push_back(s.name);
  def.mesh = file;
  draft.out.files.push_back({file.path, text});
  return true;
}

void lattice(ChaosRandom& random, ChaosDraft& draft, SceneBody& def, DraftBody& body, const Vec3& at) {
  def.element = Element::hex8;
  LatticeMesh mesh;
  const Vec3 size = draw_size(random, draft.length);
  mesh.surface = draft.add_surface_file(random, def.name, size);
  mesh.offset = at + 0.5 * size;
  mesh.spacing = std::min({size.x, size.y, size.z}) / random.between(1.5, 3.5);
  mesh.samples = random.whole(2, 4);
  def.mesh = mesh;
  // Its cubes stand out of the surface.
  const Vec3 margin{mesh.spacing, mesh.spacing, mesh.spacing};
  body.lower = at - margin;
  body.upper = at + size + margin;
  body.regions = {"body"};
}

}  // namespace

std::string ChaosDraft::add_surface_file(ChaosRandom& random, const std::string& name, const Vec3& extent) {
  const Vec3 h = 0.5 * extent;
  std::string text;
  const auto point = [&text](const Vec3& x) {
    char line[100];
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", x.x, x.y, x.z);
    text += line;
  };
  if (random.chance(0.5)) {  // an octahedron
    for (const double s : {-1.0, 1.0}) {
      point({s * h.x, 0, 0});
      point({0, s * h.y, 0});
      point({0, 0, s * h.z});
    }
    // 1 -x, 2 -y, 3 -z, 4 x, 5 y, 6 z
    text += "f 4 5 6\nf 5 1 6\nf 1 2 6\nf 2 4 6\nf 5 4 3\nf 1 5 3\nf 2 1 3\nf 4 2 3\n";
  } else {  // a box
    for (int c = 0; c < 8; ++c)
      point({(c & 1) != 0 ? h.x : -h.x, (c & 2) != 0 ? h.y : -h.y, (c & 4) != 0 ? h.z : -h.z});
    text +=
        "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 "
        "8\nf 2 8 6\n";
  }
  out.files.push_back({name + ".obj", text});
  return name + ".obj";
}

void draft_bodies(ChaosDraft& draft) {
  ChaosRandom random = draft.random("bodies");
  const int count = random.pick({1, 1, 1, 1, 1, 1, 2, 2, 2, 3});
  Vec3 at{};
  if (random.chance(0.1)) at = {1e3 * draft.length, -2e3 * draft.length, 5e2 * draft.length};
  bool flush = false;
  for (int b = 0; b < count; ++b) {
    SceneBody def;
    DraftBody body;
    def.name = "body" + std::to_string(b);
    def.element = random.pick({Element::tet4_edge_smoothed, Element::tet4_edge_smoothed, Element::tet4,
                               Element::tet4, Element::tet10, Element::hex8});
    const int kind = random.whole(0, 9);
    if (kind == 0) {
      lattice(random, draft, def, body, at);
    } else if (kind <= 3) {
      generated_box(random, draft, def, body, at);
    } else if (kind > 4 || !draft.size.library_meshes || !library_mesh(random, draft, def, body, at)) {
      random_mesh(random, draft, def, body, at);
    }
    body.tetrahedra = def.element != Element::hex8;
    draw_materials(random, draft, def, body);
    if (def.element == Element::tet4_edge_smoothed && random.chance(0.15)) {
      def.guard_stiffness = random.pick({0.0, 0.1, 1.0, 10.0});
      def.guard_threshold = random.pick({0.5, 0.2, 0.9});
    }
    if (draft.dynamic && random.chance(0.25)) {
      const double speed = draft.length / draft.duration;
      def.velocity = speed * random.decades(-2, 1) * random.direction();
      if (random.chance(0.4))
        def.angular_velocity = (random.decades(-2, 1) / draft.duration) * random.direction();
    }
    // The next one stands on it, a little above it, or beside it.
    const double gap = random.pick({0.0, 0.0, 0.001, 0.05}) * draft.length;
    at = {body.lower.x, body.lower.y, body.upper.z + gap};
    if (body.nodes.empty()) at += {draft.length, 0, 0.1 * draft.length};
    draft.scene().bodies.push_back(std::move(def));
    body.stands_on_last = flush && !body.nodes.empty();
    flush = gap == 0 && !body.nodes.empty();
    draft.bodies.push_back(std::move(body));
  }
}

namespace {

void draw_space(ChaosRandom& random, const DraftBody& body, VolumeDef& def) {
  def.space = random.pick({VolumeSpace::node, VolumeSpace::element, VolumeSpace::element, VolumeSpace::body,
                           VolumeSpace::body, VolumeSpace::ring, VolumeSpace::zone});
  if (def.space == VolumeSpace::ring) def.rings = random.whole(1, 2);
  if (def.space == VolumeSpace::zone) {
    VolumeZone low, high;
    low.name = "low";
    high.name = "high";
    const Vec3 size = body.upper - body.lower;
    Vec3 middle = body.lower + random.between(0.3, 0.7) * size;
    low.boxes = {{body.lower - size, Vec3{middle.x, body.upper.y + size.y, body.upper.z + size.z}}};
    if (random.chance(0.3)) middle.x -= 0.2 * size.x;  // overlapping
    high.boxes = {{Vec3{middle.x, body.lower.y - size.y, body.lower.z - size.z}, body.upper + size}};
    low.compliance = random.pick({1.0, 1.0, 1.0, 1.0, 0.0, 10.0});
    def.zones = {low, high};
  }
  if (def.space == VolumeSpace::body || def.space == VolumeSpace::zone)
    def.across_regions = random.chance(0.6);
}

}  // namespace

void draft_volumes(ChaosDraft& draft) {
  ChaosRandom random = draft.random("volumes");
  if (random.chance(0.4)) return;  // nodal rows on every body
  std::vector<VolumeRows> all;
  for (std::size_t b = 0; b < draft.bodies.size(); ++b) {
    VolumeRows rows;
    VolumeDef& def = rows.def;
    def.name = "volume" + std::to_string(b);
    def.body = static_cast<BodyId>(b);
    if (random.chance(0.6)) draw_space(random, draft.bodies[b], def);
    if (random.chance(0.25)) def.strain = VolumeStrain::logarithmic;
    if (random.chance(0.15)) def.stabilization = random.pick({0.0, 0.1, 10.0});
    if (random.chance(0.1)) def.hard = true;
    if (random.chance(0.1)) def.treatment = static_cast<RowTreatment>(random.whole(0, 5));
    const bool soft =
        std::none_of(draft.scene().bodies[b].materials.begin(), draft.scene().bodies[b].materials.end(),
                     [](const MaterialDef& m) { return m.constants.poisson == 0.5; });
    if (soft && !def.hard && def.space == VolumeSpace::node && random.chance(0.1))
      def.lumped_compliance = true;
    rows.none = soft && random.chance(0.35);
    all.push_back(std::move(rows));
  }
  draft.scene().volumes = std::move(all);
}

}  // namespace isochor::studies
