"""Meshes: from arrays, files, meshio and generators."""

from __future__ import annotations

import os
from typing import Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _isochor
from .errors import Error
from .reports import Finding, MeshReport

_MESHIO_CELLS = {"tetra": "tet4", "tetra10": "tet10", "hexahedron": "hex8"}
_MESHIO_FACES = {"tet4": "triangle", "tet10": "triangle6", "hex8": "quad", "tri3": "triangle"}


class Mesh:
    """A mesh at rest, of a solid or of a thin body.

    Parameters
    ----------
    points:
        Rest positions [m], shape (n, 3).
    cells:
        Nodes of each cell, shape (m, 4), (m, 10) or (m, 8) for tet4, tet10 and hex8, in the order of VTK;
        (m, 3) for tri3, the triangles of a thin body.
    cell_region:
        Index into ``regions``, shape (m,); None: all cells are in the first.
    regions:
        Names of regions; empty: the one region "body".
    surfaces:
        Faces by name, each of shape (f, 3), (f, 6), (f, 4) or (f, 3) for tet4, tet10, hex8 and tri3.
    node_sets:
        Nodes by name, each of shape (k,).
    fields:
        Values at nodes by name, of shape (n,) or (n, c).

    Arrays are copied in. Those that the properties return are read-only views of the mesh.
    Raises :class:`isochor.Error` for wrong shapes, types, indices, and numbers that are not finite.
    """

    def __init__(
        self,
        points: ArrayLike,
        cells: ArrayLike,
        *,
        cell_region: ArrayLike | None = None,
        regions: Sequence[str] = (),
        surfaces: Mapping[str, ArrayLike] | None = None,
        node_sets: Mapping[str, ArrayLike] | None = None,
        fields: Mapping[str, ArrayLike] | None = None,
        source: str = "",
    ) -> None:
        self._core = _isochor.Mesh(
            points,
            cells,
            cell_region,
            list(regions),
            dict(surfaces or {}),
            dict(node_sets or {}),
            dict(fields or {}),
            source,
        )

    @classmethod
    def _of(cls, core: Any) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._core = core
        return mesh

    @property
    def points(self) -> np.ndarray:
        """Rest positions [m], shape (n, 3)."""
        return self._core.points

    @property
    def cells(self) -> np.ndarray:
        """Nodes of each cell, shape (m, 4), (m, 10), (m, 8) or (m, 3)."""
        return self._core.cells

    @property
    def cell_region(self) -> np.ndarray:
        """Index into ``regions`` of each cell, shape (m,)."""
        stored = self._core.cell_region
        return np.zeros(len(self.cells), np.int32) if stored is None else stored

    @property
    def cell_type(self) -> str:
        """``tet4``, ``tet10``, ``hex8`` or ``tri3``."""
        return self._core.cell_type

    @property
    def regions(self) -> list[str]:
        return self._core.regions

    @property
    def surfaces(self) -> dict[str, np.ndarray]:
        """Faces by name, each of shape (f, nodes of a face)."""
        return self._core.surfaces

    @property
    def node_sets(self) -> dict[str, np.ndarray]:
        """Nodes by name, each of shape (k,)."""
        return self._core.node_sets

    @property
    def fields(self) -> dict[str, np.ndarray]:
        """Values at nodes by name, of shape (n,) or (n, c)."""
        return self._core.fields

    @property
    def notes(self) -> list[str]:
        """What a reader changed or left out on the way in, one sentence each."""
        return [message for _, message in self._core.notes]

    def check(self) -> MeshReport:
        """Looks for what would make the mesh unusable or slow."""
        found = self._core.check()
        found["findings"] = tuple(Finding(**finding) for finding in found["findings"])
        return MeshReport(**found)

    def to_meshio(self) -> Any:
        """The mesh as a ``meshio.Mesh``: cells with their region, surfaces as blocks of faces.

        Regions and surfaces have numbers in the cell data "gmsh:physical", whose names are in ``field_data``.
        """
        import meshio

        words = {**_MESHIO_CELLS, "triangle": "tri3"}
        volume_type = next(key for key, word in words.items() if word == self.cell_type)
        blocks = [(volume_type, np.array(self.cells))]
        numbers = [np.array(self.cell_region) + 1]
        field_data = {name: np.array([k + 1, 3]) for k, name in enumerate(self.regions)}
        for k, (name, faces) in enumerate(self.surfaces.items()):
            number = len(self.regions) + 1 + k
            blocks.append((_MESHIO_FACES[self.cell_type], np.array(faces)))
            numbers.append(np.full(len(faces), number, np.int32))
            field_data[name] = np.array([number, 2])
        return meshio.Mesh(
            np.array(self.points),
            blocks,
            point_data={name: np.array(values) for name, values in self.fields.items()},
            point_sets={name: np.array(nodes) for name, nodes in self.node_sets.items()},
            cell_data={"gmsh:physical": numbers},
            field_data=field_data,
        )

    @classmethod
    def from_meshio(cls, mesh: Any, scale: float = 1.0) -> Mesh:
        """The tetrahedra or hexahedra of a ``meshio.Mesh``.

        Groups of Gmsh (the cell data "gmsh:physical" with names in ``field_data``) become regions and surfaces,
        ``cell_sets`` of faces surfaces, ``point_sets`` node sets and point data fields. ``scale`` multiplies the
        coordinates: 1e-3 for millimeters.
        """
        found = [k for k, block in enumerate(mesh.cells) if block.type in _MESHIO_CELLS]
        kinds = sorted({mesh.cells[k].type for k in found})
        if len(kinds) != 1:
            present = ", ".join(sorted({block.type for block in mesh.cells})) or "none"
            raise Error(
                f"Mesh.from_meshio: the mesh has cells of type {present}; give one with cells of exactly one of "
                "tetra, tetra10 and hexahedron"
            )
        cell_type = _MESHIO_CELLS[kinds[0]]
        groups = _groups(mesh)
        cells = np.concatenate([mesh.cells[k].data for k in found])
        regions: list[str] = []
        cell_region = np.zeros(len(cells), int)
        first = 0
        for k in found:
            for name, members in groups[k].items():
                if name not in regions:
                    regions.append(name)
                cell_region[first + members] = regions.index(name)
            first += len(mesh.cells[k].data)
        surfaces: dict[str, list[np.ndarray]] = {}
        for k, block in enumerate(mesh.cells):
            if block.type == _MESHIO_FACES[cell_type]:
                for name, members in groups[k].items():
                    surfaces.setdefault(name, []).append(block.data[members])
        points = np.zeros((len(mesh.points), 3))
        points[:, : mesh.points.shape[1]] = mesh.points
        return cls(
            scale * points,
            cells,
            cell_region=cell_region,
            regions=regions,
            surfaces={name: np.concatenate(faces) for name, faces in surfaces.items()},
            node_sets={
                name: np.asarray(nodes, int)
                for name, nodes in mesh.point_sets.items()
                if not name.startswith("gmsh:")
            },
            fields={
                name: np.asarray(values, float)
                for name, values in mesh.point_data.items()
                if not name.startswith("gmsh:")
            },
        )

    def __repr__(self) -> str:
        return f"<isochor.Mesh {self.cell_type}: {len(self.points)} nodes, {len(self.cells)} cells>"

    def __getstate__(self) -> dict[str, Any]:
        return {
            "points": np.array(self.points),
            "cells": np.array(self.cells),
            "cell_region": np.array(self.cell_region),
            "regions": self.regions,
            "surfaces": {name: np.array(faces) for name, faces in self.surfaces.items()},
            "node_sets": {name: np.array(nodes) for name, nodes in self.node_sets.items()},
            "fields": {name: np.array(values) for name, values in self.fields.items()},
            "source": self._core.source,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]


