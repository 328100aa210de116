// What a material costs at one point: nanoseconds per deformation gradient for psi, P, A, and A made definite
// together with a volume row; and singular values alone. One thread, batches of eight, data in cache.
//
//   isochor_bench_materials [--repeats N]
//
// Then what elements cost around it: forces and Hessians of 39,600 Tet4 with a volume row each, and of the
// edge patches of the same mesh, with the memory that an evaluation reads and writes.
//
// Prints minimum and median over the repeats, the first one left out, and a checksum of the answers.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "engine/elements/material_model.h"
#include "engine/elements/reference_element.h"
#include "engine/elements/solid_pool.h"
#include "isochor/generate.h"
#include "isochor/materials.h"
#include "options.h"

namespace {

using namespace isochor;

constexpr int kBatches = 64;  // 512 points: 300 kB of answers

std::vector<PointBatch> points() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-0.3, 0.3);
  std::vector<PointBatch> out(kBatches);
  for (PointBatch& b : out) {
    for (int l = 0; l < kLanes; ++l) {
      for (int i = 0; i < 9; ++i) b.F[i][l] = (i % 4 == 0 ? 1 : 0) + unit(random);
      b.element[l] = 0;
    }
  }
  return out;
}

struct Timing {
  double least, median;  // [ns] a point
};

Timing measure(int repeats, const std::function<void()>& all) {
  std::vector<double> times;
  for (int r = 0; r <= repeats; ++r) {
    const auto start = std::chrono::steady_clock::now();
    all();
    const std::chrono::duration<double, std::nano> d = std::chrono::steady_clock::now() - start;
    if (r > 0) times.push_back(d.count() / (kBatches * kLanes));
  }
  std::sort(times.begin(), times.end());
  return {times.front(), times[times.size() / 2]};
}

MaterialPtr must(Result<MaterialPtr> r) {
  if (!r) {
    std::fprintf(stderr, "%s\n", r.error().c_str());
    std::exit(2);
  }
  return std::move(r).value();
}

FiberFamily isochoric_fibers(FiberLaw law) {
  FiberFamily f;
  f.direction = {1, 1, 0};
  f.k1 = 5e4;
  f.k2 = 1.5;
  f.law = law;
  f.isochoric = true;
  if (law == FiberLaw::toe) f.straight_stretch = 1.2, f.straight_modulus = 1e5;
  return f;
}

std::vector<MaterialPtr> shelf() {
  ElasticConstants c;
  c.young = 1e5;
  c.poisson = 0.45;
  return {
      must(neo_hookean(c)),
      must(neo_hookean_ogden(c)),
      must(stable_neo_hookean(c)),
      must(stable_neo_hookean_barrier(c)),
      must(isochoric_neo_hookean(c)),
      must(isochoric_extended(c)),
      must(mooney_rivlin({2e4, 1e4, 0.45})),
      must(fung({2e4, 0.3, 4e4, 0.45})),
      must(arruda_boyce({3e4, 0.02, 0.001, 0.45})),
      must(ogden({{{6e4, 1.3}, {1e3, 5}, {-1e4, -2}}, 0.45})),
      must(isochoric_mooney_rivlin({2e4, 1e4, 0.45, 1e3, 1e3, 1e3, {}})),
      must(yeoh({{2e4, -1e2, 1e1}, 0.45, {}})),
      must(isochoric_yeoh({{2e4, -1e2, 1e1}, 0.45, {}})),
      must(isochoric_fung({2e4, 0.3, 4e4, 0.45, {}})),
      must(isochoric_arruda_boyce({3e4, 0.02, 0.001, 0.45, 0, 0, 0, {}})),
      must(gent({3e4, 90, 0.45, {}})),
      must(isochoric_gent({3e4, 90, 0.45, {}})),
      must(veronda_westmann({6e4, 0.5, 0.45, {VolumeEnergy::logarithmic, -1}})),
      must(isochoric_veronda_westmann({6e4, 0.5, 0.45, {}})),
      must(holmes_mow({3e4, 0.5, 0.45})),
      must(isochoric_holmes_mow({3e4, 0.5, 0.45})),
      must(isochoric_ogden({{{6e4, 1.3}, {1e3, 5}, {-1e4, -2}}, 0.45})),
      must(corotated(c)),
      must(fixed_corotated(c)),
      must(stvk(c)),
      must(stvk_resistant(c, 1e6)),
      must(linear(c)),
      must(with_fibers(must(neo_hookean(c)), {{{1, 1, 0}, 5e4, 1.5, 0, {}}})),
      must(with_fibers(must(isochoric_yeoh({{2e4}, 0.45, {}})), {isochoric_fibers(FiberLaw::exponential)})),
      must(with_fibers(must(isochoric_yeoh({{2e4}, 0.45, {}})), {isochoric_fibers(FiberLaw::toe)}))};
}

// Slots of a pool, as the assembly holds them.
struct Slots {
  std::vector<double> energy, value, multiplier;
  std::vector<Vec3> gradient, jacobian;
  std::vector<Mat3> hessian;
  explicit Slots(const SolidPool& pool)
      : energy(at(pool.stencils())),
        value(at(pool.stencils() * pool.functions())),
        multiplier(value.size(), -3e3),
        gradient(pool.nodes().item.size()),
        jacobian(gradient.size() * static_cast<std::size_t>(pool.functions())),
        hessian(static_cast<std::size_t>(pool.hessian_offset().back())) {}
  StencilSlots spans() { return {energy, value, gradient, jacobian, hessian}; }
};

