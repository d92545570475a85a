//! The fields of a body shared by ranks, in a file per rank: together they equal those of one process.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use crate::common::vtu::{Array, Parallel, Piece, values};
use crate::job::{Ended, Job, PROGRAM, signal};
use crate::program::Folder;
use crate::scenes::path;
use crate::whole::assert_whole;

/// Runs a scene with these changes.
fn run(folder: Folder, count: usize, name: &str, solver: &str, changes: &[&str]) -> Ended {
    let scene = path(name);
    let changes: Vec<&str> = changes.iter().flat_map(|change| ["--set", change]).collect();
    let arguments = [&["run", &scene, "--solver", solver, "--out", "OUT"][..], &changes].concat();
    let ended = Job::start_in(folder, count, PROGRAM, &arguments).end();
    assert_eq!(ended.status, Some(0), "{name} on {count}: {} {}", ended.output, ended.error);
    ended
}

/// Runs a small cube, whose fields are written at the end of the second of its two increments.
fn cube(folder: Folder, count: usize) -> Ended {
    run(folder, count, "cube", "multigrid", &["mesh.elements=[5,5,5]", "time.increments=1", "output.times=[2.0]"])
}

/// Returns the files of fields, ascending.
fn of_fields(ended: &Ended) -> Vec<String> {
    let mut names = ended.folder.names("out");
    names.retain(|name| name.starts_with("fields"));
    names
}

fn read(out: &Path, name: &str) -> String {
    fs::read_to_string(out.join(name)).unwrap()
}

/// Panics unless `part` has the numbers of `whole` at these points or cells, to 1e-9 of the largest.
#[track_caller]
fn assert_same_arrays(part: &[Array], whole: &[Array], places: &[usize]) {
    for Array { name, components, values: expected } in whole {
        let (found_components, found) = values(part, name);
        assert_eq!(found_components, *components, "{name}");
        let largest = expected.iter().filter(|x| !x.is_nan()).fold(0.0, |largest, x| x.abs().max(largest));
        let expected = places.iter().flat_map(|place| &expected[place * components..][..*components]);
        for (found, expected) in found.iter().zip(expected) {
            let same = (found - expected).abs() <= 1e-9 * largest || found.is_nan() && expected.is_nan();
            assert!(same, "{name}: {found:e}, {expected:e}");
        }
    }
}

#[test]
fn pieces_together_are_the_fields_of_one_process() {
    let one = cube(Folder::new(), 1);
    assert_eq!(of_fields(&one), ["fields.pvd", "fields_0002.vtu"]);
    let whole = Piece::read(&read(&one.out(), "fields_0002.vtu"));
    let key = |x: &[f64]| [x[0], x[1], x[2]].map(f64::to_bits);
    let points: HashMap<_, usize> = whole.points.chunks_exact(3).enumerate().map(|(k, x)| (key(x), k)).collect();
    let cells: HashMap<Vec<usize>, usize> = whole
        .connectivity
        .chunks_exact(8)
        .enumerate()
        .map(|(k, corners)| (corners.iter().map(|k| *k as usize).collect(), k))
        .collect();
    assert_eq!((points.len(), cells.len()), (216, 125));
    assert!(whole.cell.iter().all(|array| array.name != "rank"));
    for count in [2, 4] {
        let shared = cube(Folder::new(), count);
        let out = shared.out();
        let named = Parallel::read(&read(&out, "fields_0002.pvtu"));
        let expected: Vec<String> = (0..count).map(|rank| format!("fields_0002_{rank}.vtu")).collect();
        assert_eq!(named.sources, expected);
        let others = ["fields.pvd", "fields_0002.pvtu"].map(String::from);
        assert_eq!(of_fields(&shared), [&others[..], &expected].concat());
        assert!(read(&out, "fields.pvd").contains("file=\"fields_0002.pvtu\""));

        let (mut of_cell, mut of_point) = (vec![0; cells.len()], vec![0; points.len()]);
        for (rank, name) in named.sources.iter().enumerate() {
            let piece = Piece::read(&read(&out, name));
            let declared = |arrays: &[Array]| -> Vec<Array> {
                arrays.iter().map(|array| Array { values: Vec::new(), ..array.clone() }).collect()
            };
            assert_eq!((declared(&piece.point), declared(&piece.cell)), (named.point.clone(), named.cell.clone()));
            let points: Vec<usize> = piece.points.chunks_exact(3).map(|x| points[&key(x)]).collect();
            let corners = piece.connectivity.chunks_exact(8);
            let corners = corners.map(|corners| corners.iter().map(|k| points[*k as usize]).collect::<Vec<_>>());
            let cells: Vec<usize> = corners.map(|corners| cells[&corners]).collect();
            for point in &points {
                of_point[*point] += 1;
            }
            for cell in &cells {
                of_cell[*cell] += 1;
            }
            assert_same_arrays(&piece.point, &whole.point, &points);
            assert_same_arrays(&piece.cell, &whole.cell, &cells);
            assert!(values(&piece.cell, "rank").1.iter().all(|of| *of == rank as f64));
            // METIS distributes nodes evenly, and a border is one layer of cells.
            assert!(cells.len() * count < 125 * 2 && cells.len() * count * 3 > 125, "{} of {count}", cells.len());
        }
        assert!(of_cell.iter().all(|times| *times == 1), "each cell is in one piece");
        assert!(of_point.iter().all(|times| *times >= 1) && of_point.iter().any(|times| *times > 1));
    }
}

