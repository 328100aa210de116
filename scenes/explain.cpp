#include "scenes/explain.h"

#include <algorithm>
#include <chrono>

#include "engine/scene/builder.h"
#include "engine/system/system.h"
#include "scenes/effects/kind.h"

namespace isochor {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The least of several evaluations of a pool at rest with multipliers of zero.
double evaluation_seconds(const StencilPool& pool, std::span<const Vec3> rest) {
  const auto stencils = static_cast<std::size_t>(pool.stencils());
  const auto functions = static_cast<std::size_t>(pool.functions());
  const std::size_t places = pool.nodes().item.size();
  std::vector<double> energy(stencils), value(stencils * functions), multiplier(stencils * functions, 0.0);
  std::vector<Vec3> gradient(places), jacobian(places * functions);
  std::vector<Mat3> hessian(static_cast<std::size_t>(pool.hessian_offset().back()));
  StencilRequest request;
  request.want = Want::hessian;
  request.end = pool.stencils();
  request.x = request.rest = rest;
  request.function_multiplier = multiplier;
  double best = 0;
  for (int k = 0; k < 4; ++k) {
    const double start = now();
    pool.evaluate(request, {energy, value, gradient, jacobian, hessian});
    const double seconds = now() - start;
    if (k == 1 || (k > 1 && seconds < best)) best = seconds;
  }
  return best;
}

std::size_t slot_bytes(const StencilPool& pool) {
  const auto stencils = static_cast<std::size_t>(pool.stencils());
  const auto functions = static_cast<std::size_t>(pool.functions());
  const std::size_t places = pool.nodes().item.size();
  return stencils * sizeof(double) * (1 + 2 * functions) + places * sizeof(Vec3) * (2 + functions) +
         static_cast<std::size_t>(pool.hessian_offset().back()) * sizeof(Mat3);
}

std::string quoted(const std::string& name) {
  return "\"" + name + "\"";
}

const char* element_name(Element e) {
  switch (e) {
    case Element::tet4:
      return "Tet4";
    case Element::tet4_edge_smoothed:
      return "edge-smoothed Tet4";
    case Element::tet10:
      return "Tet10";
    case Element::tri3:
      return "thin, of triangles";
    default:
      return "element";
  }
}

std::vector<EffectNote> notes_of(const SceneDef& scene, bool guarded) {
  std::vector<EffectNote> out;
  for (const SceneBody& body : scene.bodies)
    out.push_back({"body " + quoted(body.name), std::string("of the scene; ") + element_name(body.element)});
  for (const EffectKind* kind : kinds_by_phase()) {
    if (kind->phase == EffectPhase::volume_rows) kind->explain(*kind, scene, out);
  }
  const bool asked = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                 [](const SceneBody& b) { return b.guard_stiffness.has_value(); });
  if (guarded)
    out.push_back({"element guard", asked ? "of the scene" : "by default: the body is edge-smoothed"});
  if (scene.analysis.type == AnalysisType::dynamics)
    out.push_back({"inertia", "of the scene: the analysis is dynamic"});
  const Vec3& gravity = scene.analysis.options.gravity;
  if (dot(gravity, gravity) > 0) out.push_back({"gravity", "of the scene"});
  for (const EffectKind* kind : kinds_by_phase()) {
    if (kind->phase != EffectPhase::volume_rows) kind->explain(*kind, scene, out);
  }
  return out;
}

}  // namespace

Result<CompiledScene> compile_parts(const SceneParts& parts, bool statics) {
  CompiledScene out;
  Builder builder;
  for (const BodyDef& body : parts.bodies) {
    if (auto r = builder.add_body(body); !r) return r.failure();
  }
  for (const EffectPtr& e : parts.effects) {
    if (auto r = e->check(); !r) return r.failure();
    if (auto r = e->declare(builder); !r) return r.failure();
  }
  if (auto r = builder.build_solids(); !r) return r.failure();
  for (const EffectPtr& e : parts.effects) {
    auto instance = e->build(builder);
    if (!instance) return instance.failure();
    out.instances.push_back(std::move(instance).value());
  }
  auto finished = builder.finish(statics);
  if (!finished) return finished.failure();
  auto system = System::compile(std::move(finished).value());
  if (!system) return system.failure();
  out.system = std::move(system).value();
  return out;
}

Result<Explanation> explain(const SceneDef& scene) {
  SceneParts parts;
  auto built = build(scene, {1, &parts});
  if (!built) return built.failure();
  auto compiled = compile_parts(parts, scene.analysis.type == AnalysisType::statics);
  if (!compiled) return compiled.failure();
  const System& system = *compiled.value().system;
  Explanation out;
  out.nodes = system.nodes();
  out.displacements = system.free_unknowns();
  out.held = 3 * system.nodes() - system.free_unknowns();
  out.multipliers = system.rows();
  out.nonzeros = system.kkt().nonzeros();
  out.loads = system.parts().loads.size();
  for (const auto& pool : system.parts().stencil_pools) {
    PoolShare share;
    share.name = std::string(pool->name());
    share.stencils = pool->stencils();
    share.blocks = pool->hessian_offset().back();
    share.bytes = slot_bytes(*pool);
    share.seconds = evaluation_seconds(*pool, system.parts().rest);
    out.pools.push_back(std::move(share));
  }
  for (const auto& rows : system.parts().row_pools) {
    PoolShare& share = out.pools[static_cast<std::size_t>(rows->stencil_pool)];
    (rows->law == RowLaw::compliant ? share.multipliers : share.prescribed) += rows->rows();
    share.rows_name += (share.rows_name.empty() ? "" : ", ") + std::string(rows->name());
  }
  // The barrier of smoothed bodies is the energy of their single tets; the patches carry the material's.
  bool guarded = false;
  const auto& pools = system.parts().stencil_pools;
  for (std::size_t p = 0; p < pools.size(); ++p) {
    const bool smoothed = std::any_of(out.pools.begin(), out.pools.end(), [&](const PoolShare& other) {
      return other.name == out.pools[p].name + "/patches";
    });
    if (!smoothed || !pools[p]->has_energy()) continue;
    guarded = true;
    out.pools[p].name += " (guard)";
  }
  out.effects = notes_of(scene, guarded);
  return out;
}

}  // namespace isochor
