// Keys that several effects share.
#pragma once

#include "scenes/keys/keys.h"

namespace isochor::keys {

ISOCHOR_WORDS(FrictionCoupling, ISOCHOR_WORD(FrictionCoupling, lagged),
              ISOCHOR_WORD(FrictionCoupling, coupled));
ISOCHOR_WORDS(InitialOverlap, ISOCHOR_WORD(InitialOverlap, report), ISOCHOR_WORD(InitialOverlap, resolve));
ISOCHOR_WORDS(ObstacleShape, ISOCHOR_WORD(ObstacleShape, plane), ISOCHOR_WORD(ObstacleShape, sphere),
              ISOCHOR_WORD(ObstacleShape, capsule), ISOCHOR_WORD(ObstacleShape, cylinder),
              ISOCHOR_WORD(ObstacleShape, box), ISOCHOR_WORD(ObstacleShape, mesh),
              ISOCHOR_WORD(ObstacleShape, distance_field));

inline constexpr Key name_key{"name", "", "of the effect; all effects share one set of names"};
inline constexpr Key body_key{"body", "", "by its name"};
inline constexpr Key surfaces_key{"surfaces", "", "of the mesh or of the body"};
inline constexpr Key profile_key{"profile", "",
                                 "a factor in space and time: a formula of x, y, z (at rest) and t, see "
                                 "[profiles](effects/loads.md#profiles)"};

void describe(Visitor& io, Selection& s);
void describe(Visitor& io, Pose& p);
void describe(Visitor& io, Obstacle& o);

void describe(Visitor& io, Prestretch& p);

// Of layers that are stretched where the body is at rest.
template <class Def>
void describe_prestretch(Visitor& io, Def& d) {
  const bool there = d.prestretch.along != 1 || d.prestretch.across != 1;
  io.optional_object({"prestretch", "", "how much it is stretched where the body is at rest"}, d.prestretch,
                     there);
  io.curve({"amount", "", "of the prestretch: stretches are 1 + amount (stretch - 1)"}, d.amount,
           CurveStart::zero, there);
}

// Of contact with whatever there is.
template <class Def>
void describe_friction(Visitor& io, Def& c, const Def& d) {
  io.number(Key("friction", "", "coefficient of Coulomb friction").least(0), c.friction, d.friction);
  io.number(
      Key("static_friction", "", "coefficient that it takes to break away, not below `friction`; 0: the same")
          .least(0),
      c.static_friction, d.static_friction);
  io.number(
      Key("stick_stiffness", "Pa/m", "shear stress over slip where friction sticks; 0: automatic").least(0),
      c.stick_stiffness, d.stick_stiffness);
  io.word({"coupling", "",
           "whether the linear systems know how friction follows the normal force: unsymmetric ones then"},
          c.coupling, d.coupling);
}
template <class Def>
void describe_overlap(Visitor& io, Def& c, const Def& d) {
  io.word({"initial_overlap", "",
           "what becomes of points that are inside at the start: refused, or pushed out little by little"},
          c.initial_overlap, d.initial_overlap);
  io.number(Key("resolve_time", "s", "by which they are out; statics: load factor").above(0), c.resolve_time,
            d.resolve_time);
}

}  // namespace isochor::keys
