//! What a scene does not need is not there, and its absence changes no result.

use crate::common::prelude::*;

fn solve(scene: &Scene, backend: LinearAlgebra) -> (HistoryOutcome, Keep) {
    let model = discretise(scene).unwrap();
    let solver = &scene.solver;
    let settings = settings_of(&model, Method::BN).until(solver.max_iterations, solver.tolerance);
    let (outcome, keep) = recorded(&model, &scene.time.all(), &settings, backend);
    assert_eq!(outcome.status, Status::Converged);
    (outcome, keep)
}

/// Without friction there are fewer unknowns and entries than with next to none, and the same contact forces.
#[test]
fn friction() {
    for (name, mesh) in [("block.toml", "mesh.elements=[20,20]"), ("cube.toml", "mesh.elements=[6,6,6]")] {
        let scene = |mu: &str| common::scene(name, &[mesh, &format!("contact.friction={mu}")]);
        for backend in both() {
            let ((none, smooth), (little, rough)) = (solve(&scene("0"), backend), solve(&scene("1e-9"), backend));
            assert_eq!(none.layout.tangentials(), 0);
            assert!(none.layout.unknowns() < little.layout.unknowns());
            let (fewer, more) = (none.linear.factor.entries, little.linear.factor.entries);
            // In the plane the few unknowns less do not outweigh what the ordering leaves to chance.
            let chance = if backend == LinearAlgebra::condensed() || name == "cube.toml" { 1.0 } else { 1.03 };
            assert!((fewer as f64) < chance * more as f64, "{name} {backend}: {fewer} {more}");
            for (a, b) in smooth.states.iter().zip(&rough.states) {
                assert!(apart(&b.p_n, &a.p_n) <= 1e-7, "{name} {backend}");
                assert!(a.p_t.iter().chain(&a.p_o).all(|p| *p == 0.0));
            }
        }
    }
}

/// A load that only grows, on an obstacle that is touched from the start: the contact zone stays, and with it the factors.
#[test]
fn factors_of_a_proportional_history() {
    let overrides = ["mesh.elements=[20,20]", "contact.obstacle.gap=0", "time.increments=10"];
    let (outcome, _) = solve(&common::scene("frictionless.toml", &overrides), LinearAlgebra::default());
    let contact: Vec<_> = outcome.records.iter().map(|record| record.contact).collect();
    assert!(contact.windows(2).all(|pair| pair[0] == pair[1]), "{contact:?}");
    // That of the held body, which tells where to start, and that of the contact zone.
    assert_eq!(outcome.linear.factorizations, 2);
}

/// Without contact an increment is a substitution with the Cholesky factor of `K`.
#[test]
fn contact() {
    let text = CUBE;
    let (start, end) = (text.find("[[contact]]").unwrap(), text.find("[[load]]").unwrap());
    let text = [&text[..start], &text[end..]].concat();
    let scene = parsed_with(&text, &["mesh.elements=[5,5,5]"]);
    assert_eq!(Run::new(&scene).unwrap().choice().linear, LinearAlgebra::condensed());
    let [(whole, states), (cholesky, others)] = both().map(|backend| solve(&scene, backend));
    assert_eq!((whole.linear.factorizations, cholesky.linear.factorizations), (1, 0));
    assert!(cholesky.linear.factor.entries < whole.linear.factor.entries);
    assert!(cholesky.records.iter().all(|record| record.iterations == 0));
    for (a, b) in states.states.iter().zip(&others.states) {
        assert!(apart(&b.u, &a.u) <= 1e-12);
    }
}

/// What the program says before a run.
#[test]
fn the_list() {
    let list = |name: &str, overrides: &[&str], backend| {
        let scene = common::scene(name, overrides);
        let all = EliminatedUnknown::all(&discretise(&scene).unwrap(), backend == LinearAlgebra::condensed(), None);
        all.into_iter().map(|EliminatedUnknown { count, unknown, .. }| (count, unknown)).collect::<Vec<_>>()
    };
    let whole = LinearAlgebra::default();
    let block = ["mesh.elements=[4,4]", "contact.friction=0"];
    assert_eq!(list("block.toml", &block[..1], whole), [(10, "u"), (1, "p_n")]);
    assert_eq!(list("block.toml", &block, whole), [(10, "u"), (1, "p_n"), (4, "p_t")]);
    assert_eq!(
        list("block.toml", &block, LinearAlgebra::condensed()),
        [(10, "u"), (40 - 4, "u"), (1, "p_n"), (4, "p_t")]
    );
    let cube = ["mesh.elements=[2,2,2]", "contact.friction=0"];
    assert_eq!(list("cube.toml", &cube, whole), [(27, "u"), (3, "p_n"), (12, "p_t and p_o")]);
}
