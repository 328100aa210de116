// The stretch test of Smith, de Goes & Kim 2018, section 6 (Fig. 5 and 6): a cylinder of cubes is pulled
// to 3.4 times its length, its ends held, and what volume it gains or loses is compared between material
// models.
//
//   isochor_bench_stretch [--radius 13] [--steps 12] [--stretch 3.4] [--only "part of a name"]
//
// One eighth of the cylinder by symmetry, `radius` cubes across its radius and twice that along its half
// length. Prints Newton iterations of all steps and the volume at the end. Counts and volumes, no seconds.
//
// Two of the models have a stress but no energy. The engine does not run such; here they go through a Newton
// method of their own (bench/residual_newton.h) that looks at residuals alone.
#include <cstring>

#include "bench/residual_newton.h"
#include "bench/robustness_cases.h"
#include "materials/stress_baselines.h"
#include "options.h"

namespace {

using namespace isochor;
using robustness::must;

// Cubes whose centers lie within the cylinder; the axis is z.
Mesh cylinder_of_cubes(int radius, int length) {
  Mesh mesh;
  mesh.cell_type = CellType::hex8;
  mesh.source = "cylinder of cubes";
  const int across = radius + 1;
  std::vector<Index> number(static_cast<std::size_t>(across * across * (length + 1)), -1);
  const auto node = [&](int i, int j, int k) {
    Index& n = number[static_cast<std::size_t>(i + across * (j + across * k))];
    if (n < 0) {
      n = mesh.node_count();
      mesh.nodes.push_back((1.0 / radius) * Vec3{1.0 * i, 1.0 * j, 1.0 * k});
    }
    return n;
  };
  for (int k = 0; k < length; ++k) {
    for (int j = 0; j < radius; ++j) {
      for (int i = 0; i < radius; ++i) {
        if ((i + 0.5) * (i + 0.5) + (j + 0.5) * (j + 0.5) > radius * radius) continue;
        for (const int top : {0, 1}) {
          for (const auto& [a, b] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
            mesh.cells.push_back(node(i + a, j + b, k + top));
        }
      }
    }
  }
  return mesh;
}

constexpr double kFar = 1e9, kThin = 1e-9;

// Symmetry planes at x = y = z = 0, the end at z = `end` held and moved along z.
std::vector<EffectPtr> supports(BodyId body, double end, double move) {
  std::vector<EffectPtr> out;
  for (int axis = 0; axis < 3; ++axis) {
    DirichletDef d;
    d.name = std::string("plane ") + "xyz"[axis];
    d.where.body = body;
    Vec3 low{-kFar, -kFar, -kFar}, high{kFar, kFar, kFar}, direction{};
    low[axis] = -kThin, high[axis] = kThin, direction[axis] = 1;
    d.where.boxes = {{low, high}};
    d.directions = {direction};
    out.push_back(dirichlet(d));
  }
  // The end: along z it moves, across it is held where no plane of symmetry holds it already.
  for (int axis = 0; axis < 3; ++axis) {
    DirichletDef d;
    d.name = std::string("end ") + "xyz"[axis];
    d.where.body = body;
    Vec3 low{-kFar, -kFar, end - kThin}, high{kFar, kFar, end + kThin}, direction{};
    if (axis < 2) low[axis] = kThin;
    direction[axis] = 1;
    d.where.boxes = {{low, high}};
    d.directions = {direction};
    if (axis == 2) d.displacement = {0, 0, move};
    d.amount = Curve::ramp(1);
    out.push_back(dirichlet(d));
  }
  return out;
}

struct Run {
  int iterations = 0, corrections = 0;
  double reached = 1;  // stretch
  double volume = 0, min_J = 0;
  std::string reason;
};

struct Setting {
  int radius = 13, steps = 12;
  double stretch = 3.4;
  double end() const { return 2; }
  Mesh mesh() const { return cylinder_of_cubes(radius, 2 * radius); }
};

Run run_in_engine(const Setting& s, const MaterialPtr& material, std::optional<VolumeSpace> rows) {
  WorldOptions options;
  options.scheme = statics();
  options.threads = 1;
  options.force_tolerance = 1e-6;
  options.smallest_fraction = 0.25;
  World world = must(World::create(options));
  BodyDef def;
  def.mesh = s.mesh();
  def.element = Element::hex8;
  def.materials = {{"", material, 1}};
  const BodyId body = must(world.add_body(def));
  if (rows) {
    VolumeDef volume_def;
    volume_def.body = body;
    volume_def.space = *rows;
    must(world.add(volume(volume_def)));
  }
  for (const EffectPtr& e : supports(body, s.end(), (s.stretch - 1) * s.end())) must(world.add(e));
  Run run;
  for (int i = 0; i < s.steps && run.reason.empty(); ++i) {
    const StepReport r = world.advance(1.0 / s.steps);
    run.iterations += r.iterations;
    run.corrections += r.corrections;
    if (r.status != StepStatus::converged) run.reason = r.reason;
  }
  const BodyMeasures m = world.measures(body);
  run.reached = 1 + (s.stretch - 1) * world.time();
  run.volume = m.volume / m.rest_volume - 1;
  run.min_J = m.min_J;
  return run;
}

ElasticConstants constants() {
  ElasticConstants c;
  c.young = 1;
  c.poisson = 0.49;
  return c;
}

// Stress of Irving, Teran & Fedkiw 2004, tangent of the energy at the filtered stretches.
class Filtered final : public residual_newton::StressOnly {
 public:
  std::string_view name() const override { return "filtered"; }
  void stress(const Lanes F[9], Lanes P[9]) const override {
    filtered_neo_hookean_stress(mu_, lambda_, kThreshold, F, P);
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    Svd3 clamped = svd;
    for (Lanes& s : clamped.sigma) s = larger(s, broadcast(kThreshold));
    energy_->spectrum(points, clamped, out);
  }

 private:
  static constexpr double kThreshold = 0.25;  // of the paper
  double mu_ = 1 / (2 * 1.49), lambda_ = 0.49 / (1.49 * 0.02);
  std::shared_ptr<const Material> energy_ = must(must(neo_hookean(constants()))->complete());
};

// mu J^(-2/3) F + K (J - 1) cof F, tangent of the isochoric energy that it simplifies.
class Simplified final : public residual_newton::StressOnly {
 public:
  std::string_view name() const override { return "simplified"; }
  void stress(const Lanes F[9], Lanes P[9]) const override {
    simplified_isochoric_stress(mu_, F, P);
    Lanes g[9];
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        g[3 * i + j] = F[3 * i1 + j1] * F[3 * i2 + j2] - F[3 * i1 + j2] * F[3 * i2 + j1];
      }
    }
    const Lanes J = F[0] * g[0] + F[1] * g[1] + F[2] * g[2];
    // Free of stress at rest: the mean of mu J^(-2/3) F there is taken out with the pressure.
    const Lanes p = bulk_ * (J - 1) - mu_;
    for (int i = 0; i < 9; ++i) P[i] += p * g[i];
  }
  void spectrum(const PointBatch& points, const Svd3& svd, Spectrum& out) const override {
    energy_->spectrum(points, svd, out);
  }

