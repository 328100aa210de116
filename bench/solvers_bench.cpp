// Times of every linear solver backend on the saddle matrix of a stabilized P1-P1 block at nu = 0.5.
//
//   solvers_bench [--sizes 1600,8000,32000] [--repeats 7] [--blas-threads 1] [--all] [--sweep] [--cpu]
//   [--stiffness]
//
// --stiffness takes the displacement block alone, what a displacement-only method factors;
// --all also runs the backends that take seconds at a size; --sweep tries the settings of MUMPS instead;
// --cpu takes the processor time of the process instead of the wall clock, which a busy machine disturbs
// less.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/base/base.h"
#include "engine/solvers/foreign/cholmod_solver.h"
#include "engine/solvers/foreign/eigen_solver.h"
#include "engine/solvers/foreign/mumps_solver.h"
#include "engine/solvers/front/multifrontal_solver.h"
#include "engine/solvers/linear_solver.h"
#include "engine/solvers/ordering.h"

namespace {

using namespace isochor;

struct System {
  SymmetricPattern pattern;
  std::vector<double> values;
};

using Tet = std::array<Index, 4>;

// Six tets around the diagonal of each cell.
std::vector<Tet> box_tets(int nx, int ny, int nz) {
  const auto node = [&](int i, int j, int k) {
    return static_cast<Index>((k * (ny + 1) + j) * (nx + 1) + i);
  };
  constexpr int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<Tet> tets;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        for (const auto& path : axes) {
          int c[3] = {i, j, k};
          Tet t{node(i, j, k), 0, 0, 0};
          for (int s = 0; s < 3; ++s) {
            ++c[path[s]];
            t[at(s + 1)] = node(c[0], c[1], c[2]);
          }
          tets.push_back(t);
        }
      }
    }
  }
  return tets;
}

// K = d(P)/d(F) of neo-Hookean at rest (mu = 1), G the nodal volume rows, -C the stabilization with tau = 1.
// The face z = 0 is held. Displacements and pressures are scaled so that a typical diagonal of K and of M_p /
// mu is 1.
System block(int nx, int ny, int nz) {
  const auto tets = box_tets(nx, ny, nz);
  const Index nodes = (nx + 1) * (ny + 1) * (nz + 1), held = (nx + 1) * (ny + 1);
  const Index displacements = 3 * (nodes - held), size = displacements + nodes;
  const double h = 1.0 / nx;
  std::vector<std::map<Index, double>> column(at(size));
  const auto add = [&](Index a, Index b, double v) {
    if (a >= 0 && b >= 0 && a >= b) column[at(b)][a] += v;
  };
  for (const Tet& t : tets) {
    double x[4][3], g[4][3];
    for (int a = 0; a < 4; ++a) {
      const Index n = t[at(a)];
      x[a][0] = h * (n % (nx + 1));
      x[a][1] = h * ((n / (nx + 1)) % (ny + 1));
      x[a][2] = h * (n / held);
    }
    double volume = 0;
    for (int a = 0; a < 4; ++a) {
      // The gradient of a shape function is the normal of the opposite face over the height above it.
      const int b = (a + 1) % 4, c = (a + 2) % 4, d = (a + 3) % 4;
      double u[3], v[3], w[3], n[3];
      for (int i = 0; i < 3; ++i)
        u[i] = x[c][i] - x[b][i], v[i] = x[d][i] - x[b][i], w[i] = x[a][i] - x[b][i];
      for (int i = 0; i < 3; ++i) n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
      const double six = n[0] * w[0] + n[1] * w[1] + n[2] * w[2];
      for (int i = 0; i < 3; ++i) g[a][i] = n[i] / six;
      volume = std::abs(six) / 6;
    }
    const auto u_of = [&](int a, int i) {
      return t[at(a)] < held ? Index{-1} : 3 * (t[at(a)] - held) + static_cast<Index>(i);
    };
    const auto p_of = [&](int a) { return displacements + t[at(a)]; };
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const double dots = g[a][0] * g[b][0] + g[a][1] * g[b][1] + g[a][2] * g[b][2];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            const double k = (i == j ? dots : 0.0) + g[a][j] * g[b][i] - 2.0 / 3.0 * g[a][i] * g[b][j];
            add(u_of(a, i), u_of(b, j), volume * k);
          }
          if (u_of(b, i) >= 0) add(p_of(a), u_of(b, i), volume / 4 * g[b][i]);
        }
        add(p_of(a), p_of(b), -(volume * (a == b ? 0.1 : 0.05) - volume / 16));
      }
    }
  }
  System s;
  std::vector<double> scale(at(size));
  const double stiffness = 8 * h, mass = h * h * h / 4;
  for (Index i = 0; i < size; ++i) scale[at(i)] = 1 / std::sqrt(i < displacements ? stiffness : mass);
  s.pattern.size = size;
  s.pattern.column_start = {0};
  for (Index c = 0; c < size; ++c) {
    for (const auto& [r, v] : column[at(c)]) {
      s.pattern.row.push_back(r);
      s.values.push_back(v * scale[at(r)] * scale[at(c)]);
    }
    s.pattern.column_start.push_back(static_cast<std::int64_t>(s.values.size()));
    s.pattern.group.push_back(c < displacements ? c / 3 + held : c - displacements);
    s.pattern.multiplier.push_back(c >= displacements);
  }
  s.pattern.groups = nodes;
  return s;
}

