"""Error against CPU time of uniform meshes and of meshes that refine themselves, and told against true uncertainty.

    python3 studies/refinement.py target/release/stickslip doc/method/refined-meshes/refinement.csv [NAME]

For each quantity, the truth is a run with `mesh.refine` at a quarter or less of the finest error of the table, or a number that
is known from elsewhere. CPU times of refined meshes contain all their coarser meshes; those of
uniform meshes are of one mesh alone. The bracket needs Gmsh.
Beside the table there is a picture of each scene.
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile

CYLINDER = """
title = "Cylinder on a block"
mesh = { kind = "block", size = [1, 1], elements = [8, 8], cells = "triangle" }
material = { young = 210e9, poisson = 0.3, plane = "strain" }
support = [{ boundary = "bottom", fix = ["x", "y"] }]
[[contact]]
boundary = "top"
friction = 0.3
[contact.obstacle]
kind = "cylinder"
radius = 10
apex = [0.5, 1]
normal = [0, 1]
tangent = [1, 0]
approach = [[0, 0], [1, 1e-4]]
motion.translation = [[1, 0, 0], [2, 2.2e-5, 0]]
[time]
end = 2
increments = 8
[output]
times = [1, 2]
"""

# Two plates of 10 mm, lapped over 40 mm, drawn together by a bolt and pulled.
LAP = """
title = "Lap joint"
units = { length = "mm", stress = "MPa" }
[[body]]
name = "lower"
mesh = { kind = "block", size = [[60, 13, 14, 13], 10], elements = [[12, 3, 3, 3], 2], cells = "triangle" }
material = { young = 210e3, poisson = 0.3 }
[[body]]
name = "upper"
at = [60, 10]
mesh = { kind = "block", size = [[13, 14, 13, 60], 10], elements = [[3, 3, 3, 12], 2], cells = "triangle" }
material = { young = 210e3, poisson = 0.3 }
[[support]]
boundary = "lower:left"
fix = ["x", "y"]
[[support]]
boundary = "upper:right"
fix = ["x", "y"]
displacement = [0.06, 0]
history = [[1, 0], [2, 1]]
[[load]]
boundary = "upper:top"
traction = ["0", "-60 * exp(-((x - 80) / 5)^2)"]
history = [[0, 0], [1, 1]]
[[load]]
boundary = "lower:bottom"
traction = ["0", "60 * exp(-((x - 80) / 5)^2)"]
history = [[0, 0], [1, 1]]
[[contact]]
boundary = "upper:bottom"
against = "lower:top"
friction = 0.2
[time]
end = 2
increments = 8
[output]
times = [1, 2]
"""

PUNCH = "data/tutorials/punch.toml"
SPHERE = "data/scenes/hertz_sphere.toml"
BRACKET = "doc/method/benchmarks/bracket.toml"
MINDLIN = ["mesh.cells=triangle6", "mesh.element=bilinear"]
FIT = ["body.mesh.cells=triangle"]


# Seconds after which a run of the table is left.
LIMIT = 400


def blocks(form, numbers):
    return [[f"mesh.elements={form.format(*(round(k * n) for n in numbers))}"] for k in (1, 2, 4, 8, 16, 32)]


# Name, scene or its text, overrides, uniform meshes from coarse to fine (the first is refined), `mesh.refine`, that of the
# truth and what is known of it, quantities, and those that `converge` is asked for.
CASES = [
    dict(name="cylinder", text=CYLINDER, uniform=[[f"mesh.elements=[{n},{n}]"] for n in (8, 16, 32, 64, 128, 256, 512)],
         refine=[0.4, 0.2, 0.1, 0.05, 0.025], truth=0.006, quantities=["force", "peak", "friction_work"]),
    dict(name="Cattaneo and Mindlin", scene="data/scenes/cattaneo_mindlin.toml", sets=MINDLIN,
         uniform=blocks("[[{},{},{}],{}]", (4, 8, 4, 6)), refine=[0.2, 0.1, 0.05, 0.025, 0.0125], truth=0.003,
         quantities=["force", "peak", "friction_work"]),
    dict(name="rounded punch", scene=PUNCH, sets=["mesh.cells=triangle", "mesh.grading=[[1,1,1],1]"],
         uniform=blocks("[[{},{},{}],{}]", (3, 4, 9, 8)), refine=[0.4, 0.2, 0.1, 0.05, 0.025], truth=0.008,
         # stickslip converge data/tutorials/punch.toml --for peak --to 0.004: quadrilaterals, 473.0 MPa, 0.16 %.
         known=dict(peak=473.0), quantities=["force", "peak", "friction_work"]),
    dict(name="press fit", scene="data/tutorials/press-fit.toml", sets=FIT, uniform=[
         [f"body[0].mesh.elements=[{n},{5 * n}]", f"body[1].mesh.elements=[{n},{2 * n}]"] for n in (2, 4, 8, 16, 32)],
         refine=[0.2, 0.1, 0.05, 0.025], truth=0.006, quantities=["force", "friction_work"]),
    dict(name="lap joint", text=LAP, uniform=[
         [f"body[0].mesh.elements=[[{12 * k},{3 * k},{3 * k},{3 * k}],{2 * k}]",
          f"body[1].mesh.elements=[[{3 * k},{3 * k},{3 * k},{12 * k}],{2 * k}]"] for k in (1, 2, 4, 8, 16)],
         refine=[0.2, 0.1, 0.05, 0.025], truth=0.006, quantities=["force", "friction_work"]),
    # Known are values of second order, refined to 0.05: the force to 0.12 %.
    dict(name="sphere", scene=SPHERE, sets=["mesh.cells=tetrahedron", "mesh.grading=[[1,1],[1,1],1]"],
         uniform=blocks("[[{},{}],[{},{}],{}]", (1, 3, 1, 3, 4))[:4], refine=[0.5, 0.35, 0.25, 0.17],
         known=dict(force=822.7e3, peak=149.9e6), quantities=["force", "peak"]),
    # Known are twice the force and the friction work of studies/bracket_half.geo, in which the command stands: the friction
    # work with the increments of the table.
    dict(name="bracket", scene=BRACKET, sets=["time.increments=6"], gmsh=[6, 4, 3, 2, 1.5, 1], refine=[0.5, 0.4, 0.3, 0.22],
         known=dict(force=7434, friction_work=0.2267), quantities=["force", "friction_work"], studies=["force"]),
]


def run(program, command, scene, overrides, more=(), limit=None):
    """The JSON object that a command prints, and its CPU seconds."""
    words = [program, command, scene, *(word for override in overrides for word in ("--set", override))]
    before = os.times()
    try:
        output = subprocess.run([*words, *more, "--threads", "1", "--json"], capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return None, None
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    try:
        return json.loads(output.stdout), seconds
    except json.JSONDecodeError:
        raise SystemExit(" ".join(words) + "\n" + output.stderr)


def values(report):
    if report["status"] == "bad-input":
        raise SystemExit(report["message"])
    if report["status"] != "converged":
        return {}
    return {
        "peak": (report.get("largest_pressure") or {}).get("pressure"),
        "force": (report.get("largest_force") or {}).get("magnitude"),
        "friction_work": (report.get("friction") or {}).get("friction_work"),
    }


def within_a_percent(errors):
    """The CPU time of the first run from which on all errors are at most 1 %."""
    found = None
    for seconds, error in reversed(errors):
        if error is None or error > 0.01:
            break
        found = seconds
    return found


def meshes_of_gmsh(case, folder):
    """The overrides that name meshes of these sizes, which Gmsh writes into `folder`."""
    meshes = []
    for size in case["gmsh"]:
        file = os.path.join(folder, f"{size}.msh")
        words = ["gmsh", "-3", case["scene"].replace(".toml", ".geo"), "-setnumber", "size", str(size)]
        subprocess.run([*words, "-format", "msh41", "-o", file], check=True, capture_output=True)
        meshes.append([f"mesh.file={file}"])
    return meshes


def study(program, case, folder):
    """The rows of a case: kind, mesh, nodes' number of elements, CPU seconds, quantity, value, true error, told uncertainty."""
    scene, sets = case.get("scene"), [*case.get("sets", []), "solver.linear=auto"]
    if "text" in case:
        scene = os.path.join(folder, "scene.toml")
        with open(scene, "w") as file:
            file.write(case["text"])
    uniform = case.get("uniform") or meshes_of_gmsh(case, folder)
    first = sets + uniform[0]
    key = "body.mesh.refine" if "text" in case and "[[body]]" in case["text"] or "fit" in case["name"] else "mesh.refine"

    def true_values(*more):
        refined = [*first, f"{key}={case['truth']}", *more] if "truth" in case else None
        return {**(values(run(program, "run", scene, refined)[0]) if refined else {}), **case.get("known", {})}

    truth = true_values()
    print(f"{case['name']}: truth {truth}", flush=True)
    rows = []
    kinds = [("uniform", " ".join(mesh), sets + mesh) for mesh in uniform]
    kinds += [("refined", f"{key}={error}", [*first, f"{key}={error}"]) for error in case["refine"]]
    for kind, name, overrides in kinds:
        report, seconds = run(program, "run", scene, overrides, limit=LIMIT)
        if report is None:
            print(f"{case['name']}, {kind}, {name}: left after {LIMIT} s")
            continue
        found = values(report)
        for quantity in case["quantities"]:
            value = found.get(quantity)
            error = None if value is None else abs(value / truth[quantity] - 1)
            rows.append([case["name"], kind, os.path.basename(name), seconds, quantity, value, error, None])
            print(*rows[-1], sep=", ", flush=True)
    for quantity in case.get("studies", case["quantities"]):
        for share in (0.1, 0.02):
            limits = ["--for", quantity, "--to", str(share), "--within", "120"]
            found, seconds = run(program, "converge", scene, first, limits)
            if found["value"] is None or found["uncertainty"] is None:
                print(case["name"], quantity, found["message"])
                continue
            # Increments are another error: the truth of a study has its last ones.
            last = found["runs"][-1]
            there = true_values(f"time.increments={last['increments']}")
            true = abs(found["value"] / there[quantity] - 1)
            of_mesh = found["uncertainty_mesh"]
            rows.append([case["name"], f"converge to {share}", last["mesh"], seconds, quantity, found["value"], true, of_mesh])
            print(*rows[-1], sep=", ", flush=True)
    return rows