 private:
  double mu_ = 1 / (2 * 1.49), bulk_ = 1 / (3 * 0.02);
  std::shared_ptr<const Material> energy_ = must(must(isochoric_neo_hookean(constants()))->complete());
};

Run run_by_residuals(const Setting& s, std::shared_ptr<const Material> material) {
  residual_newton::Solver solver(s.mesh(), std::move(material),
                                 supports(BodyId{0}, s.end(), (s.stretch - 1) * s.end()));
  Run run;
  double before = 1;
  for (int i = 1; i <= s.steps; ++i) {
    // Everything along with the end: the other models' line search needs no such guess.
    const double now = 1 + (s.stretch - 1) * i / s.steps;
    for (Vec3& x : solver.x()) x.z *= now / before;
    const auto [iterations, converged] = solver.solve(1.0 * i / s.steps, 1e-6, 100);
    run.iterations += iterations;
    if (!converged) {
      run.reason = "residuals do not fall";
      break;
    }
    before = run.reached = now;
  }
  const BodyMeasures m = solver.measures();
  run.volume = m.volume / m.rest_volume - 1;
  run.min_J = m.min_J;
  return run;
}

int number_after(int argc, char** argv, const char* flag, int otherwise) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], flag) == 0) return std::atoi(argv[i + 1]);
  }
  return otherwise;
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {}, {"--radius", "--steps", "--stretch", "--only"});
  Setting setting;
  setting.radius = number_after(argc, argv, "--radius", 13);
  setting.steps = number_after(argc, argv, "--steps", 12);
  std::string only;
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], "--stretch") == 0) setting.stretch = std::atof(argv[i + 1]);
    if (std::strcmp(argv[i], "--only") == 0) only = argv[i + 1];
  }
  const auto law = [](Result<MaterialPtr> (*make)(const ElasticConstants&), double poisson) {
    ElasticConstants c = constants();
    c.poisson = poisson;
    return must(make(c));
  };
  const auto energy = [&](Result<MaterialPtr> (*make)(const ElasticConstants&)) {
    return [&, make] { return run_in_engine(setting, law(make, 0.49), std::nullopt); };
  };
  const auto mixed = [&](double poisson, VolumeSpace space) {
    return [&, poisson, space] { return run_in_engine(setting, law(stable_neo_hookean, poisson), space); };
  };
  const std::pair<const char*, std::function<Run()>> models[] = {
      {"plain corotated", energy(corotated)},
      {"fixed corotated", energy(fixed_corotated)},
      {"filtered neo-Hookean", [&] { return run_by_residuals(setting, std::make_shared<Filtered>()); }},
      {"simplified isochoric", [&] { return run_by_residuals(setting, std::make_shared<Simplified>()); }},
      {"stable neo-Hookean", energy(stable_neo_hookean)},
      {"stable neo-Hookean, element rows", mixed(0.49, VolumeSpace::element)},
      {"stable neo-Hookean, nodal rows", mixed(0.49, VolumeSpace::node)},
      {"element rows, nu = 0.5", mixed(0.5, VolumeSpace::element)},
      {"nodal rows, nu = 0.5", mixed(0.5, VolumeSpace::node)},
  };
  std::printf("Cylinder of %d hexahedra in all, stretched to %g in %d steps\n",
              8 * static_cast<int>(setting.mesh().cell_count()), setting.stretch, setting.steps);
  std::fflush(stdout);
  std::printf("%-36s %16s %9s %12s %8s\n", "model", "iterations", "stretch", "volume", "min J");
  for (const auto& [name, run] : models) {
    if (std::string(name).find(only) == std::string::npos) continue;
    const Run r = run();
    const std::string counts = std::to_string(r.iterations) + " + " + std::to_string(r.corrections);
    std::printf("%-36s %16s %9.2f %+11.2e%% %8.3f  %s\n", name, counts.c_str(), r.reached, 100 * r.volume,
                r.min_J, r.reason.c_str());
    std::fflush(stdout);
  }
  return 0;
}
