// The load cycle: `cycle` of the report in words, and any column of cycle.csv along the surface.
const cycle = report.cycle, perNode = files["cycle.csv"] ? parse(files["cycle.csv"]) : { head: [], rows: [] };
$("#per-cycle").hidden = !cycle && !perNode.rows.length;
const REGIMES = { stick: "no node slips", "partial-slip": "partial slip: nodes slip while others stick", "gross-slip": "gross slip: at some time all closed nodes of a boundary slip" };
// Cycles whose friction work differs by less from that of the cycle before have settled.
const SETTLED = 0.01;
if (cycle) {
  const { start, end, friction_work: work, change, earlier = [], boundaries = [] } = cycle;
  const trend = change == null ? "" : `, ${Math.abs(change) < 5e-4 ? "as much as" : `${percent(Math.abs(change))} ${change > 0 ? "more" : "less"} than`} in the cycle before: ${Math.abs(change) < SETTLED ? "it has settled" : "it still changes"}`;
  $("#per-cycle .words").textContent = REGIMES[cycle.regime] || cycle.regime || "";
  $("#facts").append(element("p", `From t = ${plain(start)} to ${plain(end)} s. Friction work ${rounded(work, ENERGY)}${trend}.`));
  const all = [...earlier, { end, friction_work: work }], [works, worksUnit] = scaled(all.map((one) => one.friction_work), ENERGY);
  if (all.length > 1) {
    const chart = element("div", "", "chart");
    $("#facts").append(chart);
    const show = () => draw(chart, [{ name: "friction work", colour: "var(--two)", points: all.map((one, k) => [one.end, works[k]]), marks: all.map(() => "var(--two)") }], ["end of the cycle, s", titled("friction work of a cycle", worksUnit)]);
    atEachWidth(show);
    show();
  }
  const head = ["boundary", "slip", titled("friction work", ENERGY), titled("largest slip range", LENGTH), titled("largest net slip", LENGTH)];
  if (boundaries.length) table($("#facts"), head, boundaries.map((of) => [of.boundary, of.regime, of.friction_work, of.slip_range, of.slip_net]));
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
    const near = isLine ? nearZone(x, rows.map((row) => row.sigma_n_mean === undefined || number(row.sigma_n_mean) > 0)) : [...x.keys()];
    const points = near.map((k) => [x[k], y[k]]);
    if (isLine) points.sort((a, b) => a[0] - b[0]);
    draw($("#cycle-chart"), [{ name: column, colour: "var(--one)", points, marks: isLine ? null : points.map(() => "var(--one)"), bare: !isLine }], [titled(name, xUnit), titled(column, yUnit)]);
  };
  for (const id of ["#cycle-boundary", "#cycle-across", "#cycle-up"]) $(id).addEventListener("change", showCycle);
  atEachWidth(showCycle);
  showCycle();
} else for (const node of [$("#per-cycle .controls"), $("#cycle-chart")]) node.hidden = true;
