//! Surfaces of triangles as obstacles, from STL and Gmsh files, against the shapes that they stand for.

use crate::common::prelude::*;
use crate::common::run;
use std::fmt::Write as _;

pub type Triangle = [[f64; 3]; 3];

/// The upper part of a cylinder of radius 2 about y, with its apex in the origin, in strips; seen from above.
fn cylinder(strips: usize, from: f64, to: f64) -> Vec<Triangle> {
    let at = |k: usize, y: f64| {
        let angle = 0.6 * (2.0 * k as f64 / strips as f64 - 1.0);
        [2.0 * angle.sin(), y, 2.0 * angle.cos() - 2.0]
    };
    (0..strips)
        .flat_map(|k| {
            let [a, b, c, d] = [at(k, from), at(k + 1, from), at(k + 1, to), at(k, to)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

pub fn ascii(triangles: &[Triangle]) -> String {
    let mut text = "solid cylinder\n".to_string();
    for corners in triangles {
        text += " facet normal 0 0 0\n  outer loop\n";
        for [x, y, z] in corners {
            writeln!(text, "   vertex {x:e} {y:e} {z:e}").unwrap();
        }
        text += "  endloop\n endfacet\n";
    }
    text + "endsolid cylinder\n"
}

pub fn binary(triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        corners.iter().flatten().for_each(|c| bytes.extend((*c as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Half a block above the origin on an obstacle, pressed down.
fn slab(obstacle: &str) -> String {
    scene! { format r#"
[mesh] kind = "block", size = [1.0, 0.2, 0.5], elements = [16, 2, 6]
[material] young = 1e9, poisson = 0.3
[[support]] boundary = "top", fix = ["x", "y", "z"]
[[contact]] boundary = "bottom", friction = 0.2, obstacle = {{ {obstacle} }}
[time] end = 2.0, increments = 2
"# }
}

fn solved(text: &str) -> (Model, Vec<State>) {
    let scene = parsed(text);
    let (model, mut keep) = (discretise(&scene).unwrap(), Keep::default());
    assert_eq!(run(&scene, &model, &mut keep).status, Status::Converged);
    (model, keep.states)
}

const MOTION: &str = "approach = [[0, 0], [1, 2e-2], [2, 2e-2]], motion.translation = [[1, 0, 0, 0], [2, 0.05, 0, 0]]";

/// A cylinder that presses and passes, exact and of triangles, whose apexes lie on it: as far apart as flat strips are, with
/// either direction of the gaps. The body ends where the sheet does, and nodes stand over edges of it.
#[test]
fn a_cylinder_of_triangles_is_a_cylinder() {
    let exact = |direction: &str| {
        solved(&slab(&format!(
            "kind = \"cylinder\", radius = 2.0, apex = [0, 0, 0], axis = [0, 1, 0], direction = \"{direction}\", {MOTION}"
        )))
    };
    let strips = 400;
    let triangles = cylinder(strips, 0.0, 0.2);
    let text = Scratch::new("cylinder.stl", ascii(&triangles).as_bytes());
    // In mm, and in single precision.
    let thousand: Vec<Triangle> = triangles.iter().map(|t| t.map(|x| x.map(|c| 1e3 * c))).collect();
    let bytes = Scratch::new("binary.stl", &binary(&thousand));
    // The chord of a strip is so far below its arc.
    let sagitta = 2.0 * (1.0 - (0.6 / strips as f64).cos());
    for direction in ["normal", "nearest"] {
        let (round, of_round) = exact(direction);
        for (file, scale, slack) in [(&text, 1.0, 1e-12), (&bytes, 1e-3, 1e-7)] {
            let (model, states) = solved(&slab(&format!(
                "kind = \"surface\", file = \"{}\", scale = {scale}, direction = \"{direction}\", {MOTION}",
                file.path()
            )));
            assert_eq!(model.contact.nodes.len(), round.contact.nodes.len());
            for t in [0.0, 1.0, 2.0] {
                let gaps = model.loading.gaps_at(t).into_iter().zip(round.loading.gaps_at(t));
                for (contact, (gap, exact)) in model.contact.nodes.iter().zip(gaps) {
                    let off = gap - exact;
                    // Nearest normals are those of the strips, and turn by half a strip's angle at most.
                    let leaning = if direction == "nearest" { 0.06 / strips as f64 } else { 0.0 };
                    assert!(
                        -slack - leaning <= off && off <= 1.2 * sagitta + slack + leaning,
                        "{direction} {t} {:?}: {gap} {exact}",
                        contact.position
                    );
                }
            }
            for (state, exact) in states.iter().zip(&of_round) {
                let [force, whole] = [state, exact].map(|state| state.p_n.iter().sum::<f64>());
                assert!(whole > 1e4 && (force / whole - 1.0).abs() < 2e-3, "{direction}: {force} {whole}");
            }
        }
    }
}

/// A sheet that ends under the body leaves the rest open; a die of Gmsh's triangles and quadrilaterals is read, too.
#[test]
fn a_sheet_smaller_than_the_face() {
    let sheet = |from: f64| Scratch::new("sheet.stl", ascii(&cylinder(200, from, 0.2)).as_bytes());
    let nodes = |direction: &str, file: &Scratch| {
        let scene = slab(&format!("kind = \"surface\", file = \"{}\", direction = \"{direction}\"", file.path()));
        model_of(&scene).contact.nodes.len()
    };
    let (whole, part) = (sheet(0.0), 3 * 17);
    assert_eq!([nodes("normal", &whole), nodes("nearest", &whole)], [part; 2]);
    let narrow = sheet(0.06);
    assert_eq!([nodes("normal", &narrow), nodes("nearest", &narrow)], [2 * 17; 2]);
    // A square of two by two metres at z = -0.125, as two triangles and a quadrilateral.
    let square = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 -1 -1 0 1 1 0 0 0\n$EndEntities\n\
        $Nodes\n1 6 1 6\n2 1 0 6\n1\n2\n3\n4\n5\n6\n-1 -1 -.125\n0.3 -1 -.125\n1 -1 -.125\n1 1 -.125\n0.3 1 -.125\n-1 1 -.125\n\
        $EndNodes\n$Elements\n2 3 1 3\n2 1 3 1\n1 1 2 5 6\n2 1 2 2\n2 2 3 4\n3 2 4 5\n$EndElements\n";
    let square = Scratch::new("square.msh", square.as_bytes());
    let scene = slab(&format!("kind = \"surface\", file = \"{}\"", square.path()));
    let model = model_of(&scene);
    assert!(model.contact.nodes.len() == part && model.contact.nodes.iter().all(|contact| contact.facing.gap == 0.125));
}

/// Cracks that exporters leave between strips, also where corners of one side are between those of the other, cost no node its contact.
#[test]
fn cracks_that_exporters_leave() {
    let whole = Scratch::new("whole.stl", ascii(&cylinder(60, 0.0, 0.2)).as_bytes());
    for direction in ["normal", "nearest"] {
        let of = |file: &Scratch| {
            solved(&slab(&format!(
                "kind = \"surface\", file = \"{}\", direction = \"{direction}\", {MOTION}",
                file.path()
            )))
        };
        let (model, states) = of(&whole);
        let force = |states: &[State]| states[1].p_n.iter().sum::<f64>();
        // The surface is 1.13 m long.
        for width in [2e-6, 5e-6, 1e-5, 2e-5] {
            let narrower = |[x, y, z]: [f64; 3]| [x + if x < 0.0 { -0.5 * width } else { 0.5 * width }, y, z];
            for rows in [1, 3] {
                let strips = |rows: usize| {
                    let of_row =
                        |k: usize| cylinder(60, 0.2 * k as f64 / rows as f64, 0.2 * (k + 1) as f64 / rows as f64);
                    (0..rows).flat_map(of_row).collect::<Vec<_>>()
                };
                let is_left = |corners: &Triangle| corners.iter().map(|x| x[0]).sum::<f64>() < 0.0;
                let left = strips(1)
                    .into_iter()
                    .filter(is_left)
                    .map(|corners| corners.map(|x| narrower([x[0].min(-1e-9), x[1], x[2]])));
                let right = strips(rows)
                    .into_iter()
                    .filter(|corners| !is_left(corners))
                    .map(|corners| corners.map(|x| narrower([x[0].max(0.0), x[1], x[2]])));
                let file = Scratch::new("cracked.stl", ascii(&left.chain(right).collect::<Vec<_>>()).as_bytes());
                let (cracked, found) = of(&file);
                assert_eq!(cracked.contact.nodes.len(), model.contact.nodes.len(), "{direction} {width} {rows}");
                let change = force(&found) / force(&states) - 1.0;
                assert!(change.abs() < 1e-3, "{direction} {width} {rows}: {change}");
            }
        }
    }
}
