#include "engine/base/available_memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>

namespace isochor {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

// The number behind `key` in a file of "key: number kB" lines [bytes].
double kilobytes(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key + ":")) continue;
    double value = 0;
    return std::sscanf(line.c_str() + key.size() + 1, "%lf", &value) == 1 ? 1024 * value : kUnknown;
  }
  return kUnknown;
}

double number_in(const char* file) {
  std::ifstream in(file);
  double value = 0;
  return in >> value ? value : kUnknown;  // "max" is no number
}

std::string size_text(double bytes) {
  char text[32];
  if (bytes < 1e8)
    std::snprintf(text, sizeof text, "%.0f MB", bytes / 1e6);
  else
    std::snprintf(text, sizeof text, bytes < 1e9 ? "%.2g GB" : "%.3g GB", bytes / 1e9);
  return text;
}

// Least bytes a cell at the peak, as measured on boxes of up to two million cells: of a world up to its first
// factorization, whose fill comes on top; of a check the faces that it sorts.
double bytes_per_cell(CellType type, MeshUse use) {
  const bool check = use == MeshUse::check;
  if (type == CellType::tri3) return check ? 150 : 3000;
  if (type == CellType::hex8) return check ? 250 : 15000;
  if (type == CellType::tet10) return check ? 200 : 19000;
  return check ? 150 : 2400;
}

}  // namespace

double available_memory() {
  double left = kilobytes("/proc/meminfo", "MemAvailable");
  const double most = number_in("/sys/fs/cgroup/memory.max"),
               used = number_in("/sys/fs/cgroup/memory.current");
  if (most < kUnknown && used < kUnknown) left = std::min(left, std::max(0.0, most - used));
  rlimit space{};
  if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) {
    const double taken = kilobytes("/proc/self/status", "VmSize");
    left =
        std::min(left, std::max(0.0, static_cast<double>(space.rlim_cur) - (taken < kUnknown ? taken : 0)));
  }
  return left;
}

std::string too_large_for_memory(double cells, CellType type, MeshUse use) {
  const double need = cells * bytes_per_cell(type, use);
  if (need < 1e8) return {};  // not worth a look
  const double left = available_memory();
  if (need <= left) return {};
  char count[32];
  std::snprintf(count, sizeof count, "%.0f", cells);
  return std::string("the mesh has ") + count +
         (type == CellType::hex8   ? " hexahedra"
          : type == CellType::tri3 ? " triangles"
                                   : " tetrahedra") +
         ", which take at least " + size_text(need) + " of memory, and " + size_text(left) +
         " are free; use a coarser mesh, or a machine with more memory";
}

}  // namespace isochor
