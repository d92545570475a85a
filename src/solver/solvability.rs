//! Checks before solving, to see if a problem can be expected to have a solution.

mod cone;
mod landing;

use crate::algebra::null_space::NEGLIGIBLE;
use crate::algebra::vector::dot;
use crate::solver::problem::error::{expect_finite, expect_length};
use crate::solver::problem::{ContactProblem, ProblemError};
use cone::{FiniteCone, norm};
pub(crate) use landing::{Landing, NEARBY, is_carried_without_strain, landing};

/// The violations of the conditions (a) and (b) of Theorem 3.
///
/// Theorem 3 of the paper has three conditions, checked here as far as possible:
///
/// - (a) `K u = 0` and `C_n u ≤ 0` only for `u = 0`: no rigid motion takes the body away from every
///   obstacle;
/// - (b) the columns of `[C_nᵀ C_tᵀ]`, in three dimensions of `[C_nᵀ C_tᵀ C_oᵀ]`, are linearly independent;
/// - the Jacobian of `H_I` (25) is regular everywhere in `Ω₊₊` (28). That depends on points which only the iteration
///   visits, and cannot be checked in advance.
///
/// Then Algorithm IP with the partition (F, G) is well defined and drives `H_I` to 0.
///
/// If (a) fails, the existence of a solution depends on the load: see [`rigid_equilibrium`].
#[derive(Debug, Clone, PartialEq)]
pub struct Conditions {
    /// A motion that violates (a), if there is one: the weights of the problem's `rigid_modes`.
    pub leaving: Option<Vec<f64>>,
    /// The contact nodes whose rows violate (b), ascending. An empty row counts as linearly dependent.
    pub dependent: Vec<usize>,
}

impl Conditions {
    /// Checks `problem`. The rows of `C_t` and `C_o` count if there is a `p_t` or `p_o`, that is, if they are not
    /// empty and `μ > 0`.
    pub fn of(problem: &ContactProblem) -> Self {
        Conditions { leaving: leaving(problem), dependent: problem.dependent_nodes() }
    }

    /// Returns `true` if both conditions hold.
    pub fn hold(&self) -> bool {
        self.leaving.is_none() && self.dependent.is_empty()
    }
}

/// Tests if contact forces can balance `force` (n_u, N) against the rigid modes `R`: if there are `p_n ≥ 0` and
/// `|p_T| ≤ μ p_n` with `Rᵀ (f - C_nᵀ p_n - C_tᵀ p_t - C_oᵀ p_o) = 0`.
///
/// This is necessary for an equilibrium, since `Rᵀ K = 0` in (15) multiplied by `Rᵀ`. It is not sufficient, since it
/// lets every contact node carry a force, whatever its gap and its slip.
///
/// If a node has one tangent, the cone of these forces has finitely many edges. If it has two, the cone is circular.
/// An inner cone then grows by the edge on which the residual does most work, until the load is inside or no edge of
/// the whole cone resists the residual. If neither happens, no claim is made, as for a load at the limit of balance.
///
/// Returns the weights of the problem's `rigid_modes` in a motion on which the load does work, while no admissible
/// contact force does negative work. By Farkas' lemma either such a motion or a balance exists. The motion excludes a
/// balance, because the work of all forces would have to vanish.
///
/// # Errors
/// If `force` does not have one finite entry for each displacement.
pub fn rigid_equilibrium(problem: &ContactProblem, force: &[f64]) -> Result<Option<Vec<f64>>, ProblemError> {
    rigid_equilibrium_with(problem, problem.mu(), force)
}

/// Computes [`rigid_equilibrium`] with other friction coefficients than those of the problem (n_c), for example if
/// they change in time.
///
/// # Errors
/// If `force` does not have one finite entry for each displacement, or `mu` not one for each contact node.
pub fn rigid_equilibrium_with(
    problem: &ContactProblem,
    mu: &[f64],
    force: &[f64],
) -> Result<Option<Vec<f64>>, ProblemError> {
    expect_length("mu", problem.contacts(), mu.len(), "one for each contact node")?;
    expect_length("force", problem.displacements(), force.len(), "one for each displacement")?;
    expect_finite("force", force)?;
    let sizes: Vec<f64> = force.iter().map(|f| f.abs()).collect();
    Ok(driven_motion(problem, mu, &Load { force, sizes: &sizes }))
}

