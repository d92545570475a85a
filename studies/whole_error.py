"""The whole error of one number over the CPU time of each way to it: linear solvers, increments, exact path, refined meshes.

    python3 studies/whole_error.py target/release/stickslip doc/method/error-vs-time/whole [NAME]

writes a picture of each scene, and its rows into `whole.csv`, which keeps those of other scenes. Uniform meshes are those
of the scene, refined ones of triangles, or of tetrahedra of second order; those of the bracket are of first order. The truth is a refined mesh with a smaller error than those of the table, in the plane by the exact path. Bodies in space have
no exact path. The bracket needs Gmsh.
"""

import csv
import os
import sys
import tempfile

from refinement import BRACKET, COLOURS, meshes_of_gmsh, picture, run, values

# Seconds after which a run is left.
LIMIT = 150

TRIANGLES, TETRAHEDRA = ["mesh.cells=triangle"], ["mesh.cells=tetrahedron10"]


def square(form, numbers):
    return [[f"mesh.elements={form.format(n)}"] for n in numbers]


# Scene, uniform meshes from coarse to fine (the first is refined), cells of refined meshes, the key of their error, its values,
# that of the truth, quantity, increments.
CASES = [
    dict(name="block", scene="data/scenes/block.toml", meshes=square("[{0},{0}]", (10, 20, 40, 80, 160)), cells=TRIANGLES,
         refine=[0.2, 0.1, 0.05, 0.025], truth=0.01, quantity="friction_work", increments=(10, 20, 40, 80, 160)),
    dict(name="punch", scene="data/tutorials/punch.toml",
         meshes=[[f"mesh.elements=[[{3 * k},{4 * k},{4 * k}],{4 * k}]"] for k in (1, 2, 4, 8, 16)], cells=TRIANGLES,
         refine=[0.2, 0.1, 0.05, 0.025], truth=0.01, quantity="force", increments=(5, 10, 20, 40, 80)),
    dict(name="strip", scene="data/scenes/strip.toml", meshes=square("[{0},4]", (75, 150, 300, 600)), cells=TRIANGLES,
         refine=[0.2, 0.1, 0.05, 0.025], truth=0.01, quantity="friction_work", increments=(15, 30, 60, 120)),
    dict(name="cube", scene="data/scenes/cube.toml", meshes=square("[{0},{0},{0}]", (4, 8, 12, 16)),
         cells=TETRAHEDRA, refine=[0.1, 0.07, 0.05], truth=0.035, quantity="friction_work",
         increments=(4, 10, 20, 40)),
    dict(name="fretting", scene="data/tutorials/fretting.toml", cells=["body.mesh.cells=triangle"], key="body.mesh.refine",
         meshes=[[f"body.mesh.elements=[[{3 * k},{20 * k},{3 * k}],{3 * k}]"] for k in (1, 2, 4, 8)],
         refine=[0.2, 0.1, 0.05], truth=0.02, quantity="friction_work", increments=(12, 30, 60, 120, 240)),
    dict(name="bracket", scene=BRACKET, gmsh=[6, 4, 3, 2], cells=[], refine=[0.5, 0.4, 0.3, 0.25], truth=0.18,
         quantity="force", increments=(2, 4, 8, 16)),
]


def study(program, case, folder):
    """The rows of a case: scene, way, run, CPU seconds, quantity, value, error. Draws its picture."""
    key, plane = case.get("key", "mesh.refine"), case["cells"] not in ([], TETRAHEDRA)
    with tempfile.TemporaryDirectory() as temporary:
        meshes = case.get("meshes") or meshes_of_gmsh(case, temporary)
        method, most = (["--method", "events"], []) if plane else ([], [f"time.increments={case['increments'][-1]}"])
        refined = lambda error: [*meshes[0], *case["cells"], f"{key}={error}", *most]
        ways = [(f"BN, {linear}", [], [[*mesh, f"solver.linear={linear}"] for mesh in meshes])
                for linear in ("umfpack", "partial", "condensed")]
        ways.append(("BN, increments", [], [[*meshes[-2], f"time.increments={number}"] for number in case["increments"]]))
        if plane:
            ways.append(("exact path", method, meshes))
        ways.append(("refined, " + ("exact path" if plane else "BN"), method, [refined(error) for error in case["refine"]]))
        automatic = ["solver.linear=auto"]
        report, seconds = run(program, "run", case["scene"], [*automatic, *refined(case["truth"])], method)
        truth = values(report)[case["quantity"]]
        print(f"{case['name']}: truth {case['quantity']} {truth}, {seconds:.1f} s", flush=True)
        rows, series = [], []
        for (way, options, runs), colour in zip(ways, COLOURS):
            points = []
            for overrides in runs:
                report, seconds = run(program, "run", case["scene"], [*automatic, *overrides], options, LIMIT)
                value = report and values(report).get(case["quantity"])
                name = " ".join(os.path.basename(word) for word in overrides)
                if value is None:
                    print(f"{case['name']}, {way}, {name}: " + ("no value" if report else f"left after {LIMIT} s"))
                    continue
                rows.append([case["name"], way, name, seconds, case["quantity"], value, abs(value / truth - 1)])
                print(*rows[-1], sep=", ", flush=True)
                points.append((seconds, rows[-1][-1]))
            series.append((way, colour, way.startswith("BN, ") and way != "BN, increments", points))
    with open(os.path.join(folder, case["name"] + ".svg"), "w") as file:
        file.write(picture(f"{case['name']}, {case['quantity'].replace('_', ' ')}", series))
    return rows


HEADS = ["scene", "way", "run", "cpu_seconds", "quantity", "value", "error"]


def main(program, folder, only=None):
    os.makedirs(folder, exist_ok=True)
    table, rows = os.path.join(folder, "whole.csv"), {}
    if os.path.exists(table):
        with open(table, newline="") as file:
            for row in list(csv.reader(file))[1:]:
                rows.setdefault(row[0], []).append(row)
    number = lambda x: f"{x:.4g}" if isinstance(x, float) else x
    for case in CASES:
        if only in (None, case["name"]):
            rows[case["name"]] = [[number(x) for x in row] for row in study(program, case, folder)]
    with open(table + ".new", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEADS, *(row for of_scene in rows.values() for row in of_scene)])
    os.replace(table + ".new", table)


if __name__ == "__main__":
    main(*sys.argv[1:])
