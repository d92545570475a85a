// The contact: its states by boundary and increment, each with the name of a table or of a picture.
const states = {};
for (const { increment, boundary, file } of contacts) (states[boundary] ||= new Map()).set(increment, file);
const COLOURS = { stick: "var(--one)", slip: "var(--two)" };
function along(rows) {
  const x = ["x", "y", "z"].filter((name) => rows[0] && name in rows[0]).map((name) => rows.map((row) => Number(row[name])));
  const moves = x.map((c) => Math.max(...c) - Math.min(...c));
  const only = moves.findIndex((span) => span > 0.999 * Math.hypot(...moves));
  if (only >= 0) return [x[only], "xyz"[only]];
  let s = 0;
  return [rows.map((_, k) => (k ? (s += Math.hypot(...x.map((c) => c[k] - c[k - 1]))) : 0)), "distance along the contact"];
}
// Returns the numbers of the nodes in the contact zone and in half its width on both sides.
function nearZone(s, closed) {
  const zone = s.filter((_, k) => closed[k]), [low, high] = [Math.min(...zone), Math.max(...zone)], margin = 0.5 * (high - low);
  return [...s.keys()].filter((k) => !(high > low) || (s[k] >= low - margin && s[k] <= high + margin));
}
function showState() {
  const all = states[$("#boundary").value];
  if (!all) return;
  const numbers = [...all.keys()].sort((a, b) => a - b), slider = $("#state");
  slider.max = numbers.length - 1;
  const index = numbers[Math.min(Number(slider.value), numbers.length - 1)], file = all.get(index);
  const when = times.has(index) ? `, t = ${plain(times.get(index), 6)} s` : "";
  $("#when").textContent = `${index}${when}`;
  const picture = pictures[file];
  $("#contact .note").textContent = (picture ? "" : "Blue nodes stick, orange ones slip. ")
    + `States: ${numbers.length}, those of output.times in the scene, at most 40; increments: ${[...times.keys()].pop() || 0}.`;
  $("#surface").replaceChildren();
  for (const id of ["#stresses", "#slips"]) $(id).hidden = Boolean(picture);
  if (picture) {
    const image = Object.assign(new Image(), { src: `data:image/svg+xml;base64,${picture}`, alt: `contact stresses in increment ${index}` });
    $("#surface").append(image);
    return;
  }
  const { rows } = parse(files[file]);
  const [place, name] = along(rows), [s, unit] = scaled(place, LENGTH);
  const column = (key) => rows.map((row) => number(row[key]));
  const [stress, stressUnit] = scaled([...column("sigma_n"), ...column("sigma_t")], STRESS), n = rows.length;
  const near = nearZone(s, rows.map((row) => row.status !== "open"));
  const points = (values) => near.map((k) => [s[k], values[k]]);
  const marks = near.map((k) => COLOURS[rows[k].status]);
  draw($("#stresses"), [
    { name: "pressure", colour: "var(--one)", points: points(stress.slice(0, n)) },
    { name: "shear", colour: "var(--two)", points: points(stress.slice(n)), marks },
  ], [titled(name, unit), titled("stress", stressUnit)]);
  const [lengths, lengthUnit] = scaled([...column("gap"), ...column("slip_t")], LENGTH);
  draw($("#slips"), [
    { name: "gap", colour: "var(--three)", points: points(lengths.slice(0, n)) },
    { name: "slip", colour: "var(--two)", points: points(lengths.slice(n)), marks },
  ], [titled(name, unit), titled("gap and slip", lengthUnit)]);
}
for (const boundary of Object.keys(states)) $("#boundary").append(new Option(boundary));
$("#contact").hidden = !Object.keys(states).length;
atEachWidth(showState);
$("#boundary").addEventListener("change", showState);
$("#state").addEventListener("input", showState);
// The page opens at the largest pressure, or at the last state.
if (Object.keys(states).length) {
  if (peak && states[peak.boundary]) $("#boundary").value = peak.boundary;
  const numbers = [...states[$("#boundary").value].keys()].sort((a, b) => a - b);
  const start = numbers.find((index) => peak && times.get(index) === peak.time) ?? numbers[numbers.length - 1];
  $("#state").max = numbers.length - 1;
  $("#state").value = numbers.indexOf(start);
  showState();
}
