// The body with displacements magnified as the reader likes: in the plane its cells with the contact pressure as bars, in space its surface, see space.js.
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const SHADES = [[248, 251, 255], [178, 208, 236], [96, 158, 212], [38, 98, 170]];
// The colours of nodes that are open, stick and slip.
const STATUSES = [[228, 231, 234], [47, 111, 208], [214, 96, 32]];
function shade(share) {
  const place = Math.min(1, Math.max(0, share)) * (SHADES.length - 1), k = Math.min(Math.floor(place), SHADES.length - 2);
  return [0, 1, 2].map((c) => Math.round(SHADES[k][c] + (place - k) * (SHADES[k + 1][c] - SHADES[k][c])));
}
const rgb = (colour) => `rgb(${colour.join()})`;
// 1, 2 or 5 times a power of ten, at most this number and at least 1.
function readable(most) {
  if (!(most >= 1) || !Number.isFinite(most)) return 1;
  const power = 10 ** Math.floor(Math.log10(most) + 1e-12);
  return [5, 2, 1].map((k) => k * power).find((k) => k <= most * (1 + 1e-12)) || power;
}


function showBody([mesh, ...states]) {
  const D = mesh.low.length, nodes = new Uint16Array(bytes(mesh.nodes)), flat = new Uint16Array(bytes(mesh.patches));
  const x = Float64Array.from(nodes, (n, k) => mesh.low[k % D] + mesh.step * n), contact = new Uint16Array(bytes(mesh.contact || ""));
  const patches = Array.from({ length: flat.length / mesh.corners }, (_, e) => flat.subarray(e * mesh.corners, (e + 1) * mesh.corners));
  const size = mesh.low.map((_, c) => { let [low, high] = [Infinity, -Infinity]; for (let k = c; k < x.length; k += D) [low, high] = [Math.min(low, x[k]), Math.max(high, x[k])]; return high - low; });
  const mostOf = (of) => states.reduce((most, state) => Math.max(most, of(state) || 0), 0), largest = mostOf((state) => 32767 * state.step);
  const usual = largest > 0 ? readable((0.05 * Math.hypot(...size)) / largest) : 1;
  const scales = [0, 1];
  for (let power = 1; power <= 10 * usual; power *= 10) for (const k of [2, 5, 10]) if (k * power <= 10 * usual) scales.push(k * power);
  const canvas = $("#canvas"), [slider, scale, choice] = [$("#body-state"), $("#scale"), $("#colour")];
  slider.max = states.length - 1; slider.value = Math.max(0, states.findIndex((state) => peak && state.time === peak.time) + 1 || states.length) - 1;
  slider.parentElement.hidden = states.length < 2;
  scale.max = scales.length - 1; scale.value = scales.indexOf(usual);
  // What a colour can show, the value of its darkest, and the unit.
  const STRESSES = "von Mises stress", SLOTS = 32767, kinds = new Map();
  for (const [name, key, unit] of [["contact pressure", "pressure", STRESS], ["slip", "slip", LENGTH]]) kinds.set(name, { key, unit, most: mostOf((state) => state[key] && SLOTS * state[key][0]) });
  kinds.set("contact status", { key: "status", most: contact.length });
  kinds.set(STRESSES, { key: "stress", unit: STRESS, most: mostOf((state) => state.most) });
  for (const [name, { most }] of kinds) if (most > 0 && (D === 3 || name === STRESSES)) choice.append(new Option(name));
  choice.parentElement.hidden = choice.options.length < 2;
  const atContact = (state, key) => Float64Array.from(new Int16Array(bytes(state[key][1])), (value) => state[key][0] * value);
  const note = $("#drawn .note"), placeOfContact = new Map(Array.from(contact, (node, k) => [node, k]));
  let drawn = null, usualNote = "";
  // Tells of a node, and of the patch at the pointer.
  function tell(node, patch) {
    if (node < 0) { note.textContent = usualNote; return; }
    const { state, u } = drawn, k = placeOfContact.get(node), own = (all, by = 1) => Array.from(all.subarray(D * node, D * node + D), (value) => by * value);
    const words = [`displacement (${own(u, state.step).map((c) => rounded(c, LENGTH, 3)).join(", ")})`];
    if (k !== undefined && state.status) words.push(`contact pressure ${rounded(atContact(state, "pressure")[k], STRESS, 3)}`, `slip ${rounded(atContact(state, "slip")[k], LENGTH, 3)}`, { o: "open", t: "sticks", l: "slips" }[state.status[k]]);
    if (drawn.stress) {
      const around = (patch >= 0 ? [patch] : [...patches.keys()].filter((e) => patches[e].includes(node))).map((e) => (state.most * drawn.stress[e]) / 255);
      words.push(`von Mises stress of the elements there ${[...new Set([Math.min(...around), Math.max(...around)].map((s) => rounded(s, STRESS, 3)))].join(" to ")}`);
    }
    note.textContent = `At (${own(x).map((c) => plain(c)).join(", ")}) ${LENGTH}: ${words.join(", ")}.`;
  }
  const draw = D === 3 ? spaceView({ x, patches, contact }, canvas, show, tell) : planeView({ x, patches, contact, corners: mesh.corners }, canvas, tell);
  function show() {
    const state = states[slider.value], factor = scales[scale.value], u = new Int16Array(bytes(state.u)), { key, unit, most } = kinds.get(choice.value) || {};
    const stress = state.stress && new Uint8Array(bytes(state.stress)), values = state.status ? { pressure: atContact(state, "pressure"), slip: atContact(state, "slip") } : {};
    $("#body-when").textContent = `${state.index}, t = ${plain(state.time, 6)} s`;
    $("#times").textContent = factor === 1 ? "as they are" : factor ? `× ${factor}` : "not shown";
    const length = Array.from({ length: u.length / D }, (_, k) => Math.hypot(...u.subarray(D * k, D * k + D))).reduce((a, b) => Math.max(a, b), 0) * state.step;
    const highest = kinds.get("contact pressure").most;
    usualNote = `${factor === 1 ? "" : "Magnified bodies may overlap. "}Largest displacement here ${rounded(length, LENGTH)}. `
      + (D === 3 ? "Drag to turn, point to read; what hides the contact is translucent." : `Dashes: the body before.${highest > 0 ? ` Bars: contact pressure, up to ${rounded(highest, STRESS)}; blue nodes stick, orange ones slip.` : ""}${mesh.corners === 2 ? " Of so many elements the outline is drawn." : ""}`);
    note.textContent = usualNote;
    drawn = { state, stress, u };
    const ofNode = new Float32Array(nodes.length / D);
    contact.forEach((node, k) => { ofNode[node] = key === "status" ? "otl".indexOf(state.status[k]) : values[key] ? (255 * Math.max(0, values[key][k])) / most : 0; });
    const ofPatch = key === "stress" ? stress.map((s) => Math.round((s * state.most) / most)) : null;
    draw({ moved: x.map((c, k) => c + factor * state.step * u[k]), factor, ofPatch, ofNode, smooth: key !== "status", table: key === "status" ? STATUSES : TABLE, pressure: highest > 0 ? values.pressure.map((p) => p / highest) : null, status: state.status });
    const legend = $(".legend"), [from, to] = legend.querySelectorAll("span"), isStatus = key === "status";
    legend.hidden = !key;
    [from.textContent, to.textContent] = isStatus ? ["open, stick, slip:", ""] : [`${choice.value}: 0`, rounded(most, unit)];
    const shades = isStatus ? STATUSES.flatMap((colour, k) => [0, 1].map((end) => `${rgb(colour)} ${(100 * (k + end)) / 3}%`)) : SHADES.map(rgb);
    $("i", legend).style.background = `linear-gradient(to right, ${shades.join()})`;
  }
  $("#png").addEventListener("click", () => {
    const sheet = element("canvas"), below = 0.12 * canvas.width, pen = sheet.getContext("2d");
    Object.assign(sheet, { width: canvas.width, height: canvas.height + below });
    pen.fillStyle = "#fff"; pen.fillRect(0, 0, sheet.width, sheet.height); pen.drawImage(canvas, 0, 0);
    const [from, to] = [...document.querySelectorAll(".legend span")].map((span) => span.textContent), colours = choice.value === "contact status" ? STATUSES : TABLE, letter = 0.026 * canvas.width;
    pen.fillStyle = "#000"; pen.font = `${letter}px sans-serif`;
    pen.fillText(`${title}, t = ${plain(drawn.state.time, 6)} s, displacements ${$("#times").textContent}`, letter, canvas.height + 1.4 * letter);
    pen.fillText(from, letter, canvas.height + 3.4 * letter); pen.fillText(to, canvas.width / 2 + 9 * letter, canvas.height + 3.4 * letter);
    const edge = (k) => Math.round(canvas.width / 2 + (8 * letter * k) / colours.length);
    colours.forEach((colour, k) => { pen.fillStyle = rgb(colour); pen.fillRect(edge(k), canvas.height + 2.5 * letter, edge(k + 1) - edge(k), letter); });
    Object.assign(element("a"), { href: sheet.toDataURL("image/png"), download: `${title}.png` }).click();
  });
  for (const input of [slider, scale, choice]) input.addEventListener("input", show);
  atEachWidth(show);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", show);
  show();
}
const TABLE = Array.from({ length: 256 }, (_, k) => shade(k / 255));

