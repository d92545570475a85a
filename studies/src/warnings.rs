//! Warnings beside the truth: random scenes, each compared with a run on a finer mesh and with more increments.
//!
//! Every scene has kinks in its loads. Half of the scenes have two bodies, and some have cells of second order. Three quantities are
//! judged: the peak pressure, the total tangential force over time, and the work of friction.

use std::collections::BTreeMap;

use stickslip::run::Run;
use stickslip::run::report::{ComponentSums, ForceRecord, RunReport, WarningKind};
use stickslip::scene::Scene;
use stickslip::solver::history::Status;

use crate::estimates::EstimateError;

/// An error of a quantity beyond this share asks for a warning.
pub const WRONG: f64 = 0.1;

/// A warning is false where every quantity that it speaks of is better than this share.
pub const RIGHT: f64 = 0.02;

/// The finer mesh has so many times the elements along each side, and the finer history so many times the increments.
const FINER: [usize; 2] = [2, 4];

/// Totals that are too small are not compared: a tangential force below this share of the normal force, and a work of friction below
/// this share of the largest tangential force over the whole tangential motion.
const SMALL: f64 = 0.01;

/// Splitmix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(u64);

impl Random {
    /// Returns the numbers of a `seed`.
    pub(crate) fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }

    fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.number() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub(crate) fn below(&mut self, n: u64) -> usize {
        (self.number() % n) as usize
    }
}

/// The contacts of the scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A block and a cylinder below it: a smooth pressure.
    Cylinder,
    /// A block whose lower side is pressed on a plane, which makes singular edges.
    Pad,
    /// Two blocks of equal width.
    Equal,
    /// A narrow block on a wide one, which makes singular edges.
    Narrow,
}

/// Time at the end of every scene, s.
const END: f64 = 2.0;

/// Times of two runs are the same where they differ by a smaller share of the end.
const TIME_ROUNDING: f64 = 1e-9;

const KINDS: [Kind; 4] = [Kind::Cylinder, Kind::Pad, Kind::Equal, Kind::Narrow];

/// A random scene of the plane.
#[derive(Debug, Clone)]
pub struct Case {
    /// The number that all choices come from.
    pub seed: u64,
    /// Its contact.
    pub kind: Kind,
    /// Its cells, by the word of scenes.
    pub cells: &'static str,
    elements: usize,
    increments: usize,
    friction: f64,
    poisson: f64,
    /// Time and factor of the tangential motion.
    history: Vec<[f64; 2]>,
    push: f64,
}