// The displacement block.
System stiffness_of(const System& s) {
  System k;
  const auto first_row = std::find(s.pattern.multiplier.begin(), s.pattern.multiplier.end(), std::uint8_t{1});
  k.pattern.size = static_cast<Index>(first_row - s.pattern.multiplier.begin());
  k.pattern.column_start = {0};
  for (Index c = 0; c < k.pattern.size; ++c) {
    for (auto e = s.pattern.column_start[at(c)]; e < s.pattern.column_start[at(c) + 1]; ++e) {
      if (s.pattern.row[static_cast<std::size_t>(e)] >= k.pattern.size) continue;
      k.pattern.row.push_back(s.pattern.row[static_cast<std::size_t>(e)]);
      k.values.push_back(s.values[static_cast<std::size_t>(e)]);
    }
    k.pattern.column_start.push_back(static_cast<std::int64_t>(k.values.size()));
    k.pattern.group.push_back(c / 3);
    k.pattern.multiplier.push_back(0);
  }
  k.pattern.groups = k.pattern.size / 3;
  return k;
}

struct Times {
  double minimum = 0, median = 0;
};

bool take_cpu_time = false;

double now_ms() {
  if (take_cpu_time) return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Times measure(int repeats, const std::function<void()>& work) {
  work();  // the first touches fresh memory
  std::vector<double> ms;
  for (int i = 0; i < repeats; ++i) {
    const double start = now_ms();
    work();
    ms.push_back(now_ms() - start);
    if (ms.front() > 3000) break;
  }
  std::sort(ms.begin(), ms.end());
  return {ms.front(), ms[ms.size() / 2]};
}

bool run(const char* label, LinearSolver* solver, const System& s, int repeats) {
  if (solver == nullptr) return true;
  const auto n = at(s.pattern.size);
  std::vector<double> b(n), x(n);
  for (std::size_t i = 0; i < n; ++i) b[i] = std::sin(static_cast<double>(i));
  FactorReport analysis, factor;
  SolveReport solve;
  const Times a = measure(std::min(repeats, 3), [&] { analysis = solver->analyze(s.pattern); });
  const Times f = measure(repeats, [&] { factor = solver->factor(s.values); });
  const Times t = measure(repeats, [&] { solve = solver->solve(b, x); });
  std::printf("%-34s %7zu | %8.2f | %8.2f %8.2f | %7.3f %7.3f | %8.2f M | %2d ref, %.0e %s\n", label, n,
              a.minimum, f.minimum, f.median, t.minimum, t.median,
              1e-6 * static_cast<double>(factor.factor_nonzeros), solve.refinements, solve.residual,
              factor.message.c_str());
  std::fflush(stdout);
  const Index expected = static_cast<Index>(
      std::count(s.pattern.multiplier.begin(), s.pattern.multiplier.end(), std::uint8_t{1}));
  // A benchmark of wrong answers is worth nothing.
  const bool good = solve.ok && factor.negative_pivots == expected;
  if (!good) std::printf("  WRONG: %d negative pivots, expected %d\n", factor.negative_pivots, expected);
  return good;
}

// The block whose number of unknowns is nearest: square section, four times as long, as the beam of the
// design notes.
System nearest(int unknowns) {
  int best_n = 1, best_m = 1;
  for (int n = 1; n <= 20; ++n) {
    for (int m = std::max(1, 3 * n); m <= 5 * n; ++m) {
      const auto count = [](int i, int j) { return (i + 1) * (i + 1) * (4 * (j + 1) - 3); };
      if (std::abs(count(n, m) - unknowns) < std::abs(count(best_n, best_m) - unknowns))
        best_n = n, best_m = m;
    }
  }
  return block(best_n, best_n, best_m);
}

struct Choices {
  std::vector<int> sizes{1600, 8000, 32617};
  int repeats = 7, threads = 1;
  bool all = false, sweep = false, stiffness = false;
};

bool parse(int argc, char** argv, Choices& c) {
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (std::strcmp(argv[i], "--all") == 0) {
      c.all = true;
    } else if (std::strcmp(argv[i], "--sweep") == 0) {
      c.sweep = true;
    } else if (std::strcmp(argv[i], "--stiffness") == 0) {
      c.stiffness = true;
    } else if (std::strcmp(argv[i], "--cpu") == 0) {
      take_cpu_time = true;
    } else if (more && std::strcmp(argv[i], "--repeats") == 0) {
      c.repeats = std::max(1, std::atoi(argv[++i]));
    } else if (more && std::strcmp(argv[i], "--blas-threads") == 0) {
      c.threads = std::atoi(argv[++i]);
    } else if (more && std::strcmp(argv[i], "--sizes") == 0) {
      c.sizes.clear();
      for (const char* p = argv[++i]; *p != '\0';) {
        char* end = nullptr;
        c.sizes.push_back(static_cast<int>(std::strtol(p, &end, 10)));
        p = *end == ',' ? end + 1 : end;
        if (end == p && *p != '\0') break;
      }
    } else {
      std::fprintf(stderr, "unknown argument '%s'\n", argv[i]);
      return false;
    }
  }
  return true;
}

