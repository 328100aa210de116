// The case of the worked example, as docs/adding-a-constraint.md prints it.
#include "catch.h"
#include "contract/registry.h"
#include "engine/system/pool.h"
#include "engine/system/pool_facets.h"
#include "support/meshes.h"
#include "tendon.h"

namespace test {

namespace {

using isochor::Element;
using isochor::RowFacets;

isochor::MaterialPtr material(double poisson) {
  isochor::ElasticConstants c;
  c.young = 2.6;
  c.poisson = poisson;
  return std::move(isochor::neo_hookean(c)).value();
}

Mesh solid_mesh(Element) {
  return mapped(box({2, 1, 2}, {1, 0.5, 1}, isochor::CellType::tet4), wavy);
}

// What the page says of facets: rows that keep a number from step to step.
class Remembering final : public isochor::RowPool, public isochor::RememberingRows {
 public:
  std::string_view name() const override { return "remembering"; }
  RowFacets facets() const override { return {.remembering = this}; }
  int memory() const override { return 1; }
  void start(std::span<double> memory) const override { memory[0] = 0; }
  void accept(const isochor::RowIncrement&, std::span<const double> lambda,
              std::span<double> memory) const override {
    memory[0] = lambda[0];
  }
};

}  // namespace

void add_worked_example(std::vector<SceneCase>& out) {
  isochor::TendonDef def;
  def.points = {{0, 0, 0}, {0.5, 0, 0}, {1, 0.5, 1}};
  def.stiffness = 100;
  SceneCase c{"tendon",      {"constraints/tendon"},      solid_mesh(Element::tet4),
              Element::tet4, {{"", material(0.3), 1000}}, {isochor::tendon(def)}};
  out.push_back(c);
}

TEST_CASE("rows of the page on effects are found to remember") {
  const Remembering rows;
  CHECK(rows.facets().remembering == &rows);
}

}  // namespace test
