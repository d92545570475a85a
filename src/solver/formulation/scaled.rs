//! The problem and the data of its increment in the units of a scaling, for all formulations.

use std::sync::Arc;

use super::Layout;
use crate::algebra::null_space::Motions;
use crate::algebra::sparse::Csr;
use crate::base::units::Scaling;
use crate::solver::laws::coulomb::length;
use crate::solver::problem::{ContactProblem, Increment};

/// The contact maps, and the data of the current increment, scaled.
#[derive(Clone)]
pub(super) struct ScaledData {
    pub layout: Layout,
    pub scaling: Scaling,
    pub c_n: Arc<Csr>,
    pub c_t: Arc<Csr>,
    pub c_o: Arc<Csr>,
    pub mu: Arc<[f64]>,
    pub force: Vec<f64>,
    pub gap: Vec<f64>,
    pub w_t_last: Vec<f64>,
    pub w_o_last: Vec<f64>,
    pub rigid_modes: Arc<[Vec<f64>]>,
    /// The compliances of dependent contact nodes along normal and tangents, 0 of the others.
    pub compliance: Arc<[[f64; 2]]>,
    /// The forces `(p_n, p_t, p_o)` of dependent nodes without a gap due to their compliance.
    reference: Vec<[f64; 3]>,
    /// `true` if these are the forces of a solution.
    is_referred: bool,
}

impl ScaledData {
    pub(super) fn new(problem: &ContactProblem, scaling: Scaling) -> Self {
        let layout = Layout::new(problem);
        ScaledData {
            force: vec![0.0; layout.displacements()],
            gap: vec![0.0; layout.contacts()],
            w_t_last: vec![0.0; layout.contacts()],
            w_o_last: vec![0.0; layout.contacts()],
            layout,
            scaling,
            c_n: Arc::new(problem.c_n().clone()),
            c_t: Arc::new(problem.c_t().clone()),
            c_o: Arc::new(problem.c_o().clone()),
            mu: problem.mu().into(),
            rigid_modes: problem.rigid_modes().into(),
            compliance: problem.natural().compliance.iter().map(|e| e.map(|e| e * scaling.stiffness())).collect(),
            reference: vec![[0.0; 3]; problem.contacts()],
            is_referred: false,
        }
    }

    /// Sets the data of a new increment after the solution `z`, whose friction dependent nodes keep if they can.
    pub(super) fn begin(&mut self, increment: &Increment<'_>, z: &[f64]) {
        let Scaling { force, length } = self.scaling;
        let convert = |to: &mut Vec<f64>, from: &[f64], unit: f64| {
            to.clear();
            to.extend(from.iter().map(|x| x / unit));
        };
        convert(&mut self.force, increment.force, force);
        convert(&mut self.gap, increment.gap, length);
        convert(&mut self.w_t_last, increment.w_t_last, length);
        convert(&mut self.w_o_last, increment.w_o_last, length);
        self.reference.fill([0.0; 3]);
        self.refer(z, |_| 0.0);
        self.is_referred = false;
        if *self.mu != *increment.mu {
            self.mu = increment.mu.into();
        }
    }

    /// Returns `true` if contact rows depend on each other.
    pub(super) fn has_dependent_nodes(&self) -> bool {
        self.compliance.iter().any(|e| e[0] > 0.0)
    }

    /// Returns `true` if the forces of dependent nodes have their reference, or there are none.
    pub(super) fn is_referred(&self) -> bool {
        self.is_referred || !self.has_dependent_nodes()
    }

    /// Takes the forces in `z` as those without a gap due to the compliance.
    pub(super) fn refer_to(&mut self, z: &[f64]) {
        self.refer(z, |p_n| p_n);
        self.is_referred = true;
    }

    /// Refers dependent nodes to their friction in `z`, and to a function of their pressures there.
    fn refer(&mut self, z: &[f64], pressure: impl Fn(f64) -> f64) {
        for (i, [e_n, e_t]) in self.compliance.clone().iter().enumerate().filter(|(_, e)| e[0] > 0.0) {
            let ([p_t, p_o], last) = (self.friction(i, z), self.reference[i]);
            let now = [pressure(z[self.layout.p_n(i)]), p_t, p_o];
            self.gap[i] -= e_n * (now[0] - last[0]);
            self.w_t_last[i] -= e_t * (now[1] - last[1]);
            self.w_o_last[i] -= e_t * (now[2] - last[2]);
            self.reference[i] = now;
        }
    }

    /// Returns `w_n` of node `i`, less the approach due to its compliance; `z` begins with `(u, p_t, p_o, p_n)`.
    pub(super) fn w_n(&self, i: usize, z: &[f64]) -> f64 {
        self.c_n.dot(i, z) - self.compliance[i][0] * z[self.layout.p_n(i)]
    }

