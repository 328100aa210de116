// What is behind the handles of isochor.h, and the way into every call: one caller at a time, nothing thrown
// out.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "answers.h"
#include "isochor/batch.h"
#include "isochor/isochor.h"
#include "scenes/parts_by_keys.h"

namespace isochor::c {

// Thrown where a call is refused; never leaves the library.
struct Refused {
  iso_status status = ISO_REFUSED;
  std::string message;
};
[[noreturn]] inline void refuse(std::string message) {
  throw Refused{ISO_REFUSED, std::move(message)};
}
template <class T>
T need(Result<T> result) {
  if (!result) {
    throw Refused{result.failure().kind == ErrorKind::no_memory ? ISO_NO_MEMORY : ISO_REFUSED,
                  result.error()};
  }
  if constexpr (!std::is_void_v<T>) return std::move(result).value();
}

// First in every handle, so that one of another kind is found out.
enum class Kind : std::uint64_t {
  world = 0x69736f776f726c64,
  batch = 0x69736f6261746368,
  scene = 0x69736f7363656e65
};

// Who is in a call of a world, or of a batch and its worlds.
struct Callers {
  std::atomic<bool> busy{false};
  std::atomic<std::thread::id> user{};
};

// What the last call of a handle had to say.
class Said {
 public:
  void clear() { sentence_ = ""; }
  void say(const std::string& message) noexcept;
  void say_fixed(const char* sentence) { sentence_ = sentence; }
  // By a caller that was not let in, and may not touch what the one inside writes.
  void turn_away(const char* sentence);
  void forget_turned_away();
  const char* get() const;

 private:
  std::string text_;
  const char* sentence_ = "";
  std::atomic<const char*> turned_away_{nullptr};
  std::atomic<std::thread::id> whom_{};
};

// The names and settings that keys of parts refer to.
struct Keyring {
  std::vector<std::pair<std::string, BodyId>> bodies;
  AnalysisType analysis = AnalysisType::dynamics;
  Vec3 gravity{};
  Curve gravity_curve = Curve::constant(1);
  std::string folder;

  PartContext context(const World& world) const;
};

// The status that stands for how a step ended.
iso_status status_of(StepStatus status);

}  // namespace isochor::c

struct iso_world {
  isochor::c::Kind kind = isochor::c::Kind::world;
  std::optional<isochor::World> own;  // not those of a batch
  isochor::World* world = nullptr;
  isochor::c::Keyring keys;
  std::shared_ptr<isochor::c::Callers> callers = std::make_shared<isochor::c::Callers>();
  isochor::c::Said said;
  isochor::c::Answers answers;

  iso_world(isochor::World made, isochor::c::Keyring names)
      : own(std::move(made)), world(&*own), keys(std::move(names)) {}
  iso_world(isochor::World& one, isochor::c::Keyring names, std::shared_ptr<isochor::c::Callers> of)
      : world(&one), keys(std::move(names)), callers(std::move(of)) {}
};

struct iso_batch {
  isochor::c::Kind kind = isochor::c::Kind::batch;
  isochor::WorldBatch batch;
  std::shared_ptr<isochor::c::Callers> callers = std::make_shared<isochor::c::Callers>();
  std::vector<std::unique_ptr<iso_world>> worlds;
  std::vector<isochor::StepReport> reports;
  isochor::c::Said said;

  explicit iso_batch(isochor::WorldBatch made) : batch(std::move(made)) {}
};

struct iso_scene {
  isochor::c::Kind kind = isochor::c::Kind::scene;
  isochor::SceneDef scene;
  std::string json;
};

namespace isochor::c {

inline constexpr const char* kNoWorld = "the world is a null pointer; pass one that iso_world_create() made";
inline constexpr const char* kNotAWorld = "the handle is that of something else than a world";
inline constexpr const char* kNoBatch = "the batch is a null pointer; pass one that iso_batch_create() made";
inline constexpr const char* kNotABatch = "the handle is that of something else than a batch";
inline constexpr const char* kNoMemory = "there is not enough memory; free worlds, or take smaller meshes";
inline constexpr const char* kOtherThread =
    "another thread is in a call of this world; one thread at a time uses a world: wait for it, or give each "
    "thread its own";
inline constexpr const char* kCallback =
    "called in a callback of a call of the same world, which has not returned; of all calls only "
    "iso_cancel() "
    "may be made there";

template <class Handle>
constexpr Kind kind_of() {
  if constexpr (std::is_same_v<Handle, iso_world>) return Kind::world;
  if constexpr (std::is_same_v<Handle, iso_batch>) return Kind::batch;
  return Kind::scene;
}
// A handle that is there and of its kind.
template <class Handle>
bool good(const Handle* handle) {
  return handle != nullptr && handle->kind == kind_of<Handle>();
}

// Runs `f` and turns what it throws into a status and a sentence, handed to `say(message)` or
// `say_fixed(sentence)`.
template <class Speaker, class F>
iso_status caught(const char* call, Speaker& said, const F& f) noexcept {
  try {
    if constexpr (std::is_void_v<decltype(f())>) {
      f();
      return ISO_OK;
    } else {
      return f();
    }
  } catch (const Refused& refused) {
    try {
      said.say(std::string(call) + ": " + refused.message);
    } catch (...) {
      said.say_fixed(kNoMemory);
    }
    return refused.status;
  } catch (const std::bad_alloc&) {
    said.say_fixed(kNoMemory);
    return ISO_NO_MEMORY;
  } catch (const std::exception& error) {
    try {
      said.say(std::string(call) + ": an error of the library: " + error.what());
    } catch (...) {
      said.say_fixed(kNoMemory);
    }
    return ISO_FAILED;
  } catch (...) {
    said.say_fixed("an error of the library");
    return ISO_FAILED;
  }
}

// A call of a world or of a batch: f() does it, and returns a status or nothing (ISO_OK).
template <class Handle, class F>
iso_status enter(Handle* handle, const char* call, const F& f) noexcept {
  if (!good(handle)) return ISO_REFUSED;
  Callers& callers = *handle->callers;
  bool free = false;
  if (!callers.busy.compare_exchange_strong(free, true)) {
    handle->said.turn_away(callers.user.load() == std::this_thread::get_id() ? kCallback : kOtherThread);
    return ISO_BUSY;
  }
  callers.user = std::this_thread::get_id();
  handle->said.clear();
  const iso_status status = caught(call, handle->said, f);
  handle->said.forget_turned_away();
  callers.user = std::thread::id();
  callers.busy = false;
  return status;
}

// The buffer of calls that have no world yet.
class Buffer {
 public:
  Buffer(char* text, std::size_t size) : text_(text), size_(size) { say_fixed(""); }
  void say(const std::string& message) noexcept { say_fixed(message.c_str()); }
  void say_fixed(const char* sentence) noexcept;

