//! Contact zones and slip zones that the mesh does not resolve.

use super::prelude::*;
use crate::base::units::UnitSystem;
use crate::body::estimate::{ContactEstimate, HertzContact, peak_error};
use crate::run::report::ISOLATED;

/// Slip zones with fewer nodes across cause a warning, because their width is known to half a node or one node. Of 600
/// random scenes, 69 had them although the contact itself was wide enough. The friction work was more than 10 % off in
/// 49 of them, and better than 2 % in 4.
const FINE_FOR_SLIP: f64 = 1.0 / 0.15;

/// The peak pressure of zones with fewer nodes across may be 10 % off.
const FINE: usize = 8;

/// Elements that differ by a larger factor at the end of a contact disturb the pressure inside.
const UNEVEN: f64 = 3.0;

/// In zones with fewer nodes across, the width of the stick zone is known to 5 % at best.
const FINE_FOR_STICK: usize = 40;

/// A smaller scatter of the peak is ignored.
const SMOOTH: f64 = 0.1;

/// Returns the warnings of the contact surfaces.
pub(super) fn warnings(Solved { model, checks, estimates, .. }: &Solved<'_>) -> Vec<Warning> {
    let units = model.units();
    let simplices = model.mesh.dimension == 3 && model.mesh.cells.iter().any(|cell| cell.kind.is_simplex());
    let smooth = estimates.contact.iter().filter(|contact| !checks.has_faceted_gaps(model, &contact.boundary));
    let contact = smooth.flat_map(|contact| {
        // For the reported peak, the estimate at its own time counts.
        let peak = estimates.peak.as_ref().filter(|peak| peak.boundary == contact.boundary).unwrap_or(contact);
        let zone = of_zone(contact, &units).or_else(|| of_zone(peak, &units));
        zone.into_iter().chain(of_peak(peak, &units, simplices)).chain(of_ends(contact))
    });
    let mut warnings: Vec<Warning> = contact.collect();
    // For a narrow contact, the warning of its width is enough.
    let narrow = [WarningKind::ContactUnresolved, WarningKind::ContactCoarse];
    if !warnings.iter().any(|warning| narrow.contains(&warning.kind)) {
        warnings.extend(estimates.slip_across.and_then(narrow_slip));
    }
    warnings
}

/// Names the surface and the time of an estimate.
fn at(contact: &ContactEstimate) -> String {
    format!("`{}` at t = {} s", contact.boundary, six_digits(contact.time))
}

fn percent(share: f64) -> String {
    if share > 0.0 && share < 0.005 { "less than 1 %".to_string() } else { format!("{:.0} %", 100.0 * share) }
}

/// Warns of too narrow contact zones.
fn of_zone(contact: &ContactEstimate, units: &UnitSystem) -> Option<Warning> {
    let length = |x: f64| units.rounded(Quantity::Length, x, 3);
    let at = at(contact);
    if contact.unresolved_share > ISOLATED || contact.isolated_share > ISOLATED {
        let reason = if contact.isolated_share > ISOLATED {
            format!("{} of the force is on nodes without a closed neighbour", percent(contact.isolated_share))
        } else {
            format!("{} of the force is on zones of up to 3 nodes across", percent(contact.unresolved_share))
        };
        let size = length(contact.element_size);
        let finer = match contact.hertz {
            Some(HertzContact { half_width, peak_pressure }) => format!(
                "; for this force Hertz' half-width is {} and his peak pressure {}; elements there are {size}, make \
                 them {} (8 across)",
                length(half_width),
                units.rounded(Quantity::Stress, peak_pressure, 3),
                length(0.25 * half_width)
            ),
            None => format!("; elements there are {size}, make them smaller until 8 nodes are across"),
        };
        let message = format!("{at}: {reason}, so pressure and contact width are meaningless there{finer}");
        return Some(Warning { kind: WarningKind::ContactUnresolved, message });
    }
    let n = contact.nodes_across.filter(|&n| n < FINE)?;
    let (peak, width) = (peak_error(n), 2.0 * peak_error(n));
    let message = format!(
        "{at}: the contact zone is only {n} nodes wide: its peak pressure may be off by {}, its width by {}; halve \
         the elements there for {}",
        percent(peak),
        percent(width),
        percent(peak_error(2 * n - 1))
    );
    Some(Warning { kind: WarningKind::ContactCoarse, message })
}

/// Warns if the largest pressure differs much from those around it.
fn of_peak(contact: &ContactEstimate, units: &UnitSystem, simplices: bool) -> Option<Warning> {
    let stress = |x: f64| units.rounded(Quantity::Stress, x, 3);
    let at = at(contact);
    if contact.singular_edge {
        let message = format!(
            "{at}: the pressure is singular at the edge ({} of the force on its nodes): its peak depends on the \
             mesh; use only forces, and pressures away from the edge",
            percent(contact.edge_share)
        );
        return Some(Warning { kind: WarningKind::SingularEdge, message });
    }
    let n = contact.nodes_across;
    if n.is_some_and(|n| n <= 4) || contact.scatter <= SMOOTH.max(n.map_or(0.0, peak_error)) {
        return None;
    }
    let trust = if simplices { "use the mean" } else { "refine the mesh there" };
    let message = format!(
        "{at}: pressures of neighbouring nodes differ: the peak of {} is {} above the mean over its neighbours, {}; \
         {trust}",
        stress(contact.peak_pressure),
        percent(contact.scatter),
        stress(contact.patch_pressure)
    );
    Some(Warning { kind: WarningKind::PeakScatter, message })
}

/// Warns of problems at the ends of the contact and of its stick zone.
fn of_ends(contact: &ContactEstimate) -> Vec<Warning> {
    let at = at(contact);
    let mut warnings = Vec::new();
    if let Some(ratio) = contact.edge_ratio.filter(|ratio| *ratio > UNEVEN) {
        let message = format!(
            "{at}: the contact reaches the end of its boundary, where the elements outside are {ratio:.0} times \
             longer or shorter than those inside: pressures inside may be off by several percent; let elements \
             grow gradually there"
        );
        warnings.push(Warning { kind: WarningKind::UnevenElements, message });
    }
    let n = contact.nodes_across.filter(|n| (FINE..FINE_FOR_STICK).contains(n));
    let partial = contact.stick.as_ref().filter(|stick| stick.ratio > 0.0 && stick.ratio < 1.0);
    if let (Some(stick), Some(n)) = (partial, n) {
        let message = format!(
            "`{}` at t = {} s: the stick zone, {:.2} of the contact width, lies on {n} nodes across the contact: it may be off \
             by an element at each end",
            stick.boundary,
            six_digits(stick.time),
            stick.ratio
        );
        warnings.push(Warning { kind: WarningKind::StickZoneCoarse, message });
    }
    warnings
}

/// Warns if slip zones are too narrow for the friction work.
fn narrow_slip(across: f64) -> Option<Warning> {
    let message = format!(
        "slip zones beside stick zones are only {across:.1} nodes wide (mean weighted by friction work): friction \
         work and slip may be off by about {:.0} %; make elements smaller where nodes slip, until 7 are across",
        100.0 / across
    );
    (across < FINE_FOR_SLIP).then_some(Warning { kind: WarningKind::SlipZoneCoarse, message })
}
