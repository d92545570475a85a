"use strict";
// Draws the page from the files of the run, which are in the element `data`.
const { report, files, pictures } = JSON.parse(document.getElementById("data").textContent);
const $ = (selector, inside = document) => inside.querySelector(selector);
const element = (name, text = "", className = "") =>
  Object.assign(document.createElement(name), { textContent: text, className });

// Numbers with few digits; in SI the unit gets a prefix.
const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "u"], [1e-9, "n"]];
const SI = { Pa: Infinity, N: Infinity, J: Infinity, "N m": Infinity, m: 1 };
function plain(x, digits = 4) {
  if (!Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(Number(x.toPrecision(digits)));
  if (size < 1e-4 || size >= 1e6) return x.toExponential(digits - 1);
  return `${Number.isInteger(x) ? x : Number(x.toPrecision(digits))}`;
}
function prefix(size, unit) {
  const found = size > 0 && SI[unit] ? PREFIXES.filter(([s]) => s <= SI[unit]) : [[1, ""]];
  return found.find(([s]) => size >= s) || found[found.length - 1];
}
function rounded(x, unit, digits = 4) {
  const [size, name] = prefix(Math.abs(x), unit);
  return `${plain(x / size, digits)} ${name}${unit}`.trim();
}
const percent = (x) => `${100 * x < 0.05 ? 0 : plain(100 * x, 2)} %`;

function parse(text) {
  // A cell in quotes may hold commas, and a quote twice.
  const cells = (line) => (line.match(/("([^"]|"")*"|[^,]*)(,|$)/g) || []).slice(0, line.endsWith(",") ? undefined : -1)
    .map((cell) => cell.replace(/,$/, "")).map((cell) => (cell.startsWith('"') ? cell.slice(1, -1).replaceAll('""', '"') : cell));
  const [head, ...lines] = text.trimEnd().split("\n").map(cells);
  return { head, rows: lines.map((line) => Object.fromEntries(head.map((name, k) => [name, line[k]]))) };
}
const units = report.units || {};
const unit = (kind, otherwise) => (units[kind] && units[kind].name) || otherwise;
const LENGTH = unit("length", "m"), STRESS = unit("stress", "Pa"), FORCE = unit("force", "N"), ENERGY = unit("energy", "J");

// The head and the main results.
document.title = `${report.title} – stickslip`;
$(".program").textContent = `stickslip ${report.program_version} · ${report.scene || ""}`;
$("h1").textContent = report.title;
const verdict = $(".verdict");
verdict.textContent = `${report.status}, ${report.totals.converged} increments converged`;
verdict.classList.add(report.status === "converged" ? "good" : "bad");
$(".reason").textContent = report.reason || "";
function card(name, value, note) {
  const box = element("div", "", "card");
  box.append(element("span", name), element("b", value), element("span", note));
  $("#numbers").append(box);
}
const place = (x) => `(${x.slice(0, dimension).map((c) => plain(c)).join(", ")}) ${LENGTH}`;
const dimension = report.boundaries && report.boundaries[0] ? report.boundaries[0].force.length : 3;
const { estimates = {}, largest_pressure: peak, largest_displacement: moved } = report;
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
card("computed in", `${plain(report.totals.wall_seconds, 3)} s`, `${report.method}, ${report.solver}; error of the laws ${Math.max(...Object.values(report.totals.kkt)).toExponential(1)}`);

for (const { kind, message } of report.warnings || []) {
  const item = element("li");
  item.append(element("code", kind), " ");
  message.split("`").forEach((part, k) => item.append(k % 2 ? element("code", part) : part));
  $("#warnings ol").append(item);
}
$("#warnings").hidden = !(report.warnings || []).length;

// A chart of curves { name, colour, points }.
const NS = "http://www.w3.org/2000/svg";
function draw(into, curves, [across, up]) {
  into.replaceChildren();
  const points = curves.flatMap((curve) => curve.points).filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
  if (!points.length) return;
  const W = Math.min(900, Math.max(360, into.clientWidth || 900)), H = 300, L = 78, R = 16, T = 30, B = 46;
  const range = (k, zero) => {
    let low = Math.min(...points.map((p) => p[k])), high = Math.max(...points.map((p) => p[k]));
    if (zero) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
    return high > low ? [low, high] : [low - 1, high + 1];
  };
  const [x0, x1] = range(0, false), [y0, y1] = range(1, true);
  const X = (x) => L + ((x - x0) / (x1 - x0)) * (W - L - R), Y = (y) => H - B - ((y - y0) / (y1 - y0)) * (H - T - B);
  const svg = document.createElementNS(NS, "svg");
  svg.setAttribute("viewBox", `0 0 ${W} ${H}`);
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${up} against ${across}`);
  const add = (name, attributes, text = "") => {
    const node = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.textContent = text;
    svg.append(node);
    return node;
  };
  const ticks = (low, high) => {
    const raw = (high - low) / 5, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw);
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
  };
  for (const y of ticks(y0, y1)) {
    add("line", { class: y === 0 ? "zero" : "grid", x1: L, x2: W - R, y1: Y(y), y2: Y(y) });
    add("text", { x: L - 8, y: Y(y) + 4, "text-anchor": "end" }, `${y}`);
  }
  for (const x of ticks(x0, x1)) {
    add("line", { class: "grid", x1: X(x), x2: X(x), y1: T, y2: H - B });
    add("text", { x: X(x), y: H - B + 18, "text-anchor": "middle" }, `${x}`);
  }
  add("text", { x: (L + W - R) / 2, y: H - 6, "text-anchor": "middle" }, across);
  add("text", { x: 4, y: 16 }, up);
  let right = W - R;
  for (const { name, colour, points, marks } of curves) {
    const at = points.filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
    add("polyline", { points: at.map(([x, y]) => `${X(x).toFixed(1)},${Y(y).toFixed(1)}`).join(" "), style: `stroke:${colour}` });
    if (marks) marks.forEach((fill, k) => fill && add("circle", { cx: X(points[k][0]), cy: Y(points[k][1]), r: 2.6, style: `fill:${fill}` }));
    if (curves.length === 1) continue;
    const label = add("text", { x: right, y: 16, "text-anchor": "end", style: `fill:${colour}` }, name);
    right -= 9 * name.length + 20;
    label.setAttribute("font-weight", "600");
  }
  const dot = add("circle", { r: 4, style: "fill:var(--ink)", visibility: "hidden" });
  const tip = add("text", { y: T + 12, visibility: "hidden" });
  svg.addEventListener("pointermove", (event) => {
    const scale = W / svg.getBoundingClientRect().width;
    const mouse = [event.offsetX * scale, event.offsetY * scale];
    let best = null;
    for (const curve of curves) for (const [x, y] of curve.points) {
      const distance = Math.hypot(X(x) - mouse[0], Y(y) - mouse[1]);
      if (Number.isFinite(distance) && (!best || distance < best.distance)) best = { distance, x, y, name: curve.name };
    }
    if (!best) return;
    dot.setAttribute("cx", X(best.x)); dot.setAttribute("cy", Y(best.y)); dot.setAttribute("visibility", "visible");
    tip.textContent = `${best.name}: ${plain(best.x)}, ${plain(best.y)}`;
    const late = X(best.x) > W / 2;
    tip.setAttribute("x", X(best.x) + (late ? -8 : 8)); tip.setAttribute("text-anchor", late ? "end" : "start"); tip.setAttribute("visibility", "visible");
  });
  into.append(svg);
}

// The contact: a state for each file `contact_NNNN[_boundary].csv`.
const increments = files["increments.csv"] ? parse(files["increments.csv"]).rows : [];
const times = new Map(increments.map((row) => [Number(row.index), Number(row.time)]));
const failed = new Set(increments.filter((row) => row.status !== "converged").map((row) => Number(row.index)));
const states = {};
for (const name of [...Object.keys(files), ...Object.keys(pictures)]) {
  const found = name.match(/^contact_(\d+)(?:_(.*))?\.(csv|svg)$/);
  if (!found) continue;
  const [, number, boundary = report.boundaries && report.boundaries[0] ? report.boundaries[0].boundary : "contact", kind] = found;
  const all = (states[boundary] ||= new Map());
  const state = all.get(Number(number)) || {};
  state[kind] = name;
  all.set(Number(number), state);
}
const COLOURS = { stick: "var(--one)", slip: "var(--two)" };
const scaled = (values, unit) => {
  const [size, name] = prefix(Math.max(...values.map(Math.abs).filter(Number.isFinite), 0), unit);
  return [values.map((x) => x / size), name + unit];
};
function along(rows) {
  const x = ["x", "y", "z"].filter((name) => rows[0] && name in rows[0]).map((name) => rows.map((row) => Number(row[name])));
  const moves = x.map((c) => Math.max(...c) - Math.min(...c));
  const only = moves.findIndex((span) => span > 0.999 * Math.hypot(...moves));
  if (only >= 0) return [x[only], "xyz"[only]];
  let s = 0;
  return [rows.map((_, k) => (k ? (s += Math.hypot(...x.map((c) => c[k] - c[k - 1]))) : 0)), "distance along the contact"];
}
function showState() {
  const all = states[$("#boundary").value];
  if (!all) return;
  const numbers = [...all.keys()].sort((a, b) => a - b), slider = $("#state");
  slider.max = numbers.length - 1;
  const number = numbers[Math.min(Number(slider.value), numbers.length - 1)], state = all.get(number);
  const when = times.has(number) ? `, t = ${plain(times.get(number), 6)} s` : "";
  $("#when").textContent = `${number}${when}${failed.has(number) ? ", not converged" : ""}`;
  const picture = state.svg && pictures[state.svg];
  $("#contact .note").textContent = (picture ? "" : "Blue nodes stick, orange ones slip. ")
    + `${numbers.length} of ${report.totals.converged} increments are here: those of output.times in the scene, at most 40.`;
  $("#surface").replaceChildren();
  for (const id of ["#stresses", "#slips"]) $(id).hidden = Boolean(picture);
  if (picture) {
    const image = Object.assign(new Image(), { src: `data:image/svg+xml;base64,${picture}`, alt: `contact stresses in increment ${number}` });
    $("#surface").append(image);
    return;
  }
  const { rows } = parse(files[state.csv]);
  const [place, name] = along(rows), [s, unit] = scaled(place, LENGTH);
  const column = (key) => rows.map((row) => (row[key] === "" ? NaN : Number(row[key])));
  const [stress, stressUnit] = scaled([...column("sigma_n"), ...column("sigma_t")], STRESS), n = rows.length;
  // The contact zone, with half its width on both sides.
  const closed = s.filter((_, k) => rows[k].status !== "open");
  const [low, high] = [Math.min(...closed), Math.max(...closed)], margin = 0.5 * (high - low);
  const isNear = (x) => !closed.length || high === low || (x >= low - margin && x <= high + margin);
  const near = rows.map((_, k) => k).filter((k) => isNear(s[k]));
  const points = (values) => near.map((k) => [s[k], values[k]]);
  const marks = near.map((k) => COLOURS[rows[k].status]);
  draw($("#stresses"), [
    { name: "pressure", colour: "var(--one)", points: points(stress.slice(0, n)) },
    { name: "shear", colour: "var(--two)", points: points(stress.slice(n)), marks },
  ], [`${name}, ${unit}`, `stress, ${stressUnit}`]);
  const [lengths, lengthUnit] = scaled([...column("gap"), ...column("slip_t")], LENGTH);
  draw($("#slips"), [
    { name: "gap", colour: "var(--three)", points: points(lengths.slice(0, n)) },
    { name: "slip", colour: "var(--two)", points: points(lengths.slice(n)), marks },
  ], [`${name}, ${unit}`, `gap and slip, ${lengthUnit}`]);
}
for (const boundary of Object.keys(states)) $("#boundary").append(new Option(boundary));
$("#contact").hidden = !Object.keys(states).length;
addEventListener("resize", () => { showState(); showHistory(); });
$("#boundary").addEventListener("change", showState);
$("#state").addEventListener("input", showState);
// The page opens at the largest pressure, or at the last increment that converged.
if (Object.keys(states).length) {
  if (peak && states[peak.boundary]) $("#boundary").value = peak.boundary;
  const numbers = [...states[$("#boundary").value].keys()].sort((a, b) => a - b);
  const good = numbers.filter((number) => !failed.has(number));
  const start = numbers.find((number) => peak && times.get(number) === peak.time) ?? good[good.length - 1] ?? numbers[0];
  $("#state").max = numbers.length - 1;
  $("#state").value = numbers.indexOf(start);
  showState();
}

// The history: any quantity against time or against a probe.
const columns = new Map();
const put = (name, unit, index, value) => {
  if (!columns.has(name)) columns.set(name, { unit, values: new Map() });
  // Several supports or loads may act on one boundary.
  const { values } = columns.get(name);
  values.set(index, (values.get(index) || 0) + value);
};
for (const [index, time] of times) if (!failed.has(index)) put("time", "s", index, time);
if (files["forces.csv"]) for (const row of parse(files["forces.csv"]).rows)
  for (const key of ["f_x", "f_y", "f_z", "sum_p_n", "sum_p_t", "sum_p_o"])
    if (row[key]) put(`${row.kind} ${row.boundary}${row.obstacle ? ` ${row.obstacle}` : ""}: ${key}`, FORCE, Number(row.index), Number(row[key]));
for (const [name, text] of Object.entries(files)) if (name.startsWith("probe_")) {
  const { rows } = parse(text);
  for (const row of rows) for (const key of ["u_x", "u_y", "u_z"])
    if (row[key]) put(`${name.slice(6, -4)}${row.point && rows.some((other) => other.point !== row.point) ? ` ${row.point}` : ""}: ${key}`, LENGTH, Number(row.index), Number(row[key]));
}
if (files["increments.csv"]) {
  let sum = 0;
  for (const row of increments.filter((row) => row.status === "converged")) {
    put("strain energy", ENERGY, Number(row.index), Number(row.strain_energy));
    put("friction work so far", ENERGY, Number(row.index), (sum += Number(row.friction_work)));
    for (const key of ["stick", "slip"]) put(`nodes that ${key}`, "", Number(row.index), Number(row[key]));
  }
}
for (const name of columns.keys()) { $("#across").append(new Option(name)); $("#up").append(new Option(name)); }
function showHistory() {
  const [x, y] = ["#across", "#up"].map((id) => columns.get($(id).value));
  if (!x || !y) return;
  const both = [...y.values.keys()].filter((index) => x.values.has(index)).sort((a, b) => a - b);
  const [across, acrossUnit] = scaled(both.map((index) => x.values.get(index)), x.unit);
  const [up, upUnit] = scaled(both.map((index) => y.values.get(index)), y.unit);
  const label = (id, unit) => ($(id).value + (unit ? `, ${unit}` : ""));
  draw($("#curve"), [{ name: $("#up").value, colour: "var(--one)", points: across.map((value, k) => [value, up[k]]) }], [label("#across", acrossUnit), label("#up", upUnit)]);
}
$("#up").selectedIndex = Math.max(0, [...columns.keys()].findIndex((name) => /sum_p_t/.test(name)));
$("#across").addEventListener("change", showHistory);
$("#up").addEventListener("change", showHistory);
$("#history").hidden = times.size < 2;
showHistory();

// Pictures of the body.
const deformed = Object.keys(pictures).filter((name) => name.startsWith("deformed_")).sort();
$("#body").hidden = !deformed.length;
for (const name of deformed.slice(-1)) $("#body .picture").append(Object.assign(new Image(), { src: `data:image/svg+xml;base64,${pictures[name]}`, alt: "deformed body" }));

// Tables to sort and copy.
function table(section, head, rows) {
  const box = element("div", "", "table"), sheet = element("table"), top = sheet.createTHead().insertRow(), body = sheet.createTBody();
  let order = 1;
  const fill = () => body.replaceChildren(...rows.map((row) => {
    const line = element("tr");
    line.append(...row.map((cell) => element("td", typeof cell === "number" ? plain(cell, 6) : cell, typeof cell === "number" ? "" : "word")));
    return line;
  }));
  head.forEach((name, k) => {
    const cell = element("th"), button = element("button", name);
    button.addEventListener("click", () => {
      order = -order;
      rows.sort((a, b) => order * (typeof a[k] === "number" ? a[k] - b[k] : String(a[k]).localeCompare(String(b[k]))));
      fill();
    });
    cell.append(button);
    top.append(cell);
  });
  fill();
  const copy = element("button", "copy", "copy");
  copy.addEventListener("click", () => navigator.clipboard.writeText([head, ...rows].map((row) => row.join("\t")).join("\n")));
  box.append(sheet);
  $(section).append(copy, box);
}
const cells = (row, names) => names.map((name) => (row[name] === "" || Number.isNaN(Number(row[name])) ? row[name] : Number(row[name])));
if (files["forces.csv"]) {
  const { head, rows } = parse(files["forces.csv"]);
  const last = rows.length ? rows[rows.length - 1].index : "";
  const names = ["kind", "boundary", ...head.filter((name) => name === "obstacle" || /^[fm]_|^sum/.test(name))];
  table("#forces", names, rows.filter((row) => row.index === last).map((row) => cells(row, names)));
} else $("#forces").hidden = true;
if (files["increments.csv"]) {
  const names = ["index", "time", "status", "iterations", "open", "stick", "slip", "friction_work", "strain_energy"];
  table("#increments", names, increments.map((row) => cells(row, names)));
  const all = increments.length ? Number(increments[increments.length - 1].index) : 0;
  if (all > increments.length)
    $("#increments").append(element("p", `${increments.length} of ${all} increments are here. Iterations and friction work are sums since the row before.`, "note"));
} else $("#increments").hidden = true;
$("#scene pre").textContent = report.scene_text || "";
$("#scene").hidden = !report.scene_text;
$("footer").textContent = `Forces in ${FORCE}, lengths in ${LENGTH}, energies in ${ENERGY}. All numbers are in the files beside this page.`;
