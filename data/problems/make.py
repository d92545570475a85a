"""Writes the HDF5 files beside it with h5py: the layouts that FCLIB's C library, h5repack and h5py leave."""

import h5py
import numpy as np
import scipy.sparse as sp

# Two unit masses on a line of springs in space, one on the floor, one on top of it: a local problem of two contacts.
B = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0],
              [-1, 0, 0, 1, 0, 0], [0, -1, 0, 0, 1, 0], [0, 0, -1, 0, 0, 1]]).T
MASS = np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0]) + 0.25 * np.ones((6, 6))
FORCE = np.array([-20.0, 3.0, 1.0, -10.0, 9.0, -2.0])
FREE = np.array([0.5, 0.0, 0.1, 0.0, 0.0, 0.0])
MU = np.array([0.5, 0.25])


def matrix(group, name, values, nz):
    g = group.create_group(name)
    a = {-1: sp.csc_array, -2: sp.csr_array, 0: sp.coo_array}[nz](values)
    p, i = (a.coords[1], a.coords[0]) if nz == 0 else (a.indptr, a.indices)
    for key, value in (("nzmax", a.nnz), ("m", a.shape[0]), ("n", a.shape[1]), ("nz", a.nnz if nz == 0 else nz)):
        g.create_dataset(key, data=np.array([value], dtype="<i4"))
    g.create_dataset("p", data=p.astype("<i4"))
    g.create_dataset("i", data=i.astype("<i4"))
    g.create_dataset("x", data=a.data)


def text(group, name, value):
    group.create_dataset(name, data=np.bytes_(value))


def problem(file, name, matrices, vectors, description):
    g = file.create_group(name)
    g.create_dataset("spacedim", data=np.array([3], dtype="<i4"))
    info = g.create_group("info")
    text(info, "title", b"Two masses")
    text(info, "description", description)
    text(info, "math_info", b"unique")
    for key, (values, nz) in matrices.items():
        matrix(g, key, values, nz)
    v = g.create_group("vectors")
    for key, value in vectors.items():
        v.create_dataset(key, data=value)


W = B.T @ np.linalg.solve(MASS, B)
Q = B.T @ np.linalg.solve(MASS, FORCE) + FREE
with h5py.File("local.hdf5", "w") as file:
    problem(file, "fclib_local", {"W": (W, -2)}, {"q": Q, "mu": MU}, b"A byte that is not UTF-8: \xb0")
    guesses = file.create_group("guesses")
    guesses.create_dataset("number_of_guesses", data=np.array([1], dtype="<i4"))
    first = guesses.create_group("1")
    first.create_dataset("r", data=np.array([30.0, 0, 0, 10, 0, 0]))
    first.create_dataset("u", data=W @ first["r"][:] + Q)
    # As the C library leaves a solution that nobody has written.
    unwritten = file.create_group("solution")
    unwritten.create_dataset("u", shape=(6,), dtype="<f8")
    unwritten.create_dataset("r", shape=(6,), dtype="<f8")

vectors = {"f": FORCE, "w": FREE, "mu": MU}
with h5py.File("global.hdf5", "w", libver="latest") as file:
    problem(file, "fclib_global", {"M": (MASS, 0), "H": (B, 0)}, vectors, b"The newest layout")

# The second mass glued to a wall along its last axis.
G = np.array([[0.0, 0, 0, 0, 0, 1]]).T
with h5py.File("constrained.hdf5", "w") as file:
    vectors = {**vectors, "b": np.array([-0.125])}
    problem(file, "fclib_global", {"M": (MASS, -1), "H": (B, -1), "G": (G, -1)}, vectors, b"With a constraint")

with h5py.File("packed.hdf5", "w") as file:
    problem(file, "fclib_local", {"W": (W, -1)}, {}, b"In compressed chunks")
    v = file["fclib_local/vectors"]
    v.create_dataset("q", data=Q.astype(">f8"), chunks=(4,), compression="gzip", shuffle=True, fletcher32=True)
    v.create_dataset("mu", data=MU.astype("<f4"), chunks=(1,), compression="gzip")
