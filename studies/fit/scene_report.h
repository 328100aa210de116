// Fits of scenes as a table, as JSON and as a page.
#pragma once

#include "studies/fit/scene_fit.h"
#include "studies/page.h"

namespace isochor::fit {

std::vector<std::string> scene_table_head();
std::vector<std::vector<std::string>> scene_table_rows(const SceneFit& fit);
// fit.json: constants with intervals, errors, warnings; numbers that are not finite are null.
std::string scene_fit_json(const std::vector<Experiment>& experiments, const SceneFit& fit);
studies::Page scene_fit_page(const std::vector<Experiment>& experiments, const SceneFit& fit);

}  // namespace isochor::fit
