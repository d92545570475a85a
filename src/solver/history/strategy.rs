//! The strategy: what is tried for an increment, in which order.
//!
//! | attempt | start | at most |
//! | --- | --- | --- |
//! | Algorithm BN, with `method = "bn"` | the last solution and the tangent there, or the response with clamped contact nodes | 40 iterations; alone, as many as are allowed |
//! | the interior point method | the last solution, moved away from the border by the distance that fits the load | 30 iterations |
//! | the interior point method | ten times that distance | 30 iterations |
//! | the interior point method | a hundred times that distance | the iterations that are left |
//!
//! If a state shows that the body slides whatever is tried (`slip.rs`), nothing is. It is looked for before the first attempt
//! and after it. If an attempt of the interior point method comes near a solution, BN finishes it in at most ten iterations. If no
//! attempt solves a substep and the working set lacks nodes, the set grows. Otherwise the substep is halved, at most six
//! times (`increment.rs`). A method of the paper is not in this table: `algorithm.rs` creates it alone, and its increments
//! are not halved.
//!
//! | of 615 random scenes | converge |
//! | --- | --- |
//! | all attempts | 479 |
//! | BN alone | 474 |
//! | the interior point method from the first start | 472 |
//! | the interior point method from the first two starts | 477 |

use super::bn::BnMethod;
use super::increment_error::IncrementErrors;
use super::predictor_corrector::PredictorCorrectorMethod;
use super::saved::Snapshot;
use super::settings::HistorySettings;
use super::slip::sliding_state;
use super::task::{IncrementSolver, Observe, Task};
use crate::algebra::linear::{LinearError, RefinedSolver, SystemMatrix};
use crate::solver::newton::{MethodResult, Termination};
use crate::solver::problem::State;

/// An attempt at an increment.
#[derive(Clone, Copy)]
pub(super) struct Attempt {
    by: By,
    /// The number of iterations after which the attempt is abandoned, without those of BN at its end. No attempt that
    /// solves an increment of the tests takes as many.
    patience: usize,
}

#[derive(Clone, Copy)]
enum By {
    Newton,
    /// The interior point method, from a start this many times as far from the border as the load suggests.
    InteriorPoint(f64),
}

const NEWTON: Attempt = Attempt { by: By::Newton, patience: 40 };
const NEAR: Attempt = Attempt { by: By::InteriorPoint(1.0), patience: 30 };
const FAR: Attempt = Attempt { by: By::InteriorPoint(10.0), patience: 30 };
const FARTHEST: Attempt = Attempt { by: By::InteriorPoint(100.0), patience: usize::MAX };

/// Returns `true` if no other attempt is needed.
fn ends(result: &MethodResult) -> bool {
    matches!(result.stop, Termination::Converged | Termination::Interrupted | Termination::Slips(_))
}

/// The attempts of BN without the interior point method.
const BN_ALONE: &[Attempt] = &[Attempt { by: By::Newton, patience: usize::MAX }];

/// The attempts of `method = "bn"`. BN has to be the first: it prepares the time-step error of the increment.
const BN: &[Attempt] = &[NEWTON, NEAR, FAR, FARTHEST];

/// The attempts of `method = "ip"`.
const IP: &[Attempt] = &[NEAR, FAR, FARTHEST];

/// The attempts, with the methods that make them.
pub(super) struct Strategy {
    attempts: &'static [Attempt],
    settings: HistorySettings,
    methods: Methods,
}

enum Methods {
    /// BN, which has the state of the history, and the interior point method, created when it is first needed.
    Bn(Box<BnMethod>, Option<PredictorCorrectorMethod>),
    /// The interior point method alone.
    Ip(PredictorCorrectorMethod),
}

impl Strategy {
    /// Creates all attempts, or the first alone.
    pub(super) fn bn(bn: BnMethod, settings: &HistorySettings, alone: bool) -> Self {
        let attempts = if alone { BN_ALONE } else { BN };
        Strategy { attempts, settings: settings.clone(), methods: Methods::Bn(Box::new(bn), None) }
    }

    /// Creates the attempts of the interior point method.
    pub(super) fn ip(ip: PredictorCorrectorMethod, settings: &HistorySettings) -> Self {
        Strategy { attempts: IP, settings: settings.clone(), methods: Methods::Ip(ip) }
    }
}

impl Methods {
    /// Returns the method that has the state of the history.
    fn lead(&self) -> &dyn IncrementSolver {
        match self {
            Methods::Bn(bn, _) => &**bn,
            Methods::Ip(ip) => ip,
        }
    }

    fn lead_mut(&mut self) -> &mut dyn IncrementSolver {
        match self {
            Methods::Bn(bn, _) => &mut **bn,
            Methods::Ip(ip) => ip,
        }
    }

