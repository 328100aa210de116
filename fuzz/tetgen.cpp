// TetGen's pairs of files: the input is the .node file, a line "====" and the .ele file.
#include <algorithm>
#include <string_view>

#include "fuzz/input.h"
#include "isochor/mesh_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File nodes(".node"), cells(".ele");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = std::min(text.find("\n====\n"), size);
  const std::size_t rest = std::min(size, cut + 6);
  const std::string path = nodes.write(data, cut);
  cells.write(data + rest, size - rest);
  const auto mesh = isochor::read_mesh(path);
  if (!mesh)
    fuzz::require_message(mesh.error());
  else
    (void)isochor::check_mesh(mesh.value());
  return 0;
}
