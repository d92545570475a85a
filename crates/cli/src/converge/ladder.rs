//! The meshes and numbers of increments of a study, from coarse to fine.

use stickslip::body::ModelError;
use stickslip::body::mesh::{HalfPlane, MeshSource};
use stickslip::run::{Refinement, RunError};
use stickslip::scene::{Override, Scene};

use crate::study::{MeshChoice, MeshSize, StudyError, each, first_elements, multiplied};

/// Coarser meshes than the scene's have at least this number of elements along each axis and segment, unless all
/// numbers stay whole.
const LEAST_ELEMENTS: f64 = 8.0;

/// The largest number of meshes coarser than the scene's, and the number of those that count as coarse if meshes refine
/// themselves.
const COARSER: i32 = 2;

/// Halving leaves no fewer increments.
const LEAST_INCREMENTS: usize = 4;

/// The meshes and increments of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Meshes named by the user; if there are none, the elements of the scene times powers of `ratio`, from `first` on.
    named: Vec<MeshSize>,
    /// `true` if none are named and the first mesh can refine itself; finer ones follow from it then.
    pub(super) refines_itself: bool,
    ratio: f64,
    /// The factor by which the error of a mesh that refines itself falls to that of the next: `ratio`, or in space its
    /// cube root, because a larger one takes many times the elements.
    pub(super) gain: f64,
    first: i32,
    /// The number of increments of the first run.
    first_increments: usize,
}

impl Ladder {
    /// Returns the meshes `named`; without names, those with all numbers of elements times powers of `ratio`, which begin
    /// up to two steps below the mesh of `scene`, or those to which the first of these refines itself, if it can.
    /// Increments begin with half of those of the scene, if that is a whole number and not too few.
    ///
    /// # Errors
    /// When the scene has no meshes of this kind, and when its mesh cannot be built.
    pub fn new(scene: &Scene, named: &[MeshSize], ratio: f64) -> Result<Self, StudyError> {
        let mesh = &scene.description.mesh;
        let choices: Vec<MeshChoice> = named.iter().cloned().map(MeshChoice::from).collect();
        let built = || mesh.build().map_err(|error| RunError::from(ModelError::from(error)));
        let refined = choices.is_empty().then(built).transpose()?.filter(|mesh| Refinement::is_possible(mesh));
        let refines_itself = refined.is_some();
        let gain = if refined.is_some_and(|mesh| mesh.dimension == 3) { ratio.cbrt() } else { ratio };
        let named = match choices.is_empty() {
            true if first_elements(mesh).is_none() && !refines_itself => return Err(StudyError::NoFinerMesh),
            true => Vec::new(),
            false => each(mesh, &choices)?.into_iter().map(|choice| choice.size).collect(),
        };
        // Refinement begins where the contact is seen.
        let least = if refines_itself { LEAST_ELEMENTS } else { 1.0 };
        let halves = (1..=COARSER).take_while(|&step| is_halved(mesh, ratio.powi(-step), least)).count() as i32;
        let own = scene.time.increments;
        let first_increments = if own.is_multiple_of(2) && own >= 2 * LEAST_INCREMENTS { own / 2 } else { own };
        Ok(Ladder { named, refines_itself, ratio, gain, first: -halves, first_increments })
    }

    /// Returns the number of meshes; `None` for any number.
    pub fn meshes(&self) -> Option<usize> {
        Some(self.named.len()).filter(|&number| number > 0)
    }

    /// Returns the number of increments of `level`.
    pub fn increments(&self, level: usize) -> usize {
        self.first_increments << level
    }

    /// Returns the override that gives a scene the increments of `level`.
    pub(super) fn time(&self, level: usize) -> Override {
        Override::value("time.increments", self.increments(level) as i64)
    }

    fn size(&self, level: usize) -> MeshSize {
        let steps = if self.refines_itself { 0 } else { level as i32 };
        match (self.named.get(level), self.first + steps) {
            (Some(named), _) => named.clone(),
            (None, 0) => MeshSize::Own,
            (None, power) => MeshSize::Times(self.ratio.powi(power)),
        }
    }

    /// Returns `true` if mesh `level` is the scene's own.
    pub fn is_own(&self, level: usize, mesh: &MeshSource) -> bool {
        match self.size(level) {
            MeshSize::Own => self.first + level as i32 == 0,
            MeshSize::Times(_) => false,
            MeshSize::Elements(n) => first_elements(mesh) == Some(n),
            MeshSize::File(file) => matches!(mesh, MeshSource::File { file: own, .. } if own.ends_with(file)),
        }
    }

    /// Returns `true` if mesh `level` is coarser than the scene's, is one of the first that refine themselves, or one
    /// of the named that has a finer one.
    pub fn is_coarse(&self, level: usize) -> bool {
        let first = if self.refines_itself { -COARSER } else { self.first };
        self.meshes().map_or(first + (level as i32) < 0, |number| level + 1 < number)
    }

