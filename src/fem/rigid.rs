//! Rigid motions that the supports leave free: the null space of `K`.

use std::fmt;

use super::dofs::Dofs;
use crate::mesh::Mesh;
use crate::null_space::{NEGLIGIBLE, null_space};

/// An infinitesimal rigid motion of the body, `u(x) = translation + rotation · (-(y - y₀), x - x₀)`.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotion {
    /// Translation of the point `about`, m.
    pub translation: [f64; 2],
    /// Rotation, rad.
    pub rotation: f64,
    /// The point `(x₀, y₀)`, m.
    pub about: [f64; 2],
    /// The size of the body (m), which says when a rotation is negligible.
    pub size: f64,
}

impl RigidMotion {
    /// The displacement at `x`.
    pub fn at(&self, x: [f64; 2]) -> [f64; 2] {
        let [tx, ty] = self.translation;
        [tx - self.rotation * (x[1] - self.about[1]), ty + self.rotation * (x[0] - self.about[0])]
    }

    /// The motion as a vector of unknowns, length n_u.
    pub fn displacements(&self, mesh: &Mesh, dofs: &Dofs) -> Vec<f64> {
        let mut u = vec![0.0; dofs.free()];
        for (node, &x) in mesh.nodes.iter().enumerate() {
            for (dof, value) in dofs.node(node).into_iter().zip(self.at(x)) {
                if let Some(dof) = dof {
                    u[dof] = value;
                }
            }
        }
        u
    }

    /// The sum `Σ w_k motion_k` of motions about the same point.
    pub fn combination(motions: &[RigidMotion], weights: &[f64]) -> Option<RigidMotion> {
        let mut sum = RigidMotion { translation: [0.0; 2], rotation: 0.0, ..motions.first()?.clone() };
        for (motion, w) in motions.iter().zip(weights) {
            for c in 0..2 {
                sum.translation[c] += w * motion.translation[c];
            }
            sum.rotation += w * motion.rotation;
        }
        Some(sum)
    }
}

impl fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [tx, ty] = self.translation;
        let length = tx.hypot(ty);
        if self.rotation.abs() * self.size <= NEGLIGIBLE * length {
            // + 0.0 turns -0 into 0.
            let [x, y] = [tx, ty].map(|t| (t / length * 1e6).round() / 1e6 + 0.0);
            return write!(f, "a translation along ({x}, {y})");
        }
        // The centre is the point that does not move.
        let centre = [self.about[0] - ty / self.rotation, self.about[1] + tx / self.rotation];
        let step = 10_f64.powi(4 - self.size.log10().ceil() as i32);
        let [x, y] = centre.map(|c| (c * step).round() / step + 0.0);
        write!(f, "a rotation about ({x}, {y}) m")
    }
}

/// The rigid motions of `mesh` that the fixed components of `dofs` leave free: none for a body
/// that is held, three for one that is not supported at all.
pub fn rigid_motions(mesh: &Mesh, dofs: &Dofs) -> Vec<RigidMotion> {
    let bounds = |c: usize| {
        mesh.nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x[c]), hi.max(x[c])))
    };
    let [(x0, x1), (y0, y1)] = [bounds(0), bounds(1)];
    let about = [0.5 * (x0 + x1), 0.5 * (y0 + y1)];
    let size = (x1 - x0).hypot(y1 - y0);
    let unit = |translation, rotation| RigidMotion { translation, rotation, about, size };
    // Directions of equal weight: unit translations, and the rotation that moves the corners by 1/2.
    let all = [unit([1.0, 0.0], 0.0), unit([0.0, 1.0], 0.0), unit([0.0, 0.0], 1.0 / size)];
    let rows = mesh.nodes.iter().enumerate().flat_map(|(node, &x)| {
        let fixed = dofs.node(node).map(|dof| dof.is_none());
        (0..2).filter(move |&c| fixed[c]).map({
            let all = &all;
            move |c| all.iter().map(|motion| motion.at(x)[c]).collect()
        })
    });
    null_space(all.len(), rows).iter().filter_map(|weights| RigidMotion::combination(&all, weights)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::block;

    #[test]
    fn what_supports_leave_free() {
        let mesh = block([2.0, 1.0], [4, 2]);
        let free = |fixed: &dyn Fn(usize, usize) -> bool| rigid_motions(&mesh, &Dofs::new(&mesh, fixed));
        assert_eq!(free(&|_, _| false).len(), 3);
        assert!(free(&|node, _| mesh.nodes[node][0] == 0.0).is_empty());
        let rollers = free(&|node, c| mesh.nodes[node][1] == 0.0 && c == 1);
        assert_eq!(rollers.len(), 1);
        assert_eq!(rollers[0].to_string().replace('-', ""), "a translation along (1, 0)");
        let hinge = free(&|node, _| node == 2);
        assert_eq!(hinge.len(), 1);
        assert_eq!(hinge[0].to_string(), "a rotation about (1, 0) m");
    }
}
