//! Too little memory: with any limit, and whichever allocation is refused, a run ends soon, on its own, and with a
//! correct status.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Folder, WHOLE, send, small};

/// The end of a process.
struct ProcessResult {
    /// The exit code; `None` after a signal or a timeout.
    code: Option<i32>,
    words: String,
}

/// The longest allowed time of a run, on slow and busy machines too.
const TIME: Duration = Duration::from_secs(60);

/// Runs `command` with its output in a file of `folder`.
fn ended(command: Command, folder: &Folder) -> ProcessResult {
    ended_within(TIME, command, folder)
}

fn ended_within(time: Duration, mut command: Command, folder: &Folder) -> ProcessResult {
    let words = PathBuf::from(folder.join("words"));
    let file = std::fs::File::create(&words).unwrap();
    let child =
        command.env_remove("RUST_BACKTRACE").stdout(file.try_clone().unwrap()).stderr(file).stdin(Stdio::null());
    let mut child = child.spawn().unwrap();
    let start = Instant::now();
    let status = loop {
        match child.try_wait().unwrap() {
            Some(status) => break Some(status),
            None if start.elapsed() > time => {
                child.kill().unwrap();
                child.wait().unwrap();
                break None;
            }
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    ProcessResult {
        code: status.and_then(|status| status.code()),
        words: String::from_utf8_lossy(&std::fs::read(words).unwrap()).into_owned(),
    }
}

/// Returns the program with a limit of its address space, MB.
fn limited(megabytes: usize, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    let script = format!("ulimit -v {}; exec \"$0\" \"$@\"", 1000 * megabytes);
    command.args(["-c", &script, env!("CARGO_BIN_EXE_stickslip")]).args(arguments);
    command
}

/// Returns `false` if the limit is too small for the system to load the libraries of the program. OpenBLAS 0.3.29 does
/// not return from loading then: it requests its buffers for ever, even in a C program without any function.
fn libraries_load(megabytes: usize, folder: &Folder) -> bool {
    let ProcessResult { code, words } =
        ended_within(Duration::from_secs(5), limited(megabytes, &["--version"]), folder);
    let refused = code == Some(127) && words.contains("error while loading shared libraries");
    let by_openblas = words.contains("OpenBLAS blas_thread_init") || code.is_none() && words.is_empty();
    // Its threads may have no room although the libraries have.
    let by_program = code == Some(3) && words.contains("out of memory");
    assert!(code == Some(0) || refused || by_openblas || by_program, "{megabytes} MB: {code:?}\n{words}");
    code == Some(0)
}

#[test]
fn a_limit_of_the_address_space_has_a_verdict() {
    let (folder, block) = Folder::with_scene(&small());
    let cube = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/cube.toml");
    let plane = ["run", &block, "--set", "mesh.elements=[20,20]", "--set", "time.increments=2"];
    let solid = ["run", cube, "--set", "mesh.elements=[4,4,4]", "--set", "time.increments=1"];
    let mut refused = 0;
    for megabytes in [40, 90, 110, 150, 250, 400] {
        if !libraries_load(megabytes, &folder) {
            continue;
        }
        for scene in [plane, solid] {
            for solver in [&["--solver", WHOLE][..], &["--solver", "condensed"]] {
                let ended = ended(limited(megabytes, &[&scene, solver].concat()), &folder);
                let good = ended.code == Some(0) && ended.words.contains("verdict      converged");
                let short = ended.code == Some(3) && ended.words.contains("memory");
                assert!(good || short, "{megabytes} MB, {scene:?} {solver:?}: {:?}\n{}", ended.code, ended.words);
                refused += usize::from(short);
            }
        }
    }
    assert!(refused > 0);
}

#[test]
fn check_tells_the_need_and_whose_limit_it_is() {
    let (folder, scene) = Folder::with_scene(&small());
    let check = ended(limited(4000, &["check", &scene]), &folder);
    assert_eq!(check.code, Some(0), "{}", check.words);
    let line = check.words.lines().find(|line| line.starts_with("memory       about ")).unwrap();
    // Less than 4 GB are left of that limit, whatever the machine has.
    assert!(line.ends_with(" leaves") && !line.contains("hardly"), "{line}");
    let large = ended(limited(2000, &["run", &scene, "--set", "mesh.elements=[4000,4000]"]), &folder);
    assert_eq!(large.code, Some(3), "{}", large.words);
    let words = large.words.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("the matrices of this mesh need about 13.8 GB of memory, but "), "{words}");
    let many = ended(limited(2000, &["run", &scene, "--json", "--set", "time.increments=2000000"]), &folder);
    assert_eq!(many.code, Some(3), "{}", many.words);
    assert!(many.words.contains("the records of so many increments need about 4.0 GB of memory"), "{}", many.words);
}

/// Many triangles at one position, each a body of its own: coincident nodes are not all compared with each other, in
/// time or in memory.
#[test]
fn a_stack_of_nodes_is_told_soon() {
    use std::fmt::Write;
    const TRIANGLES: usize = 20_000;
    let nodes = 3 * TRIANGLES;
    let (folder, scene) = Folder::with_scene(
        "mesh = { kind = \"gmsh\", file = \"m.msh\" }\nmaterial = { young = 1e9, poisson = 0.3 }\n\
         support = [{ boundary = \"top\", fix = [\"x\", \"y\"] }]\ntime = { end = 1, increments = 2 }\n",
    );
    let mut mesh =
        String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 1 0 0\n$EndEntities\n");
    writeln!(mesh, "$Nodes\n1 {nodes} 1 {nodes}\n2 1 0 {nodes}").unwrap();
    (1..=nodes).for_each(|node| writeln!(mesh, "{node}").unwrap());
    mesh += &"0 0 0\n1 0 0\n0 1 0\n".repeat(TRIANGLES);
    writeln!(mesh, "$EndNodes\n$Elements\n1 {TRIANGLES} 1 {TRIANGLES}\n2 1 2 {TRIANGLES}").unwrap();
    (0..TRIANGLES).for_each(|k| writeln!(mesh, "{} {} {} {}", k + 1, 3 * k + 1, 3 * k + 2, 3 * k + 3).unwrap());
    mesh += "$EndElements\n";
    std::fs::write(folder.join("m.msh"), mesh).unwrap();
    let check = ended(limited(1000, &["check", &scene]), &folder);
    assert_eq!(check.code, Some(2), "{}", check.words);
    assert!(check.words.contains("both have a node at"), "{}", check.words);
}

/// The first Ctrl-C ends a set-up, which does not check for requests.
#[test]
fn a_set_up_is_interrupted_by_the_first_request() {
    let (folder, scene) = Folder::with_scene(&small());
    let words = folder.join("words");
    let mut child = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(["run", &scene, "--set", "mesh.elements=[1200,1200]"])
        .stdout(std::fs::File::create(&words).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = || std::fs::read_to_string(&words).unwrap().contains("set-up       mesh");
    while !begun() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let start = Instant::now();
    send("INT", child.id());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    assert!(!std::fs::read_to_string(&words).unwrap().contains("verdict"));
}

/// Compiles the library that refuses memory into `folder`.
fn refusing(folder: &Folder) -> String {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/faults/malloc.c");
    let library = folder.join("malloc.so");
    // The compiler exists, because it links these tests.
    let compiled = Command::new("cc").args(["-O1", "-shared", "-fPIC", "-o", &library, source]).status().unwrap();
    assert!(compiled.success());
    library
}

/// Returns a small run whose allocations are counted, with more `arguments`.
fn counted(library: &str, scene: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.args(["run", scene, "--set", "mesh.elements=[3,3]", "--set", "time.increments=1", "--threads", "1"]);
    command.args(arguments).env("LD_PRELOAD", library).env("OPENBLAS_NUM_THREADS", "1").env("MALLOC_ARENA_MAX", "1");
    command
}

/// The largest number of allocations by libraries before `main`, of some thousand in all.
const BEFORE: usize = 45;

/// Refuses each `step`-th allocation in turn, alone or with all later ones.
fn refuse(step: usize) {
    let (folder, scene) = Folder::with_scene(&small());
    let library = refusing(&folder);
    for arguments in [&[][..], &["--solver", "condensed"], &["--method", "ip"], &["--solver", "faer"]] {
        let number = folder.join("number");
        let mut whole = counted(&library, &scene, arguments);
        whole.env("FAULT_COUNT", &number);
        let ended_well = ended(whole, &folder);
        assert_eq!(ended_well.code, Some(0), "{}", ended_well.words);
        let requests: usize = std::fs::read_to_string(Path::new(&number)).unwrap().trim().parse().unwrap();
        assert!(requests > 1000, "{requests}");
        let (mut good, mut short, mut faults) = (0, 0, Vec::new());
        for later in [false, true] {
            for at in (BEFORE..=requests).step_by(step) {
                let mut command = counted(&library, &scene, arguments);
                command.env("FAULT_AT", at.to_string());
                if later {
                    command.env("FAULT_ON", "1");
                }
                let ended = ended(command, &folder);
                match ended.code {
                    Some(0) if ended.words.contains("verdict      converged") => good += 1,
                    Some(3) if ended.words.contains("memory") => short += 1,
                    // OpenMP's runtime ends the process itself.
                    Some(1) if ended.words.contains("libgomp: Out of memory") => short += 1,
                    code => faults.push(format!("{at} of {requests}, later {later}: {code:?}\n{}", ended.words)),
                }
            }
        }
        assert!(faults.is_empty(), "{arguments:?}\n{}", faults.join("\n\n"));
        let counts = format!("{arguments:?}: {requests} requests, {good} converged, {short} out of memory");
        println!("{counts}");
        assert!(short > good, "{counts}");
    }
}

#[test]
fn a_request_for_memory_that_is_refused_ends_in_order() {
    refuse(97);
}

#[test]
#[ignore = "thousands of runs"]
fn every_request_for_memory_that_is_refused_ends_in_order() {
    refuse(1);
}
