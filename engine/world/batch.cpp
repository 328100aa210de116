#include "isochor/batch.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/out_of_memory.h"
#include "engine/base/parallel.h"

namespace isochor {

struct WorldBatch::Impl {
  explicit Impl(int threads) : parallel(threads) {}

  template <class F>
  void each(F&& f) {
    parallel.run(static_cast<Index>(worlds.size()), 1, [&](Index begin, Index end) {
      for (Index w = begin; w < end; ++w) f(at(w));
    });
  }
  template <class Step>
  std::vector<StepReport> stepped(Step&& step) {
    std::vector<StepReport> reports(worlds.size());
    each([&](std::size_t w) { reports[w] = step(worlds[w]); });
    return reports;
  }
  template <class View>
  Result<void> copy(const char* call, std::span<Vec3> out, View&& view) const {
    std::size_t total = 0;
    for (const World& w : worlds) total += view(w).size();
    const std::size_t nodes = worlds.empty() ? 0 : view(worlds.front()).size();
    if (total != out.size() || total != nodes * worlds.size()) {
      return Error{std::string(call) + ": the worlds have " + std::to_string(total) + " nodes in all, " +
                   std::to_string(nodes) + " the first of " + std::to_string(worlds.size()) +
                   ", and there is room for " + std::to_string(out.size()) +
                   "; give a vector a node a world, of a body that has as many nodes in each"};
    }
    auto to = out.begin();
    for (const World& w : worlds) {
      const auto from = view(w);
      to = std::copy(from.begin(), from.end(), to);
    }
    return {};
  }

  TbbParallel parallel;
  std::vector<World> worlds;
};

WorldBatch::WorldBatch(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WorldBatch::WorldBatch(WorldBatch&&) noexcept = default;
WorldBatch& WorldBatch::operator=(WorldBatch&&) noexcept = default;
WorldBatch::~WorldBatch() = default;

Result<WorldBatch> WorldBatch::create(const World& world, Index count, int threads) try {
  constexpr Index most = 1 << 20;
  if (count < 1 || count > most) {
    return Error{"batch: " + std::to_string(count) + " worlds; give 1 to " + std::to_string(most)};
  }
  if (threads < 0 || threads > 1024)
    return Error{"batch: threads = " + std::to_string(threads) + "; give 0 (all) or a number up to 1024"};
  auto impl = std::make_unique<Impl>(threads);
  impl->worlds.reserve(at(count));
  for (Index w = 0; w < count; ++w) {
    auto clone = world.clone(1);
    if (!clone) return Error{"batch: " + clone.error()};
    impl->worlds.push_back(std::move(clone).value());
  }
  return WorldBatch(std::move(impl));
} catch (const std::bad_alloc&) {
  return no_memory("batch");
}

Index WorldBatch::size() const {
  return static_cast<Index>(impl_->worlds.size());
}
int WorldBatch::threads() const {
  return impl_->parallel.threads();
}
World& WorldBatch::operator[](Index number) {
  return impl_->worlds[at(std::clamp(number, Index{0}, size() - 1))];
}
const World& WorldBatch::operator[](Index number) const {
  return impl_->worlds[at(std::clamp(number, Index{0}, size() - 1))];
}

std::vector<StepReport> WorldBatch::advance(double h) {
  return impl_->stepped([&](World& world) { return world.advance(h); });
}
std::vector<StepReport> WorldBatch::step(double h, const StepBudget& budget) {
  return impl_->stepped([&](World& world) { return world.step(h, budget); });
}

Result<void> WorldBatch::reset(std::span<const std::uint8_t> marked) try {
  if (!marked.empty() && marked.size() != impl_->worlds.size()) {
    return Error{"reset: " + std::to_string(marked.size()) + " marks for " +
                 std::to_string(impl_->worlds.size()) + " worlds; give one a world, or none for all"};
  }
  std::vector<std::string> errors(impl_->worlds.size());
  impl_->each([&](std::size_t w) {
    if (!marked.empty() && marked[w] == 0) return;
    if (auto r = impl_->worlds[w].reset(); !r) errors[w] = r.error();
  });
  for (std::size_t w = 0; w < errors.size(); ++w) {
    if (!errors[w].empty()) return Error{"world " + std::to_string(w) + ": " + errors[w]};
  }
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("reset");
}

Result<void> WorldBatch::set_amounts(EffectId effect, std::span<const double> amounts) try {
  if (amounts.size() != impl_->worlds.size()) {
    return Error{"set_amounts: " + std::to_string(amounts.size()) + " amounts for " +
                 std::to_string(impl_->worlds.size()) + " worlds; give one a world"};
  }
  for (std::size_t w = 0; w < amounts.size(); ++w) {
    if (!std::isfinite(amounts[w]))
      return Error{"set_amounts: the amount of world " + std::to_string(w) + " is not a finite number"};
  }
  for (std::size_t w = 0; w < amounts.size(); ++w) {
    if (auto r = impl_->worlds[w].set_amount(effect, amounts[w]); !r)
      return Error{"world " + std::to_string(w) + ": " + r.error()};
  }
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("set_amounts");
}

Result<void> WorldBatch::positions(BodyId body, std::span<Vec3> out) const {
  return impl_->copy("positions", out, [&](const World& w) { return w.positions(body); });
}
Result<void> WorldBatch::velocities(BodyId body, std::span<Vec3> out) const {
  return impl_->copy("velocities", out, [&](const World& w) { return w.velocities(body); });
}

WorldBatch::Memory WorldBatch::memory() const {
  Memory m;
  for (const World& w : impl_->worlds) {
    const WorldSize s = w.size();
    const auto numbers = static_cast<std::size_t>(s.matrix_nonzeros + s.factor_nonzeros);
    m.each += (s.engine_bytes + sizeof(double) * numbers) / impl_->worlds.size();
    m.shared = std::max(m.shared, s.table_bytes);
  }
  return m;
}

}  // namespace isochor
