"""A scene by the builder: an editor completes each call, and type checkers know all of it."""

import numpy as np

import stickslip as ss
from stickslip.builder import plane

scene = (
    ss.Scene.block([1.0, 1.0], [20, 20], title="Block on a floor")
    .material(young=210e9, poisson=0.3, plane="strain")
    .support("left", "x", "y")
    .contact("bottom", plane(gap=1e-5), friction=0.4)
    .load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])
    .time(end=1.0, increments=10)
    .solver("bn", "default")
)
result = ss.run(scene, {"contact[0].friction": 0.3}).check()
normal: float = float(result.p_n[-1].sum())
print(result)
print(f"{normal:.6e} N/m on the floor, nodes that slip: {np.count_nonzero(result.contact[-1] == ss.SLIP)}")
