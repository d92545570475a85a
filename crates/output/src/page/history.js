// The history: any quantity against any other, as a loop if both return.
const columns = new Map();
function put(group, name, quantity, unit, index, value, adds) {
  if (!Number.isFinite(value)) return;
  if (!columns.has(name)) columns.set(name, { group, quantity, unit, values: new Map() });
  const { values } = columns.get(name);
  // Several supports or loads may act on one boundary.
  if (adds || !values.has(index)) values.set(index, (values.get(index) || 0) + value);
}
for (const [index, time] of times) if (!failed.has(index)) put("the run", "time", "", "s", index, time);
let workSoFar = 0;
for (const row of increments.filter((row) => row.status === "converged")) {
  const at = (name, column, value) => put("the run", name, quantities[column], unitOf(column), Number(row.index), value);
  at("friction work so far", "friction_work", (workSoFar += number(row.friction_work)));
  at("strain energy", "strain_energy", number(row.strain_energy));
  for (const key of ["stick", "slip"]) at(`nodes that ${key}`, key, number(row[key]));
}
function putTable(text, group, skipped) {
  const { head, rows } = parse(text);
  const keys = head.filter((key) => !skipped.includes(key));
  for (const row of rows) for (const key of keys) {
    const of = group(row, rows);
    put(of, `${of}: ${key}`, quantities[key], unitOf(key), Number(row.index), number(row[key]), ["force", "moment"].includes(quantities[key]));
  }
}
if (files["forces.csv"])
  putTable(files["forces.csv"], (row) => `${row.kind} ${row.boundary}${row.obstacle ? ` ${row.obstacle}` : ""}`, ["index", "time", "boundary", "kind", "obstacle", "balance"]);
for (const [file, name] of Object.entries(probes)) if (files[file])
  putTable(files[file], (row, rows) => `probe ${name}${rows.some((other) => other.point !== row.point) ? ` ${row.point}` : ""}`, ["index", "time", "point", "x", "y", "z"]);
for (const id of ["#across", "#up"]) {
  const groups = new Map();
  for (const [name, { group }] of columns) {
    if (!groups.has(group)) groups.set(group, Object.assign(document.createElement("optgroup"), { label: group }));
    groups.get(group).append(new Option(name));
  }
  $(id).append(...groups.values());
}

// A curve has returned if it is closer to a place than 2 % of the extent of the cycle in both directions, after it was farther away than 20 % of the
// whole extent.
const CLOSED = 0.02, AWAY = 0.2, BOTH = [0, 1];
// Returns the load cycles of the report, the last first, each as its points and their first and last place (-1: the undeformed body), as far as they
// are closed. `null` without a report, or if the curve has too few of its points.
function cyclesOfReport(indices, points) {
  if (!report.cycle) return null;
  const { start, end, earlier = [] } = report.cycle, slack = 1e-9 * end, at = indices.map((index) => times.get(index));
  const place = (time) => (time <= slack ? -1 : at.findIndex((other) => Math.abs(other - time) <= slack));
  const between = ({ start, end }) => {
    const [from, to] = [place(start), place(end)];
    return { points: from < 0 ? [[0, 0], ...points.slice(0, to + 1)] : points.slice(from, to + 1), from, to, isThere: to > from + 1 && (from >= 0 || start <= slack) };
  };
  const isClosed = ({ points }) => BOTH.every((c) => {
    const values = points.map((p) => p[c]), range = Math.max(...values) - Math.min(...values);
    return Math.abs(values[0] - values[values.length - 1]) <= CLOSED * range;
  });
  const cycles = [{ start, end }, ...[...earlier].reverse()].map(between);
  if (!cycles[0].isThere) return null;
  const open = cycles.findIndex((cycle) => !cycle.isThere || !isClosed(cycle));
  return open < 0 ? cycles : cycles.slice(0, open);
}
// Returns the cycles of a curve: those of the report, or without any those that the curve itself shows.
const cyclesOf = (indices, points) => cyclesOfReport(indices, points) || foundCycles(points);
// Returns the cycles between two returns of a curve, the last first, each as its points and their first and last place.
function foundCycles(points) {
  const low = BOTH.map((c) => Math.min(...points.map((p) => p[c]))), size = BOTH.map((c) => Math.max(...points.map((p) => p[c])) - low[c] || 1);
  const at = points.map((p) => BOTH.map((c) => (p[c] - low[c]) / size[c]));
  const found = [];
  for (let end = points.length - 1; end > 1;) {
    const p = at[end], range = BOTH.map((c) => [p[c], p[c]]);
    let best = null, away = false;
    for (let k = end - 1; k >= 0; k--) {
      const [a, b] = [at[k], at[k + 1]], along = BOTH.map((c) => b[c] - a[c]);
      for (const c of BOTH) range[c] = [Math.min(range[c][0], b[c]), Math.max(range[c][1], b[c])];
      if (!away) { away = Math.hypot(p[0] - a[0], p[1] - a[1]) > AWAY; continue; }
      const length = along[0] ** 2 + along[1] ** 2;
      const share = length ? Math.min(1, Math.max(0, ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / length)) : 0;
      const gap = Math.max(...BOTH.map((c) => Math.abs(p[c] - a[c] - share * along[c]) / (range[c][1] - range[c][0] || 1)));
      if (gap < CLOSED && (!best || gap < best.gap)) best = { k, share, gap };
      else if (best && gap >= CLOSED) break;
    }
    if (!best) break;
    const { k, share } = best, start = BOTH.map((c) => points[k][c] + share * (points[k + 1][c] - points[k][c]));
    found.push({ points: [start, ...points.slice(k + 1, end + 1)], from: k + share, to: end });
    end = Math.round(k + share);
  }
  return found;
}
// The area inside a polygon.
const area = (points) => Math.abs(points.reduce((sum, [x, y], k) => { const [a, b] = points[(k + 1) % points.length]; return sum + x * b - a * y; }, 0)) / 2;

