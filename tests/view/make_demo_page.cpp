// Writes a sample results page: a thick capsule that widens at constant wall area and bends.
// Motion, fields and curves are formulas; nothing here is a result of the engine. The browser test looks at
// it. ACROSS and ALONG are cells over an end and along the straight part (10 and 16): the surface has
// 8 ACROSS (3 ACROSS + 2 ALONG) triangles, the body 4.5 times as many tets.
//
//   make_demo_page OUT.html [full|broken|single|bare|hot|parts [ACROSS ALONG FRAMES]]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "page_surface.h"
#include "results_page.h"

namespace {

using isochor::Index;
using isochor::Mesh;
using isochor::Vec3;

constexpr double inner = 0.010, outer = 0.016;  // radii of the wall [m]
constexpr double straight = 0.075;              // length of the straight part [m]
constexpr int layers = 3;                       // cells through the wall

double norm(const Vec3& v) {
  return std::sqrt(dot(v, v));
}

// The surface of a box with square cells, blown up to a capsule: triangles of nearly equal size and no poles.
// Each point is a direction on the unit sphere and its share of the straight part.
struct CapsulePoint {
  Vec3 direction;
  double share;
};

void capsule_surface(int across, int along, std::vector<CapsulePoint>& points,
                     std::vector<Index>& triangles) {
  const std::array<int, 3> cells = {across, across, across + along};
  const auto point = [&](const std::array<int, 3>& at) {
    const int raised = std::clamp(at[2] - across / 2, 0, along);
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const int on_cube = at[static_cast<std::size_t>(k)] - (k == 2 ? raised : 0);
      p[k] = std::tan((2.0 * on_cube / across - 1) * std::numbers::pi / 4);
    }
    return CapsulePoint{(1 / norm(p)) * p, static_cast<double>(raised) / along};
  };
  std::map<std::array<int, 3>, Index> known;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [entry, fresh] = known.try_emplace(at, static_cast<Index>(points.size()));
    if (fresh) points.push_back(point(at));
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < cells[u]; ++i) {
        for (int j = 0; j < cells[v]; ++j) {
          const auto at = [&](int di, int dj) {
            std::array<int, 3> a{};
            a[axis] = side * cells[axis];
            a[u] = i + di;
            a[v] = j + dj;
            return vertex(a);
          };
          std::array<Index, 4> q = {at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
          if (side == 0) std::swap(q[1], q[3]);
          triangles.insert(triangles.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
        }
      }
    }
  }
}

// Prisms between two copies of the sphere, cut by the order of their vertex numbers so that neighbors agree.
Mesh capsule(int across, int along) {
  std::vector<CapsulePoint> surface;
  std::vector<Index> triangles;
  capsule_surface(across, along, surface, triangles);
  const auto count = static_cast<Index>(surface.size());
  Mesh mesh;
  for (int layer = 0; layer <= layers; ++layer) {
    const double r = inner + (outer - inner) * layer / layers;
    for (const CapsulePoint& p : surface)
      mesh.nodes.push_back(r * p.direction + Vec3{0, 0, straight * p.share});
  }
  for (int layer = 0; layer < layers; ++layer) {
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      std::array<Index, 3> s = {triangles[t], triangles[t + 1], triangles[t + 2]};
      std::sort(s.begin(), s.end());
      const auto at = [&](std::size_t k, int up) { return s[k] + (layer + up) * count; };
      for (std::array<Index, 4> tet : {std::array{at(0, 0), at(1, 0), at(2, 0), at(2, 1)},
                                       std::array{at(0, 0), at(1, 0), at(1, 1), at(2, 1)},
                                       std::array{at(0, 0), at(0, 1), at(1, 1), at(2, 1)}}) {
        const auto node = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
        if (dot(cross(node(1) - node(0), node(2) - node(0)), node(3) - node(0)) < 0)
          std::swap(tet[0], tet[1]);
        mesh.cells.insert(mesh.cells.end(), tet.begin(), tet.end());
      }
    }
  }
  return mesh;
}

// Widens each cross-section so that the area of the wall stays, then bends the axis to an arc.
Vec3 moved(const Vec3& rest, double load) {
  const double grow = 0.75 * inner * inner * load;
  const double axial = std::clamp(rest.z, 0.0, straight);
  const double share = std::sin(std::numbers::pi * std::clamp((rest.z + 0.01) / (straight + 0.02), 0.0, 1.0));
  const double r = std::hypot(rest.x, rest.y);
  const double widened = r > 0 ? std::sqrt(r * r + grow * share) / r : 1;
  const Vec3 p = {rest.x * (r > 0.25 * inner ? widened : 1), rest.y * (r > 0.25 * inner ? widened : 1),
                  rest.z};
  const double curvature = 16.0 * load;
  if (curvature < 1e-9) return p;
  const double angle = curvature * axial;
  const double beyond = p.z - axial;
  const double reach = 1 / curvature - p.x;
  return {1 / curvature - reach * std::cos(angle) + beyond * std::sin(angle), p.y,
          reach * std::sin(angle) + beyond * std::cos(angle)};
}

