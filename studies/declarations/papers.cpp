// What three papers state, beside the same cases here.
#include "studies/analysis.h"
#include "studies/paper_cases.h"

namespace isochor::studies {

namespace {

std::vector<Cell> cells(bool quick) {
  std::vector<Cell> out;
  for (PaperPart& part : paper_parts(quick)) {
    for (PaperCase& one : part.cases) {
      one.cell.labels["part"] = part.title;
      out.push_back(std::move(one.cell));
    }
  }
  return out;
}

const Measured* find(std::span<const Measured> all, const std::string& id) {
  for (const Measured& m : all) {
    if (m.id == id) return &m;
  }
  return nullptr;
}

void add_rows(Table& table, const PaperCase& one, const Measured& m) {
  for (std::size_t k = 0; k < one.shown.size(); ++k) {
    const ShownNumber& shown = one.shown[k];
    const bool first = k == 0;
    std::string here = m.status;
    if (m.good()) {
      here = text(shown.scale * m.number(shown.metric));
      if (!shown.unit.empty()) here += " " + shown.unit;
    } else {
      table.failed.push_back(table.rows.size());
    }
    table.rows.push_back({first ? one.figure : "", first ? one.what : "", first ? one.setting : "",
                          shown.what, shown.stated, here});
    if (!m.good()) break;
  }
}

std::vector<Section> present(std::span<const Measured> all) {
  std::vector<Section> out;
  for (const PaperPart& part : paper_parts(false)) {
    Section s{part.title, part.differs};
    Table t{"Numbers", {"figure", "case", "element, law", "number", "paper", "here"}, {}};
    for (const PaperCase& one : part.cases) {
      if (const Measured* m = find(all, one.cell.id)) add_rows(t, one, *m);
    }
    s.tables = {std::move(t)};
    out.push_back(std::move(s));
  }
  out.push_back(all_cells(all));
  return out;
}

}  // namespace

Study papers_study() {
  return {"papers",
          "Three papers",
          "What the papers behind this engine state in figures and tables, beside the same cases here.",
          cells,
          present,
          1};
}

}  // namespace isochor::studies
