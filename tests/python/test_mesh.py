"""Meshes: arrays in and out, files, meshio, the checker."""

import pickle

import numpy as np
import pytest

import isochor as iso
from conftest import MESHES, sentence

TET = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])


def test_a_mesh_from_arrays_gives_them_back():
    points, cells = np.array(TET[0], float), np.array(TET[1])
    mesh = iso.Mesh(
        points,
        cells,
        regions=["bone"],
        cell_region=[0],
        surfaces={"bottom": [[0, 1, 2]]},
        node_sets={"tip": [3]},
        fields={"paint": [0, 0.5, 1, 0.25], "arrow": np.arange(12.0).reshape(4, 3)},
    )
    assert np.array_equal(mesh.points, points) and mesh.points.dtype == np.float64
    assert np.array_equal(mesh.cells, cells) and mesh.cell_type == "tet4"
    assert mesh.regions == ["bone"] and list(mesh.cell_region) == [0]
    assert np.array_equal(mesh.surfaces["bottom"], [[0, 1, 2]])
    assert np.array_equal(mesh.node_sets["tip"], [3])
    assert mesh.fields["paint"].shape == (4,) and mesh.fields["arrow"].shape == (4, 3)
    assert mesh.check().volume == pytest.approx(1 / 6)


def test_arrays_out_are_views_that_cannot_be_written_and_outlive_the_mesh():
    mesh = iso.box_mesh(divisions=(2, 2, 2))
    points = mesh.points
    assert points.base is not None and not points.flags.writeable and not points.flags.owndata
    assert points.ctypes.data == mesh.points.ctypes.data
    with pytest.raises(ValueError):
        points[0, 0] = 1
    before = points.copy()
    del mesh
    assert np.array_equal(points, before)


@pytest.mark.parametrize("order", ["strided", "fortran", "float32", "int"])
def test_arrays_in_may_be_of_any_layout_and_real_type(order):
    points = np.array(TET[0], float)
    given = {
        "strided": np.repeat(points, 2, axis=0)[::2],
        "fortran": np.asfortranarray(points),
        "float32": points.astype(np.float32),
        "int": points.astype(int),
    }[order]
    cells = np.array(TET[1], dtype=np.uint16)
    assert np.array_equal(iso.Mesh(given, cells).points, points)


@pytest.mark.parametrize("kind", ["tet4", "tet10", "hex8"])
def test_meshio_there_and_back(kind):
    pytest.importorskip("meshio")
    mesh = iso.box_mesh(divisions=(2, 1, 1), cell_type=kind)
    back = iso.Mesh.from_meshio(mesh.to_meshio())
    assert np.array_equal(back.points, mesh.points) and np.array_equal(back.cells, mesh.cells)
    assert back.regions == mesh.regions and back.surfaces.keys() == mesh.surfaces.keys()
    for name, faces in mesh.surfaces.items():
        assert np.array_equal(back.surfaces[name], faces)
    millimeters = iso.Mesh.from_meshio(mesh.to_meshio(), scale=1e-3)
    assert np.allclose(millimeters.points, 1e-3 * mesh.points)


def test_meshio_reads_what_the_package_reads():
    meshio = pytest.importorskip("meshio")
    file = MESHES / "finger_small.msh"
    theirs, ours = iso.Mesh.from_meshio(meshio.read(file)), iso.read_mesh(file)
    assert len(theirs.cells) == len(ours.cells) and theirs.regions == ours.regions
    assert {n: len(f) for n, f in theirs.surfaces.items()} == {n: len(f) for n, f in ours.surfaces.items()}
    assert theirs.check().volume == pytest.approx(ours.check().volume)


def test_meshio_with_cell_sets_alone():
    meshio = pytest.importorskip("meshio")
    box = iso.box_mesh(divisions=(2, 1, 1))
    half = np.arange(6)
    sets = {"left": [half, []], "right": [half + 6, []], "floor": [[], np.arange(2)]}
    faces = box.surfaces["z0"]
    mesh = meshio.Mesh(np.array(box.points), [("tetra", np.array(box.cells)), ("triangle", faces)], cell_sets=sets)
    back = iso.Mesh.from_meshio(mesh)
    assert back.regions == ["left", "right"] and list(back.cell_region) == [0] * 6 + [1] * 6
    assert np.array_equal(back.surfaces["floor"], faces[:2])


