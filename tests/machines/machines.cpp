// The tool under mpirun: one set of outputs, one voice, one end.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "catch.h"
#include "support/shell.h"

using Json = nlohmann::json;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;
using files::slurp;

namespace {

using test::Outcome;

class Shell : public test::Shell {
 public:
  Shell() : test::Shell("machines") {}
  // ranks 0: without mpirun.
  Outcome run(int ranks, const std::string& arguments) const {
    const std::string before =
        ranks > 0 ? "timeout 120 '" ISOCHOR_MPIRUN "' -n " + std::to_string(ranks) + " " : std::string();
    return sh(before + "'" ISOCHOR_BINARY "' run " + arguments);
  }
  void write(const std::string& name, const Json& scene) const { test::Shell::write(name, scene.dump()); }
};

Json block() {
  return Json::parse(R"({
    "bodies": [{"name": "block", "mesh": {"box": {"upper": [2, 1, 1], "divisions": [6, 3, 3]}},
                "materials": [{"young": 1000, "poisson": 0.5}]}],
    "analysis": {"steps": 2},
    "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
    "tractions": [{"name": "pull", "surface": "x1", "traction": [60, 0, 20]}],
    "probes": [{"name": "tip", "point": [2, 0.5, 0.5]}]
  })");
}

int count(const std::string& text, const std::string& word) {
  int found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// Displacement of the probe after the last step.
std::array<double, 3> tip(const fs::path& folder) {
  std::ifstream table(folder / "steps.csv");
  std::string header, line, last;
  std::getline(table, header);
  while (std::getline(table, line)) last = line;
  std::array<double, 3> at{};
  std::stringstream names(header), values(last);
  std::string name, value;
  while (std::getline(names, name, ',') && std::getline(values, value, ',')) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (name == std::string("tip.") + "xyz"[i] + "_m") at[i] = std::stod(value);
    }
  }
  return at;
}

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

constexpr double kLength = 2.449;  // of the block

}  // namespace

TEST_CASE("ranks write and print what one process does, once") {
  Shell shell;
  shell.write("block.json", block());
  const Outcome alone = shell.run(0, "block.json --out alone");
  REQUIRE(alone.code == 0);
  const Outcome shared = shell.run(3, "block.json --out shared");
  INFO(shared.err);
  REQUIRE(shared.code == 0);
  // Frames are in pieces, one a rank.
  std::vector<std::string> expected;
  for (const std::string& file : files_in(shell.folder() / "alone")) {
    if (!file.ends_with(".vtu")) {
      expected.push_back(file);
      continue;
    }
    const std::string stem = file.substr(0, file.size() - 4);
    expected.push_back(stem + ".pvtu");
    for (const char* piece : {"_0.vtu", "_1.vtu", "_2.vtu"}) expected.push_back(stem + piece);
  }
  std::sort(expected.begin(), expected.end());
  CHECK(files_in(shell.folder() / "shared") == expected);
  const std::string list = slurp(shell.folder() / "shared/frames/block_00002.pvtu");
  CHECK(count(list, "<Piece Source=\"block_00002_") == 3);
  CHECK(count(slurp(shell.folder() / "shared/block.pvd"), ".pvtu\"") == 3);
  // Pages are made again from pieces, too, where the build has pages.
  const Outcome page = shell.sh("'" ISOCHOR_BINARY "' view shared --remake --no-browser");
  CHECK((page.code == 0 || count(page.err, "has no results page") == 1));
  CHECK(count(shared.out, "outputs in shared/") == 1);
  CHECK(count(shared.out, "2/2") == 1);
  CHECK(shared.err.empty());
  CHECK(distance(tip(shell.folder() / "shared"), tip(shell.folder() / "alone")) < 1e-8 * kLength);
  CHECK(std::abs(tip(shell.folder() / "alone")[0]) > 0.01);
  const Json summary = Json::parse(slurp(shell.folder() / "shared" / "summary.json"));
  CHECK(summary["status"] == "converged");
}

TEST_CASE("more ranks than nodes to share, and ranks without a cell") {
  Shell shell;
  Json small = block();
  small["bodies"][0]["mesh"]["box"]["divisions"] = {1, 1, 1};
  shell.write("small.json", small);
  REQUIRE(shell.run(0, "small.json --out alone").code == 0);
  const Outcome shared = shell.run(4, "small.json --out shared");
  INFO(shared.err);
  REQUIRE(shared.code == 0);
  CHECK(distance(tip(shell.folder() / "shared"), tip(shell.folder() / "alone")) < 1e-8 * kLength);
}

TEST_CASE("the iterative solver across ranks comes to the same answer, and its options pass through") {
  Shell shell;
  Json scene = block();
  scene["analysis"]["solver"] = "iterative";
  shell.write("block.json", scene);
  REQUIRE(shell.run(0, "block.json --out alone").code == 0);
  for (const int ranks : {1, 2}) {
    const Outcome shared =
        shell.run(ranks, "block.json --out shared --petsc '-ksp_view -ksp_converged_reason'");
    INFO(shared.err);
    REQUIRE(shared.code == 0);
    CHECK_THAT(shared.out, Contains("type: fgmres"));
    CHECK_THAT(shared.out, Contains("type: gamg"));
    CHECK_THAT(shared.out, Contains("Linear solve converged"));
    CHECK(distance(tip(shell.folder() / "shared"), tip(shell.folder() / "alone")) < 1e-8 * kLength);
  }
}

