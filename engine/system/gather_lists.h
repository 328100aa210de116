// Sorts contributions into gather lists while a system is compiled.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include "engine/system/system.h"

namespace isochor {

// One contribution to a destination that is named by two indices.
struct Contribution {
  std::uint64_t key = 0;  // (first << 32) | second
  std::int64_t source = 0;
  double weight = 1;
};

inline std::uint64_t key_of(Index first, Index second) {
  return (static_cast<std::uint64_t>(first) << 32) | static_cast<std::uint32_t>(second);
}

inline std::uint64_t destination(const Contribution& c) {
  return c.key;
}
inline std::uint64_t destination(std::uint64_t key) {
  return key;
}

// By destination, in linear time and stable: contributions to one stay as they came, and this order is what
// makes sums independent of the thread count.
template <class T>
void sort_by_destination(std::vector<T>& items) {
  std::array<std::uint64_t, 2> largest{};
  for (const T& item : items) {
    largest[0] = std::max(largest[0], destination(item) & 0xffffffffu);
    largest[1] = std::max(largest[1], destination(item) >> 32);
  }
  std::vector<T> sorted(items.size());
  for (const int half : {0, 1}) {
    if (largest[static_cast<std::size_t>(half)] == 0) continue;
    const auto bucket = [half](const T& item) { return (destination(item) >> (32 * half)) & 0xffffffffu; };
    std::vector<std::size_t> next(largest[static_cast<std::size_t>(half)] + 2, 0);
    for (const T& item : items) ++next[bucket(item) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const T& item : items) sorted[next[bucket(item)]++] = item;
    items.swap(sorted);
  }
}

// Destinations that have contributions, in `ends` by their two indices.
inline void gather_by_key(std::vector<Contribution>& c, bool weighted, Gather& gather,
                          std::vector<std::array<Index, 2>>& ends) {
  sort_by_destination(c);
  gather.source.reserve(c.size());
  if (weighted) gather.weight.reserve(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (i == 0 || c[i].key != c[i - 1].key) {
      if (i != 0) gather.offset.push_back(static_cast<std::int64_t>(i));
      ends.push_back({static_cast<Index>(c[i].key >> 32), static_cast<Index>(c[i].key & 0xffffffffu)});
    }
    gather.source.push_back(c[i].source);
    if (weighted) gather.weight.push_back(c[i].weight);
  }
  if (!c.empty()) gather.offset.push_back(static_cast<std::int64_t>(c.size()));
}

// Gather lists for destinations 0..count-1, the key being the destination.
inline void fill_gather(std::vector<Contribution>& c, std::int64_t count, Gather& gather) {
  sort_by_destination(c);
  std::size_t i = 0;
  for (std::int64_t d = 0; d < count; ++d) {
    for (; i < c.size() && c[i].key == static_cast<std::uint64_t>(d); ++i) {
      gather.source.push_back(c[i].source);
      gather.weight.push_back(c[i].weight);
    }
    gather.offset.push_back(static_cast<std::int64_t>(i));
  }
}

}  // namespace isochor
