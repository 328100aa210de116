// The tool as a shell sees it: exit codes, outputs, signals.
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
  Shell() : test::Shell("cli") {}
  // Runs in the shell's own folder; `before`: what the shell is told before that.
  Outcome run(const std::string& arguments, const std::string& before = "") const {
    return sh(before + "'" ISOCHOR_BINARY "' " + arguments);
  }
};

const char* const kBlock = R"({
  "bodies": [{"name": "block", "mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1]}},
              "materials": [{"young": 1000, "poisson": 0.5}]}],
  "analysis": {"steps": 2},
  "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
  "tractions": [{"name": "pull", "surface": "x1", "traction": [100, 0, 0]}],
  "probes": [{"name": "tip", "point": [2, 0.5, 0.5]}]
})";

}  // namespace

TEST_CASE("a step that another method solved says so") {
  Shell shell;
  shell.write("press.json", R"({
    "bodies": [{"name": "block", "element": "tet4",
                "mesh": {"box": {"upper": [0.1, 0.1, 0.1], "divisions": [4, 4, 4]}},
                "materials": [{"young": 66000, "poisson": 0.5}]}],
    "analysis": {"steps": 1, "method": "dual_gradients"},
    "dirichlet": [{"name": "held", "where": {"surfaces": "x0"}},
                  {"name": "press", "where": {"surfaces": "x1"}, "displacement": [-0.08, 0, 0]}]
  })");
  const Outcome pressed = shell.run("run press.json --out pressed");
  INFO(pressed.err);
  CHECK(pressed.code == 0);
  CHECK_THAT(pressed.out, Contains("1 left to another method"));
  CHECK_THAT(slurp(shell.folder() / "pressed/steps.csv"), Contains(",stand_ins,"));
  shell.write("block.json", kBlock);
  CHECK_THAT(shell.run("run block.json --out plain").out, !Contains("another method"));
}

TEST_CASE("help, list and version") {
  Shell shell;
  for (const char* command :
       {"--help", "run --help", "list --help", "check --help", "version --help", "study --help",
        "study --list", "list", "list --json", "version", "version --json", "show finger"}) {
    INFO(command);
    const Outcome o = shell.run(command);
    CHECK(o.code == 0);
    CHECK(o.out.size() > 40);
  }
  CHECK_THAT(shell.run("list").out, Contains("finger") && Contains("cantilever"));
  CHECK(Json::parse(shell.run("list --json").out).size() >= 12);
  CHECK(Json::parse(shell.run("version --json").out).contains("version"));
}

TEST_CASE("wrong arguments are bad input") {
  Shell shell;
  for (const char* command :
       {"", "fly", "run --threads many", "run --threads -1", "run --budget 0", "run nosuchscene",
        "run no/such/file.json", "run finger --set", "run finger --set x", "check", "check no.msh",
        "run finger --bogus", "study", "study nosuchstudy", "study accuracy --threads -1", "study --update",
        "run finger --set cavities[0].presure=1"}) {
    INFO(command);
    const Outcome o = shell.run(command);
    CHECK(o.code == 2);
    CHECK(!(o.err + o.out).empty());
  }
  CHECK_THAT(shell.run("run finger --set cavities[0].presure=1").err, Contains("cavities[0].presure"));
  CHECK_FALSE(fs::exists(shell.folder() / "out"));
}

TEST_CASE("numbers of options that have no meaning are refused in a line") {
  Shell shell;
  for (const char* option : {"run finger --budget", "run finger --checkpoint", "study chaos --limit",
                             "drive x.json --tolerance", "live finger --step-limit", "check x.msh --scale"}) {
    const std::string name = std::string(option).substr(std::string(option).find("--"));
    for (const char* value : {"-1", "nan", "inf", "1e999", "much"}) {
      const Outcome o = shell.run(std::string(option) + " " + value);
      INFO(option << " " << value << ": " << o.err << o.out);
      CHECK(o.code == 2);
      CHECK_THAT(o.err + o.out, Contains(name) && Contains(value));
      CHECK((o.err + o.out).size() < 200);
    }
  }
}

TEST_CASE("a run explains what it was made of") {
  Shell shell;
  shell.write("block.json", kBlock);
  const Outcome o = shell.run("run block.json --out here --explain");
  CHECK(o.code == 0);
  CHECK_THAT(o.out, Contains("by default: the scene names none") && Contains("factorization") &&
                        Contains("traction \"pull\""));
}

TEST_CASE("a run says what its answers are worth") {
  Shell shell;
  shell.write("block.json", kBlock);
  const Outcome o = shell.run("run block.json --out here --accuracy");
  CHECK(o.code == 0);
  CHECK_THAT(o.out, Contains("error about") && Contains("compared with the same mesh"));
  const Json j = Json::parse(slurp(shell.folder() / "here/summary.json"));
  CHECK_FALSE(j["accuracy"]["indicators"].empty());
  CHECK(Json::parse(shell.run("run block.json --accuracy --json").out)["accuracy"]["reason"] == "");
}

