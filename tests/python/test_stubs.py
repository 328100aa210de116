"""Stubs, signatures and docstrings say what the table of keys says."""

import ast
import inspect
import subprocess
import sys

import pytest

import isochor as iso
from isochor import effects, keys, materials
from conftest import SOURCE

PACKAGE = SOURCE / "bindings" / "python" / "isochor"


def test_committed_stubs_are_current():
    script = SOURCE / "bindings" / "python" / "make_stubs.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "current\n"


def parameters_in(stub):
    tree = ast.parse((PACKAGE / stub).read_text())
    return {f.name: [a.arg for a in f.args.args + f.args.kwonlyargs] for f in tree.body if isinstance(f, ast.FunctionDef)}


@pytest.mark.parametrize("stub, module", [("effects.pyi", effects), ("materials.pyi", materials)])
def test_stubs_have_the_parameters_of_the_functions(stub, module):
    found = parameters_in(stub)
    made = [name for name in module.__all__ if name[0].islower()]
    assert len(made) > 10
    for name in made:
        assert found[name] == list(inspect.signature(getattr(module, name)).parameters), name


def test_every_key_of_an_effect_is_an_argument():
    for kind, list_name in keys.effect_types().items():
        arguments = {key.name for key, _ in effects.arguments(kind)}
        for key in keys.objects()[kind].keys:
            assert key.name in arguments or key.name == "body" or key.type == "selection", (kind, key.name)
        doc = getattr(iso, kind).__doc__
        for key, _ in effects.arguments(kind):
            assert f"\n{key.python_name}:\n" in doc
            assert key.unit == "" or f"[{key.unit}]" in doc
        assert list_name


def test_every_key_of_a_material_belongs_to_a_law():
    known = {key.name for law in materials.laws() for key in materials.arguments(law)}
    assert known | {"law"} == {key.name for key in keys.objects()["material"].keys}


def test_docstrings_have_units_and_defaults():
    assert "[Pa]" in iso.cavity.__doc__ and '"pressure"' in iso.cavity.__doc__
    assert "(default: 101325)" in iso.cavity.__doc__ and "(default: 1000)" in iso.neo_hookean.__doc__


def public_things():
    for name in iso.__all__:
        thing = getattr(iso, name)
        yield name, thing
        if inspect.isclass(thing) and thing.__module__.startswith("isochor") and not issubclass(thing, tuple):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
                    yield f"{name}.{member}", value


# What says all by its name and type.
PLAIN = {"name", "kind", "world", "materials", "regions", "bodies", "effects", "law", "converged", "title", "shape"}
PLAIN |= {"dtype", "contains", "threads", "columns", "potential", "total"}


def test_everything_public_has_a_docstring():
    without = [n for n, thing in public_things() if not inspect.getdoc(thing) and n.split(".")[-1] not in PLAIN]
    assert without == []


def test_options_of_worlds_are_keys_of_the_analysis():
    world = iso.World(**{k.name: k.default for k in keys.objects()["analysis"].keys if k.name in ("sweeps", "time_error")})
    assert world.time == 0
    words = next(k.words for k in keys.objects()["analysis"].keys if k.name == "scheme")
    for scheme in (*words, "statics", "continuation"):
        assert iso.World(scheme=scheme).bodies == ()
        assert f'"{scheme}"' in iso.World.__doc__
