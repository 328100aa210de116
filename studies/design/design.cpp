// Outline of a design:
//   1. bodies that change get meshes of their own, files that trials write
//   2. unknowns: white numbers of the field (smooth_field.h), and moves over their ranges
//   3. a trial: mesh and factors go into the scene, which is built and goes through the times of the data;
//      gradients by all cells and moves come from World::gradients, a solve a number of the data
//   4. search (inverse/search.h): errors over noise, the field against what is taken for granted, volume
//   bounds
//      as errors of what is beyond them
//   5. at the end: errors, the deviation of each cell that the data leave
#include "studies/design/design.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/base/text.h"
#include "scenes/body_parts.h"
#include "scenes/schedule.h"
#include "studies/design/smooth_field.h"
#include "studies/design/write_gmsh.h"
#include "studies/inverse/search.h"

namespace isochor::design {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// A number without bounds as the logarithm of a factor within bounds: it begins with slope 1 at 0.
class BoundedLogarithm {
 public:
  BoundedLogarithm(double least, double most) : low_(std::log(least)), width_(std::log(most / least)) {
    const double share = -low_ / width_;
    shift_ = std::log(share / (1 - share));
    slope_ = 1 / (width_ * share * (1 - share));
  }
  double at(double m) const { return low_ + width_ * logistic(m); }
  double derivative(double m) const {
    const double s = logistic(m);
    return width_ * slope_ * s * (1 - s);
  }

 private:
  double logistic(double m) const { return 1 / (1 + std::exp(-(shift_ + slope_ * m))); }
  double low_, width_, shift_ = 0, slope_ = 1;
};

// Of unknowns without other means: so little that it only chooses among equals.
constexpr double kLeastChange = 1e-6;
// Of what is beyond a volume bound, over the volume, against errors over the largest change: it stays beyond
// by about one over the square.
constexpr double kVolumeWeight = 1e4;

Result<std::size_t> body_named(const SceneDef& scene, const std::string& name) {
  std::string known;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name) return b;
    known += (known.empty() ? "\"" : ", \"") + scene.bodies[b].name + "\"";
  }
  return Error{"design: the scene has no body \"" + name + "\"; it has " + known};
}

// The body with its mesh in a file, as the engine uses it.
Result<void> detach_mesh(SceneDef& scene, std::size_t body, const Mesh& mesh, const std::string& path) {
  SceneBody& b = scene.bodies[body];
  if (std::holds_alternative<LatticeMesh>(b.mesh))
    return Error{"design: body \"" + b.name + "\" is a lattice, whose cubes fit its surface; give a mesh"};
  if (mesh.cell_type == CellType::tri3)
    return Error{"design: body \"" + b.name + "\" is a thin body; only volume meshes change"};
  for (const MaterialDef& m : b.materials) {
    const bool by_cells = m.stiffness_field.given() || m.poisson_field.given();
    if (by_cells && (b.refine > 0 || !b.refine_where.empty()))
      return Error{"design: body \"" + b.name +
                   "\" is refined and has numbers by cell; give a mesh that is fine already"};
    for (const SceneFibers& f : m.fibers) {
      if (!f.field.empty())
        return Error{"design: fibers of body \"" + b.name +
                     "\" follow a field of its mesh file; give directions"};
    }
  }
  b.mesh = MeshFile{path};
  b.surfaces.clear();
  b.node_sets.clear();
  b.refine = 0;
  b.refine_where.clear();
  return write_gmsh(path, mesh);
}

class DesignSearch {
 public:
  DesignSearch(const SceneDef& scene, const inverse::Data& data, const DesignOptions& options)
      : scene_(scene), data_(data), options_(options) {
    out_.data = data;
    out_.noise = options.noise.value_or(options.stiffness ? 0.01 : 1e-4);
  }

  Result<void> begin();
  Result<Design> run();