impl Case {
    /// The scene of a `seed`.
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let kind = KINDS[random.below(4)];
        let cells = ["quadrilateral", "triangle", "triangle6"][random.below(3)];
        let elements = 4 + random.below(21);
        let increments = 4 + random.below(17);
        let mut times: Vec<f64> = (0..=random.below(3)).map(|_| random.between(1.05, 1.95)).collect();
        times.sort_by(f64::total_cmp);
        let mut history = vec![[0.0, 0.0], [1.0, 0.0]];
        history.extend(times.into_iter().map(|time| [time, random.between(-1.0, 1.0)]));
        history.push([END, random.between(-1.0, 1.0)]);
        let friction = random.between(0.1, 0.8);
        Case {
            seed,
            kind,
            cells,
            elements,
            increments,
            friction,
            poisson: random.between(0.1, 0.45),
            history,
            push: 1e-3 * friction * random.between(0.3, 4.0),
        }
    }

    /// The text of the scene with so many times the elements and the increments.
    pub(crate) fn text(&self, [mesh, time]: [usize; 2]) -> String {
        let Case { cells, friction, poisson, history, push, .. } = self;
        let n = mesh * self.elements;
        let increments = time * self.increments;
        let material = format!("young = 1e9\npoisson = {poisson}");
        let block = |size: [f64; 2], elements: [usize; 2]| {
            format!("kind = \"block\"\nsize = {size:?}\nelements = {elements:?}\ncells = \"{cells}\"")
        };
        let time = format!("[time]\nend = {END:?}\nincrements = {increments}\n");
        let press = "[[0, 0], [1, 1], [2, 1]]";
        let body = |name: &str, at: [f64; 2], mesh: &str| {
            format!("[[body]]\nname = \"{name}\"\nat = {at:?}\n[body.mesh]\n{mesh}\n[body.material]\n{material}\n")
        };
        let two = |x: f64, width: f64, upper: [usize; 2]| {
            let lower = body("lower", [0.0, 0.0], &block([1.0, 0.5], [n, n / 2]));
            let upper = body("upper", [x, 0.5], &block([width, 0.5], upper));
            let held = "[[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n";
            let pressed = format!(
                "[[support]]\nboundary = \"upper:top\"\nfix = [\"y\"]\ndisplacement = -1e-3\nhistory = {press}\n"
            );
            let pushed = format!(
                "[[support]]\nboundary = \"upper:top\"\nfix = [\"x\"]\ndisplacement = {push}\nhistory = {history:?}\n"
            );
            let contact =
                format!("[[contact]]\nboundary = \"upper:bottom\"\nagainst = \"lower:top\"\nfriction = {friction}\n");
            [lower, upper, held.to_string(), pressed, pushed, contact, time.clone()].concat()
        };
        let one = |obstacle: &str, depth: f64| {
            let moved: Vec<[f64; 3]> =
                history.iter().map(|[t, factor]| [*t, depth / 1e-3 * push * factor, 0.0]).collect();
            format!(
                "[mesh]\n{}\n[material]\n{material}\n[[support]]\nboundary = \"top\"\nfix = [\"x\", \"y\"]\n[[contact]]\n\
                 boundary = \"bottom\"\nfriction = {friction}\n[contact.obstacle]\n{obstacle}\napproach = [[0, 0], [1, {depth}]]\n\
                 motion.translation = {moved:?}\n{time}",
                block([1.0, 0.5], [2 * n, n])
            )
        };
        match self.kind {
            Kind::Cylinder => one("kind = \"cylinder\"\nradius = 4.0\napex = [0.5, 0.0]", 1e-3),
            Kind::Pad => one("kind = \"plane\"", 1e-3),
            Kind::Equal => two(0.0, 1.0, [n + n / 3, n / 2 + 1]),
            Kind::Narrow => two(0.25, 0.5, [n.div_ceil(2) + 1, n / 2]),
        }
    }

    fn solved(&self, finer: [usize; 2]) -> Result<RunReport, EstimateError> {
        let name = format!("seed {}", self.seed);
        Ok(Run::new(&Scene::parse(&name, &self.text(finer), &[])?)?.solve(&mut ())?)
    }

    /// Solves the scene and the finer ones.
    ///
    /// # Errors
    /// When a scene cannot be read or solved. A verdict other than "converged" is no error: the case then has no errors to judge.
    pub fn judge(&self) -> Result<Judged, EstimateError> {
        let [mesh, time] = FINER;
        let [run, finer] = [[1, 1], [mesh, time]].map(|finer| self.solved(finer));
        let (run, finer) = (run?, finer?);
        let converged = [&run, &finer].iter().all(|report| report.status == Status::Converged);
        let mut kinds: Vec<WarningKind> = run.warnings.iter().map(|warning| warning.kind).collect();
        kinds.dedup();
        let errors = if converged { self.errors(&run, &finer) } else { [None; 3] };
        Ok(Judged { case: self.clone(), status: run.status.to_string(), errors, kinds })
    }

    /// Errors of the peak pressure, of the total tangential force and of the work of friction, where they can be compared.
    fn errors(&self, run: &RunReport, finer: &RunReport) -> [Option<f64>; 3] {
        let peak = |report: &RunReport| report.largest_pressure.as_ref()?.pressure;
        let peak = peak(run).zip(peak(finer)).map(|(run, finer)| (run - finer).abs() / finer);
        let largest = |of: fn(&ComponentSums) -> f64| {
            finer.forces.iter().map(|record| of(&record.resultant.sums).abs()).fold(0.0, f64::max)
        };
        let (normal, tangential) = (largest(|sums| sums.sum_p_n), largest(|sums| sums.sum_p_t));
        // Every increment of the run ends where one of the finer run does, up to rounding of the times.
        let apart = |record: &ForceRecord| {
            let near = |other: &&ForceRecord| (other.time - record.time).abs() < TIME_ROUNDING * END;
            let other = finer.forces.iter().find(near)?;
            Some((record.resultant.sums.sum_p_t - other.resultant.sums.sum_p_t).abs())
        };
        let apart = run.forces.iter().filter_map(apart).fold(0.0, f64::max);
        let force = (tangential > SMALL * normal).then_some(apart / tangential);
        let work = |report: &RunReport| report.increments.iter().map(|record| record.friction_work).sum::<f64>();
        let (of_run, of_finer) = (work(run), work(finer));
        let path: f64 = self.history.windows(2).map(|pair| self.push * (pair[1][1] - pair[0][1]).abs()).sum();
        let work = (of_finer > SMALL * tangential * path).then_some((of_run - of_finer).abs() / of_finer);
        [peak, force, work]
    }
}

