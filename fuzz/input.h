// What fuzz targets share: bytes as a file, for readers that take a path.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace fuzz {

// A file of the process in memory, written anew for every input.
class File {
 public:
  explicit File(const std::string& extension) {
    const char* folder = std::getenv("TMPDIR");
    path_ = std::string(folder != nullptr ? folder : "/tmp") + "/isochor_fuzz_" + std::to_string(getpid()) +
            extension;
  }
  ~File() { std::remove(path_.c_str()); }
  const std::string& write(const std::uint8_t* data, std::size_t size) {
    if (std::FILE* file = std::fopen(path_.c_str(), "wb")) {
      if (size > 0) std::fwrite(data, 1, size, file);
      std::fclose(file);
    }
    return path_;
  }

 private:
  std::string path_;
};

// What is refused says why.
inline void require_message(const std::string& message) {
  if (message.size() < 5) {
    std::fprintf(stderr, "refused without a message\n");
    std::abort();
  }
}

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

}  // namespace fuzz
