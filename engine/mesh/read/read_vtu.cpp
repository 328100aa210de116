// VTK XML unstructured grids: ascii, inline base64 and appended (raw or base64) arrays, plain or
// zlib-compressed.
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <pugixml.hpp>

#include "engine/mesh/read/readers.h"
#include "engine/mesh/read/vtk_parts.h"

namespace isochor::mesh_files {

namespace {

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : (c == '/' ? 63 : -1);
}

// Bytes of one array, decoded as they are asked for: appended arrays do not say where they end.
class ByteStream {
 public:
  ByteStream(std::string_view source, bool base64) : source_(source), base64_(base64) {}

  // False if the source ends or is no base64 before `count` bytes are there.
  bool read(std::size_t count, std::string& out) {
    if (!base64_) {
      if (count > source_.size() - at_) return false;
      out.assign(source_.substr(at_, count));
      at_ += count;
      return true;
    }
    // A base64 source cannot hold more than this: refuse before anything is allocated.
    if (count > most()) return false;
    while (pending_.size() < count) {
      if (!decode_group()) return false;
    }
    out.assign(pending_, 0, count);
    pending_.erase(0, count);
    return true;
  }

  // An upper bound for the bytes that can still be read.
  std::size_t most() const {
    return base64_ ? pending_.size() + (source_.size() - at_) / 4 * 3 + 3 : source_.size() - at_;
  }

 private:
  // Four characters, three bytes. Padding may come inside a stream, where a header was encoded on its own.
  bool decode_group() {
    int digit[4] = {0, 0, 0, 0}, known = 0, padding = 0;
    while (known + padding < 4) {
      if (at_ >= source_.size()) return false;
      const char c = source_[at_++];
      if (c == ' ' || (c >= '\t' && c <= '\r')) continue;
      if (c == '=') {
        ++padding;
      } else if (padding > 0 || (digit[known++] = base64_digit(c)) < 0) {
        return false;
      }
    }
    const int bits = (digit[0] << 18) | (digit[1] << 12) | (digit[2] << 6) | digit[3];
    for (int i = 0; i < 3 - padding; ++i) pending_ += static_cast<char>((bits >> (16 - 8 * i)) & 255);
    return padding < 3;
  }