/// Computes [`rigid_equilibrium`] for a load of the right size, with the friction coefficients `mu`.
pub(crate) fn driven_motion(problem: &ContactProblem, mu: &[f64], load: &Load<'_>) -> Option<Vec<f64>> {
    let (free, load, size) = Free::under(problem, load);
    let cones: Vec<FrictionCone> =
        (0..problem.contacts()).map(|i| FrictionCone::of(problem, mu[i], &free, i)).collect();
    unbalanced(&cones.iter().collect::<Vec<_>>(), &load, size).map(|y| free.weights(&y))
}

/// Returns `true` if contact forces would balance `load` with any amount of friction where there is some.
pub(crate) fn is_held_by_friction(problem: &ContactProblem, mu: &[f64], load: &Load<'_>) -> bool {
    let (free, load, size) = Free::under(problem, load);
    let forces = (0..problem.contacts()).flat_map(|i| {
        let FrictionCone { mu, normal, tangents } = FrictionCone::of(problem, mu[i], &free, i);
        let frictional = tangents.into_iter().filter(move |_| mu > 0.0);
        frictional.flat_map(|t| [t.iter().map(|t| -t).collect(), t]).chain([normal])
    });
    FiniteCone::new(load.len(), forces).outside(&load, size).is_none()
}

/// Returns a motion of the rigid modes along the contact on which `load` does more work than all friction can take up,
/// if the normal forces are `p_n` (n_c, N): the nodes in contact do not move along their normals, the others not
/// towards their obstacles. Returns `None` if there is no such motion.
pub(crate) fn sliding_motion(problem: &ContactProblem, mu: &[f64], load: &Load<'_>, p_n: &[f64]) -> Option<Vec<f64>> {
    if problem.rigid_modes().is_empty() {
        return None;
    }
    let (free, mut load, size) = Free::under(problem, load);
    let nodes: Vec<FrictionCone> =
        (0..problem.contacts()).map(|i| FrictionCone::of(problem, mu[i], &free, i)).collect();
    // Friction of given normal forces is bounded: one more dimension makes a cone of it.
    let (modes, unit) = (load.len(), norm(&load));
    load.push(unit);
    let normals = nodes.iter().zip(p_n).flat_map(|(node, p_n)| {
        let normal = |sign: f64| node.normal.iter().map(|n| sign * n).chain([0.0]).collect::<Vec<f64>>();
        [Some(normal(1.0)), (*p_n > 0.0).then(|| normal(-1.0))].into_iter().flatten()
    });
    let most = |y: &[f64]| {
        let mut sum = vec![0.0; modes];
        for (node, p_n) in nodes.iter().zip(p_n).filter(|(_, p_n)| **p_n > 0.0) {
            if let Some(steepest) = node.steepest(&y[..modes]) {
                sum.iter_mut().zip(&steepest).for_each(|(sum, t)| *sum += node.mu * p_n * t);
            }
        }
        sum.push(unit);
        Some((dot(&sum, y) / norm(&sum), sum))
    };
    let y = separated(normals.collect(), &load, size, true, most)?;
    Some(free.weights(&y[..modes]))
}

/// Returns the work of `force` (n_u, N) and of the normal forces `p_n` (n_c, N) on a motion of the rigid modes with
/// these `weights` beyond the work that all friction can take up, J per unit of the weights.
pub(crate) fn excess(problem: &ContactProblem, mu: &[f64], force: &[f64], p_n: &[f64], weights: &[f64]) -> f64 {
    let u = problem.rigid_motion(weights);
    dot(&u, force) - dot(problem.c_n().mul(&u), p_n) - friction_work(problem, mu, p_n, &u)
}

