#include "engine/world/memory_terms.h"

namespace isochor {

namespace {

constexpr std::size_t kSmooth = RelaxationPool::kSmooth;

const RelaxationPool* pool_of(const System& s, Index pool) {
  return dynamic_cast<const RelaxationPool*>(s.parts().stencil_pools[at(pool)].get());
}

// visit(pool, solid, its part of the memory).
template <class Visit>
void each_pool(const System& s, Visit&& visit) {
  for (const auto& remembering : s.facets().remembering) {
    if (const RelaxationPool* solid = pool_of(s, remembering.pool)) visit(remembering, *solid);
  }
}

std::size_t points_of(const RelaxationPool& solid) {
  return at(solid.stencils()) * static_cast<std::size_t>(solid.data().points);
}

}  // namespace

bool MemoryTerms::follows(const System& system) {
  for (const auto& remembering : system.facets().remembering) {
    if (!pool_of(system, remembering.pool)) return false;
  }
  return true;
}

std::size_t MemoryTerms::numbers(const System& system) {
  std::size_t sum = 0;
  each_pool(system, [&](const auto&, const RelaxationPool& solid) { sum += kSmooth * points_of(solid); });
  return sum;
}

std::vector<double> MemoryTerms::kept(const System& system, const Assembly& assembly, std::span<const Vec3> x,
                                      std::span<const double> memory) {
  std::vector<double> out(numbers(system));
  constexpr auto raw = static_cast<std::size_t>(RelaxationPool::kNumbers);
  std::size_t first = 0;
  each_pool(system, [&](const auto& place, const RelaxationPool& solid) {
    const std::span<const double> before = place.in(memory);
    std::vector<double> after(before.begin(), before.end());
    StencilRequest request = assembly.request(place.pool, Want::gradient, x);
    request.memory = before;
    solid.accept(request, after);
    for (std::size_t p = 0; p < points_of(solid); ++p, first += kSmooth) {
      RelaxationPool::smooth(std::span<const double, raw>(after.data() + raw * p, raw),
                             std::span<double, kSmooth>(out.data() + first, kSmooth));
    }
  });
  return out;
}

MemoryTerms::MemoryTerms(const System& system, const Assembly& assembly, const StencilIncrement& increment,
                         std::span<const Vec3> x, std::span<const double> memory)
    : system_(system) {
  each_pool(system, [&](const auto& place, const RelaxationPool& solid) {
    StencilRequest request = assembly.request(place.pool, Want::hessian, x);
    request.increment = increment;
    request.memory = place.in(memory);
    for (Index s = 0; s < solid.stencils(); ++s) {
      for (int q = 0; q < solid.data().points; ++q) rates_.push_back(solid.rates(request, s, q));
    }
  });
}

template <class Visit>
void MemoryTerms::each_point(Visit&& visit) const {
  std::size_t k = 0;
  each_pool(system_, [&](const auto&, const RelaxationPool& solid) {
    const SolidData& data = solid.data();
    const auto points = static_cast<std::size_t>(data.points);
    for (Index s = 0; s < solid.stencils(); ++s) {
      const auto nodes = data.nodes[s];
      const Vec3* gradient = data.gradient.data() + points * at(data.nodes.offset[at(s)]);
      for (std::size_t q = 0; q < points; ++q, ++k) {
        visit(Point{rates_[k], data.weight[at(s) * points + q], nodes, gradient + q * nodes.size(),
                    kSmooth * k});
      }
    }
  });
}

namespace {

// A change of positions as that of F, and back.
std::array<double, 9> gradient_along(std::span<const Index> nodes, const Vec3* B, std::span<const Vec3> dx) {
  std::array<double, 9> out{};
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const Vec3& d = dx[at(nodes[a])];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) out[at(3 * i + j)] += d[i] * B[a][j];
    }
  }
  return out;
}

void scatter(std::span<const Index> nodes, const Vec3* B, const std::array<double, 9>& P, double factor,
             std::span<Vec3> to) {
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) to[at(nodes[a])][i] += factor * P[at(3 * i + j)] * B[a][j];
    }
  }
}

}  // namespace

void MemoryTerms::add_force(double factor, std::span<const double> m, std::span<Vec3> force) const {
  each_point([&](const Point& p) {
    std::array<double, 9> P{};
    for (std::size_t i = 0; i < 9; ++i) {
      for (std::size_t k = 0; k < kSmooth; ++k) P[i] += p.rates.stress[kSmooth * i + k] * m[p.first + k];
    }
    scatter(p.nodes, p.gradient, P, factor * p.weight, force);
  });
}

void MemoryTerms::add_force_back(double factor, std::span<const Vec3> way, std::span<double> m) const {
  each_point([&](const Point& p) {
    const auto d = gradient_along(p.nodes, p.gradient, way);
    for (std::size_t i = 0; i < 9; ++i) {
      for (std::size_t k = 0; k < kSmooth; ++k)
        m[p.first + k] += factor * p.weight * p.rates.stress[kSmooth * i + k] * d[i];
    }
  });
}

std::vector<double> MemoryTerms::onward(std::span<const double> m, std::span<const Vec3> dx) const {
  std::vector<double> out(m.size());
  each_point([&](const Point& p) {
    const auto d = gradient_along(p.nodes, p.gradient, dx);
    for (std::size_t i = 0; i < kSmooth; ++i) {
      const double* by = p.rates.memory.data() + kIn * i;
      double& sum = out[p.first + i];
      for (std::size_t k = 0; k < kSmooth; ++k) sum += by[k] * m[p.first + k];
      for (std::size_t k = 0; k < 9; ++k) sum += by[kSmooth + k] * d[k];
    }
  });
  return out;
}

std::vector<double> MemoryTerms::back(std::span<const double> felt, std::span<Vec3> x) const {
  std::vector<double> out(felt.size());
  each_point([&](const Point& p) {
    std::array<double, 9> d{};
    for (std::size_t i = 0; i < kSmooth; ++i) {
      const double* by = p.rates.memory.data() + kIn * i;
      for (std::size_t k = 0; k < kSmooth; ++k) out[p.first + k] += by[k] * felt[p.first + i];
      for (std::size_t k = 0; k < 9; ++k) d[k] += by[kSmooth + k] * felt[p.first + i];
    }
    scatter(p.nodes, p.gradient, d, 1, x);
  });
  return out;
}

}  // namespace isochor
