// Runs that are killed and go on, disks that are full, pipes that are closed: as a shell sees them. What
// decides when a run is killed is how far it got, not the time it took.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "catch.h"
#include "support/shell.h"

using Json = nlohmann::json;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;
using files::slurp;

namespace {

std::size_t lines(const fs::path& path) {
  const std::string text = slurp(path);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// `code` of a signal: minus its number.
using test::Outcome;

class Desk : public test::Shell {
 public:
  Desk() : test::Shell("resume") {}

  using Before = void (*)();
  pid_t start(std::vector<std::string> arguments, Before before = nullptr) const {
    arguments.insert(arguments.begin(), ISOCHOR_BINARY);
    std::vector<char*> list;
    for (std::string& a : arguments) list.push_back(a.data());
    list.push_back(nullptr);
    const pid_t child = ::fork();
    if (child != 0) return child;
    if (::chdir(folder().c_str()) != 0) ::_exit(99);
    const int out = ::open("out.txt", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err = ::open("err.txt", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(out, 1);
    ::dup2(err, 2);
    if (before) before();
    ::execv(ISOCHOR_BINARY, list.data());
    ::_exit(98);
  }
  Outcome wait(pid_t child) const {
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), slurp(folder() / "out.txt"),
            slurp(folder() / "err.txt")};
  }
  Outcome run(const std::vector<std::string>& arguments, Before before = nullptr) const {
    return wait(start(arguments, before));
  }
  // Sends a signal as soon as the table of `out` has so many lines; a run that ends before is left to.
  Outcome stop(const std::vector<std::string>& arguments, const std::string& out, std::size_t rows,
               int signal) const {
    const pid_t child = start(arguments);
    for (;;) {
      siginfo_t info{};
      if (::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
          info.si_pid == child)
        break;
      if (lines(folder() / out / "steps.csv") >= rows) {
        ::kill(child, signal);
        break;
      }
      ::usleep(500);
    }
    return wait(child);
  }
};

// Two blocks that fall on a floor and on each other, with friction; a step of the second kind is cut in two.
const char* const kPile = R"({
  "bodies": [{"name": "low", "mesh": {"box": {"upper": [0.04, 0.02, 0.02], "divisions": [3, 2, 2]}},
              "materials": [{"young": 20000, "poisson": 0.5}]},
             {"name": "high", "mesh": {"box": {"lower": [0, 0, 0.0202], "upper": [0.04, 0.02, 0.04],
                                               "divisions": [2, 2, 2]}},
              "materials": [{"young": 20000, "poisson": 0.49}]}],
  "analysis": {"type": "dynamic", "scheme": "bdf2", "steps": 40, "duration": 0.12},
  "gravity": [0.5, 0, -9.81],
  "contacts": [{"name": "floor", "body": "low", "friction": 0.3,
                "obstacle": {"shape": "plane", "position": [0, 0, -0.0001]}}],
  "surface_contacts": [{"name": "touch", "body": "high", "against": "low", "friction": 0.2}],
  "probes": [{"name": "top", "body": "high", "point": [0.02, 0.01, 0.04]}],
  "metrics": [{"name": "fallen", "of": "top", "component": "z"}],
  "outputs": {"every": 3}
})";

const char* const kBlock = R"({
  "bodies": [{"name": "block", "mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1]}},
              "materials": [{"young": 1000, "poisson": 0.5}]}],
  "analysis": {"steps": 4},
  "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
  "tractions": [{"name": "pull", "surface": "x1", "traction": [100, 0, 0]}],
  "probes": [{"name": "tip", "point": [2, 0.5, 0.5]}]
})";

// The table without the column of wall time.
std::string table(const fs::path& folder) {
  std::stringstream in(slurp(folder / "steps.csv"));
  std::string text, line;
  std::size_t column = 0;
  while (std::getline(in, line)) {
    std::vector<std::string> cells;
    std::stringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (text.empty())
      column = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), "seconds") - cells.begin());
    REQUIRE(column < cells.size());
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(column));
    for (const std::string& cell : cells) text += cell + ",";
    text += "\n";
  }
  return text;
}

