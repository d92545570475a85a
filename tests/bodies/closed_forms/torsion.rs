//! Twist of bodies of revolution against closed forms: shafts and tubes, a cone, a press fit, a clutch and a sphere.

use super::axisymmetric_bodies::{ELEMENTS, solved};
use crate::common::prelude::*;

/// A body of revolution whose shear modulus is 1.
fn body(origin: [f64; 2], size: [f64; 2], elements: [usize; 2], (cells, element): (CellKind, Element)) -> String {
    format!(
        "[mesh]\nkind = \"block\"\norigin = {origin:?}\nsize = {size:?}\nelements = {elements:?}\ncells = \"{}\"\n\
         element = \"{}\"\n[material]\nyoung = 2.5\npoisson = 0.25\nplane = \"axisymmetric-torsion\"\n\
         [time]\nend = 1\nincrements = 1\n",
        match cells {
            CellKind::Triangle6 => "triangle6",
            other => other.name(),
        },
        element.name()
    )
}

/// One of several bodies, of blocks with this `law`.
fn part(name: &str, [origin, size]: [[f64; 2]; 2], elements: [usize; 2], law: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmesh = {{ kind = \"block\", origin = {origin:?}, size = {size:?}, elements = {elements:?} }}\n\
         material = {{ {law}, plane = \"axisymmetric-torsion\" }}\n"
    )
}

/// The torque on support `k` at the end.
fn torque(report: &RunReport, k: usize) -> f64 {
    report.reactions.last().unwrap().supports[k].moment[1]
}

/// Shafts and tubes turn by `M L / (G J)` under a torque, whichever coupling applies it. The displacement
/// `u_z = -x θ y / L` is one of quadrilaterals and of triangles of second order.
#[test]
fn shafts_and_tubes() {
    for (inner, cells) in [0.0, 0.5].into_iter().flat_map(|inner| ELEMENTS.map(|cells| (inner, cells))) {
        for kind in ["rigid", "distributing"] {
            let text = body([inner, 0.0], [1.0 - inner, 4.0], [8, 20], cells)
                + "[[support]]\nboundary = \"bottom\"\nfix = [\"x\", \"y\", \"z\"]\n\
                   [[load]]\ncoupling = \"end\"\nmoment = 1e-3\n"
                + &format!("[[coupling]]\nname = \"end\"\nboundary = \"top\"\nkind = \"{kind}\"\n");
            let report = solved(&parsed(&text).description).report;
            let turned = report.reactions[0].couplings[0].rotation[1];
            let error = turned * 0.5 * PI * (1.0 - inner.powi(4)) / 4.0 / 1e-3 - 1.0;
            let bound = if cells.0 == CellKind::Triangle { 0.03 } else { 1e-8 };
            assert!(error.abs() < bound, "{inner} {cells:?} {kind}: {error:e}");
            assert!((torque(&report, 0) / 1e-3 + 1.0).abs() < 1e-12);
        }
    }
}

/// The twist `u_z = r / R³` of a cone under a torque at its tip, R the distance from there, has no body forces. Displacements
/// converge with the order of the elements.
#[test]
fn a_cone_converges_with_the_order_of_its_elements() {
    for (cells, expected) in [(CellKind::Quadrilateral, 2.0), (CellKind::Triangle, 2.0), (CellKind::Triangle6, 3.0)] {
        let elements = [4, 8, 16];
        let errors = elements.map(|n| {
            let load = |name: &str, stress: &str| {
                format!("[[load]]\nboundary = \"{name}\"\ntraction = [\"0\", \"0\", \"{stress} / (x^2 + y^2)^2.5\"]\n")
            };
            let text = body([0.5, 1.0], [1.0, 1.0], [n, n], (cells, Element::Bilinear))
                + &[("top", "-3 * x * y"), ("bottom", "3 * x * y"), ("right", "-3 * x^2"), ("left", "3 * x^2")]
                    .map(|(name, stress)| load(name, stress))
                    .concat()
                + &format!(
                    "[[support]]\npoint = [0.5, 1]\nfix = [\"y\", \"z\"]\ndisplacement = [0, {}]\n",
                    0.5 / 1.25_f64.powf(1.5)
                );
            let found = solved(&parsed(&text).description);
            let off = |(x, u): (&[f64; 3], &[f64; 3])| (u[2] - x[0] / x[0].hypot(x[1]).powi(3)).abs();
            found.model.mesh.nodes.iter().zip(&found.end).map(off).fold(0.0, f64::max)
        });
        assert!(order(&elements, &errors) > expected - 0.3, "{cells:?}: {errors:?}");
    }
}

/// A shaft pressed into a hub slips as a whole when `(T / r)² + F² = (μ N)²`, along the direction in which it is moved.
#[test]
fn a_fit_slips_along_its_screw() {
    let steel = "young = 1e3, poisson = 0.3";
    let text = part("shaft", [[0.0, 0.0], [1.0, 4.0]], [4, 16], steel)
        + &part("hub", [[1.0, 1.0], [1.0, 2.0]], [4, 8], steel)
        + "[[contact]]\nboundary = \"hub:left\"\nagainst = \"shaft:right\"\ngap = -1e-3\nfriction = 0.1\n\
         [[support]]\nboundary = \"hub:right\"\nfix = [\"y\", \"z\"]\n\
         [[coupling]]\nname = \"end\"\nboundary = \"shaft:top\"\n\
         [time]\nend = 2\nincrements = 20\n";
    for [pull, turn] in [[0.1, 0.0], [0.0, 0.1], [0.08, 0.06]] {
        let moved = format!(
            "[[support]]\ncoupling = \"end\"\nfix = [\"y\", \"rotation_y\"]\ndisplacement = [{pull}, {turn}]\nhistory = [[1, 0], [2, 1]]\n"
        );
        let report = solved(&parsed(&(text.clone() + &moved)).description).report;
        let forces = &report.forces.last().unwrap().resultant;
        let limit = 0.1 * forces.sums.sum_p_n;
        let [force, moment] = [report.reactions.last().unwrap().supports[1].force[1], torque(&report, 1)];
        // On a cylinder of radius 1 the torque is the force around it.
        for (found, share) in [(force, pull), (moment, turn)] {
            let expected = limit * share / pull.hypot(turn);
            assert!((found - expected).abs() < 2e-3 * limit, "{pull} {turn}: {found:e} of {expected:e}");
        }
        assert!((force.hypot(moment) / limit - 1.0).abs() < 2e-3);
    }
}

/// A clutch of two plates under a pressure `p` slips at the torque `2/3 π μ p (b³ - a³)`.
#[test]
fn a_clutch_slips_at_its_torque() {
    let plate = |name: &str, y: f64| part(name, [[0.5, y], [0.5, 0.2]], [16, 4], "young = 1e3, poisson = 0");
    let text = plate("lower", 0.0)
        + &plate("upper", 0.2)
        + "[[contact]]\nboundary = \"upper:bottom\"\nagainst = \"lower:top\"\nfriction = 0.3\n\
           [[support]]\nboundary = \"lower:bottom\"\nfix = [\"y\", \"z\"]\n\
           [[coupling]]\nname = \"drive\"\nboundary = \"upper:top\"\n\
           [[load]]\ncoupling = \"drive\"\nforce = [0, -4.71238898038469, 0]\nhistory = [[0, 0], [1, 1]]\n\
           [[support]]\ncoupling = \"drive\"\nfix = [\"rotation_y\"]\ndisplacement = [0.05]\nhistory = [[1, 0], [2, 1]]\n\
           [time]\nend = 2\nincrements = 10\n";
    let report = solved(&parsed(&text).description).report;
    let expected = 2.0 / 3.0 * PI * 0.3 * 2.0 * (1.0 - 0.125); // p = 2
    let found = torque(&report, 1);
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
}

/// A sphere on a rigid plane, pressed and turned: at first it sticks, with the stiffness of a disk, and at last it slips at the
/// torque `3 π / 16 μ P a` of Hertz's pressure (Lubkin, J. Appl. Mech. 18 (1951) 183).
#[test]
fn a_pressed_sphere_is_turned() {
    let text = "[mesh]\nkind = \"block\"\nsize = [[1, 1, 8], [2, 8]]\nelements = [[40, 12, 8], [30, 12]]\n\
         grading = [[1, 1.1, 1.25], [1.05, 1.15]]\n\
         [material]\nyoung = 2.5\npoisson = 0.25\nplane = \"axisymmetric-torsion\"\n\
         [[contact]]\nboundary = \"bottom\"\nfriction = 0.3\nfriction_history = [[0, 1e-6], [0.9, 1e-6], [1, 1]]\n\
         [contact.obstacle]\nkind = \"sphere\"\nradius = 100\napex = [0, 0]\n\
         [[coupling]]\nname = \"drive\"\nboundary = \"top\"\n\
         [[support]]\ncoupling = \"drive\"\nfix = [\"y\"]\ndisplacement = [-0.008]\nhistory = [[0, 0], [0.8, 1]]\n\
         [[support]]\ncoupling = \"drive\"\nfix = [\"rotation_y\"]\ndisplacement = [0.05]\nhistory = [[1, 0], [1.1, 2e-4], [2, 1]]\n\
         [time]\nend = 2\nincrements = 20\n";
    let (_, report) = solved_by_bn(&parsed(text).description, &mut ());
    // The contact zone shrinks a little as friction turns from the radius to the circumference.
    let at = |k: usize| {
        let record = &report.reactions[k];
        let press = -record.supports[0].force[1];
        let radius = (0.75 * press * 100.0 * (1.0 - 0.0625) / 2.5).cbrt();
        (record.supports[1].moment[1], press, radius, record.couplings[0].rotation[1])
    };
    let (moment, _, radius, turn) = at(10);
    let stiffness = moment / turn / (16.0 / 3.0 * radius.powi(3));
    assert!((stiffness - 1.0).abs() < 0.03, "{stiffness}");
    let (moment, press, radius, _) = at(19);
    let share = moment / (3.0 * PI / 16.0 * 0.3 * press * radius);
    assert!((share - 1.0).abs() < 2e-3, "{share}");
}

/// The torque passes through a tightened section, about the axis; contact along a direction out of the section is refused.
#[test]
fn a_section_carries_the_torque() {
    let ring = |name: &str, y: f64| part(name, [[1.0, y], [1.0, 1.0]], [2, 2], "young = 2.5, poisson = 0.25");
    let text = ring("lower", 0.0)
        + &ring("upper", 1.0)
        + "[[contact]]\nboundary = \"lower:top\"\nagainst = \"upper:bottom\"\nglue = true\n\
           [[pretension]]\nname = \"section\"\nboundary = \"lower:top\"\nshortening = 1e-3\n\
           [[support]]\nboundary = \"lower:bottom\"\nfix = [\"y\", \"z\"]\n\
           [[coupling]]\nname = \"end\"\nboundary = \"upper:top\"\n\
           [[load]]\ncoupling = \"end\"\nmoment = 1e-3\n\
           [time]\nend = 1\nincrements = 1\n";
    let (_, report) = solved_by_bn(&parsed(&text).description, &mut ());
    let moment = &report.reactions[0].pretensions[0].moment;
    assert!((moment[1] / 1e-3 - 1.0).abs() < 1e-9 && moment[0] == 0.0, "{moment:?}");
    let inclined = text.replace("glue = true", "friction = 0\ndirection = [0, 1, 0.1]");
    let inclined =
        inclined.replace("[[pretension]]\nname = \"section\"\nboundary = \"lower:top\"\nshortening = 1e-3\n", "");
    says(&refused(&inclined), "direction has 3 components", "[x, y]");
}
