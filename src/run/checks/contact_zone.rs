//! Contact zones and slip zones that the mesh does not resolve.

use super::prelude::*;
use crate::base::units::UnitSystem;
use crate::body::estimate::{ContactEstimate, HertzContact, StickZone, peak_error};
use crate::run::report::ISOLATED;

kinds! {
    /// More than a tenth of a contact force is on zones of up to 3 nodes, or on single nodes: pressure and width are
    /// meaningless.
    CONTACT_UNRESOLVED("contact-unresolved", "Let 8 nodes be across.", "only forces matter");
    /// A contact zone is 4 to 7 nodes across.
    CONTACT_COARSE("contact-coarse", "Halve the elements there.", "only forces matter");
    /// The largest pressure is far above its neighbours, not at a corner.
    PEAK_SCATTER("peak-scatter", "Refine there; with tetrahedra use the mean.", "the peak does not matter");
    /// The largest pressure is at a corner, or where the contact reaches the end of its boundary; it grows with
    /// refinement.
    SINGULAR_EDGE("singular-edge", "Model the rounding of the edge.", "you use forces, and pressures elsewhere");
    /// Contact reaches the end of its boundary, and the elements beyond differ in length by more than three times.
    UNEVEN_ELEMENTS("uneven-elements", "Let elements grow gradually.", "only forces matter");
    /// Stick and slip in a contact of 8 to 39 nodes: the stick zone is known to one element. Not given for fewer than 8
    /// nodes, for 40 or more, or if the whole boundary is in contact.
    STICK_ZONE_COARSE("stick-zone-coarse", "Smaller elements.", "its width does not matter");
    /// Slip zones beside stick zones are fewer than 7 nodes wide (mean by friction work): work may be off by the share
    /// in the message. Not given if the whole contact is too narrow, or hardly any work is dissipated.
    SLIP_ZONE_COARSE("slip-zone-coarse", "Smaller elements in the slip zone; see [friction](../method/estimates.md#friction).",
        "slip and work do not matter");
}

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
    // Where facets change the gaps, warnings of the pressures would name the wrong cause.
    let faceted =
        |of: &str| checks.faceted_gaps.are_of(model, of) || checks.faceted_obstacle.is_of(model, of, &checks.so_far);
    let smooth = estimates.contact.iter().filter(|contact| !faceted(&contact.boundary));
    let contact = smooth.flat_map(|contact| {
        // For the reported peak, the estimate at its own time counts.
        let peak = estimates.peak.as_ref().filter(|peak| peak.boundary == contact.boundary).unwrap_or(contact);
        let zone = of_zone(contact, &units).or_else(|| of_zone(peak, &units));
        // For a narrow contact, the warning of its width is enough.
        let slip = if zone.is_none() { of_slip(contact) } else { None };
        [zone, of_peak(peak, &units, simplices), of_edge(contact), of_stick(contact), slip].into_iter().flatten()
    });
    contact.collect()
}

/// Names a surface and a time.
fn at(boundary: &str, time: f64) -> String {
    format!("`{boundary}` at t = {} s", six_digits(time))
}

fn percent(share: f64) -> String {
    if share > 0.0 && share < 0.005 { "less than 1 %".to_string() } else { format!("{:.0} %", 100.0 * share) }
}

/// Warns of too narrow contact zones.
fn of_zone(contact: &ContactEstimate, units: &UnitSystem) -> Option<Warning> {
    let length = |x: f64| units.rounded(Quantity::Length, x, 3);
    let at = at(&contact.boundary, contact.time);
    let isolated = ("nodes without a closed neighbour", contact.isolated_share);
    let narrow = ("zones of up to 3 nodes across", contact.unresolved_share);
    if let Some((place, share)) = [isolated, narrow].into_iter().find(|(_, share)| *share > ISOLATED) {
        let (share, size) = (percent(share), length(contact.element_size));
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
        return Some(WarningKind::CONTACT_UNRESOLVED.warning(format!(
            "{at}: {share} of the force is on {place}, so pressure and contact width are meaningless there{finer}"
        )));
    }
    let n = contact.nodes_across.filter(|&n| n < FINE)?;
    let [peak, width, halved] = [peak_error(n), 2.0 * peak_error(n), peak_error(2 * n - 1)].map(percent);
    Some(WarningKind::CONTACT_COARSE.warning(format!(
        "{at}: the contact zone is only {n} nodes wide: its peak pressure may be off by {peak}, its width by {width}; \
         halve the elements there for {halved}"
    )))
}

/// Warns if the largest pressure differs much from those around it.
fn of_peak(contact: &ContactEstimate, units: &UnitSystem, simplices: bool) -> Option<Warning> {
    let at = at(&contact.boundary, contact.time);
    if contact.singular_edge {
        return Some(WarningKind::SINGULAR_EDGE.warning(format!(
            "{at}: the pressure is singular at the edge ({} of the force on its nodes): its peak depends on the \
             mesh; use only forces, and pressures away from the edge",
            percent(contact.edge_share)
        )));
    }
    let n = contact.nodes_across;
    if n.is_some_and(|n| n <= 4) || contact.scatter <= SMOOTH.max(n.map_or(0.0, peak_error)) {
        return None;
    }
    let trust = if simplices { "use the mean" } else { "refine the mesh there" };
    let [peak, mean] = [contact.peak_pressure, contact.patch_pressure].map(|x| units.rounded(Quantity::Stress, x, 3));
    let scatter = percent(contact.scatter);
    Some(WarningKind::PEAK_SCATTER.warning(format!(
        "{at}: pressures of neighbouring nodes differ: the peak of {peak} is {scatter} above the mean over its \
         neighbours, {mean}; {trust}"
    )))
}

/// Warns of elements that differ at the end of the contact.
fn of_edge(contact: &ContactEstimate) -> Option<Warning> {
    let (at, ratio) = (at(&contact.boundary, contact.time), contact.edge_ratio.filter(|ratio| *ratio > UNEVEN)?);
    Some(WarningKind::UNEVEN_ELEMENTS.warning(format!(
        "{at}: the contact reaches the end of its boundary, where the elements outside are {ratio:.0} times longer or \
         shorter than those inside: pressures inside may be off by several percent; let elements grow gradually there"
    )))
}

/// Warns of a stick zone whose width is hardly known.
fn of_stick(contact: &ContactEstimate) -> Option<Warning> {
    let n = contact.nodes_across.filter(|n| (FINE..FINE_FOR_STICK).contains(n))?;
    let partial = |stick: &&StickZone| stick.ratio > 0.0 && stick.ratio < 1.0;
    let StickZone { boundary, time, ratio, .. } = contact.stick.as_ref().filter(partial)?;
    let at = at(boundary, *time);
    Some(WarningKind::STICK_ZONE_COARSE.warning(format!(
        "{at}: the stick zone, {ratio:.2} of the contact width, lies on {n} nodes across the contact: it may be off by \
         an element at each end"
    )))
}

/// Warns of slip zones that are too narrow for the friction work.
fn of_slip(contact: &ContactEstimate) -> Option<Warning> {
    let across = contact.slip_across.filter(|across| *across < FINE_FOR_SLIP)?;
    Some(WarningKind::SLIP_ZONE_COARSE.warning(format!(
        "`{}`: slip zones beside stick zones are only {across:.1} nodes wide (mean weighted by friction work): friction \
         work and slip may be off by about {:.0} %; make elements smaller where nodes slip, until 7 are across",
        contact.boundary,
        100.0 / across
    )))
}
