"""fit, fit_scene, drive and design: the same answers as the commands, as objects."""

import math
import os
import subprocess

import numpy as np
import pytest

import isochor as iso
from conftest import SOURCE

RNG = np.random.default_rng(20)


def ogden_stress(stretch, mu, alpha, mode):
    """Nominal stress of one term of Ogden's, mu the shear modulus at rest."""
    across = {"uniaxial": -0.5, "equibiaxial": -2.0, "pure_shear": -1.0}[mode]
    return 2 * mu / alpha * (stretch ** (alpha - 1) - stretch ** (across * alpha - 1))


@pytest.mark.parametrize("mode", ["uniaxial", "equibiaxial", "pure_shear"])
def test_constants_come_back_from_arrays(mode):
    mu, alpha = 3e4 * math.exp(RNG.uniform(-1, 1)), RNG.uniform(1.5, 3.5)
    stretch = np.linspace(1, 2.2, 30)
    found = iso.fit({"stretch": stretch, "stress": ogden_stress(stretch, mu, alpha, mode), "mode": mode}, "ogden_1")
    law = found["ogden_1"]
    assert law.converged and law.r2 > 1 - 1e-10 and law.reason == "" and found.best is law
    assert law.shear_modulus == pytest.approx(mu, rel=1e-6)
    stiffness, exponent = law.constants.values()
    assert exponent.value == pytest.approx(alpha, rel=1e-6)
    assert stiffness.interval[0] <= stiffness.value <= stiffness.interval[1]
    assert "ogden" in repr(law.material(density=1070))


def test_fits_of_a_file_are_those_of_the_command(tmp_path):
    curve = SOURCE / "studies/fit/elastomers/ecoflex_00_30.csv"
    done = subprocess.run(
        [os.environ["ISOCHOR_BINARY"], "fit", curve, "--to", "2", "--law", "gent", "--law", "yeoh_3", "--json", "--out", tmp_path],
        capture_output=True, text=True, check=True,
    )
    told = {f["law"]: f for f in iso.inverse.json.loads(done.stdout)["fits"]}
    found = iso.fit(curve, ["gent", "yeoh_3"], highest=2)
    assert set(found) == set(told)
    for law, fit in found.items():
        assert [c.value for c in fit.constants.values()] == [c["value"] for c in told[law]["constants"]]
        assert fit.rms == told[law]["rms"] and fit.warnings == told[law]["warnings"]


BEAM = {
    "name": "beam",
    "bodies": [
        {
            "name": "beam",
            "element": "tet4",
            "mesh": {"box": {"upper": [0.3, 0.1, 0.1], "divisions": [3, 1, 1]}},
            "materials": [{"young": 50000, "poisson": 0.4, "density": 1000}],
        }
    ],
    "analysis": {"duration": 2, "steps": 2},
    "dirichlet": [{"name": "wall", "where": {"surfaces": "x0"}}],
    "springs": [{"name": "hold", "from": [0.3, 0.1, 0.1], "to": [0.3, 0.1, 0.5], "stiffness": 40}],
    "forces": [{"name": "push", "where": {"surfaces": "x1"}, "force": [0, 1, 0], "amount": [[0, 0]]}],
    "gravity": [0, 0, -9.81],
    "probes": [{"name": "tip", "point": [0.3, 0.05, 0.05]}],
}


def beam(**overrides):
    return iso.Scene.from_dict(BEAM).override(overrides.get("set", {}))


def seen(scene, *columns):
    run = scene.run(page=False)
    axis = {"x": (0, 0.3), "y": (1, 0.05), "z": (2, 0.05)}
    out = {"time": run["time"][1:]}
    for column in columns:
        k, rest = axis[column]
        out[f"tip.{column}"] = rest + run["probes.tip"][1:, k]
    return out


def test_constants_of_a_scene_come_back_from_arrays():
    young, stiffness = 50000 * math.exp(RNG.uniform(-0.5, 0.5)), 40 * math.exp(RNG.uniform(-0.5, 0.5))
    paths = "bodies[0].materials[0].young", "springs[0].stiffness"
    data = seen(beam(set=dict(zip(paths, (young, stiffness)))), "x", "y", "z")
    data["tip.y"][0] = math.nan  # was not measured
    calls = []
    found = iso.fit_scene([(beam(), data)], {paths[0]: (1e4, 1e6), paths[1]: None}, on_iteration=lambda *a: calls.append(a))
    assert found.converged and found.warnings == [] and found.rms < 1e-8 and len(calls) > 1
    assert found.constants[paths[0]].value == pytest.approx(young, rel=1e-6)
    assert found.constants[paths[1]].value == pytest.approx(stiffness, rel=1e-6)
    assert found.constants[paths[0]].start == 50000
    assert found.fitted[0]["tip.y"].shape == (1, 3) and found.fitted[0]["tip.z"].shape == (2, 3)
    again = seen(found.scenes[0], "z")["tip.z"]
    assert again == pytest.approx(data["tip.z"], abs=1e-9)
    assert found.overrides[paths[0]] == found.constants[paths[0]].value


