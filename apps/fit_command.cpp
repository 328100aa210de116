// fit: constants of material laws from measured curves.
#include <cstdio>
#include <filesystem>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "scenes/run/outputs.h"
#include "studies/fit/report.h"

namespace isochor::app {

namespace {

Result<std::vector<const fit::Law*>> laws_of(const FitArguments& a) {
  std::vector<const fit::Law*> out;
  for (const std::string& name : a.laws) {
    auto law = fit::find_law(name);
    if (!law) return law.failure();
    out.push_back(law.value());
  }
  for (const fit::Law& law : fit::laws()) {
    if (a.laws.empty()) out.push_back(&law);
  }
  return out;
}

void print(const std::vector<fit::Curve>& curves, const std::vector<fit::Fit>& fits) {
  for (const fit::Curve& c : curves) {
    std::printf("%s, %s: %zu points%s%s\n", c.name.c_str(), fit::word(c.mode), c.stretch.size(),
                c.note.empty() ? "" : "; ", c.note.c_str());
  }
  Table table(fit::table_head());
  table.numbers_from(1, 3);
  for (const fit::Fit* f : fit::by_error(fits)) table.add(fit::table_row(*f));
  std::printf("\n%s", table.text().c_str());
  for (const fit::Fit* f : fit::by_error(fits))
    for (const std::string& w : f->warnings) std::printf("%s: %s\n", f->law.c_str(), w.c_str());
}

Result<void> write(const std::string& folder, const std::vector<fit::Curve>& curves,
                   const std::vector<fit::Fit>& fits) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{folder + ": cannot be made: " + error.message() + "; choose another --out"};
  if (auto r = write_text(folder + "/fit.json", fit::fits_json(curves, fits)); !r) return r;
  if (auto r = write_text(folder + "/fit.csv", fit::fits_csv(curves, fits)); !r) return r;
  const auto page = studies::page_html(fit::fits_page(curves, fits));
  if (!page) {
    std::fprintf(stderr, "isochor: no page: %s\n", page.error().c_str());
    return {};
  }
  return write_text(folder + "/index.html", page.value());
}

}  // namespace

int fit_laws(const FitArguments& a) {
  if (a.curves.empty()) return refuse("fit: nothing was measured; give curves, or --scene SCENE:DATA");
  fit::CurveOptions how;
  how.strain_column = a.strain;
  how.stress_column = a.stress;
  how.stress_unit = a.stress_unit;
  how.lowest = a.lowest;
  how.highest = a.highest;
  std::vector<fit::Curve> curves;
  for (const std::string& path : a.curves) {
    auto curve = fit::read_curve(path, how);
    if (!curve) return refuse(curve.error());
    curves.push_back(std::move(curve).value());
  }
  const auto laws = laws_of(a);
  if (!laws) return refuse(laws.error());

  stop_on_signals();
  fit::FitOptions options;
  options.weights = a.relative ? fit::Weights::relative : fit::Weights::absolute;
  options.stop = stop_wanted;
  std::vector<fit::Fit> fits;
  for (const fit::Law* law : laws.value()) {
    if (stop_wanted()) break;
    if (!a.quiet && !a.json) std::fprintf(stderr, "\r%-32s", law->name.c_str());
    fits.push_back(fit::fit(*law, curves, options));
  }
  if (!a.quiet && !a.json) std::fprintf(stderr, "\r%-32s\r", "");
  const std::string folder = a.folder.empty() ? "out/fit/" + curves.front().name : a.folder;
  if (auto r = write(folder, curves, fits); !r) {
    std::fprintf(stderr, "isochor: %s\n", r.error().c_str());
    return not_written;
  }
  if (a.json) {
    std::printf("%s", fit::fits_json(curves, fits).c_str());
  } else if (!a.quiet) {
    print(curves, fits);
    std::printf("%s/index.html\n", folder.c_str());
  }
  if (stop_wanted()) return interrupted;
  for (const fit::Fit& f : fits) {
    if (f.converged) return success;
  }
  return not_converged;
}

}  // namespace isochor::app
