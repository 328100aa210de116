"""One case by dolfinx: Taylor-Hood (P2-P1) at nu = 0.5, Newton's method, LDL^T by MUMPS. Seconds are of the processor,
from the first assembly on: reading, compiling of forms and renumbering are not counted. The quadrature is exact to
degree 4, the least with which answers agree to 1e-9; Isochor has one of degree 5."""
import logging
import sys
import time

import case as cases
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc as fp
from mpi4py import MPI
from petsc4py import PETSc

logging.disable(logging.INFO)
case = cases.make(sys.argv[1], "--quick" in sys.argv)
kind = sys.argv[2] if len(sys.argv) > 2 and not sys.argv[2].startswith("-") else "cholesky"
element = ufl.VectorElement("Lagrange", ufl.tetrahedron, 1)
mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, case.tets.astype(np.int64), case.points, ufl.Mesh(element))
jit = {"cffi_extra_compile_args": ["-O3", "-march=native"]}

# Triangles of the case, by the numbers that its nodes have there.
mesh.topology.create_connectivity(2, 3)
mesh.topology.create_connectivity(2, 0)
boundary = dolfinx.mesh.exterior_facet_indices(mesh.topology)
numbers = np.array(mesh.geometry.input_global_indices)
corners = numbers[dolfinx.cpp.mesh.entities_to_geometry(mesh._mesh, 2, boundary, False)]
by_corners = {tuple(sorted(c)): f for c, f in zip(corners, boundary)}
facets = lambda triangles: np.array([by_corners[tuple(sorted(t))] for t in triangles], dtype=np.int32)
held, loaded = facets(case.held), np.unique(facets(case.loaded))
tags = dolfinx.mesh.meshtags(mesh, 2, loaded, np.full(len(loaded), 2, dtype=np.int32))

space = fem.FunctionSpace(mesh, ufl.MixedElement([ufl.VectorElement("Lagrange", mesh.ufl_cell(), 2),
                                                  ufl.FiniteElement("Lagrange", mesh.ufl_cell(), 1)]))
constants = fem.FunctionSpace(mesh, ("DG", 0))
mu = fem.Function(constants)
mu.x.array[:] = case.mu[mesh.topology.original_cell_index]
displacements, dofs_of_u = space.sub(0).collapse()
zero = fem.Function(displacements)
clamp = fem.dirichletbc(zero, fem.locate_dofs_topological((space.sub(0), displacements), 2, held), space.sub(0))

w = fem.Function(space)
u, p = ufl.split(w)
dx = ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 4})
ds = ufl.Measure("ds", domain=mesh, subdomain_data=tags, metadata={"quadrature_degree": 4})
F = ufl.Identity(3) + ufl.grad(u)
J = ufl.det(F)
amount = fem.Constant(mesh, PETSc.ScalarType(0))
energy = (mu / 2 * (ufl.inner(F, F) - 3) - mu * ufl.ln(J) - p * (J - 1)) * dx
residual = ufl.derivative(energy, w)
test = ufl.TestFunction(space)
v = ufl.split(test)[0]
if "gravity" in case.load:
    force = fem.Constant(mesh, PETSc.ScalarType(tuple(case.load["density"] * g for g in case.load["gravity"])))
    residual -= amount * ufl.inner(force, v) * dx
elif "traction" in case.load:
    force = fem.Constant(mesh, PETSc.ScalarType(tuple(case.load["traction"])))
    residual -= amount * ufl.inner(force, v) * ds(2)
else:
    normal = ufl.FacetNormal(mesh)
    residual += amount * case.load["pressure"] * ufl.inner(J * ufl.inv(F).T * normal, v) * ds(2)
r_form, k_form = fem.form(residual, jit_params=jit), fem.form(ufl.derivative(residual, w), jit_params=jit)
matrix, right = fp.create_matrix(k_form), fp.create_vector(r_form)


def solve(steps):
    solver = PETSc.KSP().create(MPI.COMM_SELF)
    solver.setType("preonly")
    solver.getPC().setType(kind)
    solver.getPC().setFactorSolverType("mumps")
    solver.setOperators(matrix)
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, kind == "cholesky")
    w.x.array[:] = 0
    iterations, begin = 0, time.process_time()
    for step in range(1, steps + 1):
        amount.value = step / steps
        first = None
        for _ in range(25):
            with right.localForm() as local:
                local.set(0)
            fp.assemble_vector(right, r_form)
            fem.set_bc(right, [clamp], w.vector, -1.0)
            size = right.norm()
            first = first or size
            if not np.isfinite(size) or size > 1e6 * first:
                return None
            if size < (1e-9 if step == steps else 1e-4) * first:
                break
            matrix.zeroEntries()
            fp.assemble_matrix(matrix, k_form, bcs=[clamp])
            matrix.assemble()
            change = right.copy()
            solver.solve(right, change)
            if solver.getConvergedReason() < 0:
                return None
            w.vector.axpy(-1, change)
            w.x.scatter_forward()
            iterations += 1
        else:
            return None
    return time.process_time() - begin, iterations


found, steps = cases.ways(case, solve)
if found is None:
    sys.exit("dolfinx: %s did not converge in %d steps" % (case.name, steps))
node = fem.locate_dofs_geometrical(
    displacements, lambda x: np.isclose(np.abs(x - case.points[case.probe][:, None]).max(axis=0), 0))
end = case.points[case.probe] + w.x.array[np.array(dofs_of_u)].reshape(-1, 3)[node[0]]
cases.report(case, "dolfinx", found[0], steps, found[1], right.getSize(), end)
