// Steps: what drives them, what they report, who watches.
#include "stepping.h"

namespace isochor::c {

void show(const StepReport& from, iso_report& out) {
  out.status = status_of(from.status);
  out.reason = from.reason.c_str();
  out.warning = from.warning.c_str();
  out.time = from.time;
  out.iterations = from.iterations;
  out.corrections = from.corrections;
  out.factorizations = from.factorizations;
  out.substeps = from.substeps;
  out.rejected_substeps = from.rejected_substeps;
  out.rescues = from.rescues;
  out.unstable_directions = from.unstable_directions;
  out.min_J = from.min_J;
  out.inverted_cells = from.inverted_cells;
  out.force_residual = from.force_residual;
  out.row_residual = from.row_residual;
  out.time_error = from.time_error;
  out.seconds = from.seconds.total;
  out.factor_seconds = from.seconds.factor;
  out.solve_seconds = from.seconds.solve;
  out.compiled = {sizeof out.compiled, static_cast<std::int32_t>(from.compiled.work), from.compiled.seconds};
}

}  // namespace isochor::c

using namespace isochor;
using namespace isochor::c;

namespace {

iso_status run(iso_world* world, const char* call, iso_report* report, const auto& step) {
  return enter(world, call, [&] {
    if (report != nullptr) check_size(report, "report");
    StepReport& kept = world->answers.report;
    kept = step(*world->world);
    if (report != nullptr) {
      Filled<iso_report> told(report, "report");
      show(kept, *told);
      told.give();
    }
    if (kept.status != StepStatus::converged) throw Refused{status_of(kept.status), kept.reason};
  });
}

// Counted before they are read.
std::vector<Vec3> one_a_node(World& world, BodyId body, const double* xyz, std::size_t count,
                             std::size_t stride, const char* name) {
  need(world.compile());
  const std::size_t nodes = world.positions(body).size();
  if (count != nodes)
    refuse(std::to_string(count) + " " + name + " for the " + std::to_string(nodes) + " nodes of body \"" +
           world.body_name(body) + "\"; give one a node");
  return vectors(xyz, count, stride, name);
}

}  // namespace

extern "C" iso_status iso_set_amount(iso_world* world, iso_effect effect, double amount) {
  return enter(world, "iso_set_amount",
               [&] { need(world->world->set_amount(effect_of(*world->world, effect), amount)); });
}

extern "C" iso_status iso_set_gravity(iso_world* world, const double gravity[3]) {
  return enter(world, "iso_set_gravity", [&] {
    const Vec3 g = vector(gravity, "gravity");
    need(world->world->set_gravity(g));
    world->keys.gravity = g;
    world->keys.gravity_curve = Curve::constant(1);
  });
}

extern "C" iso_status iso_set_pose(iso_world* world, iso_effect effect, const iso_pose* pose) {
  return enter(world, "iso_set_pose", [&] {
    const iso_pose p = taken(pose, "pose");
    Pose to;
    to.position = vector(p.position, "pose->position");
    to.rotation = {p.rotation[0], p.rotation[1], p.rotation[2], p.rotation[3]};
    if (to.rotation == std::array<double, 4>{}) to.rotation = {1, 0, 0, 0};
    need(world->world->set_pose(effect_of(*world->world, effect), to));
  });
}

extern "C" iso_status iso_set_forces(iso_world* world, iso_body body, const double* forces, size_t count,
                                     size_t stride) {
  return enter(world, "iso_set_forces", [&] {
    const BodyId id = body_of(*world->world, body);
    need(world->world->set_forces(id, one_a_node(*world->world, id, forces, count, stride, "forces")));
  });
}

extern "C" iso_status iso_add_force(iso_world* world, iso_body body, int32_t node, const double force[3]) {
  return enter(world, "iso_add_force", [&] {
    need(world->world->add_force(body_of(*world->world, body), node, vector(force, "force")));
  });
}

extern "C" iso_status iso_add_force_at(iso_world* world, iso_body body, const double point[3],
                                       const double force[3]) {
  return enter(world, "iso_add_force_at", [&] {
    need(world->world->add_force_at(body_of(*world->world, body), vector(point, "point"),
                                    vector(force, "force")));
  });
}

extern "C" iso_status iso_clear_forces(iso_world* world) {
  return enter(world, "iso_clear_forces", [&] { world->world->clear_forces(); });
}

extern "C" iso_status iso_set_positions(iso_world* world, iso_body body, const double* positions,
                                        size_t count, size_t stride) {
  return enter(world, "iso_set_positions", [&] {
    const BodyId id = body_of(*world->world, body);
    need(world->world->set_positions(id,
                                     one_a_node(*world->world, id, positions, count, stride, "positions")));
  });
}

extern "C" iso_status iso_set_velocities(iso_world* world, iso_body body, const double* velocities,
                                         size_t count, size_t stride) {
  return enter(world, "iso_set_velocities", [&] {
    const BodyId id = body_of(*world->world, body);
    need(world->world->set_velocities(
        id, one_a_node(*world->world, id, velocities, count, stride, "velocities")));
  });
}

extern "C" iso_status iso_step(iso_world* world, double h, iso_report* report) {
  return run(world, "iso_step", report, [&](World& w) { return w.step(h); });
}

extern "C" iso_status iso_step_within(iso_world* world, double h, int32_t iterations, double seconds,
                                      iso_report* report) {
  return run(world, "iso_step_within", report, [&](World& w) { return w.step(h, {iterations, seconds}); });
}

extern "C" iso_status iso_advance(iso_world* world, double h, iso_report* report) {
  return run(world, "iso_advance", report, [&](World& w) { return w.advance(h); });
}

extern "C" iso_status iso_follow(iso_world* world, double length, iso_report* report) {
  return run(world, "iso_follow", report, [&](World& w) { return w.follow(length); });
}

extern "C" iso_status iso_cancel(iso_world* world) {
  if (!good(world)) return ISO_REFUSED;
  world->world->cancel();
  return ISO_OK;
}

extern "C" iso_status iso_on_progress(iso_world* world, iso_progress_fn callback, void* user) {
  return enter(world, "iso_on_progress", [&] {
    if (callback == nullptr) {
      world->world->on_progress({});
      return;
    }
    world->world->on_progress([callback, user](const ProgressInfo& info) {
      const iso_progress progress{sizeof progress, info.time,           info.target,
                                  info.iteration,  info.force_residual, info.row_residual};
      callback(user, &progress);
    });
  });
}

extern "C" iso_status iso_stop_when(iso_world* world, iso_stop_fn callback, void* user) {
  return enter(world, "iso_stop_when", [&] {
    if (callback == nullptr)
      world->world->stop_when({});
    else
      world->world->stop_when([callback, user] { return callback(user) != 0; });
  });
}
