// Terms of a Prony series from relaxations: exact data give them back, with ramps and noise, and bad files
// are told.
#include "studies/fit/prony.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "catch.h"

using namespace isochor;
using namespace isochor::fit;

namespace {

// The law of the documentation, integrated here where the strain rises: the mean over what was strained when.
double law(double stays, const std::vector<PronyTerm>& terms, double instant, double ramp, double t) {
  const auto G = [&](double s) {
    double sum = stays;
    for (const PronyTerm& term : terms) sum += instant * term.ratio * std::exp(-s / term.time);
    return sum;
  };
  if (!(ramp > 0)) return G(t);
  constexpr int n = 4000;
  const double end = std::min(t, ramp);
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += G(t - end * (i + 0.5) / n) * end / n;
  return sum / ramp;
}

Relaxation made(const std::vector<PronyTerm>& terms, double instant, double ramp, double noise = 0,
                unsigned seed = 1) {
  Relaxation data;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  double stays = instant;
  for (const PronyTerm& term : terms) stays -= instant * term.ratio;
  for (int k = 0; k < 120; ++k) {
    data.time.push_back(0.01 * std::pow(1e4, k / 119.0));
    data.value.push_back(law(stays, terms, instant, ramp, data.time.back()) * (1 + noise * normal(random)));
  }
  return data;
}

std::string refusal(const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / "isochor_relaxation.csv";
  std::ofstream(path) << text;
  const auto read = read_relaxation(path.string(), {});
  std::filesystem::remove(path);
  REQUIRE(!read);
  return read.error();
}

}  // namespace

TEST_CASE("relaxations without noise give their terms back, at once strained or by a ramp") {
  const std::vector<std::vector<PronyTerm>> cases = {
      {{0.4, 2}}, {{0.25, 0.3}, {0.35, 12}}, {{0.2, 0.1}, {0.15, 2}, {0.3, 25}}};
  for (const auto& terms : cases) {
    for (const double ramp : {0.0, 0.5}) {
      PronyOptions options;
      options.terms = static_cast<int>(terms.size());
      options.ramp = ramp;
      const PronyFit fit = fit_prony(made(terms, 3e4, ramp), options);
      INFO(terms.size() << " terms, ramp " << ramp << ": " << fit.keys());
      REQUIRE(fit.converged);
      REQUIRE(fit.terms.size() == terms.size());
      // The ramp was integrated by middles here: 4000 of them.
      const double error = ramp > 0 ? 1e-3 : 1e-6;
      for (std::size_t i = 0; i < terms.size(); ++i) {
        CHECK(fit.terms[i].ratio == Approx(terms[i].ratio).epsilon(error));
        CHECK(fit.terms[i].time == Approx(terms[i].time).epsilon(error));
      }
      CHECK(fit.instant == Approx(3e4).epsilon(error));
      CHECK(fit.r2 > 1 - 1e-6);
    }
  }
}

TEST_CASE(
    "noise moves terms by little, more terms than there are do not hurt, and fewer are told by their error") {
  const std::vector<PronyTerm> terms{{0.25, 0.3}, {0.35, 12}};
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Relaxation data = made(terms, 100, 0, 0.005, seed);
    std::vector<PronyFit> fits;
    for (const int n : {1, 2, 3}) {
      PronyOptions options;
      options.terms = n;
      fits.push_back(fit_prony(data, options));
    }
    INFO("seed " << seed << ": " << fits[1].keys() << ", " << fits[2].keys());
    REQUIRE(fits[1].terms.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(fits[1].terms[i].ratio == Approx(terms[i].ratio).epsilon(0.05));
      CHECK(fits[1].terms[i].time == Approx(terms[i].time).epsilon(0.15));
    }
    CHECK(fits[0].rms > 3 * fits[1].rms);
    CHECK(fits[2].rms < 1.001 * fits[1].rms);
    double sum = 0;
    for (const PronyTerm& t : fits[2].terms) {
      CHECK(t.ratio > 0);
      sum += t.ratio;
    }
    CHECK(sum < 1);
  }
}

TEST_CASE("what the data do not reach is told") {
  Relaxation slow;
  for (int k = 0; k < 50; ++k) {
    slow.time.push_back(0.1 * (k + 1));
    slow.value.push_back(10 * (1 - 0.4 * (1 - std::exp(-slow.time.back() / 30))));
  }
  PronyOptions options;
  const PronyFit fit = fit_prony(slow, options);
  REQUIRE(fit.warnings.size() >= 1);
  CHECK(fit.warnings.front().find("is longer than the data") != std::string::npos);
}

TEST_CASE("data of any size and without any spread give numbers") {
  for (const double instant : {1e-300, 1.0, 1e308}) {
    CAPTURE(instant);
    for (const std::vector<PronyTerm>& terms : {std::vector<PronyTerm>{}, {{0.3, 2.0}}}) {
      for (const int most : {1, 2}) {
        CAPTURE(terms.size(), most);
        PronyOptions options;
        options.terms = most;
        const PronyFit fit = fit_prony(made(terms, instant, 0), options);
        CHECK(fit.r2 > 1 - 1e-9);
        CHECK(fit.rms <= 1e-6 * instant);
        CHECK(std::isfinite(fit.worst));
      }
    }
  }
}

TEST_CASE("files of relaxations are read, and bad ones told") {
  const auto path = std::filesystem::temp_directory_path() / "isochor_relaxation_good.csv";
  std::ofstream(path) << "sample 3\nTime (s);Force (N)\n0,5;2,0\n1;1,5\n2;1,25\n\n4;1,1\n8;1,05\n";
  const auto read = read_relaxation(path.string(), {});
  std::filesystem::remove(path);
  REQUIRE(read);
  CHECK(read.value().time == std::vector<double>{0.5, 1, 2, 4, 8});
  CHECK(read.value().value == std::vector<double>{2, 1.5, 1.25, 1.1, 1.05});
  const std::string head = "time,stress\n";
  CHECK(refusal("a,b\n1,2\n").find("no line names a column of time") != std::string::npos);
  CHECK(refusal(head + "0,1\n1,x\n").find("line 3: \"x\" is no finite number") != std::string::npos);
  CHECK(refusal(head + "0,1\n0,2\n").find("line 3: time 0 s; times ascend") != std::string::npos);
  CHECK(refusal(head + "0,1\n1,-2\n").find("line 3: value -2") != std::string::npos);
  CHECK(refusal(head + "0,1\n1\n").find("line 3: fewer columns") != std::string::npos);
  CHECK(refusal(head + "0,1\n1,1\n2,1\n3,1\n").find("4 points; a fit takes five") != std::string::npos);
  CHECK(read_relaxation("/no/such/file.csv", {}).error().find("cannot be read") != std::string::npos);
}
