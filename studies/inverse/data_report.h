// Data beside what a scene answers to them, as a table and as diagrams.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <utility>
#include <vector>

#include "studies/inverse/data.h"
#include "studies/page.h"

namespace isochor::inverse {

using Answers = std::vector<std::pair<std::string, const Eigen::VectorXd*>>;  // with their names

// A row a number: time, quantity, unit, what was given, and the answers.
std::string data_csv(const Data& data, const std::string& given, const Answers& answers);
// One a quantity that is given at two times or more, over time; at most `most`.
std::vector<studies::Diagram> data_diagrams(const Data& data, const std::string& given,
                                            const Answers& answers, std::size_t most = 12);

// With all digits.
std::string full(double value);

}  // namespace isochor::inverse
