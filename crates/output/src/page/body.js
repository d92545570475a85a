// The body: in the plane with displacements magnified as the reader likes, in space a picture.
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const SHADES = [[248, 251, 255], [178, 208, 236], [96, 158, 212], [38, 98, 170]];
function shade(share) {
  const place = Math.min(1, Math.max(0, share)) * (SHADES.length - 1), k = Math.min(Math.floor(place), SHADES.length - 2);
  return `rgb(${[0, 1, 2].map((c) => Math.round(SHADES[k][c] + (place - k) * (SHADES[k + 1][c] - SHADES[k][c]))).join()})`;
}
// 1, 2 or 5 times a power of ten, at most this number and at least 1.
function readable(most) {
  if (!(most >= 1) || !Number.isFinite(most)) return 1;
  const power = 10 ** Math.floor(Math.log10(most) + 1e-12);
  return [5, 2, 1].map((k) => k * power).find((k) => k <= most * (1 + 1e-12)) || power;
}

function showPlaneBody([mesh, ...states]) {
  const nodes = new Uint16Array(bytes(mesh.nodes)), flat = new Uint16Array(bytes(mesh.patches));
  const x = Float64Array.from(nodes, (n, k) => mesh.low[k % 2] + mesh.step * n);
  const patches = Array.from({ length: flat.length / mesh.corners }, (_, e) => flat.subarray(e * mesh.corners, (e + 1) * mesh.corners));
  // The outline: the sides of one patch alone.
  const sides = new Map();
  for (const patch of patches) patch.forEach((a, k) => {
    const b = patch[(k + 1) % patch.length], key = `${Math.min(a, b)} ${Math.max(a, b)}`;
    if (a !== b) sides.set(key, sides.has(key) && mesh.corners > 2 ? null : [a, b]);
  });
  // In chains, so that dashes do not begin again at each side.
  const next = new Map();
  for (const [a, b] of [...sides.values()].filter(Boolean)) next.set(a, [...(next.get(a) || []), b]);
  const outline = [];
  for (const first of next.keys()) while (next.get(first).length) {
    const chain = [first];
    for (let node = first; (next.get(node) || []).length;) chain.push((node = next.get(node).pop()));
    outline.push(chain);
  }
  const size = [0, 1].map((c) => { let [low, high] = [Infinity, -Infinity]; for (let k = c; k < x.length; k += 2) [low, high] = [Math.min(low, x[k]), Math.max(high, x[k])]; return high - low; });
  const largest = Math.max(...states.map((state) => 32767 * state.step)), most = Math.max(...states.map((state) => state.most || 0));
  const usual = largest > 0 ? readable((0.05 * Math.hypot(...size)) / largest) : 1;
  const scales = [0, 1];
  for (let power = 1; power <= 10 * usual; power *= 10) for (const k of [2, 5, 10]) if (k * power <= 10 * usual) scales.push(k * power);
  const canvas = $("#canvas"), [slider, scale] = [$("#body-state"), $("#scale")];
  slider.max = states.length - 1; slider.value = Math.max(0, states.findIndex((state) => peak && state.time === peak.time) + 1 || states.length) - 1;
  slider.parentElement.hidden = states.length < 2;
  scale.max = scales.length - 1; scale.value = scales.indexOf(usual);
  const note = $("#drawn .note");
  let drawn = null, usualNote = "";
  function show() {
    const state = states[slider.value], factor = scales[scale.value], u = new Int16Array(bytes(state.u));
    const stress = state.stress && new Uint8Array(bytes(state.stress)), share = most > 0 && state.most ? state.most / most / 255 : 0;
    const moved = x.map((c, k) => c + factor * state.step * u[k]);
    $("#body-when").textContent = `${state.index}, t = ${plain(state.time, 6)} s`;
    $("#times").textContent = factor === 1 ? "as they are" : factor ? `× ${factor}` : "not shown";
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const at of [x, moved]) for (let k = 0; k < at.length; k += 2) {
      [left, right, low, high] = [Math.min(left, at[k]), Math.max(right, at[k]), Math.min(low, at[k + 1]), Math.max(high, at[k + 1])];
    }
    const wide = canvas.parentElement.clientWidth || 900, px = Math.min((wide - 12) / (right - left), 520 / (high - low));
    const high_px = Math.ceil(px * (high - low)) + 12, sharp = Math.max(2, devicePixelRatio || 1);
    canvas.style.height = `${high_px}px`; canvas.width = wide * sharp; canvas.height = high_px * sharp;
    const pen = canvas.getContext("2d"), start = (wide - px * (right - left)) / 2;
    const at = (places, node) => [start + px * (places[2 * node] - left), 6 + px * (high - places[2 * node + 1])];
    pen.scale(sharp, sharp);
    const style = getComputedStyle(document.documentElement), colour = (name) => style.getPropertyValue(name).trim();
    const line = (places, list) => { pen.beginPath(); for (const chain of list) chain.forEach((node, k) => pen[k ? "lineTo" : "moveTo"](...at(places, node))); pen.stroke(); };
    if (stress) patches.forEach((patch, e) => {
      const corners = Array.from(patch, (node) => at(moved, node));
      // The sides of cells that are thinner than four dots would hide their colours.
      const isFine = corners.some(([a, b], k) => { const [c, d] = corners[(k + 1) % corners.length]; return patch[k] !== patch[(k + 1) % patch.length] && Math.hypot(c - a, d - b) < 4; });
      pen.beginPath(); corners.forEach((corner, k) => pen[k ? "lineTo" : "moveTo"](...corner)); pen.closePath();
      pen.fillStyle = shade(share * stress[e]); pen.fill();
      pen.strokeStyle = isFine ? pen.fillStyle : "rgb(110,110,110)"; pen.lineWidth = isFine ? 0.5 : 0.4; pen.stroke();
    });
    pen.lineWidth = 1.2; pen.strokeStyle = colour("--ink"); line(moved, outline);
    if (factor) { pen.setLineDash([5, 4]); pen.strokeStyle = colour("--two"); line(x, outline); pen.setLineDash([]); }
    const length = u.reduce((most, _, k) => (k % 2 ? most : Math.max(most, Math.hypot(u[k], u[k + 1]))), 0) * state.step;
    note.textContent = usualNote = `Dashes: the body before the deformation. Magnified bodies may overlap. Largest displacement here ${rounded(length, LENGTH)}.${mesh.corners === 2 ? " The body has many elements: its outline is drawn." : " Point at a node to read it."}`;
    drawn = { state, stress, share, u, moved, at };
  }
  canvas.addEventListener("pointermove", (event) => {
    let best = { distance: 12 };
    for (let node = 0; node < x.length / 2; node++) {
      const [a, b] = drawn.at(drawn.moved, node), distance = Math.hypot(a - event.offsetX, b - event.offsetY);
      if (distance < best.distance) best = { node, distance };
    }
    if (best.node === undefined) { note.textContent = usualNote; return; }
    const { node } = best, [ux, uy] = [0, 1].map((c) => drawn.state.step * drawn.u[2 * node + c]);
    const around = drawn.stress ? patches.map((patch, e) => (patch.includes(node) ? drawn.share * drawn.stress[e] * most : -1)).filter((s) => s >= 0) : [];
    note.textContent = `At (${plain(x[2 * node])}, ${plain(x[2 * node + 1])}) ${LENGTH}: displacement (${rounded(ux, LENGTH, 3)}, ${rounded(uy, LENGTH, 3)})`
      + (around.length ? `, von Mises stress of the elements there ${rounded(Math.min(...around), STRESS, 3)} to ${rounded(Math.max(...around), STRESS, 3)}.` : ".");
  });
  for (const input of [slider, scale]) input.addEventListener("input", show);
  atEachWidth(show);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", show);
  const legend = $(".legend"), [zero, end] = legend.querySelectorAll("span");
  legend.hidden = !(most > 0);
  zero.textContent = "von Mises stress: 0"; end.textContent = rounded(most, STRESS);
  $("i", legend).style.background = `linear-gradient(to right, ${SHADES.map((rgb) => `rgb(${rgb.join()})`).join()})`;
  show();
}
const deformed = Object.keys(pictures).filter((name) => name.startsWith("deformed_")).sort();
$("#body").hidden = !deformed.length && !body.length;
$("#drawn").hidden = !body.length;
if (body.length) showPlaneBody(body);
for (const name of deformed.slice(-1)) $("#body .picture").append(Object.assign(new Image(), { src: `data:image/svg+xml;base64,${pictures[name]}`, alt: "deformed body" }));
