// Our own references, for problems that have no independent one: Tet10 with linear pressure on ever finer
// meshes.
#include <algorithm>
#include <cmath>

#include "studies/analysis.h"
#include "studies/problem_scenes.h"
#include "studies/problems.h"

namespace isochor::studies {

namespace {

Cell fine_cell(const char* name, int number, LevelMesh mesh, int steps = 0) {
  Problem p = problem(name);
  p.quadratic = {mesh};
  Cell c = problem_cell(p, formulation("tet10_node"), 0);
  c.id = std::string(name) + "/" + std::to_string(number) + (steps > 0 ? "/" + std::to_string(steps) : "");
  c.labels["mesh"] = std::to_string(number);
  c.reference.reset();
  c.source.clear();
  if (steps > 0) {
    c.scene.analysis.steps = steps;
    c.knobs["steps"] = steps;
  }
  return c;
}

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  int number = 0;
  for (const int n : {4, 6, 8, 10}) {
    if (!quick || n < 8) out.push_back(fine_cell("block", ++number, std::array{n, n, 2 * n}));
  }
  number = 0;
  for (const char* mesh : {"cushion_2_tet10", "cushion_3_tet10"}) {
    if (!quick || number < 1) out.push_back(fine_cell("cushion", ++number, mesh));
  }
  number = 0;
  for (const int n : {1, 2, 3}) {
    if (!quick || n < 3) out.push_back(fine_cell("swing", ++number, std::array{10 * n, n, n}, 64));
  }
  for (const int steps : {128, 256}) {
    if (!quick || steps < 256) out.push_back(fine_cell("swing", 2, std::array{20, 2, 2}, steps));
  }
  return out;
}

std::vector<Section> present(std::span<const Measured> all) {
  Section s{"Values on ever finer meshes",
            "The last column is what the reference of the problem is held against: how far the finest mesh "
            "still is from it."};
  Table t{"", {"problem", "mesh", "unknowns", "steps", "value", "change", "from the reference in use"}, {}};
  for (const auto& name : label_values(all, "problem")) {
    const Measured* last = nullptr;
    for (const Measured* m : where(all, "problem", name)) {
      if (!m->good() || !m->value) {
        t.failed.push_back(t.rows.size());
        t.rows.push_back({name, m->label("mesh"), m->status});
        t.rows.back().resize(t.head.size());
        continue;
      }
      double reference = std::nan("");
      for (const Problem& p : problems()) {
        if (p.title == name) reference = p.reference;
      }
      t.rows.push_back({name, m->label("mesh"), text(m->unknowns(), 6),
                        m->knob("steps") > 0 ? text(m->knob("steps")) : "", text(*m->value, 6),
                        last ? percent(std::abs(*m->value / *last->value - 1)) : "",
                        percent(std::abs(*m->value / reference - 1))});
      last = m;
    }
  }
  s.tables = {std::move(t)};
  return {s, all_cells(all)};
}

}  // namespace

Study references_study() {
  return {"references",
          "References of our own",
          "What our finest meshes say where there is no independent reference, and how much they still move.",
          cells,
          present,
          0};
}

}  // namespace isochor::studies
