//! Rigid motions of the bodies that the supports leave free: the null space of `K`.

use std::fmt;
use std::ops::Range;

use super::dofs::{Dofs, Tie};
use crate::algebra::null_space::{NEGLIGIBLE, Row, null_space};
use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::{cross, dot, minus, norm, plus};
use crate::base::units::{Quantity, UnitSystem};
use crate::body::fem::Spring;
use crate::body::mesh::{Bodies, Mesh};

/// The least share of rotation in a translation that the description of a motion mentions.
const FAR: f64 = 1e-3;

/// An infinitesimal rigid motion of each body of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotion {
    /// The motions of the bodies, in the order of [`Mesh::bodies`].
    pub bodies: Vec<BodyMotion>,
    /// The dimension, 2 or 3; with torsion 3.
    pub dimension: usize,
}

/// An infinitesimal rigid motion of one body, `u(x) = translation + rotation × (x - about)`.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMotion {
    /// The name of the body.
    pub name: String,
    /// Translation of the point `about`, m.
    pub translation: [f64; 3],
    /// Rotation vector, rad; along z in two dimensions.
    pub rotation: [f64; 3],
    /// The reference point of the rotation, m.
    pub about: [f64; 3],
    /// The size of the body (m), which decides if a rotation is negligible.
    pub size: f64,
}

impl BodyMotion {
    /// Returns the displacement at `x`.
    pub fn at(&self, x: [f64; 3]) -> [f64; 3] {
        let turned = cross(self.rotation, minus(x, self.about));
        [0, 1, 2].map(|c| self.translation[c] + turned[c])
    }

    /// Adds `w` times another motion of the body.
    fn add(&mut self, w: f64, other: &BodyMotion) {
        self.translation = plus(self.translation, w, other.translation);
        self.rotation = plus(self.rotation, w, other.rotation);
    }

    /// Returns the approximate size of the displacements of the body, m.
    fn length(&self) -> f64 {
        norm(self.translation) + norm(self.rotation) * self.size
    }

    /// Describes the motion, with coordinates in a unit of this name.
    fn in_words(&self, dimension: usize, unit: &str) -> String {
        let rounded = |x: [f64; 3], unit: f64| rounded(&x[..dimension], unit);
        let (length, angle) = (norm(self.translation), norm(self.rotation));
        // A rotation about an axis a thousand sizes away counts as a translation.
        if angle * self.size <= FAR * length {
            let along = rounded(self.translation.map(|t| t / length), 1e-6);
            return format!("a translation along {along}");
        }
        // The point of the axis nearest to `about`.
        let arm = cross(self.rotation, self.translation).map(|c| c / (angle * angle));
        let foot = [0, 1, 2].map(|c| self.about[c] + arm[c]);
        let foot = rounded(foot, 10_f64.powi(self.size.log10().ceil() as i32 - 4));
        if dimension == 2 {
            return format!("a rotation about {foot} {unit}");
        }
        let axis = self.rotation.map(|r| r / angle);
        let pitch = dot(self.translation, axis);
        let motion = if pitch.abs() <= 1e-6 * angle * self.size { "rotation" } else { "screw motion" };
        format!("a {motion} about the axis through {foot} {unit} along {}", rounded(axis, 1e-6))
    }
}

/// Formats `(x, y)` or `(x, y, z)` rounded to multiples of `unit`.
fn rounded(x: &[f64], unit: f64) -> String {
    // Division by the inverse keeps the printed digits few; + 0.0 turns -0 into 0.
    let inverse = (1.0 / unit).round();
    let round = |c: &f64| if unit < 1.0 { (c * inverse).round() / inverse } else { (c / unit).round() * unit };
    let numbers: Vec<String> = x.iter().map(|c| (round(c) + 0.0).to_string()).collect();
    format!("({})", numbers.join(", "))
}

impl RigidMotion {
    /// Returns the motion, which belongs to this mesh, as a vector of unknowns, length n_u.
    pub fn displacements(&self, mesh: &Mesh, dofs: &Dofs) -> Vec<f64> {
        let bodies = mesh.bodies();
        let of_node = |node: usize| dofs.in_motion(mesh, node, &self.bodies[bodies.of_nodes()[dofs.in_mesh(node)]]);
        dofs.unknowns(|node| dofs.jump_of(node).map_or_else(|| of_node(node), |jump| jump.at(of_node)))
    }

    /// Computes the sum `Σ w_k motion_k` of motions of one mesh.
    pub fn combination(motions: &[RigidMotion], weights: &[f64]) -> Option<RigidMotion> {
        let mut sum = motions.first()?.clone();
        for (k, own) in sum.bodies.iter_mut().enumerate() {
            *own = at_rest(own);
            for (motion, w) in motions.iter().zip(weights) {
                own.add(*w, &motion.bodies[k]);
            }
        }
        Some(sum)
    }

