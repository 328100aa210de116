// Rule: docs/solver.md prints the ladder that the code has.
#include "engine/step/ladder.h"

#include "tree.h"

namespace {

std::string row(std::string_view name, std::string_view when, std::string_view counter) {
  std::ostringstream text;
  text << "| " << name << " | " << when << " | ";
  if (!counter.empty()) text << '`' << counter << '`';
  text << " |\n";
  return text.str();
}

}  // namespace

TEST_CASE("the page of the solver prints the ladder of an increment and the remedies of advance") {
  std::string rungs, remedies;
  for (const isochor::Rung& r : isochor::ladder()) rungs += row(r.name, r.when, r.counted_as);
  for (const isochor::Remedy& r : isochor::remedies()) remedies += row(r.name, r.when, r.counted_as);
  const std::string page = tree::text_of(tree::root / "docs" / "solver.md");
  INFO("the tables should read\n" << rungs << "\n" << remedies);
  CHECK(page.find("|---|---|---|\n" + rungs + "\n") != std::string::npos);
  CHECK(page.find("|---|---|---|\n" + remedies + "\n") != std::string::npos);
}
