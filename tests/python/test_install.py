"""pip installs the package into a virtual environment, without a network."""

import os
import subprocess
import sys
import zipfile

import pytest

from conftest import BUILD, SOURCE

# What is built already is taken; the network is out of reach.
ENVIRONMENT = {
    **{k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "ISOCHOR_SCENES")},
    "ISOCHOR_BUILD_DIR": str(BUILD),
    "PIP_NO_INDEX": "1",
    "PIP_DISABLE_PIP_VERSION_CHECK": "1",
}

PROGRAM = """
import isochor as iso, sys
assert iso.__file__.startswith(sys.prefix), iso.__file__
world = iso.World(gravity=(0, 0, -10), threads=1)
body = world.add_body(iso.box_mesh(), iso.neo_hookean(young=1e5, poisson=0.3))
world.advance(0.1)
scene = iso.Scene.load("tube", {"analysis.steps": 1, "bodies[0].element": "tet4"})
print(world.state_hash, scene.run(threads=1, page=False).status, iso.__version__)
assert scene.folder.startswith(sys.prefix), scene.folder
"""


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    folder = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True)
    return folder


def test_pip_installs_the_package(environment, tmp_path):
    python = environment / "bin" / "python"
    command = [python, "-m", "pip", "install", "--no-build-isolation", "."]
    done = subprocess.run(command, cwd=SOURCE, env=ENVIRONMENT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    ran = subprocess.run([python, "-c", PROGRAM], cwd=tmp_path, env=ENVIRONMENT, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    state, status, version = ran.stdout.split()
    import isochor as iso

    assert status == "converged" and version == iso.__version__
    world = iso.World(gravity=(0, 0, -10), threads=1)
    world.add_body(iso.box_mesh(), iso.neo_hookean(young=1e5, poisson=0.3))
    world.advance(0.1)
    assert int(state) == world.state_hash
    # Typed, with the stubs, and gone without a trace.
    shown = subprocess.run(
        [python, "-m", "pip", "show", "--files", "isochor"], env=ENVIRONMENT, capture_output=True, text=True, check=True
    ).stdout
    assert "isochor/py.typed" in shown and "isochor/effects.pyi" in shown and f"Version: {iso.__version__}" in shown
    subprocess.run([python, "-m", "pip", "uninstall", "-q", "-y", "isochor"], env=ENVIRONMENT, check=True)
    gone = subprocess.run([python, "-c", "import isochor"], cwd=tmp_path, env=ENVIRONMENT, capture_output=True)
    assert gone.returncode != 0


def test_the_wheel_is_the_same_each_time_and_says_its_hashes(tmp_path):
    sys.path.insert(0, str(SOURCE / "bindings" / "python" / "backend"))
    try:
        import isochor_backend
    finally:
        sys.path.pop(0)
    os.environ["ISOCHOR_BUILD_DIR"] = str(BUILD)
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        name = isochor_backend.build_wheel(str(tmp_path / folder))
    first, second = ((tmp_path / folder / name).read_bytes() for folder in ("one", "two"))
    assert first == second
    with zipfile.ZipFile(tmp_path / "one" / name) as wheel:
        names = wheel.namelist()
        record = wheel.read(f"isochor-{isochor_backend._project()['version']}.dist-info/RECORD").decode()
    assert {line.split(",")[0] for line in record.splitlines()} == set(names)


def test_the_version_is_that_of_cmake():
    import re

    sys.path.insert(0, str(SOURCE / "bindings" / "python" / "backend"))
    import isochor_backend

    sys.path.pop(0)
    cmake = re.search(r"project\(isochor VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
    assert isochor_backend._project()["version"] == cmake
