//! Static condensation (33)–(35): the problem on the contact displacements alone, and the recovery of the interior.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

use crate::algebra::linear::{Cholesky, Computed, FactorInfo, Reduced, SparseCholesky};
use crate::algebra::sparse::{Csr, DenseSymmetric, Symmetric};
use crate::solver::loading::{LoadCase, Loading};
use crate::solver::problem::{ContactProblem, OwnBasis, Parts, State};

/// The factorisation with which a body is condensed.
///
/// With the contact displacements `u_c` and the interior `u_r`,
///
/// ```text
/// [ K_rr K_rc ] [u_r]   [f_r]         S u_c = f̃_c,  S = K_cc - K_cr K_rr⁻¹ K_rc,
/// [ K_cr K_cc ] [u_c] = [f_c - Cᵀ p]                f̃_c = f_c - Cᵀ p - K_cr K_rr⁻¹ f_r.
/// ```
///
/// `K` never changes. It is factored once with `u_c` last, so that the factors contain `S = L_cc L_ccᵀ`; see
/// [`Cholesky`]. This stiffness form is accurate for slender bodies, where the compliance form `C K⁻¹ Cᵀ` loses half
/// the digits. The interior part of each load case is also computed only once. An increment therefore needs the
/// interior only at its end, in [`Condensed::state`].
///
/// If contact rows couple displacements of several nodes, `OwnBasis` changes the displacements of the condensed
/// problem, so that each node can be eliminated separately.
///
/// If only contact holds a body, `K` is singular; see `SparseCholesky::factor_held`.
///
/// A condensation and its clones keep the factors and `S` of the body condensed last on all contact nodes. A later
/// problem uses them if its stiffness, its contact displacements and its change of basis are equal. Gaps, loads and
/// positive coefficients of friction may differ.
///
/// ```
/// use stickslip::algebra::{Csr, Symmetric};
/// use stickslip::algebra::linear::SparseCholesky;
/// use stickslip::solver::history::{HistorySettings, Method, SystemSolver, run};
/// use stickslip::solver::{Condensation, ContactProblem, LoadCase, Loading, Parts};
///
/// // A node on two springs of 2 N/m, pressed onto a floor with 1 N and pulled along it with 0.5 N.
/// let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 1, 2.0)])?;
/// let (c_n, c_t) = (Csr::from_rows(2, [[(1, -1.0)]])?, Csr::from_rows(2, [[(0, 1.0)]])?);
/// let problem = ContactProblem::new(Parts { c_t, mu: vec![0.1], ..Parts::new(stiffness, c_n) })?;
/// let loading = Loading::new(vec![LoadCase::new(vec![0.5, -1.0], vec![])?], vec![0.0])?;
/// let condensation = Condensation::from(SparseCholesky::default());
/// for (mu, slip) in [(0.1, 0.2), (0.3, 0.1), (0.7, 0.0)] {
///     let problem = problem.with_friction(vec![mu])?;
///     let settings = HistorySettings::new(&problem, &loading, Method::BN)?;
///     let system = SystemSolver::Condensed(condensation.clone());
///     let outcome = run(&problem, &loading, &[1.0], &settings, system, &mut ())?;
///     assert!((outcome.state.u[0] - slip).abs() < 1e-15);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Condensation {
    cholesky: SparseCholesky,
    /// The factors of `K` with the displacements of all contact nodes last, if they exist already.
    factor: Option<Arc<Cholesky>>,
    /// The body condensed last.
    last: Arc<Mutex<Option<CondensedStiffness>>>,
}

/// The condensed stiffness of a body, with what it was computed from.
#[derive(Clone)]
struct CondensedStiffness {
    /// `K`.
    whole: Arc<Symmetric>,
    border: Vec<usize>,
    basis: Option<OwnBasis>,
    factor: Arc<Cholesky>,
    /// `S`, on the basis.
    condensed: Symmetric,
}

impl CondensedStiffness {
    /// Returns `true` if this is the condensed stiffness of such a body.
    fn is_of(&self, whole: &Arc<Symmetric>, border: &[usize], basis: Option<&OwnBasis>) -> bool {
        let is_stiffness = || Arc::ptr_eq(&self.whole, whole) || self.whole == *whole;
        self.border == border && self.basis.as_ref() == basis && is_stiffness()
    }
}