/// Returns the largest work (J) of friction against displacements `u`, if the normal forces are `p_n` (n_c, N).
pub(crate) fn friction_work(problem: &ContactProblem, mu: &[f64], p_n: &[f64], u: &[f64]) -> f64 {
    let [_, w_t, w_o] = problem.contact_motion(u);
    (0..p_n.len()).map(|i| mu[i] * p_n[i].max(0.0) * w_t[i].hypot(w_o[i])).sum()
}

/// Returns the part of `load`, a sum of terms of this `size`, that the `cones` do not balance, or `None` if they
/// balance it.
fn unbalanced(cones: &[&FrictionCone], load: &[f64], size: f64) -> Option<Vec<f64>> {
    let generators = cones.iter().flat_map(|cone| cone.edges()).collect();
    let has_rim = cones.iter().any(|cone| cone.tangents.len() > 1);
    separated(generators, load, size, has_rim, |y| {
        cones.iter().filter_map(|cone| cone.edge_towards(y)).max_by(|a, b| a.0.total_cmp(&b.0))
    })
}

/// Returns the part of `load`, a sum of terms of this `size`, that a cone does not balance, or `None` if it does. The
/// cone contains the `generators`; if it is round, `furthest` finds its edge nearest to a direction.
fn separated(
    mut generators: Vec<Vec<f64>>,
    load: &[f64],
    size: f64,
    is_round: bool,
    furthest: impl Fn(&[f64]) -> Option<(f64, Vec<f64>)>,
) -> Option<Vec<f64>> {
    let least = NEARER * norm(load);
    for _ in 0..ROUNDS {
        let y = FiniteCone::new(load.len(), generators.iter().cloned()).outside(load, size)?;
        match furthest(&y).filter(|(gain, _)| *gain > least) {
            Some((_, edge)) => generators.push(edge),
            None if is_round && norm(&y) <= TELLABLE * norm(load) => break,
            None => return Some(y),
        }
    }
    None
}

/// The largest number of rounds. A new edge halves the angle between its neighbours on a rim and leaves a quarter of
/// the gap there, so that far fewer rounds exhaust the digits of a few nodes.
const ROUNDS: usize = 100;
/// A unit edge counts as nearer than the present ones if its product with the residual, relative to the load, is
/// larger than this: ten times the rounding in the residual of a projection.
const NEARER: f64 = 1e-13;
/// The smallest residual, relative to the load, that distinguishes a load from one in balance with edges of this
/// accuracy. The work of the load on the residual is the square of the residual.
const TELLABLE: f64 = 1e-6;

/// The generalised forces of one contact node on the rigid modes.
struct FrictionCone {
    mu: f64,
    normal: Vec<f64>,
    /// The vectors of the tangents that the node has.
    tangents: Vec<Vec<f64>>,
}

impl FrictionCone {
    fn of(problem: &ContactProblem, mu: f64, free: &Free, i: usize) -> Self {
        let rows = problem.tangential_maps().map(|map| map.row(i));
        FrictionCone {
            mu,
            normal: free.products(problem.c_n().row(i)),
            tangents: rows.into_iter().filter(|row| !row.is_empty()).map(|row| free.products(row)).collect(),
        }
    }

    /// Returns `n + μ t`, divided by the larger of `μ` and 1.
    fn edge(&self, mu: f64, tangent: &[f64]) -> Vec<f64> {
        self.normal.iter().zip(tangent).map(|(n, t)| (n + mu * t) / mu.abs().max(1.0)).collect()
    }

    /// Returns the edges along the tangents, and the normal. The normal is the mean of two edges, which would lose it
    /// if mu is very large.
    fn edges(&self) -> Vec<Vec<f64>> {
        let pair = |tangent: &Vec<f64>| [self.edge(self.mu, tangent), self.edge(-self.mu, tangent)];
        self.tangents.iter().flat_map(pair).chain([self.normal.clone()]).collect()
    }

