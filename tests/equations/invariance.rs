//! The verdict does not depend on the scaling of single rows and columns, on loads elsewhere, on parts that nothing
//! connects, on earlier increments, or on units. A state that breaks a law is not accepted under any of them.

use crate::common::prelude::*;
use stickslip::solver::Law;
use stickslip::solver::history::follow_exact_path;

const FACTORS: [f64; 6] = [1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12];

/// A problem with one increment and a state.
#[derive(Clone)]
struct Posed {
    entries: Vec<(usize, usize, f64)>,
    rows: [Vec<Vec<(usize, f64)>>; 2],
    mu: Vec<f64>,
    force: Vec<f64>,
    gap: Vec<f64>,
    w_t_last: Vec<f64>,
    u: Vec<f64>,
    p: [Vec<f64>; 2],
}

impl Posed {
    /// The end of the block's history, where nodes are open, stick and slip.
    fn block() -> Self {
        let scene = common::block(&["mesh.elements=[6,6]", "time.increments=2"]);
        let model = discretise(&scene).unwrap();
        let mut keep = common::Keep::default();
        common::run(&scene, &model, &mut keep);
        let problem = &model.problem;
        let (increment, state) = (keep.increment(1, model.loading.gap()), &keep.states[1]);
        let rows = |map: &Csr| (0..map.rows()).map(|i| map.row(i).to_vec()).collect();
        Posed {
            entries: problem.stiffness().assembled().unwrap().entries().filter(|(i, j, _)| i >= j).collect(),
            rows: [rows(problem.c_n()), rows(problem.c_t())],
            mu: problem.mu().to_vec(),
            force: increment.force.to_vec(),
            gap: increment.gap.to_vec(),
            w_t_last: increment.w_t_last.to_vec(),
            u: state.u.clone(),
            p: [state.p_n.clone(), state.p_t.clone()],
        }
    }

    fn problem(&self) -> ContactProblem {
        let n = self.u.len();
        let map = |rows: &Vec<Vec<(usize, f64)>>| Csr::from_rows(n, rows.iter().cloned()).unwrap();
        let [c_n, c_t] = self.rows.each_ref().map(map);
        let stiffness = Symmetric::from_triplets(n, &self.entries).unwrap();
        let rigid_modes = Some(Vec::new());
        ContactProblem::new(Parts { c_t, mu: self.mu.clone(), rigid_modes, ..Parts::new(stiffness, c_n) }).unwrap()
    }

    fn state(&self) -> State {
        let [p_n, p_t] = self.p.clone();
        State { u: self.u.clone(), u_rest: Vec::new(), p_o: vec![0.0; p_n.len()], p_t, p_n }
    }

    fn errors(&self, earlier: &KktScales) -> KktErrors {
        let (problem, zeros) = (self.problem(), vec![0.0; self.gap.len()]);
        let Posed { force, gap, mu, w_t_last, .. } = self;
        let increment = Increment { force, gap, mu, w_t_last, w_o_last: &zeros };
        KktErrors::measure(&problem, &increment, &self.state(), earlier).unwrap()
    }

    /// The rounding of the terms of equilibrium, relative to the largest contact force.
    fn rounding(&self) -> f64 {
        let mut sizes: Vec<f64> = self.force.iter().map(|f| f.abs()).collect();
        for &(i, j, k) in &self.entries {
            sizes[i] += (k * self.u[j]).abs();
            sizes[j] += if i == j { 0.0 } else { (k * self.u[i]).abs() };
        }
        f64::EPSILON * largest(&sizes) / largest(&self.p[0])
    }

    /// Contact node `i` in another unit.
    fn scale_row(&mut self, i: usize, factor: f64) {
        self.rows.iter_mut().flat_map(|rows| &mut rows[i]).for_each(|(_, c)| *c *= factor);
        self.gap[i] *= factor;
        self.w_t_last[i] *= factor;
        self.p.iter_mut().for_each(|p| p[i] /= factor);
    }

