//! What a scene writes: which increments, and faults of its keys.

use crate::common::block;
use crate::common::prelude::*;

const OUTPUT: &str = include_str!("tables/output.txt");

/// Probes, each with words of the message and of the help.
const PROBES: &str = include_str!("tables/probes.txt");

#[test]
fn values_out_of_range() {
    verify_all(BLOCK, OUTPUT, located);
    for [probe, words, remedy] in rows(PROBES) {
        let text = edit(BLOCK, "times =", &format!("probe = [{{ {probe} }}]\ntimes ="));
        verify(&located(&text), &text, line_of(&text, "probe ="), &words, &remedy);
    }
    let twice = "[[output.probe]]\nname = 'a'\npoint = [0, 0]\n[[output.probe]]\nname = 'a' # again\npoint = [1, 1]\n";
    let text = [BLOCK, twice].concat();
    verify(&located(&text), &text, line_of(&text, "# again"), "another probe is called \"a\"", "a name of its own");
}

/// What only the mesh can tell, with the place in the text.
#[test]
fn probes_lie_in_the_body() {
    for (probe, says, remedy) in [
        ("point = [1.0, 1.001]", "the point (1, 1.001) m is outside of the body", "the nearest node is at (1, 1) m"),
        ("from = [-0.25, 0]\nto = [1, 0]\npoints = 5", "the point (-0.25, 0) m is outside", "at (0, 0) m"),
        ("from = [0, 0]\nto = [1, 2]\npoints = 3", "the point (1, 2) m is outside", "at (1, 1) m"),
        (
            "point = [0.5, 0.5, 0.5]",
            "the point [0.5, 0.5, 0.5] has 3 components, but the body 2 dimensions",
            "give [x, y]",
        ),
    ] {
        let text = [BLOCK, "[[output.probe]]\nname = 'a'\n", probe, "\n"].concat();
        let small = edit(&text, "[100, 100]", "[4, 4]");
        let scene = parsed(&small);
        let error = Run::new(&scene).map(|_| ()).unwrap_err();
        let key = if says.contains("(1, 2)") { "to =" } else { probe.split(" =").next().unwrap() };
        let place = format!("scene.toml:{}: {says}", line_of(&small, &format!("\n{key}").replace('\n', "")));
        assert!(error.to_string().starts_with(&place), "{error}, not {place}");
        let help = miette::Diagnostic::help(&error).unwrap().to_string();
        assert!(help.contains(remedy), "{help}");
    }
    // The same from Rust, by the key.
    let model = discretise(&block(&["mesh.elements=[4,4]"])).unwrap();
    let probes = [Probe::at("in", [0.5, 0.5]), Probe::along("out", [0.5, 0.5], [0.5, 1.5], 4)];
    let fault = stickslip::run::report::ProbeTable::all(&model, &probes).unwrap_err();
    assert_eq!(fault.key, "output.probe[1].to");
    let fault = Probe::check(&[Probe::along("many", [0.0, 0.0], [1.0, 0.0], 1)]).unwrap_err();
    assert_eq!(fault.key, "output.probe[0].points");
}

#[test]
fn increments_that_are_written() {
    let wanted = |set: &[&str]| {
        let scene = block(&[&["time.increments=10"], set].concat());
        scene.output.increments(&scene.time.all())
    };
    assert_eq!(wanted(&[]), [5, 10]);
    assert_eq!(wanted(&["output.times=[0, 0.3, 0.2, 2]"]), [0, 1, 2, 10]);
    assert_eq!(wanted(&["output.times=all"]), (0..=10).collect::<Vec<_>>());
    assert_eq!(wanted(&["output.times=[0.2]", "output.every=4"]), [1, 4, 8, 10]);
    assert_eq!(wanted(&["output.times=[]"]), [0; 0]);
    // Alone it takes the place of the end.
    let scene = parsed(&edit(BLOCK, "times = [1.0, 2.0]", "every = 16"));
    assert_eq!(scene.output.increments(&scene.time.all()), [16, 32, 40]);
}
