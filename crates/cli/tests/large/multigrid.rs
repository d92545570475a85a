//! Multigrid gives the same results: every scene of the project, reduced, against the direct solver of this build.

use crate::scenes::{SCENES, assert_same_forces, iterations, report};

#[test]
fn every_scene_is_what_the_direct_solver_says() {
    for (name, overrides) in SCENES {
        let [multigrid, direct] = ["multigrid", "umfpack"].map(|linear| report(name, overrides, linear));
        let (by, expected) = (iterations(&multigrid), iterations(&direct));
        let krylov = multigrid["totals"]["krylov_iterations"].as_u64().unwrap_or(0);
        let warnings = multigrid["warnings"].as_array().unwrap();
        let gave_way = warnings.iter().any(|warning| warning["kind"] == "multigrid-gave-way");
        println!("{name}: {by:?}, direct {expected:?}; {krylov} Krylov{}", if gave_way { ", gave way" } else { "" });
        assert_same_forces(name, &multigrid, &direct, 1e-10);
        for (found, expected) in by.iter().zip(&expected) {
            assert!(found.abs_diff(*expected) <= 2, "{name}: {by:?}, direct {expected:?}");
        }
    }
}
