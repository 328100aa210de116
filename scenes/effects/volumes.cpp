#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"

namespace isochor {

namespace keys {

// "none" stands beside the spaces of the engine: no rows at all.
enum class VolumeSpaceWord : std::uint8_t { node, element, body, ring, zone, none };

ISOCHOR_WORDS(VolumeSpaceWord, ISOCHOR_WORD(VolumeSpaceWord, node), ISOCHOR_WORD(VolumeSpaceWord, element),
              ISOCHOR_WORD(VolumeSpaceWord, body), ISOCHOR_WORD(VolumeSpaceWord, ring),
              ISOCHOR_WORD(VolumeSpaceWord, zone), ISOCHOR_WORD(VolumeSpaceWord, none));
ISOCHOR_WORDS(VolumeStrain, ISOCHOR_WORD(VolumeStrain, by_law), ISOCHOR_WORD(VolumeStrain, linear),
              ISOCHOR_WORD(VolumeStrain, logarithmic), ISOCHOR_WORD(VolumeStrain, mixed),
              ISOCHOR_WORD(VolumeStrain, mean_logarithmic), ISOCHOR_WORD(VolumeStrain, mean_mixed));
ISOCHOR_WORDS(UnpaintedCells, ISOCHOR_WORD(UnpaintedCells, none), ISOCHOR_WORD(UnpaintedCells, nearest));
ISOCHOR_WORDS(RowTreatment, ISOCHOR_WORD(RowTreatment, automatic), ISOCHOR_WORD(RowTreatment, saddle),
              ISOCHOR_WORD(RowTreatment, condensed), ISOCHOR_WORD(RowTreatment, bordered),
              ISOCHOR_WORD(RowTreatment, dual), ISOCHOR_WORD(RowTreatment, augmented));

void describe(Visitor& io, VolumeZone& z) {
  const VolumeZone d;
  io.about("zone", "Cells with one volume row, by any of the criteria; zones may overlap.");
  io.required_text({"name", "", "of the zone"}, z.name);
  io.names({"regions", "", "of the mesh"}, z.regions);
  io.indices({"cells", "", "of the body's mesh, counted from 0"}, z.cells);
  io.boxes({"boxes", "m", "`[[lower, upper], ...]`: cells with their center inside"}, z.boxes);
  io.text({"field", "",
           "of the mesh file, with weights from 0 to 1 [painted](effects/painted-zones.md) on the surface"},
          z.field, d.field);
  io.number_or_inf(Key("compliance", "", "times 1/kappa: 0 is hard, `\"inf\"` leaves the row out").least(0),
                   z.compliance, d.compliance);
}

void describe(Visitor& io, VolumeRows& v) {
  const VolumeDef d;
  io.about("volume", "Rows that keep volume, see [volume](effects/volume.md).");
  io.text(name_key, v.def.name, d.name);
  io.body(body_key, v.def.body);
  auto space = v.none ? VolumeSpaceWord::none : static_cast<VolumeSpaceWord>(v.def.space);
  io.word({"space", "", "what has a row each; `none`: no rows"}, space,
          static_cast<VolumeSpaceWord>(d.space));
  v.none = space == VolumeSpaceWord::none;
  if (!v.none) v.def.space = static_cast<VolumeSpace>(space);
  io.word({"strain", "", "what a row measures, see [volume](effects/volume.md#strain)"}, v.def.strain,
          d.strain);
  io.names(Key("regions", "", "that have rows").absent("all"), v.def.regions);
  io.integer(Key("rings", "", "of cells around each node, for space `ring`").least(1), v.def.rings, d.rings);
  io.list({"zones", "", "for space `zone`"}, v.def.zones);
  io.word({"unpainted", "",
           "cells without paint: left out of [painted zones](effects/painted-zones.md), or with the weights "
           "of the nearest painted cell"},
          v.def.unpainted, d.unpainted);
  io.names(Key("painted_surfaces", "", "that fields are painted on").absent("all of the boundary"),
           v.def.painted_surfaces);
  io.flag({"across_regions", "", "rows of the spaces `body` and `zone` may hold cells of several regions"},
          v.def.across_regions, d.across_regions);
  io.number(Key("stabilization", "", "of nodal rows on linear tets; 0: off").least(0), v.def.stabilization,
            d.stabilization);
  io.flag({"hard", "", "no compliance, whatever the material"}, v.def.hard, d.hard);
  io.flag({"carries_bulk", "", "false: the rows come on top of the complete energy or of other rows"},
          v.def.carries_bulk, d.carries_bulk);
  io.word({"treatment", "", "[how the linear systems take the rows](solver.md)"}, v.def.treatment,
          d.treatment);
  io.flag(
      {"lumped_compliance", "", "rows at nodes with their compliance on the diagonal, without stabilization"},
      v.def.lumped_compliance, d.lumped_compliance);
}

}  // namespace keys

namespace {

std::size_t size_of(const SceneDef& s) {
  return s.volumes ? s.volumes->size() : 0;
}

const std::string& name_of(const SceneDef& s, std::size_t i) {
  return (*s.volumes)[i].def.name;
}

void keys_of(const EffectKind& kind, keys::Visitor& io, SceneDef& s) {
  io.optional_list(keys::Key(kind.key, "", kind.meaning).absent("rows at the nodes of every body"),
                   s.volumes);
}

Result<void> check_none(const EffectKind&, const SceneDef&) {
  return {};
}

std::vector<VolumeRows> rows_of(const SceneDef& s) {
  if (s.volumes) return *s.volumes;
  std::vector<VolumeRows> rows;
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    if (s.bodies[b].element == Element::tri3) continue;  // thin: no volume
    VolumeRows& of = rows.emplace_back();
    of.def.body = static_cast<BodyId>(b);
    if (b > 0) of.def.name += " " + s.bodies[b].name;
  }
  return rows;
}

Result<void> add_rows(const EffectKind& kind, EffectAdder& adder) {
  for (const VolumeRows& rows : rows_of(adder.scene())) {
    if (rows.none) continue;
    if (auto r = adder.add(kind, volume(rows.def)); !r) return r;
  }
  return {};
}

void explain_rows(const EffectKind& kind, const SceneDef& s, std::vector<EffectNote>& notes) {
  const std::string word = kind.word;
  if (!s.volumes) {
    notes.push_back({word, "by default: the scene names none, so every body has one row a node"});
    return;
  }
  for (const VolumeRows& rows : *s.volumes) {
    if (rows.none)
      notes.push_back({"no " + word, "asked for: the body keeps its complete one-field energy"});
    else
      notes.push_back({word + " \"" + rows.def.name + "\"", "of the scene"});
  }
}

}  // namespace

constinit const EffectKind volumes_kind{
    "volumes",     "a body that the list leaves out keeps its one-field energy",
    "volume rows", EffectPhase::volume_rows,
    size_of,       name_of,
    keys_of,       check_none,
    add_rows,      explain_rows};

}  // namespace isochor
