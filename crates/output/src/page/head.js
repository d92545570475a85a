// The head and the main results.
const title = report.title || "Results of a run that did not end";
document.title = `${title} – stickslip`;
$(".program").textContent = ended ? `stickslip ${report.program_version} · ${report.scene || ""}` : "stickslip";
$("h1").textContent = title;
const verdict = $(".verdict"), converged = [...times.keys()].filter((index) => !failed.has(index)).length;
verdict.textContent = ended ? `${report.status}, ${report.totals.converged} increments converged` : `unfinished, ${converged} increments converged so far`;
verdict.classList.add(report.status === "converged" ? "good" : "bad");
$(".reason").textContent = report.reason || (ended ? "" : "run.json is missing: the run still goes on, or was killed. `stickslip run` with --resume ends it. Verdict, warnings and errors come with its end.");
function card(name, value, note) {
  const box = element("div", "", "card");
  box.append(element("span", name), element("b", value), element("span", note));
  $("#numbers").append(box);
}
const place = (x) => `(${x.slice(0, dimension).map((c) => plain(c)).join(", ")}) ${LENGTH}`;
const dimension = report.boundaries && report.boundaries[0] ? report.boundaries[0].force.length : 3;
const estimates = report.estimates || {};
const { largest_pressure: peak, largest_displacement: moved } = report;
if (peak && peak.pressure) {
  const singular = (report.warnings || []).some(({ kind }) => kind === "singular-edge");
  const error = singular ? "singular: it depends on the mesh"
    : estimates.peak_error == null ? "error of the mesh unknown" : `error of the mesh up to ${percent(estimates.peak_error)}`;
  card("largest pressure", rounded(peak.pressure, STRESS), `${error}; ${peak.boundary}, ${place(peak.position)}, t = ${peak.time} s`);
}
if (moved) card("largest displacement", rounded(moved.length, LENGTH), `${place(moved.position)}, t = ${moved.time} s`);
const steps = estimates.increments;
if (steps && steps.friction_work > 0)
  card("friction work", rounded(steps.friction_work, ENERGY), `${percent(Math.abs(steps.work_error))} of it due to the increments; better ${rounded(steps.friction_work_corrected, ENERGY)}`);
if (estimates.discretisation != null) card("mesh error", percent(estimates.discretisation), "in the energy norm");
if (ended) card("computed in", `${plain(report.totals.wall_seconds, 3)} s`, `${report.method}, ${report.solver}; error of the laws ${Math.max(...Object.values(report.totals.kkt)).toExponential(1)}`);

for (const { kind, message } of report.warnings || []) {
  const item = element("li");
  item.append(element("code", kind), " ");
  message.split("`").forEach((part, k) => item.append(k % 2 ? element("code", part) : part));
  $("#warnings ol").append(item);
}
$("#warnings").hidden = !(report.warnings || []).length;

$("#scene pre").textContent = report.scene_text || "";
$("#scene").hidden = !report.scene_text;
$("#results").hidden = true;
$("footer").textContent = (known ? `Forces in ${FORCE}, lengths in ${LENGTH}, energies in ${ENERGY}` : "Numbers are in the units of the scene")
  + ". All digits are in the files beside this page.";
