// Files that appear whole or not at all.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "isochor/types.h"

namespace isochor::mesh_files {

// Writes beside the target under a temporary name; commit() renames. Without commit() nothing is left behind.
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Failures are kept and reported by commit(), so that writers need not ask after every piece.
  void write(std::string_view bytes);
  Result<void> commit();

 private:
  void keep_failure(int code, const char* action);

  std::string path_, temporary_;
  std::FILE* stream_ = nullptr;
  std::string failure_;
};

}  // namespace isochor::mesh_files
