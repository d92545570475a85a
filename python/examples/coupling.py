"""Single increments: a load that depends on the answer, here a spring that the block pushes against."""

import numpy as np

import stickslip as ss

block = ss.Scene.block([1.0, 1.0], [20, 20]).material(young=210e9, poisson=0.3).support("left", "x", "y")
block = block.contact("bottom", ss.builder.plane(gap=1e-5), friction=0.4).time(end=1.0, increments=10)
block = block.load("top", traction=[0.0, -10e6], history=[[0, 0], [1, 1]])

model = ss.Model(block)
problem, press = model.problem, model.history["force"]
shape = np.flatnonzero(press[-1])                       # where the load acts
stepper = problem.stepper(gap=1e-5)
spring, moved = 2e10, 0.0                               # N/m
for force in press:
    resisted = force.copy()
    resisted[shape] -= spring * moved / len(shape)
    result = stepper.step(resisted).check()
    moved = float(result.u[0, shape].mean())
    print(f"t = {stepper.t:g}: the top has moved by {1e6 * moved:.2f} µm, p_n = {result.p_n[0].sum():.4e} N/m")
print(f"{stepper.work['factorizations']} factorisations")
