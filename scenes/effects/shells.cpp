#include "scenes/effects/kind.h"
#include "scenes/effects/shared_keys.h"
#include "scenes/keys/parts.h"

namespace isochor {

namespace keys {

// A selection on the body of the shell.
namespace {
struct Rim {
  Selection& where;
};
}  // namespace
void describe(Visitor& io, Rim& rim) {
  Selection& s = rim.where;
  io.about("rim", "Nodes of the body that fit any of the criteria.");
  io.names(surfaces_key, s.surfaces);
  io.names({"node_sets", "", "of the mesh or of the body"}, s.node_sets);
  io.indices({"nodes", "", "of the body's mesh, counted from 0"}, s.nodes);
  io.boxes({"boxes", "m", "`[[lower, upper], ...]`, rest positions"}, s.boxes);
  io.flag({"everything", "", "all nodes of the body"}, s.everything, false);
}

void describe(Visitor& io, FiberFamily& f) {
  const FiberFamily d;
  io.about("sheet_fibers",
           "A family of fibers in a shell, see [shells](effects/shell.md#fibers-and-prestretch).");
  io.vector({"direction", "", "of all of them, at rest"}, f.direction, d.direction);
  io.points({"directions", "", "one a cell of the thin body, instead of `direction`"}, f.directions);
  describe_fiber_law(io, f);
}

void describe(Visitor& io, ShellDef& s) {
  const ShellDef d;
  io.about(
      "shell",
      "A thin sheet that stretches, shears and bends, see [shells](effects/shell.md): what a thin body is "
      "made of, or a layer on a solid one.");
  io.text(name_key, s.name, d.name);
  io.body(body_key, s.body);
  io.names(Key("surfaces", "", "of the mesh or of the body").absent("all of a thin body"), s.surfaces);
  io.number(Key("young", "Pa", "of the sheet").above(0).must(), s.young, d.young);
  io.number(Key("poisson", "", "of the sheet").least(0).most(0.5), s.poisson, d.poisson);
  io.number(Key("thickness", "m", "of the sheet").above(0).must(), s.thickness, d.thickness);
  io.number(Key("density", "kg/m^3", "of the sheet; 0: a layer without mass, on solid bodies only").least(0),
            s.density, d.density);
  io.number(Key("bending", "N m", "stiffness of a plate against bending; 0: that of a solid sheet").least(0),
            s.bending, d.bending);
  Rim rim{s.clamped};
  io.settings({"clamped", "",
               "edges at the rim with both ends there keep the direction in which the sheet leaves them; "
               "supports hold nodes"},
              rim);
  io.flag({"flat", "", "free of bending when flat, not as the mesh has it"}, s.flat, d.flat);
  describe_prestretch(io, s);
  io.list({"fibers", "", "that only pull, in the plane of the sheet"}, s.fibers);
  io.text({"fiber_field", "", "their directions: a field of the mesh in cells with three components"},
          s.fiber_field, d.fiber_field);
}

}  // namespace keys

constinit const EffectKind shells_kind =
    effect_kind<&SceneDef::shells, shell>("shells", "shell", EffectPhase::loads);

}  // namespace isochor
