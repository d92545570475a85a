//! Bodies of horizontal layers against the exact solution of layers in series.

use crate::common::prelude::*;

const PRESSURE: f64 = 1e6;

/// Layers 0.25 m, 0.25 m and the base 0.5 m thick, that cannot widen, under a uniform pressure: the
/// displacements of the corners at the top.
fn sink(mesh: &str) -> Vec<[f64; 3]> {
    let text = format!(
        "[mesh]\nsize = [1.0, 1.0]\n{mesh}\n\
         [material]\nyoung = 210e9\npoisson = 0.3\nlayers = [[0.25, 70e9, 0.33], [0.25, 3e9, 0.4]]\n\
         [[support]]\nboundary = \"bottom\"\nfix = [\"y\"]\n\
         [[support]]\nboundary = \"left\"\nfix = [\"x\"]\n\
         [[support]]\nboundary = \"right\"\nfix = [\"x\"]\n\
         [[load]]\nboundary = \"top\"\ntraction = [0.0, -{PRESSURE}]\n\
         [time]\nend = 1.0\nincrements = 1\n"
    );
    let scene = parsed(&text);
    let model = discretise(&scene).unwrap();
    let outcome = common::run(&scene, &model, &mut common::Keep::default());
    assert_eq!(outcome.status, Status::Converged);
    let u = model.constraints.dofs.displacements(&outcome.state.u);
    model.mesh.nodes.iter().zip(u).filter(|(x, _)| x[1] == 1.0).map(|(_, u)| u).collect()
}

#[test]
fn layers_in_series() {
    // The modulus of a layer that cannot widen: E (1 - ν) / ((1 + ν) (1 - 2ν)).
    let modulus = |young: f64, nu: f64| young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let exact = -PRESSURE * (0.25 / modulus(70e9, 0.33) + 0.25 / modulus(3e9, 0.4) + 0.5 / modulus(210e9, 0.3));
    let block = "kind = \"block\"\nelements = [3, 8]\n";
    for mesh in [block.to_string(), format!("{block}grading = [5.0, 1]\n"), format!("{block}element = \"b-bar\"\n")] {
        for [x, y, _] in sink(&mesh) {
            assert!(x.abs() < 1e-12 * exact.abs() && (y / exact - 1.0).abs() < 1e-12, "{x:e} {y:e} {exact:e}");
        }
    }
}

#[test]
fn an_element_belongs_to_the_layer_of_its_centre() {
    let scene = common::block(&["material.layers=[[0.3, 1e9, 0.2], [0.2, 2e9, 0.3]]"]);
    let layer = |height| scene.description.material.layer(height);
    assert_eq!([0.1, 0.29, 0.31, 0.49, 0.51, 0.9].map(layer), [Some(0), Some(0), Some(1), Some(1), None, None]);
}