// Everything of a finished run but its times and its checkpoint.
void check_same(const fs::path& a, const fs::path& b) {
  CHECK(table(a) == table(b));
  Json one = Json::parse(slurp(a / "summary.json")), other = Json::parse(slurp(b / "summary.json"));
  for (Json* j : {&one, &other}) {
    j->erase("wall_s");
    j->erase("stage_s");
    j->erase("threads");
  }
  CHECK(one == other);
  std::vector<std::string> files[2];
  for (const auto& folder : {a, b}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) files[folder == b].push_back(fs::relative(entry.path(), folder).string());
    }
    std::sort(files[folder == b].begin(), files[folder == b].end());
  }
  CHECK(files[0] == files[1]);
  for (const std::string& file : files[0]) {
    if (!file.ends_with(".vtu") && !file.ends_with(".pvd")) continue;
    INFO(file);
    CHECK(slurp(a / file) == slurp(b / file));
  }
  // Pages differ in the digits of wall times alone.
  const auto frames = [](const fs::path& folder) {
    const std::string page = slurp(folder / "index.html");
    std::size_t count = 0;
    for (std::size_t at = page.find("\"time\""); at != std::string::npos; at = page.find("\"time\"", at + 1))
      ++count;
    return std::pair{count, page.size() / 64};
  };
  const auto first = frames(a), second = frames(b);
  CHECK(first.first == second.first);
  CHECK(std::max(first.second, second.second) - std::min(first.second, second.second) <= 1);
}

}  // namespace

TEST_CASE("a run that is killed again and again ends as one that never was") {
  Desk desk;
  desk.write("pile.json", kPile);
  REQUIRE(desk.run({"run", "pile.json", "--out", "whole", "--threads", "1"}).code == 0);
  const std::vector<std::string> resume = {"run",   "pile.json", "--out",
                                           "parts", "--resume",  "--threads",
                                           "2",     "--set",     "outputs.checkpoint_steps=4"};
  // Before and behind checkpoints, in good order and not, and twice at the same place.
  const std::pair<std::size_t, int> stops[] = {{1, SIGKILL},  {4, SIGKILL},  {7, SIGINT},   {7, SIGKILL},
                                               {13, SIGTERM}, {14, SIGKILL}, {22, SIGKILL}, {23, SIGKILL},
                                               {31, SIGINT},  {40, SIGKILL}};
  for (const auto& [rows, signal] : stops) {
    INFO(rows << " rows, signal " << signal);
    const Outcome o = desk.stop(resume, "parts", rows, signal);
    CHECK((o.code == 0 || o.code == -SIGKILL || o.code == 130));
    // What lies there is whole at any moment.
    const std::string rows_there = slurp(desk / "parts/steps.csv");
    CHECK((rows_there.empty() || rows_there.back() == '\n'));
  }
  // What a kill leaves in the middle of replacing a file goes; what is not ours stays.
  for (const char* left : {"summary.json", "checkpoint.state", "pile_low.pvd", "frames/pile_low_00003.vtu"})
    desk.write(std::string("parts/") + left + ".77-3.tmp", "{");
  desk.write("parts/notes.77-3.tmp", "mine");
  const Outcome last = desk.run(resume);
  INFO(last.err);
  CHECK(fs::remove(desk / "parts/notes.77-3.tmp"));
  REQUIRE(last.code == 0);
  check_same(desk / "whole", desk / "parts");
  // There is nothing left to do, and that is no error.
  const auto before = slurp(desk / "parts/summary.json");
  const Outcome again = desk.run(resume);
  CHECK(again.code == 0);
  CHECK_THAT(again.err, Contains("nothing to resume"));
  CHECK(slurp(desk / "parts/summary.json") == before);
}