COLOURS = ["#1f5fa8", "#c2571a", "#3d8b3d", "#7b4fa3", "#b8860b", "#008b8b"]


def picture(title, series):
    """Errors over CPU seconds, both logarithmic, of series (label, colour, broken, points)."""
    width, height, left, right, top, bottom = 640, 346, 64, 172, 30, 46
    series = [(*style, [point for point in points if point[1]]) for *style, points in series]
    ranges = []
    for axis in (0, 1):
        values = [math.log10(point[axis]) for *_, points in series for point in points]
        ranges.append((math.floor(min(values)), math.ceil(max(values))))
    (x0, x1), (y0, y1) = ranges
    x = lambda value: left + (width - left - right) * (math.log10(value) - x0) / (x1 - x0)
    y = lambda value: height - bottom - (height - top - bottom) * (math.log10(value) - y0) / (y1 - y0)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
             f'<title>{title}: errors over CPU time</title><rect width="{width}" height="{height}" fill="white"/>',
             f'<text x="{left}" y="18" font-weight="bold">{title}</text>']
    for k in range(x0, x1 + 1):
        at = x(10.0**k)
        lines.append(f'<line x1="{at:.1f}" y1="{top}" x2="{at:.1f}" y2="{height - bottom}" stroke="#ddd"/>'
                     f'<text x="{at:.1f}" y="{height - bottom + 16}" text-anchor="middle">{10.0**k:g}</text>')
    for k in range(y0, y1 + 1):
        at = y(10.0**k)
        lines.append(f'<line x1="{left}" y1="{at:.1f}" x2="{width - right}" y2="{at:.1f}" stroke="#ddd"/>'
                     f'<text x="{left - 6}" y="{at + 4:.1f}" text-anchor="end">{10.0 ** (k + 2):g} %</text>')
    lines.append(f'<text x="{(left + width - right) / 2}" y="{height - 8}" text-anchor="middle">CPU time, s</text>')
    for k, (label, colour, broken, points) in enumerate(series):
        style = f'fill="none" stroke="{colour}" stroke-width="2"' + ' stroke-dasharray="5 4"' * broken
        at, fill = top + 8 + 20 * k, "white" if broken else colour
        lines.append(f'<path d="M{width - right + 12},{at} h26" {style}/>'
                     f'<text x="{width - right + 44}" y="{at + 4}">{label}</text>')
        path = " ".join(f"{x(seconds):.1f},{y(error):.1f}" for seconds, error in points)
        lines.append(f'<polyline points="{path}" {style}/>')
        lines += [f'<circle cx="{x(seconds):.1f}" cy="{y(error):.1f}" r="3.5" fill="{fill}" stroke="{colour}"/>'
                  for seconds, error in points]
    return "\n".join(lines) + "\n</svg>\n"


