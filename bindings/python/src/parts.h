// Parts of a world from the keys of scene files, as JSON texts.
#pragma once

#include "interop.h"
#include "isochor/world.h"

namespace isochor::python {

// What effects may name, and what their amounts mean.
struct PartNames {
  std::vector<std::string> bodies;  // by number
  bool statics = false;
  Vec3 gravity{};

  void put(BodyId body, const std::string& name) {
    const auto place = static_cast<std::size_t>(body.number());
    if (bodies.size() <= place) bodies.resize(place + 1);
    bodies[place] = name;
  }
};

struct OptionParts {
  WorldOptions options;
  bool statics = false;
};
OptionParts options_from(const std::string& keys);
BodyDef body_from(const std::string& keys, const Mesh& mesh);
MaterialPtr material_from(const std::string& keys);
Selection selection_from(const std::string& keys, const PartNames& names);
EffectPtr effect_from(const std::string& list, const std::string& keys, const PartNames& names);

}  // namespace isochor::python
