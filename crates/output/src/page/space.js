// The body in space, turned by mouse and finger. Its surface is drawn with a depth buffer of its own: three.js would take 700 kB, and the pen of a canvas sorts no depths.
const GREY = [186, 192, 199], HIDDEN = 0.75;
// Returns how to draw the surface of `patches` in a canvas; `again` is called when it was turned, `tell` with the node at the pointer.
function spaceView({ x, patches, contact }, canvas, again, tell) {
  const n = x.length / 3, isContact = new Uint8Array(n);
  for (const node of contact) isContact[node] = 1;
  let yaw, pitch, zoom, sharp = 2, shown = null;
  const axes = () => {
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    return [[cy, sy, 0], [-sp * sy, sp * cy, cp], [sy * cp, -cy * cp, sp]];
  };
  // The view from the right and above, or that which shows the outside of the contact.
  function turnToContact() {
    let size = 0;
    const sum = [0, 0, 0];
    for (const patch of patches) if (patch.every((node) => isContact[node])) {
      const [a, b, c, d] = [0, 1, 2, patch.length - 1].map((k) => patch[k]), [p, q] = [[a, c], [b, d]].map(([from, to]) => [0, 1, 2].map((k) => x[3 * to + k] - x[3 * from + k]));
      const normal = [0, 1, 2].map((k) => p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3]);
      normal.forEach((value, k) => { sum[k] += value; });
      size += Math.hypot(...normal);
    }
    let best = null;
    for (const view of [[0.512, 0.41], [0.512, -0.41], [0.512 + Math.PI, 0.41], [0.512 + Math.PI, -0.41]]) {
      [yaw, pitch] = view;
      const towards = axes()[2].reduce((all, value, k) => all + value * sum[k], 0);
      if (!best || towards > best.towards + 0.2 * size) best = { view, towards };
    }
    [yaw, pitch] = best.view;
    zoom = 1;
  }

  // Draws the body with its nodes at `moved`. A colour of `table` shows the value of a patch, or of its nodes, nearest or `smooth`.
  function draw({ moved, ofPatch, ofNode, smooth, table }) {
    const wide = canvas.parentElement.clientWidth || 600, high = Math.round(Math.max(240, Math.min(420, 0.5 * innerHeight, wide)));
    const W = Math.round(wide * sharp), H = Math.round(high * sharp), pen = canvas.getContext("2d"), views = axes();
    canvas.style.height = `${high}px`; canvas.width = W; canvas.height = H;
    const [X, Y, Z] = views.map(([a, b, c]) => Float32Array.from({ length: n }, (_, k) => a * moved[3 * k] + b * moved[3 * k + 1] + c * moved[3 * k + 2]));
    const [[left, right], [low, top]] = [X, Y].map((all) => all.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]));
    const px = zoom * Math.min((W - 16 * sharp) / (right - left), (H - 16 * sharp) / (top - low));
    for (let k = 0; k < n; k++) [X[k], Y[k], Z[k]] = [W / 2 + px * (X[k] - (left + right) / 2), H / 2 - px * (Y[k] - (low + top) / 2), px * Z[k]];
    const image = pen.createImageData(W, H), dots = image.data, face = new Int32Array(W * H).fill(-1);
    const body = new Float32Array(W * H).fill(-Infinity), front = new Float32Array(W * H).fill(-Infinity);
    // A triangle of a patch; the side opposite the corner `open` is inside the patch.
    function fill(e, [a, b, c], open, light, nearest, values) {
      const [ax, ay, bx, by, cx, cy] = [X[a], Y[a], X[b], Y[b], X[c], Y[c]], area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      if (!area) return;
      const side = (k, x, y) => (k === open || Math.abs(area) < 40 * sharp * sharp ? Infinity : Math.abs(area) / Math.hypot(x, y) / sharp);
      const sides = [side(0, cx - bx, cy - by), side(1, cx - ax, cy - ay), side(2, bx - ax, by - ay)];
      const [first, last] = [Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5)), Math.min(W - 1, Math.floor(Math.max(ax, bx, cx) - 0.5))];
      const end = Math.min(H - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
      for (let j = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5)); j <= end; j++) for (let i = first; i <= last; i++) {
        const [p, q] = [i + 0.5 - ax, j + 0.5 - ay];
        const v = (p * (cy - ay) - (cx - ax) * q) / area, w = ((bx - ax) * q - p * (by - ay)) / area, u = 1 - v - w;
        if (u < 0 || v < 0 || w < 0) continue;
        const z = u * Z[a] + v * Z[b] + w * Z[c], k = j * W + i;
        if (z <= nearest[k]) continue;
        nearest[k] = z;
        face[k] = e;
        const value = !values ? 0 : smooth ? u * values[0] + v * values[1] + w * values[2] : values[u >= v && u >= w ? 0 : v >= w ? 1 : 2];
        const colour = values ? table[Math.round(value)] : GREY;
        const dark = light * (Math.min(u * sides[0], v * sides[1], w * sides[2]) < 0.5 ? 0.75 : 1);
        // The part of the contact that others hide shines through.
        const share = nearest === front && z < body[k] - 2 * sharp ? HIDDEN : 1;
        for (let c = 0; c < 3; c++) dots[4 * k + c] = share * dark * colour[c] + (share < 1 ? (1 - share) * dots[4 * k + c] : 0);
        dots[4 * k + 3] = 255;
      }
    }
    const late = [];
    patches.forEach((patch, e) => {
      const corners = [0, 1, 2, patch.length - 1].map((k) => patch[k]), [a, b, c, d] = corners;
      const [p, q] = [X, Y, Z].map((all) => [all[c] - all[a], all[d] - all[b]]).reduce(([p, q], [v, w]) => [[...p, v], [...q, w]], [[], []]);
      const area = p[0] * q[1] - p[1] * q[0], light = Math.abs(area) / (Math.hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], area) || 1);
      const parts = d === c ? [[[a, b, c], -1, [0, 1, 2]]] : [[[a, b, c], 1, [0, 1, 2]], [[a, c, d], 2, [0, 2, 3]]];
      const values = ofPatch ? corners.map(() => ofPatch[e]) : corners.every((node) => isContact[node]) ? corners.map((node) => ofNode[node]) : null;
      const paint = (light, nearest, values) => parts.forEach(([nodes, open, own]) => fill(e, nodes, open, light, nearest, values && own.map((k) => values[k])));
      // Seen from outside a patch runs clockwise on the screen, where y points down.
      if (area < 0) paint(ofPatch ? 0.85 + 0.15 * light : 0.7 + 0.3 * light, body, ofPatch && values);
      if (!ofPatch && values) late.push(() => paint(0.92 + 0.08 * light, front, values));
    });
    for (const paint of late) paint();
    pen.putImageData(image, 0, 0);
    pen.scale(sharp, sharp);
    pen.font = "13px system-ui, sans-serif"; pen.fillStyle = pen.strokeStyle = getComputedStyle(canvas).color;
    [..."xyz"].forEach((name, c) => {
      const [dx, dy] = [20 * views[0][c], -20 * views[1][c]];
      pen.beginPath(); pen.moveTo(32, high - 32); pen.lineTo(32 + dx, high - 32 + dy); pen.stroke();
      pen.fillText(name, 28 + 1.4 * dx, high - 28 + 1.4 * dy);
    });
    shown = { face, W, X, Y };
  }

  let waits = false;
  const soon = (fine) => {
    sharp = fine ? 2 : 1;
    if (!waits) requestAnimationFrame(() => { waits = false; again(); });
    waits = true;
  };
  const turn = (across, down) => { yaw -= across; pitch = Math.max(-1.57, Math.min(1.57, pitch + down)); };
  const fingers = new Map();
  canvas.classList.add("turns");
  canvas.tabIndex = 0;
  canvas.addEventListener("pointerdown", (event) => { fingers.set(event.pointerId, [event.clientX, event.clientY]); canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId), now = [event.clientX, event.clientY];
    if (!before) {
      const [i, j] = [event.offsetX, event.offsetY].map((c) => Math.floor(c * sharp)), e = shown.face[j * shown.W + i];
      tell(e < 0 || e === undefined ? -1 : patches[e].reduce((best, node) => { const far = (k) => Math.hypot(shown.X[k] - i, shown.Y[k] - j); return far(node) < far(best) ? node : best; }), e);
      return;
    }
    const other = [...fingers].find(([id]) => id !== event.pointerId), far = ([a, b]) => Math.hypot(a - other[1][0], b - other[1][1]);
    if (other) zoom = Math.max(0.5, Math.min(20, (zoom * far(now)) / (far(before) || 1)));
    else turn((now[0] - before[0]) / 120, (now[1] - before[1]) / 120);
    fingers.set(event.pointerId, now);
    soon(false);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => { fingers.delete(event.pointerId); soon(true); });
  canvas.addEventListener("wheel", (event) => { if (event.ctrlKey) { event.preventDefault(); zoom = Math.max(0.5, Math.min(20, zoom * Math.exp(-event.deltaY / 200))); soon(true); } }, { passive: false });
  canvas.addEventListener("dblclick", () => { turnToContact(); soon(true); });
  canvas.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    if (by) { event.preventDefault(); turn(...by); soon(true); }
  });
  turnToContact();
  return draw;
}
