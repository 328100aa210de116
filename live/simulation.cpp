#include "live/simulation.h"

#include <atomic>
#include <chrono>
#include <cmath>

#include "engine/base/text.h"
#include "scenes/law_limits.h"

namespace isochor::live {

namespace {

using Clock = std::chrono::steady_clock;

double extent_of(const PageScene& scene) {
  if (scene.rest.empty()) return 1;
  Vec3 low = scene.rest[0], high = low;
  // Bodies alone: a table may be as large as it likes.
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    if (scene.parts[static_cast<std::size_t>(scene.triangle_part[t / 3])].obstacle) continue;
    const Vec3& p = scene.rest[static_cast<std::size_t>(scene.triangles[t])];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  const double size = std::sqrt(dot(high - low, high - low));
  return size > 0 ? size : 1;
}

}  // namespace

Simulation::Simulation(SceneDef scene, SimulationOptions options)
    : scene_(std::move(scene)), options_(std::move(options)), plan_(plan_steps(scene_.analysis)) {}

Result<std::unique_ptr<Simulation>> Simulation::make(SceneDef scene, SimulationOptions options) {
  std::unique_ptr<Simulation> made(new Simulation(std::move(scene), std::move(options)));
  if (auto r = made->start(); !r) return r.failure();
  return made;
}

Result<void> Simulation::start() {
  auto built = build(scene_, {options_.threads});
  if (!built) return built.failure();
  built_.emplace(std::move(built).value());
  auto copy = built_->world.clone();
  if (!copy) return copy.failure();
  beginning_.emplace(std::move(copy).value());
  scheduled_at_first_ = built_->scheduled;
  recorder_ = std::make_unique<StepRecorder>(scene_, *built_);
  shown_.scene = scene_.name;
  shown_.threads = options_.threads;
  shown_.size = built_->world.size();
  for (const BodyId id : built_->bodies) shown_.elements += built_->world.mesh(id).cell_count();
  name_records(scene_, shown_);
  const StepRecord first = recorder_->look(0, {});
  gauges_ = first.gauges.size();
  shown_.records = {first};
  shape_.emplace(RunView{scene_, *built_, shown_});
  maps_ = shape_->frame({scene_, *built_, shown_}, {}).fields;
  const double extent = extent_of(shape_->scene());
  poses_.emplace(scene_, *built_, extent);
  dials_ = std::make_unique<Dials>(scene_, *poses_, spring_for(scene_, extent), extent);
  hand_ = Hand(extent);
  list_measures();
  return {};
}

std::vector<std::string> Simulation::notes() const {
  std::vector<std::string> out = beginning_->warnings();
  for (const std::string& w : recorder_->warnings()) out.push_back(w);
  return out;
}

void Simulation::list_measures() {
  constexpr std::size_t most = 60;
  for (const std::string& name : shown_.cavities) {
    measures_.push_back({"Chambers", name + " pressure", "Pa"});
    measures_.push_back({"Chambers", name + " volume", "m\u00b3"});
  }
  for (const std::string& name : shown_.probes) {
    for (const char* axis : {" x", " y", " z"}) measures_.push_back({"Probes", name + axis, "m"});
  }
  for (const Gauge& g : shown_.records[0].gauges) {
    if (measures_.size() >= most) break;
    measures_.push_back({"Gauges", g.effect + " " + g.quantity, g.unit == "1" ? "" : g.unit});
  }
}

StepRecord Simulation::look() const {
  StepRecord record = recorder_->look(step_, report_);
  // Those of what is held by hand come last, and not into tables whose columns stay.
  if (record.gauges.size() > gauges_) record.gauges.resize(gauges_);
  return record;
}

Result<Hit> Simulation::hit(const Command& c) const {
  const PageScene& s = shape_->scene();
  const auto t = static_cast<std::size_t>(c.triangle);
  if (3 * t >= s.triangles.size())
    return Error{"triangle " + std::to_string(c.triangle) + " is not there; there are " +
                 std::to_string(s.triangles.size() / 3) + ", counted from 0"};
  const auto part = static_cast<std::size_t>(s.triangle_part[t]);
  if (s.parts[part].obstacle || part >= built_->bodies.size())
    return Error{"\"" + s.parts[part].name + "\" is no soft body; take hold of one that is"};
  const PageFrame now = shape_->frame({scene_, *built_, shown_}, {});
  Hit hit;
  hit.body = part;
  std::array<Vec3, 3> x;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(s.triangles[3 * t + k]);
    x[k] = now.positions[v];
    hit.rest += c.weights[k] * s.rest[v];
    hit.now += c.weights[k] * x[k];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = x[k] - x[(k + 1) % 3];
    hit.size = std::max(hit.size, std::sqrt(dot(side, side)));
  }
  const Vec3 n = cross(x[1] - x[0], x[2] - x[0]);
  const double size = std::sqrt(dot(n, n));
  if (size > 0) hit.normal = (1 / size) * n;
  return hit;
}

Result<void> Simulation::apply(const Command& c) {
  const auto held = [&](HandleKind kind) -> Result<void> {
    auto at = hit(c);
    if (!at) return at.failure();
    auto id = hand_.hold(kind, at.value(), dials_->spring(), *built_);
    return id ? Result<void>() : id.failure();
  };
  Result<void> done;
  switch (c.action) {
    case Action::reset:
      done = begin_again();
      break;
    case Action::set:
      done = dials_->set(static_cast<std::size_t>(c.control), c.value, *built_);
      break;
    case Action::pull:
      done = held(HandleKind::pull);
      break;
    case Action::pin:
      done = held(HandleKind::pin);
      break;
    case Action::push:
      done = held(HandleKind::push);
      break;
    case Action::move:
      done = hand_.move(c.handle, c.to);
      break;
    case Action::release:
      done = hand_.release(c.handle, *built_);
      break;
    case Action::record:
      done = record();
      break;
    case Action::stop_recording:
      done = end_recording();
      break;
    case Action::take:
    case Action::play:
    case Action::pause:
    case Action::step:
    case Action::speed:
      return {};
  }
  if (!done) {
    message_ = done.error();
    return done;
  }
  changed_ = changed_ || (c.action != Action::record && c.action != Action::stop_recording);
  // A world that has changed may be tried again.
  if (changed_) failed_ = false;
  return {};
}

