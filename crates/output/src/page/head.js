// The head and the main results.
const title = report.title || "Results of a run that did not end";
document.title = `${title} – stickslip`;
$(".program").textContent = ended ? `stickslip ${report.program_version} · ${report.scene || ""}` : "stickslip";
$("h1").textContent = title;
const verdict = $(".verdict"), converged = [...times.keys()].filter((index) => !failed.has(index)).length;
verdict.textContent = ended ? `${report.status}, ${report.totals.converged} increments converged` : `unfinished, ${converged} increments converged so far`;
verdict.classList.add(report.status === "converged" ? "good" : "bad");
$(".reason").textContent = report.reason || (ended ? "" : "run.json is missing: the run still goes on, or was killed. `stickslip run` with --resume ends it. Verdict, warnings and errors come with its end.");

// The key results: value, place and time, and what mesh and time steps may have spoiled.
const { largest_pressure: peak, largest_force: force, holding_force: held, friction, stick_zone: stick, largest_displacement: moved } = report;
const estimates = report.estimates || {};
const dimension = report.boundaries && report.boundaries[0] ? report.boundaries[0].force.length : 3;
const placeOf = (x) => `(${x.slice(0, dimension).map((c) => plain(c)).join(", ")}) ${LENGTH}`;
const about = (error) => (error == null ? "unknown" : Math.abs(error) < 0.001 ? "below 0.1 %" : `about ${percent(Math.abs(error))}`);
// The exact path has no time steps.
const ofSteps = (error) => (report.method === "events" ? "" : about(error));
const keyRow = (...cells) => {
  const row = element("tr");
  row.append(...["quantity", "value", "where and when", "error of the mesh", "error of the time steps"].map((name, k) => {
    const cell = element("td", cells[k]);
    cell.dataset.name = name;
    return cell;
  }));
  $("#results tbody").append(row);
};
if (peak && peak.pressure) {
  const singular = peak.singular ?? (report.warnings || []).some(({ kind }) => kind === "singular-edge");
  const across = peak.nodes_across ? `, ${peak.nodes_across} nodes across` : "";
  keyRow("largest pressure", rounded(peak.pressure, STRESS), `${peak.boundary}, ${placeOf(peak.position)}, t = ${plain(peak.time)} s`,
    (singular ? "singular: it depends on the mesh" : about(peak.mesh_error)) + across, "");
}
const ofMesh = ({ given, mesh_error }) => (given ? "loads alone determine it" : about(mesh_error));
if (force) keyRow("largest contact force", rounded(force.magnitude, FORCE), `${force.boundary}, t = ${plain(force.time)} s: (${force.force.map((f) => rounded(f, FORCE)).join(", ")})`,
  ofMesh(force), "");
if (held) keyRow("largest tangential force", rounded(held.magnitude, FORCE), `${held.boundary}, t = ${plain(held.time)} s`, ofMesh(held), ofSteps(held.time_error));
if (friction) keyRow("friction work", rounded(friction.friction_work, ENERGY), "all increments", "unknown",
  ofSteps(friction.time_error) + (Math.abs(friction.time_error) >= 0.001 ? `: better ${rounded(friction.friction_work * (1 - friction.time_error), ENERGY)}` : ""));
if (stick) keyRow("stick zone", plain(stick.ratio, 2), `of the contact width, ${stick.boundary}, t = ${plain(stick.time)} s`, `± ${plain(stick.uncertainty, 1)}`, "");
if (moved) keyRow("largest displacement", rounded(moved.length, LENGTH), `${placeOf(moved.position)}, t = ${plain(moved.time)} s`, "", "");
const remarks = [
  estimates.discretisation == null ? "" : `Error of the mesh in the energy norm: about ${percent(estimates.discretisation)}.`,
  ended ? `Computed in ${plain(report.totals.wall_seconds, 3)} s by ${report.method} with ${report.solver}; largest error of any law ${Math.max(...Object.values(report.totals.kkt)).toExponential(1)}.` : "",
];
$("#results .note").textContent = remarks.join(" ").trim();
$("#results").hidden = !ended;

for (const { kind, message } of report.warnings || []) {
  const item = element("li");
  item.append(element("code", kind), " ");
  message.split("`").forEach((part, k) => item.append(k % 2 ? element("code", part) : part));
  $("#warnings ol").append(item);
}
$("#warnings").hidden = !(report.warnings || []).length;

$("#scene pre").textContent = report.scene_text || "";
$("#scene").hidden = !report.scene_text;
$("footer").textContent = (known ? `Forces in ${FORCE}, lengths in ${LENGTH}, energies in ${ENERGY}` : "Numbers are in the units of the scene")
  + ". All digits are in the files beside this page.";