impl From<SparseCholesky> for Condensation {
    /// Creates a condensation that factors `K` with `cholesky`.
    fn from(cholesky: SparseCholesky) -> Self {
        Condensation::factored(cholesky, None)
    }
}

impl Condensation {
    /// Creates a condensation with the `factor` of `K`, which must belong to each problem that the condensation receives.
    pub(crate) fn factored(cholesky: SparseCholesky, factor: Option<Arc<Cholesky>>) -> Self {
        Condensation { cholesky, factor, last: Arc::default() }
    }

    /// Returns the condensed stiffness of a body, which is computed unless it is that of the last one.
    fn stiffness(
        &self,
        whole: &Arc<Symmetric>,
        border: &[usize],
        basis: Option<&OwnBasis>,
    ) -> Computed<CondensedStiffness> {
        if let Some(known) = self.last().filter(|last| last.is_of(whole, border, basis)) {
            return Ok(known);
        }
        let (factor, shift) = if let Some(factor) = &self.factor {
            (Arc::clone(factor), Vec::new())
        } else {
            let (factor, shift) = self.cholesky.factor_held(whole, border)?;
            (Arc::new(factor), shift)
        };
        let mut values = factor.schur_complement(&shift)?;
        if let Some(basis) = basis {
            basis.congruence(border, &mut values);
        }
        let condensed = CondensedStiffness {
            whole: Arc::clone(whole),
            border: border.to_vec(),
            basis: basis.cloned(),
            factor,
            condensed: DenseSymmetric::of_lower(border.len(), values).into(),
        };
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(condensed.clone());
        Ok(condensed)
    }

    /// Returns `true` if `problem` would be condensed with the kept factors.
    pub fn is_for(&self, problem: &ContactProblem) -> bool {
        let Ok(whole) = problem.stiffness().assembled() else { return false };
        let (border, basis) = (problem.contact_displacements(), OwnBasis::of(problem));
        self.last().is_some_and(|last| last.is_of(&whole, &border, basis.as_ref()))
    }

    /// Returns the body condensed last.
    fn last(&self) -> Option<CondensedStiffness> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the factorisation of `K`.
    pub fn cholesky(&self) -> SparseCholesky {
        self.cholesky
    }
}

/// A condensed body.
pub struct Condensed {
    /// The problem on `u_c`.
    pub problem: ContactProblem,
    /// The loads on `u_c`.
    pub loading: Loading,
    factor: Arc<Cholesky>,
    /// The indices of the contact displacements in the whole body, ascending.
    border: Vec<usize>,
    /// The reduced forces of each load case.
    cases: Vec<Reduced>,
    /// The change of basis of the displacements of the problem, if there is one.
    basis: Option<OwnBasis>,
    /// The contact nodes of the condensed problem, if they are a subset.
    subset: Option<NodeSubset>,
}

/// A subset of the contact nodes of a body.
struct NodeSubset {
    /// The contact nodes in the subset, ascending.
    nodes: Vec<usize>,
    /// The number of contact nodes of the body.
    all: usize,
}

impl Condensed {
    /// Condenses a body with its loads.
    ///
    /// # Errors
    /// [`crate::algebra::linear::LinearError::Singular`] if a part of the body can move while the contact nodes are clamped; an error if
    /// memory is short.
    pub fn new(problem: &ContactProblem, loading: &Loading, by: impl Into<Condensation>) -> Computed<Self> {
        let border = problem.contact_displacements();
        let basis = OwnBasis::of(problem);
        let whole = problem.stiffness().assembled()?;
        let CondensedStiffness { factor, condensed: stiffness, .. } =
            by.into().stiffness(&whole, &border, basis.as_ref())?;
        let natural = problem.natural().condensed(&border, &stiffness.diagonal());
        let mut condensed = Condensed {
            problem: ContactProblem::of(Parts {
                stiffness: stiffness.into(),
                c_n: restrict(problem.c_n(), &border, basis.as_ref(), |_| true),
                c_t: restrict(problem.c_t(), &border, basis.as_ref(), |i| problem.mu()[i] > 0.0),
                c_o: restrict(problem.c_o(), &border, basis.as_ref(), |i| problem.mu()[i] > 0.0),
                mu: problem.mu().to_vec(),
                weight: problem.weight().map(<[f64]>::to_vec),
                rigid_modes: Some(
                    (problem.rigid_modes().iter())
                        .map(|motion| {
                            let mut motion = motion.clone();
                            if let Some(basis) = &basis {
                                basis.undo(&mut motion);
                            }
                            border.iter().map(|&dof| motion[dof]).collect()
                        })
                        .collect(),
                ),
            })
            .with_natural_units(natural),
            loading: Loading::default(),
            factor,
            border,
            cases: Vec::new(),
            basis,
            subset: None,
        };
        condensed.load(loading)?;
        Ok(condensed)
    }

