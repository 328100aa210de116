#include "live/export.h"

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "live/guard.h"
#include "live/simulation.h"
#include "live_page.h"
#include "scenes/body_parts.h"
#include "scenes/scene_file.h"

namespace isochor::live {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Files = std::map<std::string, std::string>;  // names in the page, and what is in them

std::optional<std::string> content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path)) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::string engine_folder(const ExportOptions& options) {
  if (!options.engine.empty()) return options.engine;
  const char* set = std::getenv("ISOCHOR_LIVE_WASM");
  return set && *set ? set : ISOCHOR_LIVE_WASM_FOLDER;
}

// Letters and digits of the last part of a path behind a number: where a file was is nobody's business.
std::string name_in_page(std::size_t number, const std::string& path) {
  std::string name = std::to_string(number) + "_";
  for (const char c : fs::path(path).filename().string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-';
    name += plain ? c : '_';
  }
  return name;
}

// What the reader of a page has no library for, or would have to look for beside the file.
std::string not_for_pages(const std::string& path, const std::string& content) {
  const std::string extension = fs::path(path).extension().string();
  const bool xml = content.starts_with("<") || content.starts_with("\xEF\xBB\xBF<");
  const bool parted = extension == ".node" || extension == ".ele" || extension == ".face";
  if (!xml && !parted) return {};
  return path + ": pages without a server read no " + (xml ? "VTK XML" : "TetGen files") +
         "; convert it to Gmsh .msh, as by `meshio convert`, and name that in the scene";
}

// Puts names of the page in the place of paths: under "file", and the surface of a lattice.
Result<void> collect(Json& json, const std::string& folder, Files& files) {
  for (auto& [key, value] : json.items()) {
    const bool in_lattice = key == "lattice" && value.is_object() && value.contains("surface");
    Json* const named = key == "file" && value.is_string() ? &value
                        : in_lattice                       ? &value["surface"]
                                                           : nullptr;
    if (value.is_structured()) {
      if (auto r = collect(value, folder, files); !r) return r;
    }
    if (!named || named->get<std::string>().empty()) continue;
    const std::string path = path_in(folder, named->get<std::string>());
    auto content = content_of(path);
    if (!content) return Error{path + ": cannot be read; check the path"};
    if (const std::string why = not_for_pages(path, *content); !why.empty()) return Error{why};
    const std::string name = name_in_page(files.size(), path);
    files[name] = std::move(*content);
    *named = name;
  }
  return {};
}

// A folder that is gone with this.
struct Scratch {
  fs::path path;
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

// Whether the scene can be built of these files alone.
Result<void> try_out(const std::string& scene, const Files& files) {
  std::error_code code;
  const Scratch scratch{fs::temp_directory_path(code) / ("isochor_export_" + random_token())};
  if (code || !fs::create_directory(scratch.path, code))
    return Error{scratch.path.string() +
                 ": the folder cannot be made; set TMPDIR to one that can be written to"};
  for (const auto& [name, content] : files) {
    std::ofstream out(scratch.path / name, std::ios::binary);
    out << content;
    if (!out.flush()) return Error{(scratch.path / name).string() + ": cannot be written; is the disk full?"};
  }
  auto read = parse_scene(scene, "the scene of the page", scratch.path.string());
  if (!read) return read.failure();
  auto built = Simulation::make(std::move(read).value(), {});
  return built ? Result<void>() : built.failure();
}

}  // namespace

Result<std::string> export_page(const SceneDef& scene, const ExportOptions& options) {
  const fs::path folder = engine_folder(options);
  auto loader = content_of((folder / "isochor_live_engine.js").string());
  auto engine = content_of((folder / "isochor_live_engine.wasm").string());
  if (!loader || !engine) {
    return Error{
        (folder / "isochor_live_engine.wasm").string() +
        ": the engine for pages is not there; make it with live/wasm/build.sh, which needs Emscripten, or "
        "say in ISOCHOR_LIVE_WASM in which folder it is"};
  }
  CarriedScene page;
  Json json = Json::parse(to_json(scene), nullptr, false);
  if (auto r = collect(json, scene.folder, page.files); !r) return r.failure();
  page.scene = json.dump();
  if (auto r = try_out(page.scene, page.files); !r) return r.failure();
  page.title = scene.title.empty() ? scene.name : scene.title;
  page.playing = options.playing;
  page.loader = std::move(*loader);
  page.engine = std::move(*engine);
  std::string html = live_page(page);
  if (html.empty()) return Error{"the page could not be packed: is there memory left?", ErrorKind::no_memory};
  return html;
}

}  // namespace isochor::live
