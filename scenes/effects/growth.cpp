#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

namespace {

// Six numbers each, in one list.
std::vector<double> flat(const std::vector<std::array<double, 6>>& tensors) {
  std::vector<double> out;
  for (const auto& t : tensors) out.insert(out.end(), t.begin(), t.end());
  return out;
}

}  // namespace

void describe(Visitor& io, GrowthDef& g) {
  const GrowthDef d;
  io.about(
      "growth",
      "A stress-free state that is not that of the mesh: swelling, thermal expansion, growth, prestrain, "
      "see [growth](effects/active.md#growth).");
  io.required_text(name_key, g.name);
  io.body(body_key, g.body);
  io.names(Key("regions", "", "that grow").absent("all"), g.regions);
  io.number({"linear", "", "strain in all directions at amount 1"}, g.linear, d.linear);
  io.number({"volume", "", "instead: change of volume over volume at amount 1"}, g.volume, d.volume);
  io.number({"along", "", "instead: strain along `direction` at amount 1"}, g.along, d.along);
  io.number({"across", "", "strain across it"}, g.across, d.across);
  io.vector({"direction", "", "of `along`"}, g.direction, d.direction);
  const bool one = g.strain != d.strain;
  std::vector<double> strain = one ? std::vector<double>(g.strain.begin(), g.strain.end()) : flat(g.strains);
  io.numbers({"strain", "", "instead: xx, yy, zz, xy, yz, zx at amount 1, or six numbers a cell"}, strain);
  g.strain = d.strain;
  g.strains.clear();
  if (strain.size() == 6) {
    std::copy(strain.begin(), strain.end(), g.strain.begin());
  } else {
    // A number that is left over makes one tensor too many for the mesh, which refuses it.
    for (std::size_t k = 0; k < strain.size(); k += 6) {
      auto& t = g.strains.emplace_back();
      for (std::size_t i = 0; i < 6 && k + i < strain.size(); ++i) t[i] = strain[k + i];
    }
  }
  io.text({"field", "", "of the mesh in cells: factors on the strain, or strains with six components"},
          g.field, d.field);
  io.numbers({"factors", "", "on the strain, one a cell"}, g.factors);
  io.curve({"amount", "", "scales the strain over time, a temperature for example"}, g.amount,
           CurveStart::zero, true);
}

}  // namespace keys

constinit const EffectKind growth_kind =
    effect_kind<&SceneDef::growth, growth>("growth", "growth", EffectPhase::volume_rows);

}  // namespace isochor
