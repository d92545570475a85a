//! The unknowns of a problem and their places in `z = (u, p_t, p_o, p_n)`.

use crate::base::units::Scaling;
use crate::solver::problem::error::expect_length;
use crate::solver::problem::{ContactProblem, ProblemError, State};

/// The layout of `z = (u, p_t, p_o, p_n)`. A contact node has a `p_t` only if there is friction and freedom along
/// that tangent, and likewise a `p_o`: two, one or no tangential unknowns.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Layout {
    displacements: usize,
    /// The places of `p_t` and `p_o` of each contact node in `z`, if it has them.
    tangential: Vec<[Option<usize>; 2]>,
    first_normal: usize,
}

impl Layout {
    /// Creates the layout of `problem`.
    pub fn new(problem: &ContactProblem) -> Self {
        let displacements = problem.displacements();
        let mut next = displacements;
        let mut tangential = vec![[None; 2]; problem.contacts()];
        for (direction, map) in problem.tangential_maps().into_iter().enumerate() {
            for (i, places) in tangential.iter_mut().enumerate() {
                if problem.mu()[i] > 0.0 && !map.row(i).is_empty() {
                    places[direction] = Some(next);
                    next += 1;
                }
            }
        }
        Layout { displacements, tangential, first_normal: next }
    }

    /// Returns the length of `z`.
    pub fn unknowns(&self) -> usize {
        self.first_normal + self.contacts()
    }

    /// Returns the number of displacements, n_u.
    pub fn displacements(&self) -> usize {
        self.displacements
    }

    /// Returns the number of contact nodes and of normal unknowns, n_c.
    pub fn contacts(&self) -> usize {
        self.tangential.len()
    }

    /// Returns the number of tangential unknowns, `p_t` and `p_o`.
    pub fn tangentials(&self) -> usize {
        self.first_normal - self.displacements
    }

    /// Returns the place of `p_t` of contact node `i`, if it has one.
    pub fn p_t(&self, i: usize) -> Option<usize> {
        self.tangential(i)[0]
    }

    /// Returns the place of `p_o` of contact node `i`, if it has one.
    pub fn p_o(&self, i: usize) -> Option<usize> {
        self.tangential(i)[1]
    }

    /// Returns the places of `(p_t, p_o)` of contact node `i`; none for indices beyond the last node.
    pub fn tangential(&self, i: usize) -> [Option<usize>; 2] {
        self.tangential.get(i).copied().unwrap_or_default()
    }

    /// Writes `values` at the places of `(p_t, p_o)` of contact node `i` that it has.
    pub(super) fn set_tangential(&self, i: usize, values: [f64; 2], z: &mut [f64]) {
        for (k, value) in self.tangential(i).into_iter().zip(values) {
            if let Some(k) = k {
                z[k] = value;
            }
        }
    }

    /// Returns `true` if contact node `i` has a tangential unknown.
    pub fn has_friction(&self, i: usize) -> bool {
        self.tangential(i) != [None; 2]
    }

    /// Returns `true` if any contact node has a `p_o`, so that friction may turn.
    pub fn has_second_tangent(&self) -> bool {
        self.tangential.iter().any(|[_, p_o]| p_o.is_some())
    }

    /// Returns `true` if contact node `i` can slide in more than one direction.
    pub fn slides_in_a_plane(&self, i: usize) -> bool {
        self.tangential(i).iter().all(Option::is_some)
    }

    /// Returns the place of `p_n` of contact node `i`.
    pub fn p_n(&self, i: usize) -> usize {
        self.first_normal + i
    }

    /// Converts a state to `z`, in the units of `scaling`.
    ///
    /// # Errors
    /// If an array of `state` has another length than the layout needs.
    pub fn pack(&self, state: &State, scaling: &Scaling) -> Result<Vec<f64>, ProblemError> {
        expect_length("u", self.displacements, state.u.len(), "one for each displacement")?;
        for (array, values) in [("p_t", &state.p_t), ("p_o", &state.p_o), ("p_n", &state.p_n)] {
            expect_length(array, self.contacts(), values.len(), "one for each contact node")?;
        }
        Ok(self.packed(state, scaling))
    }

    /// Computes [`Layout::pack`] of a state of the right size.
    pub(crate) fn packed(&self, state: &State, scaling: &Scaling) -> Vec<f64> {
        let mut z = vec![0.0; self.unknowns()];
        for (to, from) in z.iter_mut().zip(&state.u) {
            *to = from / scaling.length;
        }
        for i in 0..self.contacts() {
            self.set_tangential(i, [state.p_t[i], state.p_o[i]].map(|p| p / scaling.force), &mut z);
            z[self.p_n(i)] = state.p_n[i] / scaling.force;
        }
        z
    }

    /// Returns the state of `z + z_lo`, where `z_lo` is below the rounding of `z`, or all 0.
    pub(crate) fn unpacked_with(&self, z: &[f64], z_lo: &[f64], scaling: &Scaling) -> State {
        let mut state = self.unpacked(z, scaling);
        if z_lo.iter().any(|rest| *rest != 0.0) {
            state.u_rest = z_lo[..self.displacements].iter().map(|x| x * scaling.length).collect();
        }
        state
    }

    /// Converts a `z` that begins with this layout to a state; the inverse of [`Layout::pack`].
    ///
    /// # Errors
    /// If `z` has fewer entries than the layout needs.
    pub fn unpack(&self, z: &[f64], scaling: &Scaling) -> Result<State, ProblemError> {
        expect_length("z", self.unknowns(), z.len().min(self.unknowns()), "at least, one for each unknown")?;
        Ok(self.unpacked(z, scaling))
    }

    /// Computes [`Layout::unpack`] of a `z` that is long enough.
    pub(crate) fn unpacked(&self, z: &[f64], scaling: &Scaling) -> State {
        let tangential = |direction: usize| {
            let dofs = self.tangential.iter().map(|places| places[direction]);
            dofs.map(|k| k.map_or(0.0, |k| z[k] * scaling.force)).collect()
        };
        State {
            u: z[..self.displacements].iter().map(|x| x * scaling.length).collect(),
            u_rest: Vec::new(),
            p_t: tangential(0),
            p_o: tangential(1),
            p_n: z[self.first_normal..self.unknowns()].iter().map(|x| x * scaling.force).collect(),
        }
    }
}