 private:
  Eigen::Index cells() const { return field_ ? field_->cells() : 0; }
  Eigen::Index count() const { return cells() + static_cast<Eigen::Index>(options_.moves.size()); }
  Eigen::Index rows() const {
    return static_cast<Eigen::Index>(data_.values.size()) +
           (options_.least_volume || options_.most_volume ? 1 : 0);
  }
  double range(std::size_t k) const { return options_.moves[k].most - options_.moves[k].least; }
  std::vector<double> moves_at(const Vector& x) const;
  std::vector<double> factors_at(const Vector& x, Vector* slope) const;
  Result<void> prepare_field(const BuiltScene& built);
  Result<void> prepare_moves(const BuiltScene& built);
  Result<SceneDef> scene_at(const Vector& x, inverse::Data& data);
  inverse::ParametersOf parameters() const;
  Result<bool> errors(const Vector& x, Vector& r, Matrix* jacobian);
  void add_volume_row(const std::vector<double>& moves, Vector& r, Matrix* jacobian) const;
  Matrix chained(const Vector& x, const Matrix& by_numbers) const;
  Result<void> check_dependence(const Matrix& jacobian) const;
  double error_of(const Vector& r) const {
    const auto n = static_cast<Eigen::Index>(data_.values.size());
    return std::sqrt(r.head(n).squaredNorm() / static_cast<double>(n));
  }
  void tell_field(const Vector& x, const Matrix& by_numbers);
  Result<void> finish(const Vector& x);

  SceneDef scene_;
  inverse::Data data_;
  const DesignOptions& options_;
  Design out_;
  std::size_t field_body_ = 0, moved_body_ = 0;
  std::optional<SmoothField> field_;
  std::vector<std::vector<double>> present_;  // factors that materials of the field's body have already
  std::optional<Morph> morph_;
  std::string mesh_path_;
  std::vector<std::pair<bool, std::size_t>> carried_;  // points that move along: probe or quantity, which
  std::vector<MaterialPoint> points_;
  inverse::Answer last_;
  std::string refused_;
};

std::vector<double> DesignSearch::moves_at(const Vector& x) const {
  std::vector<double> out;
  for (std::size_t k = 0; k < options_.moves.size(); ++k)
    out.push_back(x[cells() + static_cast<Eigen::Index>(k)] * range(k));
  return out;
}

std::vector<double> DesignSearch::factors_at(const Vector& x, Vector* slope) const {
  const BoundedLogarithm within(options_.stiffness->least, options_.stiffness->most);
  const Vector m = field_->field(x.head(cells()));
  std::vector<double> out;
  if (slope) slope->resize(m.size());
  for (Eigen::Index c = 0; c < m.size(); ++c) {
    out.push_back(std::exp(within.at(m[c])));
    if (slope) (*slope)[c] = within.derivative(m[c]);
  }
  return out;
}

Result<void> DesignSearch::prepare_field(const BuiltScene& built) {
  const StiffnessField& s = *options_.stiffness;
  auto body = body_named(scene_, s.body);
  if (!body) return body.failure();
  field_body_ = body.value();
  if (!(s.least > 0 && s.least < 1 && s.most > 1)) {
    return Error{"design: factors from " + number(s.least) + " to " + number(s.most) +
                 "; 1, where they begin, must lie between, and all above 0"};
  }
  if (!(s.length > 0) || !(s.spread > 0))
    return Error{"design: length " + number(s.length) + " and spread " + number(s.spread) +
                 " of the stiffness field; give positive numbers"};
  const Mesh& mesh = built.world.mesh(built.bodies[field_body_]);
  field_.emplace(mesh, s.length, s.spread);
  for (const MaterialDef& m : scene_.bodies[field_body_].materials) {
    auto values =
        m.stiffness_field.given()
            ? read_field(m.stiffness_field, scene_.folder)
            : Result<std::vector<double>>(std::vector<double>(static_cast<std::size_t>(cells()), 1.0));
    if (!values) return values.failure();
    if (values.value().size() != static_cast<std::size_t>(cells()))
      return Error{"design: the stiffness field of body \"" + s.body + "\" is one of another mesh"};
    present_.push_back(std::move(values).value());
  }
  return {};
}

