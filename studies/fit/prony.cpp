// Outline of a fit:
//   1. unknowns: what stays and a share for each term, over the largest value, and logarithms of times
//   2. starts: times spread over the decades of the data, in several ways; shares alike
//   3. the best end: terms without a share are dropped, errors, warnings for times that the data do not reach
#include "studies/fit/prony.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/base/text.h"
#include "studies/ceres_words.h"
#include "studies/table_row.h"

namespace isochor::fit {

namespace {

using studies::cells_of;

// exp(-t/time) after a strain at once, its mean over the last `ramp` seconds after one that rose; while it
// rises the part of it that there is.
double decay(double t, double time, double ramp) {
  if (!(ramp > 0)) return std::exp(-t / time);
  if (t < ramp) return -time / ramp * std::expm1(-t / time);
  return time / ramp * std::exp(-t / time) * std::expm1(ramp / time);
}
double risen(double t, double ramp) {
  return ramp > 0 ? std::min(1.0, t / ramp) : 1.0;
}

// Of Ceres: x = (what stays, shares, logarithms of times).
struct Residuals {
  const Relaxation* data;
  double scale, ramp;
  std::size_t terms;
  bool operator()(double const* const* parameters, double* out) const {
    const double* x = parameters[0];
    for (std::size_t k = 0; k < data->time.size(); ++k) {
      const double t = data->time[k];
      double sum = x[0] * risen(t, ramp);
      for (std::size_t i = 0; i < terms; ++i) sum += x[1 + i] * decay(t, std::exp(x[1 + terms + i]), ramp);
      out[k] = sum - data->value[k] / scale;
      if (!std::isfinite(out[k])) return false;
    }
    return true;
  }
};

struct Search {
  std::vector<double> x;
  double cost = std::numeric_limits<double>::infinity();
  bool converged = false;
  std::string reason;
};

Search search(const Relaxation& data, const PronyOptions& options, double scale, std::vector<double> start,
              std::pair<double, double> log_times) {
  const auto terms = static_cast<std::size_t>(options.terms);
  Search out;
  out.x = std::move(start);
  using Cost = ceres::DynamicNumericDiffCostFunction<Residuals, ceres::CENTRAL>;
  auto* cost = new Cost(new Residuals{&data, scale, options.ramp, terms});
  cost->AddParameterBlock(static_cast<int>(out.x.size()));
  cost->SetNumResiduals(static_cast<int>(data.time.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, out.x.data());
  for (std::size_t i = 0; i < out.x.size(); ++i) {
    const bool time = i > terms;
    problem.SetParameterLowerBound(out.x.data(), static_cast<int>(i), time ? log_times.first : 0);
    if (time) problem.SetParameterUpperBound(out.x.data(), static_cast<int>(i), log_times.second);
  }
  studies::StopSearch stop(options.stop);
  ceres::Solver::Options how = studies::to_last_digits(500);
  how.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(how, &problem, &summary);
  out.converged = summary.termination_type == ceres::CONVERGENCE;
  out.reason = out.converged ? "" : summary.message;
  if (summary.IsSolutionUsable()) out.cost = summary.final_cost;
  return out;
}

void take(const Search& best, const Relaxation& data, const PronyOptions& options, double scale,
          PronyFit& fit) {
  const auto terms = static_cast<std::size_t>(options.terms);
  fit.converged = best.converged;
  fit.reason = best.reason;
  fit.stays = fit.instant = scale * best.x[0];
  for (std::size_t i = 0; i < terms; ++i) fit.instant += scale * best.x[1 + i];
  int dropped = 0;
  for (std::size_t i = 0; i < terms; ++i) {
    const double ratio = scale * best.x[1 + i] / fit.instant;
    if (ratio > 1e-6)
      fit.terms.push_back({ratio, std::exp(best.x[1 + terms + i])});
    else
      ++dropped;
  }
  std::sort(fit.terms.begin(), fit.terms.end(),
            [](const PronyTerm& a, const PronyTerm& b) { return a.time < b.time; });
  if (dropped > 0)
    fit.warnings.push_back(std::to_string(dropped) + " of " + std::to_string(terms) +
                           " terms carry nothing and are left out");
  for (const PronyTerm& term : fit.terms) {
    if (term.time > data.time.back())
      fit.warnings.push_back("time " + number(term.time) + " s is longer than the data, " +
                             number(data.time.back()) + " s: what stays in the end is not known from them");
  }
  if (fit.stays < 1e-3 * fit.instant) {
    fit.warnings.push_back(
        "nothing stays in the end; a solid that flows away takes a ratio sum below 1: give it "
        "one, or measure for longer");
  }
}

void judge(const Relaxation& data, const PronyOptions& options, PronyFit& fit) {
  // Over the largest value: squares of what is given may be no numbers.
  const double scale = *std::max_element(data.value.begin(), data.value.end());
  double mean = 0, squares = 0, about = 0;
  const auto n = static_cast<double>(data.value.size());
  for (const double v : data.value) mean += v / scale / n;
  for (std::size_t k = 0; k < data.value.size(); ++k) {
    const double value = data.value[k] / scale;
    const double error = relaxed(fit, options.ramp, data.time[k]) / scale - value;
    squares += error * error;
    about += (value - mean) * (value - mean);
    fit.worst = std::max(fit.worst, scale * std::abs(error));
  }
  fit.rms = scale * std::sqrt(squares / n);
  // Values that are alike but for rounding have no spread to explain.
  constexpr double rounding = 1e-28;
  fit.r2 = about > rounding * n ? 1 - squares / about : 1;
}

std::optional<double> number_in(std::string text, char separator) {
  if (separator == ';') std::replace(text.begin(), text.end(), ',', '.');  // decimal commas
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

struct Columns {
  std::size_t time = 0, value = 0;
  char separator = ',';
};

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::optional<Columns> header_in(const std::string& line, const RelaxationOptions& options) {
  for (const char separator : {';', '\t', ','}) {
    const std::vector<std::string> cells = cells_of(line, separator);
    constexpr auto none = std::string::npos;
    std::size_t time = none, value = none;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string name = lower(cells[i]);
      const auto has = [&](const char* part) { return name.find(part) != none; };
      const bool is_time =
          options.time_column.empty() ? has("time") || name == "t" : name == lower(options.time_column);
      const bool is_value = options.value_column.empty()
                                ? has("stress") || has("force") || has("load") || has("modulus")
                                : name == lower(options.value_column);
      if (is_time && time == none) time = i;
      if (is_value && !is_time && value == none) value = i;
    }
    if (time != none && value != none) return Columns{time, value, separator};
  }
  return std::nullopt;
}

}  // namespace

Result<Relaxation> read_relaxation(const std::string& path, const RelaxationOptions& options) {
  std::ifstream in(path);
  if (!in) return Error{path + ": cannot be read; give a CSV file with columns of time and stress"};
  std::optional<Columns> columns;
  std::size_t line_number = 0;
  std::string line;
  while (!columns && std::getline(in, line)) {
    ++line_number;
    columns = header_in(studies::without_mark(line), options);
  }
  if (!columns) {
    return Error{path +
                 ": no line names a column of time and one of stress (force, load, modulus); name them in a "
                 "header, or by --time and --value"};
  }
  Relaxation data;
  data.name = std::filesystem::path(path).stem().string();
  while (std::getline(in, line)) {
    ++line_number;
    if (line.find_first_not_of(";,\t \r") == std::string::npos) continue;
    const std::vector<std::string> cells = cells_of(line, columns->separator);
    const std::string where = path + ", line " + std::to_string(line_number) + ": ";
    if (cells.size() <= std::max(columns->time, columns->value))
      return Error{where + "fewer columns than the header has; complete or remove it"};
    const auto t = number_in(cells[columns->time], columns->separator),
               v = number_in(cells[columns->value], columns->separator);
    if (!t || !v) {
      return Error{where + "\"" + cells[t ? columns->value : columns->time] +
                   "\" is no finite number; correct or remove the line"};
    }
    if (*t < 0 || (!data.time.empty() && !(*t > data.time.back()))) {
      return Error{where + "time " + number(*t) + " s; times ascend from when the strain began, at 0"};
    }
    if (!(*v > 0)) {
      return Error{where + "value " + number(*v) +
                   "; what is left of a stress is positive: cut off what comes before and after the hold, "
                   "and turn the "
                   "sign of compression"};
    }
    data.time.push_back(*t);
    data.value.push_back(*v);
  }
  if (data.time.size() >= 5) return data;
  return Error{path + ": " + std::to_string(data.time.size()) + " points; a fit takes five at least"};
}

PronyFit fit_prony(const Relaxation& data, const PronyOptions& options) {
  PronyFit fit;
  const auto terms = static_cast<std::size_t>(options.terms);
  const double scale = *std::max_element(data.value.begin(), data.value.end());
  // From the first time after the strain to ten times the last.
  double first = data.time.back();
  for (const double t : data.time) {
    if (t > options.ramp) first = std::min(first, t);
  }
  const double low = std::log(first), high = std::log(data.time.back());
  const std::pair<double, double> bounds{low - std::log(20.0), high + std::log(10.0)};
  Search best;
  // Spread over all of the data, over their later and over their earlier half.
  for (const auto& [from, to] : {std::pair(0.0, 1.0), {0.3, 1.0}, {0.0, 0.6}, {0.15, 0.85}}) {
    std::vector<double> x(1 + 2 * terms, 0.5 / static_cast<double>(terms));
    x[0] = std::max(1e-3, *std::min_element(data.value.begin(), data.value.end()) / scale);
    for (std::size_t i = 0; i < terms; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(terms);
      x[1 + terms + i] = low + (from + (to - from) * share) * (high - low);
    }
    Search one = search(data, options, scale, std::move(x), bounds);
    if (one.cost < best.cost || best.x.empty()) best = std::move(one);
    if (options.stop && options.stop()) break;
  }
  take(best, data, options, scale, fit);
  judge(data, options, fit);
  return fit;
}

double relaxed(const PronyFit& fit, double ramp, double time) {
  double sum = fit.stays * risen(time, ramp);
  for (const PronyTerm& term : fit.terms) sum += fit.instant * term.ratio * decay(time, term.time, ramp);
  return sum;
}

namespace {

nlohmann::ordered_json terms_json(const PronyFit& fit) {
  auto list = nlohmann::ordered_json::array();
  for (const PronyTerm& term : fit.terms) list.push_back({{"ratio", term.ratio}, {"time", term.time}});
  return list;
}

}  // namespace

std::string PronyFit::keys() const {
  return terms_json(*this).dump();
}

std::string prony_json(const Relaxation& data, const std::vector<PronyFit>& fits) {
  nlohmann::ordered_json out{{"data", data.name}, {"points", data.time.size()}};
  auto list = nlohmann::ordered_json::array();
  for (const PronyFit& fit : fits) {
    list.push_back({{"status", fit.converged ? "converged" : "not_converged"},
                    {"reason", fit.reason},
                    {"prony", terms_json(fit)},
                    {"instant", fit.instant},
                    {"stays", fit.stays},
                    {"r2", fit.r2},
                    {"rms", fit.rms},
                    {"worst", fit.worst},
                    {"warnings", fit.warnings}});
  }
  out["fits"] = list;
  return out.dump(2) + "\n";
}

}  // namespace isochor::fit