    /// Returns the edge on the rim that is nearest to `y`, with the component of `y` along it, or `None` if the cone
    /// has only [`FrictionCone::edges`].
    fn edge_towards(&self, y: &[f64]) -> Option<(f64, Vec<f64>)> {
        let edge = self.edge(self.mu, &self.steepest(y).filter(|_| self.tangents.len() > 1)?);
        Some((dot(&edge, y) / norm(&edge), edge))
    }

    /// Returns the vector of the tangent along which the node moves in the motion `y`, or `None` if it has none.
    fn steepest(&self, y: &[f64]) -> Option<Vec<f64>> {
        let along: Vec<f64> = self.tangents.iter().map(|t| dot(t, y)).collect();
        let length = norm(&along);
        let sum = |k: usize| self.tangents.iter().zip(&along).map(|(t, along)| along * t[k] / length).sum();
        (length > 0.0).then(|| (0..y.len()).map(sum).collect())
    }
}

/// Returns a violation of (a). Motions with no positive product with a row of `C_n` are the polar of the cone of
/// these rows. Only zero is in the polar if and only if the cone is the whole space, so that it contains every
/// direction.
fn leaving(problem: &ContactProblem) -> Option<Vec<f64>> {
    let free = Free::new(problem);
    let rows: Vec<Vec<f64>> = (0..problem.contacts()).map(|i| free.products(problem.c_n().row(i))).collect();
    let dimension = problem.rigid_modes().len();
    // First tries the direction away from all rows at once, which is the simplest answer.
    let away: Vec<f64> = (0..dimension).map(|k| -rows.iter().map(|row| row[k]).sum::<f64>()).collect();
    let size: f64 = rows.iter().map(|row| norm(row)).sum();
    let cone = FiniteCone::new(dimension, rows);
    let directions = (0..dimension).flat_map(|k| {
        [1.0, -1.0].map(|sign| (0..dimension).map(|j| if j == k { sign } else { 0.0 }).collect::<Vec<f64>>())
    });
    let y = cone.outside(&away, size).or_else(|| directions.into_iter().find_map(|e| cone.outside(&e, 1.0)));
    y.map(|y| free.weights(&y))
}

/// External forces (n_u, N) with the sizes of their terms: a resultant that is only rounding of these terms drives
/// nothing.
#[derive(Clone, Copy)]
pub(crate) struct Load<'a> {
    pub force: &'a [f64],
    pub sizes: &'a [f64],
}

/// The rigid modes, each scaled by its largest displacement, so that units do not matter, and by the loads of its part of the
/// body, so that a large load elsewhere does not.
struct Free<'a> {
    motions: &'a [Vec<f64>],
    largest: Vec<f64>,
    /// The size of the loads on the part, relative to the largest.
    loads: Vec<f64>,
}

impl<'a> Free<'a> {
    fn new(problem: &'a ContactProblem) -> Self {
        let motions = problem.rigid_modes();
        let largest = motions.iter().map(|motion| motion.iter().fold(0.0_f64, |m, u| m.max(u.abs()))).collect();
        Free { motions, largest, loads: vec![1.0; motions.len()] }
    }

    /// Returns the work of `load` on each mode, and the sizes of the terms in these sums.
    fn work(&self, load: &Load<'_>) -> (Vec<f64>, Vec<f64>) {
        let of = |(motion, largest): (&Vec<f64>, &f64)| {
            // Rounding in a mode's zero components counts as zero, since it would be multiplied by whole forces.
            let nonzero = |u: &f64| if u.abs() <= NEGLIGIBLE * largest { 0.0 } else { *u };
            let size = motion.iter().zip(load.sizes).map(|(u, size)| (nonzero(u) * size).abs()).sum::<f64>() / largest;
            (motion.iter().zip(load.force).map(|(u, f)| nonzero(u) * f).sum::<f64>() / largest, size)
        };
        self.motions.iter().zip(&self.largest).map(of).unzip()
    }

