#include "studies/run_study.h"

#include <chrono>
#include <filesystem>
#include <map>
#include <thread>

#include "scenes/run/outputs.h"
#include "studies/store.h"

namespace isochor::studies {

namespace {

// Repeats stop once a cell has taken so long [s].
constexpr double kQuickBudget = 1.5, kBudget = 4;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string part_of(std::size_t part, std::size_t whole) {
  return std::to_string(part) + " of " + std::to_string(whole);
}

class Runner {
 public:
  Runner(const Study& study, const StudyOptions& options)
      : study_(study), options_(options), cells_(study.cells(options.quick)) {
    threads_ = options.threads > 0 ? options.threads
                                   : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    repeats_ = options.quick ? 1 : study.repeats;
    for (const Cell& cell : cells_) {
      if (chosen(cell)) chosen_.push_back(&cell);
    }
  }

  StudyResult run();

 private:
  bool chosen(const Cell& cell) const { return cell.id.find(options_.only) != std::string::npos; }
  bool stopped() const { return options_.stop && options_.stop(); }
  Result<void> open();
  Result<void> keep_results(bool complete) const;
  Result<void> write_page() const;
  void take(Measured m, bool kept);
  std::string file(const char* name) const {
    return (std::filesystem::path(options_.folder) / name).string();
  }

  const Study& study_;
  const StudyOptions& options_;
  std::vector<Cell> cells_;
  std::vector<const Cell*> chosen_;  // those to measure now
  int threads_ = 1, repeats_ = 1;
  std::map<std::string, Measured> earlier_;  // by id: of this build, not yet taken
  StudyResult result_;
  double start_ = now(), measuring_ = 0;
  std::size_t measured_ = 0;
};

Result<void> Runner::open() {
  if (chosen_.empty()) {
    return Error{"no cell of the study " + std::string(study_.name) + (options_.quick ? " --quick" : "") +
                 " has \"" + options_.only + "\" in its name" +
                 (cells_.empty() ? "" : "; the first is \"" + cells_.front().id + "\"")};
  }
  std::error_code code;
  std::filesystem::create_directories(options_.folder, code);
  if (code)
    return Error{"output folder " + options_.folder + " cannot be made: " + code.message() +
                 "; name another with --out"};
  std::map<std::string, std::string> wanted;
  for (const Cell& cell : cells_) {
    if (!options_.fresh || !chosen(cell)) wanted[cell.id] = fingerprint(cell, threads_, repeats_);
  }
  for (Measured& m : read_results(file("results.json"))) {
    const auto it = wanted.find(m.id);
    if (it != wanted.end() && it->second == m.fingerprint) earlier_[m.id] = std::move(m);
  }
  return {};
}

Result<void> Runner::keep_results(bool complete) const {
  const StoreHead head{std::string(study_.name), std::string(study_.title), options_.quick, complete,
                       threads_};
  // What an earlier run measured further down the list stays until its turn comes.
  std::vector<Measured> cells = result_.cells;
  for (const auto& [id, cell] : earlier_) cells.push_back(cell);
  if (auto r = write_text(file("results.json"), results_json(head, cells)); !r) return r;
  return write_text(file("results.csv"), results_csv(cells));
}

Result<void> Runner::write_page() const {
  Page page;
  page.title = std::string(study_.title);
  page.subtitle = std::string(study_.question);
  page.footer = "isochor " + version() + " · study " + std::string(study_.name);
  if (result_.cells.size() < cells_.size())
    page.notes.push_back("Not complete: " + part_of(result_.cells.size(), cells_.size()) +
                         " cells were measured. The same command goes on from here.");
  if (result_.not_good > 0)
    page.notes.push_back(std::to_string(result_.not_good) +
                         " cells gave no answer; they are in red in the last table, with the reason.");
  page.run = {{"Command", "isochor study " + std::string(study_.name) + (options_.quick ? " --quick" : "")},
              {"Machine", machine_description()},
              {"Build", build_description()},
              {"Version", version()},
              {"Threads", std::to_string(threads_)},
              {"Repeats", "up to " + std::to_string(repeats_) + " after a first run that is not counted"},
              {"Cells", part_of(result_.cells.size(), cells_.size())}};
  page.sections = study_.present(result_.cells);
  if (auto r = write_text(file("tables.md"), tables_markdown(page.sections)); !r) return r;
  auto html = page_html(page);
  // Without the page the numbers still stand.
  if (!html) return {};
  return write_text(file("index.html"), html.value());
}

void Runner::take(Measured m, bool kept) {
  if (!m.good()) ++result_.not_good;
  if (kept) ++result_.kept;
  result_.cells.push_back(std::move(m));
  if (!options_.on_cell) return;
  const std::size_t left = chosen_.size() - result_.cells.size();
  const double each = measured_ > 0 ? measuring_ / static_cast<double>(measured_) : 0;
  options_.on_cell({result_.cells.size(), chosen_.size(), result_.cells.back(), kept, now() - start_,
                    each * static_cast<double>(left)});
}

StudyResult Runner::run() {
  result_.total = cells_.size();
  if (auto r = open(); !r) {
    result_.reason = r.error();
    return result_;
  }
  for (const Cell* each : chosen_) {
    const Cell& cell = *each;
    if (stopped()) break;
    const auto found = earlier_.find(cell.id);
    if (found != earlier_.end()) {
      take(std::move(found->second), true);
      earlier_.erase(found);
      continue;
    }
    const double before = now();
    Measured m = measure(cell, threads_, repeats_, options_.quick ? kQuickBudget : kBudget, options_.stop);
    if (m.status == "interrupted") break;
    measuring_ += now() - before;
    ++measured_;
    take(std::move(m), false);
    if (auto r = keep_results(result_.cells.size() == cells_.size()); !r) {
      result_.reason = r.error();
      return result_;
    }
  }
  result_.status = result_.cells.size() == chosen_.size() ? StudyStatus::complete : StudyStatus::interrupted;
  result_.seconds = now() - start_;
  for (auto& [id, cell] : earlier_) {
    if (!cell.good()) ++result_.not_good;
    result_.cells.push_back(cell);
  }
  earlier_.clear();
  for (auto& written : {keep_results(result_.cells.size() == cells_.size()), write_page()}) {
    if (written) continue;
    result_.status = StudyStatus::failed;
    result_.reason = written.error();
  }
  return result_;
}

}  // namespace

StudyResult run_study(const Study& study, const StudyOptions& options) {
  return Runner(study, options).run();
}

}  // namespace isochor::studies