    /// Looks for a sliding state from the normal forces of a state. Returns the solves that it took, and moves to the
    /// sliding state if there is one.
    fn slide(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        last: &State,
        p_n: &[f64],
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        let newton = match self {
            Methods::Bn(bn, _) => bn.newton(),
            Methods::Ip(ip) => ip.end.newton(),
        };
        let (result, state) = sliding_state(task, newton, linear, last, p_n, observe)?;
        if let Some(state) = state {
            self.lead_mut().set_state(&state);
        }
        Ok(result)
    }
}

impl IncrementSolver for Strategy {
    fn matrix(&self) -> &SystemMatrix {
        self.methods.lead().matrix()
    }

    fn linearize(&mut self) {
        self.methods.lead_mut().linearize();
    }

    fn linearization(&self) -> &SystemMatrix {
        self.methods.lead().linearization()
    }

    fn clamp_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.methods.lead_mut().clamp_contacts()
    }

    fn starts_on_tangent(&self, linear: &RefinedSolver) -> bool {
        self.methods.lead().starts_on_tangent(linear)
    }

    /// Makes one attempt after the other, each from the last solution, until one solves the increment.
    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        let start = self.methods.lead_mut().unknowns().clone();
        let Strategy { attempts, settings, methods } = self;
        let last = match methods {
            Methods::Bn(bn, _) => bn.last_solution(task),
            Methods::Ip(ip) => ip.state(),
        };
        let mut tested = methods.slide(task, linear, &last, &last.p_n, observe)?;
        if ends(&tested) {
            return Ok(tested);
        }
        let mut result: Option<MethodResult> = None;
        for attempt in *attempts {
            let left = settings.max_iterations.saturating_sub(result.as_ref().map_or(0, |result| result.iterations));
            if left == 0 {
                break;
            }
            let tried = match (attempt.by, &mut *methods) {
                (By::Newton, Methods::Bn(bn, _)) => {
                    bn.limit(left.min(attempt.patience));
                    bn.solve(task, linear, observe)?
                }
                (By::InteriorPoint(distance), Methods::Bn(bn, ip)) => {
                    let ip = ip.get_or_insert_with(|| PredictorCorrectorMethod::beside(bn.assembled(), settings));
                    ip.set_state(&last);
                    ip.start_at(distance, attempt.patience, left);
                    let mut tried = ip.solve(task, linear, observe)?;
                    if tried.stop == Termination::Converged {
                        tried.rescued = true;
                        bn.set_state(&ip.state());
                        bn.follow(task.problem, linear)?;
                    } else if let (Some(result), true) = (&result, tried.stop != Termination::Interrupted) {
                        // The termination of BN is more informative.
                        tried.stop.clone_from(&result.stop);
                    }
                    tried
                }
                (By::InteriorPoint(distance), Methods::Ip(ip)) => {
                    ip.unknowns().copy_from_slice(&start);
                    ip.start_at(distance, attempt.patience, left);
                    ip.solve(task, linear, observe)?
                }
                (By::Newton, Methods::Ip(_)) => continue,
            };
            let reached = match result.take() {
                None => tried,
                Some(before) => before.then(tried),
            };
            if ends(&reached) {
                return Ok(tested.then(reached));
            }
            // The first attempt tells the pressures, if nothing was known of them.
            if result.is_none() {
                let again = methods.slide(task, linear, &last, &methods.lead().state().p_n, observe)?;
                if ends(&again) {
                    return Ok(tested.then(reached).then(again));
                }
                tested = tested.then(again);
            }
            result = Some(reached);
        }
        Ok(tested.then(result.unwrap_or_else(|| MethodResult::new(f64::NAN))))
    }

    fn state(&self) -> State {
        self.methods.lead().state()
    }

    fn set_state(&mut self, state: &State) {
        self.methods.lead_mut().set_state(state);
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        self.methods.lead_mut().unknowns()
    }

    fn increment_errors(&mut self) -> Option<&mut IncrementErrors> {
        self.methods.lead_mut().increment_errors()
    }

    fn snapshot(&self, linear: &RefinedSolver) -> Snapshot {
        let rescue = match &self.methods {
            Methods::Bn(_, Some(ip)) => Some(Box::new(ip.snapshot(linear))),
            _ => None,
        };
        Snapshot { rescue, ..self.methods.lead().snapshot(linear) }
    }

    fn restore(&mut self, mut snapshot: Snapshot, linear: &mut RefinedSolver) -> Result<bool, LinearError> {
        if let (Methods::Bn(bn, ip), Some(rescue)) = (&mut self.methods, snapshot.rescue.take()) {
            let ip = ip.insert(PredictorCorrectorMethod::beside(bn.assembled(), &self.settings));
            if !ip.restore(*rescue, linear)? {
                return Ok(false);
            }
        }
        self.methods.lead_mut().restore(snapshot, linear)
    }
}
