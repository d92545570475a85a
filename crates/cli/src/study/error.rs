//! The reasons why a study is impossible.

use stickslip::run::RunError;
use stickslip::solver::history::Status;

/// The reason why a study is impossible.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum StudyError {
    /// Numbers of elements were requested for a scene whose mesh comes from a file.
    #[error("the mesh of the scene comes from a file, so it has no numbers of elements to change")]
    #[diagnostic(help("name mesh files (--meshes coarse.msh,fine.msh), or remove --meshes"))]
    FixedMesh,
    /// Cell types were requested for a scene whose mesh file determines them.
    #[error("the cell types of the scene's mesh cannot be changed")]
    #[diagnostic(help(
        "other cell types need a scene with mesh.kind = \"block\"; strains alone (--elements bilinear,b-bar) work \
         with every mesh"
    ))]
    FixedCells,
    /// Mesh files were named for a scene that generates its mesh.
    #[error("the scene generates its mesh, so it takes no mesh file")]
    #[diagnostic(help("give numbers of elements (--meshes 20,40), or a scene with a mesh file"))]
    NoMeshFile,
    /// There is no mesh to compare on.
    #[error("the plan has no meshes")]
    #[diagnostic(help("name at least one"))]
    NoMesh,
    /// The mesh of the scene comes from a file, and no finer one is named.
    #[error("the mesh of the scene comes from a file, and no finer meshes are named")]
    #[diagnostic(help(
        "use triangles or tetrahedra, which refine themselves, or name mesh files from coarse to fine, relative to the scene file \
         (--meshes coarse.msh,fine.msh)"
    ))]
    NoFinerMesh,
    /// The meshes do not become finer.
    #[error("mesh {mesh} has {elements} elements and is no finer than the one before")]
    #[diagnostic(help(
        "name meshes from coarse to fine; an element of second order counts as four, in space as eight"
    ))]
    NotFiner {
        /// The mesh.
        mesh: String,
        /// Its number of elements.
        elements: usize,
    },
    /// Nothing with such a column acts at the place of the quantity.
    #[error("{0}")]
    Quantity(String),
    /// The scene has no such quantity.
    #[error("the scene has no {sought}")]
    #[diagnostic(help("{}", if known.is_empty() { "nothing touches: correct the scene".to_string() } else { format!("ask for {}", known.join(", ")) }))]
    NoValue {
        /// The quantity.
        sought: String,
        /// The quantities that the scene has.
        known: Vec<&'static str>,
    },
    /// A mesh refines itself no further.
    #[error("the mesh refines itself no further: {}", match .0 {
        Status::Converged => "finer meshes hardly reduce the error of the stresses, as beside a force at a point".to_string(),
        status => format!("the history on it ended as {status}"),
    })]
    NotRefined(Status),
    /// A mesh could not be built, or a run ended without a report.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
}