/// A scene with the true errors of its quantities, and its warnings.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The scene.
    pub case: Case,
    /// Its verdict.
    pub status: String,
    /// Errors of the peak pressure, of the total tangential force and of the work of friction, as shares.
    pub errors: [Option<f64>; 3],
    /// The kinds of its warnings.
    pub kinds: Vec<WarningKind>,
}

impl Judged {
    /// The largest error of any quantity.
    pub fn worst(&self) -> Option<f64> {
        self.errors.iter().copied().flatten().reduce(f64::max)
    }

    /// Of each quantity, whether it is wrong and no warning speaks of it.
    pub fn silent(&self) -> [bool; 3] {
        [0, 1, 2].map(|quantity| {
            self.errors[quantity].is_some_and(|error| error > WRONG)
                && !self.kinds.iter().any(|kind| speaks_of(*kind)[quantity])
        })
    }

    /// Whether a warning is false: the quantities that it speaks of can be judged, and are all right.
    pub fn is_false(&self, kind: WarningKind) -> bool {
        let worst = self.worst_of(kind);
        worst.is_some_and(|worst| worst < RIGHT)
    }

    /// The largest error of what a warning speaks of.
    fn worst_of(&self, kind: WarningKind) -> Option<f64> {
        let speaks = speaks_of(kind);
        let of = (0..3).filter(|quantity| speaks[*quantity]);
        of.filter_map(|quantity| self.errors[quantity]).reduce(f64::max)
    }
}

/// Whether a kind of warning speaks of the peak pressure, of the tangential force, and of the work of friction.
pub fn speaks_of(kind: WarningKind) -> [bool; 3] {
    match kind {
        WarningKind::PEAK_SCATTER
        | WarningKind::SINGULAR_EDGE
        | WarningKind::UNEVEN_ELEMENTS
        | WarningKind::BEYOND_THE_END
        | WarningKind::ROUGH_STRESSES => [true, false, false],
        WarningKind::INCREMENTS_WORK | WarningKind::SLIP_ZONE_COARSE => [false, false, true],
        WarningKind::INCREMENTS_FORCE | WarningKind::JUMP | WarningKind::TANGENTIAL_COARSE => [false, true, true],
        // Of the width of that zone, which is none of them.
        WarningKind::STICK_ZONE_COARSE => [false; 3],
        _ => [true; 3],
    }
}

/// Of each kind of warning: how many scenes had it, in how many of them a quantity that it speaks of was wrong, and in how many all of
/// these were right.
pub fn by_kind(judged: &[Judged]) -> BTreeMap<&'static str, [usize; 3]> {
    let mut table = BTreeMap::new();
    for (case, kind) in judged.iter().flat_map(|case| case.kinds.iter().map(move |kind| (case, *kind))) {
        let Some(worst) = case.worst_of(kind) else { continue };
        let counts: &mut [usize; 3] = table.entry(kind.name).or_default();
        counts[0] += 1;
        counts[1] += usize::from(worst > WRONG);
        counts[2] += usize::from(case.is_false(kind));
    }
    table
}