TEST_CASE("what is not shared out over ranks is refused by name, once, on all of them") {
  Shell shell;
  const auto refused = [&](const Json& scene, const std::string& words) {
    shell.write("scene.json", scene);
    const Outcome o = shell.run(2, "scene.json");
    INFO(o.err);
    CHECK(o.code == 2);
    CHECK(count(o.err, words) == 1);
    CHECK(count(o.err, "run on one process") == 1);
    CHECK(shell.run(0, "scene.json").code == 0);
  };
  Json dual = block();
  dual["analysis"]["method"] = "augmented_gradients";
  refused(dual, "method augmented_gradients");
  Json factors = block();
  factors["analysis"]["solver"] = "multifrontal";
  refused(factors, "linear solver");
}

TEST_CASE("what one rank cannot read ends all of them, and says who") {
  Shell shell;
  shell.write("block.json", block());
  const std::string mpirun = "timeout 60 '" ISOCHOR_MPIRUN "' ", run = "'" ISOCHOR_BINARY "' run ";
  const Outcome o = shell.sh(mpirun + "-n 1 " + run + "block.json : -n 1 " + run + "missing.json");
  INFO(o.err);
  CHECK(o.code == 2);
  CHECK_THAT(o.err, Contains("rank 1: ") && Contains("missing.json"));
  const Outcome both = shell.run(2, "missing.json");
  CHECK(both.code == 2);
  CHECK(count(both.err, "missing.json") == 1);
}

TEST_CASE("outputs that cannot be written end all ranks") {
  Shell shell;
  shell.write("block.json", block());
  std::ofstream(shell.folder() / "file") << "in the way";
  const Outcome o = shell.run(2, "block.json --out file/out");
  INFO(o.err);
  CHECK(o.code == 2);
  CHECK_THAT(o.err, Contains("cannot be made"));
}

TEST_CASE("a run that its budget stopped goes on with another number of ranks") {
  Shell shell;
  Json scene = block();
  scene["analysis"]["steps"] = 12;
  scene["outputs"] = {{"checkpoint_steps", 1}};
  shell.write("block.json", scene);
  REQUIRE(shell.run(0, "block.json --out alone").code == 0);
  const Outcome stopped = shell.run(2, "block.json --out shared --budget 0.05");
  INFO(stopped.err);
  REQUIRE(stopped.code == 4);
  const Outcome resumed = shell.run(3, "block.json --out shared --resume");
  INFO(resumed.err);
  REQUIRE(resumed.code == 0);
  CHECK(distance(tip(shell.folder() / "shared"), tip(shell.folder() / "alone")) < 1e-8 * kLength);
}

namespace {

// Processes of the tool that `parent` has started, by what the system says of them.
std::vector<pid_t> children(pid_t parent) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream file(entry.path() / "stat");
    std::string pid, command, state;
    pid_t of = 0;
    if (file >> pid >> command >> state >> of && of == parent && command == "(isochor)")
      found.push_back(static_cast<pid_t>(std::stol(pid)));
  }
  return found;
}

}  // namespace

TEST_CASE("a rank that is killed ends all of them within ten seconds") {
  using Clock = std::chrono::steady_clock;
  Shell shell;
  Json scene = block();
  scene["analysis"]["steps"] = 100000;
  scene["outputs"] = {{"every", 0}};
  shell.write("long.json", scene);
  const pid_t mpirun = fork();
  REQUIRE(mpirun >= 0);
  if (mpirun == 0) {
    if (chdir(shell.folder().c_str()) != 0) _exit(99);
    const int sink = open("err.txt", O_WRONLY | O_CREAT, 0600);
    dup2(sink, 1);
    dup2(sink, 2);
    execl(ISOCHOR_MPIRUN, "mpirun", "-n", "2", ISOCHOR_BINARY, "run", "long.json",
          static_cast<char*>(nullptr));
    _exit(98);
  }
  std::vector<pid_t> ranks;
  const auto begin = Clock::now();
  // Long enough to be in the middle of steps.
  while (!fs::exists(shell.folder() / "out/long/steps.csv") &&
         Clock::now() - begin < std::chrono::seconds(60))
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  ranks = children(mpirun);
  REQUIRE(ranks.size() == 2);
  ::kill(ranks[1], SIGKILL);
  const auto killed = Clock::now();
  int status = 0;
  pid_t ended = 0;
  while (ended == 0 && Clock::now() - killed < std::chrono::seconds(10)) {
    ended = waitpid(mpirun, &status, WNOHANG);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  CHECK(ended == mpirun);
  CHECK(!(WIFEXITED(status) && WEXITSTATUS(status) == 0));
  CHECK(children(mpirun).empty());
  CHECK_THAT(slurp(shell.folder() / "err.txt"), Contains("signal 9"));
  // What was written is whole.
  CHECK(Json::accept(slurp(shell.folder() / "out/long/summary.json")));
  if (ended == 0) {
    ::kill(mpirun, SIGTERM);
    waitpid(mpirun, &status, 0);
  }
}
