// Batches: many worlds of one scene.
#include "stepping.h"

using namespace isochor;
using namespace isochor::c;

namespace {

std::size_t size_of(const iso_batch& batch) {
  return static_cast<std::size_t>(batch.batch.size());
}

void check_count(const iso_batch& batch, std::size_t count, const char* what) {
  if (count != size_of(batch))
    refuse("there are " + std::to_string(count) + " " + what + " and " + std::to_string(size_of(batch)) +
           " worlds; give one a world");
}

void work(iso_batch& batch, iso_report* reports, std::size_t count, const auto& step) {
  if (reports != nullptr) {
    check_count(batch, count, "reports");
    check_size(reports, "reports");
    for (std::size_t i = 1; i < count; ++i) {
      if (nth(reports, i)->size != reports->size)
        refuse("reports[" + std::to_string(i) + "].size = " + std::to_string(nth(reports, i)->size) +
               " and that of the first is " + std::to_string(reports->size) + "; they must be the same");
    }
  }
  batch.reports = step(batch.batch);
  for (std::size_t i = 0; reports != nullptr && i < count; ++i) {
    Filled<iso_report> told(nth(reports, i), "reports");
    show(batch.reports[i], *told);
    told.give();
  }
  for (std::size_t i = 0; i < batch.reports.size(); ++i) {
    const StepReport& report = batch.reports[i];
    if (report.status != StepStatus::converged)
      throw Refused{status_of(report.status), "world " + std::to_string(i) + ": " + report.reason};
  }
}

// Vectors of all worlds, through memory of our own: C hands out doubles.
void copy_vectors(double* out, std::size_t count, const auto& ask) {
  if (count > 0) (void)given(out, "out");
  std::vector<Vec3> all(count);
  need(ask(std::span<Vec3>(all)));
  for (std::size_t i = 0; i < count; ++i) put(all[i], out + 3 * i);
}

// Refused before memory of that size is asked for.
void check_vectors(iso_batch& batch, iso_body body, std::size_t count) {
  const World& first = std::as_const(batch.batch)[0];
  const std::size_t all = size_of(batch) * first.positions(body_of(first, body)).size();
  if (count != all)
    refuse("there is room for " + std::to_string(count) + " vectors, and the worlds have " +
           std::to_string(all) + "; give a vector a node of every world");
}

}  // namespace

extern "C" iso_status iso_batch_create(iso_world* world, int32_t count, int32_t threads, iso_batch** out) {
  return enter(world, "iso_batch_create", [&] {
    (void)given(out, "out");
    if (count < 1 || threads < 0)
      refuse("count = " + std::to_string(count) + " and threads = " + std::to_string(threads) +
             "; a batch has at least one world, and 0 threads stand for all");
    auto batch = std::make_unique<iso_batch>(need(WorldBatch::create(*world->world, count, threads)));
    for (Index i = 0; i < batch->batch.size(); ++i)
      batch->worlds.push_back(std::make_unique<iso_world>(batch->batch[i], world->keys, batch->callers));
    *out = batch.release();
  });
}

extern "C" iso_status iso_batch_free(iso_batch* batch) {
  if (batch == nullptr) return ISO_OK;
  const iso_status status = enter(batch, "iso_batch_free", [] {});
  if (status != ISO_OK) return status;
  batch->kind = Kind{};
  delete batch;
  return ISO_OK;
}

extern "C" const char* iso_batch_last_error(const iso_batch* batch) {
  if (batch == nullptr) return kNoBatch;
  return good(batch) ? batch->said.get() : kNotABatch;
}

extern "C" iso_status iso_batch_size(iso_batch* batch, int32_t* out) {
  return enter(batch, "iso_batch_size", [&] { given(out, "out") = batch->batch.size(); });
}

extern "C" iso_status iso_batch_threads(iso_batch* batch, int32_t* out) {
  return enter(batch, "iso_batch_threads", [&] { given(out, "out") = batch->batch.threads(); });
}

extern "C" iso_status iso_batch_world(iso_batch* batch, int32_t number, iso_world** out) {
  return enter(batch, "iso_batch_world", [&] {
    (void)given(out, "out");
    if (number < 0 || number >= batch->batch.size())
      refuse("number = " + std::to_string(number) + "; the worlds have the numbers 0 to " +
             std::to_string(batch->batch.size() - 1));
    *out = batch->worlds[static_cast<std::size_t>(number)].get();
  });
}

extern "C" iso_status iso_batch_advance(iso_batch* batch, double h, iso_report* reports, size_t count) {
  return enter(batch, "iso_batch_advance",
               [&] { work(*batch, reports, count, [h](WorldBatch& b) { return b.advance(h); }); });
}

extern "C" iso_status iso_batch_step(iso_batch* batch, double h, int32_t iterations, double seconds,
                                     iso_report* reports, size_t count) {
  return enter(batch, "iso_batch_step", [&] {
    work(*batch, reports, count, [&](WorldBatch& b) { return b.step(h, {iterations, seconds}); });
  });
}

extern "C" iso_status iso_batch_reset(iso_batch* batch, const uint8_t* marks, size_t count) {
  return enter(batch, "iso_batch_reset", [&] {
    if (marks == nullptr) {
      need(batch->batch.reset());
      return;
    }
    check_count(*batch, count, "marks");
    need(batch->batch.reset({marks, count}));
  });
}

extern "C" iso_status iso_batch_set_amounts(iso_batch* batch, iso_effect effect, const double* amounts,
                                            size_t count) {
  return enter(batch, "iso_batch_set_amounts", [&] {
    check_count(*batch, count, "amounts");
    const EffectId id = effect_of(batch->batch[0], effect);
    need(batch->batch.set_amounts(id, {&given(amounts, "amounts"), count}));
  });
}

extern "C" iso_status iso_batch_positions(iso_batch* batch, iso_body body, double* out, size_t count) {
  return enter(batch, "iso_batch_positions", [&] {
    check_vectors(*batch, body, count);
    copy_vectors(out, count, [&](std::span<Vec3> all) { return batch->batch.positions(id(body), all); });
  });
}

extern "C" iso_status iso_batch_velocities(iso_batch* batch, iso_body body, double* out, size_t count) {
  return enter(batch, "iso_batch_velocities", [&] {
    check_vectors(*batch, body, count);
    copy_vectors(out, count, [&](std::span<Vec3> all) { return batch->batch.velocities(id(body), all); });
  });
}

extern "C" iso_status iso_batch_memory(iso_batch* batch, size_t* each, size_t* shared) {
  return enter(batch, "iso_batch_memory", [&] {
    const WorldBatch::Memory memory = batch->batch.memory();
    given(each, "each") = memory.each;
    given(shared, "shared") = memory.shared;
  });
}
