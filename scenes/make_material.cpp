#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "scenes/body_parts.h"
#include "scenes/material_fibers.h"

namespace isochor {

namespace {

// The laws that know a constant: those of a family, whose forms have the same ones.
enum class Family : std::uint8_t {
  none,
  mooney_rivlin,
  fung,
  arruda_boyce,
  ogden,
  yeoh,
  gent,
  veronda_westmann,
  holmes_mow,
  stvk_resistant,
  isochoric_extended,
  named
};

Family family_of(MaterialLaw law) {
  switch (law) {
    case MaterialLaw::mooney_rivlin:
    case MaterialLaw::isochoric_mooney_rivlin:
      return Family::mooney_rivlin;
    case MaterialLaw::fung:
    case MaterialLaw::isochoric_fung:
      return Family::fung;
    case MaterialLaw::arruda_boyce:
    case MaterialLaw::isochoric_arruda_boyce:
      return Family::arruda_boyce;
    case MaterialLaw::ogden:
    case MaterialLaw::isochoric_ogden:
      return Family::ogden;
    case MaterialLaw::yeoh:
    case MaterialLaw::isochoric_yeoh:
      return Family::yeoh;
    case MaterialLaw::gent:
    case MaterialLaw::isochoric_gent:
      return Family::gent;
    case MaterialLaw::veronda_westmann:
    case MaterialLaw::isochoric_veronda_westmann:
      return Family::veronda_westmann;
    case MaterialLaw::holmes_mow:
    case MaterialLaw::isochoric_holmes_mow:
      return Family::holmes_mow;
    case MaterialLaw::stvk_resistant:
      return Family::stvk_resistant;
    case MaterialLaw::isochoric_extended:
      return Family::isochoric_extended;
    case MaterialLaw::named:
      return Family::named;
    default:
      return Family::none;
  }
}

struct GivenConstant {
  const char* key;
  bool given;
  std::initializer_list<Family> families;  // that know it
  const char* laws;
};

// A constant that no one reads would be a mistake that nobody sees.
Result<void> check_constants(const MaterialDef& def) {
  const LawConstants& c = def.own;
  const std::initializer_list<Family> with_volume = {
      Family::mooney_rivlin, Family::fung, Family::arruda_boyce,     Family::ogden,
      Family::yeoh,          Family::gent, Family::veronda_westmann, Family::holmes_mow};
  const GivenConstant list[] = {
      {"c1",
       c.c1 != 0,
       {Family::mooney_rivlin, Family::veronda_westmann},
       "mooney_rivlin or veronda_westmann"},
      {"c2",
       c.c2 != 0,
       {Family::mooney_rivlin, Family::veronda_westmann},
       "mooney_rivlin or veronda_westmann"},
      {"c20", c.c20 != 0, {Family::mooney_rivlin}, "mooney_rivlin"},
      {"c11", c.c11 != 0, {Family::mooney_rivlin}, "mooney_rivlin"},
      {"c02", c.c02 != 0, {Family::mooney_rivlin}, "mooney_rivlin"},
      {"mu0", c.mu0 != 0, {Family::fung}, "fung"},
      {"mu1", c.mu1 != 0, {Family::fung}, "fung"},
      {"gamma", c.gamma != 0, {Family::fung}, "fung"},
      {"beta1", c.beta1 != 0, {Family::arruda_boyce}, "arruda_boyce"},
      {"beta2", c.beta2 != 0, {Family::arruda_boyce}, "arruda_boyce"},
      {"beta3", c.beta3 != 0, {Family::arruda_boyce}, "arruda_boyce"},
      {"beta4", c.beta4 != 0, {Family::arruda_boyce}, "arruda_boyce"},
      {"locking_stretch", c.locking_stretch != 0, {Family::arruda_boyce}, "arruda_boyce"},
      {"terms", !c.terms.empty(), {Family::ogden}, "ogden"},
      {"c", !c.c.empty(), {Family::yeoh}, "yeoh"},
      {"jm", c.jm != 0, {Family::gent}, "gent"},
      {"beta", c.beta != 0, {Family::holmes_mow}, "holmes_mow"},
      {"volume_energy", c.volume_energy != VolumeEnergyWord::by_law, with_volume,
       "yeoh or another with constants of its own"},
      {"name", !c.name.empty(), {Family::named}, "named"},
      {"resistance", c.resistance != 0, {Family::stvk_resistant}, "stvk_resistant"},
      {"threshold", c.threshold != 0.1, {Family::isochoric_extended}, "isochoric_extended"},
  };
  const Family family = family_of(def.law);
  for (const GivenConstant& g : list) {
    if (g.given && std::find(g.families.begin(), g.families.end(), family) == g.families.end()) {
      return Error{std::string(g.key) + " belongs to the law " + g.laws +
                   " and means nothing to the law given; remove it or change \"law\""};
    }
  }
  return {};
}

// Laws with constants of their own take Poisson's ratio or the modulus of their volume part from the common
// ones, a few mu, and nothing else.
Result<void> check_common(const MaterialDef& def, bool takes_mu) {
  const ElasticConstants& c = def.constants;
  const char* key = c.young != 0 ? "young" : (c.lambda != -1 ? "lambda" : nullptr);
  if (!key && c.bulk != -1 && def.law == MaterialLaw::named) key = "bulk";
  if (!key && c.mu != 0 && !takes_mu) key = "mu";
  if (!key && c.bulk_choice != BulkChoice::consistent) key = "bulk_choice";
  if (!key) return {};
  return Error{std::string(key) +
               " is given, but this law takes its own constants and \"poisson\" or \"bulk\"; remove it"};
}

Result<MaterialPtr> make_native(const MaterialDef& def) {
  const LawConstants& c = def.own;
  const double mu = def.constants.mu, bulk = def.constants.bulk;
  // Where bulk stands in its place, no ratio is given.
  const double poisson = bulk != -1 && def.constants.poisson == 0 ? 0.5 : def.constants.poisson;
  const auto volume = [&](VolumeEnergy standard) {
    switch (c.volume_energy) {
      case VolumeEnergyWord::quadratic:
        return VolumePart{VolumeEnergy::quadratic, bulk};
      case VolumeEnergyWord::logarithmic:
        return VolumePart{VolumeEnergy::logarithmic, bulk};
      case VolumeEnergyWord::mixed:
        return VolumePart{VolumeEnergy::mixed, bulk};
      default:
        return VolumePart{standard, bulk};
    }
  };
  const VolumePart part = volume(VolumePart{}.energy);
  const MooneyRivlinConstants mooney{c.c1, c.c2, poisson, c.c20, c.c11, c.c02, part};
  const FungConstants exponential{c.mu0, c.mu1, c.gamma, poisson, part};
  const ArrudaBoyceConstants chains{mu, c.beta1, c.beta2, poisson, c.beta3, c.beta4, c.locking_stretch, part};
  const OgdenConstants stretches{c.terms, poisson, volume(OgdenConstants{}.volume.energy)};
  const HolmesMowConstants cartilage{mu, c.beta, poisson, part};
  const bool takes_mu = family_of(def.law) == Family::arruda_boyce || family_of(def.law) == Family::gent ||
                        family_of(def.law) == Family::holmes_mow;
  if (auto r = check_common(def, takes_mu); !r) return r.failure();
  switch (def.law) {
    case MaterialLaw::mooney_rivlin:
      return mooney_rivlin(mooney);
    case MaterialLaw::isochoric_mooney_rivlin:
      return isochoric_mooney_rivlin(mooney);
    case MaterialLaw::fung:
      return fung(exponential);
    case MaterialLaw::isochoric_fung:
      return isochoric_fung(exponential);
    case MaterialLaw::arruda_boyce:
      return arruda_boyce(chains);
    case MaterialLaw::isochoric_arruda_boyce:
      return isochoric_arruda_boyce(chains);
    case MaterialLaw::ogden:
      return ogden(stretches);
    case MaterialLaw::isochoric_ogden:
      return isochoric_ogden(stretches);
    case MaterialLaw::yeoh:
      return yeoh({c.c, poisson, part});
    case MaterialLaw::isochoric_yeoh:
      return isochoric_yeoh({c.c, poisson, part});
    case MaterialLaw::gent:
      return gent({mu, c.jm, poisson, part});
    case MaterialLaw::isochoric_gent:
      return isochoric_gent({mu, c.jm, poisson, part});
    case MaterialLaw::veronda_westmann:
      return veronda_westmann({c.c1, c.c2, poisson, part});
    case MaterialLaw::isochoric_veronda_westmann:
      return isochoric_veronda_westmann({c.c1, c.c2, poisson, part});
    case MaterialLaw::holmes_mow:
      return holmes_mow(cartilage);
    case MaterialLaw::isochoric_holmes_mow:
      return isochoric_holmes_mow(cartilage);
    case MaterialLaw::named:
      return named_material(c.name, poisson);
    default:
      return Error{"unknown material law"};
  }
}

}  // namespace

static Result<MaterialPtr> make_matrix(const MaterialDef& def) {
  if (auto r = check_constants(def); !r) return r.failure();
  switch (def.law) {
    case MaterialLaw::neo_hookean:
      return neo_hookean(def.constants);
    case MaterialLaw::neo_hookean_ogden:
      return neo_hookean_ogden(def.constants);
    case MaterialLaw::stable_neo_hookean:
      return stable_neo_hookean(def.constants);
    case MaterialLaw::stable_neo_hookean_barrier:
      return stable_neo_hookean_barrier(def.constants);
    case MaterialLaw::isochoric_neo_hookean:
      return isochoric_neo_hookean(def.constants);
    case MaterialLaw::isochoric_extended:
      return isochoric_extended(def.constants, def.own.threshold);
    case MaterialLaw::corotated:
      return corotated(def.constants);
    case MaterialLaw::fixed_corotated:
      return fixed_corotated(def.constants);
    case MaterialLaw::stvk:
      return stvk(def.constants);
    case MaterialLaw::stvk_resistant:
      return stvk_resistant(def.constants, def.own.resistance);
    case MaterialLaw::linear:
      return linear(def.constants);
    default:
      return make_native(def);
  }
}

// The matrix with the fields of its constants.
static Result<MaterialPtr> make_varied(const MaterialDef& def, const std::string& folder) {
  if (!def.poisson_field.given()) return make_matrix(def);
  auto poisson = read_field(def.poisson_field, folder);
  if (!poisson) return Error{"poisson_field: " + poisson.error()};
  const ElasticConstants& c = def.constants;
  if (c.poisson != 0 || c.lambda != -1 || c.bulk != -1) {
    return Error{"poisson_field is given beside " +
                 std::string(c.poisson != 0   ? "poisson"
                             : c.lambda != -1 ? "lambda"
                                              : "bulk") +
                 "; it takes its place, remove one of them"};
  }
  return with_poisson_field(
      [&](double nu) {
        MaterialDef one = def;
        one.constants.poisson = nu;
        return make_matrix(one);
      },
      poisson.value());
}

// The directions of cells whose nodes have some: the axis a a^T sums up to, whatever the signs. Power
// iteration from the sum of the vectors turned to one side.
static Vec3 common_axis(const std::vector<Vec3>& a) {
  Vec3 axis{};
  for (const Vec3& v : a) axis += dot(axis, v) < 0 ? -1.0 * v : v;
  for (int i = 0; i < 50; ++i) {
    Vec3 next{};
    for (const Vec3& v : a) next += dot(v, axis) * v;
    const double n = std::sqrt(dot(next, next));
    if (!(n > 0)) break;
    axis = (1 / n) * next;
  }
  return axis;
}

static Result<std::vector<Vec3>> directions_of(const std::string& name, const Mesh* mesh) {
  if (!mesh) return Error{"field \"" + name + "\" is of a mesh, and there is none here; give directions"};
  const auto find = [&](const std::vector<MeshField>& fields) -> const MeshField* {
    const auto it =
        std::find_if(fields.begin(), fields.end(), [&](const MeshField& f) { return f.name == name; });
    return it == fields.end() ? nullptr : &*it;
  };
  const MeshField* in_cells = find(mesh->cell_fields);
  const MeshField* at_nodes = find(mesh->fields);
  const MeshField* field = in_cells ? in_cells : at_nodes;
  if (!field) {
    std::string known;
    for (const auto* list : {&mesh->cell_fields, &mesh->fields}) {
      for (const MeshField& f : *list) known += (known.empty() ? "\"" : ", \"") + f.name + "\"";
    }
    return Error{"field \"" + name + "\" is none of the mesh; it has " +
                 (known.empty() ? "no fields" : known)};
  }
  if (field->components != 3) {
    return Error{"field \"" + name + "\" has " + std::to_string(field->components) +
                 " components; a direction has three"};
  }
  const auto vector = [&](std::size_t i) {
    return Vec3{field->values[3 * i], field->values[3 * i + 1], field->values[3 * i + 2]};
  };
  std::vector<Vec3> out(static_cast<std::size_t>(mesh->cell_count()));
  const auto corners = static_cast<std::size_t>(nodes_per_cell(mesh->cell_type));
  for (std::size_t c = 0; c < out.size(); ++c) {
    if (in_cells) {
      out[c] = vector(c);
      continue;
    }
    std::vector<Vec3> a;
    for (std::size_t k = 0; k < corners; ++k)
      a.push_back(vector(static_cast<std::size_t>(mesh->cells[corners * c + k])));
    out[c] = common_axis(a);
  }
  return out;
}

Result<std::vector<FiberFamily>> fibers_of(const MaterialDef& def, const Mesh* mesh) {
  std::vector<FiberFamily> families;
  for (std::size_t i = 0; i < def.fibers.size(); ++i) {
    FiberFamily& family = families.emplace_back(def.fibers[i]);
    if (def.fibers[i].field.empty()) continue;
    const std::string who = "fibers[" + std::to_string(i) + "]: ";
    if (!family.directions.empty()) return Error{who + "both directions and field are given; give one"};
    auto directions = directions_of(def.fibers[i].field, mesh);
    if (!directions) return Error{who + directions.error()};
    family.directions = std::move(directions).value();
  }
  return families;
}

// With the families that stand for those in all directions.
static Result<std::vector<FiberFamily>> spread_all(const MaterialDef& def,
                                                   std::vector<FiberFamily>& families) {
  std::vector<FiberFamily> all;
  for (std::size_t i = 0; i < families.size(); ++i) {
    if (!def.fibers[i].spread) {
      all.push_back(std::move(families[i]));
      continue;
    }
    auto spread = spread_fibers(families[i], *def.fibers[i].spread);
    if (!spread) return Error{"fibers[" + std::to_string(i) + "]: " + spread.error()};
    all.insert(all.end(), spread.value().begin(), spread.value().end());
  }
  return all;
}

Result<MaterialPtr> make_material(const MaterialDef& def, const std::string& folder, const Mesh* mesh) {
  if (def.prony.empty() && def.static_time != StaticTime::long_term)
    return Error{"static_time is given without prony, whose time it would be; give its terms or drop it"};
  auto matrix = make_varied(def, folder);
  if (matrix && !def.prony.empty())
    matrix = with_prony_series(std::move(matrix).value(), def.prony, def.static_time);
  if (matrix && def.mullins) matrix = with_mullins_softening(std::move(matrix).value(), *def.mullins);
  if (matrix && !def.fibers.empty()) {
    auto families = fibers_of(def, mesh);
    if (!families) return families.failure();
    auto all = spread_all(def, families.value());
    if (!all) return all.failure();
    matrix = with_fibers(std::move(matrix).value(), all.value());
  }
  const CompressionPenalty& penalty = def.compression_penalty;
  const bool penalized = penalty.modulus != 0 || penalty.beta != CompressionPenalty{}.beta;
  if (matrix && penalized) matrix = with_compression_penalty(std::move(matrix).value(), penalty);
  if (!matrix || !def.stiffness_field.given()) return matrix;
  auto factor = read_field(def.stiffness_field, folder);
  if (!factor) return Error{"stiffness_field: " + factor.error()};
  return with_stiffness_field(std::move(matrix).value(), std::move(factor).value());
}

}  // namespace isochor