  std::string_view source_;
  std::size_t at_ = 0;
  std::string pending_;
  bool base64_;
};

struct VtuFile {
  Cursor at;
  std::string_view appended;  // behind the underscore
  bool appended_base64 = false, compressed = false, swapped = false, long_header = false;
};

struct NumberType {
  std::size_t bytes = 0;
  enum { signed_int, unsigned_int, real } kind = real;
};

NumberType number_type(VtuFile& f, std::string_view name) {
  for (const std::size_t bytes : {1, 2, 4, 8}) {
    if (name == "Int" + std::to_string(8 * bytes)) return {bytes, NumberType::signed_int};
    if (name == "UInt" + std::to_string(8 * bytes)) return {bytes, NumberType::unsigned_int};
    if (bytes > 2 && name == "Float" + std::to_string(8 * bytes)) return {bytes, NumberType::real};
  }
  f.at.fail("arrays of type " + quoted(name) + " are not read", "leave the array out when exporting");
}

template <class Stored, class Out>
void convert(const std::string& bytes, bool swapped, std::vector<Out>& out) {
  for (std::size_t i = 0; i + sizeof(Stored) <= bytes.size(); i += sizeof(Stored)) {
    char piece[sizeof(Stored)];
    std::memcpy(piece, bytes.data() + i, sizeof(Stored));
    if (swapped) std::reverse(piece, piece + sizeof(Stored));
    Stored value;
    std::memcpy(&value, piece, sizeof(Stored));
    out.push_back(static_cast<Out>(value));
  }
}

template <class Out>
void convert(VtuFile& f, NumberType type, const std::string& bytes, std::vector<Out>& out) {
  if (type.kind == NumberType::real) {
    // Casting an unbounded real to an integer is undefined, and indices are never reals.
    if constexpr (std::is_floating_point_v<Out>) {
      return type.bytes == 4 ? convert<float>(bytes, f.swapped, out) : convert<double>(bytes, f.swapped, out);
    } else {
      f.at.fail("indices are stored as reals", rewrite_file);
    }
  }
  const bool s = type.kind == NumberType::signed_int;
  switch (type.bytes) {
    case 1:
      return s ? convert<std::int8_t>(bytes, f.swapped, out) : convert<std::uint8_t>(bytes, f.swapped, out);
    case 2:
      return s ? convert<std::int16_t>(bytes, f.swapped, out) : convert<std::uint16_t>(bytes, f.swapped, out);
    case 4:
      return s ? convert<std::int32_t>(bytes, f.swapped, out) : convert<std::uint32_t>(bytes, f.swapped, out);
    default:
      return s ? convert<std::int64_t>(bytes, f.swapped, out) : convert<std::uint64_t>(bytes, f.swapped, out);
  }
}

std::uint64_t read_header_word(VtuFile& f, ByteStream& stream) {
  std::string bytes;
  if (!stream.read(f.long_header ? 8 : 4, bytes))
    f.at.fail("the binary data end in their header", rewrite_file);
  std::vector<std::uint64_t> word;
  f.long_header ? convert<std::uint64_t>(bytes, f.swapped, word)
                : convert<std::uint32_t>(bytes, f.swapped, word);
  return word[0];
}

std::string read_plain(VtuFile& f, ByteStream& stream) {
  const std::uint64_t size = read_header_word(f, stream);
  std::string bytes;
  if (size > stream.most() || !stream.read(static_cast<std::size_t>(size), bytes)) {
    f.at.fail(join("the binary data should have ", size, " bytes and end before"), rewrite_file);
  }
  return bytes;
}

// Blocks of one size but for the last, each deflated on its own: count, size, last size (0: full), deflated
// sizes.
std::string read_deflated(VtuFile& f, ByteStream& stream) {
  const std::uint64_t blocks = read_header_word(f, stream);
  const std::uint64_t block_size = read_header_word(f, stream);
  const std::uint64_t last_size = read_header_word(f, stream);
  if (blocks > stream.most()) f.at.fail(join(blocks, " compressed blocks are announced"), rewrite_file);
  std::vector<std::uint64_t> deflated;
  for (std::uint64_t b = 0; b < blocks; ++b) deflated.push_back(read_header_word(f, stream));
  std::string result, packed;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t size = b + 1 == blocks && last_size != 0 ? last_size : block_size;
    if (deflated[b] > stream.most() || !stream.read(static_cast<std::size_t>(deflated[b]), packed)) {
      f.at.fail(join("compressed block ", b, " should have ", deflated[b], " bytes and ends before"),
                rewrite_file);
    }
    // Deflate gains a factor of 1032 at most, so a larger size is a lie not worth allocating for.
    if (size / 1100 > deflated[b]) {
      f.at.fail(join("compressed block ", b, " announces ", size, " bytes"), rewrite_file);
    }
    const std::size_t start = result.size();
    result.resize(start + static_cast<std::size_t>(size));
    uLongf got = static_cast<uLongf>(size);
    const int status =
        uncompress(reinterpret_cast<Bytef*>(result.data() + start), &got,
                   reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size()));
    if (status != Z_OK || got != size) f.at.fail(join("compressed block ", b, " is damaged"), rewrite_file);
  }
  return result;
}

std::string read_bytes(VtuFile& f, const pugi::xml_node& array, std::string_view format) {
  if (format == "binary") {
    ByteStream stream(array.child_value(), true);
    return f.compressed ? read_deflated(f, stream) : read_plain(f, stream);
  }
  const std::string_view offset = array.attribute("offset").value();
  std::uint64_t start = 0;
  const auto [end, status] = std::from_chars(offset.data(), offset.data() + offset.size(), start);
  if (status != std::errc() || end != offset.data() + offset.size() || start >= f.appended.size()) {
    f.at.fail(
        join("the offset ", quoted(offset), " points outside of the ", f.appended.size(), " appended bytes"),
        rewrite_file);
  }
  ByteStream stream(f.appended.substr(static_cast<std::size_t>(start)), f.appended_base64);
  return f.compressed ? read_deflated(f, stream) : read_plain(f, stream);
}

