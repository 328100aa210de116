// Measures the cells of a study and keeps what they gave.
//
// Folder of a study: results.json (everything, and what a later run takes up), results.csv (a row a cell),
// tables.md, index.html. Each file is whole at any moment; results.json and results.csv are renewed after
// every cell.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "studies/study.h"

namespace isochor::studies {

struct CellProgress {
  std::size_t done = 0, total = 0;  // cells, with this one
  const Measured& cell;
  bool kept = false;     // measured by an earlier run of the same build
  double elapsed = 0;    // [s]
  double remaining = 0;  // [s], estimated from the cells measured so far
};

struct StudyOptions {
  std::string folder;  // required
  bool quick = false;
  bool fresh = false;  // forget what an earlier run measured
  std::string only;    // measure the cells with this text in their ids; empty: all
  int threads = 0;     // 0: all the machine has
  std::function<bool()> stop;
  std::function<void(const CellProgress&)> on_cell;
};

enum class StudyStatus : std::uint8_t { complete, interrupted, failed };

struct StudyResult {
  StudyStatus status = StudyStatus::failed;
  std::string reason;           // of a failure: outputs that cannot be written
  std::vector<Measured> cells;  // those of this run, then what earlier ones left
  std::size_t total = 0;        // cells of the study
  std::size_t kept = 0, not_good = 0;
  double seconds = 0;
};

StudyResult run_study(const Study& study, const StudyOptions& options);

// One cell, measured `repeats` times after a first run that is not counted. With repeats = 0 the first run is
// the one that counts. A stop leaves the status "interrupted".
Measured measure(const Cell& cell, int threads, int repeats, double budget,
                 const std::function<bool()>& stop);

// Of all that decides the numbers of a cell: the program, the scene with its mesh, threads and repeats.
std::string fingerprint(const Cell& cell, int threads, int repeats);

}  // namespace isochor::studies
