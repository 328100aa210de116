// Programs as a shell runs them, in a folder of their own that is gone afterwards.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/files.h"

namespace test {

struct Outcome {
  int code = -1;  // 1000: ended by a signal
  std::string out, err;
};

class Shell {
 public:
  // `name`: of the folder, beside the number of the process.
  explicit Shell(const std::string& name)
      : folder_(std::filesystem::temp_directory_path() /
                ("isochor_" + name + "_" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;
  ~Shell() {
    std::error_code code;
    std::filesystem::remove_all(folder_, code);
  }
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path operator/(const std::string& file) const { return folder_ / file; }

  Outcome sh(const std::string& line) const {
    const std::string command = "cd '" + folder_.string() + "' && " + line + " > out.txt 2> err.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000, files::slurp(folder_ / "out.txt"),
            files::slurp(folder_ / "err.txt")};
  }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace test
