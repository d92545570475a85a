"""Quasi-static elastic contact with Coulomb friction: the exact law, and a judge that does not trust the solver.

SI units throughout; in two dimensions forces are per m of depth.

    result = stickslip.run("block.toml", {"contact.friction": 0.3})
    results = stickslip.sweep("block.toml", {"contact.friction": [0.3, 0.5]})
    study = stickslip.converge("block.toml", "peak", to=0.02)
    found = stickslip.capacity("joint.toml", load=1)
    result = stickslip.ContactProblem(K, C_n, C_t, mu=0.3).solve(force, gap=1e-5)
    errors = stickslip.measure(problem, force, u, p_n, p_t, gap=1e-5)
    table = stickslip.compare(model, {"mine": my_solver})
"""

from . import builder, exchange, mesh, newton, siconos
from ._capacity import Capacity, capacity
from ._cite import cite
from ._core import UMFPACK, VERSION as __version__, keep_freed_memory
from ._errors import AccuracyWarning, NotConvergedWarning, SceneError, StickslipError
from ._compare import Comparison, compare
from ._converge import Convergence, converge
from ._cycle import Cycle
from ._derivative import Derivative
from ._fields import Svg
from ._kinds import LAWS, OPEN, SLIP, STICK
from ._gone import refuse_old_names
from ._judge import Errors, Posed, Verdict, judge, measure
from ._many import Results
from ._options import LinearSolver
from ._problem import CondensedProblem, ContactProblem
from ._result import NotConverged, Result
from ._scene import Model, load, run
from ._stepper import Stepper, StepperState
from ._sweep import Sweep, sweep
from .builder import Scene

__all__ = [
    "LAWS", "OPEN", "SLIP", "STICK", "UMFPACK",
    "AccuracyWarning", "Capacity", "Comparison", "Convergence", "CondensedProblem", "ContactProblem", "Cycle", "Derivative", "Errors", "LinearSolver", "Model", "NotConverged",
    "NotConvergedWarning", "Posed", "Result", "Results", "Scene", "SceneError", "Stepper", "StepperState", "StickslipError",
    "Svg", "Sweep", "Verdict",
    "__version__", "builder", "capacity", "cite", "compare", "converge", "exchange", "judge", "keep_freed_memory", "load", "measure", "mesh",
    "newton", "run", "siconos", "sweep",
]

refuse_old_names()
del refuse_old_names
