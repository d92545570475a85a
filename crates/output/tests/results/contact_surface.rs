//! The contact surface of a body in space, as numbers and as a picture.
#![allow(clippy::unwrap_used)]

use crate::common;
use std::ops::ControlFlow;
use stickslip::body::Model;
use stickslip::run::discretise;
use stickslip::solver::ContactStatus;
use stickslip::solver::history::{IncrementView, Observer, Status};
use stickslip_output::ContactSurface;

/// Observer that keeps the surfaces of every increment, and the sums of the contact forces along x, y and z.
struct Surfaces<'a>(&'a Model, Vec<(Vec<ContactSurface>, [f64; 3])>);

impl Observer for Surfaces<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let mut sum = [0.0; 3];
        for (i, contact) in self.0.contact.nodes.iter().enumerate() {
            let (n, [t, o]) = (contact.facing.normal, contact.facing.tangents);
            let (p_n, p_t, p_o) = (step.state.p_n[i], step.state.p_t[i], step.state.p_o[i]);
            (0..3).for_each(|c| sum[c] += p_n * n[c] + p_t * t[c] + p_o * o[c]);
        }
        self.1.push((ContactSurface::all(self.0, step), sum));
        ControlFlow::Continue(())
    }
}

fn surfaces(overrides: &[&str]) -> Vec<(Vec<ContactSurface>, [f64; 3])> {
    let scene = common::scene("cube.toml", overrides);
    let model = discretise(&scene).unwrap();
    let mut surfaces = Surfaces(&model, Vec::new());
    assert_eq!(common::run_default(&scene, &model, &mut surfaces).status, Status::Converged);
    surfaces.1
}

/// Stresses times their areas add up to the contact forces, whatever the tangents of the computation.
#[test]
fn stresses_add_up_to_the_forces() {
    let oblique = "contact.obstacle={ kind = \"plane\", gap = 1e-5, normal = [0, 0, -1], tangent = [0.6, 0.8, 0] }";
    for overrides in [&["mesh.elements=[4,4,4]"][..], &["mesh.elements=[4,4,4]", oblique]] {
        for (surfaces, force) in surfaces(overrides) {
            let [surface] = &surfaces[..] else { panic!("{}", surfaces.len()) };
            assert_eq!((surface.nodes.len(), surface.facets.len(), &surface.boundary), (25, 16, &None));
            assert_eq!(surface.axes, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
            let mut sum = [0.0; 3];
            for node in &surface.nodes {
                let halves = node.position.iter().filter(|&&x| x == 0.0 || x == 1.0).count();
                let share = 0.0625 / [1.0, 2.0, 4.0][halves];
                assert_eq!(node.status.is_none(), node.position[0] == 0.0, "the clamped edge");
                assert_eq!(node.held, node.status.is_none());
                assert!(node.status != Some(ContactStatus::Open) || node.pressure.abs() < 1.0);
                let stress = [node.traction[0], node.traction[1], -node.pressure];
                (0..3).for_each(|c| sum[c] += share * stress[c]);
            }
            let most = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            assert!((0..3).all(|c| (sum[c] - force[c]).abs() < 1e-9 * most), "{sum:?} {force:?}");
        }
    }
}

#[test]
fn the_picture_says_what_it_shows() {
    let last = |overrides: &[&str]| surfaces(overrides).pop().unwrap().0.remove(0);
    let texts = |svg: &str| svg.lines().filter(|line| !line.starts_with('<')).map(str::to_string).collect::<Vec<_>>();
    let with = last(&["mesh.elements=[4,4,4]"]).to_svg("A < B").unwrap();
    let found = texts(&with);
    for text in ["A &lt; B", "contact stresses, t = 2 s", "open", "held by supports", "stick", "slip", "x, m", "y, m"] {
        assert!(found.iter().any(|line| line == text), "{text}: {found:?}");
    }
    assert!(found.iter().any(|line| line.starts_with("σₜ, tangential, ")) && !with.contains("NaN"), "{found:?}");
    // The largest pressure is marked, and the colours are those of eight to ten bands.
    let surface = last(&["mesh.elements=[4,4,4]"]);
    let most = surface.nodes.iter().map(|node| node.pressure).fold(0.0, f64::max);
    let mark = format!("{:.2} MPa", 1e-6 * most);
    assert!(most > 1e7 && found.contains(&mark), "{mark}: {found:?}");
    // Besides the bands there are polygons for the space outside the surface, and for the two patches of the legend.
    assert!((8 + 3..=10 + 3).contains(&with.matches("<polygon").count()));
    assert!(with.len() < 30_000, "{}", with.len());

    // Without friction there are no arrows and no markers.
    let without = last(&["mesh.elements=[4,4,4]", "contact.friction=0"]).to_svg("").unwrap();
    assert!(!texts(&without).iter().any(|line| line.contains("tangential") || line == "slip"), "{without}");
    assert!(!without.contains("<circle") && with.contains("<circle"));

    let mut broken = last(&["mesh.elements=[2,2,2]"]);
    broken.nodes[3].pressure = f64::NAN;
    assert!(broken.to_svg("").unwrap_err().to_string().contains("not finite"));
}
