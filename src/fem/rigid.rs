//! Rigid motions that the supports leave free: the null space of `K`.

use std::fmt;
use std::ops::Range;

use super::dofs::Dofs;
use super::spring::Spring;
use crate::mesh::{Geometry, Mesh};
use crate::null_space::{NEGLIGIBLE, null_space};
use crate::units::{Quantity, UnitSystem};
use crate::vector::{cross, dot, minus, norm};

/// What a rotation adds to a translation counts from this share on, when motions are told.
const FAR: f64 = 1e-4;

/// An infinitesimal rigid motion of the body, `u(x) = translation + rotation × (x - about)`.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotion {
    /// Translation of the point `about`, m.
    pub translation: [f64; 3],
    /// Rotation vector, rad; along z in two dimensions.
    pub rotation: [f64; 3],
    /// A point, m.
    pub about: [f64; 3],
    /// The size of the body (m), which says when a rotation is negligible.
    pub size: f64,
    /// 2 or 3.
    pub dimension: usize,
}

impl RigidMotion {
    /// The displacement at `x`.
    pub fn at(&self, x: [f64; 3]) -> [f64; 3] {
        let turned = cross(self.rotation, minus(x, self.about));
        [0, 1, 2].map(|c| self.translation[c] + turned[c])
    }

    /// The motion as a vector of unknowns, length n_u.
    pub fn displacements(&self, mesh: &Mesh, dofs: &Dofs) -> Vec<f64> {
        dofs.unknowns(|node| self.at(mesh.nodes[node]))
    }

    /// The sum `Σ w_k motion_k` of motions about the same point.
    pub fn combination(motions: &[RigidMotion], weights: &[f64]) -> Option<RigidMotion> {
        let mut sum = RigidMotion { translation: [0.0; 3], rotation: [0.0; 3], ..motions.first()?.clone() };
        for (motion, w) in motions.iter().zip(weights) {
            for c in 0..3 {
                sum.translation[c] += w * motion.translation[c];
                sum.rotation[c] += w * motion.rotation[c];
            }
        }
        Some(sum)
    }

    /// `(x, y)` or `(x, y, z)` in whole numbers of `unit`.
    fn rounded(&self, x: [f64; 3], unit: f64) -> String {
        // Dividing by the inverse keeps few digits in print; + 0.0 turns -0 into 0.
        let inverse = (1.0 / unit).round();
        let round = |c: &f64| if unit < 1.0 { (c * inverse).round() / inverse } else { (c / unit).round() * unit };
        let numbers: Vec<String> = x[..self.dimension].iter().map(|c| (round(c) + 0.0).to_string()).collect();
        format!("({})", numbers.join(", "))
    }
}

impl RigidMotion {
    /// The motion in words, with coordinates in `units`.
    pub fn told(&self, units: &UnitSystem) -> String {
        let told = |x: [f64; 3]| x.map(|c| units.of_si(Quantity::Length, c));
        let size = units.of_si(Quantity::Length, self.size);
        let (translation, about) = (told(self.translation), told(self.about));
        RigidMotion { translation, about, size, ..self.clone() }.in_words(&units.name(Quantity::Length))
    }

    /// The motion in words, whose coordinates are in a unit of this name.
    fn in_words(&self, unit: &str) -> String {
        let (length, angle) = (norm(self.translation), norm(self.rotation));
        // A rotation about an axis that is ten thousand sizes away is none that anybody sees.
        if angle * self.size <= FAR * length {
            let along = self.rounded(self.translation.map(|t| t / length), 1e-6);
            return format!("a translation along {along}");
        }
        // The foot of the axis: of all points of the axis the nearest to `about`.
        let arm = cross(self.rotation, self.translation).map(|c| c / (angle * angle));
        let foot = [0, 1, 2].map(|c| self.about[c] + arm[c]);
        let foot = self.rounded(foot, 10_f64.powi(self.size.log10().ceil() as i32 - 4));
        if self.dimension == 2 {
            return format!("a rotation about {foot} {unit}");
        }
        let axis = self.rotation.map(|r| r / angle);
        let pitch = dot(self.translation, axis);
        let motion = if pitch.abs() <= 1e-6 * angle * self.size { "rotation" } else { "screw motion" };
        format!("a {motion} about the axis through {foot} {unit} along {}", self.rounded(axis, 1e-6))
    }
}

impl fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words("m"))
    }
}

/// The rigid motions of `mesh` that the fixed components of `dofs` leave free: none for a body
/// that is held; for one that is not supported at all three in two dimensions, six in three; for one of revolution the translation
/// along its axis, for what moves it aside or tilts it is no motion of its section. First the
/// translations, then rotations about one axis of coordinates each, as far as there are such.
pub fn rigid_motions(mesh: &Mesh, dofs: &Dofs) -> Vec<RigidMotion> {
    unresisted_motions(mesh, dofs, &[], &[])
}

