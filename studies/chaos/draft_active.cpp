// What bodies do by themselves and what pulls at single points: muscles, growth, pressures on open patches,
// springs, equations between points, nodes that follow data, skins over bones, statics before dynamics.
#include <algorithm>
#include <cmath>

#include "studies/chaos/draft.h"

namespace isochor::studies {

namespace {

BodyId id_of(std::size_t body) {
  return static_cast<BodyId>(body);
}

Vec3 point_in(ChaosRandom& random, const DraftBody& body) {
  Vec3 x{};
  for (int k = 0; k < 3; ++k)
    x[k] = body.lower[k] + random.between(0.1, 0.9) * (body.upper[k] - body.lower[k]);
  return x;
}

// Directions of any length, as people write them.
Vec3 axis(ChaosRandom& random) {
  return random.chance(0.5) ? random.pick({Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 2}}) : random.direction();
}

void draw_muscle(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  MuscleDef def;
  def.name = "muscle" + std::to_string(b);
  def.body = id_of(b);
  const auto& regions = draft.bodies[b].regions;
  if (regions.size() > 1 && random.chance(0.5)) def.regions = {random.pick(regions)};
  def.direction = axis(random);
  const double sign = random.chance(0.8) ? 1 : -1;
  def.amount = draft.curve(random, sign * draft.young * ChaosDraft::load_factor(random));
  if (random.chance(0.5)) def.tension = MuscleTension::current;
  if (random.chance(0.5)) {
    def.optimal_stretch = random.between(0.6, 1.6);
    def.width = random.between(0.1, 1);
  }
  draft.scene().muscles.push_back(def);
}

void draw_growth(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  GrowthDef def;
  def.name = "growth" + std::to_string(b);
  def.body = id_of(b);
  const auto& regions = draft.bodies[b].regions;
  if (regions.size() > 1 && random.chance(0.5)) def.regions = {random.pick(regions)};
  // Mostly some tenths; now and then so much that pieces would turn over, or many times their size.
  const auto strain = [&] {
    return random.chance(0.85) ? random.between(-0.4, 0.6) : random.between(-1.5, 6);
  };
  switch (random.whole(0, 3)) {
    case 0:
      def.linear = strain();
      break;
    case 1:
      def.volume = strain();
      break;
    case 2:
      def.along = strain();
      def.across = strain();
      def.direction = axis(random);
      break;
    default:
      for (std::size_t k = 0; k < 6; ++k) def.strain[k] = (k < 3 ? 1 : 0.3) * strain();
      break;
  }
  def.amount = draft.curve(random, 1);
  draft.scene().growth.push_back(def);
}

void draw_pressure(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const auto& surfaces = draft.bodies[b].surfaces;
  if (surfaces.empty()) return;
  PressureDef def;
  def.name = "pressure" + std::to_string(b);
  def.body = id_of(b);
  def.surfaces = {random.pick(surfaces)};
  if (random.chance(0.3)) def.surfaces.push_back(random.pick(surfaces));
  const double sign = random.chance(0.6) ? 1 : -1;
  def.amount = draft.curve(random, sign * draft.young * ChaosDraft::load_factor(random));
  def.lagged = random.chance(0.4);
  draft.scene().pressures.push_back(def);
}

void draw_spring(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const DraftBody& body = draft.bodies[b];
  SpringDef def;
  def.name = "spring" + std::to_string(b);
  def.body = id_of(b);
  def.from = point_in(random, body);
  def.to = def.from + draft.length * random.between(0, 1.5) * random.direction();
  if (b > 0 && draft.bodies[b - 1].tetrahedra && random.chance(0.5)) {
    def.to_body = id_of(b - 1);
    def.to = point_in(random, draft.bodies[b - 1]);
  } else if (random.chance(0.2)) {
    def.to_body = id_of(b);
    def.to = point_in(random, body);
  }
  def.stiffness = draft.young * draft.length * random.decades(-3, 3);
  if (random.chance(0.4)) def.length = draft.length * random.between(0, 2);
  def.pulls_only = random.chance(0.4);
  if (random.chance(0.5)) def.amount = draft.curve(random, random.between(0, 2), 1);
  draft.scene().springs.push_back(def);
}

void draw_equation(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  LinearConstraintDef def;
  def.name = "equation" + std::to_string(b);
  const int terms = random.whole(1, 3);
  for (int k = 0; k < terms; ++k) {
    LinearConstraintDef::Term term;
    const bool before = b > 0 && draft.bodies[b - 1].tetrahedra && random.chance(0.3);
    term.body = id_of(before ? b - 1 : b);
    term.point = point_in(random, draft.bodies[before ? b - 1 : b]);
    term.direction = axis(random);
    term.weight = random.chance(0.5) ? random.pick({1.0, -1.0}) : random.between(-2, 2);
    def.terms.push_back(term);
  }
  if (random.chance(0.6))
    def.value =
        draft.length * (random.chance(0.8) ? random.between(-0.3, 0.3) : random.pick({-1.0, 1.0, 20.0}));
  if (random.chance(0.4)) def.stiffness = draft.young * draft.length * random.decades(-2, 3);
  def.amount = draft.curve(random, 1);
  draft.scene().linear_constraints.push_back(def);
}

void draw_driven(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const DraftBody& body = draft.bodies[b];
  if (body.nodes.empty()) return;
  DrivenDef def;
  def.name = "driven" + std::to_string(b);
  def.body = id_of(b);
  const int nodes = random.whole(1, 4), last = static_cast<int>(body.nodes.size()) - 1;
  for (int k = 0; k < nodes; ++k) def.nodes.push_back(random.whole(0, last));
  std::sort(def.nodes.begin(), def.nodes.end());
  def.nodes.erase(std::unique(def.nodes.begin(), def.nodes.end()), def.nodes.end());
  const int frames = random.whole(2, 4);
  const Vec3 way = draft.length * (random.chance(0.8) ? random.between(0, 0.3) : random.decades(0, 2)) *
                   random.direction();
  for (int f = 0; f < frames; ++f) {
    const double s = static_cast<double>(f) / (frames - 1);
    def.times.push_back(s * draft.duration);
    std::vector<Vec3> at;
    for (const Index i : def.nodes)
      at.push_back(body.nodes[static_cast<std::size_t>(i)] + (f % 2 == 0 ? s : 0.5 * s) * way);
    def.positions.push_back(std::move(at));
  }
  draft.scene().driven.push_back(def);
}

// One end of a body between two bones, by where its nodes are.
void draw_skin(ChaosRandom& random, ChaosDraft& draft, std::size_t b) {
  const DraftBody& body = draft.bodies[b];
  if (body.nodes.empty() || body.surfaces.empty()) return;
  SkinDef def;
  def.name = "skin" + std::to_string(b);
  def.where.body = id_of(b);
  def.where.surfaces = {random.pick(body.surfaces)};
  const int k = random.whole(0, 2);
  const double size = body.upper[k] - body.lower[k];
  for (int bone = 0; bone < 2; ++bone) {
    SkinDef::Bone made;
    const std::string name = def.name + "_" + std::to_string(bone);
    made.track.file = draft.add_motion(random, name, 0.3 * random.unit() * draft.length * random.direction());
    for (const Vec3& x : body.nodes) {
      const double s = std::clamp((x[k] - body.lower[k]) / size, 0.0, 1.0);
      made.weights.push_back(bone == 0 ? 1 - s : s);
    }
    def.bones.push_back(std::move(made));
  }
  draft.scene().skins.push_back(std::move(def));
}

}  // namespace

void draft_active(ChaosDraft& draft) {
  ChaosRandom random = draft.random("active");
  SceneDef& s = draft.scene();
  for (TractionDef& traction : s.tractions) {
    traction.current_area = random.chance(0.15);
    traction.lagged = traction.current_area && random.chance(0.4);
  }
  for (std::size_t b = 0; b < draft.bodies.size(); ++b) {
    const bool tetrahedra = draft.bodies[b].tetrahedra || random.chance(0.05);
    if (random.chance(0.1)) draw_muscle(random, draft, b);
    if (random.chance(0.1)) draw_growth(random, draft, b);
    if (random.chance(0.1)) draw_pressure(random, draft, b);
    if (tetrahedra && random.chance(0.1)) draw_spring(random, draft, b);
    if (tetrahedra && random.chance(0.06)) draw_equation(random, draft, b);
    if (random.chance(0.04)) draw_driven(random, draft, b);
    if (random.chance(0.04)) draw_skin(random, draft, b);
  }
  if (draft.dynamic && random.chance(0.08))
    s.analysis.static_until = random.pick({0.2, 0.5, 0.97}) * draft.duration;
}

}  // namespace isochor::studies
