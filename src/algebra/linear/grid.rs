//! The geometric data of a system besides its matrix: the positions of the unknowns.

/// The positions of a body's displacements, and the unknowns that are contact forces.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// `true` for the matrices of an interior point method, during which contact is a stiff spring.
    pub interior: bool,
    /// The dimension, 2 or 3.
    pub dimension: usize,
    /// The number of nodes.
    pub nodes: usize,
    /// The node and the direction of each displacement; the displacements are the first unknowns.
    pub displacements: Vec<(usize, usize)>,
    /// The contact nodes: the places of their tangential and normal forces among the unknowns, and their nodes.
    pub contacts: Vec<GridContact>,
    /// Displacements that contain shares of others, `u_e = ũ_e + Σ c ũ_a`, so that the contact rows of a node have
    /// only its own `ũ`.
    pub changed: Vec<(usize, Vec<(usize, f64)>)>,
    /// The displacements of the rigid modes of the whole grid, without supports: 3 in the plane, 6 in space.
    pub motions: Vec<Vec<f64>>,
}

/// One contact node of a [`Grid`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GridContact {
    /// The node whose displacements its rows contain.
    pub node: usize,
    /// The places of its forces.
    pub forces: [Option<usize>; 3],
}
