//! What tables and reports tell of boundaries of second order.

use super::{lines, pressed, pushed, solve};
use crate::common::prelude::*;

/// Looks at tables.
struct Tables<'a>(&'a Model);
impl Observer for Tables<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let u = self.0.displacements(step.record.time, &step.state.u).unwrap();
        let lines = ContactLine::all(self.0, step);
        for point in &lines[0].points {
            let [_, t, _] = point.frame;
            assert!((point.w_n - dot(u[point.node], point.frame[0])).abs() < 1e-14);
            assert!((point.w_t - dot(u[point.node], t)).abs() < 1e-14);
            assert!((point.slip_t - point.w_t).abs() < 1e-14);
            let gap = 0.02 * (point.x - 0.4).powi(2);
            assert!((point.gap - (gap - point.w_n)).abs() < 1e-14, "{point:?}");
            assert!(point.gap > -1e-12);
        }
        // In a row: from end to end, the middles between.
        assert!(lines[0].points.windows(2).all(|pair| (pair[0].x - pair[1].x).abs() < 0.1));
        ControlFlow::Continue(())
    }
}

/// Displacements, gaps and slips of tables are those of the nodes, not of the rows.
#[test]
fn tables_tell_of_nodes() {
    let (_, model, times) = pushed("triangle6", "[6, 3]");
    solve(&model, &times, SolverChoice::default(), &mut Tables(&model));
}

/// The largest pressure of a run, and the peak that its estimate is about, are those of the tables.
#[test]
fn one_peak_in_all_reports() {
    let scene = pressed("triangle6", "[8, 8]", 0.0, "0.1 * (x - 0.5)^2 - 0.01", "");
    let model = discretise(&scene).unwrap();
    let (_, lines) = lines(&model, &[1.0], scene.solver);
    let peak = lines[0].points.iter().map(|point| point.sigma_n).fold(0.0, f64::max);
    let mean = lines[0].points.iter().zip(&model.contact.nodes).map(|(point, contact)| point.p_n / contact.weight);
    assert!(peak > 1.01 * mean.fold(0.0, f64::max));
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    let near = |pressure: f64| (pressure / peak - 1.0).abs() < 1e-9;
    assert!(near(report.largest_pressure.unwrap().pressure.unwrap()));
    assert!(near(report.estimates.contact[0].peak_pressure));
}

/// The forces of the nodes add up to that on the obstacle, where each node has a normal of its own, too.
#[test]
fn forces_of_nodes_add_up() {
    let scene = pressed("triangle6", "[8, 4]", 0.0, "0", "");
    let round = "{ kind = \"cylinder\", radius = 0.7, apex = [0.4, 0.99], direction = \"nearest\" }";
    let scene = scene.with(&[format!("contact.obstacle={round}").parse().unwrap()]).unwrap();
    let model = discretise(&scene).unwrap();
    let (HistoryOutcome { state, .. }, lines) = lines(&model, &[1.0], scene.solver);
    let [on_obstacle] = &Resultant::all(&model, 1.0, &state)[..] else { panic!() };
    for axis in 0..2 {
        let sum: f64 = lines[0].points.iter().map(|point| point.force[axis]).sum();
        assert!((sum - on_obstacle.force[axis]).abs() < 1e-12 * on_obstacle.force[1].abs(), "{sum} {on_obstacle:?}");
    }
}