 private:
  char* text_;
  std::size_t size_;
};

// Pointers that must be there, structs of the size that they have here.
template <class T>
T& given(T* pointer, const char* name) {
  if (pointer == nullptr) refuse(std::string(name) + " is a null pointer; pass where it is");
  return *pointer;
}
// Structs of callers that were compiled with another version of the header: a struct grows at its end only,
// and a member that is zero has its default. A smaller one, down to that of the first version, is filled up
// with zeros; what a larger one has beyond ours must be zero.
template <class T>
inline constexpr std::size_t kFirstSize = sizeof(T);  // specialized for a struct that has grown since
inline constexpr std::size_t kMostBeyond = 512;       // larger is a size that nobody set

template <class T>
void check_size(const T* pointer, const char* name) {
  const std::size_t size = given(pointer, name).size;
  if (size >= kFirstSize<T> && size <= sizeof(T) + kMostBeyond) return;
  refuse(std::string(name) + "->size = " + std::to_string(size) +
         "; set it to sizeof of the struct, which is " + std::to_string(sizeof(T)) +
         " in this version of the library");
}

// A struct that is read.
template <class T>
T taken(const T* pointer, const char* name) {
  check_size(pointer, name);
  T out{};
  const auto* bytes = reinterpret_cast<const unsigned char*>(pointer);
  const std::size_t size = pointer->size, known = std::min(size, sizeof(T));
  std::memcpy(&out, bytes, known);
  out.size = sizeof(T);
  if (std::any_of(bytes + known, bytes + size, [](unsigned char byte) { return byte != 0; }))
    refuse(std::string(name) +
           " has members set that this version of the library does not know; leave them zero "
           "or take a newer one");
  return out;
}

// A struct that is filled: here first, and by give() where the caller has it.
template <class T>
class Filled {
 public:
  Filled(T* pointer, const char* name) : out_(pointer) {
    check_size(pointer, name);
    value_.size = pointer->size;
  }
  T* operator->() { return &value_; }
  T& operator*() { return value_; }
  void give() {
    const std::size_t size = out_->size, known = std::min(size, sizeof(T));
    value_.size = size;
    std::memcpy(out_, &value_, known);
    std::memset(reinterpret_cast<unsigned char*>(out_) + known, 0, size - known);
  }

 private:
  T* out_;
  T value_{};
};
// The i-th of an array of them, whose step is the size that its first says.
template <class T>
T* nth(T* first, std::size_t i) {
  using Byte = std::conditional_t<std::is_const_v<T>, const unsigned char, unsigned char>;
  return reinterpret_cast<T*>(reinterpret_cast<Byte*>(first) + i * first->size);
}
inline std::string text(const char* pointer, const char* name) {
  return &given(pointer, name);
}
inline std::string text_or_none(const char* pointer) {
  return pointer == nullptr ? std::string() : std::string(pointer);
}
std::vector<std::string> texts(const char* const* list, std::size_t count, const char* name);

// A vector of three doubles.
Vec3 vector(const double* xyz, const char* name);
void put(const Vec3& v, double* xyz);  // null: nothing
// `count` vectors, `stride` bytes from one to the next; 0: without gaps.
std::vector<Vec3> vectors(const double* xyz, std::size_t count, std::size_t stride, const char* name);

static_assert(sizeof(BodyId) == sizeof(iso_body) && sizeof(EffectId) == sizeof(iso_effect));
inline BodyId id(iso_body body) {
  return std::bit_cast<BodyId>(body);
}
inline EffectId id(iso_effect effect) {
  return std::bit_cast<EffectId>(effect);
}
inline iso_body handle(BodyId id) {
  return std::bit_cast<iso_body>(id);
}
inline iso_effect handle(EffectId id) {
  return std::bit_cast<iso_effect>(id);
}

// Ids that a host has; those made from zeros or by number name nothing here.
BodyId body_of(const World& world, iso_body body);
EffectId effect_of(const World& world, iso_effect effect);

Mesh mesh_from(const iso_mesh* mesh);

}  // namespace isochor::c
