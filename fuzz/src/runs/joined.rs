//! Scenes of two bodies, or of one that repeats, whose contact rows share nodes with others, or whose loads are elsewhere.

use crate::random::Random;

/// A block that is held at its top, with what else its table of the scene says.
fn body(random: &mut Random, name: &str, at: [f64; 2], size: [f64; 2]) -> String {
    let elements = [1 + random.below(5), 1 + random.below(4)];
    let (young, poisson) = (1e9 * random.decades(-3.0, 3.0), random.one(&[0.3, 0.0, 0.45]));
    let cells = random.one(&["quadrilateral", "triangle6", "quadrilateral8"]);
    format!(
        "[[body]]\nname = '{name}'\nat = {at:?}\nmaterial = {{ young = {young:e}, poisson = {poisson} }}\n\
         mesh = {{ kind = 'block', cells = '{cells}', size = {size:?}, elements = {elements:?} }}\n"
    )
}

/// Presses a boundary down, and moves it sideways, as the time goes on.
fn pressed(random: &mut Random, boundary: &str, deep: f64) -> String {
    let aside = deep * random.between(-1.0, 1.0);
    format!(
        "[[support]]\nboundary = '{boundary}'\nfix = ['x', 'y']\ndisplacement = [{aside:e}, {:e}]\n\
         history = [[0, 0], [1, 1], [2, {}]]\n",
        -deep,
        random.between(-0.5, 1.5)
    )
}

fn on_plane(random: &mut Random, boundary: &str, gap: f64) -> String {
    let friction = random.one(&[0.0, 0.1, 0.3, 0.6]);
    format!(
        "[[contact]]\nboundary = '{boundary}'\nfriction = {friction}\nobstacle = {{ kind = 'plane', gap = {gap:e} }}\n"
    )
}

/// A body that friction alone holds between two others, by an interference; a load pulls it out.
fn plug(random: &mut Random, deep: f64, width: f64) -> String {
    let bodies = [("a", 0.0, 1.0), ("b", 1.0, width), ("c", 1.0 + width, 1.0)]
        .map(|(name, at, width)| body(random, name, [at, 0.0], [width, 1.0]));
    let held = ["a:left", "c:right"].map(|side| format!("[[support]]\nboundary = '{side}'\nfix = ['x', 'y']\n"));
    let friction = random.one(&[0.1, 0.3, 0.6]);
    let contact = [["b:left", "a:right"], ["c:left", "b:right"]].map(|[slave, master]| {
        format!("[[contact]]\nboundary = '{slave}'\nagainst = '{master}'\ngap = {:e}\nfriction = {friction}\n", -deep)
    });
    let pull = deep * 1e9 * random.decades(-3.0, 1.0);
    let load = format!("[[load]]\nboundary = 'b:top'\ntraction = [0, {pull:e}]\nhistory = [[1, 0], [2, 1]]\n");
    [bodies.concat(), held.concat(), contact.concat(), load].concat()
}

/// The text of some scene: two bodies that are glued and stand on one plane, a period over a plane, a body beside a
/// loaded one that nothing connects with it, or one that friction alone holds.
pub(super) fn text(random: &mut Random) -> String {
    let deep = random.decades(-5.0, -3.0);
    let gap = 0.5 * deep * random.between(-1.0, 1.0);
    let width = random.between(0.5, 2.0);
    let time = format!("[time]\nend = 2\nincrements = {}\n", 1 + random.below(6));
    let first = body(random, "a", [0.0, 0.0], [1.0, 1.0]) + &pressed(random, "a:top", deep);
    let first = first + &on_plane(random, "a:bottom", gap);
    let glue = "[[contact]]\nglue = true\n";
    let remaining = match random.below(4) {
        3 => return plug(random, deep, width) + &time,
        0 => {
            let second = body(random, "b", [1.0, 0.0], [width, 1.0]) + &pressed(random, "b:top", deep);
            let second = second + &on_plane(random, "b:bottom", gap);
            let [slave, master] = random.one(&[["a:right", "b:left"], ["b:left", "a:right"]]);
            format!("{second}{glue}boundary = '{slave}'\nagainst = '{master}'\n")
        }
        1 => format!("{glue}boundary = 'a:right'\nagainst = 'a:left'\nshift = [1, 0]\n"),
        _ => {
            let second = body(random, "b", [2.0, 0.0], [width, 1.0]);
            let traction = 1e5 * random.decades(0.0, 9.0);
            format!(
                "{second}[[support]]\nboundary = 'b:bottom'\nfix = ['x', 'y']\n\
                 [[load]]\nboundary = 'b:top'\ntraction = [{traction:e}, {traction:e}]\nhistory = [[0, 0], [1, 1]]\n"
            )
        }
    };
    first + &remaining + &time
}