TEST_CASE("a run that its budget stopped goes on, and a changed scene is refused with the reason") {
  Desk desk;
  desk.write("pile.json", kPile);
  const Outcome o = desk.stop({"run", "pile.json", "--out", "out", "--set", "outputs.checkpoint_steps=5"},
                              "out", 12, SIGINT);
  if (o.code == 0) return;  // it was faster
  REQUIRE(o.code == 130);
  struct Change {
    const char *set, *named;
  };
  for (const auto& [set, named] :
       {Change{"analysis.steps=41", "analysis.steps was 40 and is 41"},
        {"bodies.low.materials[0].young=20001", "bodies[0].materials[0].young was 20000 and is 20001"},
        {"gravity=[0,0,-9.81]", "gravity[0] was 0.5"},
        {"analysis.scheme=implicit_euler", "analysis.scheme was \"bdf2\" and is left out"},
        {"contacts.floor.friction=0.31", "contacts[0].friction"},
        {"outputs.every=4", "outputs.every"}}) {
    INFO(set);
    const std::string table_before = slurp(desk / "out/steps.csv");
    const Outcome refused = desk.run({"run", "pile.json", "--out", "out", "--resume", "--set", set});
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains("cannot be resumed") && Contains(named));
    CHECK(slurp(desk / "out/steps.csv") == table_before);
  }
  // A damaged checkpoint is told, and nothing is run.
  std::string bytes = slurp(desk / "out/checkpoint.state");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  fs::copy(desk / "out/checkpoint.state", desk / "kept");
  desk.write("out/checkpoint.state", bytes);
  const Outcome damaged = desk.run({"run", "pile.json", "--out", "out", "--resume"});
  CHECK(damaged.code == 2);
  CHECK_THAT(damaged.err,
             Contains("checkpoint.state") && Contains("damaged") && Contains("without --resume"));
  fs::rename(desk / "kept", desk / "out/checkpoint.state");
  CHECK(desk.run({"run", "pile.json", "--out", "out", "--resume"}).code == 0);
  // A run that begins anew leaves no checkpoint of another.
  CHECK(desk.run({"run", "pile.json", "--out", "out", "--set", "analysis.steps=1"}).code == 0);
  CHECK(lines(desk / "out/steps.csv") == 3);
}

TEST_CASE("without a checkpoint a run resumes at the beginning") {
  Desk desk;
  desk.write("block.json", kBlock);
  const Outcome o = desk.run({"run", "block.json", "--resume", "--out", "new"});
  CHECK(o.code == 0);
  CHECK_THAT(o.err, Contains("no checkpoint"));
  CHECK(lines(desk / "new/steps.csv") == 6);
  const Outcome none = desk.run({"run", "block.json", "--checkpoint", "-1"});
  CHECK(none.code == 2);
}

TEST_CASE("a step that leads nowhere adds no row") {
  Desk desk;
  desk.write("block.json", kBlock);
  const Outcome o = desk.run({"run", "block.json", "--out", "out", "--set", "analysis.max_iterations=1",
                              "--set", "tractions.pull.amount=100000"});
  REQUIRE(o.code == 3);
  std::stringstream in(slurp(desk / "out/steps.csv"));
  std::string line, before;
  while (std::getline(in, line)) {
    CHECK(line.substr(0, line.find(',', line.find(',') + 1)) !=
          before.substr(0, before.find(',', before.find(',') + 1)));
    before = line;
  }
}

TEST_CASE("what cannot be written has an exit code of its own") {
  Desk desk;
  desk.write("block.json", kBlock);
  // A file may have so many bytes and no more, as on a disk that is full.
  const Outcome full = desk.run({"run", "block.json", "--out", "full", "--set", "analysis.steps=40"}, [] {
    const rlimit limit{6000, 6000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::signal(SIGXFSZ, SIG_IGN);
  });
  CHECK(full.code == 5);
  CHECK_THAT(full.err, Contains("outputs cannot be written") && Contains("free space"));
  const Json j = Json::parse(slurp(desk / "full/summary.json"));
  CHECK(j["status"] == "not_written");
  CHECK_THAT(j["reason"].get<std::string>(), Contains("cannot be written"));
  for (const auto& arguments : {std::vector<std::string>{"list"},
                                {"version"},
                                {"show", "finger"},
                                {"list", "--json"},
                                {"run", "block.json", "--out", "piped"}}) {
    INFO(arguments[0]);
    const Outcome to_full = desk.run(arguments, [] { ::dup2(::open("/dev/full", O_WRONLY), 1); });
    CHECK(to_full.code == 5);
    CHECK_THAT(to_full.err, Contains("standard output"));
    const Outcome to_nobody = desk.run(arguments, [] {
      int ends[2];
      if (::pipe(ends) != 0) ::_exit(97);
      ::close(ends[0]);
      ::dup2(ends[1], 1);
    });
    CHECK(to_nobody.code == 5);
    CHECK_THAT(to_nobody.err, Contains("standard output"));
  }
  // The run itself is done.
  CHECK(Json::parse(slurp(desk / "piped/summary.json"))["status"] == "converged");
}
