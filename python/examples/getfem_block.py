"""The block of compare_solvers.ipynb by GetFEM, to see how much there is to write: `getfem_block.py [ELEMENTS] [INCREMENTS]`.

Debian's python3-getfem brings GetFEM. Young's modulus is the unit of stress, since the tolerance of its Newton iteration is absolute,
and the slip is from the last displacements where gamma is -1.
"""

import sys

import getfem as gf
import numpy as np


def solve(n: int, increments: int) -> float:
    young, poisson, friction, gap = 210e9, 0.3, 0.4, 1e-5
    line = np.linspace(0.0, 1.0, n + 1)
    mesh = gf.Mesh("cartesian", line, line)
    u = gf.MeshFem(mesh, 2)
    u.set_fem(gf.Fem("FEM_QK(2,1)"))
    rule = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))
    faces = mesh.outer_faces()
    normals = mesh.normal_of_faces(faces)
    left, right, bottom, top = range(1, 5)
    for region, normal in zip(range(1, 5), ([-1, 0], [1, 0], [0, -1], [0, 1])):
        mesh.set_region(region, faces[:, normals.T @ normal > 0.5])
    model = gf.Model("real")
    model.add_fem_variable("u", u)
    model.add_initialized_data("lambda", poisson / ((1 + poisson) * (1 - 2 * poisson)))
    model.add_initialized_data("mu", 1 / (2 * (1 + poisson)))
    model.add_isotropic_linearized_elasticity_brick(rule, "u", "lambda", "mu")
    model.add_Dirichlet_condition_with_multipliers(rule, "u", u, left)
    for name, region in (("top", top), ("right", right)):
        model.add_initialized_data(name, np.zeros(2))
        model.add_source_term_brick(rule, "u", name, region)
    held = set(u.basic_dof_on_region(left))
    dofs = np.array([dof for dof in u.basic_dof_on_region(bottom) if dof not in held]).reshape(-1, 2)
    m = len(dofs)
    normal, tangent = gf.Spmat("empty", m, u.nbdof()), gf.Spmat("empty", m, u.nbdof())
    for row, (x, y) in enumerate(dofs):
        normal.add(row, y, -1.0)
        tangent.add(row, x, 1.0)
    model.add_variable("p_n", m)
    model.add_variable("p_t", m)
    model.add_initialized_data("r", 1.0)
    model.add_initialized_data("friction", friction)
    model.add_initialized_data("gap", np.full(m, gap))
    model.add_initialized_data("alpha", np.ones(m))
    model.add_initialized_data("gamma", -1.0)
    model.add_fem_data("last", u)
    model.add_basic_contact_brick(
        "u", "p_n", "p_t", "r", normal, tangent, "friction", "gap", "alpha", 1, "gamma", "last"
    )
    for time in np.linspace(0.0, 2.0, increments + 1)[1:]:
        model.set_variable("top", np.array([0.0, -10e6 * min(time, 1.0) / young]))
        model.set_variable("right", np.array([10e6 * min(time, 2.0 - time) / young, 0.0]))
        model.solve("max_res", 1e-15, "max_iter", 100)
        model.set_variable("last", model.variable("u"))
    return -young * float(model.variable("p_n").sum())


if __name__ == "__main__":
    n, increments = (int(word) for word in sys.argv[1:] or ("20", "40"))
    print(f"sum p_n = {solve(n, increments):.9e} N")
