//! `stickslip-studies gaps`.

use clap::Args;
use miette::miette;
use stickslip_output::Table;
use stickslip_studies::gaps::{Case, Shape};

use super::{Answer, jobs};

#[derive(Args)]
pub(super) struct GapsArgs {
    /// Only bodies whose name contains this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// So many computations at a time [default: as many as there are processors]
    #[arg(long, value_name = "NUMBER")]
    jobs: Option<u16>,
}

pub(super) fn gaps(args: &GapsArgs) -> miette::Result<Answer> {
    let name = |shape: Shape| format!("{shape:?}").to_lowercase();
    let mut table =
        Table::new(&["bodies", "order", "elements", "slave", "force", "peak", "told", "automatic", "warnings"]);
    let percent = |share: f64| format!("{:+.1} %", 100.0 * share);
    for shape in Shape::ALL.into_iter().filter(|shape| name(*shape).contains(&args.only)) {
        let exact = shape.exact().map_err(|error| miette!("{}: {error}", name(shape)))?;
        let sides = |elements| [0, 1].map(|slave| (elements, slave));
        let meshes: Vec<_> = shape.elements().into_iter().flat_map(sides).collect();
        let of_order =
            |second_order| meshes.iter().map(move |&(elements, slave)| Case { shape, elements, slave, second_order });
        let cases: Vec<Case> = of_order(false).chain(of_order(true)).collect();
        let all = jobs::run(&cases, jobs::count(args.jobs), |case| format!("{case:?}"), Case::run);
        for (case, told) in cases.iter().zip(all.map_err(|error| miette!("{error}"))?) {
            let kinds: Vec<&str> = told.kinds.iter().map(|kind| kind.name).collect();
            table.push(vec![
                name(shape),
                if case.second_order { "2" } else { "1" }.into(),
                format!("{} : {}", case.elements[0], case.elements[1]),
                ["first", "second"][case.slave].into(),
                percent(told.found.force / exact.force - 1.0),
                percent(told.found.peak / exact.peak - 1.0),
                told.peak.map_or("-".into(), percent),
                if told.automatic == case.slave { "this" } else { "" }.into(),
                kinds.join(" "),
            ]);
        }
    }
    Ok(Answer { lines: vec![table.to_string()], has_passed: true })
}
