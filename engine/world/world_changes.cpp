// A world that changes while it lives. What changes its structure or its constants goes into a draft, which
// the next call that needs the scene compiles (renewal.cpp); gravity, poses, amounts and forces are there at
// once.
#include <algorithm>
#include <cmath>

#include "engine/base/fingerprint.h"
#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/scene/embedding.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

std::string text_of(const Vec3& v) {
  std::string text = "(";
  text += number(v.x) + ", " + number(v.y) + ", " + number(v.z);
  return text + ")";
}

bool names_body(const EffectSource& effect, Index number) {
  std::vector<Index> named;
  Fingerprint f;
  f.list_bodies(named);
  effect.describe(f);
  return std::find(named.begin(), named.end(), number) != named.end();
}

}  // namespace

Result<void> World::replace(EffectId effect, EffectPtr with) try {
  if (auto r = check(effect); !r) return Error{"replace: " + r.error()};
  if (!with) return Error{"replace: the new effect is empty"};
  if (auto r = with->check(); !r) return Error{"replace: " + r.error()};
  impl_->open_draft().sources[static_cast<std::size_t>(effect)] = std::move(with);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("replace");
}

Result<void> World::remove(EffectId effect) try {
  if (auto r = check(effect); !r) return Error{"remove: " + r.error()};
  Description& d = impl_->open_draft();
  const auto place = static_cast<Index>(effect);
  d.places.release(place);
  d.sources[at(place)] = nullptr;
  d.order.erase(std::find(d.order.begin(), d.order.end(), place));
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("remove");
}

Result<void> World::remove(BodyId body) try {
  if (auto r = check(body); !r) return Error{"remove: " + r.error()};
  const auto place = body == BodyId{} ? Index{0} : static_cast<Index>(body);
  const Description& now = impl_->latest();
  for (const Index e : now.order) {
    if (!names_body(*now.sources[at(e)], place)) continue;
    return Error{"remove: body \"" + now.builder.bodies()[at(place)].name + "\" is named by effect \"" +
                 now.sources[at(e)]->name() + "\"; remove that first"};
  }
  impl_->open_draft().builder.remove_body(place);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("remove");
}

Result<void> World::set_material(BodyId body, const std::string& region, MaterialPtr material) try {
  if (auto r = check(body); !r) return Error{"set_material: " + r.error()};
  return impl_->open_draft().builder.set_material(body, region, material);
} catch (const std::bad_alloc&) {
  return no_memory("set_material");
}

Result<void> World::set_density(BodyId body, const std::string& region, double density) try {
  if (auto r = check(body); !r) return Error{"set_density: " + r.error()};
  return impl_->open_draft().builder.set_density(body, region, density);
} catch (const std::bad_alloc&) {
  return no_memory("set_density");
}

Result<void> World::set_gravity(const Vec3& gravity) {
  if (!finite(gravity))
    return Error{"set_gravity: gravity = " + text_of(gravity) + " m/s^2; give finite numbers"};
  impl_->amounts.gravity.set(gravity);
  return {};
}

Result<void> World::set_pose(EffectId effect, const Pose& pose) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (auto r = check(effect); !r) return Error{"set_pose: " + r.error()};
  const auto i = static_cast<std::size_t>(effect);
  LivePose* p = w.instances[i]->pose();
  if (!p) {
    return Error{"set_pose: effect \"" + w.said.sources[i]->name() +
                 "\" has no pose to set; supports and obstacles have one"};
  }
  if (auto r = check_poses({{pose}, {}}); !r)
    return Error{"set_pose: effect \"" + w.said.sources[i]->name() + "\": " + r.error()};
  p->set(pose);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("set_pose");
}

Result<void> World::set_forces(BodyId body, std::span<const Vec3> forces) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (auto r = check(body); !r) return Error{"set_forces: " + r.error()};
  const BodyData& b = w.said.builder.body(body);
  if (forces.size() != b.mesh.nodes.size()) {
    return Error{"set_forces: " + std::to_string(forces.size()) + " forces for the " +
                 std::to_string(b.mesh.nodes.size()) + " nodes of body \"" + b.name + "\"; give one a node"};
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (finite(forces[i])) continue;
    return Error{"set_forces: the force on node " + std::to_string(i) + " of body \"" + b.name +
                 "\" is not a finite number"};
  }
  w.state.forces.resize(w.state.x.size());
  std::copy(forces.begin(), forces.end(), w.state.forces.begin() + b.first_node);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("set_forces");
}

Result<void> World::add_force(BodyId body, Index node, const Vec3& force) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (auto r = check(body); !r) return Error{"add_force: " + r.error()};
  const BodyData& b = w.said.builder.body(body);
  if (node < 0 || node >= b.mesh.node_count()) {
    return Error{"add_force: node " + std::to_string(node) + " is not in body \"" + b.name +
                 "\", which has nodes 0 to " + std::to_string(b.mesh.node_count() - 1)};
  }
  if (!finite(force)) return Error{"add_force: the force is " + text_of(force) + " N; give finite numbers"};
  w.state.forces.resize(w.state.x.size());
  w.state.forces[at(b.first_node + node)] += force;
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("add_force");
}

Result<void> World::add_force_at(BodyId body, const Vec3& point, const Vec3& force) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  if (auto r = check(body); !r) return Error{"add_force_at: " + r.error()};
  const BodyData& b = w.said.builder.body(body);
  if (!finite(force) || !finite(point))
    return Error{"add_force_at: force " + text_of(force) + " N at " + text_of(point) +
                 " m; give finite numbers"};
  const auto found = embed(b, w.system().parts().rest, point, "add_force_at");
  if (!found) return found.failure();
  w.state.forces.resize(w.state.x.size());
  const PointInBody& p = found.value();
  for (std::size_t k = 0; k < p.nodes.size(); ++k) w.state.forces[at(p.nodes[k])] += p.weight[k] * force;
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("add_force_at");
}

void World::clear_forces() {
  impl_->state.forces.clear();
}

Result<void> World::reset() try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  w.begin_state();
  w.settled.reset();
  w.amounts.forget();
  w.data->evaluate(w.system(), w.state.t);
  // Should memory run out here, the world is reset and its stencils follow with the next call.
  return w.put_stencils_back();
} catch (const std::bad_alloc&) {
  return no_memory("reset");
}

Result<World> World::clone(int threads) const try {
  Impl& w = *impl_;
  if (threads < 0 || threads > 1024) {
    return Error{"clone: threads = " + std::to_string(threads) +
                 "; give 0 (as many as this world has) or a number up to 1024"};
  }
  if (auto r = w.compile(); !r) return r.failure();
  std::unique_ptr<Parallel> parallel;
  if (threads > 0)
    parallel = std::make_unique<TbbParallel>(threads);
  else
    parallel = w.parallel->another();
  auto impl = std::make_unique<Impl>(w.options, std::move(parallel));
  impl->said = {w.said.builder.again(), w.said.places, w.said.sources, w.said.order};
  if (auto r = impl->compile_like(w); !r) return r.failure();
  return World(std::move(impl));
} catch (const std::bad_alloc&) {
  return no_memory("clone");
}

const CompileReport& World::compile_report() const {
  return impl_->compile_report;
}

}  // namespace isochor
