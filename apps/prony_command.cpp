// fit-prony: terms of a Prony series from a measured relaxation.
#include <cstdio>
#include <filesystem>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "scenes/run/outputs.h"
#include "studies/fit/prony.h"

namespace isochor::app {

namespace {

void print(const fit::Relaxation& data, const std::vector<fit::PronyFit>& fits) {
  std::printf("%s: %zu points up to %s s\n", data.name.c_str(), data.time.size(),
              number(data.time.back()).c_str());
  Table table({"terms", "R2", "rms", "at once", "stays", "prony"});
  for (const fit::PronyFit& f : fits) {
    table.add({std::to_string(f.terms.size()), number(f.r2, 6), number(f.rms, 3), number(f.instant, 4),
               number(f.stays, 4), f.converged ? f.keys() : f.reason});
  }
  std::printf("\n%s", table.text().c_str());
  for (const fit::PronyFit& f : fits) {
    for (const std::string& w : f.warnings) std::printf("%zu terms: %s\n", f.terms.size(), w.c_str());
  }
}

Result<void> write(const std::string& folder, const std::string& text) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{folder + ": cannot be made: " + error.message() + "; choose another --out"};
  return write_text(folder + "/prony.json", text);
}

}  // namespace

int fit_prony(const PronyArguments& a) {
  const auto data = fit::read_relaxation(a.file, {a.time, a.value});
  if (!data) return refuse(data.error());
  if (!(a.ramp < data.value().time.back())) {
    return refuse("--ramp " + number(a.ramp) + " s is longer than the data, which end at " +
                  number(data.value().time.back()) + " s");
  }
  stop_on_signals();
  std::vector<fit::PronyFit> fits;
  for (int terms = 1; terms <= a.terms && !stop_wanted(); ++terms) {
    fit::PronyOptions options;
    options.terms = terms;
    options.ramp = a.ramp;
    options.stop = stop_wanted;
    fits.push_back(fit::fit_prony(data.value(), options));
  }
  const std::string text = fit::prony_json(data.value(), fits);
  if (auto r = write(a.folder.empty() ? "out/fit/" + data.value().name : a.folder, text); !r) {
    std::fprintf(stderr, "isochor: %s\n", r.error().c_str());
    return not_written;
  }
  if (a.json)
    std::printf("%s", text.c_str());
  else if (!a.quiet)
    print(data.value(), fits);
  if (stop_wanted()) return interrupted;
  for (const fit::PronyFit& f : fits) {
    if (f.converged) return success;
  }
  return not_converged;
}

}  // namespace isochor::app