function showHistory() {
  const [x, y] = ["#across", "#up"].map((id) => columns.get($(id).value));
  if (!x || !y) return;
  const both = [...y.values.keys()].filter((index) => x.values.has(index)).sort((a, b) => a - b);
  const raw = both.map((index) => [x.values.get(index), y.values.get(index)]);
  const [across, acrossUnit] = scaled(raw.map((p) => p[0]), x.unit), [up, upUnit] = scaled(raw.map((p) => p[1]), y.unit);
  const points = across.map((value, k) => [value, up[k]]);
  const labels = [titled($("#across").value, acrossUnit), titled($("#up").value, upUnit)];
  const returns = across.some((value, k) => k && value < across[k - 1]);
  const cycles = returns ? cyclesOf(both, points) : [], rawCycles = returns ? cyclesOf(both, raw) : [];
  const whole = { name: cycles.length ? "history" : $("#up").value, colour: cycles.length ? "var(--three)" : "var(--one)", points, arrows: returns && !cycles.length, ends: returns };
  const last = cycles.length ? [{ name: "last cycle", colour: "var(--two)", points: [...cycles[0].points, cycles[0].points[0]], arrows: true, wide: true }] : [];
  draw($("#curve"), [whole, ...last], labels);
  $("#loop").textContent = !returns ? "A drag zooms, a double click shows all again." : !cycles.length
    ? "Arrows show the direction of time. The curve is not closed: its end is farther than 2 % of its extent from where it was before."
    : `Arrows show the direction of time. The last cycle${during(both, cycles[0])} encloses ${areaOf(rawCycles[0], x, y)}${rawCycles[1] ? `, the one before ${areaOf(rawCycles[1], x, y)}` : ""}.`;
}
const during = (indices, { from, to }) => {
  const at = (k) => { if (k < 0) return 0; const [a, b] = [Math.floor(k), Math.ceil(k)].map((j) => times.get(indices[j])); return a + (k - Math.floor(k)) * (b - a); };
  return Number.isFinite(at(from)) && Number.isFinite(at(to)) ? ` (t = ${plain(at(from))} to ${plain(at(to))} s)` : "";
};
function areaOf(cycle, x, y) {
  const kinds = [x.quantity, y.quantity], size = area(cycle.points);
  if (known && kinds.includes("force") && kinds.includes("length"))
    return rounded((size * factor("force") * factor("length")) / factor("energy"), ENERGY);
  return [plain(size), [y.unit, x.unit].filter(Boolean).join(" · ")].join(" ").trim();
}
// An open loop encloses at least this share of the rectangle around it. A loop that encloses less than the second share is a line, but for rounding.
const OPEN = 1e-3, LINE = 1e-6;
// The history opens at the open loop of a force over the displacement with the largest range in the cycle, at a narrower loop, or at friction over time. Of equal ranges
// that with the larger area counts, or one before a probe, which has no force of its own but the contact forces along its displacement.
function widestLoop(share) {
  let widest = null;
  const contacts = [...columns].filter(([, column]) => column.group.startsWith("contact ")).map(([name]) => name);
  for (const [name, x] of columns) {
    const [, axis] = name.match(/: u_([xyz])$/) || [];
    if (!axis) continue;
    const own = name.replace(/: u_[xyz]$/, `: f_${axis}`);
    for (const up of columns.has(own) ? [own] : contacts.filter((other) => other.endsWith(`: f_${axis}`))) {
      const y = columns.get(up), both = [...x.values.keys()].filter((index) => y.values.has(index)).sort((a, b) => a - b);
      const [last] = cyclesOf(both, both.map((index) => [x.values.get(index), y.values.get(index)]));
      if (!last) continue;
      const [range, height] = BOTH.map((c) => Math.max(...last.points.map((p) => p[c])) - Math.min(...last.points.map((p) => p[c])));
      const size = area(last.points);
      if (!(size > share * range * height)) continue;
      const wider = widest ? range / widest.range - 1 : 1;
      if (wider > 1e-6 || (wider > -1e-6 && up === own && size > widest.size)) widest = { names: [name, up], range, size };
    }
  }
  return widest && widest.names;
}
const acts = (pattern) => [...columns].filter(([name, { values }]) => pattern.test(name) && [...values.values()].some((value) => value)).map(([name]) => name);
const overTime = ["time", acts(/^load .*: m_[xyz]$/)[0] || [...columns.keys()].find((name) => /sum_p_t/.test(name)) || [...columns.keys()][1] || ""];
[$("#across").value, $("#up").value] = widestLoop(OPEN) || widestLoop(LINE) || overTime;
for (const id of ["#across", "#up"]) $(id).addEventListener("change", showHistory);
atEachWidth(showHistory);
// Moments and rotations of couplings at the end are key results, too.
for (const name of acts(/^coupling .*: m_[xyz]$/)) {
  const { unit, values } = columns.get(name), [index, value] = [...values].pop(), turned = columns.get(name.replace(/m_(.)$/, "rotation_$1"));
  const angle = turned && turned.values.get(index);
  keyRow(name.replace(/^coupling (.*): m_(.)$/, "moment of $1 about $2"), rounded(value, unit), `t = ${plain(times.get(index))} s${angle ? `, turned by ${plain(angle)} rad` : ""}`, "", "");
}
$("#history").hidden = times.size < 2;
showHistory();
