// A chart of curves { name, colour, points } with: `marks`, a colour or nothing for each point, `hollow` rings or discs; `arrows` in the direction of time; `ends`, its
// first and last point; `wide`, or `bare` without the curve itself. A drag zooms, and a double click or double tap shows all again.
// Own code: uPlot (51 kB) wants ascending x, which loops do not have; Chart.js takes 210 kB, and one more plugin to zoom.
const NS = "http://www.w3.org/2000/svg";
function draw(into, curves, titles, zoom = null) {
  const [across, up] = titles;
  into.replaceChildren();
  const points = curves.flatMap((curve) => curve.points).filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
  if (!points.length) return;
  const W = Math.min(900, Math.max(340, into.clientWidth || 900)), H = 300, L = 78, R = 16, T = 30, B = 46;
  const range = (k) => {
    let low = Math.min(...points.map((p) => p[k])), high = Math.max(...points.map((p) => p[k]));
    // Heights that vary by more than half of their size are shown from 0.
    if (k && high - low > 0.5 * Math.max(-low, high)) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
    // A smaller range is rounding.
    const size = Math.max(-low, high);
    return high - low > 1e-9 * size ? [low, high] : [low - (size / 2 || 1), high + (size / 2 || 1)];
  };
  const [[x0, x1], [y0, y1]] = zoom || [0, 1].map(range);
  const X = (x) => L + ((x - x0) / (x1 - x0)) * (W - L - R), Y = (y) => H - B - ((y - y0) / (y1 - y0)) * (H - T - B);
  const svg = document.createElementNS(NS, "svg");
  svg.setAttribute("viewBox", `0 0 ${W} ${H}`);
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${up} against ${across}`);
  const addTo = (parent) => (name, attributes, text = "") => {
    const node = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.textContent = text;
    parent.append(node);
    return node;
  };
  const add = addTo(svg);
  const ticks = (low, high, most) => {
    // Labels have at most six digits.
    const raw = Math.max((high - low) / most, 1e-5 * Math.max(-low, high)), power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw);
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(6)));
  };
  for (const y of ticks(y0, y1, 5)) {
    add("line", { class: y === 0 ? "zero" : "grid", x1: L, x2: W - R, y1: Y(y), y2: Y(y) });
    add("text", { x: L - 8, y: Y(y) + 4, "text-anchor": "end" }, `${y}`);
  }
  for (const x of ticks(x0, x1, Math.min(5, (W - L - R) / 80))) {
    add("line", { class: "grid", x1: X(x), x2: X(x), y1: T, y2: H - B });
    add("text", { x: X(x), y: H - B + 18, "text-anchor": "middle" }, `${x}`);
  }
  add("text", { x: (L + W - R) / 2, y: H - 6, "text-anchor": "middle" }, across);
  add("text", { x: 4, y: 16 }, up);
  const box = { x: L, y: T, width: W - L - R, height: H - T - B };
  const inside = addTo(add("svg", { ...box, viewBox: Object.values(box).join(" "), style: `overflow:${zoom ? "hidden" : "visible"}` }));
  for (const { name, colour, points, marks, hollow, arrows, ends, wide, bare } of curves) {
    const at = points.filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
    const shown = at.map(([x, y]) => [X(x), Y(y)]);
    if (!bare) inside("polyline", { points: shown.map((p) => p.map((c) => c.toFixed(1)).join(",")).join(" "), style: `stroke:${colour};stroke-width:${wide ? 2.6 : 1.6}` });
    if (arrows) for (const [x, y, angle] of arrowsOn(shown))
      inside("path", { class: "arrow", d: "M 7 0 L -6 5 L -6 -5 Z", transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) rotate(${angle.toFixed(0)})`, style: `fill:${colour}` });
    if (ends) [shown[0], shown[shown.length - 1]].forEach(([cx, cy], k) => inside("circle", { cx, cy, r: 4, style: `fill:${k ? colour : "var(--paper)"};stroke:${colour}` }));
    if (marks) marks.forEach((fill, k) => fill && Number.isFinite(points[k][0] + points[k][1]) && inside("circle", { cx: X(points[k][0]), cy: Y(points[k][1]), r: hollow ? 5 : 2.6, style: hollow ? `fill:none;stroke:${fill}` : `fill:${fill}` }));
  }
  const dot = inside("circle", { r: 4, style: "fill:var(--ink)", visibility: "hidden" });
  const tip = add("text", { y: T + 12, visibility: "hidden" });
  const frame = inside("rect", { class: "zoom", visibility: "hidden" });
  const place = (event) => {
    const { left, top, width } = svg.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top].map((c) => (c * W) / width);
  };
  // The ranges of a drag, along a side of the chart that it hardly crosses the whole; none if it is short along both.
  let from = null;
  const dragged = (to) => {
    const sides = from ? [0, 1].map((k) => [from[k], to[k]].sort((a, b) => a - b)) : [], isShort = ([a, b]) => b - a < 8;
    return sides.every(isShort) ? [] : sides.map((side, k) => (isShort(side) ? [[L, W - R], [T, H - B]][k] : side));
  };
  svg.addEventListener("pointerdown", (event) => { from = place(event); });
  svg.addEventListener("pointerup", (event) => {
    const [x, y] = dragged(place(event)), back = (c, start, length, low, high) => low + ((c - start) / length) * (high - low);
    from = null;
    if (x) draw(into, curves, titles, [x.map((c) => back(c, L, W - L - R, x0, x1)), y.map((c) => back(c, H - B, T + B - H, y0, y1)).reverse()]);
  });
  svg.addEventListener("dblclick", () => draw(into, curves, titles));
  svg.addEventListener("pointermove", (event) => {
    const mouse = place(event), [x, y] = dragged(mouse);
    if (x) Object.entries({ x: x[0], width: x[1] - x[0], y: y[0], height: y[1] - y[0], visibility: "visible" }).forEach(([key, value]) => frame.setAttribute(key, value));
    let best = null;
    for (const curve of curves) for (const [x, y] of curve.points) {
      const distance = Math.hypot(X(x) - mouse[0], Y(y) - mouse[1]);
      if (Number.isFinite(distance) && (!best || distance < best.distance)) best = { distance, x, y, name: curve.name };
    }
    if (!best) return;
    dot.setAttribute("cx", X(best.x)); dot.setAttribute("cy", Y(best.y)); dot.setAttribute("visibility", "visible");
    // The names are above the chart, and long ones do not fit in it.
    tip.textContent = `${8 * best.name.length > W / 2 ? "" : `${best.name}: `}${plain(best.x)}, ${plain(best.y)}`;
    const late = X(best.x) > W / 2;
    tip.setAttribute("x", X(best.x) + (late ? -8 : 8)); tip.setAttribute("text-anchor", late ? "end" : "start"); tip.setAttribute("visibility", "visible");
  });
  const names = document.createElement("p");
  names.className = "names";
  const named = new Map(curves.map(({ name, colour }) => [name, colour]));
  if (named.size > 1) names.append(...[...named].map(([name, colour]) => Object.assign(document.createElement("span"), { textContent: name, style: `color:${colour}` })));
  into.append(names, svg);
}

