#include "support/compiled.h"

#include <algorithm>

namespace test {

using namespace isochor;

Compiled compile(const std::vector<BodyDef>& bodies, const std::vector<EffectPtr>& effects, bool anchored,
                 RowTreatment treatment) {
  Compiled c;
  Builder& builder = *c.builder;
  const auto failed = [&](const auto& result) {
    if (!result) c.error = result.error();
    return !result;
  };
  for (const BodyDef& b : bodies) {
    if (failed(builder.add_body(b))) return c;
  }
  for (const EffectPtr& e : effects) {
    if (failed(e->check()) || failed(e->declare(builder))) return c;
  }
  if (failed(builder.build_solids())) return c;
  for (const EffectPtr& e : effects) {
    auto instance = e->build(builder);
    if (failed(instance)) return c;
    c.instances.push_back(std::move(instance).value());
  }
  auto parts = builder.finish(anchored);
  if (failed(parts)) return c;
  SystemParts all = std::move(parts).value();
  all.treatment = treatment;
  all.border_wide_rows = false;
  auto system = System::compile(std::move(all));
  if (failed(system)) return c;
  c.system = std::move(system).value();
  return c;
}

ProblemData::ProblemData(const System& system)
    : predicted(system.parts().rest),
      force(system.parts().rest.size()),
      position(system.free_bases().size()),
      target(at(system.rows())),
      prescribed(at(system.prescribed_rows())) {}

void ProblemData::at_time(const System& system, double t) {
  const SystemParts& parts = system.parts();
  memory.resize(at(system.memory()));
  system.start_memory(memory);
  std::fill(force.begin(), force.end(), Vec3{});
  for (const auto& load : parts.loads) load->add(t, force);
  for (std::size_t p = 0; p < parts.row_pools.size(); ++p) {
    const RowPool& pool = *parts.row_pools[p];
    auto& all = pool.law == RowLaw::compliant ? target : prescribed;
    pool.update(t, std::span(all).subspan(at(system.first_row(static_cast<Index>(p))), at(pool.rows())));
  }
  std::size_t first = 0;
  for (const auto& p : parts.prescribers) {
    p->target(t, std::span(position).subspan(first, p->nodes.size()));
    first += p->nodes.size();
  }
}

SaddleProblem ProblemData::problem() const {
  SaddleProblem p;
  p.mass_scale = mass_scale;
  p.predicted = predicted;
  p.force = force;
  p.target = target;
  p.prescribed = prescribed;
  p.position = position;
  p.memory = memory;
  return p;
}

}  // namespace test