def _groups(mesh: Any) -> list[dict[str, np.ndarray]]:
    """Cells of each block of a ``meshio.Mesh`` by the names of the groups that they are in.

    Groups of Gmsh are there twice, as numbers and as cell sets; other programs have one of the two.
    """
    out: list[dict[str, np.ndarray]] = [{} for _ in mesh.cells]
    dimensions = {"triangle": 2, "triangle6": 2, "quad": 2}
    names = {(int(number), int(dim)): name for name, (number, dim) in mesh.field_data.items()}
    for k, numbers in enumerate(mesh.cell_data.get("gmsh:physical", ())):
        dim = dimensions.get(mesh.cells[k].type, 3)
        for number in np.unique(numbers):
            out[k][names.get((int(number), dim), str(number))] = np.flatnonzero(numbers == number)
    for name, members in mesh.cell_sets.items():
        for k, chosen in enumerate(members):
            if not name.startswith("gmsh:") and chosen is not None and len(chosen) > 0:
                out[k].setdefault(name, np.asarray(chosen, int))
    return out


def read_mesh(path: str | os.PathLike[str], *, scale: float = 1.0, triangles: bool = False) -> Mesh:
    """Reads Gmsh, VTK, VTU, TetGen, Medit or Abaqus.

    ``scale`` multiplies the coordinates: 1e-3 for a file in millimeters. ``triangles``: those of the file are
    the cells, for a thin body (also of Wavefront and STL files).
    Raises :class:`isochor.Error` with what is wrong and where in the file.
    """
    return Mesh._of(_isochor.read_mesh(os.fspath(path), float(scale), bool(triangles)))


def box_mesh(
    lower: ArrayLike = (0.0, 0.0, 0.0),
    upper: ArrayLike = (1.0, 1.0, 1.0),
    *,
    divisions: Sequence[int] = (1, 1, 1),
    cell_type: str = "tet4",
) -> Mesh:
    """A box of cells between two corners [m], with surfaces x0, x1, y0, y1, z0 and z1.

    ``divisions`` are cells a side (six tets each); ``cell_type`` is "tet4", "tet10" or "hex8", or
    "tri3" for a sheet that is flat along one axis.
    """
    return Mesh._of(_isochor.box_mesh(lower, upper, divisions, cell_type))
