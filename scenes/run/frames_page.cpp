#include "scenes/run/frames_page.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <sstream>
#include <vector>

#include "isochor/mesh_io.h"
#include "page_surface.h"
#include "results_page.h"
#include "scenes/run/run.h"

namespace isochor {

namespace {

namespace fs = std::filesystem;

// Files of one time, in the order of the collection.
using Times = std::map<double, std::vector<std::string>>;

Result<std::string> text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream out;
  out << in.rdbuf();
  if (!in) return Error{path.string() + " cannot be read"};
  return out.str();
}

std::optional<std::string> attribute(const std::string& tag, const std::string& name) {
  std::smatch found;
  if (!std::regex_search(tag, found, std::regex("\\b" + name + "\\s*=\\s*\"([^\"]*)\""))) return {};
  return found[1].str();
}

// Of a frame that several ranks wrote (.pvtu) the pieces, each as a body of its own.
Result<void> add_files(const fs::path& file, std::vector<std::string>& files) {
  if (file.extension() != ".pvtu") {
    files.push_back(file.string());
    return {};
  }
  const auto text = text_of(file);
  if (!text) return text.failure();
  const std::regex tag("<Piece\\b[^>]*>");
  for (std::sregex_iterator it(text.value().begin(), text.value().end(), tag), end; it != end; ++it) {
    const auto piece = attribute(it->str(), "Source");
    if (!piece) return Error{file.string() + ": " + it->str() + " has no Source"};
    files.push_back((file.parent_path() / *piece).string());
  }
  return {};
}

Result<Times> read_collection(const fs::path& path) {
  const auto text = text_of(path);
  if (!text) return text.failure();
  Times out;
  const std::regex tag("<DataSet\\b[^>]*>");
  for (std::sregex_iterator it(text.value().begin(), text.value().end(), tag), end; it != end; ++it) {
    const auto file = attribute(it->str(), "file"), time = attribute(it->str(), "timestep");
    if (!file || !time) return Error{path.string() + ": " + it->str() + " has no file or no timestep"};
    if (auto r = add_files(path.parent_path() / *file, out[std::strtod(time->c_str(), nullptr)]); !r)
      return r.failure();
  }
  if (out.empty()) return Error{path.string() + " names no frames (DataSet)"};
  return out;
}

Result<fs::path> find_collection(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    if (entry.path().extension() == ".pvd") found.push_back(entry.path());
  }
  if (code) return Error{folder.string() + " cannot be read: " + code.message()};
  if (found.size() == 1) return found.front();
  return Error{folder.string() + " holds " + std::to_string(found.size()) +
               " .pvd files; one is needed, as `isochor run` writes it"};
}

const MeshField* field_of(const Mesh& mesh, const std::string& name, int components) {
  for (const MeshField& f : mesh.fields) {
    if (f.name == name && f.components == components) return &f;
  }
  return nullptr;
}

PageField page_field(const std::string& name) {
  PageField field;
  field.name = field.label = name;
  if (name != "pressure") return field;
  field.label = "Mean stress";
  field.unit = "Pa";
  field.diverging = true;
  return field;
}

// The bodies of the first frame; later ones must have the same nodes.
// A frame of a solid, or of a thin body.
Result<Mesh> read_frame(const std::string& file) {
  auto solid = read_mesh(file);
  if (solid) return solid;
  MeshReadOptions options;
  options.triangles = true;
  auto thin = read_mesh(file, options);
  return thin ? thin : solid;
}

struct Bodies {
  PageScene scene;
  std::vector<std::vector<Index>> nodes;  // of the mesh, one a vertex of the page; one list a body
  std::vector<std::size_t> mesh_nodes;
  std::size_t elements = 0;
};

Result<PageFrame> frame_of(const Bodies& bodies, double time, const std::vector<std::string>& files) {
  if (files.size() != bodies.nodes.size())
    return Error{"the frame at " + std::to_string(time) + " has " + std::to_string(files.size()) +
                 " files, the first " + std::to_string(bodies.nodes.size())};
  PageFrame frame;
  frame.time = time;
  frame.fields.resize(bodies.scene.fields.size());
  for (std::size_t b = 0; b < files.size(); ++b) {
    const auto mesh = read_frame(files[b]);
    if (!mesh) return mesh.failure();
    const Mesh& m = mesh.value();
    if (m.nodes.size() != bodies.mesh_nodes[b])
      return Error{files[b] + " has " + std::to_string(m.nodes.size()) + " nodes, the first frame " +
                   std::to_string(bodies.mesh_nodes[b])};
    const MeshField* moved = field_of(m, "displacement", 3);
    for (const Index node : bodies.nodes[b]) {
      const auto n = static_cast<std::size_t>(node);
      Vec3 p = m.nodes[n];
      if (moved) p += Vec3{moved->values[3 * n], moved->values[3 * n + 1], moved->values[3 * n + 2]};
      frame.positions.push_back(p);
    }
    for (std::size_t f = 0; f < frame.fields.size(); ++f) {
      const MeshField* field = field_of(m, bodies.scene.fields[f].name, 1);
      for (const Index node : bodies.nodes[b])
        frame.fields[f].push_back(field ? field->values[static_cast<std::size_t>(node)] : 0);
    }
  }
  return frame;
}