TEST_CASE("a run finds what an error takes, and its end is in its code") {
  Shell shell;
  shell.write("block.json", kBlock);
  const Outcome o = shell.run("run block.json --out here --error 5%");
  INFO(o.out << o.err);
  CHECK(o.code == 0);
  CHECK_THAT(o.out, Contains("nothing to compare with yet") && Contains("held by \"probe tip\"") &&
                        Contains("the same alone: isochor run block.json"));
  const Json j = Json::parse(slurp(shell.folder() / "here/summary.json"));
  CHECK(j["accuracy"]["error_asked"] == 0.05);
  CHECK(fs::exists(shell.folder() / "here/block.pvd"));
  CHECK(Json::parse(shell.run("run block.json --error 0.05 --json").out)["state_hash"] == j["state_hash"]);
  CHECK(shell.run("run block.json --error 5% --quiet").out.empty());
  const Outcome late = shell.run("run block.json --out late --error 0.1% --budget 0.3");
  INFO(late.out << late.err);
  CHECK((late.code == 4 || late.code == 0));  // a fast machine gets there
  CHECK((late.code == 0 || late.err.find("not reached") != std::string::npos ||
         late.err.find("no run converged") != std::string::npos));
  for (const char* wrong : {"0%", "-1%", "nan", "1", "x"}) {
    INFO(wrong);
    const Outcome refused = shell.run(std::string("run block.json --error=") + wrong);
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains("--error = ") && Contains("above 0 %"));
  }
  CHECK(shell.run("run block.json --error ''").code == 2);
  CHECK(shell.run("run block.json --error 1% --resume").code == 2);
  const Outcome nothing = shell.run("run block.json --error 1% --set probes=[]");
  CHECK(nothing.code == 2);
  CHECK_THAT(nothing.err, Contains("no probe and no metric"));
}

TEST_CASE("a price comes from the machine's cost model, which is kept and remade where it is damaged") {
  Shell shell;
  shell.write("block.json", kBlock);
  const fs::path cache = shell.folder() / "cache/isochor/cost_model.json";
  const std::string with = "XDG_CACHE_HOME=" + (shell.folder() / "cache").string() + " ";
  fs::create_directories(cache.parent_path());
  std::ofstream(cache) << "{\"format\": 1, \"elem";
  const Outcome first = shell.run("run block.json --price", with);
  INFO(first.out << first.err);
  CHECK(first.code == 0);
  CHECK_THAT(first.err, Contains("measuring"));
  CHECK_THAT(first.out, Contains("0.3 %") && Contains("memory"));
  const std::string kept = slurp(cache);
  CHECK(Json::parse(kept)["elements"].size() == 4);
  const Outcome second = shell.run("run block.json --price --json", with);
  CHECK_THAT(second.err, !Contains("measuring"));
  CHECK(Json::parse(second.out).size() == 4);
  CHECK(slurp(cache) == kept);
}

TEST_CASE("a scene file runs and writes where it is told") {
  Shell shell;
  shell.write("block.json", kBlock);
  const Outcome o = shell.run("run block.json --out here --threads 1");
  INFO(o.err);
  CHECK(o.code == 0);
  CHECK_THAT(o.out, Contains("2/2") && Contains("converged"));
  const Json j = Json::parse(slurp(shell.folder() / "here/summary.json"));
  CHECK(j["status"] == "converged");
  CHECK(j["threads"] == 1);
  CHECK(fs::exists(shell.folder() / "here/block.pvd"));
  CHECK(Json::parse(shell.run("run block.json --json").out)["state_hash"] == j["state_hash"]);
  CHECK(shell.run("run block.json --quiet").out.empty());
}

TEST_CASE("the output folder must be writable before anything is solved") {
  Shell shell;
  shell.write("block.json", kBlock);
  shell.write("file", "");
  for (const char* folder : {"/proc/nowhere", "file", "file/inside"}) {
    INFO(folder);
    const Outcome o = shell.run(std::string("run block.json --out ").append(folder));
    CHECK(o.code == 2);
    CHECK(o.out.empty());
  }
}

TEST_CASE("no convergence and a spent budget have codes of their own") {
  Shell shell;
  shell.write("block.json", kBlock);
  CHECK(shell.run("run block.json --set analysis.max_iterations=1 --set tractions.pull.amount=1000").code ==
        3);
  CHECK(Json::parse(slurp(shell.folder() / "out/block/summary.json"))["status"] == "not_converged");
  CHECK(shell.run("run block.json --budget 1e-6").code == 4);
}