Result<void> DesignSearch::prepare_moves(const BuiltScene& built) {
  auto body = body_named(scene_, options_.moves.front().body);
  if (!body) return body.failure();
  moved_body_ = body.value();
  std::vector<Move> moves;
  for (const BodyMove& move : options_.moves) {
    if (move.body != options_.moves.front().body)
      return Error{"design: surfaces of two bodies move, \"" + options_.moves.front().body + "\" and \"" +
                   move.body + "\"; move one"};
    if (!(move.least <= 0 && move.most >= 0 && move.least < move.most))
      return Error{"design: surface \"" + move.surface + "\" moves from " + number(move.least) + " to " +
                   number(move.most) + " m; 0, where it is, must lie between"};
    moves.push_back(move);
  }
  const Mesh& mesh = built.world.mesh(built.bodies[moved_body_]);
  auto morph = Morph::make(mesh, moves, options_.hold);
  if (!morph) return Error{"design: " + morph.error()};
  morph_.emplace(std::move(morph).value());
  mesh_path_ =
      (std::filesystem::absolute(options_.folder) / (scene_.bodies[moved_body_].name + ".msh")).string();
  if (auto r = detach_mesh(scene_, moved_body_, mesh, mesh_path_); !r) return r;
  for (std::size_t p = 0; p < scene_.probes.size(); ++p) {
    if (static_cast<std::size_t>(scene_.probes[p].body) != moved_body_) continue;
    carried_.emplace_back(true, p);
    points_.push_back(locate(mesh, scene_.probes[p].point));
  }
  for (std::size_t q = 0; q < data_.quantities.size(); ++q) {
    if (!data_.quantities[q].marker || data_.quantities[q].of != moved_body_) continue;
    carried_.emplace_back(false, q);
    points_.push_back(locate(mesh, *data_.quantities[q].marker));
  }
  const std::vector<double> still(moves.size(), 0.0);
  out_.volume_before = morph_->volume(still);
  const double least = options_.least_volume.value_or(0), most = options_.most_volume.value_or(HUGE_VAL);
  if (!(least < most) || least > 100 * out_.volume_before || most < 0.01 * out_.volume_before)
    return Error{"design: volumes from " + number(least) + " to " + number(most) + " m^3, and the body has " +
                 number(out_.volume_before) + " m^3; give cubic meters"};
  return {};
}

Result<SceneDef> DesignSearch::scene_at(const Vector& x, inverse::Data& data) {
  SceneDef scene = scene_;
  if (field_) {
    const std::vector<double> factors = factors_at(x, nullptr);
    for (std::size_t m = 0; m < present_.size(); ++m) {
      auto& values = scene.bodies[field_body_].materials[m].stiffness_field;
      values.file.clear();
      values.values = present_[m];
      for (std::size_t c = 0; c < factors.size(); ++c) values.values[c] *= factors[c];
    }
  }
  if (morph_) {
    Mesh mesh = morph_->mesh();
    mesh.nodes = morph_->nodes(moves_at(x));
    if (auto r = write_gmsh(mesh_path_, mesh); !r) return r.failure();
    for (std::size_t k = 0; k < carried_.size(); ++k) {
      const Vec3 at = points_[k].at(mesh.nodes);
      if (carried_[k].first)
        scene.probes[carried_[k].second].point = at;
      else
        data.quantities[carried_[k].second].marker = at;
    }
  }
  return scene;
}

inverse::ParametersOf DesignSearch::parameters() const {
  return [this](const BuiltScene& built) -> Result<std::vector<Parameter>> {
    std::vector<Parameter> out;
    if (field_) out.push_back(Parameter::cell_stiffness(built.bodies[field_body_]));
    for (std::size_t k = 0; k < options_.moves.size(); ++k)
      out.push_back(Parameter::shape(built.bodies[moved_body_], morph_->motions()[k]));
    return out;
  };
}

// What is beyond a bound, as one more error.
void DesignSearch::add_volume_row(const std::vector<double>& moves, Vector& r, Matrix* jacobian) const {
  if (!options_.least_volume && !options_.most_volume) return;
  const double volume = morph_->volume(moves), unit = kVolumeWeight / (out_.noise * out_.volume_before);
  const double least = options_.least_volume.value_or(0), most = options_.most_volume.value_or(HUGE_VAL);
  const double beyond = volume < least ? volume - least : volume > most ? volume - most : 0;
  const auto row = r.size() - 1;
  r[row] = unit * beyond;
  if (!jacobian || beyond == 0) return;
  for (std::size_t k = 0; k < moves.size(); ++k) {
    std::vector<double> above = moves, below = moves;
    const double h = 1e-3 * range(k);  // volumes are cubic in moves
    above[k] += h;
    below[k] -= h;
    (*jacobian)(row, cells() + static_cast<Eigen::Index>(k)) =
        unit * (morph_->volume(above) - morph_->volume(below)) / (2 * h) * range(k);
  }
}

// By unknowns, of derivatives by relative stiffnesses of cells and by moves.
Matrix DesignSearch::chained(const Vector& x, const Matrix& by_numbers) const {
  Matrix out(by_numbers.rows(), count());
  if (field_) {
    Vector slope;
    (void)factors_at(x, &slope);
    out.leftCols(cells()) = field_->times(by_numbers.leftCols(cells()) * slope.asDiagonal());
  }
  for (std::size_t k = 0; k < options_.moves.size(); ++k) {
    const auto column = cells() + static_cast<Eigen::Index>(k);
    out.col(column) = range(k) * by_numbers.col(column);
  }
  return out;
}

