// The head and the main results.
const title = report.title || "Results of a run that did not end";
document.title = `${title} – stickslip`;
$(".program").textContent = ended ? `stickslip ${report.program_version} · ${report.scene || ""}` : "stickslip";
$("h1").textContent = title;
const converged = [...times.keys()].filter((index) => !failed.has(index)).length, isGood = report.status === "converged";
$(".reason").textContent = report.reason || (ended ? "" : "run.json is missing: the run still goes on, or was killed. `stickslip run` with --resume ends it. Verdict, warnings and errors come with its end.");
// Keeps a number and its unit in one line.
const close = (text) => text.replace(/ (s|%|=)(?=[ .;,]|$)/g, "\u00a0$1").replaceAll("= ", "=\u00a0");
// Fills an element with a text whose names are between backquotes.
const inCode = (node, text) => { text.split("`").forEach((part, k) => node.append(k % 2 ? element("code", part) : part)); return node; };

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
// The friction of each contact that is in use, the largest share first.
const uses = [...(report.friction_use || [])].sort((a, b) => b.largest - a.largest);
// Nodes that slip without a hundredth of the friction in use, as radially under the head of a bolt, are no verdict.
const [used, ...further] = uses.filter(({ largest }) => largest >= 0.01);
const AT_THE_END = { open: "nothing touches", stick: "it sticks", partial: "it slips in part", whole: "it slips as a whole" };
function slipOf({ slips_from: some, slips_wholly_from: all, factors, end }) {
  // The time, with the loads that change there.
  const from = (time, k) => {
    const loads = (factors || []).map(({ load, between }) => `load[${load}] at ${plain(between[k])}`);
    return `from t = ${plain(time)} s${loads.length ? ` (${loads.join(", ")})` : ""}`;
  };
  if (some == null) return "no node slips";
  if (all == null) return `some nodes slip ${from(some, 0)}${report.status === "slips" ? "" : ", never all"}`;
  return `${some < all ? `some nodes slip ${from(some, 0)}, all` : "all nodes slip"} ${from(all, 1)}; at the end ${AT_THE_END[end]}`;
}
const slips = used ? ` On \`${used.boundary}\` ${slipOf(used)}.` : "";
const others = further.length ? ` ${further.length} more ${further.length > 1 ? "contacts" : "contact"} below.` : "";
inCode($(".verdict"), close((!ended ? `Unfinished, ${converged} increments converged so far.` : isGood ? `Converged in all ${report.totals.converged} increments.`
  : `Not converged: ${report.status} after ${report.totals.converged} increments.`) + slips + others));
$(".verdict").classList.add(isGood ? "good" : "bad");

// The numbers of the job. A pressure that depends on the mesh is the last and the least of them.
const singular = peak && (peak.singular ?? (report.warnings || []).some(({ kind }) => kind === "singular-edge"));
const ofPeak = peak && (singular ? "singular: it depends on the mesh" : `error of the mesh ${about(peak.mesh_error)}`);
const ofMesh = ({ given, mesh_error }) => (given ? "loads alone determine it" : about(mesh_error));
const told = ({ given, mesh_error }) => (given ? ofMesh({ given }) : `error of the mesh ${about(mesh_error)}`);
const [bolt] = report.pretension_forces || [];
const sinceLock = ({ locked_force: locked, force_range: [least, most] }) => `${rounded(least, FORCE)} to ${rounded(most, FORCE)}${locked == null ? "" : `, ${rounded(locked, FORCE)} at the lock`}`;
const numbers = [
  bolt && [`largest force of ${bolt.name}`, rounded(bolt.force_range[1], FORCE), sinceLock(bolt), { boundary: bolt.name }],
  force && ["largest contact force", rounded(force.magnitude, FORCE), told(force), force],
  used && ["friction in use", percent(used.largest), used.slips_from == null ? "no node slips" : `slip begins at t = ${plain(used.slips_from)} s`, used],
  peak && peak.pressure && (singular && peak.mean_pressure ? ["mean pressure", rounded(peak.mean_pressure, STRESS), `the largest one, ${rounded(peak.pressure, STRESS)}, depends on the mesh`, peak]
    : ["largest pressure", rounded(peak.pressure, STRESS), ofPeak, peak, singular]),
  !used && moved && ["largest displacement", rounded(moved.length, LENGTH), "", moved],
].filter(Boolean).slice(0, 3);
for (const [name, value, error, { boundary, time }, isWeak] of numbers) {
  const box = element("div");
  box.append(element("span", name), element("b", value, isWeak ? "weak" : ""), element("span", close(error)), element("span", close([boundary, time == null ? "" : `t = ${plain(time)} s`].filter(Boolean).join(", ")), "note"));
  $("#numbers").append(box);
}
for (const of of report.pretension_forces || []) keyRow(`force of ${of.name}`, rounded(of.force_range[1], FORCE), sinceLock(of), "", "");
if (force) keyRow("largest contact force", rounded(force.magnitude, FORCE), `${force.boundary}, t = ${plain(force.time)} s: (${force.force.map((f) => rounded(f, FORCE)).join(", ")})`,
  ofMesh(force), "");
