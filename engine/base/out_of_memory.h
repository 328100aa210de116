// What calls say where memory runs out, in memory that a string has of its own where there is no other.
#pragma once

#include <new>
#include <string>

#include "isochor/types.h"

namespace isochor {

inline std::string out_of_memory(const char* call) {
  try {
    return std::string(call) +
           ": out of memory; take a coarser mesh or Solver::iterative, or give the process more";
  } catch (const std::bad_alloc&) {
    return "out of memory";
  }
}

inline Error no_memory(const char* call) {
  return {out_of_memory(call), ErrorKind::no_memory};
}

}  // namespace isochor
