#include "scenes/check_values.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace isochor {

namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", v);
  return text;
}

// A name fit for a message: what would end or garble a line is shown as a question mark.
std::string printable(std::string text) {
  for (char& c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20 || u == 0x7f) c = '?';
  }
  return text;
}

}  // namespace

std::string place(const std::string& list, std::size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

Result<void> check_name(const std::string& where, const std::string& name) {
  if (name.empty()) return Error{where + ".name is empty; give it a name"};
  if (name.size() > 100)
    return Error{where + ".name has " + std::to_string(name.size()) + " characters; 100 are allowed"};
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20 || u == 0x7f) {
      char code[8];
      std::snprintf(code, sizeof code, "U+%04X", u);
      return Error{where + ".name = \"" + printable(name) + "\" has the control character " + code +
                   ", which file names and tables cannot hold; remove it"};
    }
    if (c == '/' || c == '\\' || c == '"' || c == ',') {
      return Error{where + ".name = \"" + printable(name) + "\" has the character '" + c +
                   "', which file names or tables cannot hold; take another"};
    }
  }
  return {};
}

Result<void> check_curve(const std::string& where, const Curve& curve) {
  if (curve.points.empty()) return Error{where + " is empty; give a number or points [[time, value], ...]"};
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& p : curve.points) {
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
      return Error{where + " has a value that is no finite number"};
    if (p[0] < last) {
      return Error{where + " goes back in time from " + number(last) + " to " + number(p[0]) +
                   "; list its points by ascending time"};
    }
    last = p[0];
  }
  return {};
}

}  // namespace isochor
