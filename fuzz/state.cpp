// Saved states: the first byte chooses a world, and from 128 on a checksum that fits; the rest is XORed into
// its own saved state, so that an input of zeros is the state as it was saved; longer inputs append, shorter
// ones truncate where their last byte is odd. What is loaded must be finite and must go on without a fault,
// and what is refused leaves the world as it was.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "engine/base/base.h"
#include "fuzz/input.h"
#include "scenes/scene.h"

namespace {

using namespace isochor;

SceneDef block() {
  SceneDef s;
  SceneBody body;
  BoxMeshDef box;
  box.divisions = {2, 1, 1};
  body.mesh = box;
  MaterialDef m;
  m.constants.young = 1000;
  m.constants.poisson = 0.5;
  body.materials = {m};
  s.bodies = {body};
  DirichletDef hold;
  hold.where.surfaces = {"x0"};
  s.dirichlet = {hold};
  s.analysis.type = AnalysisType::dynamics;
  s.analysis.steps = 10;
  s.analysis.options.gravity = {0, 0, -1};
  return s;
}

// Contact, friction and restitution keep more than positions.
SceneDef on_floor() {
  SceneDef s = block();
  s.analysis.scheme = SchemeWord::bdf2;
  s.dirichlet.clear();
  ContactDef floor;
  floor.friction = 0.3;
  s.contacts = {floor};
  return s;
}

SceneDef two_blocks() {
  SceneDef s = block();
  s.bodies.push_back(s.bodies[0]);
  s.bodies[1].name = "upper";
  std::get<BoxMeshDef>(s.bodies[1].mesh).lower = {0, 0, 1.001};
  std::get<BoxMeshDef>(s.bodies[1].mesh).upper = {1, 1, 2};
  SurfaceContactDef between;
  between.body = static_cast<BodyId>(1);
  between.against = static_cast<BodyId>(0);
  between.friction = 0.2;
  s.surface_contacts = {between};
  return s;
}

struct Start {
  BuiltScene built;
  std::vector<std::byte> saved;
};

Start start_of(const SceneDef& scene) {
  auto built = build(scene, {1});
  fuzz::require(built.ok(), "a world of the fuzz target cannot be built");
  Start start{std::move(built).value(), {}};
  start.built.world.step(0.05);
  start.saved = start.built.world.save();
  return start;
}

std::vector<std::byte> damaged(const std::vector<std::byte>& saved, const std::uint8_t* data,
                               std::size_t size) {
  std::vector<std::byte> blob = saved;
  const bool shorter = size > 0 && size < blob.size() && data[size - 1] % 2 == 1;
  if (shorter || size > blob.size()) blob.resize(size);
  for (std::size_t i = 0; i < std::min(size, blob.size()); ++i) blob[i] ^= static_cast<std::byte>(data[i]);
  return blob;
}

// Ends the bytes with the checksum that fits them, so that what lies behind it is reached.
void seal(std::vector<std::byte>& blob) {
  constexpr std::size_t size = sizeof(std::uint64_t);
  if (blob.size() < size) return;
  Hash h;
  h.add(std::span<const std::byte>(blob).first(blob.size() - size));
  const std::uint64_t value = h.value();
  std::memcpy(blob.data() + blob.size() - size, &value, size);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Start starts[] = {start_of(block()), start_of(on_floor()), start_of(two_blocks())};
  if (size == 0) return 0;
  Start& start = starts[data[0] % 3];
  World& world = start.built.world;
  fuzz::require(world.load(start.saved).ok(), "a world refuses its own saved state");
  const std::uint64_t before = world.state_hash();
  auto blob = damaged(start.saved, data + 1, size - 1);
  if ((data[0] & 128) != 0) seal(blob);
  if (const auto loaded = world.load(blob); !loaded) {
    fuzz::require_message(loaded.error());
    fuzz::require(world.state_hash() == before, "a state that was refused changed the world");
    return 0;
  }
  for (const BodyId id : start.built.bodies) {
    for (const Vec3& x : world.positions(id))
      fuzz::require(std::isfinite(x.x + x.y + x.z), "a state with positions that are not finite was loaded");
    for (const Vec3& v : world.velocities(id))
      fuzz::require(std::isfinite(v.x + v.y + v.z), "a state with velocities that are not finite was loaded");
  }
  (void)world.step(0.05, {3, 0});
  return 0;
}