    /// Displacement `dof` in another unit.
    fn scale_column(&mut self, dof: usize, factor: f64) {
        for (row, column, value) in &mut self.entries {
            *value *= if *row == dof { factor } else { 1.0 } * if *column == dof { factor } else { 1.0 };
        }
        let entries = self.rows.iter_mut().flatten().flatten();
        entries.filter(|(column, _)| *column == dof).for_each(|(_, c)| *c *= factor);
        self.force[dof] *= factor;
        self.u[dof] /= factor;
    }

    /// Adds a spring that nothing connects with the body, with a load.
    fn add_elsewhere(&mut self, force: f64) {
        let n = self.u.len();
        self.entries.push((n, n, 1e6));
        self.force.push(force);
        self.u.push(force / 1e6);
    }
}

/// The solution, and states that break one law each by a share of the largest contact force.
fn states() -> Vec<(&'static str, Posed)> {
    let solution = Posed::block();
    let largest = largest(&solution.p[0]);
    let pressed = (0..solution.gap.len()).max_by(|&a, &b| solution.p[0][a].total_cmp(&solution.p[0][b])).unwrap();
    let broken = |change: &dyn Fn(&mut Posed)| {
        let mut posed = solution.clone();
        change(&mut posed);
        posed
    };
    vec![
        ("cone", broken(&|posed| posed.p[1][pressed] = 3.0 * posed.mu[pressed] * largest)),
        ("pressure", broken(&|posed| posed.p[0][pressed] *= 1.1)),
        ("no contact force", broken(&|posed| posed.p.iter_mut().for_each(|p| p.fill(0.0)))),
        ("moved", broken(&|posed| posed.u.iter_mut().for_each(|u| *u *= 1.001))),
        ("solution", solution),
    ]
}

/// Every error is the same to many digits, but for what is rounding; that of equilibrium is a violation or not, or the
/// `rounding` of its terms.
fn agree(name: &str, expected: &KktErrors, found: &KktErrors, rounding: f64) {
    for ((law, a), (_, b)) in expected.components().into_iter().zip(found.components()) {
        let same = (a - b).abs() <= 1e-6 * a.max(b) + 1e-10;
        let of_equilibrium = law == Law::Equilibrium && (a.min(b) > 1e-7 || (a - b).abs() <= rounding);
        assert!(same || of_equilibrium, "{name}: {law} {a:e} and {b:e}, rounding {rounding:e}");
    }
}

#[test]
fn the_measure_sees_through_scalings() {
    for (name, posed) in states() {
        let none = KktScales::default();
        let expected = posed.errors(&none);
        assert_eq!(expected.worst().1 <= 1e-10, name == "solution", "{name}: {expected:?}");
        for factor in FACTORS {
            let mut one = posed.clone();
            one.scale_row(2, factor);
            agree(&format!("{name}, row times {factor:e}"), &expected, &one.errors(&none), 0.0);
            let mut all = posed.clone();
            (0..posed.gap.len()).for_each(|i| all.scale_row(i, factor));
            agree(&format!("{name}, rows times {factor:e}"), &expected, &all.errors(&none), 0.0);
            for dof in [0, 7, posed.u.len() - 1] {
                let mut column = posed.clone();
                column.scale_column(dof, factor);
                let name = format!("{name}, column {dof} times {factor:e}");
                agree(&name, &expected, &column.errors(&none), column.rounding());
            }
            let mut elsewhere = posed.clone();
            elsewhere.add_elsewhere(factor * 1e6);
            agree(&format!("{name}, load of {factor:e} elsewhere"), &expected, &elsewhere.errors(&none), 0.0);
            // Earlier increments with terms so many times as large.
            let terms = largest(&posed.force) / 1e5;
            agree(
                &format!("{name}, earlier terms {factor:e}"),
                &expected,
                &posed.errors(&KktScales::new(&[factor * terms, 0.0]).unwrap()),
                0.0,
            );
        }
    }
}

