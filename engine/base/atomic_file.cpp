#include "engine/base/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <random>
#include <system_error>

namespace isochor::mesh_files {

namespace {

// Beside the target, since a rename is atomic within one file system only; different for every writer.
std::string temporary_name(const std::string& path) {
  static const unsigned run = std::random_device{}();
  static std::atomic<unsigned> counter{0};
  return path + "." + std::to_string(run) + "-" + std::to_string(counter++) + ".tmp";
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), temporary_(temporary_name(path_)) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored)) {
    failure_ = path_ + ": cannot be written: it is a directory; give a file name";
    return;
  }
  stream_ = std::fopen(temporary_.c_str(), "wb");
  if (!stream_) keep_failure(errno, "cannot be created");
}

AtomicFile::~AtomicFile() {
  if (!stream_) return;
  std::fclose(stream_);
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::keep_failure(int code, const char* action) {
  if (!failure_.empty()) return;
  failure_ = path_ + ": " + action + ": " + std::generic_category().message(code) +
             "; check the directory, its permissions and the free space";
}

void AtomicFile::write(std::string_view bytes) {
  if (!stream_ || !failure_.empty()) return;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size())
    keep_failure(errno, "writing failed");
}

Result<void> AtomicFile::commit() {
  std::error_code error;
  if (stream_) {
    // A full disk may show only when the last buffer goes out.
    if (std::fclose(stream_) != 0) keep_failure(errno, "writing failed");
    stream_ = nullptr;
    if (failure_.empty()) {
      std::filesystem::rename(temporary_, path_, error);
      if (error) keep_failure(error.value(), "cannot be replaced");
    }
    if (!failure_.empty()) std::filesystem::remove(temporary_, error);
  }
  if (!failure_.empty()) return Error{failure_};
  return {};
}

}  // namespace isochor::mesh_files
