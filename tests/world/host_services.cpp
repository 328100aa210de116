// Threads and a log that a host lends to a world.
#include <algorithm>
#include <atomic>
#include <thread>

#include "support/worlds.h"

using namespace test;
using isochor::World;

namespace {

// As simple as a pool can be: threads that take the next number until none is left. Begins with the last one,
// so that an order of the calls that mattered would be seen.
class PlainPool final : public isochor::ThreadPool {
 public:
  explicit PlainPool(int threads) : threads_(threads) {}
  int threads() const override { return threads_; }
  void parallel_for(Index count, const std::function<void(Index)>& body) override {
    ++calls;
    std::atomic<Index> next{count};
    const auto work = [&] {
      for (Index i = --next; i >= 0; i = --next) body(i);
    };
    std::vector<std::thread> others;
    for (int t = 1; t < threads_; ++t) others.emplace_back(work);
    work();
    for (std::thread& t : others) t.join();
  }
  std::atomic<int> calls{0};

 private:
  int threads_;
};

std::uint64_t hash_after_steps(World world) {
  const isochor::BodyId body =
      add_body(world, box({10, 10, 10}), isochor::Element::tet4_edge_smoothed, neo_hookean(1e5, 0.5));
  add_volume(world, body);
  hold(world, body, {"z0"});
  for (int k = 0; k < 2; ++k) {
    const isochor::StepReport report = world.advance(0.01);
    INFO(report.reason);
    REQUIRE(report.status == isochor::StepStatus::converged);
  }
  return world.state_hash();
}

isochor::WorldOptions falling() {
  isochor::WorldOptions options = dynamic_options();
  options.gravity = {0, 0, -9.8};
  return options;
}

}  // namespace

TEST_CASE("a world on the threads of its host has the same bits as on its own") {
  const std::uint64_t own = hash_after_steps(make_world(falling()));
  for (const int threads : {2, 3}) {
    INFO(threads << " threads");
    const auto pool = std::make_shared<PlainPool>(threads);
    isochor::Host host;
    host.threads = pool;
    CHECK(hash_after_steps(value(World::create(falling(), host))) == own);
    CHECK(pool->calls > 10);
  }
}

TEST_CASE("a pool without threads is refused") {
  isochor::Host host;
  host.threads = std::make_shared<PlainPool>(0);
  const auto world = World::create(static_options(), host);
  REQUIRE_FALSE(world.ok());
  CHECK_THAT(world.error(), ContainsSubstring("0 threads"));
}

TEST_CASE("the log of the host takes the place of that of the options") {
  std::vector<std::string> first, second;
  isochor::WorldOptions options = static_options();
  options.log = [&](const std::string& line) { first.push_back(line); };
  isochor::Host host;
  host.log = [&](const std::string& line) { second.push_back(line); };
  const World world = value(World::create(options, host));
  CHECK(world.body_name(isochor::BodyId{3}).empty());
  CHECK(first.empty());
  REQUIRE(second.size() == 1);
  CHECK_THAT(second.front(), ContainsSubstring("body number 3"));
}