// A second body beside the finger, and a table below both.
void add_block_and_table(isochor::PageScene& scene) {
  const auto box = [&](const Vec3& low, const Vec3& high, const isochor::PagePart& part) {
    const auto first = static_cast<Index>(scene.rest.size()), number = static_cast<Index>(scene.parts.size());
    scene.parts.push_back(part);
    for (int k = 0; k < 8; ++k)
      scene.rest.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
    for (const Index i : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
      scene.triangles.push_back(first + i);
    scene.triangle_part.resize(scene.triangles.size() / 3, number);
    scene.triangle_edges.resize(scene.triangles.size() / 3, 7);
  };
  box({-0.05, -0.02, -0.016}, {-0.02, 0.02, 0.03}, {"Block", ""});
  box({-0.08, -0.06, -0.018}, {0.1, 0.06, -0.016}, {"Table", "", true});
  scene.probes = {"Tip", "Root", "Beside the root", "Also beside it", "And here"};
}

// Those two stay where they are.
Vec3 moved_part(const Vec3& rest, double load) {
  return rest.x <= -0.02 || rest.z <= -0.016 ? rest : moved(rest, load);
}

void add_arrows(isochor::PageFrame& frame, double load) {
  frame.probes.resize(2);
  for (const double d : {1.0, 2.0, 3.0}) frame.probes.push_back(frame.probes[1] + Vec3{1e-4 * d, 0, 0});
  for (const double y : {-0.01, 0.0, 0.01})
    frame.forces.push_back({{-0.02, y, 0.01}, {-2 * load, 0, 0}, {0, 0, 0.7 * load}});
  for (int k = 0; k < 20; ++k)
    frame.fibers.insert(frame.fibers.end(),
                        {moved({outer, 0, 0.003 * k}, load), moved({outer, 0, 0.003 * k + 0.002}, load)});
}

struct Values {
  double pressure, stress, volume_ratio;
};

Values values_at(const Vec3& rest, double load) {
  const double r = norm({rest.x, rest.y, std::min(rest.z, 0.0) + std::max(rest.z - straight, 0.0)});
  const double depth = (r - inner) / (outer - inner);
  const double side = rest.x / outer;
  return {load * (26e3 * (1 - depth) - 9e3 * side * depth),
          load * 68e3 * (1.15 - 0.85 * depth) * (1 + 0.5 * side),
          1 + load * 2.2e-4 * std::sin(9 * depth + 40 * rest.z)};
}

isochor::PageReport report(int frames) {
  isochor::PageReport out;
  out.title = "Pneumatic finger (sample data)";
  out.subtitle =
      "Sample data for looking at this page: motion, fields and curves are formulas. Nothing was simulated.";
  out.footer = "Isochor sample page, not a simulation";
  out.run = {{"Shape", "Thick capsule with one chamber"},
             {"Motion", "Widened at constant wall area, then bent to an arc"},
             {"Fields and curves", "Formulas chosen to look plausible"}};
  isochor::PageSeries pressure{"Chamber", "Pressure", "Pa"}, volume{"Chamber", "Volume", "m³"};
  isochor::PageSeries elastic{"Energy", "Elastic", "J"}, kinetic{"Energy", "Kinetic", "J"};
  isochor::PageSeries work{"Energy", "Work of the pump", "J"};
  isochor::PageSeries error{"Volume error", "Largest |J − 1|", ""};
  isochor::PageSeries iterations{"Solver", "Newton iterations", ""};
  isochor::PageSeries residual{"Residual", "Force", "N", {}, {}, true},
      gap{"Residual", "Volume", "N", {}, {}, true};
  const int steps = std::max(1, 6 * (frames - 1));
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps, t = 2 * s;
    const double load = std::pow(std::sin(std::numbers::pi * s), 2);
    const auto add = [&](isochor::PageSeries& series, double y) {
      series.x.push_back(t);
      series.y.push_back(y);
    };
    add(pressure, 40e3 * load);
    add(volume, 2.35e-5 * (1 + 0.75 * load));
    add(elastic, 0.21 * load * load);
    add(kinetic, 0.012 * std::pow(std::sin(2 * std::numbers::pi * s), 2));
    add(work, 0.21 * load * load + 0.012 * std::pow(std::sin(2 * std::numbers::pi * s), 2) + 0.004 * s);
    add(error, 2.2e-4 * load);
    add(iterations, 3 + (i % 5 == 0 ? 1 : 0) + std::round(3 * load));
    add(residual, 1e-7 * std::exp(-2 * load) * (1 + 0.6 * std::sin(2.3 * i)));
    add(gap, 3e-10 * (1.2 + std::cos(1.7 * i)));
  }
  out.series = {pressure, volume, elastic, kinetic, work, error, iterations, residual, gap};
  const Vec3 tip = {0, 0, straight + outer};
  char reach[32];
  std::snprintf(reach, sizeof reach, "%.1f mm", 1e3 * norm(moved(tip, 1) - tip));
  out.summary = {{"Tip displacement at full load", reach}, {"Frames", std::to_string(frames)}};
  out.summary.push_back({"Largest pressure", "#0", {40e3}, "Pa"});
  out.summary.push_back({"Least pressure", "#0", {0}, "Pa"});
  out.summary.push_back({"Volume at rest", "#0 (at most #1)", {2.35e-5, 1.75 * 2.35e-5}, "m³"});
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(
        stderr, "usage: make_demo_page OUT.html [full|broken|single|bare|hot|parts [ACROSS ALONG FRAMES]]\n");
    return 2;
  }
  const std::string_view variant = argc > 2 ? argv[2] : "full";
  const auto count = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
  const int across = count(3, 10), along = count(4, 16);
  const int frames = count(5, variant == "single" ? 1 : 21);
  if (across < 2 || across % 2 != 0 || along < 1 || frames < 1) {
    std::fprintf(stderr, "make_demo_page: ACROSS is even and at least 2, ALONG and FRAMES are at least 1\n");
    return 2;
  }
  const bool bare = variant == "bare", broken = variant == "broken", hot = variant == "hot",
             parts = variant == "parts";

  isochor::PageScene scene;
  const Mesh mesh = capsule(across, along);
  const std::vector<Index> nodes = add_page_mesh(scene, mesh, {"Finger", ""}, {.cells = !bare});
  if (!bare) {
    scene.fields = {{"pressure", "Pressure", "Pa", false, true},
                    {"stress", "Von Mises stress", "Pa"},
                    {"J", "Volume ratio J", "", false, true, 1},
                    {"region", "Region", "", true, false, 0, {"Root", "Shaft", "Tip"}}};
    scene.lines = {{"Tendon", "#d8a11d"}};
    scene.probes = {"Tip", "Root"};
  }
  if (parts) add_block_and_table(scene);
  auto recorder = isochor::ResultsRecorder::start(scene);
  if (!recorder) {
    std::fprintf(stderr, "%s\n", recorder.error().c_str());
    return 1;
  }
  for (int i = 0; i < frames; ++i) {
    isochor::PageFrame frame;
    frame.time = frames > 1 ? 2.0 * i / (frames - 1) : 1.0;
    const double load = frames > 1 ? std::pow(std::sin(0.5 * std::numbers::pi * frame.time), 2) : 1.0;
    frame.label = frame.time < 1 ? "inflating" : "releasing";
    frame.fields.resize(scene.fields.size());
    for (const Vec3& rest : scene.rest) {
      frame.positions.push_back(parts ? moved_part(rest, load) : moved(rest, load));
      if (bare) continue;
      const Values v = values_at(rest, load);
      frame.fields[0].push_back(v.pressure);
      frame.fields[1].push_back(broken && rest.z > 0.05 ? std::numeric_limits<double>::quiet_NaN()
                                                        : v.stress);
      frame.fields[2].push_back(broken ? std::numeric_limits<double>::infinity() : v.volume_ratio);
    }
    if (!bare) {
      for (std::size_t t = 0; t < scene.triangles.size(); t += 3) {
        const double z = scene.rest[static_cast<std::size_t>(scene.triangles[t])].z;
        frame.fields[3].push_back(z < 0.01 ? 0 : z < 0.06 ? 1 : 2);
      }
      frame.lines.resize(1);
      for (int k = 0; k <= 30; ++k) frame.lines[0].push_back(moved({0.0135, 0, straight * k / 30.0}, load));
      frame.probes = {moved({0, 0, straight + outer}, load), moved({0, 0, -outer}, load)};
      for (int k = 0; k < 6; ++k) {
        const double a = k * std::numbers::pi / 3;
        frame.contacts.push_back(
            moved({0.9 * outer * std::cos(a), 0.9 * outer * std::sin(a), -0.0072}, load));
      }
      if (broken && i == 5) frame.positions[7].x = std::numeric_limits<double>::quiet_NaN();
    }
    if (parts) add_arrows(frame, load);
    // A single point, as a sharp edge has it.
    if (hot) frame.fields[1][frame.fields[1].size() / 2] = load * 1e7;
    if (auto ok = recorder.value().append(frame); !ok) {
      std::fprintf(stderr, "%s\n", ok.error().c_str());
      return 1;
    }
  }
  isochor::PageReport words = bare ? isochor::PageReport{} : report(frames);
  if (broken) {
    words.title = "</script><b>Broken & \"quoted\"";
    words.series[0].y.assign(words.series[0].y.size(), std::numeric_limits<double>::quiet_NaN());
    words.series.push_back({"Empty", "Nothing", "m"});
  }
  if (auto ok = recorder.value().write(argv[1], words); !ok) {
    std::fprintf(stderr, "%s\n", ok.error().c_str());
    return 1;
  }
  std::printf("%zu vertices, %zu triangles, %zu tets, %zu frames, %zu bytes of data\n", scene.rest.size(),
              scene.triangles.size() / 3, scene.cells.size() / 4, recorder.value().frame_count(),
              recorder.value().stored_bytes());
  return 0;
}
