// The keys of scene files as data: what functions, docstrings and stubs of the package are made from.
#include "scenes/keys/catalog.h"

#include <pybind11/stl.h>

#include "interop.h"
#include "scenes/effects/kind.h"

namespace isochor::python {

namespace {

py::dict dict_of(const keys::CatalogKey& key) {
  py::dict out;
  out["name"] = key.name;
  out["unit"] = key.unit;
  out["meaning"] = keys::plain_text(key.meaning);
  out["kind"] = key.kind;
  out["default"] = key.standard;  // as JSON; empty: none
  out["absent"] = keys::plain_text(key.without);
  out["type"] = key.type;
  out["words"] = py::cast(key.words);
  out["needed"] = key.needed;
  out["least"] = key.bounds.least;
  out["above"] = key.bounds.above;
  out["most"] = key.bounds.most;
  return out;
}

py::dict objects() {
  py::dict out;
  for (const keys::CatalogObject& object : keys::catalog_of_scene().objects) {
    py::list all;
    for (const keys::CatalogKey& key : object.keys) all.append(dict_of(key));
    py::dict one;
    one["what"] = keys::plain_text(object.what);
    one["keys"] = all;
    one["one_of"] = py::cast(object.one_of);
    out[py::str(object.type)] = one;
  }
  return out;
}

// Lists of effects by the name that they have in a scene file, in the order in which they are added.
py::list effect_lists() {
  py::list out;
  for (const EffectKind* kind : kinds_by_phase()) out.append(kind->key);
  return out;
}

}  // namespace

void bind_catalog(py::module_& module) {
  module.def("objects", &objects);
  module.def("effect_lists", &effect_lists);
}

}  // namespace isochor::python