if (held) keyRow("largest tangential force", rounded(held.magnitude, FORCE), `${held.boundary}, t = ${plain(held.time)} s`, ofMesh(held), ofSteps(held.time_error));
for (const of of uses) keyRow("friction in use", percent(of.largest), `${of.boundary}, t = ${plain(of.time)} s: ${slipOf(of)}`, "", "");
if (friction) keyRow("friction work", rounded(friction.friction_work, ENERGY), "all increments", "unknown",
  ofSteps(friction.time_error) + (Math.abs(friction.time_error) >= 0.001 ? `: better ${rounded(friction.friction_work * (1 - friction.time_error), ENERGY)}` : ""));
if (stick) keyRow("stick zone", plain(stick.ratio, 2), `of the contact width, ${stick.boundary}, t = ${plain(stick.time)} s`, stick.uncertainty == null ? "unknown" : `± ${plain(stick.uncertainty, 1)}`, "");
if (moved) keyRow("largest displacement", rounded(moved.length, LENGTH), `${placeOf(moved.position)}, t = ${plain(moved.time)} s`, "", "");
if (peak && peak.pressure) {
  const across = peak.nodes_across ? `, ${peak.nodes_across} nodes across` : "";
  keyRow("largest pressure", rounded(peak.pressure, STRESS), `${peak.boundary}, ${placeOf(peak.position)}, t = ${plain(peak.time)} s`, ofPeak.replace("error of the mesh ", "") + across, "");
  if (singular) $("#results tbody tr:last-child").className = "weak";
}
const remarks = [
  estimates.discretisation == null ? "" : `Error of the mesh in the energy norm: about ${percent(estimates.discretisation)}.`,
  ended ? `Computed in ${plain(report.totals.wall_seconds, 3)} s by ${report.method} with ${report.solver}; largest error of any law ${Math.max(...Object.values(report.totals.kkt)).toExponential(1)}.` : "",
];
$("#results .note").textContent = remarks.join(" ").trim();
$("#results").hidden = !ended;

// A line for each warning; its cure, the last part of the message, unfolds.
for (const { kind, message } of report.warnings || []) {
  const fold = element("details"), cut = message.lastIndexOf("; "), line = element("summary");
  line.append(element("code", kind), " ");
  fold.append(inCode(line, cut < 0 ? message : message.slice(0, cut)), inCode(element("p"), cut < 0 ? "" : message.slice(cut + 2)));
  $("#warnings").append(fold);
}
addEventListener("beforeprint", () => document.querySelectorAll("#warnings details").forEach((fold) => { fold.open = true; }));
$("#warnings").hidden = !(report.warnings || []).length;

$("#scene pre").textContent = report.scene_text || "";
$("#scene").hidden = !report.scene_text;
$("footer").textContent = (known ? `Forces in ${FORCE}, lengths in ${LENGTH}, energies in ${ENERGY}` : "Numbers are in the units of the scene")
  + ". All digits are in the files beside this page.";
