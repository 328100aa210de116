#include "studies/inverse/data_report.h"

#include <cstdio>

namespace isochor::inverse {

std::string full(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string data_csv(const Data& data, const std::string& given, const Answers& answers) {
  std::string out = "time,quantity,unit," + given;
  for (const auto& [name, values] : answers) out += "," + name;
  out += "\n";
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    const Datum& d = data.values[i];
    const Quantity& q = data.quantities[d.quantity];
    out += full(data.time[d.step]) + "," + q.name + "," + unit_of(q.kind) + "," + full(d.value);
    for (const auto& [name, values] : answers) out += "," + full((*values)[static_cast<Eigen::Index>(i)]);
    out += "\n";
  }
  return out;
}

std::vector<studies::Diagram> data_diagrams(const Data& data, const std::string& given,
                                            const Answers& answers, std::size_t most) {
  std::vector<studies::Diagram> out;
  for (std::size_t q = 0; q < data.quantities.size() && out.size() < most; ++q) {
    studies::Diagram d;
    d.title = data.quantities[q].name;
    d.x = "time of the scene";
    d.y = data.quantities[q].name + " [" + unit_of(data.quantities[q].kind) + "]";
    studies::Line measured{given, {}, {}};
    measured.dashed = true;
    d.lines.push_back(std::move(measured));
    for (const auto& [name, values] : answers) d.lines.push_back({name, {}, {}});
    for (std::size_t i = 0; i < data.values.size(); ++i) {
      if (data.values[i].quantity != q) continue;
      const auto add = [&](studies::Line& line, double y) {
        line.x.push_back(data.time[data.values[i].step]);
        line.y.push_back(y);
      };
      add(d.lines[0], data.values[i].value);
      for (std::size_t k = 0; k < answers.size(); ++k)
        add(d.lines[k + 1], (*answers[k].second)[static_cast<Eigen::Index>(i)]);
    }
    if (d.lines[0].x.size() > 1) out.push_back(std::move(d));
  }
  return out;
}

}  // namespace isochor::inverse