template <class Out>
std::vector<Out> read_array(VtuFile& f, const pugi::xml_node& array) {
  const std::string name = array.attribute("Name").value();
  f.at.set_section("array " + quoted(name));
  const NumberType type = number_type(f, array.attribute("type").value());
  const std::string_view format = array.attribute("format").as_string("ascii");
  std::vector<Out> values;
  if (format == "ascii") {
    Cursor text(array.child_value(), f.at.file());
    text.set_section("array " + quoted(name) + ", counted from its first line");
    while (!text.peek_word().empty()) {
      if constexpr (std::is_floating_point_v<Out>) {
        values.push_back(text.any_real("a value"));
      } else {
        values.push_back(text.integer("a value"));
      }
    }
    return values;
  }
  if (format != "binary" && format != "appended") f.at.fail("unknown format " + quoted(format), rewrite_file);
  const std::string bytes = read_bytes(f, array, format);
  if (bytes.size() % type.bytes != 0) {
    f.at.fail(join(bytes.size(), " bytes are no whole number of values of ", type.bytes, " bytes"),
              rewrite_file);
  }
  values.reserve(bytes.size() / type.bytes);
  convert(f, type, bytes, values);
  return values;
}

pugi::xml_node child(VtuFile& f, const pugi::xml_node& parent, const char* name) {
  const pugi::xml_node found = parent.child(name);
  if (!found) f.at.fail(join("the element <", parent.name(), "> has no <", name, ">"), rewrite_file);
  return found;
}

std::vector<VtkArray> read_data(VtuFile& f, const pugi::xml_node& parent) {
  std::vector<VtkArray> arrays;
  for (const pugi::xml_node& node : parent.children("DataArray")) {
    const int components = node.attribute("NumberOfComponents").as_int(1);
    f.at.set_section("array " + quoted(node.attribute("Name").value()));
    // 0 components mean "not set" to some writers.
    if (components < 0 || components > 10000) f.at.fail(join(components, " components"), rewrite_file);
    arrays.push_back({node.attribute("Name").value(), std::max(1, components), read_array<double>(f, node)});
  }
  return arrays;
}

std::size_t announced(VtuFile& f, const pugi::xml_node& piece, const char* name) {
  f.at.set_section("<Piece>");
  const std::string_view text = piece.attribute(name).value();
  std::uint64_t count = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (status != std::errc() || end != text.data() + text.size()) {
    f.at.fail(join(name, " is ", quoted(text), ", not a count"), rewrite_file);
  }
  return static_cast<std::size_t>(count);
}

VtkCells read_cells(VtuFile& f, const pugi::xml_node& piece, std::size_t count) {
  const pugi::xml_node node = child(f, piece, "Cells");
  const auto array = [&](const char* name) {
    f.at.set_section("<Cells>");
    const pugi::xml_node found = node.find_child_by_attribute("DataArray", "Name", name);
    if (!found) f.at.fail("the array " + quoted(name) + " is missing", rewrite_file);
    return read_array<std::int64_t>(f, found);
  };
  VtkCells cells;
  cells.connectivity = array("connectivity");
  const std::vector<std::int64_t> ends = array("offsets");
  cells.types = array("types");
  f.at.set_section("<Cells>");
  if (ends.size() != count || cells.types.size() != count) {
    f.at.fail(join(count, " cells are announced but there are ", ends.size(), " offsets and ",
                   cells.types.size(), " types"),
              rewrite_file);
  }
  cells.offsets.insert(cells.offsets.end(), ends.begin(), ends.end());
  return cells;
}