    /// Returns the overrides that give `scene` the mesh `level`.
    pub fn mesh(&self, scene: &Scene, level: usize) -> Vec<Override> {
        MeshChoice::from(self.size(level)).overrides(&scene.description.mesh)
    }

    /// Returns the factor by which the next mesh after `level` has more elements along an axis; `None` if there is
    /// none, or its size is not known before it is read.
    pub fn growth(&self, level: usize) -> Option<f64> {
        match (self.named.get(level), self.named.get(level + 1)) {
            _ if self.named.is_empty() => Some(self.gain),
            (Some(MeshSize::Elements(n)), Some(MeshSize::Elements(next))) => Some(*next as f64 / *n as f64),
            _ => None,
        }
    }
}

/// Returns all numbers of elements of a mesh that is generated.
fn counts(mesh: &MeshSource) -> Vec<usize> {
    match mesh {
        MeshSource::Block { axes, .. } => axes.concat().iter().map(|segment| segment.elements).collect(),
        MeshSource::HalfPlane(HalfPlane { contact_elements, outer_elements, layers, .. }) => {
            vec![*contact_elements, *outer_elements, *layers]
        }
        MeshSource::File { .. } | MeshSource::Given(_) => Vec::new(),
        MeshSource::Bodies(bodies) => bodies.iter().flat_map(|body| counts(&body.mesh)).collect(),
    }
}

/// Returns `true` if the mesh with all numbers times `share`, of which none is below `least`, is similar: rounding hardly
/// changes the proportions.
fn is_halved(mesh: &MeshSource, share: f64, least: f64) -> bool {
    let counts = counts(mesh);
    let is_similar = |count: &usize| {
        let exact = share * *count as f64;
        exact >= LEAST_ELEMENTS || (exact >= least && (exact - exact.round()).abs() < 1e-9)
    };
    !counts.is_empty() && counts.iter().all(is_similar)
}

/// Names a mesh by its numbers of elements, as in the scene: `[80, 40]`.
pub(super) fn name(mesh: &MeshSource) -> String {
    match mesh {
        MeshSource::Block { .. } => {
            let [elements] = &multiplied(mesh, 1.0)[..] else { return String::new() };
            elements.to_string().trim_start_matches("mesh.elements=").to_string()
        }
        MeshSource::HalfPlane(HalfPlane { contact_elements, outer_elements, layers, .. }) => {
            format!("{contact_elements} + {outer_elements}, {layers} layers")
        }
        MeshSource::File { file, .. } => file.display().to_string(),
        MeshSource::Given(_) => "the mesh in memory".to_string(),
        MeshSource::Bodies(bodies) => bodies.iter().map(|body| name(&body.mesh)).collect::<Vec<_>>().join(" "),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn block(elements: &str, increments: usize) -> Scene {
        let overrides = [format!("mesh.elements={elements}"), format!("time.increments={increments}")];
        let overrides = overrides.map(|text| text.parse().unwrap());
        Scene::parse("block.toml", include_str!("../../../../data/scenes/block.toml"), &overrides).unwrap()
    }

    fn meshes(scene: &Scene, ratio: f64) -> [String; 4] {
        let ladder = Ladder::new(scene, &[], ratio).unwrap();
        [0, 1, 2, 3].map(|level| {
            let scene = scene.with(&ladder.mesh(scene, level)).unwrap();
            name(&scene.description.mesh)
        })
    }

    #[test]
    fn meshes_begin_below_that_of_the_scene() {
        assert_eq!(meshes(&block("[20,8]", 4), 2.0), ["[5, 2]", "[10, 4]", "[20, 8]", "[40, 16]"]);
        // An odd number of few elements has no half.
        assert_eq!(meshes(&block("[20,5]", 4), 2.0), ["[20, 5]", "[40, 10]", "[80, 20]", "[160, 40]"]);
        assert_eq!(meshes(&block("[30,30]", 4), 1.5), ["[13, 13]", "[20, 20]", "[30, 30]", "[45, 45]"]);
        let ladder = Ladder::new(&block("[20,8]", 4), &[], 2.0).unwrap();
        let mesh = &block("[20,8]", 4).description.mesh;
        assert_eq!([1, 2, 3].map(|level| ladder.is_own(level, mesh)), [false, true, false]);
    }

    #[test]
    fn increments_begin_with_half_of_many() {
        for (own, first) in [(20, 10), (8, 4), (6, 6), (7, 7), (1, 1)] {
            let ladder = Ladder::new(&block("[8,8]", own), &[], 2.0).unwrap();
            assert_eq!([0, 2].map(|level| ladder.increments(level)), [first, 4 * first]);
        }
    }

    #[test]
    fn named_meshes_are_taken_in_order() {
        let scene = block("[20,8]", 4);
        let named = [MeshSize::Elements(10), MeshSize::Elements(20)];
        let ladder = Ladder::new(&scene, &named, 2.0).unwrap();
        assert_eq!((ladder.meshes(), ladder.growth(0), ladder.growth(1)), (Some(2), Some(2.0), None));
        assert!(Ladder::new(&scene, &[MeshSize::File("a.msh".into())], 2.0).is_err());
    }
}
