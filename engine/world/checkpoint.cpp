// Saved states of a world. Version 4: magic, version and length in bytes; fingerprints of the parts of the
// scene; time, positions, velocities, multipliers, what schemes and effects keep, what a host has
// set (amounts, gravity, poses, forces), reactions; a checksum over all of it. A state is loaded whole or not
// at all.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/base/bytes.h"
#include "engine/base/fingerprint.h"
#include "engine/base/out_of_memory.h"
#include "engine/base/text.h"
#include "engine/step/time_scheme.h"
#include "engine/world/world_impl.h"

namespace isochor {

namespace {

constexpr std::uint64_t kMagic = 0x6574617473736f69ull;       // "iosstate"
constexpr std::uint64_t kFirstMagic = 0x31726f68636f7369ull;  // of version 1, without a checksum
constexpr std::uint64_t kVersion = 4;

struct Header {
  std::uint64_t magic = kMagic, version = kVersion, bytes = 0;
};

// What follows the header.
struct Moment {
  double t = 0;
  std::vector<Vec3> x, v;
  std::vector<double> lambda, extra;
};
struct Content {
  std::vector<ScenePart> scene;
  Moment now;
  std::vector<double> amounts;  // of effects and gravity, and poses, where a host has set them
  std::vector<Vec3> reactions, forces;
  std::vector<Moment> settled;  // none, or the state in balance behind an unfinished one
};

Moment moment_of(const State& s) {
  return {s.t, s.x, s.v, s.lambda, s.extra};
}
State state_of(Moment&& m, const std::vector<Vec3>& reactions, const std::vector<Vec3>& forces) {
  State s;
  s.t = m.t;
  s.x = std::move(m.x);
  s.v = std::move(m.v);
  s.lambda = std::move(m.lambda);
  s.extra = std::move(m.extra);
  s.reactions = reactions;
  s.forces = forces;
  return s;
}

// What a scene's options mean; how its equations are solved, and how well, may differ.
void describe_options(const WorldOptions& o, std::vector<ScenePart>& parts) {
  const auto part = [&parts](const char* what, const auto&... values) {
    parts.push_back({what, Fingerprint().add(values...).value()});
  };
  parts.push_back({"the time scheme", Fingerprint().add(o.scheme).value()});
  part("gravity", o.gravity, o.gravity_curve);
  const bool sweeps = o.method == Method::position_based;
  part("the number of position-based sweeps", sweeps, sweeps ? o.sweeps : 0);
  if (!o.scheme->has_inertia()) return;
  part("the consistency of the mass matrix", o.consistent_mass);
  part("the bound on the time error", o.time_error);
}

std::uint64_t fingerprint_of(const RegionData& region) {
  const MaterialModel& m = *region.material;
  Fingerprint f;
  f.add(region.name, region.density, m.name(), m.shear_modulus(), m.inverse_bulk(), m.poisson(), m.young(),
        m.defined_inverted(), m.distortional());
  if (const auto complete = m.complete()) f.add(complete.value());
  for (std::size_t c = 0; c < m.field_cells(); ++c) {
    const auto cell = static_cast<Index>(c);
    f.add(m.stiffness_factor(cell), m.poisson_of(cell), m.inverse_bulk_of(cell));
  }
  return f.value();
}

void describe_body(const BodyData& body, std::vector<ScenePart>& parts) {
  const std::string who = " of body \"" + body.name + "\"";
  const Mesh& m = body.mesh;
  parts.push_back({"the element" + who,
                   Fingerprint().add(body.element, body.guard_threshold, body.guard_stiffness).value()});
  // No list of regions means region 0, as a list of zeros does.
  const bool one_region =
      std::all_of(m.cell_region.begin(), m.cell_region.end(), [](Index r) { return r == 0; });
  const std::vector<Index> cell_region = one_region ? std::vector<Index>() : m.cell_region;
  parts.push_back({"the mesh" + who, Fingerprint()
                                         .add(m.cell_type, m.nodes, m.cells, cell_region, m.regions,
                                              m.surfaces, m.node_sets, m.fields)
                                         .value()});
  for (const RegionData& region : body.regions) {
    const std::string where = body.regions.size() > 1 ? " in region \"" + region.name + "\"" : "";
    parts.push_back({"the material" + who + where, fingerprint_of(region)});
  }
}

// How the scene of a saved state differs from that of this world; empty: it does not.
std::string difference(const std::vector<ScenePart>& saved, const std::vector<ScenePart>& here) {
  constexpr std::size_t most = 4;
  std::vector<std::string> all;
  // Names may repeat: the n-th of a name is held against the n-th of that name.
  const auto counterpart = [](const std::vector<ScenePart>& from, std::size_t i,
                              const std::vector<ScenePart>& to) {
    const auto same = [&](const ScenePart& p) { return p.what == from[i].what; };
    auto left = std::count_if(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(i), same);
    return std::find_if(to.begin(), to.end(), [&](const ScenePart& p) { return same(p) && left-- == 0; });
  };
  for (std::size_t i = 0; i < here.size(); ++i) {
    const auto other = counterpart(here, i, saved);
    if (other == saved.end())
      all.push_back(here[i].what + " (the state has none)");
    else if (other->fingerprint != here[i].fingerprint)
      all.push_back(here[i].what);
  }
  for (std::size_t i = 0; i < saved.size(); ++i) {
    if (counterpart(saved, i, here) == here.end()) all.push_back(saved[i].what + " (this world has none)");
  }
  if (all.empty() && saved.size() != here.size()) all.emplace_back("the number of its parts");
  for (std::size_t i = 0; all.empty() && i < here.size(); ++i) {
    if (saved[i].what != here[i].what) all.emplace_back("the order of its parts");
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(all.size(), most); ++i) text += (i > 0 ? ", " : "") + all[i];
  if (all.size() > most) text += " and " + std::to_string(all.size() - most) + " more";
  return text;
}

bool finite(std::span<const double> list) {
  return std::all_of(list.begin(), list.end(), [](double v) { return std::isfinite(v); });
}
bool finite(std::span<const Vec3> list) {
  return std::all_of(list.begin(), list.end(), [](const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  });
}

Error damaged(const std::string& how) {
  return Error{"load: the saved state is damaged (" + how + "); take an earlier one"};
}

Result<Content> read(std::span<const std::byte> bytes) {
  const std::size_t size = bytes.size();
  ByteReader in(bytes);
  Header header;
  if (!in.take(header.magic) || (header.magic != kMagic && header.magic != kFirstMagic))
    return Error{"load: these bytes are no saved state of a world (wrong first eight bytes)"};
  if (header.magic == kFirstMagic || !in.take(header.version) || header.version != kVersion) {
    return Error{"load: the state was saved in format " +
                 std::to_string(header.magic == kFirstMagic ? 1 : header.version) +
                 ", this library reads format " + std::to_string(kVersion) +
                 "; save it anew with this library"};
  }
  if (!in.take(header.bytes) || header.bytes != size) {
    return damaged("it has " + std::to_string(size) + " bytes where it says " + std::to_string(header.bytes));
  }
  if (ByteReader whole(bytes); !whole.unseal()) return damaged("its checksum does not fit");
  Content content;
  in = ByteReader(bytes.subspan(sizeof(Header), size - sizeof(Header) - sizeof(std::uint64_t)));
  if (!in.take(content) || in.left() > 0) return damaged("its lists do not fit its length");
  return content;
}

}  // namespace

const std::vector<ScenePart>& World::Impl::scene_parts() {
  if (!described.empty()) return described;
  std::vector<ScenePart> parts;
  describe_options(options, parts);
  for (const BodyData& body : said.builder.bodies()) {
    if (body.present()) describe_body(body, parts);
  }
  for (const Index e : said.order) {
    const EffectPtr& source = said.sources[at(e)];
    parts.push_back({"effect \"" + source->name() + "\"", Fingerprint().add(source).value()});
  }
  return described = std::move(parts);
}

std::vector<std::byte> World::save() const {
  Impl& w = *impl_;
  if (!w.ready()) return {};
  Content content{w.scene_parts(), moment_of(w.state), {}, w.state.reactions, w.state.forces, {}};
  const std::optional<State>& settled = w.settled;
  if (settled) content.settled.push_back(moment_of(*settled));
  w.amounts.save(content.amounts);
  ByteWriter out;
  out.put(Header{});
  out.put(content);
  return std::move(out).sealed(offsetof(Header, bytes));
}

// Whether numbers can be a state of this world.
template <class M>
Result<void> World::Impl::check_moment(const M& m) const {
  if (m.x.size() != state.x.size() || m.v.size() != m.x.size() || m.lambda.size() != state.lambda.size() ||
      m.extra.size() != state.extra.size())
    return damaged("its sizes do not fit this scene");
  if (!std::isfinite(m.t) || !finite(m.x) || !finite(m.v) || !finite(m.lambda) || !finite(m.extra))
    return damaged("it holds numbers that are not finite");
  // Beyond this, searches for what is close have no numbers left to count their boxes with.
  constexpr double farthest = 1e12;
  const double limit = farthest * std::max(system().length(), 1e-300);
  for (std::size_t i = 0; i < m.x.size(); ++i) {
    if (std::max({std::abs(m.x[i].x), std::abs(m.x[i].y), std::abs(m.x[i].z)}) <= limit) continue;
    return damaged("node " + std::to_string(i) + " is more than " + number(limit) + " m away");
  }
  return {};
}

Result<void> World::load(std::span<const std::byte> bytes) try {
  Impl& w = *impl_;
  if (auto r = w.compile(); !r) return r;
  auto content = read(bytes);
  if (!content) return content.failure();
  Content& c = content.value();
  if (const std::string what = difference(c.scene, w.scene_parts()); !what.empty()) {
    return Error{"load: the state was saved from another scene: of this world differ " + what +
                 "; load it into a world built the same way"};
  }
  const bool forces = !c.forces.empty();
  if (c.reactions.size() != w.state.reactions.size() || c.settled.size() > 1 ||
      (forces && c.forces.size() != w.state.x.size()))
    return damaged("its sizes do not fit this scene");
  if (!finite(c.reactions) || !finite(c.forces) || !finite(c.amounts))
    return damaged("it holds numbers that are not finite");
  if (auto r = w.check_moment(c.now); !r) return r;
  if (!c.settled.empty()) {
    if (auto r = w.check_moment(c.settled.front()); !r) return r;
  }
  if (!w.amounts.fit(c.amounts)) return damaged("its amounts are none of these effects");
  State next = state_of(std::move(c.now), c.reactions, c.forces);
  std::optional<State> settled;
  if (!c.settled.empty()) settled = state_of(std::move(c.settled.front()), c.reactions, c.forces);
  const auto stencils = w.controller->stepper().surroundings().restore(
      std::span<const double>(next.extra).first(w.layout.pools));
  if (!stencils) return damaged(stencils.error());
  w.amounts.load(c.amounts);
  w.take_over(std::move(next));
  w.settled = std::move(settled);
  return {};
} catch (const std::bad_alloc&) {
  return no_memory("load");
}

std::uint64_t World::state_hash() const {
  const Impl& w = *impl_;
  Hash h;
  h.add(w.state.hash());
  return w.amounts.add_set_by_host(h) ? h.value() : w.state.hash();
}

}  // namespace isochor
