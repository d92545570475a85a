// The last load cycle: `cycle` of the report in words, and any column of cycle.csv along the surface.
const cycle = report.cycle, perNode = files["cycle.csv"] ? parse(files["cycle.csv"]) : { head: [], rows: [] };
$("#per-cycle").hidden = !cycle && !perNode.rows.length;
const words = (key) => key.replaceAll("_", " ");
function entries(value, key = "", path = "") {
  if (value === null || value === undefined) return [];
  if (Array.isArray(value)) return value.every((x) => typeof x === "number") ? [[path, value.map((x) => plain(x)).join(", ")]] : value.flatMap((x, k) => entries(x, key, `${path} ${k + 1}`));
  if (typeof value === "object") return Object.entries(value).flatMap(([name, x]) => entries(x, name, `${path} ${words(name)}`.trim()));
  const unit = /energy|work/.test(key) && typeof value === "number" ? ENERGY : ["start", "end", "time"].includes(key) ? "s" : "";
  return [[path, typeof value === "number" ? rounded(value, unit) : typeof value === "boolean" ? (value ? "yes" : "no") : value]];
}
if (cycle) {
  const { verdict, ...others } = cycle;
  $("#per-cycle .words").textContent = typeof verdict === "string" ? words(verdict) : "";
  table($("#facts"), ["of the cycle", "value"], entries(typeof verdict === "string" ? others : cycle));
}
if (perNode.rows.length) {
  const numeric = perNode.head.filter((name) => perNode.rows.some((row) => Number.isFinite(number(row[name]))));
  const names = perNode.head.includes("boundary") ? [...new Set(perNode.rows.map((row) => row.boundary))] : [""];
  $("#cycle-boundary").append(...names.map((name) => new Option(name)));
  $("#cycle-boundary").parentElement.hidden = names.length < 2;
  $("#cycle-across").append(new Option("the surface"), ...numeric.map((name) => new Option(name)));
  $("#cycle-up").append(...numeric.map((name) => new Option(name)));
  $("#cycle-up").value = numeric.find((name) => /energy|slip_path/.test(name)) || numeric.find((name) => !["x", "y", "z", "node"].includes(name)) || numeric[0];
  // In space the nodes of a surface have no order.
  const inSpace = perNode.head.includes("z");
  if (inSpace) $("#cycle-across").value = "x";
  const showCycle = () => {
    const rows = perNode.rows.filter((row) => names.length < 2 || row.boundary === $("#cycle-boundary").value);
    const chosen = $("#cycle-across").value, column = $("#cycle-up").value;
    const [place, name, placeUnit] = chosen === "the surface" ? [...along(rows), LENGTH] : [rows.map((row) => number(row[chosen])), chosen, unitOf(chosen)];
    const [x, xUnit] = scaled(place, placeUnit), [y, yUnit] = scaled(rows.map((row) => number(row[column])), unitOf(column));
    const isLine = !inSpace && ["the surface", "x", "y"].includes(chosen);
    const points = x.map((value, k) => [value, y[k]]);
    if (isLine) points.sort((a, b) => a[0] - b[0]);
    draw($("#cycle-chart"), [{ name: column, colour: "var(--one)", points, marks: isLine ? null : points.map(() => "var(--one)"), bare: !isLine }], [titled(name, xUnit), titled(column, yUnit)]);
  };
  for (const id of ["#cycle-boundary", "#cycle-across", "#cycle-up"]) $(id).addEventListener("change", showCycle);
  addEventListener("resize", showCycle);
  showCycle();
} else for (const node of [$("#per-cycle .controls"), $("#cycle-chart")]) node.hidden = true;
