// The keys of a scene file. Every struct that a scene file holds has one function describe(Visitor&, T&),
// which names its keys with their units, bounds and meaning. The reader, the writer, the schema and the table
// of docs/scenes.md are visitors, so what one of them knows the others know. Defaults are those of the
// struct: a description hands over the member of an object as it is made.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/scene.h"

namespace isochor::keys {

struct Bounds {
  std::optional<double> least, above, most;  // above: an open bound
};

// A key as it is read, and as it is told to people.
struct Key {
  // `unit`: of SI; empty: a pure number, or none at all. `meaning`: one phrase in Markdown, links relative to
  // docs/.
  constexpr Key(const char* name_of_key, const char* unit_of_value, const char* phrase)
      : name(name_of_key), unit(unit_of_value), meaning(phrase) {}
  constexpr Key least(double v) const { return bounded({v, {}, bounds.most}); }
  constexpr Key above(double v) const { return bounded({{}, v, bounds.most}); }
  constexpr Key most(double v) const { return bounded({bounds.least, bounds.above, v}); }
  // Refused without it, by the reader or when the world is built.
  constexpr Key must() const {
    Key k = *this;
    k.needed = true;
    return k;
  }
  // What its absence means where no default value says it.
  constexpr Key absent(const char* means) const {
    Key k = *this;
    k.without = means;
    return k;
  }

  const char* name;
  const char* unit;
  const char* meaning;
  const char* without = "";
  bool needed = false;
  Bounds bounds;

 private:
  constexpr Key bounded(Bounds b) const {
    Key k = *this;
    k.bounds = b;
    return k;
  }
};

// A word of a scene file for the value of an enumeration. Several words may mean one value; the first is
// written.
struct Word {
  int value;
  std::string_view name;
};
template <class E>
struct Words;  // specialized by ISOCHOR_WORDS

#define ISOCHOR_WORD(E, name)        \
  Word {                             \
    static_cast<int>(E::name), #name \
  }
// The words of enumeration E, in namespace isochor::keys.
#define ISOCHOR_WORDS(E, ...)                                        \
  template <>                                                        \
  struct Words<E> {                                                  \
    static constexpr auto list = std::to_array<Word>({__VA_ARGS__}); \
  }

// How a number given for a curve is meant: statics ramps to it, from zero or from one; dynamics has it from
// the start, as `constant` has in both.
enum class CurveStart : std::uint8_t { zero, one, constant };

class Visitor;

// An object with keys, and a list of such objects, whatever their type.
struct Object {
  void* value;
  void (*keys)(Visitor&, void*);
};
template <class T>
Object object_of(T& value) {
  return {&value, [](Visitor& io, void* v) { describe(io, *static_cast<T*>(v)); }};
}

struct List {
  void* list;
  std::size_t (*size)(const void*);
  Object (*item)(void*, std::size_t);
  Object (*append)(void*);
};

class Visitor {
 public:
  virtual ~Visitor() = default;

  // What the object is that is described: a word for it, and a sentence.
  virtual void about(const char* type, const char* what) = 0;