function planeView({ x, patches, contact, corners: most }, canvas, tell) {
  // The outline: the sides of one patch alone.
  const sides = new Map();
  for (const patch of patches) patch.forEach((a, k) => {
    const b = patch[(k + 1) % patch.length], key = `${Math.min(a, b)} ${Math.max(a, b)}`;
    if (a !== b) sides.set(key, sides.has(key) && most > 2 ? null : sides.get(key) || [a, b]);
  });
  // In chains, so that dashes do not begin again at each side. A node of the contact has the outward normal of its sides in the contact.
  const next = new Map(), inContact = new Set(contact), normals = new Map();
  for (const [a, b] of [...sides.values()].filter(Boolean)) {
    next.set(a, [...(next.get(a) || []), b]);
    if (inContact.has(a) && inContact.has(b)) for (const node of [a, b]) {
      const [dx, dy] = normals.get(node) || [0, 0];
      normals.set(node, [dx + x[2 * b + 1] - x[2 * a + 1], dy + x[2 * a] - x[2 * b]]);
    }
  }
  const outline = [];
  for (const first of next.keys()) while (next.get(first).length) {
    const chain = [first];
    for (let node = first; (next.get(node) || []).length;) chain.push((node = next.get(node).pop()));
    outline.push(chain);
  }
  const BAR = 36, margin = contact.length ? BAR + 6 : 6;
  let at = null;
  canvas.addEventListener("pointermove", (event) => {
    let best = { distance: 12, node: -1 };
    for (let node = 0; node < x.length / 2; node++) {
      const [a, b] = at(node), distance = Math.hypot(a - event.offsetX, b - event.offsetY);
      if (distance < best.distance) best = { node, distance };
    }
    tell(best.node);
  });
  return ({ moved, factor, ofPatch, table, pressure, status }) => {
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const at of [x, moved]) for (let k = 0; k < at.length; k += 2) {
      [left, right, low, high] = [Math.min(left, at[k]), Math.max(right, at[k]), Math.min(low, at[k + 1]), Math.max(high, at[k + 1])];
    }
    const wide = canvas.parentElement.clientWidth || 900, px = Math.min((wide - 2 * margin) / (right - left), (Math.max(240, Math.min(420, 0.5 * innerHeight)) - 2 * margin) / (high - low));
    const high_px = Math.ceil(px * (high - low)) + 2 * margin, sharp = Math.max(2, devicePixelRatio || 1);
    canvas.style.height = `${high_px}px`; canvas.width = wide * sharp; canvas.height = high_px * sharp;
    const pen = canvas.getContext("2d"), start = (wide - px * (right - left)) / 2;
    const to = (places, node) => [start + px * (places[2 * node] - left), margin + px * (high - places[2 * node + 1])];
    at = (node) => to(moved, node);
    pen.scale(sharp, sharp);
    const style = getComputedStyle(document.documentElement), colour = (name) => style.getPropertyValue(name).trim();
    const line = (places, list) => { pen.beginPath(); for (const chain of list) chain.forEach((node, k) => pen[k ? "lineTo" : "moveTo"](...to(places, node))); pen.stroke(); };
    if (ofPatch) patches.forEach((patch, e) => {
      const corners = Array.from(patch, at);
      // The sides of cells that are thinner than four dots would hide their colours.
      const isFine = corners.some(([a, b], k) => { const [c, d] = corners[(k + 1) % corners.length]; return patch[k] !== patch[(k + 1) % patch.length] && Math.hypot(c - a, d - b) < 4; });
      pen.beginPath(); corners.forEach((corner, k) => pen[k ? "lineTo" : "moveTo"](...corner)); pen.closePath();
      pen.fillStyle = rgb(table[ofPatch[e]]); pen.fill();
      pen.strokeStyle = isFine ? pen.fillStyle : "rgb(110,110,110)"; pen.lineWidth = isFine ? 0.5 : 0.4; pen.stroke();
    });
    pen.lineWidth = 1.2; pen.strokeStyle = colour("--ink"); line(moved, outline);
    if (factor) { pen.setLineDash([5, 4]); pen.strokeStyle = colour("--two"); line(x, outline); pen.setLineDash([]); }
    pen.lineWidth = 2;
    if (pressure) contact.forEach((node, k) => {
      const [a, b] = at(node), [dx, dy] = normals.get(node) || [0, 0], length = (BAR * Math.max(0, pressure[k])) / (Math.hypot(dx, dy) || 1);
      pen.strokeStyle = rgb(STATUSES["otl".indexOf(status[k])]);
      if (status[k] !== "o") { pen.beginPath(); pen.moveTo(a, b); pen.lineTo(a + length * dx, b - length * dy); pen.stroke(); }
    });
  };
}
const deformed = Object.keys(pictures).filter((name) => name.startsWith("deformed_")).sort();
$("#body").hidden = !deformed.length && !body.length;
$("#drawn").hidden = !body.length;
if (body.length) showBody(body);
for (const name of deformed.slice(-1)) $("#body .picture").append(Object.assign(new Image(), { src: `data:image/svg+xml;base64,${pictures[name]}`, alt: "deformed body" }));