#[test]
fn fields_replace_those_of_another_number_of_ranks() {
    let mut folder = Folder::new();
    for count in [4, 1, 2, 4] {
        let ended = cube(folder, count);
        let expected = cube(Folder::new(), count);
        assert_eq!(ended.folder.names("out"), expected.folder.names("out"), "on {count}");
        assert_whole(&ended.out());
        folder = ended.folder;
    }
}

#[test]
fn where_one_process_has_the_stiffness_fields_are_one_file() {
    let small = ["mesh.elements=[5,5,5]", "time.increments=1", "output.times=[2.0]"];
    let cases: &[(&str, &str, &[&str], &str)] = &[
        ("two_blocks", "multigrid", &["time.increments=1", "output.fields=true"], "fields_0003.vtu"),
        ("cube", "mumps", &small, "fields_0002.vtu"),
    ];
    for (name, solver, changes, last) in cases {
        let ended = run(Folder::new(), 2, name, solver, changes);
        assert_eq!(of_fields(&ended), ["fields.pvd", *last], "{name} by {solver}");
    }
}

#[test]
fn a_run_goes_on_with_another_number_of_ranks() {
    let scene = path("cube");
    let changes = ["mesh.elements=[9,9,9]", "time.increments=12", "output.times=\"all\""];
    let changes = changes.into_iter().flat_map(|change| ["--set", change]);
    let arguments = ["run", &scene, "--solver", "multigrid", "--checkpoint-every", "0", "--resume", "--out", "OUT"];
    let arguments: Vec<&str> = arguments.into_iter().chain(changes).collect();
    for count in [1, 4] {
        let mut job = Job::start(2, &arguments);
        job.reaches(2);
        signal("-USR1", job.launcher.id());
        let ended = job.end();
        assert_eq!(ended.status, Some(1), "{}", ended.error);
        assert_whole(&ended.out());
        let ended = Job::start_in(ended.folder, count, PROGRAM, &arguments).end();
        assert_eq!(ended.status, Some(0), "{} {}", ended.output, ended.error);
        assert_whole(&ended.out());
        let names = of_fields(&ended);
        let there = |name: String| names.contains(&name);
        let pieces = |k: usize| (0..5).take_while(|rank| there(format!("fields_{k:04}_{rank}.vtu"))).count();
        let found: Vec<usize> = (0..=12)
            .map(|k| {
                let pieces = pieces(k);
                assert_eq!(there(format!("fields_{k:04}.pvtu")), pieces > 0, "{k}");
                assert_eq!(there(format!("fields_{k:04}.vtu")), pieces == 0, "{k}");
                pieces
            })
            .collect();
        let after = if count == 1 { 0 } else { count };
        let change = found.iter().position(|pieces| *pieces != 2).unwrap();
        assert!(change > 2 && found[change..].iter().all(|pieces| *pieces == after), "{found:?}");
        let series = read(&ended.out(), "fields.pvd");
        assert_eq!(series.matches("<DataSet ").count(), 13, "{series}");
        assert_eq!(series.matches(".pvtu").count(), if count == 1 { change } else { 13 }, "{series}");
    }
}
