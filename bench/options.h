// Options that a benchmark does not know are refused: a measurement of something else than was asked for is
// worse than none.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string_view>

namespace isochor::bench {

// `flags` stand alone, `values` are followed by one. Ends the program with status 2 at anything else that
// starts with a dash, at a value that is missing, and at bare words unless these are wanted.
inline void check_options(int argc, char** argv, std::initializer_list<std::string_view> flags,
                          std::initializer_list<std::string_view> values, bool words = false) {
  const auto among = [](const auto& list, std::string_view word) {
    return std::find(list.begin(), list.end(), word) != list.end();
  };
  const auto refuse = [&](const char* word, const char* why) {
    std::fprintf(stderr, "%s: \"%s\" %s; known are%s", argv[0], word, why,
                 flags.size() + values.size() > 0 ? "" : " no options");
    for (const std::string_view f : flags) std::fprintf(stderr, " %s", f.data());
    for (const std::string_view v : values) std::fprintf(stderr, " %s VALUE", v.data());
    std::fprintf(stderr, "\n");
    std::exit(2);
  };
  for (int i = 1; i < argc; ++i) {
    if (among(flags, argv[i])) continue;
    if (among(values, argv[i])) {
      if (i + 1 >= argc) refuse(argv[i], "needs a value");
      ++i;
    } else if (argv[i][0] == '-' || !words) {
      refuse(argv[i], "is not an option");
    }
  }
}

}  // namespace isochor::bench
