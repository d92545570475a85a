//! What was found stays found, and a short stretch of every target finds nothing.

use std::time::Duration;

use stickslip_fuzz::pool::{self, Plan, Verdict};
use stickslip_fuzz::{corpus, readers, runs};

/// A stretch of seeds without a failure; how many inputs were of each kind.
fn stretch(count: u64, check: fn(u64) -> Verdict) -> Vec<(&'static str, u64)> {
    let plan = Plan { seed: 0, count, time: Duration::MAX, jobs: 1 };
    let tally = pool::run(plan, check, |_, _| ());
    assert!(tally.failures.is_empty(), "{:?}", tally.failures);
    assert_eq!(tally.done, count);
    tally.kinds.into_iter().collect()
}

/// So many of a hundred inputs at least are of this kind.
fn share(kinds: &[(&'static str, u64)], kind: &str, least: u64) {
    let all: u64 = kinds.iter().map(|(_, count)| count).sum();
    let found = kinds.iter().find(|(name, _)| *name == kind).map_or(0, |(_, count)| *count);
    assert!(100 * found >= least * all, "{kinds:?}");
}

/// Input that is all refused tries little.
#[test]
fn readers_take_or_refuse() {
    let kinds = stretch(40_000, readers::check);
    share(&kinds, "read", 4);
    share(&kinds, "valued", 5);
    share(&kinds, "refused", 30);
}

#[test]
fn runs_obey_the_laws_however_they_are_told() {
    let kinds = stretch(100, runs::check);
    share(&kinds, "converged and compared", 20);
    share(&kinds, "converged", 20);
}

#[test]
fn what_was_found_stays_found() {
    let mut tried = 0;
    for reader in readers::ALL {
        for (path, bytes) in corpus::files(&corpus::found(reader.name)) {
            let verdict = pool::caught(|| reader.check(&bytes));
            assert!(verdict.is_ok(), "{}: {verdict:?}", path.display());
            tried += 1;
        }
    }
    for (path, bytes) in corpus::files(&corpus::found("runs")) {
        let verdict = pool::caught(|| runs::check_scene(&String::from_utf8_lossy(&bytes)));
        assert!(verdict.is_ok(), "{}: {verdict:?}", path.display());
        tried += 1;
    }
    assert!(tried >= 9, "the corpus has gone");
}