Result<bool> DesignSearch::errors(const Vector& x, Vector& r, Matrix* jacobian) {
  const std::vector<double> moves = moves_at(x);
  if (morph_) {
    const double quality = morph_->quality(moves);
    if (!(quality >= options_.least_quality)) {
      out_.note = "cells of the mesh end the way: the least J against the mesh as it came is " +
                  number(quality) + ", below " + number(options_.least_quality);
      return false;
    }
  }
  inverse::Data data = data_;
  const auto scene = scene_at(x, data);
  if (!scene) return scene.failure();
  auto told = inverse::answer(scene.value(), data, jacobian ? parameters() : inverse::ParametersOf(),
                              options_.threads);
  if (!told) return told.failure();
  if (!told.value().found) {
    out_.note = "a trial has no equilibrium " + told.value().reason;
    return false;
  }
  last_ = std::move(told).value();
  if (out_.scale.size() == 0) out_.scale = inverse::scales(data_, last_);
  const auto n = static_cast<Eigen::Index>(data_.values.size());
  const Vector weight = (out_.noise * out_.scale).cwiseInverse();
  r.setZero(rows());
  for (Eigen::Index i = 0; i < n; ++i)
    r[i] = weight[i] * (last_.values[i] - data_.values[static_cast<std::size_t>(i)].value);
  if (jacobian) {
    jacobian->setZero(rows(), count());
    last_.jacobian = weight.asDiagonal() * last_.jacobian;
    jacobian->topRows(n) = chained(x, last_.jacobian);
  }
  if (morph_) add_volume_row(moves, r, jacobian);
  return true;
}

Result<void> DesignSearch::check_dependence(const Matrix& jacobian) const {
  const double most = jacobian.cwiseAbs().maxCoeff();
  if (field_ && !(jacobian.leftCols(cells()).cwiseAbs().maxCoeff() > 0))
    return Error{"design: no target depends on the stiffness of body \"" + options_.stiffness->body +
                 "\"; a load must act on it"};
  for (std::size_t k = 0; k < options_.moves.size(); ++k) {
    const double size = jacobian.col(cells() + static_cast<Eigen::Index>(k)).cwiseAbs().maxCoeff();
    if (size > 1e-12 * most) continue;
    return Error{"design: no target depends on where surface \"" + options_.moves[k].surface +
                 "\" is; leave it out"};
  }
  return {};
}

Result<void> DesignSearch::begin() {
  if (auto r = no_schedule(scene_, "design"); !r) return r.failure();
  auto built = build(scene_, {.threads = options_.threads});
  if (!built) return built.failure();
  if (options_.stiffness) {
    if (auto r = prepare_field(built.value()); !r) return r;
  }
  if (!options_.moves.empty()) {
    if (auto r = prepare_moves(built.value()); !r) return r;
  }
  Vector r;
  Matrix jacobian;
  const auto found = errors(Vector::Zero(count()), r, &jacobian);
  if (!found) return found.failure();
  if (!found.value()) return Error{"design: the scene as it is: " + out_.note};
  if (auto u = inverse::check_units(scene_, data_, last_); !u) return u;
  out_.before = last_.values;
  out_.error_before = error_of(r);
  return check_dependence(jacobian);
}

void DesignSearch::tell_field(const Vector& x, const Matrix& by_numbers) {
  Vector slope;
  out_.factor = factors_at(x, &slope);
  const Vector m = field_->deviations(by_numbers.leftCols(cells()) * slope.asDiagonal());
  for (Eigen::Index c = 0; c < m.size(); ++c) out_.deviation.push_back(slope[c] * m[c]);
}

Result<void> DesignSearch::finish(const Vector& x) {
  Vector r;
  Matrix jacobian;
  const auto there = errors(x, r, &jacobian);
  if (!there) return there.failure();
  if (!there.value()) return Error{"design: what was found is not found again: " + out_.note};
  out_.found = last_.values;
  out_.error = error_of(r);
  out_.reached = out_.error <= 1 + 1e-9;
  const std::vector<double> moves = moves_at(x);
  for (std::size_t k = 0; k < moves.size(); ++k) {
    const BodyMove& move = options_.moves[k];
    const double room = 1e-9 * range(k);
    out_.moves.push_back({move, moves[k], moves[k] <= move.least + room || moves[k] >= move.most - room});
  }
  if (morph_) {
    out_.quality = morph_->quality(moves);
    out_.volume = morph_->volume(moves);
  }
  if (field_) tell_field(x, last_.jacobian);
  inverse::Data data = data_;
  auto scene = scene_at(x, data);
  if (!scene) return scene.failure();
  out_.scene = std::move(scene).value();
  return {};
}

