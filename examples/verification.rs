//! The pictures of doc/method/verification.md: Hertz's pressure and the shear of Cattaneo and Mindlin beside their closed forms.
//!
//! `cargo run --release --example verification -- doc/method/verification`

#[path = "../tests/common/hertz.rs"]
mod hertz;

use hertz::Hertz;
use std::error::Error;
use stickslip::body::Model;
use stickslip::run::{Recording, Run};
use stickslip::scene::{Override, Scene};
use stickslip::solver::State;
use stickslip_output::{Axis, Chart, Curve, Dash, Line, Marker, Panel, Scale, write_file};

const YOUNG: f64 = 210e9;
const RADIUS: f64 = 100.0;

/// The model of a scene, and the states at the ends of all increments.
fn solve(name: &str) -> Result<(Model, Vec<State>), Box<dyn Error>> {
    let condensed = Override::value("solver.linear", "condensed");
    let scene = Scene::read(format!("data/scenes/{name}.toml").as_ref(), &[condensed])?;
    let (run, mut recording) = (Run::new(&scene)?, Recording::all());
    run.solve(&mut recording)?;
    Ok((run.into_model(), recording.increments.into_iter().map(|increment| increment.state).collect()))
}

/// Stresses (MPa) over the distance (mm) at the nodes where `place` gives one (m), on the closed form.
fn panel(
    model: &Model,
    title: &str,
    forces: &[f64],
    place: impl Fn([f64; 3]) -> Option<f64>,
    exact: impl Fn(f64) -> f64,
) -> Panel {
    let nodes = model.contact.nodes.iter().zip(forces);
    let mut nodes: Vec<[f64; 2]> = nodes.filter_map(|(c, p)| Some([place(c.position)?, p / c.weight])).collect();
    nodes.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [first, last] = [nodes.first(), nodes.last()].map(|node| node.map_or(0.0, |node| node[0]));
    let fine = (0..=400).map(|k| first + (last - first) * f64::from(k) / 400.0).map(|x| [x, exact(x)]);
    let scaled = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, p]| [1e3 * x, 1e-6 * p]).collect();
    let colour = [31, 90, 160];
    let closed = Some(Line { dash: Dash::Solid, width: 1.4 });
    let computed = scaled(nodes);
    Panel {
        title: title.into(),
        curves: vec![
            Curve { label: "computed".into(), points: computed, line: None, marker: Some(Marker::Circle), colour },
            Curve {
                label: "closed form".into(),
                points: scaled(fine.collect()),
                line: closed,
                marker: None,
                colour: [0; 3],
            },
        ],
        ..Panel::default()
    }
}

/// Distances along x from `middle`, where they are at most `width` and nothing is aside.
fn along(middle: f64, width: f64) -> impl Fn([f64; 3]) -> Option<f64> {
    move |x| (x[2] == 0.0 || x[1] == 0.0).then_some(x[0] - middle).filter(|x| x.abs() <= width)
}

fn chart(title: &str, subtitle: &str, quantity: &str, panels: Vec<Panel>) -> Chart {
    Chart {
        title: title.into(),
        subtitle: subtitle.into(),
        x: Axis { label: "x, mm".into(), scale: Scale::Linear },
        y: Axis { label: format!("{quantity}, MPa"), scale: Scale::Linear },
        columns: panels.len(),
        panels,
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("give a folder for the pictures")?;
    std::fs::create_dir_all(&folder)?;

    let (model, states) = solve("hertz_line")?;
    let p_n = &states.last().ok_or("no increment")?.p_n;
    let hertz = Hertz::line(2.0 * p_n.iter().sum::<f64>(), RADIUS, YOUNG / (1.0 - 0.3 * 0.3));
    let pressure = panel(&model, "", p_n, along(0.0, 1.2 * hertz.a), |x| hertz.pressure(x));
    let picture = chart("Hertz: a cylinder on a half-plane", "hertz_line.toml", "contact pressure", vec![pressure]);
    write_file(folder.as_ref(), "hertz_line.svg", &picture.to_svg()?)?;

    let (model, states) = solve("hertz_sphere")?;
    let p_n = &states.last().ok_or("no increment")?.p_n;
    let hertz = Hertz::sphere(4.0 * p_n.iter().sum::<f64>(), RADIUS, YOUNG / (1.0 - 0.3 * 0.3));
    let pressure = panel(&model, "", p_n, along(0.0, 1.2 * hertz.a), |x| hertz.pressure(x));
    let picture = chart("Hertz: a sphere on a half-space", "hertz_sphere.toml", "contact pressure", vec![pressure]);
    write_file(folder.as_ref(), "hertz_sphere.svg", &picture.to_svg()?)?;

    let (model, states) = solve("cattaneo_mindlin")?;
    let mu = 0.4;
    let share = |state: &State| -state.p_t.iter().sum::<f64>() / (mu * state.p_n.iter().sum::<f64>());
    let [.., pushed, _, back] = &states[..] else { return Err("too few increments".into()) };
    let (most, least) = (share(pushed), share(back));
    let hertz = Hertz::line(back.p_n.iter().sum(), RADIUS, YOUNG / (1.0 - 0.499 * 0.499));
    let place = || along(5.0, 1.2 * hertz.a);
    let panels = vec![
        panel(&model, &format!("Q = {most:.2} μ P"), &pushed.p_t, place(), |x| -mu * hertz.shear(x, most)),
        panel(&model, &format!("back at Q = {least:.2} μ P"), &back.p_t, place(), |x| {
            -mu * hertz.shear_unloaded(x, most, least)
        }),
    ];
    let picture = chart("Cattaneo and Mindlin", "cattaneo_mindlin.toml", "tangential traction", panels);
    write_file(folder.as_ref(), "cattaneo_mindlin.svg", &picture.to_svg()?)?;

    let (model, states) = solve("mindlin_sphere")?;
    let state = states.last().ok_or("no increment")?;
    let (q, middle) = (share(state), 1.0);
    let hertz = Hertz::sphere(2.0 * state.p_n.iter().sum::<f64>(), RADIUS, YOUNG / (1.0 - 0.49 * 0.49));
    let width = 1.2 * hertz.a;
    let aside = |x: [f64; 3]| ((x[0] - middle).abs() < 1e-9 && x[1] <= width).then_some(x[1]);
    let exact = |r| -mu * hertz.shear_of_sphere(r, q);
    let panels = vec![
        panel(&model, "along the push", &state.p_t, along(middle, width), exact),
        panel(&model, "across the push", &state.p_t, aside, exact),
    ];
    let subtitle = format!("mindlin_sphere.toml, Q = {q:.2} μ P");
    let mut picture = chart("Mindlin: a sphere pushed sideways", &subtitle, "tangential traction", panels);
    picture.x.label = "distance from the middle, mm".into();
    write_file(folder.as_ref(), "mindlin_sphere.svg", &picture.to_svg()?)?;
    Ok(())
}
