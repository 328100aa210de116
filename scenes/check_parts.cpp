#include "scenes/check_parts.h"

#include <cmath>
#include <cstdio>

namespace isochor {

namespace {

constexpr int kMostSteps = 1'000'000;

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

Result<void> check_lattice(const std::string& where, const LatticeMesh& lattice, Element element) {
  if (lattice.surface.empty()) return Error{where + ".surface is empty; name a file with a closed surface"};
  if (!(lattice.scale > 0) || !std::isfinite(lattice.scale)) {
    return Error{where + ".scale = " + number(lattice.scale) + "; it must be a positive number"};
  }
  if (!std::isfinite(dot(lattice.offset, lattice.offset)))
    return Error{where + ".offset has a coordinate that is no finite number"};
  if (!(lattice.spacing > 0) || !std::isfinite(lattice.spacing)) {
    return Error{where + ".spacing = " + number(lattice.spacing) +
                 " m; it must be a positive number, the edge of a cube"};
  }
  if (element != Element::hex8)
    return Error{where + ": its cells are hexahedra; set \"element\" of the body to \"hex8\""};
  return {};
}

Result<void> check_mesh_file(const std::string& where, const MeshFile& file) {
  if (file.path.empty()) return Error{where + ".file is empty; name a mesh file"};
  if (!(file.scale > 0) || !std::isfinite(file.scale))
    return Error{where + ".scale = " + number(file.scale) + "; it must be a positive number"};
  if (!std::isfinite(dot(file.turn, file.turn)))
    return Error{where + ".turn has a component that is no finite number"};
  if (!std::isfinite(dot(file.offset, file.offset)))
    return Error{where + ".offset has a coordinate that is no finite number"};
  return {};
}

}  // namespace

Result<void> check_body(const std::string& where, const SceneBody& body) {
  const bool thin = body.element == Element::tri3;
  if (!thin && body.materials.empty()) return Error{where + ".materials is empty; give the body a material"};
  if (thin && !body.materials.empty())
    return Error{where +
                 ".materials: a thin body (element \"tri3\") takes none; give it a shell in \"shells\", "
                 "which has its own modulus, thickness and density"};
  if (const auto* lattice = std::get_if<LatticeMesh>(&body.mesh))
    return check_lattice(where + ".mesh.lattice", *lattice, body.element);
  if (const auto* file = std::get_if<MeshFile>(&body.mesh)) return check_mesh_file(where + ".mesh", *file);
  return {};
}

static Result<void> check_static_until(const std::string& where, const AnalysisDef& a) {
  if (!a.static_until) return {};
  const std::string key = where + ".static_until = " + number(*a.static_until) + " s";
  if (!(*a.static_until > 0) || !(*a.static_until < a.duration)) {
    return Error{key + "; it must be positive and less than the duration, " + number(a.duration) +
                 " (statics throughout is " + where + ".type \"static\")"};
  }
  if (a.type == AnalysisType::statics)
    return Error{key + " belongs to dynamics; remove it or set " + where + ".type to \"dynamic\""};
  if (a.scheme == SchemeWord::implicit_midpoint)
    return Error{key + " does not go with implicit_midpoint, which balances forces in the middle of a step"};
  if (a.options.time_error > 0)
    return Error{key + " does not go with time_error, which is of dynamics from the start; drop one of them"};
  return {};
}

Result<void> check_analysis(const std::string& where, const AnalysisDef& a) {
  if (!(a.duration > 0) || !std::isfinite(a.duration)) {
    return Error{where + ".duration = " + number(a.duration) + "; it must be positive and finite"};
  }
  if (a.step && (!(*a.step > 0) || *a.step > a.duration * (1 + 1e-9))) {
    return Error{where + ".step = " + number(*a.step) + " s; it must be positive and at most the duration, " +
                 number(a.duration)};
  }
  if (a.step && a.duration / *a.step > kMostSteps) {
    return Error{where + ".step = " + number(*a.step) + " s asks for more than " +
                 std::to_string(kMostSteps) + " steps; take a longer one"};
  }
  // Steps are of one length and end with the duration; to the digits that people type.
  if (a.step && std::abs(std::round(a.duration / *a.step) * *a.step - a.duration) > 1e-5 * a.duration) {
    const double fewer = std::max(1.0, std::floor(a.duration / *a.step));
    return Error{where + ".step = " + number(*a.step) + " s does not divide the duration, " +
                 number(a.duration) + ": " + number(fewer) + " steps take " + number(a.duration / fewer) +
                 " s each and " + number(fewer + 1) + " take " + number(a.duration / (fewer + 1)) +
                 "; give one of these numbers as " + where + ".steps, or another duration"};
  }
  if (!a.step && (a.steps < 1 || a.steps > kMostSteps)) {
    return Error{where + ".steps = " + std::to_string(a.steps) + "; it must lie between 1 and " +
                 std::to_string(kMostSteps)};
  }
  if (!(a.spectral_radius >= 0 && a.spectral_radius <= 1)) {
    return Error{where + ".spectral_radius = " + number(a.spectral_radius) +
                 "; it must lie between 0 (damps the fastest motion at once) and 1 (not at all)"};
  }
  if (a.type == AnalysisType::statics && a.scheme != SchemeWord::implicit_euler) {
    return Error{where + ".scheme belongs to dynamics; remove it or set " + where + ".type to \"dynamic\""};
  }
  if (auto r = check_static_until(where, a); !r) return r;
  if (a.path_step && (!(*a.path_step > 0) || !std::isfinite(*a.path_step))) {
    return Error{where + ".path_step = " + number(*a.path_step) + " m; it must be positive and finite"};
  }
  if (a.path_step && a.type != AnalysisType::statics) {
    return Error{where + ".path_step belongs to statics; remove it or set " + where + ".type to \"static\""};
  }
  if (!(a.options.time_error >= 0) || !std::isfinite(a.options.time_error)) {
    return Error{where + ".time_error = " + number(a.options.time_error) +
                 "; it must be zero (no control) or a positive part of the scene's length"};
  }
  if (a.type == AnalysisType::statics && (a.options.time_error > 0 || a.options.consistent_mass)) {
    return Error{where + "." + std::string(a.options.time_error > 0 ? "time_error" : "consistent_mass") +
                 " belongs to dynamics; remove it or set " + where + ".type to \"dynamic\""};
  }
  if (!(a.options.smallest_fraction > 0) || a.options.smallest_fraction > 1) {
    return Error{where + ".smallest_fraction = " + number(a.options.smallest_fraction) +
                 "; it must be positive and at most 1"};
  }
  return {};
}

}  // namespace isochor
