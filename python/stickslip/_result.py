"""The result of a run."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _cycle, _plot
from ._errors import AccuracyWarning, NotConvergedWarning, StickslipError, in_python
from ._fields import Fields
from ._files import replaced
from ._kinds import LAWS, OPEN, SLIP, STICK
from ._linear import Checked
from ._options import path_of
from ._words import REASONS, counted, violation, warn

if TYPE_CHECKING:
    from ._matrices import Matrices
    from ._scene import Model

Array = NDArray[Any]

#: The kinds of warnings that cost time or memory and no accuracy.
_COSTS = ("slow-blas", "multigrid-gave-way", "ranks-apart")


@dataclass(frozen=True, eq=False, repr=False)
class Result(Fields):
    """A history; row k of every array is the end of increment k, the one that failed included.

    SI units; in two dimensions forces are per m of depth. m increments, n_u free displacements, n_c contact nodes, d tangents.

    Attributes
    ----------
    status : str
        The verdict, "converged" or the reason of the first increment that did not.
    reason : str
        Why the run ended early, in words, and what may help; empty if it converged.
    t : ndarray, shape (m,)
        Ends of the increments, s.
    p_n : ndarray, shape (m, n_c)
        Normal contact forces, N, positive in compression.
    p_t : ndarray, shape (m, n_c, d)
        Tangential contact forces of the body on the obstacle, N.
    contact : ndarray of uint8, shape (m, n_c)
        `OPEN`, `STICK` or `SLIP`.
    gap : ndarray, shape (m, n_c)
        Prescribed gaps, of the undeformed body, m; what is left of them is `opening`.
    mu : ndarray, shape (m, n_c)
        Friction coefficients.
    w_t_last : ndarray, shape (m, n_c, d)
        Tangential displacements before the increment, m; of its last part if it was halved.
    errors : ndarray, shape (m, 6)
        The independent error measure, relative, columns `LAWS`.
    kept : tuple of int
        The indices k of the increments whose `u`, `u_rest` and `force` are kept.
    u : ndarray, shape (len(kept), n_u)
        Free displacements, m.
    u_rest : ndarray, shape (len(kept), n_u)
        What rounding u leaves off, m; slender bodies need it.
    force : ndarray, shape (len(kept), n_u)
        External nodal forces, N.
    records : list of dict
        For each increment: iterations, parts, energies, seconds, ... ``friction_work`` is that of the increment alone, and
        ``strain_energy`` that at its end; of a `CondensedProblem` the one of the condensed body.
    iterations : recarray
        A row for each iteration: increment, iteration, theta, step, error.
    report : dict
        All that the program's ``--json`` says, in the units of the scene; empty for a problem of matrices.
    model : Model or None
        What was solved; None for a problem of matrices.

    Examples
    --------
    >>> import stickslip as ss
    >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
    >>> result.converged, result.p_n.shape, result.p_t.shape
    (True, (20, 21), (20, 21, 1))
    >>> result.error < 1e-10
    True
    """

    model: Model | None = field(default=None)

    @classmethod
    def _of(
        cls, raw: dict[str, Any], problem: Matrices, model: Model | None = None, *, reason: str = "",
        linear: object = None, drift: Sequence[Array | None] = (),
    ) -> Result:
        records: list[dict[str, Any]] = json.loads(raw["records"]) if isinstance(raw["records"], str) else raw["records"]
        report: dict[str, Any] = json.loads(raw.get("report", "{}"))

        of_nodes, of_body, d = (len(records), problem.n_c), (len(raw["kept"]), problem.n_u), problem.tangents

        def nodes(name: str) -> Array:
            values: Array = raw[name].reshape(of_nodes)
            return values

        def pair(first: str, second: str) -> Array:
            return np.stack([nodes(first), nodes(second)][:d], axis=-1) if d else np.zeros((*of_nodes, 0))

        nan = float("nan")
        errors = [[nan if r["kkt"][law] is None else r["kkt"][law] for law in LAWS] for r in records]
        table = raw["iterations"].reshape(-1, 5)
        kinds = [("increment", int), ("iteration", int), ("theta", float), ("step", float), ("error", float)]
        iterations = np.empty(len(table), dtype=kinds).view(np.recarray)
        for (name, _), column in zip(kinds, table.T):
            iterations[name] = column
        reason = in_python(report.get("reason", reason))
        reason = reason or REASONS.get(raw["status"], "")
        if isinstance(linear, Checked) and raw["status"] != "converged":
            reason = linear.blamed(reason)
        result = cls(
            status=raw["status"], reason=reason, t=np.array([r["time"] for r in records]),
            p_n=nodes("p_n"), p_t=pair("p_t", "p_o"), contact=nodes("contact"), gap=nodes("gap"), mu=nodes("mu"),
            w_t_last=pair("w_t_last", "w_o_last"), errors=np.array(errors).reshape(len(records), 6),
            kept=tuple(k - 1 for k in raw["kept"]), u=raw["u"].reshape(of_body), u_rest=raw["u_rest"].reshape(of_body),
            force=raw["force"].reshape(of_body),
            records=records, iterations=iterations, report=report, model=model,
        )
        if model is None:
            moved = [np.zeros(of_nodes) if rows is None else rows[: len(records)] for rows in drift[:d]]
            result.__dict__["_posed"] = problem, np.stack(moved, axis=-1) if moved else np.zeros((*of_nodes, d))
        return result

    def _told(self) -> Result:
        """Itself, once Python's warnings tell what was found."""
        for category, kind, message in self._found():
            warn(f"{kind}: {message}" if kind else message, category)
        return self

    def _found(self) -> list[tuple[type[UserWarning], str, str]]:
        """Category, kind and message of each of Python's warnings; the verdict has no kind."""
        found: list[tuple[type[UserWarning], str, str]] = []
        if not self.converged:
            found.append((NotConvergedWarning, "", self.message))
        accuracy = (warning for warning in self.warnings if warning["kind"] not in _COSTS)
        return found + [(AccuracyWarning, warning["kind"], warning["message"]) for warning in accuracy]

    @property
    def converged(self) -> bool:
        """True if every law holds within the tolerance in every increment, by the independent error measure, and the history is complete."""
        return self.status == "converged"

    @property
    def message(self) -> str:
        """The verdict in words: the status, and where it is not "converged" the increment, the law and the reason."""
        if self.converged:
            return self.status
        if not len(self.t):
            return f"{self.status} before the first increment" + (f": {self.reason}" if self.reason else "")
        last = self.errors[-1]
        law = LAWS[int(np.argmax(np.where(np.isnan(last), np.inf, last)))]
        at = f"in increment {len(self.t)} (t = {self.t[-1]:g} s): {violation(law, last.max())}"
        return f"{self.status} {at}" + (f"; {self.reason}" if self.reason else "")

    @property
    def nit(self) -> int:
        """The number of iterations of all increments."""
        return sum(record["iterations"] for record in self.records)

    @property
    def friction_work(self) -> float:
        """The friction work of all increments that converged, J; in the plane J per m of depth. A record has that of its increment.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3)
        >>> print(f"{problem.solve([[0.0, -100.0], [40.0, -100.0]]).friction_work:.2e} J")
        1.50e-04 J
        """
        return float(sum(record["friction_work"] for record in self.records if record["status"] == "converged"))

    def quantity(self, name: str) -> Any:
        """A number or a word of the report by its name, as in ``stickslip sweep --table`` and `converge`.

        Parameters
        ----------
        name : str
            "peak", "force", "tangential", "friction_work" or "stick_ratio"; a key of the report with one value, such as
            "largest_force.time"; "size:" and the key of a vector, for its length; or "max:", "min:" or "last:" of a boundary and a
            column of ``forces.csv``, such as "max:top.f_x".

        Returns
        -------
        float, int, str, bool or None
            SI, in the plane per m of depth; None if the run has no such value.

        Raises
        ------
        ValueError
            The scene has no such quantity; the message has those that are meant. Or there is no scene, but a problem of matrices.

        Examples
        --------
        >>> import stickslip as ss
        >>> result = ss.run(ss.Scene.example("block"), {"mesh.elements": [20, 10]})
        >>> round(result.quantity("last:bottom.sum_p_n")), result.quantity("largest_pressure.boundary")
        (10000, 'bottom')
        """
        if self.model is None:
            raise ValueError(f"name: a problem of matrices has no report, and so no {name}")
        return json.loads(self.model._core.quantity(name, self.report))

    @property
    def warnings(self) -> list[dict[str, str]]:
        """Doubts about the answer although every law holds.

        Returns
        -------
        list of dict
            Each with its ``kind``, a word, and its ``message`` with numbers and cure; empty for a problem of matrices. What makes
            numbers wrong was a Python warning, `AccuracyWarning`, when the run ended; what costs time alone is only here.
        """
        return [{**warning, "message": in_python(warning["message"])} for warning in self.report.get("warnings", [])]

    @property
    def error(self) -> float:
        """The largest error of all laws and increments; NaN if there is none or one is NaN."""
        return float(self.errors.max()) if self.errors.size else float("nan")

    def check(self) -> Result:
        """Itself, if it converged.

        Returns
        -------
        Result

        Raises
        ------
        NotConverged
            If it did not converge; the exception has the incomplete result.
        """
        if not self.converged:
            raise NotConverged(self.message, self)
        return self

    def cycle(self, start: float | None = None, end: float | None = None) -> _cycle.Cycle:
        """Friction work, slip path and pressure along it of each contact node in a part of the history, such as a load cycle.

        Friction forces at the end of an increment count for all of its slip, and a node slips in an increment if it does at its end.
        Increments that the run divided count as one: the program's ``cycle.csv`` has their parts.

        Parameters
        ----------
        start, end : float, optional
            Its times, s, ends of increments; the whole result without them.

        Returns
        -------
        Cycle

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> problem = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3, weight=1e-4)
        >>> cycle = problem.solve([[0.0, -100.0], [40.0, -100.0]]).cycle(0.5)
        >>> print(f"{cycle.friction_work[0]:.1e} J over {cycle.slip_path[0]:.0e} m")
        1.5e-04 J over 5e-06 m
        """
        return _cycle.of(self, start, end)

    def joined(self, *later: Result) -> Result:
        """This result and later increments of the same `Stepper` as one history.

        Parameters
        ----------
        *later : Result
            In order, each from the end of the one before; tries that did not converge are left out.

        Returns
        -------
        Result
            With the verdict of the last.

        Raises
        ------
        ValueError
            A result that does not continue the one before, such as one of `ContactProblem.solve`, which begins unloaded.

        Examples
        --------
        >>> import numpy as np, stickslip as ss
        >>> stepper = ss.ContactProblem(np.diag([2e6, 1e6]), [[0, -1]], [[1, 0]], mu=0.3).stepper()
        >>> first, *later = [stepper.step([push, -100.0]) for push in (0.0, 20.0, 40.0)]
        >>> first.joined(*later).p_t[:, 0, 0]
        array([ 0., 20., 30.])
        """
        parts = (self, *later)
        for before, part in zip(parts, later):
            if not isinstance(part, Result):
                raise TypeError(f"later: results expected, {type(part).__name__} found")
            if not before.converged:
                raise ValueError("later: only the last result may have ended early; leave out tries that did not converge")
            begun = part._begun
            if begun is None or before._posed is None or begun[0] != before.t[-1] or part._posed[0] is not before._posed[0]:
                raise ValueError("later: a result does not begin where the one before ended: increments of one Stepper are expected, in order")
        arrays: dict[str, Any] = {
            f.name: np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(self) if f.name not in _NOT_ARRAYS
        }
        tables, kept, records, count = [], [], [], 0
        for part in parts:
            table = part.iterations.copy()
            table["increment"] += count + 1 - part.records[0]["index"]
            tables.append(table)
            kept += [count + k for k in part.kept]
            records += [{**record, "index": count + k + 1} for k, record in enumerate(part.records)]
            count += len(part.t)
        whole = Result(
            status=parts[-1].status, reason=parts[-1].reason, kept=tuple(kept), records=records,
            iterations=np.concatenate(tables).view(np.recarray), report={}, model=self.model, **arrays,
        )
        if later:
            whole.__dict__["_posed"] = self._posed[0], np.concatenate([part._posed[1] for part in parts])
        whole.__dict__["_begun"] = self._begun
        return whole

    def _amount(self) -> str:
        return f"{counted(len(self.t), 'increment')}, {counted(self.nit, 'iteration')}"

    def __getstate__(self) -> dict[str, Any]:
        """Without what is computed again when it is asked for."""
        return {name: value for name, value in self.__dict__.items() if name != "_of_nodes"}

    def __repr__(self) -> str:
        head = f"<Result {self.message}; {self._amount()}, error {self.error:.1e}"
        if len(self.t):
            counts = {name: int((self.contact[-1] == code).sum()) for name, code in _CODES.items()}
            head += "; at the end " + ", ".join(f"{n} {name}" for name, n in counts.items())
        kinds = ", ".join(warning["kind"] for warning in self.warnings)
        return head + (f"; warnings: {kinds}>" if kinds else ">")

    def _repr_html_(self) -> str:
        colour = "#1a7f37" if self.converged else "#cf222e"
        rows = "".join(
            f"<tr><td>{law}</td><td style='text-align:right'>{error:.1e}</td></tr>"
            for law, error in zip(LAWS, self.errors.max(axis=0) if len(self.t) else [])
        )
        title = html.escape(self.model.title) if self.model is not None else "contact problem"
        verdict = html.escape(self.message)
        found = "".join(
            f"<li><b>{html.escape(warning['kind'])}</b>: {html.escape(warning['message'])}</li>" for warning in self.warnings
        )
        return (
            f"<div><b>{title}</b>: <b style='color:{colour}'>{verdict}</b>, {self._amount()}"
            f"<table><tr><th>law</th><th>largest error</th></tr>{rows}</table>"
            + (f"<p>Warnings:</p><ul>{found}</ul>" if found else "") + "</div>"
        )

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` with a row for each increment: the records, errors by law."""
        import pandas

        frame = pandas.json_normalize(self.records)
        return frame.rename(columns=lambda name: name.removeprefix("kkt.")).set_index("index")

    def to_xarray(self) -> Any:
        """An `xarray.Dataset` of what is known of the contact nodes, over increments, nodes and tangents."""
        import xarray

        nodes, tangents = ("t", "node"), ("t", "node", "tangent")
        data: dict[str, Any] = {name: (nodes, getattr(self, name)) for name in ("p_n", "contact", "gap", "mu")}
        data |= {name: (tangents, getattr(self, name)) for name in ("p_t", "w_t_last")}
        data["errors"] = (("t", "law"), self.errors)
        coordinates: dict[str, Any] = {"t": self.t, "law": list(LAWS)}
        if self.model is not None:
            points = self.model.contact_points
            coordinates |= {name: ("node", points[:, c]) for c, name in enumerate("xyz")}
        dataset = xarray.Dataset(data, coordinates, {"status": self.status})
        for name, unit in (("p_n", "N"), ("p_t", "N"), ("gap", "m"), ("w_t_last", "m")):
            dataset[name].attrs["units"] = unit
        return dataset

    # Pictures.

    def plot(self, k: int = -1, ax: Any = None) -> Any:
        """Contact stresses of increment k (forces where there are no weights), with statuses, by matplotlib.

        In the plane: along x, or along the boundaries where these go to and fro or lie above each other. In space: a map of the
        normal stress, each boundary seen along the axis of its least extent. Of a problem of matrices: by the number of the contact node.

        Parameters
        ----------
        k : int, optional
            The increment from 0; -1 is the last.
        ax : matplotlib.axes.Axes, optional
            Where to draw; new axes without it.

        Returns
        -------
        matplotlib.axes.Axes
        """
        return _plot.contact(self, k, ax)

    def plot_convergence(self, ax: Any = None) -> Any:
        """The error of every law over the increments, on a logarithmic scale, by matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; new axes without it.

        Returns
        -------
        matplotlib.axes.Axes
        """
        return _plot.convergence(self, ax)

    def plot_history(self, ax: Any = None) -> Any:
        """Sums of the contact forces over time, by matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; new axes without it.

        Returns
        -------
        matplotlib.axes.Axes
        """
        return _plot.history(self, ax)

    # Files.

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes all of it to an npz file: arrays, the scene, its mesh and the other files that it names.

        Parameters
        ----------
        path : str or os.PathLike
            The file; `numpy` adds ``.npz`` to a name without it.
        """
        path = path_of(path)
        if os.path.basename(path) in ("", ".", ".."):
            raise ValueError(f"path: {path!r} found, expected the name of a file")
        arrays = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in _NOT_ARRAYS}
        words: dict[str, Any] = {"status": self.status, "reason": self.reason, "records": self.records, "report": self.report}
        words["kept"] = list(self.kept)
        words["model"] = None
        if self.model is not None:
            words["model"], of_model = self.model._saved()
            arrays |= of_model
        arrays["iterations"] = np.asarray(self.iterations)
        with replaced(path if path.endswith(".npz") else f"{path}.npz") as file:
            np.savez_compressed(file, words=np.array(json.dumps(words)), **arrays)


class NotConverged(StickslipError, RuntimeError):
    """Raised by `Result.check`.

    Attributes
    ----------
    result : Result
        What was reached.
    """

    def __init__(self, message: str, result: Result) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> Any:
        return type(self), (self.args[0], self.result)


_CODES = {"open": OPEN, "stick": STICK, "slip": SLIP}
_NOT_ARRAYS = ("status", "reason", "records", "report", "kept", "model", "iterations")
