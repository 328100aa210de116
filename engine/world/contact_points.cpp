// What presses on what, for hosts.
#include <algorithm>

#include "engine/world/world_impl.h"

namespace isochor {

namespace {

// The body that a node of the scene belongs to; null: a rigid body's.
const BodyData* body_of(const Builder& builder, Index node) {
  for (const BodyData& b : builder.bodies()) {
    if (b.present() && node >= b.first_node && node < b.first_node + b.mesh.node_count()) return &b;
  }
  return nullptr;
}

}  // namespace

std::vector<ContactPoint> World::contacts() const {
  Impl& w = *impl_;
  std::vector<ContactPoint> all;
  if (!w.ready()) return all;
  const Builder& builder = w.said.builder;
  std::vector<PressingPoint> points;
  for (const Index e : w.said.order) {
    points.clear();
    w.instances[at(e)]->pressing_points({w.system(), w.state}, points);
    for (const PressingPoint& p : points) {
      ContactPoint c;
      c.effect = WorldNumbers::make<EffectTag>(e, builder.world(), w.said.places.generation(e));
      const BodyData* body = body_of(builder, p.of);
      const BodyData* partner = body_of(builder, p.partner_of);
      c.body = body ? body->name : p.name;
      c.partner = partner ? partner->name : p.partner;
      if (body && p.node >= 0) c.node = p.node - body->first_node;
      c.position = p.position;
      c.gap = p.gap;
      c.normal = p.normal;
      c.normal_force = p.force * p.normal;
      c.friction = p.friction;
      c.area = p.area;
      all.push_back(std::move(c));
    }
  }
  return all;
}

std::vector<ContactPair> World::contact_pairs() const {
  std::vector<ContactPair> pairs;
  for (const ContactPoint& c : contacts()) {
    // Either of two may be the one whose point it is.
    auto pair = std::find_if(pairs.begin(), pairs.end(), [&](const ContactPair& p) {
      return (p.body == c.body && p.partner == c.partner) || (p.body == c.partner && p.partner == c.body);
    });
    if (pair == pairs.end()) pair = pairs.insert(pair, {c.body, c.partner, {}, 0, 0});
    const bool turned = pair->body != c.body;
    // Within one body forces cancel.
    if (c.body != c.partner) pair->force += (turned ? -1.0 : 1.0) * (c.normal_force + c.friction);
    pair->normal += norm(c.normal_force);
    ++pair->points;
  }
  return pairs;
}

}  // namespace isochor