    /// Returns `w_t` of node `i`, less the slip due to its compliance.
    pub(super) fn w_t(&self, i: usize, z: &[f64]) -> f64 {
        self.tangential(i, z)[0]
    }

    /// Returns `w_T = (w_t, w_o)` of node `i`, less the slip due to its compliance.
    pub(super) fn tangential(&self, i: usize, z: &[f64]) -> [f64; 2] {
        let (w, p) = ([self.c_t.dot(i, z), self.c_o.dot(i, z)], self.friction(i, z));
        [0, 1].map(|k| w[k] - self.compliance[i][1] * p[k])
    }

    /// Returns the slip increment `w_T - w̄_T` of node `i` for a given `w_T`.
    pub(super) fn slip(&self, i: usize, [w_t, w_o]: [f64; 2]) -> [f64; 2] {
        [w_t - self.w_t_last[i], w_o - self.w_o_last[i]]
    }

    /// Returns `w_n - g` of node `i` at `z + z_lo`, where `z_lo` is below the rounding of `z`.
    pub(super) fn approach_dd(&self, i: usize, z: &[f64], z_lo: &[f64]) -> f64 {
        self.c_n.difference(i, z, z_lo, self.gap[i]) - self.compliance[i][0] * z[self.layout.p_n(i)]
    }

    /// Returns the slip increment of node `i` at `z + z_lo`, where `z_lo` is below the rounding of `z`.
    pub(super) fn slip_dd(&self, i: usize, z: &[f64], z_lo: &[f64]) -> [f64; 2] {
        let slip =
            [self.c_t.difference(i, z, z_lo, self.w_t_last[i]), self.c_o.difference(i, z, z_lo, self.w_o_last[i])];
        let p = self.friction(i, z);
        [0, 1].map(|k| slip[k] - self.compliance[i][1] * p[k])
    }

    /// Returns the part of the slip increment of node `i` at `z` beyond `elastic`, the deformation due to the load: the
    /// slip of a body with a rigid offset, or due to a moving obstacle.
    pub(super) fn excess_slip(&self, i: usize, z: &[f64], elastic: f64) -> [f64; 2] {
        let slip = self.slip(i, self.tangential(i, z));
        let size = length(slip);
        if size > elastic { slip.map(|w| w * (1.0 - elastic / size)) } else { [0.0; 2] }
    }

    /// Returns `p_T = (p_t, p_o)` of node `i`; missing components are 0.
    pub(super) fn friction(&self, i: usize, z: &[f64]) -> [f64; 2] {
        self.layout.tangential(i).map(|k| k.map_or(0.0, |k| z[k]))
    }

    /// Returns the weights of a combination of the rigid modes that would be unconstrained even if all contact nodes
    /// were closed and sticking.
    pub(super) fn unconstrained_mode(&self) -> Option<Vec<f64>> {
        let ScaledData { layout, c_n, c_t, c_o, rigid_modes, .. } = self;
        let [c_n, c_t, c_o] = [c_n, c_t, c_o].map(|map| &**map);
        let normal = (0..layout.contacts()).map(|i| (c_n, i));
        let tangential = (0..layout.contacts()).flat_map(|i| {
            let maps = [c_t, c_o].into_iter().zip(layout.tangential(i));
            maps.filter_map(move |(map, place)| place.map(|_| (map, i)))
        });
        let motions = Motions::new(rigid_modes);
        let row = |(c, i): (&Csr, usize)| motions.felt(c.row(i));
        motions.unfelt(normal.chain(tangential).map(row)).into_iter().next()
    }

    /// Returns the displacements on which contact forces act, ascending.
    pub(super) fn contact_displacements(&self) -> Vec<usize> {
        let ScaledData { layout, c_n, c_t, c_o, .. } = self;
        let mut dofs: Vec<usize> = (0..layout.contacts())
            .flat_map(|i| {
                let [p_t, p_o] = layout.tangential(i);
                let tangential = [(c_t, p_t), (c_o, p_o)].into_iter().filter(|(_, place)| place.is_some());
                let rows = tangential.map(|(map, _)| map.row(i)).chain([c_n.row(i)]);
                rows.flatten().map(|(dof, _)| *dof).collect::<Vec<_>>()
            })
            .collect();
        dofs.sort_unstable();
        dofs.dedup();
        dofs
    }

    /// Returns the sum of the rigid modes with these `weights`, followed by zeros up to `length`.
    pub(super) fn motion(&self, weights: &[f64], length: usize) -> Vec<f64> {
        let mut sum = vec![0.0; length];
        for (motion, weight) in self.rigid_modes.iter().zip(weights) {
            sum.iter_mut().zip(motion).for_each(|(sum, u)| *sum += weight * u);
        }
        sum
    }
}
