"""Isochor: soft, incompressible bodies.

    import isochor as iso
    world = iso.World(gravity=(0, -9.81, 0))
    finger = world.add_body(iso.read_mesh("finger.msh"), iso.neo_hookean(young=100e3, poisson=0.5, density=1070))
    world.add(iso.volume(finger))
    world.add(iso.dirichlet(finger, surfaces="clamped"))
    air = world.add(iso.cavity(finger, surfaces="chamber"))
    air.amount = 6000.0
    report = world.advance(1 / 60)

SI units throughout. docs/python.md starts from zero; keyword arguments of effects, materials and worlds are the keys
of docs/scenes.md.
"""

import os as _os
from pathlib import Path as _Path

# An installed package has the meshes of the library's scenes beside it.
if (_Path(__file__).parent / "scenes").is_dir():
    _os.environ.setdefault("ISOCHOR_SCENES", str(_Path(__file__).parent / "scenes"))

from . import _isochor
from . import effects as _effects
from . import materials as _materials
from .batch import WorldBatch
from .effects import *
from .environment import Box, Environment
from .errors import Cancelled, Error, NotConverged
from .gradients import Gradients, Output, Parameter
from .inverse import Constant, Design, Drive, Fits, LawFit, SceneFit, Target, design, drive, fit, fit_scene
from .materials import *
from .mesh import Mesh, box_mesh, read_mesh
from .reports import (
    BodyMeasures,
    ContactPair,
    Contacts,
    Energies,
    Fields,
    Finding,
    Gauge,
    MeshReport,
    Orientation,
    Progress,
    Reaction,
    Response,
    Size,
    StepReport,
    Volume,
)
from .scene import Metric, Run, Scene, Search, library
from .studies import Study, study
from .world import Body, LiveEffect, World

__version__ = _isochor.version()
__all__ = [
    *_effects.__all__,
    *_materials.__all__,
    "Body",
    "BodyMeasures",
    "Box",
    "Cancelled",
    "Constant",
    "ContactPair",
    "Contacts",
    "Design",
    "Drive",
    "Energies",
    "Environment",
    "Error",
    "Fields",
    "Finding",
    "Fits",
    "Gauge",
    "Gradients",
    "LawFit",
    "LiveEffect",
    "Mesh",
    "MeshReport",
    "Metric",
    "NotConverged",
    "Orientation",
    "Output",
    "Parameter",
    "Progress",
    "Reaction",
    "Response",
    "Run",
    "Scene",
    "SceneFit",
    "Search",
    "Size",
    "StepReport",
    "Study",
    "Target",
    "Volume",
    "World",
    "WorldBatch",
    "box_mesh",
    "design",
    "drive",
    "fit",
    "fit_scene",
    "library",
    "read_mesh",
    "study",
]
