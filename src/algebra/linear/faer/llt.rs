//! faer's supernodal Cholesky factorisation `P K Pᵀ = L Lᵀ` in a given order.

use faer::dyn_stack::{MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::cholesky::simplicial::{
    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::linalg::cholesky::supernodal::{
    SymbolicSupernodalCholesky, factorize_supernodal_numeric_llt, factorize_supernodal_numeric_llt_scratch,
    factorize_supernodal_symbolic_cholesky, factorize_supernodal_symbolic_cholesky_scratch,
};
use faer::sparse::linalg::{SymbolicSupernodalParams, amd};
use faer::sparse::utils::{permute_self_adjoint, permute_self_adjoint_scratch};
use faer::sparse::{FaerError, SparseColMatRef};
use faer::{Side, Spec};

use super::{Indices, memory, out_of_memory, parallelism, permutation};
use crate::algebra::linear::supernodal::{Supernodal, Supernode};
use crate::algebra::linear::{Computed, FactorInfo, LinearError};
use crate::algebra::sparse::{Csc, Pattern};

/// Returns a fill-reducing order for a symmetric matrix with this lower triangle. faer has no nested dissection; on
/// plane grids CHOLMOD also chooses minimum degree.
pub(in crate::algebra::linear) fn minimum_degree(lower: &Pattern) -> Computed<Vec<usize>> {
    let failed = |error| out_of_memory(error, "the ordering");
    let lower = Indices::new(lower);
    let mut work = memory(amd::order_scratch::<usize>(lower.n(), lower.rows.len())).map_err(failed)?;
    let (mut order, mut inverse) = (vec![0; lower.n()], vec![0; lower.n()]);
    let stack = MemStack::new(&mut work);
    amd::order(&mut order, &mut inverse, lower.symbolic(), amd::Control::default(), stack).map_err(failed)?;
    Ok(order)
}

/// The factors of faer.
pub(in crate::algebra::linear) struct Llt {
    symbolic: SymbolicSupernodalCholesky<usize>,
    /// The rows below the supernodes, supernode by supernode.
    below: Vec<i64>,
    values: Vec<f64>,
    info: FactorInfo,
}

impl Llt {
    /// Returns entries and operations, without factoring.
    #[cfg(not(feature = "umfpack"))]
    pub(in crate::algebra::linear) fn predict(lower: &Csc, order: &[usize]) -> Computed<FactorInfo> {
        let indices = Indices::new(lower.pattern());
        let analysed = Permuted::new(indices.with(lower.values()), order).and_then(|permuted| permuted.analyse());
        Ok(analysed.map_err(|error| out_of_memory(error, "the symbolic analysis"))?.1)
    }

    /// Factors the symmetric matrix with this lower triangle in the given order.
    pub(in crate::algebra::linear) fn factor(lower: &Csc, order: &[usize]) -> Computed<Self> {
        let indices = Indices::new(lower.pattern());
        let permuted = Permuted::new(indices.with(lower.values()), order);
        let permuted = permuted.map_err(|error| out_of_memory(error, "the ordering"))?;
        let analysed = permuted.analyse().map_err(|error| out_of_memory(error, "the symbolic analysis"))?;
        let (symbolic, mut info) = analysed;

        let par = parallelism(info.flops);
        let size = factorize_supernodal_numeric_llt_scratch::<usize, f64>(&symbolic, par, Spec::default());
        let mut work = memory(size).map_err(|error| out_of_memory(error, "the factorisation"))?;
        let mut values = Vec::new();
        let room = values.try_reserve_exact(symbolic.len_val());
        room.map_err(|_| LinearError::OutOfMemory { step: "the factorisation" })?;
        values.resize(symbolic.len_val(), 0.0);
        let result = factorize_supernodal_numeric_llt(
            &mut values,
            permuted.lower(),
            LltRegularization::default(),
            &symbolic,
            par,
            MemStack::new(&mut work),
            Spec::default(),
        );
        // NaN is no positive pivot either.
        if let Err(LltError::NonPositivePivot { .. }) = result {
            return Err(LinearError::Singular { pivot_ratio: 0.0 });
        }
        let below = symbolic.row_idx().iter().map(|&row| row as i64).collect();
        let (real, index) = (size_of::<f64>(), size_of::<usize>());
        let matrices = (indices.rows.len() + permuted.values.len()) * (real + index);
        let factors = values.len() * real + symbolic.row_idx().len() * 2 * index;
        info.peak_bytes = (matrices + factors + size.unaligned_bytes_required()) as f64;
        Ok(Llt { symbolic, below, values, info })
    }
}

impl Supernodal for Llt {
    fn len(&self) -> usize {
        self.symbolic.n_supernodes()
    }

    fn supernode(&self, k: usize) -> Supernode<'_> {
        let symbolic = &self.symbolic;
        let (first, end) = (symbolic.supernode_begin()[k], symbolic.supernode_end()[k]);
        let row = symbolic.col_ptr_for_row_idx()[k];
        let values = symbolic.col_ptr_for_val()[k]..symbolic.col_ptr_for_val()[k + 1];
        Supernode {
            first,
            columns: end - first,
            below: &self.below[row..row + symbolic.supernode(k).pattern().len()],
            values: &self.values[values],
        }
    }

    fn info(&self) -> FactorInfo {
        self.info
    }
}

/// The lower triangle of `P K Pᵀ`.
struct Permuted {
    indices: Indices,
    values: Vec<f64>,
}

impl Permuted {
    fn new(lower: SparseColMatRef<'_, usize, f64>, order: &[usize]) -> Result<Self, FaerError> {
        let (n, entries) = (order.len(), lower.val().len());
        let mut inverse = vec![0; n];
        order.iter().enumerate().for_each(|(k, &unknown)| inverse[unknown] = k);
        let (mut starts, mut rows, mut values) = (vec![0; n + 1], vec![0; entries], vec![0.0; entries]);
        let mut work = memory(permute_self_adjoint_scratch::<usize>(n))?;
        permute_self_adjoint(
            &mut values,
            &mut starts,
            &mut rows,
            lower,
            permutation(order, &inverse),
            Side::Lower,
            Side::Lower,
            MemStack::new(&mut work),
        );
        Ok(Permuted { indices: Indices { starts, rows }, values })
    }

    fn lower(&self) -> SparseColMatRef<'_, usize, f64> {
        self.indices.with(&self.values)
    }

    /// Returns the supernodes of `L`, its entries and the operations.
    fn analyse(&self) -> Result<(SymbolicSupernodalCholesky<usize>, FactorInfo), FaerError> {
        // faer analyses the upper triangle.
        let (upper, _) = self.indices.transposed();
        let n = upper.n();
        let mut work = memory(StackReq::or(
            prefactorize_symbolic_cholesky_scratch::<usize>(n, upper.rows.len()),
            factorize_supernodal_symbolic_cholesky_scratch::<usize>(n),
        ))?;
        let stack = MemStack::new(&mut work);
        let (mut tree, mut counts) = (vec![0; n], vec![0; n]);
        let tree = prefactorize_symbolic_cholesky(&mut tree, &mut counts, upper.symbolic(), stack);
        let supernodes = SymbolicSupernodalParams::default();
        let symbolic = factorize_supernodal_symbolic_cholesky(upper.symbolic(), tree, &counts, stack, supernodes)?;
        let flops = counts.iter().map(|&count| (count as f64).powi(2)).sum();
        Ok((symbolic, FactorInfo { entries: counts.iter().sum(), flops, ..FactorInfo::default() }))
    }
}