TEST_CASE("view makes the page of a folder from its frames") {
  const Shell shell;
  REQUIRE(shell.run("run cantilever --set bodies[0].mesh.box.divisions=[4,1,1] --quiet --out frames").code ==
          0);
  const fs::path page = shell.folder() / "frames/index.html";
  fs::remove(page);
  const Outcome made = shell.run("view frames --no-browser");
  if (made.code != 0) {
    CHECK_THAT(made.err, Contains("no results page"));  // a build without node and npm
  } else {
    CHECK_THAT(made.out, Contains("2 frames, 24 elements"));
    CHECK_THAT(made.out, Contains("frames/index.html"));
    const std::string text = slurp(page);
    CHECK_THAT(text, Contains("Mean stress"));
    CHECK_THAT(text, Contains("tip.y_m"));
    // A page that is there stays, unless asked for.
    std::ofstream(page) << "kept";
    CHECK(shell.run("view frames --no-browser").code == 0);
    CHECK(slurp(page) == "kept");
    CHECK(shell.run("view frames --no-browser --remake").code == 0);
    CHECK(slurp(page).size() > 1000);
  }
  CHECK(shell.run("view nowhere").code == 2);
  fs::create_directories(shell.folder() / "empty");
  const Outcome empty = shell.run("view empty --no-browser");
  CHECK(empty.code == 2);
  CHECK((made.code != 0 || empty.err.find("0 .pvd files") != std::string::npos));
}

TEST_CASE("drive finds amounts, and says which targets are out of reach") {
  Shell shell;
  shell.write("block.json", kBlock);
  shell.write("targets.csv", "time,tip.x\n1,2.05\n2,2.1\n");
  const std::string drive = "drive block.json --targets targets.csv --out out";
  const Outcome free = shell.run(drive + " --amount pull");
  INFO(free.out << free.err);
  CHECK(free.code == 0);
  CHECK(free.out.find("2 of 2 targets reached") != std::string::npos);
  for (const char* file : {"drive.csv", "drive.json", "summary.json", "steps.csv"})
    CHECK(fs::exists(shell.folder() / "out" / file));
  const Outcome bounded = shell.run(drive + " --amount pull=0:0.4");
  CHECK(bounded.code == 3);
  CHECK(bounded.out.find("nearest") != std::string::npos);
  CHECK(shell.run(drive + " --amount wind").code == 2);
  CHECK(shell.run("drive block.json --targets nowhere.csv --amount pull").code == 2);
}

TEST_CASE("check judges meshes") {
  Shell shell;
  const Outcome good = shell.run("check " ISOCHOR_SCENES "/meshes/tube.msh");
  CHECK(good.code == 0);
  CHECK_THAT(good.out, Contains("chamber") && Contains("usable"));
  CHECK_THAT(shell.run("check " ISOCHOR_SCENES "/meshes/finger.msh").out, Contains("thin-walls"));
  CHECK_THAT(shell.run("check " ISOCHOR_SCENES "/meshes/cantilever_3.msh").out, !Contains("thin-walls"));
  shell.write("broken.msh", "$MeshFormat\n4.1 0 8\n");
  CHECK(shell.run("check broken.msh").code == 2);
  const Outcome both = shell.run("check broken.msh " ISOCHOR_SCENES "/meshes/tube.msh --json");
  CHECK(both.code == 2);
  CHECK(Json::parse(both.out).size() == 2);
}

TEST_CASE("an interrupt ends a run in good order") {
  Shell shell;
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::path out = shell.folder() / "stopped";
    fs::remove_all(out);
    const pid_t child = ::fork();
    if (child == 0) {
      // Silent, and long enough to be caught on the way.
      if (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr)) _exit(99);
      ::execl(ISOCHOR_BINARY, "isochor", "run", "tube", "--set", "analysis.steps=500", "--threads", "1",
              "--out", out.c_str(), static_cast<char*>(nullptr));
      _exit(99);
    }
    REQUIRE(child > 0);
    for (int wait = 0; wait < 2000 && !fs::exists(out / "frames/tube_00001.vtu"); ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ::kill(child, signal);
    int status = 0;
    ::waitpid(child, &status, 0);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 130);
    const Json j = Json::parse(slurp(out / "summary.json"));
    CHECK(j["status"] == "interrupted");
    CHECK(j["steps"].get<int>() >= 1);
    CHECK(fs::exists(out / "tube.pvd"));
    CHECK_FALSE(slurp(out / "steps.csv").empty());
  }
}

#ifndef __SANITIZE_ADDRESS__  // its shadow alone takes more than any limit
TEST_CASE("without memory the tool ends, and says why") {
  Shell shell;
  shell.write("large.json", R"({"bodies": [{"name": "b", "mesh": {"box": {"divisions": [24, 24, 24]}},
    "element": "tet10", "materials": [{"young": 1000, "poisson": 0.5}]}], "gravity": [0, 0, -0.1],
    "dirichlet": [{"name": "h", "where": {"surfaces": ["z0"]}}]})");
  for (const char* kilobytes : {"150000", "400000", "900000"}) {
    CAPTURE(kilobytes);
    const Outcome o = shell.run("run large.json --out out",
                                "ulimit -v " + std::string(kilobytes) + " && timeout -k 1 100 ");
    CHECK(o.code != 0);
    CHECK(o.code < 124);  // nobody had to end it, no signal did
    CHECK_THAT(o.err, Contains("memory"));
  }
}
#endif
