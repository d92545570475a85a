"""Tells how far the uncertainties of `stickslip converge` are right: told uncertainty against true error.

    python3 studies/converge.py target/release/stickslip doc/method/estimates/converge.csv

The truth is the run on a mesh at least four times finer than the last one of the study, extrapolated from two numbers of
increments; for the stick ratio of the pushed cylinder it is the closed form. Studies of sharp edges have no true peak:
they must end as singular.
"""

import csv
import json
import math
import subprocess
import sys
import time

SCENES = "data/scenes/"
TUTORIALS = "data/tutorials/"
PATH = ["peak", "force", "friction_work"]
SHARP = 'contact.obstacle.formula="%s * max(0, x - 5)"'
# In space, one factorisation for all increments.
CONDENSED = "solver.linear=condensed"
PUNCH_GRADING = "mesh.grading=[[1,1,20],0.1]"

# Name, scene, overrides, first meshes with the ratio of the next and at most so many, the mesh of the truth, first
# increments, increments of the truth, quantities, shares.
CASES = [
    dict(name="line", scene=SCENES + "hertz_line.toml", half_plane=True, truth=(160, 160, 96), increments=1, steps=1,
         first=[((6, 6, 4), 2), ((10, 10, 6), 2), ((2, 2, 1), 1.5, 3), ((3, 3, 2), 1.5, 3)],
         quantities=["peak", "force"], shares=[0.1, 0.01]),
    dict(name="line with friction", scene=SCENES + "punch.toml", half_plane=True, truth=(80, 128, 32), increments=4,
         first=[((5, 8, 2), 2), ((8, 13, 3), 1.5), ((3, 5, 1), 1.5, 3)], steps=64,
         quantities=PATH + ["stick_ratio"], shares=[0.2, 0.05]),
    dict(name="rounded punch", scene=TUTORIALS + "punch.toml", sets=[PUNCH_GRADING], truth="[[40,56,48],64]",
         first=[("[[3,4,3],4]", 1.5), ("[[5,7,6],8]", 1.41), ("[[2,2,2],2]", 1.41, 3)], increments=4, steps=64,
         quantities=PATH, shares=[0.2, 0.05]),
    dict(name="rounded punch, second order", scene=TUTORIALS + "punch.toml", truth="[[24,32,24],32]",
         sets=[PUNCH_GRADING, "mesh.cells=triangle6"], first=[("[[3,4,3],4]", 1.41)], increments=4, steps=64,
         quantities=PATH, shares=[0.2, 0.05]),
    dict(name="rounded punch, much friction", scene=TUTORIALS + "punch.toml", truth="[[40,56,48],64]",
         sets=[PUNCH_GRADING, "contact.friction=0.6"], first=[("[[3,4,3],4]", 1.5), ("[[5,7,6],8]", 1.41)],
         increments=4, steps=64, quantities=PATH, shares=[0.2, 0.05]),
    dict(name="line, second order", scene=TUTORIALS + "punch.toml", truth="[[24,32,24],32]", increments=1, steps=1,
         sets=[PUNCH_GRADING, "mesh.cells=triangle6", "contact.friction=0", "contact.obstacle.formula='x^2/2000'"],
         first=[("[[3,4,3],4]", 1.41), ("[[2,3,2],3]", 1.41)], quantities=["peak", "force"], shares=[0.2, 0.05]),
    dict(name="cylinder pushed", scene=SCENES + "cattaneo_mindlin.toml", truth="[[48,96,48],64]", increments=3,
         first=[("[[6,12,6],8]", 1.41), ("[[4,7,4],6]", 1.5), ("[[3,5,3],4]", 1.41, 3)], steps=48, friction=0.4,
         quantities=PATH + ["stick_ratio"],
         shares=[0.3, 0.1]),
    dict(name="block", scene=SCENES + "block.toml", sets=["solver.setting=default"], truth="[128,128]", increments=4,
         first=[("[5,5]", 2), ("[8,8]", 2)], steps=64, quantities=["force", "friction_work"], shares=[0.1, 0.03]),
    dict(name="fretting, two bodies", scene=TUTORIALS + "fretting.toml", bodies=True, truth="[[32,96,32],40]",
         first=[("[[4,12,4],5]", 1.41), ("[[2,5,2],3]", 1.41, 3)], increments=12, steps=96, shares=[0.3, 0.1],
         quantities=PATH + ["stick_ratio"],
         sets=["body.mesh.grading=[[0.05,1,20],0.05]", "body[1].mesh.grading=[[0.05,1,20],20]"]),
    dict(name="fretting, unequal bodies", scene=TUTORIALS + "fretting.toml", bodies=True, truth="[[32,96,32],40]",
         first=[("[[4,12,4],5]", 1.41), ("[[3,10,3],4]", 1.5)], increments=12, steps=96, shares=[0.3, 0.1],
         quantities=PATH + ["stick_ratio"], sets=[
             "body.mesh.grading=[[0.05,1,20],0.05]", "body[1].mesh.grading=[[0.05,1,20],20]",
             "body[1].material.young=70e3"]),
    dict(name="two blocks", scene=SCENES + "two_blocks.toml", bodies=True, truth="[64,32]", increments=8, steps=128,
         first=[("[4,2]", 2)], quantities=["force", "friction_work"], shares=[0.2, 0.05]),
    dict(name="cube", scene=SCENES + "cube.toml", truth="[24,24,24]", increments=4, steps=32, sets=[CONDENSED],
         first=[("[2,2,2]", 1.41), ("[3,3,3]", 1.41)], quantities=["force", "friction_work"], shares=[0.2, 0.1]),
    dict(name="disk", scene=SCENES + "disk.toml", truth="[24,24,12]", increments=8, steps=32, first=[("[2,2,1]", 1.41)],
         sets=[CONDENSED], quantities=["force", "friction_work"], shares=[0.2]),
    dict(name="sphere", scene=SCENES + "hertz_sphere.toml", truth="[[20,20],[20,20],30]", increments=1, steps=1,
         sets=[CONDENSED],
         first=[("[[2,2],[2,2],3]", 1.5)], quantities=["peak", "force"], shares=[0.2, 0.05]),
]
# Peaks that grow without a limit.
SINGULAR = [
    dict(name=f"sharp punch, slope {slope}, {cells}", scene=TUTORIALS + "punch.toml", first=blocks, increments=4,
         sets=[PUNCH_GRADING, SHARP % slope, f"mesh.cells={cells}", f"contact.friction={friction}"],
         quantities=["peak"], shares=[0.05], truth=None)
    for slope, friction in [(0.1, 0.2), (0.5, 0.0), (2, 0.5)]
    for cells, blocks in [("quadrilateral", [("[[5,7,6],8]", 2), ("[[3,4,4],5]", 2)]),
                          ("triangle6", [("[[3,4,3],4]", 2)])]
] + [
    dict(name="press fit", scene=TUTORIALS + "press-fit.toml", first=[(None, 2)], increments=8, quantities=["peak"],
         sets=["body[0].mesh.elements=[4,40]", "body[1].mesh.elements=[4,16]"], shares=[0.05], truth=None),
]


