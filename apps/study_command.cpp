// study: sweeps with their measurements.
#include <cstdio>

#include "apps/commands.h"
#include "apps/stop.h"
#include "apps/table.h"
#include "scenes/run/outputs.h"
#include "studies/check.h"
#include "studies/run_study.h"

namespace isochor::app {

namespace {

void print_cell(const studies::CellProgress& p) {
  const std::string place = std::to_string(p.done) + "/" + std::to_string(p.total);
  std::string what = p.cell.good() ? (p.kept ? "kept" : number(p.cell.seconds, 3) + " s") : p.cell.status;
  if (p.cell.error) what += ", error " + number(100 * *p.cell.error, 3) + " %";
  std::printf("%9s  %-52s %-28s ETA %s\n", place.c_str(), p.cell.id.c_str(), what.c_str(),
              duration(p.remaining).c_str());
  std::fflush(stdout);
}

int list_studies() {
  Table table({"study", "what it answers", "cells", "quick"});
  table.numbers_from(2, 3);
  for (const studies::Study& s : studies::studies()) {
    table.add({std::string(s.name), std::string(s.question), std::to_string(s.cells(false).size()),
               std::to_string(s.cells(true).size())});
  }
  table.add({"chaos", "Does any random scene end wrong and unsaid? (one process a seed: --seeds)", "", ""});
  std::printf("%s\nRun one with `isochor study NAME`.\n", table.text().c_str());
  return success;
}

Result<const studies::Study*> find(const std::string& name) {
  if (const studies::Study* study = studies::find_study(name)) return study;
  std::string known;
  for (const auto& s : studies::studies()) known += std::string(s.name) + ", ";
  known += "chaos";
  return Error{"there is no study named \"" + name + "\"; there are " + known};
}

int check_all(bool update, bool quiet) {
  const auto read = studies::read_expectations(studies::expectations_file());
  if (!read && !update) {
    std::fprintf(stderr, "isochor: %s\n", read.error().c_str());
    return bad_input;
  }
  studies::CheckOptions options;
  options.stop = stop_wanted;
  options.on_cell = [&](const std::string& id, const std::vector<std::string>& findings) {
    if (findings.empty() && quiet) return;
    std::printf("%-5s %s\n", findings.empty() ? "ok" : "WRONG", id.c_str());
    for (const auto& f : findings) std::printf("      %s\n", f.c_str());
    std::fflush(stdout);
  };
  const auto result = studies::check_studies(read ? read.value() : studies::Expectations{}, options);
  if (result.interrupted) return interrupted;
  std::printf("%zu cells, %zu not as expected\n", result.cells, result.wrong);
  if (!update) return result.wrong == 0 ? success : not_converged;
  const auto written = write_text(studies::expectations_file(), studies::expectations_json(result.found));
  if (!written) {
    std::fprintf(stderr, "isochor: %s\n", written.error().c_str());
    return bad_input;
  }
  std::printf("written to %s\n", studies::expectations_file().c_str());
  return success;
}

}  // namespace

int study(const StudyArguments& a) {
  if (a.list) return list_studies();
  stop_on_signals();
  if (a.check) return check_all(a.update, a.quiet);
  if (a.study == "chaos") return chaos(a, stop_wanted);
  if (a.study.empty()) {
    std::fprintf(stderr, "isochor: study: name one, or ask for --list\n");
    return bad_input;
  }
  const auto found = find(a.study);
  if (!found) {
    std::fprintf(stderr, "isochor: %s\n", found.error().c_str());
    return bad_input;
  }
  studies::StudyOptions options;
  options.folder = a.folder.empty() ? "out/study/" + a.study + (a.quick ? "_quick" : "") : a.folder;
  options.quick = a.quick;
  options.fresh = a.fresh;
  options.only = a.only;
  options.threads = a.threads;
  options.stop = stop_wanted;
  if (!a.quiet) options.on_cell = print_cell;
  const studies::StudyResult result = studies::run_study(*found.value(), options);
  if (result.status == studies::StudyStatus::failed) {
    std::fprintf(stderr, "isochor: %s\n", result.reason.c_str());
    return bad_input;
  }
  if (!a.quiet) {
    std::printf("\n%s: %zu of %zu cells, %zu kept from before, %zu without an answer, %s\n", a.study.c_str(),
                result.cells.size(), result.total, result.kept, result.not_good,
                duration(result.seconds).c_str());
    std::printf("outputs in %s/: index.html, results.csv, results.json, tables.md\n", options.folder.c_str());
  }
  return result.status == studies::StudyStatus::interrupted ? interrupted : success;
}

}  // namespace isochor::app
