// Measured curves of homogeneous tests: stretch against nominal stress.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "isochor/types.h"

namespace isochor::fit {

// How the block is loaded; the third direction is free of stress.
enum class Mode { uniaxial, equibiaxial, pure_shear };
const char* word(Mode mode);
Result<Mode> mode_of(const std::string& word);

struct Curve {
  std::string name;  // of the file, without folder and ending
  Mode mode = Mode::uniaxial;
  std::vector<double> stretch;  // [-]
  std::vector<double> stress;   // force over area at rest [Pa]
  std::string note;             // what was left out, in words; empty: nothing
};

// Of the stretches of all curves, with rest in it.
struct Range {
  double least = 1, most = 1;
};
Range range_of(const std::vector<Curve>& curves);

struct CurveOptions {
  // Names of columns; empty: found by what their names say.
  std::string strain_column, stress_column;
  std::string stress_unit;                // "Pa", "kPa", "MPa"; empty: what the name of the column says
  std::optional<double> lowest, highest;  // engineering strain; absent: all, up to the largest stress
};

// A CSV file, separated by commas, semicolons or tabs. Lines before the one that names a strain (or stretch)
// and a stress are skipped. Engineering columns are preferred; true strain and stress are converted, of an
// incompressible block. `path` may end in ":uniaxial", ":equibiaxial" or ":pure_shear". Errors name file,
// line and remedy.
Result<Curve> read_curve(const std::string& path, const CurveOptions& options);
// The same of a text; `source` is for messages and the name.
Result<Curve> read_curve(std::istream& in, const std::string& source, Mode mode, const CurveOptions& options);

}  // namespace isochor::fit
