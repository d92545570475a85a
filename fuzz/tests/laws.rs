//! The measure of the laws sees each of them broken by little.

#![allow(clippy::unwrap_used)]

use stickslip::run::{RecordedIncrement, Recording, Run};
use stickslip::scene::Scene;
use stickslip_fuzz::runs::laws;

/// Pressed, pushed and pushed back: nodes stick, slip and are open.
const BLOCK: &str = "[mesh]\nkind = 'block'\nsize = [1, 1]\nelements = [6, 6]\n[material]\nyoung = 210e9\npoisson = 0.3\n\
    [[support]]\nboundary = 'left'\nfix = ['x', 'y']\n[[contact]]\nboundary = 'bottom'\nfriction = 0.4\n\
    obstacle = { kind = 'plane', gap = 1e-5 }\n[[load]]\nboundary = 'top'\ntraction = [0, -10e6]\nhistory = [[0, 0], [1, 1]]\n\
    [[load]]\nboundary = 'right'\ntraction = [-10e6, 0]\nhistory = [[0, 0], [1, 1], [2, 0]]\n[time]\nend = 2\nincrements = 4\n";

#[test]
fn every_law_is_measured() {
    let scene = Scene::parse("block.toml", BLOCK, &[]).unwrap();
    let run = Run::new(&scene).unwrap();
    let mut recording = Recording::all();
    run.solve(&mut recording).unwrap();
    let model = run.model();
    let last = recording.increments.len() - 1;
    let judged = |change: &dyn Fn(&mut RecordedIncrement)| {
        let mut increments = recording.increments.clone();
        change(&mut increments[last]);
        laws::check(model, &scene.solver, &increments).err().unwrap_or_default()
    };
    assert_eq!(judged(&|_| ()), "");

    let state = &recording.increments[last].state;
    let pressed = (0..model.contact.nodes.len()).max_by(|&a, &b| state.p_n[a].total_cmp(&state.p_n[b])).unwrap();
    let open = state.p_n.iter().position(|p| *p == 0.0).unwrap();
    let full = |&i: &usize| state.p_n[i] > 0.0 && (state.p_t[i].abs() / (0.4 * state.p_n[i]) - 1.0).abs() < 1e-9;
    let slipping = (0..model.contact.nodes.len()).find(full).unwrap();
    let largest = state.p_n.iter().fold(0.0_f64, |m, p| m.max(*p));
    let length = state.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));

    // Each change breaks equilibrium as well, which is told first, unless the loads are changed with it.
    let little = 1e-8 * largest;
    assert!(judged(&|increment| increment.state.u[7] += 1e-8 * length).contains("equilibrium"));
    assert!(judged(&|increment| increment.state.p_n[pressed] += little).contains("equilibrium"));
    assert!(judged(&|increment| increment.state.p_t[pressed] += little).contains("equilibrium"));

    // Judged beside a balance that is not asked for: these are told by the laws of contact.
    let contact = |change: &dyn Fn(&mut RecordedIncrement)| {
        let mut increment = recording.increments[last].clone();
        change(&mut increment);
        laws::contact_faults(model, &scene.solver, &recording.increments[..last], &increment)
    };
    assert_eq!(contact(&|_| ()), [""; 0]);
    let says = |change: &dyn Fn(&mut RecordedIncrement), words: &str| {
        let faults = contact(change);
        assert!(faults.iter().any(|fault| fault.contains(words)), "{words}: {faults:?}");
    };
    let down = |i: usize| model.problem.c_n().row(i)[0];
    says(&|increment| increment.state.u[down(pressed).0] += 1e-8 * length * down(pressed).1, "penetration");
    says(&|increment| increment.state.u[down(pressed).0] -= 1e-8 * length * down(pressed).1, "pressure across a gap");
    says(&|increment| increment.state.p_n[open] = -little, "tension");
    says(&|increment| increment.state.p_t[slipping] *= 1.0 + 1e-6, "friction beyond the cone");
    says(&|increment| increment.state.p_t[slipping] *= 1.0 - 1e-6, "slip without full friction");
    says(&|increment| increment.state.p_t[slipping] *= -1.0, "slip without full friction");
}