    /// Describes the motion, with coordinates in `units`. If there are several bodies, the moving ones are named: ``
    /// `upper`: a translation along (0, 1); `lower`: a rotation about (1, 0) m``.
    pub fn describe(&self, units: &UnitSystem) -> String {
        let (length, unit) = (|x: f64| units.of_si(Quantity::Length, x), units.name(Quantity::Length));
        let converted = |motion: &BodyMotion| BodyMotion {
            translation: motion.translation.map(length),
            about: motion.about.map(length),
            size: length(motion.size),
            ..motion.clone()
        };
        RigidMotion { bodies: self.bodies.iter().map(converted).collect(), ..self.clone() }.in_words(&unit)
    }

    /// Describes what moves and how: "the body against a translation along (0, 1)", `` `upper` against a translation
    /// along (0, 1)``.
    pub fn against(&self, units: &UnitSystem) -> String {
        let text = self.describe(units);
        match &self.moving()[..] {
            _ if self.bodies.len() == 1 => format!("the body against {text}"),
            [_] => text.replacen("`: ", "` against ", 1),
            _ => format!("the bodies against {text}"),
        }
    }

    /// Describes how the bodies slide: "the body slides along (0, 1)", `` `hub` turns about (0, 0) mm``.
    pub fn sliding(&self, units: &UnitSystem) -> String {
        let verbs = [
            ("a translation along", "slides along"),
            ("a rotation about", "turns about"),
            ("a screw motion about", "moves on a screw about"),
        ];
        let text = self.describe(units);
        let verbal = verbs.iter().fold(text.clone(), |text, (noun, verb)| text.replace(noun, verb));
        match &self.moving()[..] {
            _ if self.bodies.len() == 1 => format!("the body {verbal}"),
            [_] => verbal.replacen("`: ", "` ", 1),
            _ => format!("the bodies move, {text}"),
        }
    }

    /// Returns the length of a translation (m) or the angle of a rotation (rad) of the only body that moves, with the
    /// quantity that does work on it; `None` for a screw motion or several bodies.
    pub(crate) fn extent(&self) -> Option<(Quantity, f64)> {
        let [body] = self.moving()[..] else { return None };
        let (length, angle) = (norm(body.translation), norm(body.rotation));
        if angle * body.size <= FAR * length {
            return Some((Quantity::Force, length));
        }
        (dot(body.translation, body.rotation).abs() <= 1e-6 * angle * angle * body.size)
            .then_some((Quantity::Moment, angle))
    }

    /// Returns the bodies with a non-negligible motion.
    fn moving(&self) -> Vec<&BodyMotion> {
        let furthest = self.bodies.iter().map(BodyMotion::length).fold(0.0, f64::max);
        self.bodies.iter().filter(|body| self.bodies.len() == 1 || body.length() > FAR * furthest).collect()
    }

    /// Describes the motion, with coordinates in a unit of this name.
    fn in_words(&self, unit: &str) -> String {
        // Bodies with the same motion are described together.
        let mut list: Vec<(String, Vec<String>)> = Vec::new();
        for body in self.moving() {
            let words = body.in_words(self.dimension, unit);
            if self.bodies.len() == 1 {
                return words;
            }
            let name = format!("`{}`", body.name);
            match list.iter_mut().find(|(other, _)| *other == words) {
                Some((_, names)) => names.push(name),
                None => list.push((words, vec![name])),
            }
        }
        list.into_iter().map(|(words, names)| format!("{}: {words}", names.join(", "))).collect::<Vec<_>>().join("; ")
    }
}

impl fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words("m"))
    }
}

impl Dofs {
    /// Returns the displacement of a node of the mesh or of a reference point in a rigid motion.
    pub fn in_motion(&self, mesh: &Mesh, node: usize, motion: &BodyMotion) -> [f64; 3] {
        match self.point_of(node) {
            None => motion.at(mesh.nodes[node]),
            Some((point, false)) => motion.at(point.position),
            Some((point, true)) => point.of_rotation(mesh.components(), motion.rotation),
        }
    }
}

/// Computes the rigid motions of `mesh` that the fixed components of `dofs` leave free.
///
/// A fully supported body has none; a body without supports has three in two dimensions, six in three dimensions. A body of
/// revolution has the translation along its axis and, with torsion, the rotation about it. Translations are first, then rotations about one
/// coordinate axis each, if there are such; body by body.
pub fn rigid_motions(mesh: &Mesh, dofs: &Dofs) -> Vec<RigidMotion> {
    unresisted_motions(mesh, dofs, &[], &[])
}