    /// Replaces the loading. If the condensed problem has a subset of the contact nodes, the loading is restricted to
    /// it.
    ///
    /// # Errors
    /// If memory is short.
    pub(crate) fn load(&mut self, loading: &Loading) -> Computed<()> {
        let cases =
            loading.cases().iter().map(|case| self.factor.reduce(case.force())).collect::<Result<Vec<_>, _>>()?;
        let reduced = |(case, reduced): (&LoadCase, &Reduced)| case.on(self.on_contact(reduced));
        self.loading = loading.with_cases(loading.cases().iter().zip(&cases).map(reduced).collect());
        self.cases = cases;
        Ok(())
    }

    /// Takes over the histories and gaps of a `loading` with the nodal forces of the present one.
    pub(crate) fn load_again(&mut self, loading: &Loading) {
        let case = |(case, own): (&LoadCase, &LoadCase)| case.on(own.force().to_vec());
        self.loading = loading.with_cases(loading.cases().iter().zip(self.loading.cases()).map(case).collect());
    }

    /// Condenses a body on these contact `nodes` alone, ascending. All other contact nodes carry no forces and are
    /// eliminated with the interior.
    ///
    /// # Errors
    /// As [`Condensed::new`].
    pub(crate) fn of_nodes(
        problem: &ContactProblem,
        loading: &Loading,
        nodes: Vec<usize>,
        cholesky: SparseCholesky,
    ) -> Computed<Self> {
        let condensed = Self::new(&problem.of_nodes(&nodes), &loading.of_nodes(&nodes), cholesky)?;
        Ok(Condensed { subset: Some(NodeSubset { nodes, all: problem.contacts() }), ..condensed })
    }

    /// Returns the contact nodes of the condensed problem, ascending, or `None` if they are all contact nodes of the
    /// body.
    pub(crate) fn nodes(&self) -> Option<&[usize]> {
        self.subset.as_ref().map(|subset| subset.nodes.as_slice())
    }

