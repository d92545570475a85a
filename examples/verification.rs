//! The pictures of doc/verification.md: Hertz's pressure and the shear of Cattaneo and Mindlin beside their closed forms.
//!
//! `cargo run --release --example verification -- doc/verification`

#[path = "../tests/common/hertz.rs"]
mod hertz;

use std::error::Error;

use hertz::Hertz;
use stickslip::history::{self, HistorySettings, Observer, Step};
use stickslip::linear::Direct;
use stickslip::model::Model;
use stickslip::nonlinear::Flow;
use stickslip::problem::State;
use stickslip::report::{Axis, Chart, Curve, Dash, Line, Marker, Panel, Scale, write_file};
use stickslip::scene::Scene;

const YOUNG: f64 = 210e9;
const RADIUS: f64 = 100.0;

/// The states at the ends of all increments.
#[derive(Default)]
struct States(Vec<State>);

impl Observer for States {
    fn increment(&mut self, step: &Step<'_>) -> Flow {
        self.0.push(step.state.clone());
        Flow::Continue
    }
}

fn solve(name: &str) -> Result<(Model, Vec<State>), Box<dyn Error>> {
    let scene = Scene::read(format!("data/scenes/{name}.toml").as_ref(), &[])?;
    let model = Model::new(&scene)?;
    let settings = HistorySettings::bn(&model.problem, model.scaling(), 200, 1e-10);
    let mut states = States::default();
    let times = scene.time.all();
    history::run(&model.problem, &model.loading, &times, &settings, &mut Direct::default(), &mut states)?;
    Ok((model, states.0))
}

/// Stresses (MPa) over x (mm) from `middle` (m), the nodes on the closed form, where that reaches `width` (m).
fn panel(model: &Model, title: &str, forces: &[f64], (middle, width): (f64, f64), exact: impl Fn(f64) -> f64) -> Panel {
    // The contact line, or the edge of the surface on the symmetry plane.
    let row = model.contacts.iter().map(|c| c.position[1]).fold(f64::INFINITY, f64::min);
    let along = model.contacts.iter().zip(forces).filter(|(c, _)| c.position[1] == row);
    let nodes = along.map(|(c, p)| [c.position[0] - middle, p / c.weight]);
    let mut nodes: Vec<[f64; 2]> = nodes.filter(|point| point[0].abs() <= width).collect();
    nodes.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let first = nodes.first().map_or(0.0, |point| point[0]);
    let fine = (0..=400).map(|k| first + (width - first) * f64::from(k) / 400.0).map(|x| [x, exact(x)]);
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
    }
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
    let pressure = panel(&model, "", p_n, (0.0, 1.2 * hertz.a), |x| hertz.pressure(x));
    let picture = chart("Hertz: a cylinder on a half-plane", "hertz_line.toml", "contact pressure", vec![pressure]);
    write_file(folder.as_ref(), "hertz_line.svg", &picture.to_svg()?)?;

    let (model, states) = solve("hertz_sphere")?;
    let p_n = &states.last().ok_or("no increment")?.p_n;
    let hertz = Hertz::sphere(4.0 * p_n.iter().sum::<f64>(), RADIUS, YOUNG / (1.0 - 0.3 * 0.3));
    let pressure = panel(&model, "", p_n, (0.0, 1.5 * hertz.a), |x| hertz.pressure(x));
    let picture = chart("Hertz: a sphere on a half-space", "hertz_sphere.toml", "contact pressure", vec![pressure]);
    write_file(folder.as_ref(), "hertz_sphere.svg", &picture.to_svg()?)?;

    let (model, states) = solve("cattaneo_mindlin")?;
    let mu = 0.4;
    let share = |state: &State| -state.p_t.iter().sum::<f64>() / (mu * state.p_n.iter().sum::<f64>());
    let [.., pushed, _, _, _, _, back] = &states[..] else { return Err("too few increments".into()) };
    let (most, least) = (share(pushed), share(back));
    let hertz = Hertz::line(back.p_n.iter().sum(), RADIUS, YOUNG / (1.0 - 0.49 * 0.49));
    let place = (1.2, 1.2 * hertz.a);
    let panels = vec![
        panel(&model, &format!("Q = {most:.2} μ P"), &pushed.p_t, place, |x| -mu * hertz.shear(x, most)),
        panel(&model, &format!("back at Q = {least:.2} μ P"), &back.p_t, place, |x| {
            -mu * hertz.shear_unloaded(x, most, least)
        }),
    ];
    let picture = chart("Cattaneo and Mindlin", "cattaneo_mindlin.toml", "tangential traction", panels);
    write_file(folder.as_ref(), "cattaneo_mindlin.svg", &picture.to_svg()?)?;
    Ok(())
}