/// Computes the rigid motions that no spring of `springs` resists and for which each of the `ties`, between bodies or
/// of a body to the ground, is 0. Bodies connected by ties move together.
pub fn unresisted_motions(mesh: &Mesh, dofs: &Dofs, springs: &[Spring], ties: &[Tie]) -> Vec<RigidMotion> {
    let bodies = mesh.bodies();
    let own: Vec<Vec<BodyMotion>> = (0..bodies.count()).map(|k| all_motions(mesh, &bodies, k)).collect();
    let of = |node: usize| bodies.of_nodes()[dofs.in_mesh(node)];
    let mut joined = UnionFind::new(bodies.count());
    for tie in ties {
        tie.windows(2).for_each(|pair| joined.join(of(pair[0].0), of(pair[1].0)));
    }
    let first_of: Vec<usize> = (0..bodies.count()).map(|k| joined.least(k)).collect();
    let still: Vec<BodyMotion> = own.iter().map(|motions| at_rest(&motions[0])).collect();
    let mut found = Vec::new();
    for first in (0..bodies.count()).filter(|&k| first_of[k] == k) {
        let together: Vec<usize> = (0..bodies.count()).filter(|&k| first_of[k] == first).collect();
        // The translations of all these bodies are first, then their rotations.
        let (moves, turns): (Vec<_>, Vec<_>) = (together.iter())
            .flat_map(|&k| own[k].iter().map(move |motion| (k, motion)))
            .partition(|(_, motion)| motion.rotation == [0.0; 3]);
        let translations = moves.len();
        let all: Vec<(usize, &BodyMotion)> = moves.into_iter().chain(turns).collect();
        // The forms have directions of unit length, and the motions displacements of about one.
        let row = |form: &[(usize, [f64; 3])]| -> Row {
            let projected = |k: usize, motion: &BodyMotion| {
                let own = form.iter().filter(|(node, _)| of(*node) == k);
                own.map(|(node, c)| dot(dofs.in_motion(mesh, *node, motion), *c)).sum()
            };
            Row::of_unit_size(all.iter().map(|(k, motion)| projected(*k, motion)).collect())
        };
        // The ties contain the held directions of jumps.
        let nodes = 0..dofs.node_of_jump(0);
        let held = nodes.flat_map(|node| dofs.held(node).map(move |n| (node, n)));
        let single = held.chain(springs.iter().flat_map(Spring::resisted));
        let single = single.filter(|(node, _)| first_of[of(*node)] == first).map(|form| row(&[form]));
        let several = ties.iter().filter(|tie| tie.first().is_some_and(|(node, _)| first_of[of(*node)] == first));
        let rows = single.chain(several.map(|tie| row(&of_unit_size(tie))));
        for weights in readable(null_space(all.len(), rows), translations) {
            let mut bodies = still.clone();
            for ((k, motion), w) in all.iter().zip(weights) {
                bodies[*k].add(w, motion);
            }
            found.push(RigidMotion { bodies, dimension: mesh.components() });
        }
    }
    found
}

/// Scales the form so that its largest coefficient is 1.
fn of_unit_size(tie: &Tie) -> Tie {
    let size = tie.iter().map(|(_, c)| norm(*c)).fold(0.0, f64::max);
    tie.iter().map(|(node, c)| (*node, c.map(|c| if size > 0.0 { c / size } else { 0.0 }))).collect()
}

/// Returns the motion of the same body at rest.
fn at_rest(motion: &BodyMotion) -> BodyMotion {
    BodyMotion { translation: [0.0; 3], rotation: [0.0; 3], ..motion.clone() }
}

/// Returns all rigid motions of the unsupported body `k`: translations along the axes, then rotations about them.
fn all_motions(mesh: &Mesh, bodies: &Bodies, k: usize) -> Vec<BodyMotion> {
    let bounds = mesh.bounds_of(bodies.nodes(k));
    let middle = bounds.map(|(lo, hi)| 0.5 * (lo + hi));
    let about = if mesh.geometry.is_revolved() { [0.0, middle[1], 0.0] } else { middle };
    let size = norm(bounds.map(|(lo, hi)| hi - lo));
    let along = |axis: usize, length: f64| [0, 1, 2].map(|c| if c == axis { length } else { 0.0 });
    let name = &bodies.names()[k];
    let unit = |translation, rotation| BodyMotion { name: name.clone(), translation, rotation, about, size };
    // The motions have similar sizes: unit translations, and rotations that move the far corners by about 1/2.
    let directions = if mesh.geometry.is_revolved() { 1..2 } else { 0..mesh.dimension };
    let translations = directions.map(|axis| unit(along(axis, 1.0), [0.0; 3]));
    let rotations = mesh.rotation_axes().map(|axis| unit([0.0; 3], along(axis, 1.0 / size)));
    translations.chain(rotations).collect()
}

/// Returns a readable basis of the space of `basis`, whose members are weights of the translations and then of the
/// rotations. Pure translations are first, then rotations about one coordinate axis each, without the free
/// translations, if the space has such members.
///
/// The result is the reduced echelon form with the rotations eliminated first. Its members are unit vectors but not
/// necessarily orthogonal.
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

/// Returns the pivot column and row, from `first` on: the first of `columns` whose largest entry is not much smaller
/// than the largest of all. This keeps the order of columns and avoids small pivots.
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
    use crate::body::mesh::block;

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
