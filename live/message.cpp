#include "live/message.h"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace isochor::live {

namespace {

using Json = nlohmann::json;

class Writer {
 public:
  explicit Writer(const Json& head) {
    std::string text = head.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    u32(static_cast<std::uint32_t>(text.size()));
    out_ += text;
  }
  void u32(std::uint32_t v) {
    for (int k = 0; k < 4; ++k) out_ += static_cast<char>(v >> (8 * k) & 255u);
  }
  void f32(double v) {
    const auto narrow = static_cast<float>(v);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &narrow, sizeof bits);  // libc++ has std::bit_cast since version 14
    u32(bits);
  }
  void points(const std::vector<Vec3>& all) {
    for (const Vec3& p : all) {
      for (int k = 0; k < 3; ++k) f32(p[k]);
    }
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

// JSON has no number that is not finite.
Json finite(double v) {
  return std::isfinite(v) ? Json(v) : Json(nullptr);
}

Json triple(const Vec3& v) {
  return Json::array({finite(v.x), finite(v.y), finite(v.z)});
}

Json fields_json(const PageScene& scene) {
  Json out = Json::array();
  for (const PageField& f : scene.fields) {
    out.push_back({{"name", f.name},
                   {"label", f.label},
                   {"unit", f.unit},
                   {"place", f.per_triangle ? "triangle" : "vertex"},
                   {"diverging", f.diverging},
                   {"center", f.center},
                   {"categories", f.categories}});
  }
  return out;
}

// Fields with one value a triangle come after those of vertices.
std::size_t vertex_fields(const PageScene& scene) {
  std::size_t n = 0;
  while (n < scene.fields.size() && !scene.fields[n].per_triangle) ++n;
  return n;
}

const char* word(HandleKind kind) {
  return kind == HandleKind::pull ? "pull" : kind == HandleKind::pin ? "pin" : "push";
}

std::string hex(std::uint64_t v) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(v));
  return text;
}

}  // namespace