double megabytes(const SolidPool& pool, const Slots& s) {
  const double nodes = static_cast<double>(pool.nodes().item.size());
  const double read = nodes * (sizeof(Index) + 3 * sizeof(Vec3)) + 8.0 * static_cast<double>(s.energy.size());
  const double write = static_cast<double>((s.gradient.size() + s.jacobian.size()) * sizeof(Vec3) +
                                           s.hessian.size() * sizeof(Mat3) + 16 * s.energy.size());
  return (read + write) / 1e6;
}

void bench_elements(int repeats) {
  auto mesh = box_mesh({{0, 0, 0}, {1, 0.15, 0.15}, {66, 10, 10}, CellType::tet4});
  if (!mesh) std::exit(2);
  const Mesh& m = mesh.value();
  std::vector<Index> cells(static_cast<std::size_t>(m.cell_count()));
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = static_cast<Index>(c);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-2e-3, 2e-3);
  std::vector<Vec3> x = m.nodes;
  for (Vec3& p : x) p += Vec3{unit(random), unit(random), unit(random)};
  ElasticConstants c;
  c.young = 1e5;
  c.poisson = 0.5;
  const auto material = must(stable_neo_hookean(c))->distortional();
  auto tets = solid_data(tet4_element(), m.nodes, m.cells, cells, VolumeFunctions::constant);
  auto patches = edge_patch_data(m.nodes, m.cells, cells);
  if (!tets || !patches) std::exit(2);
  const SolidPool pools[] = {
      {"tet4", std::make_shared<const SolidData>(std::move(tets).value()), material, VolumeStrain::linear},
      {"edge patches", std::make_shared<const SolidData>(std::move(patches).value()), material,
       VolumeStrain::linear}};
  std::printf("%-28s %14s %14s %14s %14s   ms an evaluation, least (median)\n", "elements", "energy",
              "forces", "Hessians", "definite");
  for (const SolidPool& pool : pools) {
    Slots slots(pool);
    const auto run = [&](Want want, Definiteness policy) {
      const StencilRequest request{want, policy, 0, pool.stencils(), x, m.nodes, slots.multiplier};
      Timing t = measure(repeats, [&] { pool.evaluate(request, slots.spans()); });
      const double scale = kBatches * kLanes * 1e-6;
      std::printf(" %6.2f (%5.2f)", t.least * scale, t.median * scale);
    };
    std::printf("%-14s %13d", std::string(pool.name()).c_str(), pool.stencils());
    run(Want::value, Definiteness::exact);
    run(Want::gradient, Definiteness::exact);
    run(Want::hessian, Definiteness::exact);
    run(Want::hessian, Definiteness::projected);
    std::printf("   %.1f MB\n", megabytes(pool, slots));
  }
}

}  // namespace

int main(int argc, char** argv) {
  isochor::bench::check_options(argc, argv, {}, {"--repeats"});
  int repeats = 200;
  for (int i = 1; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], "--repeats") == 0) repeats = std::max(1, std::atoi(argv[i + 1]));
  }
  const std::vector<PointBatch> in = points();
  std::vector<ResponseBatch> out(kBatches);
  std::vector<Svd3> svds(kBatches);
  const auto decompose = [&](int b) {
    Lanes F[9];
    for (int i = 0; i < 9; ++i) F[i] = load(in[static_cast<std::size_t>(b)].F[i]);
    svd3(F, svds[static_cast<std::size_t>(b)]);
  };
  const Timing svd = measure(repeats, [&] {
    for (int b = 0; b < kBatches; ++b) decompose(b);
  });
  std::printf("ns a point, least (median) of %d; %zu-byte vectors, %s\n", repeats, sizeof(Lanes),
              __VERSION__);
  std::printf("%-28s %13.1f (%.1f)\n", "singular values", svd.least, svd.median);
  std::printf("%-28s %14s %14s %14s %18s\n", "complete energies", "psi", "P", "A", "A, definite");
  for (const MaterialPtr& model : shelf()) {
    const auto material = model->complete().value();
    Timing t[4];
    for (const Want want : {Want::value, Want::gradient, Want::hessian}) {
      t[static_cast<int>(want)] = measure(repeats, [&] {
        for (std::size_t b = 0; b < kBatches; ++b) material->evaluate(want, in[b], out[b]);
      });
    }
    t[3] = measure(repeats, [&] {
      for (std::size_t b = 0; b < kBatches; ++b) {
        decompose(static_cast<int>(b));
        Spectrum spectrum;
        Lanes A[45];
        material->spectrum(in[b], svds[b], spectrum);
        add_volume(svds[b], broadcast(0), broadcast(-3e4), spectrum);
        make_definite(Definiteness::projected, spectrum);
        assemble(svds[b], spectrum, A);
        for (int i = 0; i < 45; ++i) store(A[i], out[b].A[i]);
        material->add_anisotropic(Definiteness::projected, in[b], out[b]);
      }
    });
    double sum = 0;
    for (const ResponseBatch& r : out) {
      for (int l = 0; l < kLanes; ++l) sum += r.A[0][l];
    }
    std::printf("%-28s", std::string(model->name()).c_str());
    for (const Timing& x : t) std::printf(" %6.1f (%5.1f)", x.least, x.median);
    std::printf("   sum %.9g\n", sum);
  }
  bench_elements(std::max(3, repeats / 10));
  return 0;
}
