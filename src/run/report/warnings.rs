//! Warnings: reasons why a result may be inaccurate although every law holds, and why a run is slow.

use serde::Serialize;

/// A warning.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct Warning {
    /// The kind of the warning.
    pub kind: WarningKind,
    /// The warning in words, with the cure.
    pub message: String,
}

/// The kind of a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WarningKind {
    /// Locking of elements, because a material is nearly incompressible.
    Locking,
    /// A border between layers that cuts elements.
    LayersThroughElements,
    /// A load that acts only on constrained displacements.
    IdleLoad,
    /// A coefficient of friction larger than for real surfaces.
    LargeFriction,
    /// A hole in a triangulated surface in front of a boundary.
    SurfaceHole,
    /// A boundary that never touches its obstacle.
    NoContact,
    /// Displacements that are not small.
    LargeDisplacements,
    /// Strains that are not small.
    LargeStrains,
    /// An obstacle whose surface is inclined against the contact normal.
    LeaningObstacle,
    /// A contact that leaves the range of its linearised gaps.
    GapsOutOfRange,
    /// Contact forces on nodes beyond the end of the other body.
    BeyondTheEnd,
    /// Bodies that penetrate each other where no contact is defined.
    PassedThrough,
    /// Facets that falsify measured gaps if they are of a curved surface.
    FacetedGaps,
    /// Neglected friction of constrained nodes while something slides past them.
    FrictionLeftOut,
    /// Bodies that slide across each other's facets.
    SlidAcrossFacets,
    /// A rigid body that moves along its contact while contact alone holds it against rotation.
    LargeMotion,
    /// A contact node inside an obstacle that it does not meet.
    ObstacleNotMet,
    /// An obstacle with details finer than the elements.
    ObstacleBetweenNodes,
    /// A non-unique equilibrium: contact leaves a motion of the body unconstrained.
    NotUnique,
    /// A mesh that is too coarse for the body itself.
    CoarseMesh,
    /// Stresses of a nearly incompressible body that are much less accurate than its displacements.
    RoughStresses,
    /// A contact zone of a few nodes, or of isolated ones.
    ContactUnresolved,
    /// A contact zone that is fewer than eight nodes across.
    ContactCoarse,
    /// A peak pressure that is far above that of the neighbours.
    PeakScatter,
    /// A pressure that is singular at the edge of the contact.
    SingularEdge,
    /// Elements that differ much in size at the end of the contact.
    UnevenElements,
    /// A stick zone whose size is known to one element.
    StickZoneCoarse,
    /// A mesh that is too coarse for tangential forces much smaller than the normal ones.
    TangentialCoarse,
    /// Narrow slip zones of a few nodes beside stick zones.
    SlipZoneCoarse,
    /// Increments too long for the friction work.
    IncrementsWork,
    /// Increments too long for the tangential forces, or too few for an estimate.
    IncrementsForce,
    /// Gaps curved in time, which the exact path follows along chords.
    CurvedGaps,
    /// A quasi-static motion that ended and was continued by a jump.
    Jump,
    /// Forces so small compared with stiffness times displacements that rounding matters.
    Unbalanced,
    /// A requested additional result that could not be computed. The history itself is complete.
    NotComputed,
    /// A BLAS several times slower than possible on the processor. Costs time and no accuracy.
    SlowBlas,
    /// Multigrid that stagnated, so that a direct solver took over. Costs time and no accuracy.
    MultigridGaveWay,
    /// A process with another body than rank 0, so that the stiffness is not distributed. Costs memory and no accuracy.
    RanksApart,
}

impl WarningKind {
    /// Returns `true` if the warning is known only after the solution. Locking is also predicted before it.
    pub fn needs_the_solution(self) -> bool {
        !matches!(
            self,
            WarningKind::LayersThroughElements
                | WarningKind::IdleLoad
                | WarningKind::LargeFriction
                | WarningKind::SurfaceHole
                | WarningKind::SlowBlas
        )
    }

    /// Returns `true` if the warning is never to be ignored: results may be those of another problem.
    pub fn is_grave(self) -> bool {
        matches!(
            self,
            WarningKind::BeyondTheEnd
                | WarningKind::CurvedGaps
                | WarningKind::FrictionLeftOut
                | WarningKind::GapsOutOfRange
                | WarningKind::Jump
                | WarningKind::LargeDisplacements
                | WarningKind::LeaningObstacle
                | WarningKind::ObstacleBetweenNodes
                | WarningKind::ObstacleNotMet
                | WarningKind::PassedThrough
        )
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    /// The page of warnings has a row for each kind, and none for another.
    #[test]
    fn every_kind_has_its_row() {
        let (_, list) = include_str!("warnings.rs").split_once("pub enum WarningKind {").unwrap();
        let kinds = list.lines().take_while(|line| *line != "}").filter_map(|line| line.trim().strip_suffix(','));
        let kinds: BTreeSet<String> = kinds.map(in_words).collect();
        let page = include_str!("../../../doc/reference/warnings.md");
        let (table, _) = page.split_once("\n## Warnings\n").unwrap().1.split_once("\n## ").unwrap();
        let rows: BTreeSet<String> =
            table.lines().filter_map(|line| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_string())).collect();
        assert_eq!(rows, kinds);
    }

    /// The kinds that the page says are never to be ignored are those that studies never ignore.
    #[test]
    fn grave_kinds_are_never_to_be_ignored() {
        let (_, list) = include_str!("warnings.rs").split_once("pub fn is_grave").unwrap();
        let (list, _) = list.split_once("\n    }\n").unwrap();
        let grave: BTreeSet<String> =
            list.split("WarningKind::").skip(1).map(|name| in_words(first_word(name))).collect();
        let page = include_str!("../../../doc/reference/warnings.md");
        let never = page.lines().filter(|line| line.trim_end_matches([' ', '|']).ends_with("| never"));
        let never: BTreeSet<String> = never.filter_map(|line| Some(line.split('`').nth(1)?.to_string())).collect();
        assert_eq!(grave, never);
    }

    fn first_word(text: &str) -> &str {
        text.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default()
    }

    /// Returns the name as serde writes it.
    fn in_words(name: &str) -> String {
        let words = name.chars().enumerate().flat_map(|(k, c)| {
            let dash = (c.is_uppercase() && k > 0).then_some('-');
            dash.into_iter().chain(c.to_lowercase())
        });
        words.collect()
    }
}