    /// Scales the modes by `load`. Returns them with its work on each mode, and the size of the terms in these sums.
    fn under(problem: &'a ContactProblem, load: &Load<'_>) -> (Self, Vec<f64>, f64) {
        let mut free = Free::new(problem);
        let (mut work, mut sizes) = free.work(load);
        let part = |motion: &Vec<f64>| motion.iter().position(|u| *u != 0.0).map(|dof| problem.natural().part[dof]);
        let parts: Vec<Option<usize>> = free.motions.iter().map(part).collect();
        let on =
            |part| sizes.iter().zip(&parts).filter(|(_, of)| **of == part).map(|(size, _)| *size).collect::<Vec<_>>();
        let loads: Vec<f64> = parts.iter().map(|part| norm(&on(*part))).collect();
        let most = loads.iter().fold(0.0_f64, |most, load| most.max(*load));
        free.loads = loads.iter().map(|load| if *load > 0.0 { load / most } else { 1.0 }).collect();
        for (k, load) in free.loads.iter().enumerate() {
            (work[k], sizes[k]) = (work[k] / load, sizes[k] / load);
        }
        (free, work, norm(&sizes))
    }

    /// Returns the product of a contact row with each mode. Rounding counts as zero, because the cone uses any
    /// vector, however short, as a direction.
    fn products(&self, row: &[(usize, f64)]) -> Vec<f64> {
        let size: f64 = row.iter().map(|(_, c)| c.abs()).sum();
        (self.motions.iter().zip(&self.largest))
            .map(|(motion, largest)| row.iter().map(|&(j, c)| c * motion[j]).sum::<f64>() / largest)
            .zip(&self.loads)
            .map(|(w, load)| if w.abs() <= NEGLIGIBLE * size { 0.0 } else { w / load })
            .collect()
    }

    /// Returns the weights of the unscaled modes in `y`, normalised to length one.
    fn weights(&self, y: &[f64]) -> Vec<f64> {
        let motion: Vec<f64> = y.iter().zip(&self.loads).map(|(y, load)| y / load).collect();
        let length = norm(&motion);
        motion.iter().zip(&self.largest).map(|(y, largest)| y / length / largest).collect()
    }