/// Those of them that no spring of `springs` resists.
pub fn unresisted_motions(mesh: &Mesh, dofs: &Dofs, springs: &[Spring], _ties: &[Vec<(usize, [f64; 3])>]) -> Vec<RigidMotion> {
    let all = all_motions(mesh);
    let held = mesh.nodes.iter().enumerate().flat_map(|(node, _)| dofs.held(node).map(move |n| (node, n)));
    let felt = held.chain(springs.iter().flat_map(Spring::resisted));
    let row = |(node, n): (usize, [f64; 3])| all.iter().map(|motion| dot(motion.at(mesh.nodes[node]), n)).collect();
    let translations = all.iter().filter(|motion| motion.rotation == [0.0; 3]).count();
    let basis = readable(null_space(all.len(), felt.map(row)), translations);
    basis.iter().filter_map(|weights| RigidMotion::combination(&all, weights)).collect()
}

/// All rigid motions of a body that nothing holds: translations along the axes, then rotations about them.
fn all_motions(mesh: &Mesh) -> Vec<RigidMotion> {
    let bounds = mesh.bounds();
    let about = bounds.map(|(lo, hi)| 0.5 * (lo + hi));
    let size = norm(bounds.map(|(lo, hi)| hi - lo));
    let dimension = mesh.dimension;
    let along = |axis: usize, length: f64| [0, 1, 2].map(|c| if c == axis { length } else { 0.0 });
    let unit = |translation, rotation| RigidMotion { translation, rotation, about, size, dimension };
    // Directions of equal weight: unit translations, and rotations that move the far corners by about 1/2.
    if mesh.geometry == Geometry::Axisymmetric {
        return vec![unit(along(1, 1.0), [0.0; 3])];
    }
    let translations = (0..dimension).map(|axis| unit(along(axis, 1.0), [0.0; 3]));
    let axes = if dimension == 2 { 2..3 } else { 0..3 };
    let rotations = axes.map(|axis| unit([0.0; 3], along(axis, 1.0 / size)));
    translations.chain(rotations).collect()
}

/// A basis for people of the space of `basis`, whose members are weights of the translations and then of the rotations:
/// first what is a translation only, then rotations about one axis of coordinates each, without the translations
/// that are free by themselves, as far as the space has such members.
///
/// That is the reduced echelon form, the rotations eliminated first; its members are unit, but need not be at right
/// angles.
fn readable(mut basis: Vec<Vec<f64>>, translations: usize) -> Vec<Vec<f64>> {
    let mut pivots = Vec::new();
    for columns in [translations..basis.first().map_or(0, Vec::len), 0..translations] {
        while let Some((column, row)) = pivot(&basis, pivots.len(), columns.clone()) {
            let k = pivots.len();
            basis.swap(k, row);
            let scale = basis[k][column];
            basis[k].iter_mut().for_each(|x| *x /= scale);
            let pivot = basis[k].clone();
            for (_, member) in basis.iter_mut().enumerate().filter(|(j, _)| *j != k) {
                let factor = member[column];
                member.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
            }
            pivots.push(column);
        }
    }
    let mut members: Vec<(usize, Vec<f64>)> = pivots.into_iter().zip(basis).collect();
    members.sort_by_key(|(column, _)| *column);
    let unit = |member: Vec<f64>| {
        let length = member.iter().map(|x| x * x).sum::<f64>().sqrt();
        member.iter().map(|x| x / length).collect()
    };
    members.into_iter().map(|(_, member)| unit(member)).collect()
}

/// The column and the row, from `first` on, to eliminate with: the first of `columns` whose largest entry is not much
/// smaller than that of all. So columns come in order, and are safe to divide by.
fn pivot(rows: &[Vec<f64>], first: usize, columns: Range<usize>) -> Option<(usize, usize)> {
    let largest = |column: usize| {
        let entries = (first..rows.len()).map(|row| (rows[row][column].abs(), row));
        entries.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(entry, _)| *entry > NEGLIGIBLE)
    };
    let all: Vec<_> = columns.filter_map(|column| largest(column).map(|(entry, row)| (entry, column, row))).collect();
    let most = all.iter().fold(0.0_f64, |most, (entry, ..)| most.max(*entry));
    all.into_iter().find(|(entry, ..)| *entry >= 0.5 * most).map(|(_, column, row)| (column, row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::block;

    #[test]
    fn what_supports_leave_free() {
        let mesh = block(&[2.0, 1.0], &[4, 2]);
        let free = |fixed: &dyn Fn(usize, usize) -> bool| rigid_motions(&mesh, &Dofs::new(&mesh, fixed));
        assert_eq!(free(&|_, _| false).len(), 3);
        assert!(free(&|node, _| mesh.nodes[node][0] == 0.0).is_empty());
        let rollers = free(&|node, c| mesh.nodes[node][1] == 0.0 && c == 1);
        assert_eq!(rollers.len(), 1);
        assert_eq!(rollers[0].to_string(), "a translation along (1, 0)");
        let hinge = free(&|node, _| node == 2);
        assert_eq!(hinge.len(), 1);
        assert_eq!(hinge[0].to_string(), "a rotation about (1, 0) m");
    }
}
