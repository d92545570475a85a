//! The page of a sweep: table, chart and links to the reports of the variants, for any browser without a network.

use super::table::{Row, Sweep};
use serde_json::json;
use stickslip_output::{CHART_SCRIPT, Chart, Curve, Marker, filled};

impl Sweep {
    /// Returns the page, which draws the `chart`.
    pub fn to_html(&self, chart: &Chart) -> String {
        let heads = enclosed(&self.heads(), "<th><button>", "</button></th>");
        let curve = |Curve { label, points, line, marker, colour: [r, g, b] }: &Curve| {
            let colour = format!("#{r:02x}{g:02x}{b:02x}");
            json!({ "name": label, "colour": colour, "points": points, "bare": line.is_none(), "hollow": line.is_none() && *marker == Some(Marker::Square) })
        };
        let curves: Vec<_> = chart.panels.iter().flat_map(|panel| &panel.curves).map(curve).collect();
        let data = json!({ "titles": [&chart.x.label, &chart.y.label], "curves": curves }).to_string();
        let rows: String = self.variants.iter().map(|row| self.row(row)).collect();
        let notes: Vec<String> = self.notes().iter().map(|(label, note)| format!("{label}: {note}")).collect();
        let notes = enclosed(&notes, "<li>", "</li>");
        let converged = self.variants.iter().filter(|row| row.outcome.is_converged()).count();
        let verdict = format!("{} variants, {converged} converged", self.variants.len());
        let class = if converged == self.variants.len() { "good" } else { "bad" };
        let program = format!("stickslip {} &middot; {}", env!("CARGO_PKG_VERSION"), escaped(&self.command));
        let parts = [
            ("/*STYLE*/", include_str!("page/page.css")),
            ("<!--TITLE-->", &escaped(&self.title)),
            ("<!--PROGRAM-->", &program),
            ("<!--VERDICT-->", &format!("<p class=\"verdict {class}\">{verdict}</p>")),
            ("<!--SUBTITLE-->", &escaped(&chart.subtitle)),
            ("<!--HEADS-->", &heads),
            ("<!--ROWS-->", &rows),
            ("<!--NOTES-->", &if notes.is_empty() { notes } else { format!("<h2>Notes</h2><ul>{notes}</ul>") }),
            ("/*DATA*/", &data.replace('<', "\\u003c")),
            ("/*CHART*/", CHART_SCRIPT),
        ];
        filled(include_str!("page/page.html"), &parts)
    }

    /// Returns the row of a variant. Its verdict leads to its report.
    fn row(&self, row: &Row) -> String {
        let (verdict, cells) = (row.values.len(), self.cells(row));
        let cell = |(k, cell): (usize, &String)| match &row.results {
            Some(folder) if k == verdict => {
                format!("<td><a href=\"{}/report.html\">{}</a></td>", escaped(folder), escaped(cell))
            }
            _ => format!("<td>{}</td>", escaped(cell)),
        };
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<Vec<_>>().concat())
    }
}

/// Encloses each text, which is escaped, in tags.
fn enclosed(texts: &[String], open: &str, close: &str) -> String {
    texts.iter().map(|text| [open, &escaped(text), close].concat()).collect()
}

/// Escapes a text for HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
