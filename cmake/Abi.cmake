# Writes a header with a number that stands for what the public headers say: any change of a declaration, a default or
# an enumerator changes it, comments and blanks do not. In: INCLUDE (folder with isochor/), OUTPUT
cmake_minimum_required(VERSION 3.25)
file(GLOB_RECURSE headers RELATIVE ${INCLUDE} ${INCLUDE}/isochor/*.h)
list(SORT headers)
set(all "")
foreach(header ${headers})
  file(READ ${INCLUDE}/${header} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX REPLACE "/\\*[^*]*\\*+([^/*][^*]*\\*+)*/" "" text "${text}")
  string(REGEX REPLACE "[ \t\r\n]+" " " text "${text}")
  string(APPEND all "${header}:${text}\n")
endforeach()
string(SHA256 hash "${all}")
string(SUBSTRING ${hash} 0 16 hash)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT "// Made by cmake/Abi.cmake from the public headers.
#pragma once

#include <cstdint>

namespace isochor {
inline constexpr std::uint64_t kPublicHeaders = 0x@hash@;
}
")