// Not every frame carries fields: that of the rest state has none. They are taken from the last.
Result<Bodies> read_bodies(const std::vector<std::string>& first, const std::vector<std::string>& last) {
  Bodies out;
  for (const std::string& file : first) {
    auto mesh = read_frame(file);
    if (!mesh) return mesh.failure();
    out.nodes.push_back(add_page_mesh(out.scene, mesh.value(), {fs::path(file).stem().string()}));
    out.mesh_nodes.push_back(mesh.value().nodes.size());
    out.elements += static_cast<std::size_t>(mesh.value().cell_count());
  }
  for (const std::string& file : last) {
    auto mesh = read_frame(file);
    if (!mesh) return mesh.failure();
    for (const MeshField& f : mesh.value().fields) {
      const bool known = std::any_of(out.scene.fields.begin(), out.scene.fields.end(),
                                     [&](const PageField& p) { return p.name == f.name; });
      if (f.components == 1 && !known) out.scene.fields.push_back(page_field(f.name));
    }
  }
  out.scene.up = 'y';
  return out;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> out;
  std::stringstream in(line);
  for (std::string word; std::getline(in, word, ',');) out.push_back(word);
  return out;
}

// A column a curve: "chamber.pressure_Pa" stands in the chart "chamber".
std::vector<PageSeries> curves_of(const std::string& csv) {
  std::stringstream in(csv);
  std::string line;
  if (!std::getline(in, line)) return {};
  const std::vector<std::string> head = split(line);
  const auto at = std::find(head.begin(), head.end(), "time");
  if (at == head.end()) return {};
  const auto time = static_cast<std::size_t>(at - head.begin());
  std::vector<PageSeries> out(head.size());
  for (std::size_t c = 0; c < head.size(); ++c) {
    const auto dot = head[c].find('.');
    const bool error = head[c].find("residual") != std::string::npos || head[c] == "volume_row_residual" ||
                       head[c] == "volume_error";
    out[c].name = head[c];
    out[c].group = dot != std::string::npos ? head[c].substr(0, dot) : error ? "Errors" : head[c];
    out[c].log = error;
  }
  while (std::getline(in, line)) {
    const auto words = split(line);
    if (words.size() != head.size()) continue;
    for (std::size_t c = 0; c < head.size(); ++c) {
      const double v = std::strtod(words[c].c_str(), nullptr);
      out[c].x.push_back(std::strtod(words[time].c_str(), nullptr));
      out[c].y.push_back(out[c].log ? std::max(v, 1e-18) : v);
    }
  }
  std::vector<PageSeries> kept;
  for (PageSeries& s : out) {
    if (s.name != "time" && s.name != "step") kept.push_back(std::move(s));
  }
  return kept;
}

}  // namespace

Result<FramesPage> write_frames_page(const std::string& folder) {
  if (!results_page_available())
    return Error{"this build has no results page: it was made without node and npm"};
  const auto collection = find_collection(folder);
  if (!collection) return collection.failure();
  const auto times = read_collection(collection.value());
  if (!times) return times.failure();
  auto bodies = read_bodies(times.value().begin()->second, times.value().rbegin()->second);
  if (!bodies) return bodies.failure();
  auto recorder = ResultsRecorder::start(bodies.value().scene);
  if (!recorder) return recorder.failure();
  for (const auto& [time, files] : times.value()) {
    const auto frame = frame_of(bodies.value(), time, files);
    if (!frame) return frame.failure();
    if (auto r = recorder.value().append(frame.value()); !r) return r.failure();
  }
  PageReport report;
  report.title = collection.value().stem().string();
  report.subtitle = "From the frames of " + collection.value().filename().string() + ".";
  report.footer = "isochor " + version();
  report.run = {{"Elements", std::to_string(bodies.value().elements)},
                {"Frames", std::to_string(times.value().size())}};
  report.x_unit = "";
  if (const auto csv = text_of(fs::path(folder) / "steps.csv")) report.series = curves_of(csv.value());
  FramesPage out{(fs::path(folder) / "index.html").string(), times.value().size(), bodies.value().elements};
  if (auto r = recorder.value().write(out.path, report); !r) return r.failure();
  return out;
}

}  // namespace isochor