    /// Returns the weights of the unscaled modes in `y`.
    fn weights_of(&self, y: &[f64]) -> Vec<f64> {
        (0..y.len()).map(|k| y[k] / self.loads[k] / self.largest[k]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::Csr;
    use crate::algebra::sparse::Symmetric;
    use crate::solver::problem::Parts;

    fn driven(problem: &ContactProblem, force: &[f64]) -> Option<Vec<f64>> {
        let sizes: Vec<f64> = force.iter().map(|f| f.abs()).collect();
        driven_motion(problem, problem.mu(), &Load { force, sizes: &sizes })
    }

    type Entries<'a> = &'a [(usize, f64)];

    /// Creates one or two rigid particles: displacements that only contact rows connect.
    fn problem(motions: &[&[f64]], displacements: usize, contacts: &[(Entries, Entries, f64)]) -> ContactProblem {
        let row = |entries: Entries| entries.to_vec();
        let c_n = Csr::of_rows(displacements, contacts.iter().map(|(n, ..)| row(n)));
        let c_t = Csr::of_rows(displacements, contacts.iter().map(|(_, t, _)| row(t)));
        ContactProblem::new(Parts {
            stiffness: Symmetric::from_entries(displacements, |_| ()).unwrap().into(),
            c_n,
            c_t,
            c_o: Csr::empty(contacts.len(), displacements).unwrap(),
            mu: contacts.iter().map(|(_, _, mu)| *mu).collect(),
            weight: Some(vec![1.0; contacts.len()]),
            rigid_modes: Some(motions.iter().map(|motion| motion.to_vec()).collect()),
        })
        .unwrap()
    }

    const FREE: [&[f64]; 2] = [&[1.0, 0.0], &[0.0, 1.0]];

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    #[test]
    fn rows_that_share_displacements_are_ranked_together() {
        let (n, t): (Entries, Entries) = (&[(0, 0.6), (1, 0.8)], &[(0, 0.8), (1, -0.6)]);
        let dependent = |contacts: &[(Entries, Entries, f64)]| problem(&[], 8, contacts).dependent_nodes();
        assert_eq!(dependent(&[(n, t, 0.3), (&[(2, -1.0)], &[(3, 1.0)], 0.3)]), [0; 0]);
        // A slanted normal where a roller leaves only x free: the tangent repeats it, if there is friction.
        let roller: (Entries, Entries) = (&[(4, 0.6)], &[(4, 0.8)]);
        assert_eq!(dependent(&[(n, t, 0.3), (roller.0, roller.1, 0.3)]), [1]);
        assert_eq!(dependent(&[(n, t, 0.3), (roller.0, roller.1, 0.0)]), [0; 0]);
        assert_eq!(dependent(&[(n, t, 0.3), (roller.0, &[], 0.3)]), [0; 0]);
        // Two obstacles at one node, the second with friction or without.
        assert_eq!(dependent(&[(n, &[], 0.3), (&[(0, 1.0)], &[], 0.3)]), [0; 0]);
        assert_eq!(dependent(&[(n, t, 0.3), (&[(0, 1.0)], &[], 0.3)]), [0, 1]);
        // A chain of nodes that share displacements, closed by its last row.
        let (a, b, c): (Entries, Entries, Entries) = (&[(0, 1.0), (1, -1.0)], &[(1, 1e-6), (2, -1e-6)], &[(2, 1e6)]);
        let ring: Entries = &[(2, 1.0), (0, -1.0)];
        assert_eq!(dependent(&[(a, &[], 0.0), (b, &[], 0.0), (c, &[], 0.0)]), [0; 0]);
        assert_eq!(dependent(&[(a, &[], 0.0), (b, &[], 0.0), (c, &[], 0.0), (ring, &[], 0.0)]), [0, 1, 3]);
        // A row without entries.
        assert_eq!(dependent(&[(n, t, 0.3), (&[], &[(2, 1.0)], 0.3)]), [1]);
    }

    #[test]
    fn motions_that_leave_every_obstacle() {
        let leaving = |contacts: &[(Entries, Entries, f64)]| leaving(&problem(&FREE, 2, contacts));
        let (down, up, left, right): (Entries, Entries, Entries, Entries) =
            (&[(1, -1.0)], &[(1, 1.0)], &[(0, -1.0)], &[(0, 1.0)]);
        assert!(close(&leaving(&[(down, &[], 0.0)]).unwrap(), &[0.0, 1.0]));
        let half = 0.5_f64.sqrt();
        assert!(close(&leaving(&[(down, &[], 0.0), (left, &[], 0.0)]).unwrap(), &[half, half]));
        // Between two walls only the motion along them remains.
        assert!(close(&leaving(&[(left, &[], 0.0), (right, &[], 0.0)]).unwrap(), &[0.0, 1.0]));
        assert_eq!(leaving(&[(down, &[], 0.0), (up, &[], 0.0), (left, &[], 0.0), (right, &[], 0.0)]), None);
        assert_eq!(leaving(&[(down, &[], 0.0), (&[(0, 1.0), (1, 1.0)], &[], 0.0), (left, &[], 0.0)]), None);
        assert!(leaving(&[]).is_some());
        // Supported, or a rigid mode without contact along it.
        assert_eq!(super::leaving(&problem(&[], 2, &[(down, &[], 0.0)])), None);
        assert_eq!(super::leaving(&problem(&[&[7.0, 0.0]], 2, &[(down, &[], 0.0)])), Some(vec![1.0 / 7.0]));
        // A slanted plane: rounding of a motion along it is no contact.
        let (c, s) = (0.1_f64.cos(), 0.1_f64.sin());
        let slant: [&[f64]; 2] = [&[c, s], &[1e6 * s, -1e6 * c]];
        let wall: Entries = &[(0, -s), (1, c)];
        let back: Entries = &[(0, s), (1, -c)];
        let along = super::leaving(&problem(&slant, 2, &[(wall, &[], 0.0), (back, &[], 0.0)])).unwrap();
        assert!(along[0] > 0.0 && along[1].abs() < 1e-16, "{along:?}");
    }

    #[test]
    fn friction_balances_up_to_its_limit() {
        let floor = |mu| problem(&FREE, 2, &[(&[(1, -1.0)], &[(0, 1.0)], mu)]);
        let balance = |mu, force: [f64; 2]| driven(&floor(mu), &force);
        assert_eq!(balance(0.4, [4.0, -10.0]), None);
        assert_eq!(balance(0.4, [-3.9, -10.0]), None);
        let slide = balance(0.4, [4.1, -10.0]).unwrap();
        // Orthogonal to the edge of the friction cone: forward, and lifting by the friction angle.
        assert!((slide[1] / slide[0] - 0.4).abs() < 1e-12 && slide[0] > 0.0, "{slide:?}");
        assert!(close(&balance(0.4, [0.0, 1.0]).unwrap(), &[0.0, 1.0]));
        // No load; a load in balance up to rounding; forces and friction of any size.
        assert_eq!(balance(0.0, [0.0, 0.0]), None);
        let pair = problem(&[&[1.0, 1.0]], 2, &[]);
        assert_eq!(driven(&pair, &[0.1 + 0.2, -0.3]), None);
        assert_eq!(driven(&pair, &[0.3, -0.2]).unwrap().len(), 1);
        for mu in [1e9, 1e18, 1e300] {
            assert_eq!(balance(mu, [1e3, -1e-4]), None, "{mu}");
            assert_eq!(balance(mu, [0.0, -1.0]), None, "{mu}");
            assert!(balance(mu, [0.0, 1.0]).is_some(), "{mu}");
        }
        for mu in [1e-12, 1e-9, 1e-8, 1e-7, 1e-5] {
            assert_eq!(balance(mu, [0.0, -1.0]), None, "{mu}");
            assert_eq!(balance(mu, [0.9 * mu, -1.0]), None, "{mu}");
            assert_eq!(balance(mu, [2.0 * mu, -1.0]).is_some(), mu > NEGLIGIBLE, "{mu}");
        }
        assert_eq!(driven(&problem(&[], 2, &[]), &[1.0, 1.0]), None);
    }

    /// A particle on a plane with a friction disk has the same limit for every load direction.
    #[test]
    fn friction_balances_up_to_its_limit_in_every_direction() {
        let free: [&[f64]; 3] = [&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0]];
        let floor = problem(&free, 3, &[(&[(2, -1.0)], &[(0, 1.0)], 0.4)]);
        let c_o = Csr::of_rows(3, [[(1, 1.0)]]);
        let floor = ContactProblem::new(Parts { c_o, ..floor.into_parts() }).unwrap();
        for angle in [0.0_f64, 0.3, 0.785, 1.0, 2.0, 3.0, 4.4, 5.9] {
            let load = |side: f64| [side * angle.cos(), side * angle.sin(), -10.0];
            for inside in [0.0, 3.0, 3.99, 4.0 * (1.0 - 1e-9)] {
                assert_eq!(driven(&floor, &load(inside)), None, "{angle} {inside}");
            }
            for outside in [4.0 * (1.0 + 1e-5), 4.1, 100.0] {
                let slide = driven(&floor, &load(outside)).unwrap();
                // Along the load, and lifting by the friction angle. Near the limit the rim is found to the square
                // root of the accuracy of an edge, relative to the residual.
                let along = slide[0].hypot(slide[1]);
                let expected = [along * angle.cos(), along * angle.sin(), 0.4 * along];
                assert!(slide.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{angle} {outside} {slide:?}");
            }
        }
        assert!(close(&driven(&floor, &[0.0, 0.0, 1.0]).unwrap(), &[0.0, 0.0, 1.0]));
    }
}
