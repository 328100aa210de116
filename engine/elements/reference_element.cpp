#include "engine/elements/reference_element.h"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/mesh/cell_shape.h"

namespace isochor {

namespace {

struct Barycentric {
  double b[4];
  double weight;
};

// Walkington's 14 points: degree 5, all weights positive; weights sum to 1/6.
std::vector<Barycentric> quadrature_degree_5() {
  std::vector<Barycentric> points;
  const auto four = [&](double a, double w) {
    for (int k = 0; k < 4; ++k) {
      Barycentric p{{a, a, a, a}, w};
      p.b[k] = 1 - 3 * a;
      points.push_back(p);
    }
  };
  four(0.31088591926330060980, 0.11268792571801585080 / 6);
  four(0.092735250310891226402, 0.073493043116361949544 / 6);
  const double a = 0.045503704125649649492, w = 0.042546020777081466438 / 6;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      Barycentric p{{a, a, a, a}, w};
      p.b[i] = p.b[j] = 0.5 - a;
      points.push_back(p);
    }
  }
  return points;
}

const Vec3 kBarycentricGradient[4] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int kTet10Edge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

ReferenceElement make_tet4() {
  ReferenceElement e;
  e.nodes = e.corners = 4;
  e.points = 1;
  e.weight = {1.0 / 6};
  e.shape_gradient.assign(kBarycentricGradient, kBarycentricGradient + 4);
  e.shape = e.corner_shape = {0.25, 0.25, 0.25, 0.25};
  return e;
}

ReferenceElement make_tet10() {
  ReferenceElement e;
  e.nodes = 10;
  e.corners = 4;
  for (const Barycentric& p : quadrature_degree_5()) {
    e.weight.push_back(p.weight);
    for (int a = 0; a < 4; ++a) {
      e.shape.push_back(p.b[a] * (2 * p.b[a] - 1));
      e.shape_gradient.push_back((4 * p.b[a] - 1) * kBarycentricGradient[a]);
      e.corner_shape.push_back(p.b[a]);
    }
    for (const auto& [i, j] : kTet10Edge) {
      e.shape.push_back(4 * p.b[i] * p.b[j]);
      e.shape_gradient.push_back(4 * (p.b[i] * kBarycentricGradient[j] + p.b[j] * kBarycentricGradient[i]));
    }
    ++e.points;
  }
  return e;
}

ReferenceElement make_hex8() {
  ReferenceElement e;
  e.nodes = e.corners = e.points = 8;
  for (const auto& sign : kHexSign) {
    const Vec3 xi = kHexGauss * Vec3{1.0 * sign[0], 1.0 * sign[1], 1.0 * sign[2]};
    e.weight.push_back(1);
    for (std::size_t a = 0; a < 8; ++a) {
      e.shape.push_back(hex_function(a, xi));
      e.shape_gradient.push_back(hex_gradient(a, xi));
    }
  }
  e.corner_shape = e.shape;
  return e;
}

// dX/dxi at a point, its determinant and inverse.
struct RestMap {
  Mat3 inverse;
  double determinant = 0;
};

RestMap rest_map(const ReferenceElement& e, int point, std::span<const Vec3> rest, const Index* nodes) {
  Mat3 m;
  for (int a = 0; a < e.nodes; ++a) {
    const Vec3& d = e.shape_gradient[static_cast<std::size_t>(point * e.nodes + a)];
    const Vec3& X = rest[at(nodes[a])];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) m(i, j) += X[i] * d[j];
    }
  }
  const Vec3 c0{m(0, 0), m(1, 0), m(2, 0)}, c1{m(0, 1), m(1, 1), m(2, 1)}, c2{m(0, 2), m(1, 2), m(2, 2)};
  RestMap result;
  result.determinant = dot(c0, cross(c1, c2));
  const Vec3 rows[3] = {cross(c1, c2), cross(c2, c0), cross(c0, c1)};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.inverse(i, j) = rows[i][j] / result.determinant;
  }
  return result;
}

}  // namespace

const ReferenceElement& tet4_element() {
  static const ReferenceElement element = make_tet4();
  return element;
}

const ReferenceElement& tet10_element() {
  static const ReferenceElement element = make_tet10();
  return element;
}

const ReferenceElement& tri3_element() {
  static const ReferenceElement element{3, 0, {}, {}, {}, {}, 3};
  return element;
}

const ReferenceElement& hex8_element() {
  static const ReferenceElement element = make_hex8();
  return element;
}

Result<SolidData> solid_data(const ReferenceElement& e, std::span<const Vec3> rest,
                             std::span<const Index> cell_nodes, std::span<const Index> cells,
                             VolumeFunctions functions) {
  SolidData data;
  data.points = e.points;
  data.cell.assign(cells.begin(), cells.end());
  for (const Index c : cells) {
    const Index* nodes = cell_nodes.data() + at(c) * static_cast<std::size_t>(e.nodes);
    data.nodes.push({nodes, static_cast<std::size_t>(e.nodes)});
    for (int q = 0; q < e.points; ++q) {
      const RestMap map = rest_map(e, q, rest, nodes);
      if (!(map.determinant > 0)) {
        return Error{"cell " + std::to_string(c + 1) + " is inverted or flat at rest (Jacobian " +
                     std::to_string(map.determinant) + "); mend the mesh, `isochor check` lists such cells"};
      }
      data.weight.push_back(e.weight[static_cast<std::size_t>(q)] * map.determinant);
      for (int a = 0; a < e.nodes; ++a) {
        data.gradient.push_back(
            transposed_times(map.inverse, e.shape_gradient[static_cast<std::size_t>(q * e.nodes + a)]));
      }
    }
  }
  if (functions == VolumeFunctions::constant) {
    data.functions = 1;
    data.shape.assign(static_cast<std::size_t>(e.points), 1.0);
  } else if (functions == VolumeFunctions::corners) {
    data.functions = e.corners;
    data.shape = e.corner_shape;
  }
  return data;
}