Result<void> Simulation::begin_again() {
  auto fresh = beginning_->clone();
  if (!fresh) return fresh.failure();
  const auto ended = end_recording();
  built_->world = std::move(fresh).value();
  built_->scheduled = scheduled_at_first_;
  hand_.forget();
  dials_->forget();
  poses_->forget(*built_);
  report_ = {};
  step_ = 0;
  seconds_ = 0;
  message_.clear();
  return ended;
}

bool Simulation::settled() const {
  if (dynamic() || changed_ || !hand_.arrived() || !poses_->arrived(built_->world.time())) return false;
  return built_->world.time() >= scene_.analysis.duration - 0.5 * plan_.h;
}

Result<void> Simulation::keep_schedule() {
  if (built_->scheduled.empty()) return {};
  const auto changed = follow_schedule(*built_, built_->world.time() + 0.5 * plan_.h);
  return changed ? Result<void>() : changed.failure();
}

StepEnd Simulation::advance() {
  auto prepared = hand_.prepare(*built_);
  if (prepared) prepared = poses_->prepare(*built_, plan_.h);
  if (prepared) prepared = keep_schedule();
  if (!prepared) {
    message_ = prepared.error();
    failed_ = true;
    return StepEnd::failed;
  }
  World& world = built_->world;
  const double before = world.time();
  const auto start = Clock::now();
  std::atomic<bool> late{false};
  world.stop_when([this, start, &late] {
    if (std::chrono::duration<double>(Clock::now() - start).count() > options_.step_limit) late = true;
    return late || (options_.interrupted && options_.interrupted());
  });
  const auto& path = scene_.analysis.path_step;
  report_ = path ? world.follow(*path) : world.advance(plan_.h);
  world.stop_when({});
  seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
  return told(report_, before, late);
}

StepEnd Simulation::told(const StepReport& report, double before, bool too_long) {
  const bool moved = built_->world.time() != before;
  if (moved) ++step_;
  if (moved && recording_) {
    StepRecord record = look();
    recorder_->measure(record);
    const auto added = recording_->add(scene_, *built_, std::move(record));
    if (!added || !added.value()) {
      const std::string why = added ? "the recording is full and has been ended" : added.error();
      const auto ended = end_recording();
      message_ = ended ? why : why + "; " + ended.error();
    }
  }
  if (report.status == StepStatus::converged) {
    message_ = report.warning;
    changed_ = failed_ = false;
    return StepEnd::done;
  }
  if (report.status == StepStatus::cancelled && !too_long) return StepEnd::interrupted;
  message_ = report.reason;
  if (too_long) {
    message_ = "the step took longer than " + number(options_.step_limit) +
               " s and was given up; take a coarser mesh, or a larger --step-limit";
  }
  if (const std::string limit = law_limit_reached(scene_, *built_); !limit.empty()) message_ += "; " + limit;
  failed_ = true;
  changed_ = false;
  return StepEnd::failed;
}

Result<void> Simulation::record() {
  if (recording_) return Error{"a recording goes on already, in " + recording_->folder()};
  if (options_.folder.empty()) return Error{"there is no folder for recordings; name one with --out"};
  constexpr int most = 100;
  if (recordings_ >= most) return Error{"100 recordings are all that one session makes"};
  ++recordings_;
  const std::string folder =
      recordings_ == 1 ? options_.folder : options_.folder + "_" + std::to_string(recordings_);
  StepRecord first = look();
  recorder_->measure(first);
  auto begun = Recording::begin(folder, scene_, *built_, shown_, std::move(first));
  if (!begun) return begun.failure();
  recording_.emplace(std::move(begun).value());
  return {};
}

Result<void> Simulation::end_recording() {
  if (!recording_) return {};
  auto ended = recording_->end(scene_, *built_);
  recording_.reset();
  return ended;
}

Result<void> Simulation::close() {
  return end_recording();
}

Picture Simulation::picture(bool fields) const {
  Picture p;
  shown_.records.resize(1);
  shown_.records[0] = look();
  const RunView view{scene_, *built_, shown_};
  std::vector<BodyFields> values;
  for (std::size_t b = 0; fields && b < built_->bodies.size(); ++b)
    values.push_back(built_->world.fields(built_->bodies[b]));
  p.frame = shape_->frame(view, values);
  p.step = step_;
  p.time = built_->world.time();
  for (std::size_t d = 0; d < dials_->list().size(); ++d) p.dials.push_back(dials_->value(d, p.time));
  const StepRecord& r = shown_.records[0];
  for (const CavityState& c : r.cavities) p.measures.insert(p.measures.end(), {c.pressure, c.volume});
  for (const Vec3& v : r.probes) p.measures.insert(p.measures.end(), {v.x, v.y, v.z});
  for (const Gauge& g : r.gauges) p.measures.push_back(g.value);
  p.measures.resize(measures_.size());
  p.handles = hand_.states(*built_);
  p.message = message_;
  p.failed = failed_;
  if (recording_) {
    p.recorded = static_cast<int>(recording_->steps());
    p.recorded_in = recording_->folder();
  }
  p.hash = built_->world.state_hash();
  return p;
}

}  // namespace isochor::live
