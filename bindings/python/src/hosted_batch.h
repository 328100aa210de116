// Many worlds of one scene for Python: arrays whose first dimension is that of the worlds.
#pragma once

#include "hosted_world.h"
#include "isochor/batch.h"

namespace isochor::python {

class HostedBatch : public std::enable_shared_from_this<HostedBatch> {
 public:
  HostedBatch(WorldBatch batch, KeyMeaning meaning, LogLines log)
      : batch_(std::move(batch)), meaning_(std::move(meaning)) {
    common_.log = std::move(log);
    for (Index w = 0; w < batch_.size(); ++w)
      batch_[w].stop_when([stop = common_.interruption] { return stop->asked(); });
  }

  Index size() const { return batch_.size(); }
  int threads() const { return batch_.threads(); }

  template <class F>
  auto work(const char* call, const F& f) {
    const Turn turn(*common_.callers, call);
    const py::gil_scoped_release free;
    return f(batch_);
  }
  std::vector<StepReport> step(const char* call,
                               const std::function<std::vector<StepReport>(WorldBatch&)>& f) {
    std::vector<StepReport> reports;
    {
      const Turn turn(*common_.callers, call);
      common_.interruption->begin();
      const py::gil_scoped_release free;
      reports = f(batch_);
    }
    common_.interruption->end();
    return reports;
  }
  // One of the worlds, which keeps the batch alive.
  std::shared_ptr<HostedWorld> world(Index number) {
    return std::make_shared<HostedWorld>(batch_[number], meaning_, common_, shared_from_this());
  }

 private:
  WorldBatch batch_;
  KeyMeaning meaning_;
  Common common_;
};

}  // namespace isochor::python
