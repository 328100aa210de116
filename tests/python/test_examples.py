"""The examples run, and do what they say."""

import os
import re
import runpy
import subprocess

import pytest

from conftest import SOURCE

EXAMPLES = SOURCE / "examples" / "python"


def run(name, capsys):
    program = runpy.run_path(str(EXAMPLES / f"{name}.py"))
    result = program["main"]()
    return result, capsys.readouterr().out


def test_inflate_prints_what_the_cpp_example_prints(capsys):
    _, printed = run("inflate", capsys)
    done = subprocess.run([os.environ["ISOCHOR_FINGER_EXAMPLE"]], capture_output=True, text=True, check=True, cwd=SOURCE)
    assert printed == done.stdout and printed.count("\n") == 6


def test_grip_lifts_the_ball_and_lets_it_fall(capsys):
    _, printed = run("grip", capsys)
    heights = [float(h) for h in re.findall(r"ball at +(-?[0-9.]+) mm", printed)]
    closed, lifted, held, opened = heights
    assert abs(closed - 20) < 1 and 45 < lifted < 51 and abs(held - lifted) < 1.5 and opened < held - 5


def test_control_brings_the_tip_to_its_targets(capsys):
    off, printed = run("control_tip", capsys)
    assert off < 1e-5
    for distance, steps in re.findall(r"off by ([0-9.]+) mm after ([0-9]+) steps", printed):
        assert float(distance) < 0.0101 and int(steps) < 20
    assert printed.count("target") == 3


def test_a_fit_finds_the_moduli_of_layers_and_a_design_its_thickness(capsys):
    (off, steps, steps_of_design), printed = run("fit_layers", capsys)
    assert off < 1e-7 and steps < 12 and steps_of_design < 8
    assert printed.startswith("moduli 60.000 and 240.000 kPa")


def test_there_is_no_example_that_no_test_runs():
    assert {file.stem for file in EXAMPLES.glob("*.py")} == {"inflate", "grip", "control_tip", "fit_layers"}


@pytest.mark.parametrize("name", ["inflate", "grip", "control_tip", "fit_layers"])
def test_examples_say_what_they_do(name):
    assert (EXAMPLES / f"{name}.py").read_text().startswith('"""')