def test_a_drive_reaches_targets_and_its_scene_goes_that_way():
    y = 0.05 + RNG.uniform(0.001, 0.01, 2)
    found = iso.drive(beam(), {"time": [1, 2], "tip.y": y}, {"push": (-5, 5)})
    assert found.reached and found.reason == "" and [t.end for t in found.targets] == ["reached"] * 2
    assert [t.found["tip.y"] for t in found.targets] == pytest.approx(list(y), abs=1e-6)
    assert seen(found.scene, "y")["tip.y"] == pytest.approx(y, abs=2e-6)
    assert found.curves["push"].shape == (2, 2)
    far = iso.drive(beam(), {"time": [1], "tip.y": [0.2]}, {"push": (-0.1, 0.1, 0.05)})
    assert not far.reached and far.targets[0].end == "nearest" and far.targets[0].at_bound == ["push"]
    assert far.targets[0].amounts["push"] == pytest.approx(0.05)


def test_a_drive_over_a_horizon_moves_in_time():
    scene = beam(set={"analysis": {"type": "dynamic", "duration": 0.3, "steps": 15}, "gravity": [0, 0, 0]})
    targets = {"time": [0.26, 0.28, 0.3], "tip.y": [0.055] * 3}
    offs = []
    found = iso.drive(scene, targets, {"push": (-5, 5)}, horizon=True, on_iteration=lambda n, off: offs.append(off))
    assert found.reached and len(offs) == found.targets[0].gradients
    assert found.curves["push"].shape == (16, 2) and found.curves["push"][0].tolist() == [0, 0]
    assert seen(found.scene, "y")["tip.y"][-3:] == pytest.approx(targets["tip.y"], abs=2e-6)
    with pytest.raises(iso.Error, match="static"):
        iso.drive(scene, targets, {"push": (-5, 5)})


def test_a_design_thins_a_beam(tmp_path):
    wanted = seen(beam(), "z")["tip.z"]
    lower = {"time": [2], "tip.z": [wanted[-1] - 0.0005]}
    found = iso.design(beam(), lower, move={"z1": (-0.02, 0.02)}, hold=["z0"])
    assert found.reached and found.end == "reached" and found.error < found.noise < found.error_before
    (moved,) = found.moves.values()
    assert abs(moved) > 1e-5 and found.at_bound == []
    assert found.history[-1]["moves"] == [moved] and found.quality > 0.2
    assert found.factor.size == 0
    mesh = found.scene.world()["beam"].mesh
    assert mesh.points[:, 2].max() == pytest.approx(0.1 + moved, abs=1e-9)
    kept = iso.design(beam(), lower, move={"z1": (-0.02, 0.02)}, hold=["z0"], folder=tmp_path / "made")
    assert list((tmp_path / "made").iterdir()) and kept.moves == found.moves


def test_a_stiffness_field_has_a_factor_a_cell():
    truth = seen(beam(set={"bodies[0].materials[0].young": 40000}), "y", "z")
    found = iso.design(beam(), truth, stiffness="beam", length=0.1, noise=1e-3)
    assert found.factor.shape == found.deviation.shape == (len(beam().world()["beam"].mesh.cells),)
    assert (found.deviation > 0).all() and found.moves == {}


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: iso.fit({"stretch": [1, 2]}), "stretch"),
        (lambda: iso.fit({"stretch": [1, 1.2, 1.4], "stress": [0, 1]}), "different lengths"),
        (lambda: iso.fit({"stretch": [1, 1.2, 1.4, 2], "stress": [0, "a", 1, 2]}), "stress"),
        (lambda: iso.fit({"stretch": [1, 1.2, 1.4, 2], "stress": [0, 9e3, 1e4, 2e4], "mode": "shear"}), "shear"),
        (lambda: iso.fit("nothing.csv"), "nothing.csv"),
        (lambda: iso.fit({"stretch": [1, 1.2, 1.4, 2], "stress": [0, 9e3, 1e4, 2e4]}, "hooke"), "hooke"),
        (lambda: iso.fit_scene([], ["springs[0].stiffness"]), "nothing was measured"),
        (lambda: iso.fit_scene([beam()], ["springs[0].stiffness"]), r"experiments\[0\]"),
        (lambda: iso.fit_scene([(beam(), {"time": [1], "tip.x": [0.3]}, -1)], ["springs[0].stiffness"]), "weight"),
        (lambda: iso.fit_scene([(beam(), {"time": [1], "tip.x": [0.3]})], {"springs[0].stiffness": (2, 1)}), "below"),
        (lambda: iso.fit_scene([(beam(), {"time": [1], "nose.x": [0.3]})], ["springs[0].stiffness"]), "nose"),
        (lambda: iso.drive(beam(), {"time": [1], "tip.y": [0.05]}, {}), "amount"),
        (lambda: iso.drive(beam(), {"time": [1], "tip.y": [0.05]}, {"push": (1,)}), "least, most"),
        (lambda: iso.drive(beam(), {"time": [1], "tip.y": [0.05]}, {"push": (1, 0)}), "below"),
        (lambda: iso.drive(beam(), {"time": [1], "tip.y": [0.05]}, {"pull": None}), "pull"),
        (lambda: iso.drive(beam(), {"time": [1], "tip.y": [math.nan]}, {"push": None}), "finite"),
        (lambda: iso.design(beam(), {"time": [1], "tip.y": [0.05]}), "nothing"),
        (lambda: iso.design(beam(), {"time": [1], "tip.y": [0.05]}, stiffness="beam"), "length"),
    ],
)
def test_bad_input_is_named(call, words):
    with pytest.raises(iso.Error, match=words):
        call()


def test_what_a_callback_raises_ends_a_search():
    def stop(*_):
        raise RuntimeError("enough")

    data = seen(beam(set={"springs[0].stiffness": 90}), "z")
    with pytest.raises(RuntimeError, match="enough"):
        iso.fit_scene((beam(), data), "springs[0].stiffness", on_iteration=stop)
