//! `stickslip run --uniqueness`: how far the friction is from making the last increment non-unique.

use stickslip::solver::CriticalFriction;

/// Explains a critical friction in words. `mu` are the friction coefficients of all contact nodes.
pub(super) fn explain(critical: &CriticalFriction, mu: &[f64]) -> String {
    let factor = critical.factor;
    if critical.slipping == 0 {
        return "no node slips with friction: more friction changes nothing for the present contact statuses"
            .to_string();
    }
    if factor == 0.0 {
        return "the rate problem is singular even without friction: nothing holds the body".to_string();
    }
    if factor == f64::INFINITY {
        return "rates are unique for the present contact statuses, however large the friction".to_string();
    }
    // If all friction coefficients are equal, the critical coefficient is clearer than the factor.
    let mut frictional = mu.iter().filter(|mu| **mu > 0.0);
    let coefficient = match frictional.next() {
        Some(first) if frictional.all(|mu| mu == first) => format!(" (mu {:.3})", factor * first),
        _ => String::new(),
    };
    let times = format!("{factor:.3} times this friction for the present contact statuses{coefficient}");
    if critical.regular() {
        format!("rates are unique up to {times}")
    } else {
        format!("warning: unique only up to {times}; beyond it the increment may have several solutions or none")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_has_its_words() {
        let words = |factor, slipping, mu: &[f64]| explain(&CriticalFriction { factor, slipping }, mu);
        assert!(words(f64::INFINITY, 0, &[0.4]).starts_with("no node slips"));
        assert!(words(f64::INFINITY, 2, &[0.4, 0.4]).contains("however large"));
        assert!(words(0.0, 1, &[0.4]).contains("singular"));
        let unique = "rates are unique up to 7.500 times this friction for the present contact statuses";
        assert_eq!(words(7.5, 2, &[0.4, 0.0, 0.4]), format!("{unique} (mu 3.000)"));
        assert_eq!(words(7.5, 2, &[0.4, 0.3]), unique);
        let warning = words(0.5, 2, &[4.0, 4.0]);
        assert!(warning.starts_with("warning: unique only up to 0.500 times") && warning.contains("(mu 2.000)"));
        assert!(warning.ends_with("several solutions or none"));
    }
}
