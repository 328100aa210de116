// Given coordinates that do not move as one rigid body: nodes that follow data, and bones that share nodes.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "engine/base/text.h"
#include "engine/scene/builder.h"
#include "isochor/effects/support.h"

namespace isochor {

namespace {

class DrivenInstance final : public EffectInstance {};

// One node of the frames.
class FrameMotion final : public Motion {
 public:
  FrameMotion(std::shared_ptr<const DrivenDef> frames, std::size_t node)
      : frames_(std::move(frames)), node_(node) {}
  Vec3 displacement(double t, const Vec3& rest) const override {
    const std::vector<double>& times = frames_->times;
    const auto after = std::upper_bound(times.begin(), times.end(), t);
    if (after == times.begin()) return frames_->positions.front()[node_] - rest;
    if (after == times.end()) return frames_->positions.back()[node_] - rest;
    const auto k = static_cast<std::size_t>(after - times.begin());
    const Vec3 &a = frames_->positions[k - 1][node_], &b = frames_->positions[k][node_];
    return a + ((t - times[k - 1]) / (times[k] - times[k - 1])) * (b - a) - rest;
  }

 private:
  std::shared_ptr<const DrivenDef> frames_;
  std::size_t node_;
};

Result<void> check_frames(const DrivenDef& def) {
  if (def.nodes.empty()) return Error{"it has no nodes; list those that follow"};
  if (def.times.empty()) return Error{"it has no frames; give at least one time with positions"};
  if (def.positions.size() != def.times.size()) {
    return Error{"positions has " + std::to_string(def.positions.size()) + " frames, times " +
                 std::to_string(def.times.size()) + "; give one list of positions a time"};
  }
  for (std::size_t k = 0; k < def.times.size(); ++k) {
    const std::string frame = "times[" + std::to_string(k) + "] = " + number(def.times[k]);
    if (!std::isfinite(def.times[k])) return Error{frame + "; give a finite number"};
    if (k > 0 && !(def.times[k] > def.times[k - 1]))
      return Error{frame + " does not come after " + number(def.times[k - 1]) + "; times must ascend"};
    if (def.positions[k].size() != def.nodes.size()) {
      return Error{"positions[" + std::to_string(k) + "] has " + std::to_string(def.positions[k].size()) +
                   " entries, nodes " + std::to_string(def.nodes.size()) + "; give one position a node"};
    }
    for (const Vec3& p : def.positions[k]) {
      if (!finite(p))
        return Error{"positions[" + std::to_string(k) + "] has a coordinate that is no finite number"};
    }
  }
  std::vector<Index> sorted = def.nodes;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    return Error{"node " + std::to_string(*twice) + " is listed twice; list every node once"};
  return {};
}

class DrivenEffect final : public EffectSource {
 public:
  explicit DrivenEffect(DrivenDef def) : def_(std::make_shared<const DrivenDef>(std::move(def))) {}
  const std::string& name() const override { return def_->name; }
  void describe(Fingerprint& f) const override { f.add(*def_); }

  Result<void> check() const override {
    if (auto r = check_frames(*def_); !r) return Error{who() + r.error()};
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    if (!builder.has_body(def_->body)) return Error{who() + builder.no_body(def_->body)};
    const BodyData& body = builder.body(def_->body);
    for (std::size_t k = 0; k < def_->nodes.size(); ++k) {
      const Index node = def_->nodes[k];
      if (node < 0 || node >= body.mesh.node_count()) {
        return Error{who() + "node " + std::to_string(node) + " is none of body \"" + body.name +
                     "\"; its mesh has nodes 0 to " + std::to_string(body.mesh.node_count() - 1)};
      }
      const auto motion = std::make_shared<FrameMotion>(def_, k);
      for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        if (auto r = builder.prescribe(body.first_node + node, d, motion, def_->name); !r) return r.failure();
      }
    }
    return std::unique_ptr<EffectInstance>(std::make_unique<DrivenInstance>());
  }

 private:
  std::string who() const { return "driven \"" + def_->name + "\": "; }
  std::shared_ptr<const DrivenDef> def_;
};

// One node of several bones. Only those with a weight there.
class BlendedMotion final : public Motion {
 public:
  BlendedMotion(std::shared_ptr<const SkinDef> skin, std::vector<std::pair<std::size_t, double>> shares)
      : skin_(std::move(skin)), shares_(std::move(shares)) {}
  Vec3 displacement(double t, const Vec3& rest) const override {
    Vec3 u{};
    for (const auto& [bone, share] : shares_)
      u += share * (carried(skin_->bones[bone].track, t, rest) - rest);
    return u;
  }
  double turn(double t0, double t1) const override {
    double most = 0;
    for (const auto& [bone, share] : shares_) most = std::max(most, turned(skin_->bones[bone].track, t0, t1));
    return most;
  }

 private:
  std::shared_ptr<const SkinDef> skin_;
  std::vector<std::pair<std::size_t, double>> shares_;  // sum to one
};

class SkinEffect final : public EffectSource {
 public:
  explicit SkinEffect(SkinDef def) : def_(std::make_shared<const SkinDef>(std::move(def))) {}
  const std::string& name() const override { return def_->name; }
  void describe(Fingerprint& f) const override { f.add(*def_); }

