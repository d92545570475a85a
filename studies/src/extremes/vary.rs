//! What is different from element to element or node to node in a scene of the suite, and how well
//! conditioned it is.

use super::ExtremeError;
use serde::Deserialize;
use stickslip::algebra::linear::{LinearError, RefinedSolver};
use stickslip::body::constraints::assemble;
use stickslip::body::fem::{Elasticity, Element};
use stickslip::body::{Model, ModelError};
use stickslip::scene::Scene;
use stickslip::solver::formulation::{Bdiff, FormulationScaling};
use stickslip::solver::{ContactProblem, Loading, Parts};

/// What is varied at random.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Vary {
    /// The modulus of each element, over so many decades.
    Stiffness,
    /// The friction coefficient of each node, between 0 and so much.
    Friction,
    /// The gap of each node, by up to half of so much (m) in either direction.
    Gap,
}

impl Vary {
    pub(super) fn apply(self, scene: &Scene, model: &mut Model, by: f64, seed: u64) -> Result<(), ExtremeError> {
        let mut random = Random(seed);
        let parts = model.problem.clone().into_parts();
        match self {
            Vary::Stiffness => {
                let young: Vec<f64> = (model.mesh.cells.iter())
                    .map(|_| scene.description.material.young * 10_f64.powf(by * (random.next() - 0.5)))
                    .collect();
                let poisson = scene.description.material.poisson;
                let material = |element: usize| Elasticity::isotropic(young[element], poisson);
                let stiffness = assemble(&model.mesh, &model.constraints.dofs, Element::Bilinear, material)
                    .map_err(ModelError::from)?;
                model.problem =
                    ContactProblem::new(Parts { stiffness: stiffness.into(), ..parts }).map_err(ModelError::from)?;
            }
            Vary::Friction => {
                let mu = parts.mu.iter().map(|_| by * random.next()).collect();
                model.problem = ContactProblem::new(Parts { mu, ..parts }).map_err(ModelError::from)?;
            }
            Vary::Gap => {
                let gap = model.loading.gap().iter().map(|_| by * (random.next() - 0.5)).collect();
                let loading = Loading::new(model.loading.cases().to_vec(), gap);
                model.loading = loading.map_err(ModelError::from)?;
            }
        }
        Ok(())
    }
}

/// Splitmix64 (Steele, Lea and Flood 2014), in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Steps of the power iterations: their estimates are from below, and within a factor of two or so.
const STEPS: usize = 12;

/// An estimate of the condition number of the stiffness of the body with its contact nodes held, by
/// power iteration on `K` and on its inverse; infinite if it is singular even then.
pub(super) fn condition(model: &Model) -> Result<f64, LinearError> {
    let problem = &model.problem;
    let mut formulation = Bdiff::new(problem, model.scaling(), &FormulationScaling::natural(problem));
    formulation.clamp_contacts();
    let mut linear = RefinedSolver::default();
    linear.analyze(formulation.jacobian())?;
    match linear.factorize(formulation.jacobian()) {
        Ok(_) => {}
        Err(LinearError::Singular { .. }) => return Ok(f64::INFINITY),
        Err(error) => return Err(error),
    }
    let (n_u, n) = (problem.displacements(), formulation.unknowns());
    let mut random = Random(n as u64);
    let start: Vec<f64> = (0..n_u).map(|_| random.next() - 0.5).collect();
    let normalise = |x: &mut [f64]| {
        let norm = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        for x in x.iter_mut() {
            *x /= norm;
        }
        norm
    };
    let stiffness = problem.stiffness().assembled()?;
    let (mut x, mut largest) = (start.clone(), 0.0);
    for _ in 0..STEPS {
        normalise(&mut x);
        x = stiffness.times(&x).unwrap_or_default();
        largest = x.iter().map(|x| x * x).sum::<f64>().sqrt() / model.scaling().stiffness();
    }
    let (mut b, mut z, mut inverse) = (vec![0.0; n], vec![0.0; n], 0.0);
    b[..n_u].copy_from_slice(&start);
    for _ in 0..STEPS {
        normalise(&mut b[..n_u]);
        match linear.solve(formulation.jacobian(), &b, &mut z) {
            Ok(_) => {}
            Err(LinearError::NotFinite) => return Ok(f64::INFINITY),
            Err(error) => return Err(error),
        }
        inverse = z[..n_u].iter().map(|z| z * z).sum::<f64>().sqrt();
        b[..n_u].copy_from_slice(&z[..n_u]);
    }
    Ok(largest * inverse)
}