void read_piece(VtuFile& f, const pugi::xml_node& piece, RawMesh& raw) {
  const std::size_t points = announced(f, piece, "NumberOfPoints");
  const std::size_t cell_count = announced(f, piece, "NumberOfCells");
  if (points == 0 && cell_count == 0) return;
  const std::size_t first = raw.nodes.size();
  const std::vector<double> coordinates =
      read_array<double>(f, child(f, child(f, piece, "Points"), "DataArray"));
  f.at.set_section("<Points>");
  if (coordinates.size() % 3 != 0 || coordinates.size() / 3 != points) {
    f.at.fail(join(points, " points are announced but there are ", coordinates.size(), " coordinates"),
              rewrite_file);
  }
  if (first + points > static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
    f.at.fail(join(first + points, " points"), "no mesh that large can be read");
  }
  add_vtk_points(f.at, coordinates, raw);
  const VtkCells cells = read_cells(f, piece, cell_count);
  const std::vector<VtkArray> cell_arrays = read_data(f, piece.child("CellData"));
  f.at.set_section("<Cells>");
  add_vtk_cells(f.at, cells, cell_arrays, static_cast<Index>(first), raw);
  for (VtkArray& array : read_data(f, piece.child("PointData"))) {
    f.at.set_section("<PointData>");
    // Fields of several pieces join if each piece has them; one that a piece lacks is told below.
    const auto same = std::find_if(raw.fields.begin(), raw.fields.end(),
                                   [&](const MeshField& old) { return old.name == array.name; });
    if (first == 0 || same == raw.fields.end()) {
      add_vtk_point_array(f.at, std::move(array), points, raw);
    } else {
      same->values.insert(same->values.end(), array.values.begin(), array.values.end());
    }
  }
  f.at.set_section("<PointData>");
  for (const MeshField& field : raw.fields) {
    if (field.values.size() != raw.nodes.size() * static_cast<std::size_t>(field.components)) {
      f.at.fail("not every piece has the array " + quoted(field.name) + " in the same shape", rewrite_file);
    }
  }
}

// Cuts the appended data off, since raw bytes are no XML, and closes the element instead.
std::string split_appended(VtuFile& f, std::string_view content) {
  const std::size_t start = content.find("<AppendedData");
  if (start == content.npos) return std::string(content);
  const std::size_t open = content.find('>', start);
  const std::size_t mark = open == content.npos ? open : content.find('_', open);
  if (mark == content.npos) f.at.fail("the appended data do not begin with '_'", rewrite_file);
  const std::size_t close = content.rfind("</AppendedData>");
  f.appended =
      content.substr(mark + 1, close == content.npos || close < mark ? content.npos : close - mark - 1);
  return std::string(content.substr(0, open)) + "/></VTKFile>";
}

void read_settings(VtuFile& f, const pugi::xml_node& root) {
  const std::string_view type = root.attribute("type").value();
  if (type != "UnstructuredGrid") {
    f.at.fail("the VTK file has the type " + quoted(type),
              "only UnstructuredGrid is read: export the volume mesh");
  }
  const std::string_view compressor = root.attribute("compressor").value();
  if (!compressor.empty() && compressor != "vtkZLibDataCompressor") {
    f.at.fail("the compressor is " + quoted(compressor), "write with zlib or without compression");
  }
  f.compressed = !compressor.empty();
  const std::string_view order = root.attribute("byte_order").as_string("LittleEndian");
  if (order != "LittleEndian" && order != "BigEndian") f.at.fail("byte order " + quoted(order), rewrite_file);
  f.swapped = (order == "LittleEndian") != (std::endian::native == std::endian::little);
  const std::string_view header = root.attribute("header_type").as_string("UInt32");
  if (header != "UInt32" && header != "UInt64") f.at.fail("header type " + quoted(header), rewrite_file);
  f.long_header = header == "UInt64";
  f.appended_base64 = std::string_view(root.child("AppendedData").attribute("encoding").value()) != "raw";
}

}  // namespace

RawMesh read_vtu(std::string_view content, const std::string& file) {
  VtuFile f{Cursor(content, file), {}, false, false, false, false};
  f.at.forget_place();
  const std::string xml = split_appended(f, content);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed) {
    const auto offset =
        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)), xml.size());
    const auto lines = std::count(xml.begin(), xml.begin() + static_cast<std::ptrdiff_t>(offset), '\n');
    f.at.fail(join("line ", lines + 1, " is no valid XML (", parsed.description(), ")"), rewrite_file);
  }
  f.at.set_section("<VTKFile>");
  const pugi::xml_node root = document.child("VTKFile");
  if (!root) f.at.fail("the element is missing", rewrite_file);
  read_settings(f, root);
  RawMesh raw;
  raw.file = file;
  for (const pugi::xml_node& piece : child(f, root, "UnstructuredGrid").children("Piece"))
    read_piece(f, piece, raw);
  return raw;
}

}  // namespace isochor::mesh_files