def run(program, arguments):
    start = time.time()
    output = subprocess.run([program, *arguments, "--json", "--threads", "1"], capture_output=True, text=True)
    try:
        return json.loads(output.stdout), time.time() - start
    except json.JSONDecodeError:
        raise SystemExit(" ".join(arguments) + "\n" + output.stderr)


def sets(overrides):
    return [word for override in overrides for word in ("--set", override)]


def mesh(case, elements):
    """The overrides that give a case this mesh."""
    if elements is None:
        return []
    if "half_plane" in case:
        keys = ["contact_elements", "outer_elements", "layers"]
        return [f"mesh.{key}={number}" for key, number in zip(keys, elements)]
    return [f"{'body.' if case.get('bodies') else ''}mesh.elements={elements}"]


def values(report):
    """The quantities of the report of a run."""
    forces = [force["force"] for force in report["forces"]]
    return {
        "peak": (report.get("largest_pressure") or {}).get("pressure"),
        "force": max(sum(f * f for f in force) ** 0.5 for force in forces),
        "friction_work": sum(increment["friction_work"] for increment in report["increments"]),
        "stick_ratio": (report.get("stick_zone") or {}).get("ratio"),
    }


def mindlin(report, friction):
    """The stick ratio of Cattaneo and Mindlin at the largest tangential force, sqrt(1 - Q / (mu P))."""
    largest = max(report["forces"], key=lambda force: abs(force["sum_p_t"]))
    return math.sqrt(1 - abs(largest["sum_p_t"]) / (friction * largest["sum_p_n"]))


