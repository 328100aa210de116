"""One case by GetFEM: P2-P1 at nu = 0.5, its own Newton's method with line search, MUMPS. Seconds are of the processor,
of all solves."""
import sys
import tempfile
import time

import case as cases
import getfem as gf
import numpy as np

gf.util_trace_level(0)
case = cases.make(sys.argv[1], "--quick" in sys.argv)
with tempfile.NamedTemporaryFile(suffix=".msh") as f:
    case.write_mesh(f.name)
    mesh = gf.Mesh("import", "gmsh", f.name)
u_space, p_space = gf.MeshFem(mesh, 3), gf.MeshFem(mesh, 1)
u_space.set_classical_fem(2)
p_space.set_classical_fem(1)
points = gf.MeshIm(mesh, gf.Integ("IM_TETRAHEDRON(5)"))


def solve(steps):
    model = gf.Model("real")
    model.add_fem_variable("u", u_space)
    model.add_fem_variable("p", p_space)
    model.add_initialized_data("amount", [0.0])
    for r in sorted(set(case.region)):
        model.add_initialized_data("mu%d" % r, [float(case.mu[np.flatnonzero(case.region == r)[0]])])
        model.add_nonlinear_term(points, "mu%d*((Id(3)+Grad_u):Grad_Test_u - Inv(Id(3)+Grad_u)':Grad_Test_u)" % r,
                                 int(11 + r))
    model.add_nonlinear_term(points, "-p*Det(Id(3)+Grad_u)*(Inv(Id(3)+Grad_u)':Grad_Test_u)"
                                     "-(Det(Id(3)+Grad_u)-1)*Test_p")
    if "gravity" in case.load:
        model.add_initialized_data("f", [case.load["density"] * g for g in case.load["gravity"]])
        model.add_nonlinear_term(points, "-amount*f.Test_u")
    elif "traction" in case.load:
        model.add_initialized_data("f", case.load["traction"])
        model.add_nonlinear_term(points, "-amount*f.Test_u", 2)
    else:
        model.add_initialized_data("f", [float(case.load["pressure"])])
        model.add_nonlinear_term(points, "amount*f*Det(Id(3)+Grad_u)*(Inv(Id(3)+Grad_u)'*Normal).Test_u", 2)
    model.add_Dirichlet_condition_with_simplification("u", 1)
    iterations, begin = 0, time.process_time()
    for step in range(1, steps + 1):
        model.set_variable("amount", [step / steps])
        last = step == steps
        count, ok = model.solve("max_res", 1e-9 if last else 1e-4, "max_iter", 25, "lsolver", "mumps")
        iterations += count
        if count >= 25 or not ok or not np.all(np.isfinite(model.variable("u"))):
            return None
    return time.process_time() - begin, iterations, model.variable("u")


found, steps = cases.ways(case, solve)
if found is None:
    sys.exit("GetFEM: %s did not converge in %d steps" % (case.name, steps))
where = u_space.basic_dof_nodes()
dofs = np.flatnonzero(np.all(np.isclose(where.T, case.points[case.probe]), axis=1))
end = case.points[case.probe] + found[2][dofs[:3]]
cases.report(case, "GetFEM", found[0], steps, found[1], u_space.nbdof() + p_space.nbdof(), end)
