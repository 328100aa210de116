"""Scenes: the same as from the command line; results as arrays and as a page; studies."""

import html
import json
import os
import pickle
import re
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import isochor as iso
from conftest import SOURCE, sentence
from isochor.keys import effect_types

SHORT = {"analysis.steps": 2, "bodies[0].element": "tet4"}


def tube(**more):
    return iso.Scene.load("tube", {**SHORT, **more})


def test_the_library_and_files_are_the_same_scene():
    assert "finger" in iso.library() and iso.library()["tube"]
    scene = iso.Scene.load("tube")
    file = iso.Scene.load(SOURCE / "scenes" / "files" / "tube.json")
    assert scene.name == file.name == "tube" and scene.title == file.title
    mine, theirs = scene.to_dict(), file.to_dict()
    for one in (mine, theirs):
        for body in one["bodies"]:
            body["mesh"].pop("file", None)
    assert mine == theirs


def test_overrides_by_place_and_by_name():
    scene = tube(**{"analysis.steps": 3})
    assert scene.to_dict()["analysis"]["steps"] == 3
    other = scene.override({"analysis.steps": 4})
    assert other.to_dict()["analysis"]["steps"] == 4 and scene.to_dict()["analysis"]["steps"] == 3


def test_a_run_has_the_bits_of_the_command_line(tmp_path):
    result = tube().run(threads=1, page=False)
    assert result.converged and result.reason == ""
    tool = os.environ["ISOCHOR_BINARY"]
    sets = [part for key, value in SHORT.items() for part in ("--set", f"{key}={value}")]
    subprocess.run([tool, "run", "tube", "--out", tmp_path, "--quiet", *sets], check=True, capture_output=True)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert int(str(summary["state_hash"]), 16) == result.state_hash or summary["state_hash"] == result.summary["state_hash"]
    assert {m["name"]: m["value"] for m in summary["metrics"]} == {
        m["name"]: m["value"] for m in result.summary["metrics"]
    }


def test_results_are_arrays_over_time():
    result = tube().run(threads=1, page=False)
    time = result["time"]
    assert time.shape == (3,) and time[0] == 0 and time[-1] == 1
    assert set(result) >= {"min_J", "newton_iterations", "energies.elastic", "linear_momentum"}
    assert result["linear_momentum"].shape == (3, 3)
    cavity = next(name for name in result if name.startswith("cavities.") and name.endswith(".pressure"))
    assert result[cavity].shape == (3,) and result[cavity][-1] > 0
    probe = next(name for name in result if name.startswith("probes."))
    assert result[probe].shape == (3, 3) and not result[probe][0].any()
    assert result.metrics and all(isinstance(m.value, float) for m in result.metrics.values())
    with pytest.raises(KeyError, match="there are: step, time"):
        result["pressure"]


def test_steps_are_told_and_what_is_raised_there_stops_the_run():
    told = []
    tube().run(threads=1, page=False, on_step=lambda *step: told.append(step))
    assert told == [(1, 2, 0.5), (2, 2, 1.0)]

    def fail(step, steps, time):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        tube().run(threads=1, page=False, on_step=fail)