  virtual void text(const Key& key, std::string& value, const std::string& standard) = 0;
  virtual void required_text(const Key& key, std::string& value) = 0;
  virtual void number(const Key& key, double& value, double standard) = 0;
  virtual void number_or_inf(const Key& key, double& value, double standard) = 0;
  virtual void optional_number(const Key& key, std::optional<double>& value) = 0;
  virtual void integer(const Key& key, int& value, int standard) = 0;
  virtual void flag(const Key& key, bool& value, bool standard) = 0;
  virtual void vector(const Key& key, Vec3& value, const Vec3& standard) = 0;
  virtual void required_vector(const Key& key, Vec3& value) = 0;
  virtual void optional_vector(const Key& key, std::optional<Vec3>& value) = 0;
  virtual void integers(const Key& key, std::array<int, 3>& value) = 0;
  virtual void names(const Key& key, std::vector<std::string>& value) = 0;  // a list, or one name
  virtual void indices(const Key& key, std::vector<Index>& value) = 0;
  virtual void numbers(const Key& key, std::vector<double>& value) = 0;
  virtual void points(const Key& key, std::vector<Vec3>& value) = 0;
  virtual void paths(const Key& key, std::vector<std::vector<Vec3>>& value) = 0;
  virtual void boxes(const Key& key, std::vector<std::array<Vec3, 2>>& value) = 0;
  virtual void optional_box(const Key& key, std::optional<std::array<Vec3, 2>>& value) = 0;
  virtual void directions(const Key& key, std::vector<Vec3>& value) = 0;  // "xz", or vectors
  // An angle in radians or, by another key, in degrees.
  virtual void angle(const Key& radians, const Key& degrees, double& value) = 0;
  virtual void optional_angle(const Key& radians, const Key& degrees, double& value, double standard) = 0;
  virtual void body(const Key& key, BodyId& value) = 0;  // by name; absent: the first
  virtual void optional_body(const Key& key, std::optional<BodyId>& value) = 0;
  // Absent: 1 with its ramp. It is written where it matters.
  virtual void curve(const Key& key, Curve& value, CurveStart start, bool matters) = 0;
  virtual void required_curve(const Key& key, Curve& value, CurveStart start) = 0;
  virtual void note(const Key& key) = 0;  // read and forgotten
  virtual void not_both(const char* a, const char* b) = 0;
  // The form of a mesh, which decides what keys it has.
  virtual void mesh_form(std::variant<MeshFile, BoxMeshDef, LatticeMesh>& mesh) = 0;

  template <class E>
  void word(const Key& key, E& value, E standard) {
    int v = static_cast<int>(value);
    choice(key, v, static_cast<int>(standard), Words<E>::list);
    value = static_cast<E>(v);
  }

  template <class T>
  void object(const Key& key, T& value) {
    object_at(key, object_of(value));
  }
  // May be absent as a whole: all of it has defaults.
  template <class T>
  void settings(const Key& key, T& value) {
    settings_at(key, object_of(value));
  }
  // Written where it is `present`.
  template <class T>
  void optional_object(const Key& key, T& value, bool present) {
    optional_at(key, object_of(value), present);
  }
  template <class T>
  void maybe_object(const Key& key, std::optional<T>& value) {
    T one = value.value_or(T{});
    if (optional_at(key, object_of(one), value.has_value())) value = std::move(one);
  }
  template <class T>
  void list(const Key& key, std::vector<T>& value) {
    list_at(key, as_list(value), !value.empty());
  }
  template <class T>
  void optional_list(const Key& key, std::optional<std::vector<T>>& value) {
    std::vector<T> all = value.value_or(std::vector<T>{});
    if (list_at(key, as_list(all), value.has_value())) value = std::move(all);
  }

  // What is read later depends on these.
  virtual void bodies_known(const std::vector<SceneBody>& bodies) = 0;
  virtual void analysis_known(const AnalysisDef& analysis) = 0;

 protected:
  virtual void choice(const Key& key, int& value, int standard, std::span<const Word> words) = 0;
  virtual void object_at(const Key& key, const Object& object) = 0;
  virtual void settings_at(const Key& key, const Object& object) = 0;
  // These say whether it is there now.
  virtual bool optional_at(const Key& key, const Object& object, bool present) = 0;
  virtual bool list_at(const Key& key, const List& list, bool present) = 0;

 private:
  template <class T>
  static List as_list(std::vector<T>& value) {
    using All = std::vector<T>;
    return {&value, [](const void* v) { return static_cast<const All*>(v)->size(); },
            [](void* v, std::size_t i) { return object_of((*static_cast<All*>(v))[i]); },
            [](void* v) { return object_of(static_cast<All*>(v)->emplace_back()); }};
  }
};

}  // namespace isochor::keys