    /// Restricts per-contact-node values of the body to the nodes of the condensed problem.
    pub(crate) fn on_nodes<'v>(&self, values: &'v [f64]) -> Cow<'v, [f64]> {
        match &self.subset {
            Some(subset) => subset.nodes.iter().map(|&i| values[i]).collect(),
            None => Cow::Borrowed(values),
        }
    }

    /// Extends per-node values of the condensed problem to all contact nodes of the body, with 0 elsewhere.
    pub(crate) fn of_all_nodes(&self, values: Vec<f64>) -> Vec<f64> {
        let Some(NodeSubset { nodes, all }) = &self.subset else { return values };
        let mut of_all = vec![0.0; *all];
        nodes.iter().zip(values).for_each(|(&i, value)| of_all[i] = value);
        of_all
    }

    /// Converts a state of the whole body into one of the condensed problem, up to rounding of the displacements.
    pub(crate) fn condensed_state(&self, whole: &State) -> State {
        let mut u = whole.u.clone();
        if let Some(basis) = &self.basis {
            basis.undo(&mut u);
        }
        State {
            u: self.border.iter().map(|&dof| u[dof]).collect(),
            u_rest: Vec::new(),
            p_t: self.on_nodes(&whole.p_t).into_owned(),
            p_o: self.on_nodes(&whole.p_o).into_owned(),
            p_n: self.on_nodes(&whole.p_n).into_owned(),
        }
    }

    /// Returns information about the factors of the body.
    pub fn info(&self) -> FactorInfo {
        self.factor.info()
    }

    /// Returns the state of the whole body at `time` (35) for a state `contact` of the condensed problem.
    ///
    /// # Errors
    /// If an array of `contact` has another length than the condensed problem needs.
    pub fn state(&self, time: f64, contact: &State) -> Computed<State> {
        let (border, u_rest) = match &self.basis {
            None => (contact.u.clone(), self.spread(&contact.u_rest)),
            Some(basis) => {
                let (mut border, mut u_rest) = (self.spread(&contact.u), self.spread(&contact.u_rest));
                if u_rest.is_empty() {
                    basis.apply(&mut border);
                } else {
                    basis.apply_dd(&mut border, &mut u_rest);
                }
                (self.border.iter().map(|&dof| border[dof]).collect(), u_rest)
            }
        };
        let factors: Vec<f64> = self.loading.cases().iter().map(|case| case.factor(time)).collect();
        let u = self.factor.expand_sum(&self.cases, &factors, &border)?;
        let forces = |p: &Vec<f64>| self.of_all_nodes(p.clone());
        Ok(State { u, u_rest, p_t: forces(&contact.p_t), p_o: forces(&contact.p_o), p_n: forces(&contact.p_n) })
    }

    /// Extends values on the contact displacements to all displacements, with 0 elsewhere. Empty input gives empty
    /// output.
    fn spread(&self, values: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; if values.is_empty() { 0 } else { self.factor.order() }];
        self.border.iter().zip(values).for_each(|(&dof, value)| all[dof] = *value);
        all
    }

    /// Reduces forces on the whole body (N) to the contact displacements: `b_c - K_cr K_rr⁻¹ b_r`.
    ///
    /// # Errors
    /// If memory is short.
    pub fn reduce(&self, forces: &[f64]) -> Computed<Reduced> {
        self.factor.reduce(forces)
    }

    /// Returns reduced forces (N) on the displacements of the condensed problem.
    pub fn on_contact(&self, forces_on_body: &Reduced) -> Vec<f64> {
        forces(&self.border, self.basis.as_ref(), forces_on_body)
    }

    /// Computes the displacements (m) under reduced forces if the displacements of the condensed problem are
    /// `contact` (m).
    ///
    /// # Errors
    /// If memory is short.
    pub fn displacements(&self, forces: &Reduced, contact: &[f64]) -> Computed<Vec<f64>> {
        let mut u = vec![0.0; self.factor.order()];
        match &self.basis {
            None => self.factor.expand(forces, contact, &mut u)?,
            Some(basis) => {
                let mut all = self.spread(contact);
                basis.apply(&mut all);
                let border: Vec<f64> = self.border.iter().map(|&dof| all[dof]).collect();
                self.factor.expand(forces, &border, &mut u)?;
            }
        }
        Ok(u)
    }
}

/// Returns reduced forces on the displacements `border`, transformed by `basis`.
fn forces(border: &[usize], basis: Option<&OwnBasis>, reduced: &Reduced) -> Vec<f64> {
    let Some(basis) = basis else { return reduced.border.clone() };
    let mut all = vec![0.0; border.last().map_or(0, |last| last + 1)];
    border.iter().zip(&reduced.border).for_each(|(&dof, force)| all[dof] = *force);
    basis.apply_transposed(&mut all);
    border.iter().map(|&dof| all[dof]).collect()
}

/// Returns the `wanted` rows of `map` on the contact displacements, transformed by `basis`; all other rows are empty.
fn restrict(map: &Csr, border: &[usize], basis: Option<&OwnBasis>, wanted: impl Fn(usize) -> bool) -> Csr {
    let index = |dof: &usize| border.binary_search(dof).ok();
    let row = |i: usize| {
        let row = basis.map_or_else(|| map.row(i).to_vec(), |basis| basis.row(map, i));
        row.into_iter().filter_map(|(dof, c)| index(&dof).map(|k| (k, c)))
    };
    Csr::of_rows(border.len(), (0..map.rows()).map(|i| row(i).filter(|_| wanted(i)).collect::<Vec<_>>()))
}