bool run_mumps(const char* label, const MumpsOptions& o, const System& s, int repeats) {
  return run(label, make_mumps_solver(o).get(), s, repeats);
}

bool run_orderings(const System& s, int repeats) {
  bool good = true;
  const auto mumps = [&](const char* label, const MumpsOptions& o) {
    good &= run_mumps(label, o, s, repeats);
  };
  mumps("mumps, our choice of ordering", {});
  MumpsOptions o;
  o.ordering = OrderingMethod::metis;
  mumps("mumps, METIS on the groups", o);
  o.ordering = OrderingMethod::amf;
  mumps("mumps, AMF on the groups", o);
  o.ordering = OrderingMethod::pord;
  mumps("mumps, PORD on the unknowns", o);
  o.ordering = OrderingMethod::amd;
  mumps("mumps, AMD on the groups", o);
  return good;
}

bool run_sweep(const System& s, int repeats) {
  bool good = true;
  const auto mumps = [&](const char* label, const MumpsOptions& o) {
    good &= run_mumps(label, o, s, repeats);
  };
  MumpsOptions o;
  o.scaling = true;
  mumps("  + scaling", o);
  o = {};
  for (const double threshold : {1e-1, 1e-3, 1e-4, 1e-6, 0.0}) {
    o.pivot_threshold = threshold;
    char label[64];
    std::snprintf(label, sizeof label, "  pivot threshold %.0e", threshold);
    mumps(label, o);
  }
  for (const auto& [choice, name] :
       std::vector<std::pair<int, const char*>>{{0, "  ordering: AMD"},
                                                {2, "  ordering: AMF"},
                                                {3, "  ordering: Scotch"},
                                                {4, "  ordering: PORD"},
                                                {5, "  ordering: METIS (or else auto)"},
                                                {6, "  ordering: QAMD"},
                                                {7, "  ordering: auto"}}) {
    o = {};
    o.own_ordering = choice;
    mumps(name, o);
  }
  System ungrouped = s;
  ungrouped.pattern.group.clear();
  good &= run("  without groups", make_mumps_solver().get(), ungrouped, repeats);
  return good;
}

bool run_others(const System& s, int repeats) {
  bool good = true;
  good &= run("cholmod, METIS", make_cholmod_solver(OrderingMethod::metis).get(), s, repeats);
  good &= run("cholmod, AMD", make_cholmod_solver(OrderingMethod::amd).get(), s, repeats);
  good &= run("eigen, METIS", make_eigen_solver(OrderingMethod::metis).get(), s, repeats);
  good &= run("eigen, AMD", make_eigen_solver(OrderingMethod::amd).get(), s, repeats);
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  Choices c;
  if (!parse(argc, argv, c)) return 2;
  const bool settable = set_blas_threads(c.threads);
  for (const SolverBackend& b : linear_solver_backends()) {
    std::printf("%s %s (%s)\n", b.name.c_str(), b.version.c_str(), b.license.c_str());
  }
  std::printf("BLAS threads: %s%d; %s times in ms, minimum and median of up to %d, the first excluded\n\n",
              settable ? "" : "not settable, wanted ", c.threads, take_cpu_time ? "processor" : "wall",
              c.repeats);
  std::printf("%-34s %7s | %8s | %17s | %15s | %10s |\n", "backend", "size", "analyze", "factor", "solve",
              "factor nnz");
  bool good = true;
  for (const int size : c.sizes) {
    const System s = c.stiffness ? stiffness_of(nearest(size)) : nearest(size);
    const auto fronts = [&](const char* label, const MultifrontalOptions& o) {
      good &= run(label, make_multifrontal_solver(make_mumps_solver(), o).get(), s, c.repeats);
    };
    fronts("multifrontal, single precision", {.single_from = 0});
    fronts("multifrontal, double precision", {.single_precision = false});
    if (c.stiffness) {
      good &= run("cholmod, supernodal", make_linear_solver(Solver::cholmod_supernodal).get(), s, c.repeats);
    }
    good &= run_orderings(s, c.repeats);
    if (c.sweep)
      good &= run_sweep(s, c.repeats);
    else if (c.all || size <= 10000)
      good &= run_others(s, c.repeats);
    std::printf("\n");
  }
  return good ? 0 : 1;
}
