"""An implicit coupling: a sliding pad warms up by friction, grows, and presses more where it is warm.

Each increment is solved again, from `save` by `restore`, until the temperatures of the contact nodes agree with the heat of friction:
a fixed point with Aitken's relaxation.
"""

import numpy as np

import stickslip as ss

speed, dt = 2.0, 0.5            # of the obstacle, m/s; an increment, s
capacity, loss = 2.5e4, 2e4     # of the warm layer, J/(m² K), W/(m² K)
growth = 1e-7                   # of its thickness, m/K


def main(increments: int = 10, tolerance: float = 1e-10) -> tuple[ss.Model, list[ss.Result], np.ndarray]:
    pad = ss.Scene.block([0.1, 0.02], [40, 8]).material(young=1e9, poisson=0.3).support("top", "x")
    pad = pad.contact("bottom", ss.builder.plane(gap=0.0), friction=0.4).load("top", traction=[0.0, -1e6])
    model = ss.Model(pad.time(end=increments * dt, increments=increments))
    problem, force, width = model.problem, model.history["force"][-1], model.problem.weight
    assert width is not None
    stepper, results = problem.stepper(gap=0.0), list[ss.Result]()
    warm, slip = np.zeros(problem.n_c), np.zeros((problem.n_c, 1))
    for k in range(1, increments + 1):
        before, guess, relaxation, last = stepper.save(), warm, 1.0, None
        for iteration in range(1, 51):
            result = stepper.step(force, t=k * dt, gap=-growth * guess, drift=speed * k * dt * np.ones(problem.n_c)).check()
            slid = problem.slip(result.u[0]) - slip - speed * dt
            heat = (result.p_t[0] * slid).sum(axis=1) / (dt * width)                  # W/m²
            residual = (capacity * warm / dt + heat) / (capacity / dt + loss) - guess
            if abs(residual).max() < tolerance * abs(guess).max():
                break
            stepper.restore(before)
            if last is not None:
                relaxation *= -(last @ (residual - last)) / ((residual - last) @ (residual - last))
            guess, last = guess + relaxation * residual, residual
        else:
            raise RuntimeError(f"increment {k}: no agreement in {iteration} iterations")
        warm, slip = guess, problem.slip(result.u[0])
        results.append(result)
        stress = result.p_n[0] / width
        print(f"t = {stepper.t:g} s: {iteration:2} iterations, at most {warm.max():.1f} K, pressure {stress.min():.3e} to {stress.max():.3e} Pa")
    return model, results, warm


if __name__ == "__main__":
    main()
