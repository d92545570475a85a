//! A load cycle against closed forms: the cylinder of Cattaneo and Mindlin pushed to and fro, and a block that slides.

// The figures of doc/method/verification.md, with --nocapture.
use crate::common::prelude::*;
use stickslip::run::report::{CycleNode, SlipRegime};

/// Keeps the checkpoint after some increments.
struct At(usize, Option<Vec<u8>>);

impl Observer for At {
    fn checkpoint_offered(&mut self, here: &dyn Fn() -> Checkpoint) {
        let checkpoint = here();
        if checkpoint.increments() == self.0 {
            self.1 = Some(checkpoint.to_bytes().unwrap());
        }
    }

    fn iteration(&mut self, _: usize, _: &stickslip::solver::IterationRecord) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

fn solve(name: &str, overrides: &[&str]) -> RunReport {
    Run::new(&common::scene(name, overrides)).unwrap().solve(&mut ()).unwrap()
}

/// A cycle between ± Q dissipates `(μ P)²/(π E*) (2 (1 - s²) + 4 s ln s)` with s = 1 - Q/(μ P). From the first cycle on, all are
/// equal (Masing).
#[test]
fn cylinder_pushed_to_and_fro() {
    let far = 2.1e-5;
    let points = (2..=6).map(|k| format!("[{k}, {}, 0]", if k % 2 == 0 { far } else { -far }));
    let points = points.collect::<Vec<_>>().join(", ");
    let motion = format!("contact.obstacle.motion.translation=[[1, 0, 0], {points}]");
    let mesh = "mesh.elements=[[24,36,24],32]";
    let asked = "output.cycle=\"last\"";
    let overrides = [mesh, &motion, "time.end=6", "time.increments=96", "output.times=[]", asked];
    let report = solve("cattaneo_mindlin.toml", &overrides);
    let cycle = report.cycle.clone().unwrap();
    assert_eq!((cycle.start, cycle.end, cycle.earlier.len()), (4.0, 6.0, 1));
    assert_eq!((cycle.earlier[0].start, cycle.earlier[0].end), (2.0, 4.0));
    let friction: f64 = report.increments[64..].iter().map(|record| record.friction_work).sum();
    let of_nodes: f64 = cycle.nodes.iter().map(|node| node.energy_density * node.area).sum();
    assert!((cycle.friction_work / friction - 1.0).abs() < 1e-12);
    assert!((of_nodes / friction - 1.0).abs() < 1e-9, "{of_nodes} {friction}");
    let [pressed, pushed] = [report.forces[95].resultant.sums.sum_p_n, report.forces[95].resultant.sums.sum_p_t];
    let slides = 0.4 * pressed;
    let s = 1.0 - pushed.abs() / slides;
    let modulus = 210e9 / (1.0 - 0.499_f64.powi(2));
    let exact = slides * slides / (PI * modulus) * (2.0 * (1.0 - s * s) + 4.0 * s * s.ln());
    let error = cycle.friction_work / exact - 1.0;
    println!(
        "friction work of a cycle {:.6e} J/m, {:.2} % off, change {:?}",
        cycle.friction_work,
        100.0 * error,
        cycle.change
    );
    assert!(error.abs() < 0.003, "{error}");
    assert!(cycle.change.unwrap().abs() < 3e-3 && cycle.regime == SlipRegime::PartialSlip, "{:?}", cycle.change);
    // Every node comes back, and those that slip go both ways.
    let middle = cycle.nodes.iter().min_by(|a, b| (a.position[0] - 5.0).abs().total_cmp(&(b.position[0] - 5.0).abs()));
    assert_eq!(middle.unwrap().slip_path, 0.0);
    let largest = cycle.nodes.iter().map(|node| node.slip_range).fold(0.0, f64::max);
    assert!(largest > 0.0 && largest == cycle.boundaries[0].slip_range);
    let far = |of: fn(&CycleNode) -> f64| cycle.nodes.iter().map(of).fold(0.0, f64::max) / largest;
    let (drift, path) = (far(|node| node.slip_net), far(|node| (node.slip_path - 2.0 * node.slip_range).abs()));
    println!("of the largest slip range: net slip {drift:.1e}, path beyond twice the range {path:.1e}");
    assert!(drift < 1e-9 && path < 1e-9);
}

/// An obstacle slides below a pressed block to and fro. Once everything slides, each node does: the friction work is μ times
/// the pressure over the path, and the wear depth k times that.
#[test]
fn block_that_slides() {
    let motion = "contact.obstacle.motion.translation=[[0,0,0],[1,0,0],[2,1e-3,0],[4,-1e-3,0],[6,1e-3,0]]";
    let overrides = [
        "mesh.elements=[8,8]",
        "contact.obstacle={ kind = \"plane\", gap = 0 }",
        motion,
        "time.end=6",
        "time.increments=60",
        "load=[{ boundary = \"top\", traction = [0, -10e6], history = [[0, 0], [1, 1]] }]",
        "output.cycle=[2, 6]",
        "output.wear_coefficient=1e-14",
    ];
    let report = solve("block.toml", &overrides);
    let cycle = report.cycle.unwrap();
    let boundary = &cycle.boundaries[0];
    assert_eq!((cycle.regime, boundary.regime), (SlipRegime::GrossSlip, SlipRegime::GrossSlip));
    assert!(boundary.slip_net < 1e-3 * boundary.slip_range, "{boundary:?}");
    assert!(boundary.slip_range > 1.5e-3 && boundary.slip_range < 2e-3, "{boundary:?}");
    let mu = 0.4;
    for node in cycle.nodes.iter().filter(|node| node.slip_path > 0.0) {
        let wear = 1e-14 * node.energy_density / mu;
        assert!((node.wear_depth.unwrap() / wear - 1.0).abs() < 0.05, "{node:?} {wear}");
    }
    assert!((boundary.friction_work / cycle.friction_work - 1.0).abs() < 1e-9);
}

#[test]
fn a_cycle_is_taken_up() {
    let overrides = ["mesh.elements=[6,6]", "time.increments=20", "output.cycle=[0.5, 1]"];
    let scene = common::scene("block.toml", &overrides);
    let mut at = At(15, None);
    let whole = Run::new(&scene).unwrap().solve(&mut at).unwrap();
    assert!(whole.cycle.is_some());
    let checkpoint = Checkpoint::from_bytes(&at.1.unwrap()).unwrap();
    let resumed = Run::new(&scene).unwrap().from(checkpoint.clone()).solve(&mut ()).unwrap();
    assert_eq!(resumed.cycle, whole.cycle);
    let without = common::scene("block.toml", &overrides[..2]);
    assert!(Run::new(&without).unwrap().from(checkpoint).solve(&mut ()).is_err());
}

#[test]
fn a_history_without_a_cycle_is_warned_of() {
    let report = solve("block.toml", &["mesh.elements=[4,4]", "output.cycle=\"last\""]);
    assert!(report.cycle.is_none());
    let warning = report.warnings.iter().find(|warning| warning.kind == WarningKind::NOT_COMPUTED).unwrap();
    assert!(warning.message.contains("output.cycle"), "{}", warning.message);
}
