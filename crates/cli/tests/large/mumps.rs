//! MUMPS in one process gives the same results as UMFPACK: every scene of the project, reduced.

use crate::scenes::{SCENES, assert_same_forces, iterations, report};

#[test]
fn every_scene_is_what_umfpack_says() {
    for (name, overrides) in SCENES {
        let [mumps, umfpack] = ["mumps", "umfpack"].map(|linear| report(name, overrides, linear));
        assert_eq!(iterations(&mumps), iterations(&umfpack), "{name}");
        assert_same_forces(name, &mumps, &umfpack, 1e-11);
        assert_eq!(mumps["totals"]["symbolic_analyses"], 1, "{name}");
        assert!(mumps["totals"]["ranks"].is_null());
        let error = mumps["totals"]["backward_error"].as_f64().unwrap();
        assert!(error <= 2e-15, "{name}: {error:e}");
    }
}

/// PORD's ordering, which MUMPS takes where it has neither METIS nor SCOTCH, has 1.1 times the fill of METIS'; that of minimum
/// degree has 1.7 times.
#[test]
fn factors_are_as_small_as_those_of_umfpack() {
    for (name, change, bound) in [("cube", "mesh.elements=[16,16,16]", 1.3), ("block", "mesh.elements=[100,100]", 1.25)]
    {
        let overrides = [change, "time.increments=1"];
        let entries = |linear| report(name, &overrides, linear)["totals"]["nnz_factors"].as_f64().unwrap();
        let ratio = entries("mumps") / entries("umfpack");
        println!("{name}: {ratio:.3}");
        assert!(ratio < bound, "{name}: {ratio}");
    }
}
