// Tables to sort and copy.
function table(section, head, rows) {
  const box = element("div", "", "table"), sheet = element("table"), top = sheet.createTHead().insertRow(), body = sheet.createTBody();
  let order = 1;
  sheet.style.setProperty("--columns", head.length);
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
  section.append(copy, box);
}
// Every table of the run that is one for all increments.
const cells = (row, names) => names.map((name) => (Number.isNaN(number(row[name])) ? row[name] : number(row[name])));
// Numbers that are rounding beside the largest of their column are 0.
function withoutRounding(rows) {
  (rows[0] || []).forEach((_, k) => {
    const most = Math.max(...rows.map((row) => (typeof row[k] === "number" ? Math.abs(row[k]) : 0)));
    for (const row of rows) if (typeof row[k] === "number" && Math.abs(row[k]) < 1e-12 * most) row[k] = 0;
  });
  return rows;
}
const SHOWN = {
  "forces.csv": ["Forces at the end of the last converged increment", (head) => ["kind", "boundary", ...head.filter((name) => !["index", "time", "boundary", "kind", "balance"].includes(name))]],
  "increments.csv": ["Increments", () => ["index", "time", "status", "iterations", "open", "stick", "slip", "friction_work", "strain_energy"]],
  "cycle.csv": ["Contact nodes in the load cycle"],
};
for (const [name, text] of Object.entries(files)) {
  if (/^(contact|probe)_/.test(name)) continue;
  const [title, columns = (head) => head] = SHOWN[name] || [name];
  const { head, rows } = parse(text);
  const section = element("section"), names = columns(head).filter((column) => head.includes(column));
  section.id = name.replace(/\.csv$/, "");
  section.append(element("h2", title));
  const last = name === "forces.csv" && rows.length ? rows[rows.length - 1].index : null;
  const shown = last === null ? rows : rows.filter((row) => row.index === last);
  table(section, names.map((column) => titled(column, unitOf(column))), withoutRounding(shown.map((row) => cells(row, names))));
  const all = name === "increments.csv" && rows.length ? Number(rows[rows.length - 1].index) : 0;
  if (all > rows.length)
    section.append(element("p", `${rows.length} of ${all} increments are here. Iterations and friction work are sums since the row before.`, "note"));
  $("#tables").append(section);
}
