//! A stiffness assembled in distributed rows: the more processes, the less memory each needs.

use serde_json::Value;

use crate::job::{Ended, Job, PROGRAM, other_ranks_with};
use crate::program::Folder;
use crate::scenes::{assert_same_forces, iterations, path};

/// Returns the arguments for a cube with this number of elements per side, in one increment, by multigrid on one
/// thread.
fn cube(elements: usize) -> Vec<String> {
    let changes = [format!("mesh.elements=[{elements},{elements},{elements}]"), "time.increments=1".to_string()];
    let options = ["--solver", "multigrid", "--threads", "1", "--out", "OUT"].map(str::to_string);
    let changes = changes.into_iter().flat_map(|change| ["--set".to_string(), change]);
    ["run".to_string(), path("cube")].into_iter().chain(options).chain(changes).collect()
}

fn run(count: usize, program: &str, folder: Folder, arguments: &[String]) -> Ended {
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let ended = Job::start_in(folder, count, program, &arguments).end();
    assert_eq!(ended.status, Some(0), "on {count}: {} {}", ended.output, ended.error);
    ended
}

/// Returns the peak memory of each process, MB.
fn peaks(report: &Value) -> Vec<f64> {
    let peak = |of: &Value| of["peak_rss_bytes"].as_f64().unwrap() * 1e-6;
    match report["totals"]["ranks"].as_array() {
        Some(ranks) if !ranks.is_empty() => ranks.iter().map(peak).collect(),
        _ => vec![peak(&report["totals"])],
    }
}

#[test]
fn memory_of_each_rank_falls_with_their_number() {
    let [one, two, four] = [1, 2, 4].map(|count| run(count, PROGRAM, Folder::new(), &cube(20)).report());
    let largest = |report: &Value| peaks(report).into_iter().fold(0.0, f64::max);
    println!("{:?} {:?} {:?}", peaks(&one), peaks(&two), peaks(&four));
    for shared in [&two, &four] {
        assert_same_forces("cube", shared, &one, 1e-10);
        assert!(iterations(shared).iter().zip(iterations(&one)).all(|(by, expected)| by.abs_diff(expected) <= 1));
    }
    assert_eq!((peaks(&two).len(), peaks(&four).len()), (2, 4));
    // The program and its libraries always take about 60 MB. Sharing has an overhead: for this small body, two
    // processes save an eighth each, four a half.
    let beyond = |report: &Value| largest(report) - 60.0;
    assert!(beyond(&two) < 0.95 * beyond(&one) && beyond(&four) < 0.6 * beyond(&one));
}

#[test]
fn where_ranks_have_other_bodies_the_first_assembles_alone() {
    let expected = run(1, PROGRAM, Folder::new(), &cube(5)).report();
    for (change, told) in [
        ("mesh.elements=[4,4,4]", ""),
        ("material.young=1e11", ""),
        ("mesh.elements=[0,4,4]", "rank 1: "),
        ("mesh.file=\"nowhere.msh\"", "rank 1: "),
    ] {
        let folder = Folder::new();
        let script = other_ranks_with(&folder, &format!("\"$@\" --set '{change}'"));
        let ended = run(2, &script, folder, &cube(5));
        assert_same_forces(change, &ended.report(), &expected, 1e-10);
        assert!(ended.error.contains(told), "{change}: {}", ended.error);
        assert!(ended.error.contains("rank 1 was started with other arguments than rank 0"), "{}", ended.error);
        let apart = |report: &Value| {
            report["warnings"].as_array().unwrap().iter().any(|warning| warning["kind"] == "ranks-apart")
        };
        assert!(apart(&ended.report()) && !apart(&expected), "{change}");
    }
}