def limit(program, case, fine):
    """The values on the mesh `fine`, extrapolated from two numbers of increments, the error of which is proportional."""
    start, found = time.time(), []
    for steps in sorted({case["steps"], max(case["steps"] // 2, 1)}):
        report, _ = run(program, ["run", case["scene"], *sets(fine + [f"time.increments={steps}"])])
        assert report["status"] == "converged", report["reason"]
        found.append(values(report))
    follows = {"peak", "force", "friction_work"} if len(found) == 2 else set()
    truth = {key: 2 * x - found[0][key] if key in follows else x for key, x in found[-1].items()}
    if "friction" in case:
        truth["stick_ratio"] = mindlin(report, case["friction"])
    return truth, time.time() - start


def along(case, elements):
    """The number of elements along the first axis of a mesh; along the contact zone of a half-plane."""
    if "half_plane" in case:
        return elements[0]
    first = json.loads(elements)[0]
    return sum(first) if isinstance(first, list) else first


def ladder(case, first, ratio, most=9):
    """The meshes of a study, at most so many, the last one at least four times coarser than the truth."""
    numbers = [float(along(case, first))]
    while round(numbers[-1] * ratio) <= along(case, case["truth"]) / 4:
        numbers.append(numbers[-1] * ratio)
    return ",".join(str(round(number)) for number in numbers[:most])


def main(program, out, only=None):
    rows = []
    for case in SINGULAR + CASES:
        if only and only not in case["name"]:
            continue
        overrides = case.get("sets", [])
        truth, seconds = {}, 0.0
        if case["truth"]:
            fine = overrides + mesh(case, case["truth"])
            truth, seconds = limit(program, case, fine)
            print(f"{case['name']}: truth {truth}, {seconds:.0f} s", flush=True)
        studies = [(first, quantity, to) for first in case["first"]
                   for quantity in case["quantities"] for to in case["shares"]]
        for first, quantity, to in studies:
            more = sets(overrides + mesh(case, first[0]) + [f"time.increments={case['increments']}"])
            limits = ["--to", str(to), "--max-runs", "10", "--within", "60"]
            if truth:
                limits += ["--meshes", ladder(case, *first)]
            study, seconds = run(program, ["converge", case["scene"], "--for", quantity, *limits, *more])
            if "runs" not in study:
                print(case["name"], quantity, study["message"])
                continue
            last = study["runs"][-1]
            told, true = study["uncertainty"], None
            if truth and study["value"]:
                true = abs(study["value"] / truth[quantity] - 1)
            rows.append([case["name"], quantity, to, len(study["runs"]), last["mesh"], last["increments"],
                         study["verdict"], told, true, "" if truth else "singular"])
            print(*rows[-1], f"{seconds:.0f} s", sep=", ", flush=True)
    heads = ["scene", "quantity", "to", "runs", "mesh", "increments", "verdict", "told", "true", "note"]
    with open(out, "w", newline="") as file:
        number = lambda x: f"{x:.4g}" if isinstance(x, float) else x
        csv.writer(file, lineterminator="\n").writerows([heads] + [[number(x) for x in row] for row in rows])
    judge(rows)


def judge(rows):
    # Several shares may end with one run, at the limit of the meshes.
    once = {(*row[:2], *row[3:6]): row for row in rows}.values()
    judged = [row for row in once if row[7] is not None and row[8] is not None and not row[9]]
    for quantity in ["peak", "force", "friction_work", "stick_ratio", None]:
        # Smaller shares are rounding errors.
        of = [(max(told, 1e-8), max(true, 1e-8)) for _, q, *_, told, true, _ in judged if quantity in (None, q)]
        within, twice = (sum(true <= times * told for told, true in of) for times in (1, 2))
        near = sum(told / 2 <= true <= 2 * told for told, true in of)
        bad = sum(true > 0.1 and told < 0.05 for told, true in of)
        ratios = sorted(told / true for told, true in of)
        median = ratios[len(ratios) // 2] if ratios else float("nan")
        print(f"{quantity or 'all'}: {len(of)} studies, true <= told {within}, <= 2 told {twice}, within a factor of two "
              f"{near}, > 10 % with < 5 % told {bad}, median told/true {median:.1f}, "
              f"largest true/told {1 / ratios[0]:.1f}, true above 10 % {sum(true > 0.1 for _, true in of)}")
    silent = [row for row in once if row[7] is None and not row[9]]
    print(f"without an uncertainty: {len(silent)}, told as known {sum(row[6] == 'known' for row in silent)}")
    singular = [row for row in rows if row[9] == "singular"]
    print(f"singular: {len(singular)}, told as such {sum(row[6] == 'singular' for row in singular)}, "
          f"told as known {sum(row[6] == 'known' for row in singular)}")
    print(f"verdicts: { {v: sum(r[6] == v for r in rows) for v in sorted({r[6] for r in rows})} }")


if __name__ == "__main__":
    main(*sys.argv[1:])
