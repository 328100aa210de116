// Materials of a body.
#include "scenes/keys/parts.h"

namespace isochor::keys {

ISOCHOR_WORDS(MaterialLaw, ISOCHOR_WORD(MaterialLaw, neo_hookean),
              ISOCHOR_WORD(MaterialLaw, neo_hookean_ogden), ISOCHOR_WORD(MaterialLaw, stable_neo_hookean),
              ISOCHOR_WORD(MaterialLaw, stable_neo_hookean_barrier),
              ISOCHOR_WORD(MaterialLaw, isochoric_neo_hookean), ISOCHOR_WORD(MaterialLaw, isochoric_extended),
              ISOCHOR_WORD(MaterialLaw, corotated), ISOCHOR_WORD(MaterialLaw, fixed_corotated),
              ISOCHOR_WORD(MaterialLaw, stvk), ISOCHOR_WORD(MaterialLaw, stvk_resistant),
              ISOCHOR_WORD(MaterialLaw, linear), ISOCHOR_WORD(MaterialLaw, mooney_rivlin),
              ISOCHOR_WORD(MaterialLaw, fung), ISOCHOR_WORD(MaterialLaw, arruda_boyce),
              ISOCHOR_WORD(MaterialLaw, ogden), ISOCHOR_WORD(MaterialLaw, yeoh),
              ISOCHOR_WORD(MaterialLaw, gent), ISOCHOR_WORD(MaterialLaw, veronda_westmann),
              ISOCHOR_WORD(MaterialLaw, holmes_mow), ISOCHOR_WORD(MaterialLaw, isochoric_mooney_rivlin),
              ISOCHOR_WORD(MaterialLaw, isochoric_fung), ISOCHOR_WORD(MaterialLaw, isochoric_arruda_boyce),
              ISOCHOR_WORD(MaterialLaw, isochoric_ogden), ISOCHOR_WORD(MaterialLaw, isochoric_yeoh),
              ISOCHOR_WORD(MaterialLaw, isochoric_gent),
              ISOCHOR_WORD(MaterialLaw, isochoric_veronda_westmann),
              ISOCHOR_WORD(MaterialLaw, isochoric_holmes_mow), ISOCHOR_WORD(MaterialLaw, named));
ISOCHOR_WORDS(VolumeEnergyWord, ISOCHOR_WORD(VolumeEnergyWord, by_law),
              ISOCHOR_WORD(VolumeEnergyWord, quadratic), ISOCHOR_WORD(VolumeEnergyWord, logarithmic),
              ISOCHOR_WORD(VolumeEnergyWord, mixed));
ISOCHOR_WORDS(FiberLaw, ISOCHOR_WORD(FiberLaw, exponential), ISOCHOR_WORD(FiberLaw, toe));
ISOCHOR_WORDS(BulkChoice, ISOCHOR_WORD(BulkChoice, consistent), ISOCHOR_WORD(BulkChoice, bulk_modulus));

void describe(Visitor& io, OgdenTerm& t) {
  const OgdenTerm d;
  io.about("ogden_term",
           "mu/alpha (sum of the principal stretches to the power alpha - 3); mu has the sign of alpha.");
  io.number({"mu", "Pa", "modulus"}, t.mu, d.mu);
  io.number({"alpha", "", "exponent"}, t.alpha, d.alpha);
}

ISOCHOR_WORDS(StaticTime, ISOCHOR_WORD(StaticTime, long_term), ISOCHOR_WORD(StaticTime, seconds));

void describe(Visitor& io, PronyTerm& t) {
  const PronyTerm d;
  io.about("prony_term",
           "A term of the shear relaxation modulus G0 (1 - sum of ratio (1 - exp(-t/time))), see "
           "[viscoelastic](materials/viscoelastic.md).");
  io.number(Key("ratio", "", "share of the instantaneous shear modulus that relaxes").above(0).must(),
            t.ratio, d.ratio);
  io.number(Key("time", "s", "of relaxation").above(0).must(), t.time, d.time);
}

void describe(Visitor& io, MullinsSoftening& s) {
  const MullinsSoftening d;
  io.about("mullins",
           "Softer where it has been stretched before, see [Mullins softening](materials/mullins.md).");
  io.number(Key("r", "", "how much softer at most: 1 - 1/r of the stress is left").above(1).must(), s.r, d.r);
  io.number(Key("m", "Pa", "energy density below which softening is not full").least(0), s.m, d.m);
  io.number(Key("beta", "", "the same as a share of the largest energy density").least(0), s.beta, d.beta);
}

void describe_fiber_law(Visitor& io, FiberFamily& f) {
  const FiberFamily d;
  io.word({"law", "", "how they pull"}, f.law, d.law);
  io.number(Key("k1", "Pa", "stiffness").above(0).must(), f.k1, d.k1);
  io.number(Key("k2", "", "how soon they stiffen").least(0), f.k2, d.k2);
  io.number(Key("dispersion", "", "0: all alike, 1/3: all directions").least(0), f.dispersion, d.dispersion);
  io.number(Key("exponent", "", "of the exponential law").above(1), f.exponent, d.exponent);
  io.flag({"isochoric", "", "strains of the part of F without change of volume"}, f.isochoric, d.isochoric);
  io.number(Key("straight_modulus", "Pa", "of the toe law").least(0), f.straight_modulus, d.straight_modulus);
  io.number(Key("straight_stretch", "", "of the toe law: where its line begins").least(0), f.straight_stretch,
            d.straight_stretch);
}

void describe(Visitor& io, FiberSpread& s) {
  const FiberSpread d;
  io.about("fiber_spread",
           "Fibers in all directions about one, see [spread](materials/fibers.md#fibers-in-all-directions).");
  io.number({"concentration", "", "0: all alike, large: along the direction, negative: across it"},
            s.concentration, d.concentration);
  io.integer(Key("rings", "", "of the quadrature: cones about the direction").least(1).most(64), s.rings,
             d.rings);
  io.integer(Key("around", "", "of the quadrature: directions on each").least(1).most(128), s.around,
             d.around);
}

void describe(Visitor& io, SceneFibers& f) {
  const SceneFibers d;
  io.about("fibers",
           "A family of fibers that only pull, added to the material, see [fibers](materials/fibers.md).");
  io.vector({"direction", "", "of all of them, at rest"}, f.direction, d.direction);
  io.points({"directions", "", "one a cell of the mesh, instead of `direction`"}, f.directions);
  io.text(
      {"field", "", "of the mesh file, with three components in cells or at nodes, instead of `direction`"},
      f.field, d.field);
  io.maybe_object({"spread", "", "in all directions about it, instead of one"}, f.spread);
  describe_fiber_law(io, f);
}

void describe(Visitor& io, CompressionPenalty& p) {
  const CompressionPenalty d;
  io.about("compression_penalty",
           "Added to every element: modulus (J - 1)^2 (beta (J - 1)^2 + 6) / 12, see [compression "
           "penalty](materials/compression_penalty.md).");
  io.number(Key("modulus", "Pa", "its stiffness").above(0).must(), p.modulus, d.modulus);
  io.number(Key("beta", "", "how soon it stiffens").least(0), p.beta, d.beta);
}

void describe(Visitor& io, CellField& f) {
  const CellField d;
  io.about("cell_field",
           "Numbers of cells of the body's mesh: one a cell (a factor on its stiffness, its Poisson's "
           "ratio), or a list "
           "of cells.");
  io.numbers({"values", "", "in place"}, f.values);
  io.text({"file", "", "text, numbers divided by blanks or lines; instead of `values`"}, f.file, d.file);
}

namespace {

void describe_own(Visitor& io, LawConstants& c) {
  const LawConstants d;
  io.number({"c1", "Pa",
             "of [mooney_rivlin](materials/mooney_rivlin.md) and "
             "[veronda_westmann](materials/veronda_westmann.md), with and without `isochoric_`"},
            c.c1, d.c1);
  io.number({"c2", "", "of the same: in Pa, and a pure number"}, c.c2, d.c2);
  io.number({"c20", "Pa", "of mooney_rivlin"}, c.c20, d.c20);
  io.number({"c11", "Pa", "of mooney_rivlin"}, c.c11, d.c11);
  io.number({"c02", "Pa", "of mooney_rivlin"}, c.c02, d.c02);
  io.numbers({"c", "Pa", "of [yeoh](materials/yeoh.md): its coefficients in order"}, c.c);
  io.number(Key("jm", "", "of [gent](materials/gent.md): I - 3 where chains are straight").least(0), c.jm,
            d.jm);
  io.number(Key("beta", "", "of [holmes_mow](materials/holmes_mow.md)").least(0), c.beta, d.beta);
  io.number(Key("mu0", "Pa", "of [fung](materials/stiffening.md)").least(0), c.mu0, d.mu0);
  io.number(Key("mu1", "", "of fung").least(0), c.mu1, d.mu1);
  io.number(Key("gamma", "Pa", "of fung").least(0), c.gamma, d.gamma);
  io.number(Key("beta1", "", "of [arruda_boyce](materials/stiffening.md)").least(0), c.beta1, d.beta1);
  io.number(Key("beta2", "", "of arruda_boyce").least(0), c.beta2, d.beta2);
  io.number(Key("beta3", "", "of arruda_boyce").least(0), c.beta3, d.beta3);
  io.number(Key("beta4", "", "of arruda_boyce").least(0), c.beta4, d.beta4);
  io.number(Key("locking_stretch", "", "of arruda_boyce, in place of the betas").least(0), c.locking_stretch,
            d.locking_stretch);
  io.list({"terms", "", "of [ogden](materials/ogden.md)"}, c.terms);
  io.word({"volume_energy", "", "[U(J)](materials/uncoupled.md) of a law with constants of its own"},
          c.volume_energy, d.volume_energy);
  io.text({"name", "", "of the law `named`: one of the [library](materials/library.md)"}, c.name, d.name);
  io.number(Key("resistance", "Pa", "of [stvk_resistant](materials/stvk.md)").least(0), c.resistance,
            d.resistance);
  io.number({"threshold", "", "of [isochoric_extended](materials/isochoric.md)"}, c.threshold, d.threshold);
}

}  // namespace

void describe(Visitor& io, MaterialDef& m) {
  const MaterialDef d;
  io.about("material",
           "A law and its constants at small strain: `young` and `poisson`, or `mu` with `lambda` or `bulk`. "
           "Constants of single laws are refused beside another law.");
  io.text(Key("region", "", "of the mesh").absent("every region not named elsewhere"), m.region, d.region);
  io.word({"law", "", "one of the [materials](materials/README.md)"}, m.law, d.law);
  io.number(Key("young", "Pa", "Young's modulus").above(0).absent("by others"), m.constants.young,
            d.constants.young);
  io.number(Key("poisson", "", "Poisson's ratio; 0.5: incompressible").most(0.5), m.constants.poisson,
            d.constants.poisson);
  io.number(Key("mu", "Pa", "shear modulus").above(0).absent("by others"), m.constants.mu, d.constants.mu);
  io.number_or_inf(Key("lambda", "Pa", "first Lamé parameter, may be `\"inf\"`").absent("by others"),
                   m.constants.lambda, d.constants.lambda);
  io.number_or_inf(Key("bulk", "Pa", "bulk modulus, may be `\"inf\"`").absent("by others"), m.constants.bulk,
                   d.constants.bulk);
  io.word({"bulk_choice", "", "what Poisson's ratio means for a [neo_hookean](materials/neo_hookean.md) law"},
          m.constants.bulk_choice, d.constants.bulk_choice);
  describe_own(io, m.own);
  io.list(
      {"prony", "", "terms of a [Prony series](materials/viscoelastic.md): an isochoric law then relaxes"},
      m.prony);
  io.word({"static_time", "", "what the time of a statics is to `prony`: everything has relaxed, or seconds"},
          m.static_time, d.static_time);
  io.maybe_object(
      {"mullins", "", "[softening](materials/mullins.md) of an isochoric law by what it has borne"},
      m.mullins);
  io.list({"fibers", "", "families of [fibers](materials/fibers.md)"}, m.fibers);
  io.optional_object({"compression_penalty", "", "against single crushed elements"}, m.compression_penalty,
                     m.compression_penalty.modulus != 0);
  io.optional_object({"stiffness_field", "", "factors on the stiffness"}, m.stiffness_field,
                     m.stiffness_field.given());
  io.optional_object({"poisson_field", "", "Poisson's ratios, in place of `poisson`"}, m.poisson_field,
                     m.poisson_field.given());
  io.number(Key("density", "kg/m^3", "").above(0), m.density, d.density);
}

}  // namespace isochor::keys
