//! The paper's block: Table II as far as it is quick, and the check values of the reconstruction.

use stickslip::solver::history::{LinearAlgebra, Status};
use stickslip_studies::tables::{Agreement, Case, Cell, Counts, PaperMethod, PaperTable};

use super::bn;

/// The cells of `method` whose cases are `wanted`.
fn cells(method: PaperMethod, linear: LinearAlgebra, wanted: fn(&Case) -> bool) -> Vec<Cell> {
    let cases = PaperTable::Block.cases().into_iter().filter(wanted);
    cases.map(|case| PaperTable::Block.cell(&case, method, linear).unwrap()).collect()
}

/// BN's counts equal the published ones to rounding. The cells with 100 contact nodes take minutes:
/// `make tables` computes those.
#[test]
fn table_ii_bn() {
    let coarse = cells(PaperMethod::Bn, LinearAlgebra::default(), |case| case.contact_nodes <= 20);
    let fine =
        cells(PaperMethod::Bn, LinearAlgebra::default(), |case| case.contact_nodes == 50 && case.increments == 5);
    let cells = [coarse, fine].concat();
    assert!(cells.iter().all(|cell| cell.status == Status::Converged));
    for difference in [Cell::nle_difference, Cell::nls_difference] {
        let agreement = Agreement::of(cells.iter().map(difference));
        assert_eq!((agreement.equal, agreement.cells), (48, 48), "{cells:?}");
    }
}

/// IP from the safe point: 0.35 of an iteration from the published counts on average, never more
/// than 1. From the last solution single cells are chance, so that only the mean says anything.
#[test]
fn table_ii_ip() {
    let safe = cells(PaperMethod::IpSafe, LinearAlgebra::condensed(), |case| case.contact_nodes <= 20);
    let agreement = Agreement::of(safe.iter().map(Cell::nle_difference));
    assert!(agreement.failed == 0 && agreement.mean <= 0.35 && agreement.largest <= 1.0, "{agreement:?}");
    let prev = cells(PaperMethod::IpPrev, LinearAlgebra::condensed(), |case| case.contact_nodes <= 20);
    let agreement = Agreement::of(prev.iter().map(Cell::nle_difference));
    assert!(agreement.failed == 0 && agreement.mean <= 3.0, "{agreement:?}");
    let default = cells(PaperMethod::Ip, LinearAlgebra::condensed(), |case| case.contact_nodes <= 20);
    for cell in default {
        assert!(cell.status == Status::Converged && cell.here.nle <= 10.0, "{cell:?}");
    }
}

/// Condensed or not, the iterates are the same to rounding.
#[test]
fn condensation_changes_no_count() {
    let some = |case: &Case| case.contact_nodes == 20 && case.increments == 10;
    for method in [PaperMethod::Bn, PaperMethod::IpSafe, PaperMethod::Ip] {
        let [whole, condensed] = [LinearAlgebra::default(), LinearAlgebra::condensed()].map(|l| cells(method, l, some));
        assert_eq!(whole.len(), 3);
        for (whole, condensed) in whole.iter().zip(&condensed) {
            assert_eq!((whole.status, whole.here), (condensed.status, condensed.here));
        }
    }
}

/// Compares forces with six-decimal values in MN.
fn assert_forces(computed: &[f64], expected: &[f64]) {
    assert_eq!(computed.len(), expected.len());
    for (p, e) in computed.iter().zip(expected) {
        assert!((p * 1e-6 - e).abs() <= 0.51e-6, "{computed:?} {expected:?}");
    }
}

/// n = 5, mu = 0.4: contact forces at the maximum of Q1 and at the end, iterations and backtracks.
#[test]
fn check_values() {
    let p_n_max = [0.184_048, 1.135_931, 1.560_943, 1.662_502, 0.574_223];
    let p_n_end = [0.0, 0.582_627, 1.218_624, 1.860_807, 1.640_039];
    let p_t_end = [0.0, -0.020_448, 0.007_464, 0.625_733, 0.656_016];
    for (inc, iterations, backtracks) in
        [(1, vec![5, 3], vec![42, 23]), (5, vec![5, 3, 1, 1, 3, 2, 2, 2, 1, 1], vec![20, 1, 0, 0, 5, 22, 0, 7, 0, 0])]
    {
        let (_, outcome, states) = bn(PaperTable::Block, 5, inc);
        assert_eq!(outcome.records.iter().map(|r| r.iterations).collect::<Vec<_>>(), iterations);
        assert_eq!(outcome.records.iter().map(|r| r.backtracks).collect::<Vec<_>>(), backtracks);
        let at_max = &states[inc - 1];
        assert_forces(&at_max.p_n, &p_n_max);
        assert_forces(&at_max.p_t, &p_n_max.map(|p| -0.4 * p));
        if inc == 5 {
            assert_forces(&outcome.state.p_n, &p_n_end);
            assert_forces(&outcome.state.p_t, &p_t_end);
        }
    }
}

/// Exact resultants at the end of the history, where backward Euler has no error (mu = 0.4, n = 5).
#[test]
fn resultants_equal_the_exact_ones() {
    let (_, outcome, _) = bn(PaperTable::Block, 5, 5);
    assert!((outcome.state.p_n.iter().sum::<f64>() * 1e-6 - 5.302_096).abs() < 1e-6);
    assert!((outcome.state.p_t.iter().sum::<f64>() * 1e-6 - 1.268_765).abs() < 1e-6);
}

/// The default setting of BN over the cells up to 20 contact nodes and those of the punch: all converge, in
/// at least 12 % fewer iterations than the paper's on the block, and no more on the punch.
#[test]
fn the_default_setting_needs_fewer_iterations() {
    for (table, largest, share) in [(PaperTable::Block, 20, 0.88), (PaperTable::Punch, 31, 1.0)] {
        let cases: Vec<_> = table.cases().into_iter().filter(|case| case.contact_nodes <= largest).collect();
        let (mut here, mut paper) = (0.0, 0.0);
        for case in &cases {
            let cell = table.cell(case, PaperMethod::BnDefault, LinearAlgebra::default()).unwrap();
            assert_eq!(cell.status, Status::Converged, "{case:?}");
            here += cell.here.nle;
            paper += case.bn.nle;
        }
        assert!(here <= share * paper, "{table:?}: {here} {paper}");
    }
}

#[test]
fn the_published_tables_are_complete() {
    let (punch, block) = (PaperTable::Punch.cases(), PaperTable::Block.cases());
    assert_eq!((punch.len(), block.len()), (21, 75));
    let last = block[74];
    assert_eq!((last.contact_nodes, last.mu, last.increments), (100, 0.8, 50));
    assert_eq!(last.bn, Counts { nle: 2.7, nls: Some(18.5) });
    assert_eq!((last.ip_safe.nle, last.ip_prev), (14.1, Counts { nle: 20.7, nls: Some(2.8) }));
    assert_eq!((punch[20].mu, punch[20].increments, punch[20].bn.nls), (0.8, 100, Some(23.3)));
}

#[test]
fn agreement_counts_rounding_as_equal() {
    let agreement = Agreement::of([Some(0.05), Some(-0.04), None, Some(0.2)].into_iter());
    assert_eq!((agreement.equal, agreement.cells, agreement.failed, agreement.largest), (2, 3, 1, 0.2));
}
