from .errors import Error, NotConverged, Cancelled
from .mesh import Mesh, read_mesh, box_mesh