Result<SolidData> edge_patch_data(std::span<const Vec3> rest, std::span<const Index> cell_nodes,
                                  std::span<const Index> cells) {
  auto tets = solid_data(tet4_element(), rest, cell_nodes, cells, VolumeFunctions::none);
  if (!tets) return tets.failure();
  const SolidData& t = tets.value();
  // Tets around each edge, edges in the order of their node pairs.
  struct Member {
    Index low, high, tet;
  };
  std::vector<Member> members;
  for (Index s = 0; s < t.nodes.count(); ++s) {
    const auto n = t.nodes[s];
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        members.push_back({std::min(n[i], n[j]), std::max(n[i], n[j]), s});
      }
    }
  }
  std::sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
    return std::pair(std::pair(a.low, a.high), a.tet) < std::pair(std::pair(b.low, b.high), b.tet);
  });
  SolidData data;
  data.points = 1;
  std::vector<Index> nodes;
  std::vector<Vec3> gradient;
  for (std::size_t begin = 0; begin < members.size();) {
    std::size_t end = begin;
    nodes.clear();
    gradient.clear();
    double volume = 0;
    for (; end < members.size() && members[end].low == members[begin].low &&
           members[end].high == members[begin].high;
         ++end) {
      const Index s = members[end].tet;
      const double share = t.weight[at(s)] / 6;
      volume += share;
      for (std::size_t a = 0; a < 4; ++a) {
        const Index node = t.nodes[s][a];
        const auto found = std::find(nodes.begin(), nodes.end(), node);
        const auto place = static_cast<std::size_t>(found - nodes.begin());
        if (found == nodes.end()) {
          nodes.push_back(node);
          gradient.push_back({});
        }
        gradient[place] += share * t.gradient[4 * at(s) + a];
      }
    }
    for (Vec3& g : gradient) g = (1 / volume) * g;
    for (std::size_t m = begin; m < end; ++m) {
      data.patch_cells.item.push_back(t.cell[at(members[m].tet)]);
      data.patch_share.push_back(t.weight[at(members[m].tet)] / 6 / volume);
    }
    data.patch_cells.offset.push_back(static_cast<Index>(data.patch_cells.item.size()));
    data.nodes.push(nodes);
    data.gradient.insert(data.gradient.end(), gradient.begin(), gradient.end());
    data.weight.push_back(volume);
    data.cell.push_back(t.cell[at(members[begin].tet)]);
    begin = end;
  }
  return data;
}

void add_lumped_mass(const ReferenceElement& e, std::span<const Vec3> rest, std::span<const Index> cell_nodes,
                     std::span<const Index> cells, double density, std::span<double> mass) {
  std::vector<double> diagonal(static_cast<std::size_t>(e.nodes));
  for (const Index c : cells) {
    const Index* nodes = cell_nodes.data() + at(c) * static_cast<std::size_t>(e.nodes);
    std::fill(diagonal.begin(), diagonal.end(), 0.0);
    double volume = 0, sum = 0;
    for (int q = 0; q < e.points; ++q) {
      const double w = e.weight[static_cast<std::size_t>(q)] * rest_map(e, q, rest, nodes).determinant;
      volume += w;
      for (int a = 0; a < e.nodes; ++a) {
        const double N = e.shape[static_cast<std::size_t>(q * e.nodes + a)];
        diagonal[static_cast<std::size_t>(a)] += w * N * N;
        sum += w * N * N;
      }
    }
    for (int a = 0; a < e.nodes; ++a) {
      mass[at(nodes[a])] += density * volume * diagonal[static_cast<std::size_t>(a)] / sum;
    }
  }
}

void add_consistent_mass(const ReferenceElement& e, std::span<const Vec3> rest,
                         std::span<const Index> cell_nodes, std::span<const Index> cells, double density,
                         std::vector<MassEntry>& mass) {
  for (const Index c : cells) {
    const Index* nodes = cell_nodes.data() + at(c) * static_cast<std::size_t>(e.nodes);
    for (int a = 0; a < e.nodes; ++a) {
      for (int b = 0; b <= a; ++b) {
        double sum = 0;
        for (int q = 0; q < e.points; ++q) {
          const double w = e.weight[static_cast<std::size_t>(q)] * rest_map(e, q, rest, nodes).determinant;
          const double* const N = e.shape.data() + static_cast<std::ptrdiff_t>(q) * e.nodes;
          // One point does not integrate the square of linear functions.
          sum += e.nodes == 4 ? w * (a == b ? 0.1 : 0.05) : w * N[a] * N[b];
        }
        mass.push_back({std::max(nodes[a], nodes[b]), std::min(nodes[a], nodes[b]), density * sum});
      }
    }
  }
}

void add_nodal_volume(const ReferenceElement& e, std::span<const Vec3> rest,
                      std::span<const Index> cell_nodes, std::span<const Index> cells, double density,
                      std::span<double> volume) {
  for (const Index c : cells) {
    const Index* nodes = cell_nodes.data() + at(c) * static_cast<std::size_t>(e.nodes);
    for (int q = 0; q < e.points; ++q) {
      const double w =
          density * e.weight[static_cast<std::size_t>(q)] * rest_map(e, q, rest, nodes).determinant;
      for (int a = 0; a < e.nodes; ++a) {
        volume[at(nodes[a])] += w * e.shape[static_cast<std::size_t>(q * e.nodes + a)];
      }
    }
  }
}

}  // namespace isochor
