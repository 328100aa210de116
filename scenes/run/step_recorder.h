// What a step of a scene leaves behind: the record that tables, pages and metrics are made of.
#pragma once

#include <string>
#include <vector>

#include "scenes/probes.h"
#include "scenes/run/contact_watch.h"
#include "scenes/run/run.h"

namespace isochor {

// The names of probes, cavities and supports, in the order of the records' lists.
void name_records(const SceneDef& scene, RunResult& result);

// Reads a built scene between steps. Scene and world outlive it; the world may be assigned anew.
class StepRecorder {
 public:
  StepRecorder(const SceneDef& scene, const BuiltScene& built);

  // How the step went, probes, chambers, reactions and gauges: what costs next to nothing.
  StepRecord look(int step, const StepReport& report);
  // Volumes, energies, momentum and orientations on top.
  void measure(StepRecord& record) const;

  const std::vector<std::string>& warnings() const { return warnings_; }  // of probes outside of bodies
  std::vector<std::string> contact_findings() const { return contacts_.findings(); }

 private:
  std::vector<Gauge> in_columns(std::vector<Gauge> gauges) const;

  const SceneDef& scene_;
  const BuiltScene& built_;
  std::vector<MaterialPoint> probes_;
  std::vector<std::string> warnings_;
  ContactWatch contacts_;
};

}  // namespace isochor