// Returns the places and angles, degrees, of arrows at four parts of the length of a curve on the screen.
function arrowsOn(points) {
  const steps = points.slice(1).map(([x, y], k) => Math.hypot(x - points[k][0], y - points[k][1]));
  const whole = steps.reduce((sum, step) => sum + step, 0);
  if (!(whole > 60)) return [];
  let k = 0, before = 0;
  return [0.125, 0.375, 0.625, 0.875].map((part) => {
    while (k < steps.length - 1 && before + steps[k] < part * whole) before += steps[k++];
    const share = steps[k] ? (part * whole - before) / steps[k] : 0, [[a, b], [c, d]] = [points[k], points[k + 1]];
    return [a + share * (c - a), b + share * (d - b), (180 / Math.PI) * Math.atan2(d - b, c - a)];
  });
}

// Calls `show` when the width of the window changes. On a phone the height does so while a page is scrolled.
function atEachWidth(show) {
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; show(); } });
}

// Formats a number with few digits.
function plain(x, digits = 4) {
  if (!Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(Number(x.toPrecision(digits)));
  if (size >= 10 ** (digits - 1) && size < 1e6) return `${Math.round(x)}`;
  if (size < 1e-4 || size >= 1e6) return x.toExponential(digits - 1);
  return `${Number.isInteger(x) ? x : Number(x.toPrecision(digits))}`;
}
