// isochor: list, run, live, view, check and show scenes, and studies, from the command line.
#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "apps/commands.h"
#ifdef ISOCHOR_HAVE_PETSC
#include "petsc/session.h"
#endif

namespace {

using namespace isochor;

constexpr const char* kRunFooter =
    "Exit codes: 0 success, 1 internal error, 2 bad input, 3 not converged, or --error not reached (what "
    "was\n"
    "reached is kept), 4 stopped by the budget, 5 outputs cannot be written,\n6 out of memory, 130 "
    "interrupted.\n"
    "Example: isochor run finger --set cavities.chamber.amount=20000 --set bodies[0].element=tet10";

// CLI11 has checks of its own, whose messages print the largest number there is in 309 digits.
CLI::Validator number_that(bool (*fits)(double), const std::string& wanted) {
  return CLI::Validator(
      [fits, wanted](std::string& text) {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && fits(value))
          return std::string();
        return "\"" + text + "\" does not do; give " + wanted;
      },
      "");
}
CLI::Validator positive() {
  return number_that([](double v) { return v > 0; }, "a positive number");
}
CLI::Validator not_negative() {
  return number_that([](double v) { return v >= 0; }, "0 or a positive number");
}

void add_overrides(CLI::App* c, std::vector<std::string>& overrides) {
  c->add_option("--set", overrides, "Change a value of the scene: path=value")
      ->type_name("PATH=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
}

void add_run(CLI::App& top, app::RunArguments& a) {
  CLI::App* c = top.add_subcommand("run", "Run a scene of the library or a scene file");
  c->add_option("scene", a.scene, "Name of a scene (see `isochor list`) or a file that ends in .json")
      ->capture_default_str();
  add_overrides(c, a.overrides);
  c->add_option("--out", a.folder, "Folder of the outputs; default out/NAME")->type_name("DIR");
  c->add_option("--threads", a.threads, "Threads; 0: all the machine has")->check(CLI::Range(0, 1024));
  c->add_option("--budget", a.budget, "Stop after this much wall time")
      ->type_name("SECONDS")
      ->check(positive());
  c->add_flag("--resume", a.resume, "Go on from the last checkpoint in the folder of outputs");
  c->add_option("--checkpoint", a.checkpoint, "Wall time between checkpoints; default 60, 0: none")
      ->type_name("SECONDS")
      ->check(not_negative());
  c->add_flag("--quiet", a.quiet, "Print errors only");
  c->add_flag("--json", a.json, "Print the summary as JSON instead of tables");
  c->add_flag("--explain", a.explain, "Say which effects are on, why, and their share of time and memory");
  c->add_flag("--accuracy", a.accuracy,
              "Run once more with something better and say what every metric and probe is worth");
  c->add_option("--error", a.error,
                "Find element and mesh so that every metric and probe is within this of the answer")
      ->type_name("PERCENT")
      ->excludes("--accuracy", "--resume");
  c->add_flag("--price", a.price, "Say what 10, 3, 1 and 0.3 % would take: element, mesh, time, memory")
      ->excludes("--accuracy", "--resume", "--error");
#ifdef ISOCHOR_HAVE_PETSC
  c->add_option("--petsc", a.petsc, "Options of PETSc, which solves under mpirun or where this is given")
      ->type_name("'-KEY VALUE ...'");
#endif
  c->footer(kRunFooter);
}

void add_study(CLI::App& top, app::StudyArguments& a) {
  CLI::App* c = top.add_subcommand("study", "Sweep scenes and measure: accuracy for time, locking and more");
  c->add_option("study", a.study, "Name of a study (see --list)");
  c->add_flag("--list", a.list, "List the studies");
  c->add_flag("--quick", a.quick, "A smaller sweep, one repeat");
  c->add_option("--out", a.folder, "Folder of the outputs; default out/study/NAME")->type_name("DIR");
  c->add_option("--only", a.only, "Measure only cells with this text in their names")->type_name("TEXT");
  c->add_flag("--fresh", a.fresh, "Measure all again; otherwise what this build has measured is kept");
  c->add_option("--threads", a.threads, "Threads; 0: all the machine has")->check(CLI::Range(0, 1024));
  c->add_flag("--check", a.check, "Hold guarded cells of all studies against the committed expectations");
  c->add_flag("--update", a.update, "With --check: write what was found as the new expectations")
      ->needs("--check");
  c->add_option("--seeds", a.seeds, "chaos: the seeds, first and last")
      ->type_name("A-B")
      ->capture_default_str();
  c->add_option("--limit", a.limit, "chaos: processor time after which a seed counts as hanging")
      ->type_name("SECONDS")
      ->check(positive());
  c->add_option("--jobs", a.jobs, "chaos: seeds at a time")->check(CLI::Range(1, 256));
  c->add_flag("--keep", a.keep, "chaos: keep the scenes of all seeds, not only of broken ones");
  c->add_flag("--untimed", a.untimed,
              "chaos: budgets count iterations in place of seconds, the same on every machine");
  c->add_flag("--quiet", a.quiet, "Print errors only");
  c->footer("A study that is stopped (Ctrl-C) leaves what it has; the same command goes on from there.");
}

void add_fit(CLI::App& top, app::FitArguments& a) {
  CLI::App* c = top.add_subcommand("fit", "Find constants of material laws from measured curves");
  c->add_option("curve", a.curves,
                "CSV files with strain (or stretch) and stress; FILE:equibiaxial, FILE:pure_shear for other "
                "modes than "
                "uniaxial");
  c->add_option("--scene", a.scenes,
                "In place of curves: a scene and a CSV file of what was measured of it; may be given again")
      ->type_name("SCENE:DATA:WEIGHT")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  c->add_option("--constant", a.constants,
                "A constant that is sought, by its path in the scenes, with bounds; may be given again")
      ->type_name("PATH=LEAST:MOST")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  add_overrides(c, a.overrides);
  c->add_option("--threads", a.threads, "Threads; 0: all the machine has")->check(CLI::Range(0, 1024));
  c->add_option("--law", a.laws, "Law to fit, may be given again; default all")->allow_extra_args(false);
  c->add_option("--strain", a.strain, "Column of the strain; default by its name")->type_name("NAME");
  c->add_option("--stress", a.stress, "Column of the stress; default by its name")->type_name("NAME");
  c->add_option("--stress-unit", a.stress_unit, "Of the stress, where its column does not say")
      ->check(CLI::IsMember({"Pa", "kPa", "MPa"}));
  c->add_option("--from", a.lowest, "Least engineering strain that counts")->type_name("STRAIN");
  c->add_option("--to", a.highest,
                "Largest engineering strain that counts; default where the stress is largest")
      ->type_name("STRAIN");
  c->add_flag("--relative", a.relative,
              "Errors over the measured stress, in place of over the largest of a curve");
  c->add_option("--out", a.folder, "Folder of the outputs; default out/fit/NAME")->type_name("DIR");
  c->add_flag("--json", a.json, "Print fit.json");
  c->add_flag("--quiet", a.quiet, "Print errors only");
}

void add_prony(CLI::App& top, app::PronyArguments& a) {
  CLI::App* c = top.add_subcommand("fit-prony", "Find terms of a Prony series from a measured relaxation");
  c->add_option("data", a.file, "CSV file with time [s] and stress, force or modulus in any unit")
      ->required();
  c->add_option("--terms", a.terms, "Most terms; fits of fewer are told too")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  c->add_option("--ramp", a.ramp, "How long the strain rose, steadily from time 0; default 0: at once")
      ->type_name("SECONDS")
      ->check(not_negative());
  c->add_option("--time", a.time, "Column of the time; default by its name")->type_name("NAME");
  c->add_option("--value", a.value, "Column of the stress; default by its name")->type_name("NAME");
  c->add_option("--out", a.folder, "Folder of prony.json; default out/fit/NAME")->type_name("DIR");
  c->add_flag("--json", a.json, "Print prony.json");
  c->add_flag("--quiet", a.quiet, "Print errors only");
}

void add_drive(CLI::App& top, app::DriveArguments& a) {
  CLI::App* c = top.add_subcommand("drive", "Find amounts that bring probes of a scene to targets");
  c->add_option("scene", a.scene, "Name of a scene (see `isochor list`) or a file that ends in .json")
      ->required();
  c->add_option("--targets", a.targets, "CSV file: time, and components of probes such as tip.x [m]")
      ->required()
      ->type_name("FILE");
  c->add_option("--amount", a.amounts,
                "An effect whose amount is chosen, with bounds and rate; may be given again")
      ->required()
      ->type_name("NAME=LEAST:MOST:RATE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  add_overrides(c, a.overrides);
  c->add_option("--tolerance", a.tolerance, "Distance within which a target is reached; default 1e-6")
      ->type_name("METERS")
      ->check(positive());
  auto* horizon =
      c->add_flag("--horizon", a.horizon, "Choose the amounts of all times together; dynamics too");
  c->add_option("--every", a.every, "Increments between two points of an amount's curve; default 1")
      ->needs(horizon)
      ->check(CLI::Range(1, 1000000));
  c->add_option("--smooth", a.smooth,
                "How much changes of amounts count; default 1e-4, and less where that keeps from targets")
      ->needs(horizon)
      ->check(positive());
  c->add_option("--out", a.folder, "Folder of the outputs; default out/drive/NAME")->type_name("DIR");
  c->add_option("--threads", a.threads, "Threads; 0: all the machine has")->check(CLI::Range(0, 1024));
  c->add_flag("--json", a.json, "Print drive.json");
  c->add_flag("--quiet", a.quiet, "Print errors only");
  c->footer(
      "Exit codes: 0 all targets are reached, 3 some are not (drive.csv says which and how far), 2 bad "
      "input.");
}

void add_design(CLI::App& top, app::DesignArguments& a) {
  CLI::App* c =
      top.add_subcommand("design", "Find shapes and stiffness fields that bring a scene to targets");
  c->add_option("scene", a.scene, "Name of a scene (see `isochor list`) or a file that ends in .json")
      ->required();
  c->add_option("--targets", a.targets, "CSV file: time and what is wanted then, or markers")
      ->required()
      ->type_name("FILE");
  c->add_option("--move", a.moves,
                "A surface whose place is chosen, between bounds in meters along its outward normals (or "
                "SURFACE.x along an axis); may be given again")
      ->type_name("BODY:SURFACE=LEAST:MOST")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  c->add_option("--hold", a.hold, "A surface that stays; may be given again; default all that does not move")
      ->type_name("SURFACE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  c->add_option("--volume-least", a.least_volume, "Of the body that moves, at rest [m^3]")->check(positive());
  c->add_option("--volume-most", a.most_volume, "Of the body that moves, at rest [m^3]")->check(positive());
  c->add_option("--quality", a.quality, "Least J of a cell against the mesh as it came; default 0.2")
      ->check(number_that([](double v) { return v > 0 && v < 1; }, "a number between 0 and 1"));
  CLI::Option* field =
      c->add_option("--stiffness", a.stiffness, "Body whose stiffness is chosen cell by cell")
          ->type_name("BODY");
  c->add_option("--length", a.length, "Length over which the field is smooth [m]")
      ->check(positive())
      ->needs(field);
  c->add_option("--spread", a.spread, "Standard deviation of the logarithm of factors; default 0.5")
      ->check(positive())
      ->needs(field);
  c->add_option("--least", a.least_factor, "Least factor on the stiffness; default 0.01")
      ->check(positive())
      ->needs(field);
  c->add_option("--most", a.most_factor, "Largest factor on the stiffness; default 100")
      ->check(positive())
      ->needs(field);
  c->add_option("--noise", a.noise,
                "Errors that count as met, over the largest change; default 1e-4, with --stiffness 0.01")
      ->check(positive());
  c->add_option("--iterations", a.iterations, "At most so many steps; default 60")
      ->check(CLI::Range(1, 100000));
  add_overrides(c, a.overrides);
  c->add_option("--out", a.folder, "Folder of the outputs; default out/design/NAME")->type_name("DIR");
  c->add_option("--threads", a.threads, "Threads; 0: all the machine has")->check(CLI::Range(0, 1024));
  c->add_flag("--json", a.json, "Print design.json");
  c->add_flag("--quiet", a.quiet, "Print errors only");
  c->footer(
      "Exit codes: 0 targets are met, 3 they are not (design.json says how far), 2 bad input, 130 "
      "interrupted: "
      "what was found up to then is kept.");
}

void add_view(CLI::App& top, app::ViewArguments& a) {
  CLI::App* c = top.add_subcommand("view", "Open the results page of a folder; make it where it is missing");
  c->add_option("folder", a.folder, "What `isochor run` or `isochor study` wrote: out/finger")->required();
  c->add_flag("--remake", a.remake, "Make the page from the frames (.pvd, .vtu) even if there is one");
  c->add_flag("--no-browser", a.quiet_browser, "Only print where the page is");
}

constexpr const char* kLiveFooter =
    "Exit codes: 0 ended by Ctrl-C, 1 internal error, 2 bad input, 5 a recording cannot be written,\n"
    "6 out of memory, 7 the port is in use or there is no such address, 8 live is not in this build.\n"
    "Example: isochor live finger --dynamic --set bodies[0].mesh.file=meshes/finger_small.msh";

void add_live(CLI::App& top, app::LiveArguments& a) {
  CLI::App* c = top.add_subcommand("live", "Run a scene in the browser, where it answers to the hand");
  c->add_option("scene", a.scene, "Name of a scene (see `isochor list`) or a file that ends in .json")
      ->capture_default_str();
  add_overrides(c, a.overrides);
  c->add_option("--host", a.host,
                "Address to listen on; others than this machine can reach what is no loopback")
      ->capture_default_str();
  c->add_option("--port", a.port, "Port; default: one that is free")->check(CLI::Range(0, 65535));
  c->add_option("--threads", a.threads, "Threads; 0: all the machine has")->check(CLI::Range(0, 1024));
  c->add_option("--step-limit", a.step_limit, "Wall time after which a step is given up")
      ->type_name("SECONDS")
      ->check(positive())
      ->capture_default_str();
  c->add_option("--out", a.folder, "Folder of recordings; default out/live_NAME")->type_name("DIR");
  c->add_flag("--dynamic", a.dynamic,
              "Statics as a motion, in steps of 1/60 s: the load factor becomes seconds");
  c->add_flag("--record", a.record, "Record from the beginning, with the outputs of `isochor run`");
  c->add_flag("--paused", a.paused, "Begin at rest");
  c->add_flag("--readonly", a.readonly, "Viewers may look on and change nothing");
  c->add_flag("--no-browser", a.quiet_browser, "Only print the link");
  CLI::Option* page =
      c->add_option("--export", a.export_to, "Write one page that runs the scene without a server, and end")
          ->type_name("FILE.html");
  for (const char* served :
       {"--host", "--port", "--threads", "--step-limit", "--out", "--record", "--readonly"})
    page->excludes(c->get_option(served));
  c->footer(kLiveFooter);
}

int dispatch(int argc, char** argv) {
  CLI::App top{"Isochor: soft incompressible bodies, pneumatic robots at Poisson's ratio 0.5"};
  top.name("isochor");
  top.require_subcommand(1);
  app::RunArguments run;
  app::StudyArguments study;
  app::ViewArguments view;
  app::FitArguments fit;
  app::PronyArguments prony;
  app::LiveArguments live;
  app::DriveArguments drive;
  app::DesignArguments design;
  bool json = false;
  double scale = 1;
  std::vector<std::string> meshes, overrides;
  std::string scene;
  CLI::App* list = top.add_subcommand("list", "List the scenes of the library");
  list->add_flag("--json", json, "As JSON");
  add_run(top, run);
  add_study(top, study);
  add_view(top, view);
  add_live(top, live);
  add_fit(top, fit);
  add_prony(top, prony);
  add_drive(top, drive);
  add_design(top, design);
  CLI::App* check =
      top.add_subcommand("check", "Check mesh files: counts and findings; exit 2 if one is not usable");
  check->add_option("mesh", meshes, "Mesh files (.msh, .vtk, .vtu, .node/.ele, .mesh)")->required();
  check->add_option("--scale", scale, "Multiplies coordinates: 1e-3 for millimeters")->check(positive());
  bool triangles = false;
  check->add_flag("--triangles", triangles,
                  "Its triangles are the cells, of a thin body; also of .obj and .stl");
  check->add_flag("--json", json, "As JSON");
  CLI::App* show = top.add_subcommand("show", "Print a scene as a scene file, a start for one of your own");
  show->add_option("scene", scene, "Name of a scene or a scene file")->required();
  show->add_option("--set", overrides, "Change a value: path=value")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  bool schema = false, tables = false;
  CLI::App* keys =
      top.add_subcommand("keys", "Print every key of a scene file with kind, unit, default and meaning");
  CLI::Option* as_schema = keys->add_flag("--schema", schema, "As JSON Schema");
  keys->add_flag("--tables", tables, "As tables of Markdown")->excludes(as_schema);
  CLI::App* version = top.add_subcommand("version", "Print version, build and licenses");
  version->add_flag("--json", json, "As JSON");
  try {
    top.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    // CLI11 has exit codes of its own; help is success, all else is bad input.
    return top.exit(e) == 0 ? app::success : app::bad_input;
  }
  if (list->parsed()) return app::list(json);
  if (check->parsed()) return app::check(meshes, scale, triangles, json);
  if (show->parsed()) return app::show(scene, overrides);
  if (keys->parsed()) {
    return app::keys(schema ? app::KeysAs::schema : tables ? app::KeysAs::tables : app::KeysAs::lines);
  }
  if (version->parsed()) return app::version(json);
  if (top.got_subcommand("fit-prony")) return app::fit_prony(prony);
  if (top.got_subcommand("fit")) return fit.scenes.empty() ? app::fit_laws(fit) : app::fit_constants(fit);
  if (top.got_subcommand("drive")) return app::drive_scene(drive);
  if (top.got_subcommand("design")) return app::design_scene(design);
  if (top.got_subcommand("study")) return app::study(study);
  if (top.got_subcommand("view")) return app::view(view);
  if (top.got_subcommand("live")) return app::live(live);
#ifdef ISOCHOR_HAVE_PETSC
  if (PetscSession::launched() || !run.petsc.empty()) return app::run_on_ranks(run);
#endif
  return app::run(run);
}

}  // namespace

namespace {

// What was printed counts as done only when it has arrived.
int checked_output(int code) {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    std::fprintf(
        stderr,
        "isochor: standard output could not be written: its reader is gone, or the disk is full; what "
        "went into files is there\n");
    if (code == app::success) code = app::not_written;
  }
  // Threads of BLAS that found no memory, which may be what the reason is about, never end, and an exit that
  // waits for them does not either.
  if (code != app::success) std::_Exit(code);
  return code;
}

}  // namespace

void app::end_without_memory() {
  std::fputs("isochor: out of memory; take a smaller mesh or give the process more\n", stderr);
  std::fflush(stdout);
  std::_Exit(out_of_memory);
}

int main(int argc, char** argv) {
  // A reader that goes away is told by the writes that fail, and ends no run.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return checked_output(dispatch(argc, argv));
  } catch (const std::bad_alloc&) {
    app::end_without_memory();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "isochor: internal error: %s\n", e.what());
  } catch (...) {
    std::fprintf(stderr, "isochor: internal error\n");
  }
  return app::internal;
}