  Result<void> check() const override {
    if (def_->bones.empty()) return Error{who() + "it has no bones; give at least one"};
    for (std::size_t b = 0; b < def_->bones.size(); ++b) {
      const SkinDef::Bone& bone = def_->bones[b];
      const std::string where = who() + "bones[" + std::to_string(b) + "]";
      if (auto r = check_poses(bone.track); !r) return Error{where + ": " + r.error()};
      if (bone.weights.empty() == bone.field.empty())
        return Error{where + ": give it either weights or a field of the mesh at nodes"};
      if (auto r = check_weights(where, bone.weights); !r) return r;
    }
    return {};
  }

  Result<std::unique_ptr<EffectInstance>> build(Builder& builder) const override {
    auto nodes = builder.select(def_->where, def_->name);
    if (!nodes) return nodes.failure();
    const BodyData& body = builder.body(def_->where.body);
    std::vector<std::vector<double>> weights;
    for (std::size_t b = 0; b < def_->bones.size(); ++b) {
      auto own = weights_of(def_->bones[b], body.mesh, who() + "bones[" + std::to_string(b) + "]");
      if (!own) return own.failure();
      weights.push_back(std::move(own).value());
    }
    for (const Index node : nodes.value()) {
      double sum = 0;
      std::vector<std::pair<std::size_t, double>> shares;
      for (std::size_t b = 0; b < weights.size(); ++b) {
        const double w = weights[b][at(node - body.first_node)];
        if (w > 0) shares.emplace_back(b, w);
        sum += w;
      }
      if (!(sum > 0)) {
        return Error{who() + "node " + std::to_string(node - body.first_node) +
                     " has no weight of any bone; give it one, or leave it out of the selection"};
      }
      for (auto& share : shares) share.second /= sum;
      const auto motion = std::make_shared<BlendedMotion>(def_, std::move(shares));
      for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        if (auto r = builder.prescribe(node, d, motion, def_->name); !r) return r.failure();
      }
    }
    return std::unique_ptr<EffectInstance>(std::make_unique<DrivenInstance>());
  }

 private:
  std::string who() const { return "skin \"" + def_->name + "\": "; }

  static Result<void> check_weights(const std::string& where, const std::vector<double>& weights) {
    for (std::size_t n = 0; n < weights.size(); ++n) {
      if (weights[n] >= 0 && std::isfinite(weights[n])) continue;
      return Error{where + ".weights[" + std::to_string(n) + "] = " + number(weights[n]) +
                   "; weights must be zero or positive"};
    }
    return {};
  }

  static Result<std::vector<double>> weights_of(const SkinDef::Bone& bone, const Mesh& mesh,
                                                const std::string& where) {
    std::vector<double> out = bone.weights;
    if (!bone.field.empty()) {
      const auto found = std::find_if(mesh.fields.begin(), mesh.fields.end(),
                                      [&](const MeshField& f) { return f.name == bone.field; });
      if (found == mesh.fields.end())
        return Error{where + ": field \"" + bone.field + "\" is none of the nodes of the mesh"};
      if (found->components != 1) {
        return Error{where + ": field \"" + bone.field + "\" has " + std::to_string(found->components) +
                     " components; weights have one"};
      }
      out = found->values;
    }
    if (out.size() != at(mesh.node_count())) {
      return Error{where + ": weights has " + std::to_string(out.size()) + " entries, the mesh of the body " +
                   std::to_string(mesh.node_count()) + " nodes; give one a node"};
    }
    if (auto r = check_weights(where, out); !r) return r.failure();
    return out;
  }

  std::shared_ptr<const SkinDef> def_;
};

// The numbers of a line; false where there are others or a word.
bool five_numbers(std::string text, std::array<double, 5>& v, std::size_t& count) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  for (count = 0; count < v.size() && words >> v[count];) ++count;
  std::string rest;
  words.clear();
  words >> rest;
  return count == v.size() && rest.empty();
}

}  // namespace

EffectPtr driven(DrivenDef def) {
  return std::make_shared<DrivenEffect>(std::move(def));
}

EffectPtr skin(SkinDef def) {
  return std::make_shared<SkinEffect>(std::move(def));
}

Result<DrivenDef> read_driven(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Error{path + ": cannot be read; check the name of the file of positions"};
  DrivenDef def;
  std::string line;
  for (int line_number = 1; std::getline(file, line); ++line_number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == std::string::npos || line[0] == '#') continue;
    const std::string where = path + ", line " + std::to_string(line_number) + ": ";
    std::array<double, 5> v{};
    std::size_t count = 0;
    if (!five_numbers(line, v, count)) {
      if (count == 0 && line_number == 1) continue;  // names of the columns
      return Error{where + "\"" + line + "\"; expected the five numbers t, node, x, y, z"};
    }
    if (!(v[1] >= 0) || v[1] > std::numeric_limits<Index>::max() || v[1] != std::floor(v[1]))
      return Error{where + "node = " + number(v[1]) + "; it must be a whole number from 0 on"};
    const auto node = static_cast<Index>(v[1]);
    if (def.times.empty() || v[0] != def.times.back()) {
      def.times.push_back(v[0]);
      def.positions.emplace_back();
    }
    const std::size_t place = def.positions.back().size();
    if (def.times.size() == 1) {
      def.nodes.push_back(node);
    } else if (place >= def.nodes.size() || def.nodes[place] != node) {
      return Error{where + "node " + std::to_string(node) + " at time " + number(v[0]) +
                   " is out of its place; every frame has the nodes of the first, in their order"};
    }
    def.positions.back().push_back({v[2], v[3], v[4]});
  }
  if (auto r = check_frames(def); !r) return Error{path + ": " + r.error()};
  return def;
}

}  // namespace isochor