/// An answer of each method; none if the method does not know the problem.
fn solutions(posed: &Posed) -> Vec<(String, HistoryOutcome)> {
    let problem = posed.problem();
    let case = LoadCase::new(posed.force.clone(), vec![[0.0, 0.0], [1.0, 1.0]]).unwrap();
    let loading = Loading::new(vec![case], posed.gap.clone()).unwrap();
    let mut found = Vec::new();
    for method in [Method::BN, Method::Ip] {
        let settings = HistorySettings::new(&problem, &loading, method).unwrap();
        let systems: [(&str, SystemSolver); 3] = [
            ("whole", SystemSolver::default()),
            ("condensed", LinearAlgebra::condensed().into()),
            ("partial", "partial".parse::<LinearAlgebra>().unwrap().into()),
        ];
        for (name, system) in systems {
            let outcome = history::run(&problem, &loading, &[0.5, 1.0], &settings, system, &mut ()).unwrap();
            found.push((format!("{}, {name}", method.name()), outcome));
        }
    }
    let settings = HistorySettings::new(&problem, &loading, Method::BN).unwrap();
    let path = follow_exact_path(&problem, &loading, &[0.5, 1.0], &settings, SystemSolver::default(), &mut ()).unwrap();
    found.push(("events".to_string(), path));
    found
}

#[test]
fn no_answer_hides_behind_a_large_number() {
    let posed = Posed::block();
    let references: Vec<State> = solutions(&posed).into_iter().map(|(_, outcome)| outcome.state).collect();
    let largest = largest(&references[0].p_n);
    for factor in FACTORS {
        let mut rows = posed.clone();
        (0..posed.gap.len()).for_each(|i| rows.scale_row(i, factor));
        let mut elsewhere = posed.clone();
        elsewhere.add_elsewhere(factor * 1e6);
        for (what, posed, unit) in [("rows", rows, factor), ("elsewhere", elsewhere, 1.0)] {
            for ((name, outcome), reference) in solutions(&posed).into_iter().zip(&references) {
                let off = |a: &[f64], b: &[f64]| {
                    a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a * unit - b).abs())) / largest
                };
                let off = off(&outcome.state.p_n, &reference.p_n).max(off(&outcome.state.p_t, &reference.p_t));
                if outcome.status == Status::Converged {
                    assert!(off < 1e-8, "{what} {factor:e}, {name}: {off:e}");
                } else {
                    // The exact path has no refinement: what rounding leaves of it is said.
                    assert_eq!((name.as_str(), outcome.status), ("events", Status::Inaccurate), "{what} {factor:e}");
                }
            }
        }
    }
}

/// Forces of open nodes are not accepted because earlier increments had larger forces.
#[test]
fn tension_of_an_open_node_does_not_hide_behind_earlier_forces() {
    let stiffness = Symmetric::from_triplets(1, &[(0, 0, 2.0)]).unwrap();
    let problem = ContactProblem::new(Parts::new(stiffness, Csr::from_rows(1, [[(0, 1.0)]]).unwrap())).unwrap();
    let zeros = [0.0];
    let increment = Increment { force: &[-1.0], gap: &[1.0], mu: &zeros, w_t_last: &zeros, w_o_last: &zeros };
    let none = || vec![0.0];
    let state = State { u: vec![-0.495], u_rest: Vec::new(), p_n: vec![-0.01], p_t: none(), p_o: none() };
    let errors = |earlier: &KktScales| KktErrors::measure(&problem, &increment, &state, earlier).unwrap();
    let first = errors(&KktScales::default());
    assert!(first.tension > 1e-3, "{first:?}");
    for factor in FACTORS {
        let later = errors(&KktScales::new(&[factor, 0.0]).unwrap());
        assert!((later.tension / first.tension - 1.0).abs() < 1e-9, "{factor:e}: {later:?}");
    }
}
