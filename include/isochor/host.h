// What a host may lend to a world: its threads, its log, and other processes.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "isochor/export.h"
#include "isochor/ranks.h"
#include "isochor/types.h"

namespace isochor {

class ISOCHOR_API ThreadPool {
 public:
  virtual ~ThreadPool() = default;
  // How many calls run at once at most, that of the caller included; at least 1, and always the same.
  virtual int threads() const = 0;
  // Calls body(0), ..., body(count - 1) in any order, on any threads, and returns when all have returned. A
  // body does not throw. It may call parallel_for() again.
  virtual void parallel_for(Index count, const std::function<void(Index)>& body) = 0;
};

struct Host {
  std::shared_ptr<ThreadPool> threads;          // empty: the engine's own, WorldOptions::threads of them
  std::function<void(const std::string&)> log;  // empty: WorldOptions::log
  std::shared_ptr<const Ranks> ranks;           // empty: this process alone
};

}  // namespace isochor