def draw(out, rows):
    for scene in dict.fromkeys(row[0] for row in rows):
        points = {}
        for _, kind, _, seconds, quantity, _, error, _ in (row for row in rows if row[0] == scene):
            if kind in ("uniform", "refined") and error:
                points.setdefault((quantity, kind), []).append((seconds, error))
        quantities = list(dict.fromkeys(quantity for quantity, _ in points))
        series = [(f"{quantity.replace('_', ' ')}, {kind}", COLOURS[k], kind == "uniform", points.get((quantity, kind), []))
                  for k, quantity in enumerate(quantities) for kind in ("uniform", "refined")]
        with open(os.path.join(os.path.dirname(out), scene.lower().replace(" ", "-") + ".svg"), "w") as file:
            file.write(picture(scene, series))


def main(program, out, only=None):
    rows = []
    for case in CASES:
        if only and only not in case["name"]:
            continue
        with tempfile.TemporaryDirectory() as folder:
            rows += study(program, case, folder)
    heads = ["scene", "kind", "mesh", "cpu_seconds", "quantity", "value", "error", "told"]
    with open(out, "w", newline="") as file:
        number = lambda x: f"{x:.4g}" if isinstance(x, float) else x
        csv.writer(file, lineterminator="\n").writerows([heads] + [[number(x) for x in row] for row in rows])
    draw(out, rows)
    for scene, quantity in dict.fromkeys((row[0], row[4]) for row in rows):
        of = lambda kind: [(row[3], row[6]) for row in rows if row[:2] == [scene, kind] and row[4] == quantity]
        uniform, refined = within_a_percent(of("uniform")), within_a_percent(of("refined"))
        print(f"{scene}, {quantity}: CPU seconds to 1 %: uniform {uniform}, refined {refined}")
    told = [row for row in rows if row[7] is not None]
    print(f"converge: {sum(row[6] <= row[7] for row in told)} of {len(told)} errors of the mesh within the told one")


if __name__ == "__main__":
    main(*sys.argv[1:])
