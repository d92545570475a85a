//! A graded rectangle that approximates a half-plane.

use super::block::rectangle;
use super::{Boundary, Mesh};

/// Creates a rectangle of `size` (m) with its lower left corner at the origin, for contact at the left end of its top:
/// `contact_elements` equal columns over the first `contact_width` (m), `outer_elements` equal columns over the rest,
/// and `layers` in geometric progression downwards from elements that are square in the contact zone. Boundaries
/// `bottom`, `right`, `top` (without the contact zone), `contact` and `left`.
pub(super) fn half_plane(
    size: [f64; 2],
    contact_width: f64,
    contact_elements: usize,
    outer_elements: usize,
    layers: usize,
) -> Mesh {
    let [width, height] = size;
    let inner = (0..contact_elements).map(|i| contact_width * i as f64 / contact_elements as f64);
    let rest = width - contact_width;
    let outer = (0..=outer_elements).map(|i| contact_width + rest * i as f64 / outer_elements as f64);
    let xs: Vec<f64> = inner.chain(outer).collect();
    let depths = graded(height, layers, contact_width / contact_elements as f64);
    let ys: Vec<f64> = depths.iter().rev().map(|depth| height - depth).collect();

    let mut mesh = rectangle(&xs, &ys);
    if let Some(top) = mesh.boundaries.iter_mut().find(|boundary| boundary.name == "top") {
        // The top runs from right to left, so that the contact zone is its end.
        let facets = top.facets.split_off(outer_elements);
        // Contact nodes are numbered from the symmetry plane; each edge keeps its direction.
        mesh.boundaries.push(Boundary { name: "contact".into(), facets: facets.into_iter().rev().collect() });
    }
    mesh
}

/// Computes depths from 0 to `height` of `layers` layers in geometric progression with the first thickness `first`; the
/// layers are equal if `first` alone would fill the height.
fn graded(height: f64, layers: usize, first: f64) -> Vec<f64> {
    let sum = |q: f64| (0..layers).fold(0.0, |sum, k| sum + first * q.powi(k as i32));
    // The ratio follows by bisection: the sum grows with it, and a ratio of height / first is too large.
    let (mut low, mut high) = (1e-3, 1.0 + height / first);
    while high - low > f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if sum(middle) < height { low = middle } else { high = middle }
    }
    let ratio = if layers as f64 * first >= height { 1.0 } else { high };
    let mut depths = vec![0.0];
    let mut depth = 0.0;
    for k in 0..layers {
        depth += ratio.powi(k as i32);
        depths.push(depth);
    }
    depths.iter().map(|d| height * (d / depth)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_grow_geometrically_from_square_elements() {
        let depths = graded(1.0, 11, 1.0 / 300.0);
        assert_eq!((depths.len(), depths[0], depths[11]), (12, 0.0, 1.0));
        assert!((depths[1] - 1.0 / 300.0).abs() < 1e-14);
        let ratio = (depths[2] - depths[1]) / depths[1];
        assert!(depths.windows(3).all(|d| ((d[2] - d[1]) / (d[1] - d[0]) - ratio).abs() < 1e-9));
        assert_eq!(graded(1.0, 2, 0.7), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn the_mesh_of_the_punch() {
        let mesh = half_plane([1.0, 1.0], 0.1, 30, 50, 11);
        assert_eq!(mesh.cells.len(), 880);
        let contact = mesh.boundary("contact").unwrap();
        let xs: Vec<f64> = contact.nodes().iter().map(|&node| mesh.nodes[node][0]).collect();
        assert_eq!((xs.len(), xs[0], xs[30]), (31, 0.0, 0.1));
        assert!(xs.windows(2).all(|x| x[1] > x[0]));
        assert_eq!(mesh.boundary("top").unwrap().facets.len(), 50);
    }
}