Result<Design> DesignSearch::run() {
  inverse::SearchProblem problem;
  problem.errors = rows();
  problem.start = Vector::Zero(count());
  problem.least = Vector::Constant(count(), -HUGE_VAL);
  problem.most = Vector::Constant(count(), HUGE_VAL);
  problem.prior = Vector::Ones(count());
  for (std::size_t k = 0; k < options_.moves.size(); ++k) {
    const auto at = cells() + static_cast<Eigen::Index>(k);
    problem.least[at] = options_.moves[k].least / range(k);
    problem.most[at] = options_.moves[k].most / range(k);
    problem.prior[at] = kLeastChange / out_.noise;
  }
  problem.evaluate = [&](const Vector& x, Vector& r, Matrix* jacobian) {
    const auto found = errors(x, r, jacobian);
    if (!found) refused_ = found.error();
    return found && found.value();
  };
  inverse::SearchOptions how;
  how.max_iterations = options_.max_iterations;
  how.many_unknowns = count() > 200;
  if (how.many_unknowns)
    how.function_tolerance = 1e-7, how.gradient_tolerance = 1e-8, how.parameter_tolerance = 1e-7;
  how.stop = options_.stop;
  how.on_iteration = [&](int iteration, double cost, const Vector& x) {
    const double taken = problem.prior.cwiseProduct(x).squaredNorm();
    DesignStep step;
    step.iteration = iteration;
    step.error = std::sqrt(std::max(0.0, 2 * cost - taken) / static_cast<double>(data_.values.size()));
    step.moves = moves_at(x);
    if (morph_) step.quality = morph_->quality(step.moves), step.volume = morph_->volume(step.moves);
    if (options_.on_iteration) options_.on_iteration(iteration, step.error);
    out_.history.push_back(std::move(step));
  };
  out_.note.clear();
  const inverse::Search found = inverse::search(problem, how);
  out_.converged = found.converged;
  out_.interrupted = found.interrupted;
  out_.reason = found.converged || found.interrupted ? "" : refused_.empty() ? found.reason : refused_;
  if (auto r = finish(found.x); !r) return r.failure();
  return std::move(out_);
}

}  // namespace

Result<BodyMove> parse_move(const std::string& text, const SceneDef& scene) {
  const std::string who = "--move \"" + text + "\": ";
  const std::string form = "give SURFACE=LEAST:MOST or BODY:SURFACE.x=LEAST:MOST, in meters";
  BodyMove out;
  const auto equals = text.rfind('=');
  if (equals == std::string::npos) return Error{who + "there are no bounds; " + form};
  std::string name = text.substr(0, equals);
  const auto colon = text.find(':', equals);
  if (colon == std::string::npos) return Error{who + "there is one bound; " + form};
  const auto least = inverse::number_in(text.substr(equals + 1, colon - equals - 1), who);
  if (!least) return least.failure();
  const auto most = inverse::number_in(text.substr(colon + 1), who);
  if (!most) return most.failure();
  out.least = least.value();
  out.most = most.value();
  if (name.size() > 2 && name[name.size() - 2] == '.' &&
      std::string("xyz").find(name.back()) != std::string::npos) {
    out.along = name.back();
    name.resize(name.size() - 2);
  }
  const auto of = name.find(':');
  if (of != std::string::npos) {
    out.body = name.substr(0, of);
    name = name.substr(of + 1);
  } else if (scene.bodies.size() == 1) {
    out.body = scene.bodies.front().name;
  } else {
    return Error{who + "the scene has several bodies; " + form};
  }
  if (name.empty()) return Error{who + "there is no surface; " + form};
  out.surface = name;
  return out;
}

Result<Design> design(const SceneDef& scene, const inverse::Data& data, const DesignOptions& options) {
  if (!options.stiffness && options.moves.empty())
    return Error{"design: nothing may be chosen; name a body with --stiffness or a surface with --move"};
  if ((options.least_volume || options.most_volume) && options.moves.empty())
    return Error{"design: volume bounds, and no surface moves; name one with --move"};
  if (auto r = inverse::check_statics(scene, "design"); !r) return r.failure();
  DesignSearch search(scene, data, options);
  if (auto r = search.begin(); !r) return r.failure();
  return search.run();
}

}  // namespace isochor::design