def test_a_notebook_shows_the_page(tmp_path):
    result = tube().run(threads=1)
    page = result.page()
    assert page.lstrip().lower().startswith("<!doctype html>") and len(page) > 10000
    shown = result._repr_html_()
    source = re.fullmatch(r'<iframe srcdoc="([^"]*)"[^>]*></iframe>', shown, re.S)
    assert source and html.unescape(source[1]) == page
    result.save_page(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page
    without = tube().run(threads=1, page=False)
    assert "<table>" in without._repr_html_()
    with pytest.raises(iso.Error) as error:
        without.page()
    assert "page=True" in sentence(error)


def test_outputs_go_to_a_folder_and_a_run_resumes(tmp_path):
    result = tube().run(tmp_path, threads=1)
    assert (tmp_path / "summary.json").exists() and (tmp_path / "steps.csv").exists()
    assert result.page() == (tmp_path / "index.html").read_text(encoding="utf-8")
    again = tube().run(tmp_path, threads=1, resume=True)
    assert again.status == "converged"


def test_a_run_that_finds_nothing_is_a_result_and_no_exception():
    result = tube(**{"analysis.max_iterations": 1, "analysis.smallest_fraction": 1.0, "analysis.transient_rescue": False}).run(threads=1, page=False)
    assert result.status == "not_converged" and result.reason and "not_converged" in repr(result)


BAD = {
    "name": (lambda: iso.Scene.load("tubes"), 'no file "tubes" and no scene of the library'),
    "file": (lambda: iso.Scene.load("nowhere.json"), "nowhere.json"),
    "key": (lambda: iso.Scene.load("tube", {"analysis.stesp": 1}), "stesp"),
    "list": (lambda: iso.Scene.load("tube", ["analysis.steps=1"]), "give a dict"),
    "value": (lambda: iso.Scene.load("tube", {"analysis.steps": -1}), "steps"),
    "dict": (lambda: iso.Scene.from_dict({"bodies": 3}), "bodies"),
    "budget": (lambda: tube().run(budget=-1.0, page=False), "budget"),
    "folder": (lambda: tube().run("/proc/nowhere"), "/proc/nowhere"),
    "mesh": (lambda: tube(**{"bodies[0].mesh.file": "nowhere.msh"}).run(page=False), "nowhere.msh"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_scenes_get_one_sentence(case):
    call, words = BAD[case]
    with pytest.raises(iso.Error) as error:
        call()
    assert words in sentence(error)


def test_a_scene_of_a_dict_and_a_scene_that_was_pickled():
    scene = tube()
    again = iso.Scene.from_dict(scene.to_dict(), scene.folder)
    third = pickle.loads(pickle.dumps(scene))
    hashes = {s.run(threads=1, page=False).state_hash for s in (scene, again, third)}
    assert len(hashes) == 1


def test_a_study_is_a_table():
    amounts = [2000.0, 4000.0]
    name = iso.Scene.load("tube").to_dict()["cavities"][0]["name"]
    place = f"cavities.{name}.amount"
    told = []
    table = iso.study(tube(), {place: amounts, "analysis.steps": [1, 2]}, on_run=lambda *a: told.append(a[:2]))
    assert len(table) == 4 and told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert list(table[place]) == [2000.0, 2000.0, 4000.0, 4000.0]
    assert list(table["analysis.steps"]) == [1, 2, 1, 2] and all(table["status"] == "converged")
    metric = next(iter(table.runs[0].metrics))
    assert table[metric].shape == (4,) and table[metric][0] != table[metric][2]
    assert table._repr_html_().count("<tr>") == 5


def test_runs_of_a_study_may_go_side_by_side(tmp_path):
    over = {"analysis.steps": [1, 2], "bodies[0].element": ["tet4", "tet4_edge_smoothed"]}
    one = iso.study(tube(), over, together=True)
    two = iso.study(tube(), over, together=True, workers=2)
    assert len(one) == 2
    assert [r.state_hash for r in one.runs] == [r.state_hash for r in two.runs]
    one.to_csv(tmp_path / "study.csv")
    assert (tmp_path / "study.csv").read_text().startswith("analysis.steps,bodies[0].element,status,reason")


def test_a_study_says_what_was_refused():
    table = iso.study(tube(), {"bodies[0].materials[0].poisson": [0.4, 0.7]})
    assert table.rows[1]["status"] == "refused" and "poisson" in table.rows[1]["reason"] and table.runs[1] is None
    for over, words in (({}, "nothing to vary"), ({"a": 3}, "give a list"), ({"a": []}, "give a list")):
        with pytest.raises(iso.Error) as error:
            iso.study(tube(), over)
        assert words in sentence(error)
    with pytest.raises(iso.Error, match="different lengths"):
        iso.study(tube(), {"analysis.steps": [1, 2], "bodies[0].element": ["tet4"]}, together=True)


def test_control_c_stops_a_run():
    program = textwrap.dedent(
        """
        import os, signal, threading, time
        import isochor as iso
        def interrupt():
            time.sleep(0.5)
            os.kill(os.getpid(), signal.SIGINT)
        scene = iso.Scene.load("finger", {"analysis.steps": 100000})
        threading.Thread(target=interrupt).start()
        try:
            scene.run(threads=1, page=False)
        except KeyboardInterrupt:
            print("interrupted")
        """
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    assert done.stdout == "interrupted\n", done.stderr


@pytest.mark.parametrize("name", ["thick_tube", "thick_sphere_volume", "incline", "two_chambers"])
def test_a_world_of_a_scene_goes_where_the_scene_goes(name):
    scene = iso.Scene.load(name)
    world = scene.world()
    for _ in range(scene.steps):
        if scene.path_step:
            world.follow(scene.path_step)
        else:
            world.advance(scene.step_length)
    assert world.state_hash == scene.run(page=False).state_hash


def test_every_scene_of_the_library_is_a_world_with_its_names():
    for name in iso.library():
        scene = iso.Scene.load(name)
        if scene.to_dict()["bodies"][0]["mesh"].get("file", "").endswith("large.msh"):
            continue
        said, world = scene.to_dict(), scene.world()
        assert [b.name for b in world.bodies] == [b.get("name", "body") for b in said["bodies"]]
        named = {keys["name"] for name in effect_types().values() for keys in said.get(name, [])}
        assert named <= {effect.name for effect in world.effects}
        assert all(world[effect.name] is effect for effect in world.effects)


def test_a_world_of_a_scene_lives():
    world = tube().world(threads=1)
    chamber = next(e for e in world.effects if e.kind == "cavity")
    chamber.amount = 2000.0
    world.advance(0.5)
    other = pickle.loads(pickle.dumps(world))
    assert other.state_hash == world.state_hash and other[chamber.name].amount == 2000.0
    twin = world.clone()
    for one in (world, other, twin):
        one.advance(0.5)
    assert other.state_hash == world.state_hash == twin.state_hash
    # Changed, it is a world like others.
    body = world.bodies[0]
    body.set_material(iso.neo_hookean(young=2e5, poisson=0.5))
    world.add(iso.damping(body, viscosity=1.0)) if hasattr(iso, "damping") else None
    world.advance(0.1)
    changed = pickle.loads(pickle.dumps(world))
    assert changed.state_hash == world.state_hash
    world.remove(chamber)
    world.advance(0.1)
    with pytest.raises(KeyError):
        world[chamber.name]
    batch = iso.WorldBatch(tube().world(), 2)
    batch.advance(0.1)
    with pytest.raises(iso.Error, match="threads = -1"):
        tube().world(threads=-1)


def small():
    return iso.Scene.from_dict(
        {
            "name": "small",
            "bodies": [
                {
                    "name": "block",
                    "mesh": {"box": {"upper": [2, 1, 1], "divisions": [2, 1, 1]}},
                    "materials": [{"young": 1000, "poisson": 0.5}],
                }
            ],
            "analysis": {"steps": 2},
            "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
            "tractions": [{"name": "pull", "surface": "x1", "traction": [100, 0, 0]}],
            "probes": [{"name": "tip", "point": [2, 0.5, 0.5]}],
            "metrics": [{"name": "pulled", "of": "tip", "component": "x"}],
        }
    )


def test_solve_to_delivers_an_error_or_says_why_not(tmp_path):
    seen = []
    found = small().solve_to("5%", tmp_path / "out", threads=1, on_trial=seen.append)
    assert found.reached and found.end == "reached" and "within 5 %" in found.sentence
    assert seen == found.trials and found.trials[found.best]["indicator"] <= 0.05
    assert set(found.errors) == {"pulled", "probe tip"}
    assert found.errors["pulled"]["relative"] <= 0.05
    assert found.run.converged and (tmp_path / "out" / "summary.json").exists()
    # What it found stands alone.
    again = found.scene.run(threads=1, page=False)
    assert again.state_hash == found.run.state_hash
    assert small().solve_to(0.05, threads=1).run.state_hash == found.run.state_hash
    late = small().solve_to(1e-6, most_levels=1, threads=1)
    assert not late.reached and late.end == "not_reached" and "not reached" in late.sentence
    assert late.run.converged


@pytest.mark.parametrize("error", ["0%", "-1%", "100%", "much", "", 0.0, -0.1, 1.0, float("nan")])
def test_errors_without_a_meaning_are_refused(error):
    with pytest.raises(iso.Error) as caught:
        small().solve_to(error)
    sentence(caught)


def test_a_callback_that_raises_stops_a_search():
    def stop(trial):
        raise RuntimeError(trial["status"])

    with pytest.raises(RuntimeError, match="converged"):
        small().solve_to(1e-6, threads=1, on_trial=stop)