def test_meshio_without_volume_cells_is_refused():
    meshio = pytest.importorskip("meshio")
    flat = meshio.Mesh(np.zeros((3, 3)), [("triangle", np.array([[0, 1, 2]]))])
    with pytest.raises(iso.Error) as error:
        iso.Mesh.from_meshio(flat)
    assert "cells of type triangle" in sentence(error)


def test_a_mesh_can_be_pickled():
    mesh = iso.read_mesh(MESHES / "finger_small.msh")
    back = pickle.loads(pickle.dumps(mesh))
    assert np.array_equal(back.points, mesh.points) and np.array_equal(back.cells, mesh.cells)
    assert back.regions == mesh.regions and np.array_equal(back.cell_region, mesh.cell_region)
    assert np.array_equal(back.surfaces["chamber"], mesh.surfaces["chamber"])


BAD = {
    "points of two numbers": (lambda: iso.Mesh([[0, 0]], TET[1]), "points: an array of shape (1, 2)"),
    "points in a row": (lambda: iso.Mesh([0.0, 1.0], TET[1]), "points: an array of shape (2,)"),
    "nan": (lambda: iso.Mesh([[0, 0, 0], [0, np.nan, 0]], TET[1]), "points: row 1 holds nan"),
    "text": (lambda: iso.Mesh([["a", "b", "c"]], TET[1]), "points: an array of type <U1"),
    "complex": (lambda: iso.Mesh([[1j, 0, 0]], TET[1]), "points: an array of type complex128"),
    "ragged": (lambda: iso.Mesh([[0, 0, 0], [1]], TET[1]), "points: "),
    "cells of five": (lambda: iso.Mesh(TET[0], [[0, 1, 2, 3, 0]]), "cells have 5 nodes each"),
    "cells in a row": (lambda: iso.Mesh(TET[0], [0, 1, 2, 3]), "cells have 1 dimensions"),
    "real cells": (lambda: iso.Mesh(TET[0], [[0, 1, 2, 3.0]]), "cells: an array of type float64"),
    "index out of range": (lambda: iso.Mesh(TET[0], [[0, 1, 2, 4]]), "cells: entry 3 is 4; give numbers from 0 to 3"),
    "negative index": (lambda: iso.Mesh(TET[0], [[0, 1, 2, -1]]), "cells: entry 3 is -1"),
    "huge index": (lambda: iso.Mesh(TET[0], [[0, 1, 2, 2**40]]), "cells: entry 3 is 1099511627776"),
    "regions": (lambda: iso.Mesh(*TET, cell_region=[0, 0]), "cell_region has 2 entries for 1 cells"),
    "region number": (lambda: iso.Mesh(*TET, cell_region=[1]), "cell_region: entry 0 is 1"),
    "surface": (lambda: iso.Mesh(*TET, surfaces={"s": [[0, 1]]}), 'surface "s": an array of shape (1, 2)'),
    "field": (lambda: iso.Mesh(*TET, fields={"f": [1, 2, 3]}), 'field "f" has 3 numbers for 4 nodes'),
    "file": (lambda: iso.read_mesh("nowhere.msh"), "nowhere.msh"),
    "divisions": (lambda: iso.box_mesh(divisions=(0, 1, 1)), "divisions"),
    "two divisions": (lambda: iso.box_mesh(divisions=(1, 1)), "divisions"),
    "cell type": (lambda: iso.box_mesh(cell_type="tet5"), 'cell_type is "tet5"'),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_meshes_get_one_sentence(case):
    call, words = BAD[case]
    with pytest.raises(iso.Error) as error:
        call()
    assert words in sentence(error)


def test_the_checker_says_what_is_wrong():
    flat = iso.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]])
    report = flat.check()
    assert not report.usable and any(f.severity == "error" and f.count == 1 for f in report.findings)
