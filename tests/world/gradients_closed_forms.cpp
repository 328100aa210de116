// Gradients against closed forms: thick tube and thick sphere of inner radius 1 and outer radius 2, mu = 1,
// incompressible, under inner pressure. Derivatives of the outward displacement of the outer surface and of
// the volume of the hollow, by pressure, shear modulus and the two radii at rest.
#include <cmath>
#include <functional>
#include <limits>

#include "isochor/gradients.h"
#include "support/worlds.h"

using namespace test;
using isochor::GradientQuery;
using isochor::Gradients;
using isochor::Output;
using isochor::Parameter;
using isochor::World;

namespace {

struct Closed {
  bool sphere = false;
  double pressure = 0;
  std::array<double, 4> du, dV;  // by pressure, mu, inner and outer radius
};

// Partial derivatives of the equilibrium, 40-digit arithmetic.
constexpr std::array<Closed, 2> kClosed{{
    {false,
     0.275711536803412,
     {0.733494721821, -0.20223295699, 0.433055283763, -0.148527173717},
     {9.84415175655, -2.71414620933, 12.0951725042, -1.13884773089}},
    {true,
     0.551868541979446,
     {0.279020394982, -0.153982578561, 0.329402996096, -0.126468358714},
     {15.1180430783, -8.34317239119, 30.4142726841, -2.93529003894}},
}};

isochor::Result<isochor::MaterialPtr> rubber(double mu) {
  isochor::ElasticConstants c;
  c.mu = mu;
  c.lambda = std::numeric_limits<double>::infinity();
  return isochor::neo_hookean(c);
}

// Along the radius, by as much as `amount` says at radius r.
std::vector<Vec3> radial(std::span<const Vec3> rest, bool sphere,
                         const std::function<double(double)>& amount) {
  std::vector<Vec3> out;
  for (const Vec3& X : rest) {
    const Vec3 from_axis{X.x, X.y, sphere ? X.z : 0};
    const double r = std::sqrt(dot(from_axis, from_axis));
    out.push_back((amount(r) / r) * from_axis);
  }
  return out;
}

// What is asked, and the answers divided by the closed ones, less one.
struct Errors {
  std::array<double, 4> u, V;
};

Errors errors_of(const Closed& closed, const std::string& mesh_name) {
  World world = make_world(static_options());
  Mesh mesh = scene_mesh(mesh_name);
  double length = 0;
  for (const Vec3& X : mesh.nodes) length = std::max(length, X.z);
  const isochor::BodyId body =
      add_body(world, std::move(mesh), isochor::Element::hex8, value(rubber(1)), 1000);
  add_volume(world, body, isochor::VolumeSpace::element);
  hold(world, body, {"symmetry_x"}, {{1, 0, 0}});
  hold(world, body, {"symmetry_y"}, {{0, 1, 0}});
  hold(world, body, {closed.sphere ? "symmetry_z" : "faces_z"}, {{0, 0, 1}});
  isochor::CavityDef def;
  def.body = body;
  def.surfaces = {"inner"};
  def.amount = isochor::Curve::ramp(closed.pressure);
  const isochor::EffectId cavity = value(world.add(isochor::cavity(def)));
  must_advance(world);
  const auto rest = world.rest_positions(body);
  GradientQuery query;
  query.outputs = {Output::node(body, nearest_node(rest, {2, 0, 0}), {1, 0, 0}),
                   Output::gauge(cavity, "volume")};
  query.parameters = {Parameter::amount_of(cavity), Parameter::material(body, "", 1, rubber),
                      Parameter::shape(body, radial(rest, closed.sphere, [](double r) { return 2 - r; })),
                      Parameter::shape(body, radial(rest, closed.sphere, [](double r) { return r - 1; }))};
  const Gradients g = value(world.gradients(query));
  CHECK(g.regular);
  // The model is a quarter of a tube, or an eighth of a sphere.
  const double whole = closed.sphere ? 8 : 4 / length;
  Errors out{};
  for (std::size_t p = 0; p < 4; ++p) {
    // A node on the outer surface moves at rest with the outer radius.
    const double at_rest = p == 3 ? 1 : 0;
    out.u[p] = (g.of(0, p) - at_rest) / closed.du[p] - 1;
    out.V[p] = whole * g.of(1, p) / closed.dV[p] - 1;
  }
  // Only p/mu counts, and lengths scale.
  CHECK(std::abs(closed.pressure * g.of(0, 0) + g.of(0, 1)) < 1e-8 * std::abs(g.of(0, 1)));
  const double x = g.values[0], V = g.values[1];
  CHECK(std::abs(g.of(0, 2) + 2 * g.of(0, 3) - x) < 1e-8 * x);
  const double degree = closed.sphere ? 3 : 2;  // the length of the tube stays
  CHECK(std::abs(g.of(1, 2) + 2 * g.of(1, 3) - degree * V) < 1e-8 * V);
  return out;
}

}  // namespace

TEST_CASE("gradients of thick tubes and spheres come to the closed forms with the square of the mesh width",
          "[gradients]") {
  for (const Closed& closed : kClosed) {
    const std::string shape = closed.sphere ? "thick_sphere" : "thick_tube";
    const Errors coarse = errors_of(closed, shape + "_1_hex"), fine = errors_of(closed, shape + "_2_hex");
    for (std::size_t p = 0; p < 4; ++p) {
      CAPTURE(shape, p, coarse.u[p], fine.u[p], coarse.V[p], fine.V[p]);
      CHECK(std::abs(fine.u[p]) < 0.02);
      CHECK(std::abs(fine.V[p]) < 0.02);
      CHECK(std::abs(coarse.u[p]) > 2.5 * std::abs(fine.u[p]));
      CHECK(std::abs(coarse.V[p]) > 2.5 * std::abs(fine.V[p]));
    }
  }
}
