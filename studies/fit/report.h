// Fits as a table, as JSON and as a page.
#pragma once

#include "studies/fit/fit.h"
#include "studies/page.h"

namespace isochor::fit {

// "mu 21.3 kPa +- 0.2": constants with the half width of their intervals.
std::string constants_text(const Fit& fit);

// fit.json: curves, options, and of each fit everything in Fit, SI units. Numbers that are not finite are
// null.
std::string fits_json(const std::vector<Curve>& curves, const std::vector<Fit>& fits);

// Measured and fitted stress a curve, the modes that were not measured, and the table.
studies::Page fits_page(const std::vector<Curve>& curves, const std::vector<Fit>& fits);

// fit.csv: a row a measured point, a column a law [Pa].
std::string fits_csv(const std::vector<Curve>& curves, const std::vector<Fit>& fits);

// Least error first; laws that turn over inside the data, and those that were not fitted, behind the others.
std::vector<const Fit*> by_error(const std::vector<Fit>& fits);
std::vector<std::string> table_head();
std::vector<std::string> table_row(const Fit& fit);

}  // namespace isochor::fit