std::string error_message(const std::string& sentence) {
  return Json{{"error", sentence}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool is_computed(const Simulation& simulation, const std::string& field) {
  for (const PageField& f : simulation.shape().fields) {
    if (f.name == field) return !f.per_triangle && field != "displacement";
  }
  return false;
}

std::string scene_message(const Simulation& simulation, bool readonly) {
  const PageScene& s = simulation.shape();
  const SceneDef& scene = simulation.scene();
  Json parts = Json::array(), lines = Json::array(), dials = Json::array(), measures = Json::array();
  for (const PagePart& p : s.parts)
    parts.push_back({{"name", p.name}, {"color", p.color}, {"obstacle", p.obstacle}});
  for (const PageLine& l : s.lines) lines.push_back({{"name", l.name}, {"color", l.color}});
  for (const Dial& d : simulation.dials()) {
    dials.push_back({{"group", d.group},
                     {"name", d.name},
                     {"unit", d.unit},
                     {"low", d.low},
                     {"high", d.high},
                     {"log", d.logarithmic}});
  }
  for (const Measure& m : simulation.measures())
    measures.push_back({{"group", m.group}, {"name", m.name}, {"unit", m.unit}});
  // Maps stand in a picture behind the fields of vertices, of which one without fields has none.
  const auto& maps = simulation.maps();
  const Json head = {{"format", 1},
                     {"title", scene.title.empty() ? scene.name : scene.title},
                     {"subtitle", scene.description},
                     {"name", scene.name},
                     {"version", version()},
                     {"readonly", readonly},
                     {"records", simulation.records()},
                     {"notes", simulation.notes()},
                     {"dynamic", simulation.dynamic()},
                     {"step", simulation.step_length()},
                     {"up", std::string(1, s.up)},
                     {"vertices", s.rest.size()},
                     {"triangles", s.triangles.size() / 3},
                     {"fields", fields_json(s)},
                     {"maps", maps.size()},
                     {"parts", parts},
                     {"lines", lines},
                     {"probes", s.probes},
                     {"dials", dials},
                     {"measures", measures},
                     {"elements", simulation.elements()},
                     {"forces", has_contact(scene)},
                     {"fibers", simulation.has_fibers()},
                     {"handles", Hand::most}};
  Writer out(head);
  out.points(s.rest);
  for (const Index v : s.triangles) out.u32(static_cast<std::uint32_t>(v));
  for (const Index p : s.triangle_part) out.u32(static_cast<std::uint32_t>(p));
  for (const std::uint8_t e : s.triangle_edges) out.u32(e);
  for (const auto& map : maps) {
    for (const double v : map) out.f32(v);
  }
  return out.take();
}

namespace {

Json picture_head(const Simulation& simulation, const Shown& shown, const Audience& audience) {
  Json dials = Json::array(), measures = Json::array(), handles = Json::array(), lines = Json::array();
  for (const double v : shown.dials) dials.push_back(finite(v));
  for (const double v : shown.measures) measures.push_back(finite(v));
  for (const HandleState& h : shown.handles) {
    handles.push_back({{"id", h.id},
                       {"kind", word(h.kind)},
                       {"at", triple(h.at)},
                       {"to", triple(h.to)},
                       {"force", finite(h.force)},
                       {"radius", h.radius}});
  }
  for (const auto& line : shown.frame.lines) lines.push_back(line.size());
  Json head = {{"number", shown.number},
               {"step", shown.step},
               {"time", shown.time},
               {"playing", shown.playing},
               {"settled", shown.settled},
               {"failed", shown.failed},
               {"message", shown.message},
               {"speed", shown.speed},
               {"stepMs", shown.step_ms},
               {"perSecond", shown.per_s},
               {"spent", {shown.spent_on_steps, shown.spent_on_pictures}},
               {"dials", dials},
               {"measures", measures},
               {"handles", handles},
               {"lines", lines},
               {"probes", shown.frame.probes.size()},
               {"contacts", shown.frame.contacts.size()},
               {"hash", hex(shown.hash)},
               {"drives", audience.drives},
               {"viewers", audience.viewers},
               {"refused", audience.refused},
               {"vertices", simulation.shape().rest.size()}};
  head["factor"] = shown.factor ? finite(*shown.factor) : Json(nullptr);
  head["recorded"] = shown.recorded >= 0 ? Json(shown.recorded) : Json(nullptr);
  return head;
}

}  // namespace

std::string picture_message(const Simulation& simulation, const Shown& shown, const Wish& wish,
                            const Audience& audience) {
  const PageScene& s = simulation.shape();
  Json head = picture_head(simulation, shown, audience);
  const std::vector<double>* values = nullptr;
  const std::size_t computed = shown.values ? std::min(vertex_fields(s), shown.values->size()) : 0;
  for (std::size_t f = 0; f < computed; ++f) {
    if (s.fields[f].name == wish.field && is_computed(simulation, wish.field)) values = &(*shown.values)[f];
  }
  const std::vector<PageForce> none;
  const auto& forces = wish.forces ? shown.frame.forces : none;
  const std::vector<Vec3> fibers = wish.fibers ? shown.frame.fibers : std::vector<Vec3>();
  head["field"] = values ? Json(wish.field) : Json(nullptr);
  head["forces"] = forces.size();
  head["fibers"] = fibers.size();
  head["values"] = values ? values->size() : 0;
  Writer out(head);
  // From rest: places far from the origin, and motions far smaller than the body, keep their digits.
  for (std::size_t v = 0; v < s.rest.size(); ++v) {
    const Vec3 moved = shown.frame.positions[v] - s.rest[v];
    for (int k = 0; k < 3; ++k) out.f32(moved[k]);
  }
  for (std::size_t i = 0; values && i < values->size(); ++i) out.f32((*values)[i]);
  for (const auto& line : shown.frame.lines) out.points(line);
  out.points(shown.frame.probes);
  out.points(shown.frame.contacts);
  for (const PageForce& f : forces) out.points({f.at, f.normal, f.friction});
  out.points(fibers);
  return out.take();
}

}  // namespace isochor::live
