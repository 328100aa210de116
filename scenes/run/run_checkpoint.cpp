#include "scenes/run/run_checkpoint.h"

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "engine/base/atomic_file.h"
#include "engine/base/bytes.h"
#include "results_page.h"

namespace isochor {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMagic = 0x6e75726f686373ull;  // "schorun"
constexpr std::uint64_t kVersion = 3;

struct Header {
  std::uint64_t magic = kMagic, version = kVersion, bytes = 0;
};

Error damaged(const std::string& path, const char* how) {
  return Error{path + ": this checkpoint " + how + "; run without --resume to begin anew"};
}

// All of a file; empty where it cannot be read.
std::vector<std::byte> bytes_of(const std::string& path, std::uint64_t most) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return {};
  const auto end = in.tellg();
  if (end <= 0) return {};
  std::vector<std::byte> bytes(std::min(static_cast<std::uint64_t>(end), most));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) bytes.clear();
  return bytes;
}

std::string_view view_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<void> write_checkpoint(const std::string& path, const RunCheckpoint& checkpoint) {
  ByteWriter out;
  out.put(Header{});
  out.put(checkpoint);
  const std::vector<std::byte> bytes = std::move(out).sealed(offsetof(Header, bytes));
  mesh_files::AtomicFile file(path);
  file.write(view_of(bytes));
  return file.commit();
}

Result<RunCheckpoint> read_checkpoint(const std::string& path) {
  const std::vector<std::byte> bytes = bytes_of(path, UINT64_MAX);
  ByteReader in(bytes);
  Header header;
  if (!in.take(header.magic) || header.magic != kMagic) return damaged(path, "is none");
  if (!in.take(header.version) || header.version != kVersion)
    return damaged(path, "is of another version of isochor");
  if (!in.take(header.bytes) || header.bytes != bytes.size()) return damaged(path, "is cut off");
  if (!ByteReader(bytes).unseal()) return damaged(path, "is damaged");
  RunCheckpoint checkpoint;
  in = ByteReader(
      std::span(bytes).subspan(sizeof(Header), bytes.size() - sizeof(Header) - sizeof(std::uint64_t)));
  if (!in.take(checkpoint) || in.left() > 0 || (checkpoint.records.empty() && !checkpoint.ended))
    return damaged(path, "is of another build of isochor");
  return checkpoint;
}

Result<void> PageJournal::append(const PageFrame& frame) {
  ByteWriter out;
  out.put(std::uint64_t{0});
  out.put(frame);
  const std::vector<std::byte> bytes = std::move(out).sealed(0);
  std::FILE* file = std::fopen(path_.c_str(), bytes_ == 0 ? "wb" : "ab");
  bool good = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  if (file) good = std::fclose(file) == 0 && good;
  if (!good) {
    return Error{path_ + ": writing failed: " + std::generic_category().message(errno) +
                 "; check the directory, its permissions and the free space"};
  }
  bytes_ += bytes.size();
  return {};
}

Result<std::vector<PageFrame>> PageJournal::restart(std::uint64_t bytes) {
  const std::vector<std::byte> all = bytes_of(path_, bytes);
  std::vector<PageFrame> frames;
  if (all.size() != bytes) return damaged(path_, "is cut off");
  for (std::span<const std::byte> left = all; !left.empty();) {
    std::uint64_t size = 0;
    if (!ByteReader(left).take(size) || size > left.size() || size < 2 * sizeof size ||
        !ByteReader(left.first(size)).unseal())
      return damaged(path_, "is damaged");
    ByteReader in(left.subspan(sizeof size, size - 2 * sizeof size));
    if (!in.take(frames.emplace_back()) || in.left() > 0) return damaged(path_, "is damaged");
    left = left.subspan(size);
  }
  std::error_code code;
  if (bytes > 0) fs::resize_file(path_, bytes, code);
  if (code) return Error{path_ + ": " + code.message()};
  bytes_ = bytes;
  return frames;
}

}  // namespace isochor
