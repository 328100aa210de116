"""Builds the wheel with CMake: what pip calls (PEP 517). Needs CMake, a compiler and the standard library.

What is compiled stays in build-python, or in the folder that $ISOCHOR_BUILD_DIR names, such as one that was configured
with -DISOCHOR_PYTHON=ON already. $ISOCHOR_CMAKE_ARGS is handed to the configuration.
"""

import base64
import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = "isochor"


def _project():
    """The [project] table of pyproject.toml, as much of TOML as it uses."""
    if sys.version_info >= (3, 11):
        import tomllib

        return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    table, inside = {}, False
    for line in (ROOT / "pyproject.toml").read_text().splitlines():
        if line.startswith("["):
            inside = line == "[project]"
        elif inside and ' = "' in line:
            key, value = line.split(" = ", 1)
            table[key] = value.strip('"')
    table["dependencies"] = ["numpy"]
    return table


def _tag():
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{tag}-{tag}-{platform}"


def _compile():
    """The folder of the package as it was built."""
    build = Path(os.environ.get("ISOCHOR_BUILD_DIR", ROOT / "build-python"))
    if not (build / "CMakeCache.txt").exists():
        # Python's headers are those of the interpreter that asks.
        base = Path(sys.base_prefix) / "bin" / f"python{sys.version_info.major}.{sys.version_info.minor}"
        python = base if base.exists() else Path(sys.executable)
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.run(
            ["cmake", "-S", str(ROOT), "-B", str(build), *generator]
            + ["-DCMAKE_BUILD_TYPE=Release", "-DISOCHOR_PYTHON=ON", "-DISOCHOR_TESTS=OFF", "-DISOCHOR_BENCHMARKS=OFF"]
            + [f"-DPython_EXECUTABLE={python}"]
            + shlex.split(os.environ.get("ISOCHOR_CMAKE_ARGS", "")),
            check=True,
        )
    subprocess.run(["cmake", "--build", str(build), "--target", "isochor_python"], check=True)
    return build / "python" / PACKAGE


def _metadata(project):
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}"]
    lines += [f"Summary: {project['description']}", f"Requires-Python: {project['requires-python']}"]
    lines += ["License: Apache-2.0"]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, names in project.get("optional-dependencies", {}).items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {name} ; extra == "{extra}"' for name in names]
    readme = (ROOT / "bindings/python/README.md").read_text()
    return "\n".join([*lines, "Description-Content-Type: text/markdown", "", readme])


class _Wheel:
    """A zip of files with a list of their hashes."""

    def __init__(self, folder, project):
        self.stem = f"{project['name']}-{project['version']}"
        self.name = f"{self.stem}-{_tag()}.whl"
        self.zip = zipfile.ZipFile(Path(folder) / self.name, "w", zipfile.ZIP_DEFLATED)
        self.record = []

    def add(self, name, data):
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        self.record.append(f"{name},sha256={digest},{len(data)}")
        self._write(name, data)

    def _write(self, name, data):
        entry = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))  # the same bytes from the same files
        entry.external_attr = 0o644 << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        self.zip.writestr(entry, data)

    def close(self, project):
        info = f"{self.stem}.dist-info"
        self.add(f"{info}/METADATA", _metadata(project).encode())
        self.add(f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes())
        wheel = f"Wheel-Version: 1.0\nGenerator: isochor\nRoot-Is-Purelib: false\nTag: {_tag()}\n"
        self.add(f"{info}/WHEEL", wheel.encode())
        self.record.append(f"{info}/RECORD,,")
        self._write(f"{info}/RECORD", ("\n".join(self.record) + "\n").encode())
        self.zip.close()
        return self.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    del config_settings, metadata_directory
    project, built = _project(), _compile()
    wheel = _Wheel(wheel_directory, project)
    for file in sorted(built.rglob("*")):
        if file.is_file() and "__pycache__" not in file.parts:
            wheel.add(f"{PACKAGE}/{file.relative_to(built)}", file.read_bytes())
    # What the scenes of the library are made of; from the source tree they are found without.
    for file in sorted((ROOT / "scenes" / "meshes").iterdir()):
        if file.suffix != ".md":
            wheel.add(f"{PACKAGE}/scenes/meshes/{file.name}", file.read_bytes())
    return wheel.close(project)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """A wheel that points to the built folder: what `cmake --build` makes is what is imported."""
    del config_settings, metadata_directory
    project, built = _project(), _compile()
    wheel = _Wheel(wheel_directory, project)
    wheel.add(f"__editable__.{PACKAGE}.pth", f"{built.parent}\n".encode())
    return wheel.close(project)


def build_sdist(sdist_directory, config_settings=None):
    """The files that git knows."""
    del config_settings
    project = _project()
    stem = f"{project['name']}-{project['version']}"
    archive = Path(sdist_directory) / f"{stem}.tar.gz"
    with tempfile.TemporaryDirectory() as folder:
        info = Path(folder) / "PKG-INFO"
        info.write_text(_metadata(project))
        subprocess.run(
            ["git", "-C", str(ROOT), "archive", f"--prefix={stem}/", f"--add-file={info}", "-o", str(archive), "HEAD"],
            check=True,
        )
    return archive.name
