//! The capacity of a joint: the factor by which a load may grow beyond its last value until the joint slips as a whole.
//!
//! The history goes on after its end, with all other loads and motions as they are there, while the load doubles again
//! and again. The run ends where friction can no longer balance the loads, between two times; it is repeated with more
//! increments between them until they are close. The exact path finds the time itself. If the joint slips before the end
//! of the history, other loads may be smaller there than at the end: the load then grows from 0 after the history.

use serde_json::{Value, json};

use stickslip::base::within;
use stickslip::body::{Action, Against, Load};
use stickslip::run::report::{ForceRecord, JointSlip, RunReport};
use stickslip::run::{Run, RunError};
use stickslip::scene::Scene;
use stickslip::solver::history::{Observer, Status};

use crate::words::acts;

/// The number of times that the load doubles, and the increments of each time.
const DOUBLINGS: u32 = 10;
const INCREMENTS: u32 = 8;

/// The largest difference of the factors between which the joint slips, relative, the number of increments between them
/// in another run, and the number of runs.
const CLOSE: f64 = 2e-3;
const FINER: u32 = 32;
const RUNS: usize = 3;

/// The capacity of a joint for a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Capacity {
    /// The number of the load, from 0.
    pub load: usize,
    /// The load at factor 1.
    pub action: Action,
    /// Its last factor in the history.
    pub last: f64,
    /// The factors of the load, relative to its last value, at which equilibrium was found and at which the joint
    /// slips, or has no equilibrium; `None` if it holds all factors, or is not known.
    pub between: Option<[f64; 2]>,
    /// The first contact that carries force at the end of the history itself and none later, with the factors of the
    /// load between which it opens.
    pub opens: Option<(String, [f64; 2])>,
    /// The contacts that slip wholly before the joint does, with the factors of the load between which they begin to.
    pub slips_before: Vec<(String, [f64; 2])>,
    /// `true` if the joint slips within the history itself, so that the load grows after all others.
    pub comes_last: bool,
    /// The report of the run.
    pub report: RunReport,
}

/// Returns the load of this number, or the only one at a place of this name.
///
/// # Errors
/// In words, without such a load or with several.
pub fn load(scene: &Scene, name: &str) -> Result<usize, String> {
    if let Ok(number) = name.parse() {
        return Ok(number);
    }
    let place = |load: &Load| load.action.location(&scene.description.system(3));
    let loads: Vec<String> = scene.description.loads.iter().map(place).collect();
    match loads.iter().enumerate().filter(|(_, place)| *place == name).collect::<Vec<_>>()[..] {
        [(k, _)] => Ok(k),
        [] => Err(format!("there is no load at `{name}`: the scene has loads at {}", loads.join(", "))),
        _ => Err(format!("there are several loads at `{name}`: give the number of one, from 0")),
    }
}

/// Finds the capacity of `scene` for this `load`, by its number from 0. `observer` sees the run, and may stop it.
///
/// # Errors
/// Without such a load, and if its last value is 0, in words; if the run cannot be prepared or go on.
pub fn compute(scene: &Scene, load: usize, observer: &mut dyn Observer) -> Result<Result<Capacity, String>, RunError> {
    let mut longer = scene.clone();
    let last = match extend(&mut longer, load) {
        Ok(last) => last,
        Err(message) => return Ok(Err(message)),
    };
    let of_load = |slip: &JointSlip| slip.factors.iter().find(|changing| changing.load == load).map(|of| of.between);
    let factor_at = |longer: &Scene, time: f64| {
        let history = longer.description.loads[load].factors(longer.description.end());
        within(time, &history).last().map_or(0.0, |[_, factor]| factor / last)
    };
    let opens = |longer: &Scene, report: &RunReport| {
        let sum = |record: &ForceRecord| record.resultant.sums.sum_p_n;
        let has_opened = |record: &&ForceRecord| record.time > scene.time.end && sum(record) == 0.0;
        report.forces.iter().filter(has_opened).find_map(|first| {
            let is_before = |earlier: &&ForceRecord| {
                earlier.time < first.time && earlier.resultant.boundary == first.resultant.boundary
            };
            let before = report.forces.iter().rfind(is_before).filter(|before| sum(before) > 0.0)?;
            Some((first.resultant.boundary.clone(), [before.time, first.time].map(|time| factor_at(longer, time))))
        })
    };
    let slips_before = |between: Option<[f64; 2]>, longer: &Scene, report: &RunReport| {
        let most = between.map_or(f64::INFINITY, |[holds, _]| (1.0 - CLOSE) * holds);
        let of_contacts = report.friction_use.iter().filter_map(|contact| {
            let by = contact.slips_wholly_from.filter(|_| contact.factors.iter().any(|of| of.load == load))?;
            let sticks = report.increments.iter().rfind(|record| record.time < by).map_or(0.0, |record| record.time);
            let factors @ [_, slips] = [sticks, by].map(|time| factor_at(longer, time));
            (0.0 < slips && slips < most).then(|| (contact.boundary.clone(), factors))
        });
        of_contacts.collect()
    };
    let found = |between, longer: &Scene, comes_last: bool, report: RunReport| {
        let action = scene.description.loads[load].action.clone();
        let (opens, slips_before) = (opens(longer, &report), slips_before(between, longer, &report));
        Capacity { load, action, last, between, opens, slips_before, comes_last, report }
    };
    let is_exact = scene.solver.method.is_exact_path();
    let (mut known, mut runs, mut comes_last): (Option<Capacity>, usize, bool) = (None, 0, false);
    loop {
        runs += 1;
        let report = Run::new(&longer)?.solve(observer)?;
        let reached = report.increments.iter().rfind(|record| record.status == Status::Converged);
        let reached = reached.map_or(0.0, |record| record.time);
        // Times and factors between which the joint gives way.
        let interval = match (&report.explanation.slip, report.increments.last()) {
            (Some(slip), _) => of_load(slip).map(|[holds, slips]| {
                (slip.between, [holds, if is_exact { holds } else { slips }].map(|factor| factor / last))
            }),
            (None, Some(failed)) if report.status == Status::NoEquilibrium => {
                let times = [reached, failed.time];
                Some((times, times.map(|time| factor_at(&longer, time))))
            }
            _ => None,
        };
        if !comes_last && interval.is_some_and(|([_, by], _)| by <= scene.time.end) {
            (comes_last, runs) = (true, 0);
            put_last(&mut longer, load, scene.time.end);
            continue;
        }
        if let Some(([from, by], between @ [holds, gives_way])) = interval {
            longer.time.kinks.extend((0..=FINER).map(|k| from + f64::from(k) / f64::from(FINER) * (by - from)));
            longer.description.times = longer.time.all();
            let capacity = found(Some(between), &longer, comes_last, report);
            if runs == RUNS || gives_way - holds <= CLOSE * gives_way {
                return Ok(Ok(capacity));
            }
            known = Some(capacity);
        } else {
            let mut capacity = known.unwrap_or_else(|| found(None, &longer, comes_last, report));
            if let Some([holds, gives_way]) = &mut capacity.between {
                // Close to the capacity a run may fail before it slips: it holds the load that it has reached.
                *holds = factor_at(&longer, reached).max(*holds).min(*gives_way);
            }
            return Ok(Ok(capacity));
        }
    }
}

/// Lets the history go on while the load doubles. Returns its factor at the end so far.
fn extend(scene: &mut Scene, load: usize) -> Result<f64, String> {
    let (end, step) = (scene.time.end, scene.time.end / scene.time.increments as f64);
    let description = &mut scene.description;
    let number = description.loads.len();
    let history = description.loads.get(load).map(|load| within(end, &load.factors(end)));
    let mut points = history.ok_or(format!("there is no load[{load}]: the scene has {number} loads, from 0"))?;
    let last = points.last().map_or(0.0, |[_, last]| *last);
    points.retain(|[time, _]| *time < end);
    if last == 0.0 {
        return Err(format!("load[{load}] is 0 at the end of the history, and no factor makes it larger"));
    }
    // What grows until the end by default, or goes on after it, stays as it is at the end.
    description.loads.iter_mut().for_each(|load| load.history = Some(within(end, &load.factors(end))));
    description.supports.iter_mut().for_each(|support| support.history = Some(within(end, &support.factors(end))));
    for contact in &mut description.contacts {
        let stay =
            |points: &mut Option<Vec<[f64; 2]>>| points.iter_mut().for_each(|points| *points = within(end, points));
        stay(&mut contact.friction_history);
        let Against::Obstacles(obstacles) = &mut contact.against else { continue };
        for obstacle in obstacles {
            stay(&mut obstacle.approach);
            obstacle.rotation.iter_mut().for_each(|rotation| rotation.history = within(end, &rotation.history));
            if let Some(points) = &mut obstacle.translation {
                let is_plane = points.iter().all(|(_, at)| at.dimension() == 2);
                let all = points.iter().map(|(t, at)| (*t, at.components())).map(|(t, [x, y, z])| [t, x, y, z]);
                let vector = |[x, y, z]: [f64; 3]| if is_plane { [x, y].into() } else { [x, y, z].into() };
                *points = within(end, &all.collect::<Vec<_>>())
                    .into_iter()
                    .map(|[t, x, y, z]| (t, vector([x, y, z])))
                    .collect();
            }
        }
    }
    description.pretensions.iter_mut().for_each(|given| given.history = Some(within(end, &given.factors(end))));
    points.extend((0..=DOUBLINGS).map(|k| [end + f64::from(k * INCREMENTS) * step, last * f64::from(1 << k)]));
    description.loads[load].history = Some(points);
    scene.time.end = end + f64::from(DOUBLINGS * INCREMENTS) * step;
    scene.time.increments += (DOUBLINGS * INCREMENTS) as usize;
    description.times = scene.time.all();
    Ok(last)
}

/// Lets a load that grows further after `end` grow from 0 there, over the time in which it doubles.
fn put_last(scene: &mut Scene, load: usize, end: f64) {
    let later = (scene.time.end - end) / f64::from(DOUBLINGS);
    let kept = scene.description.loads[load].history.iter().flatten().filter(|[time, _]| *time >= end);
    let points = [[0.0; 2], [end, 0.0]].into_iter().chain(kept.map(|[time, factor]| [time + later, *factor]));
    scene.description.loads[load].history = Some(points.collect());
    scene.time.end += later;
    scene.time.increments += INCREMENTS as usize;
    scene.description.times = scene.time.all();
}

impl Capacity {
    /// Returns `true` if the joint holds the load as it is at the end.
    pub fn holds(&self) -> bool {
        self.between.map_or(self.report.status == Status::Converged, |[holds, _]| holds >= 1.0)
    }

    /// Returns the factor that the joint holds, in words.
    pub fn safety(&self) -> String {
        match self.between {
            Some([holds, _]) => format!("{holds:.4}"),
            None if self.report.status == Status::Converged => format!("above {}", 1 << DOUBLINGS),
            None => "unknown".to_string(),
        }
    }

    /// Describes the load that the joint holds.
    pub fn held(&self) -> Option<String> {
        self.between.map(|[holds, _]| acts(&self.action, holds * self.last, &self.report.units))
    }

    /// Returns the capacity in a sentence, with the motion.
    pub fn sentence(&self) -> String {
        let (load, most, held) = (self.load, 1 << DOUBLINGS, self.held().unwrap_or_default());
        let last =
            if self.comes_last { " if it grows after all other loads, while the history itself slips" } else { "" };
        let found = match (self.between, &self.report.explanation.slip, self.report.status) {
            (Some([holds, slips]), Some(JointSlip { motion, .. }), _) => format!(
                "load[{load}] times {holds:.4}, {held}, holds{last}; beyond {slips:.4} the joint slips as a whole: {motion}"
            ),
            (None, Some(JointSlip { between: [from, by], .. }), _) => {
                format!("the joint slips as a whole between t = {from} s and {by} s, where load[{load}] is constant")
            }
            (Some([holds, gives_way]), None, _) => format!(
                "load[{load}] times {holds:.4}, {held}, holds; beyond {gives_way:.4} nothing balances the loads"
            ),
            (_, _, Status::Converged) => format!("the joint holds {most} times load[{load}] without slip as a whole"),
            (_, _, status) => {
                format!("no capacity was found: the run is {status}. {}", self.report.explanation.reason)
            }
        };
        let on_the_way = |what: &str, (name, [from, to]): &(String, [f64; 2])| {
            format!("; `{name}` {what} between load[{load}] times {from:.4} and {to:.4}")
        };
        let opens = self.opens.iter().map(|contact| on_the_way("opens", contact));
        let slip = self.slips_before.iter().map(|contact| on_the_way("begins to slip wholly", contact));
        found + &opens.chain(slip).collect::<String>()
    }

    /// Returns the capacity as one JSON object.
    pub fn to_json(&self) -> Value {
        let report = self.report.to_value().unwrap_or_default();
        let contact = |(boundary, factors): &(String, [f64; 2])| json!({ "boundary": boundary, "between": factors });
        json!({
            "title": self.report.title,
            "load": self.load,
            "safety": self.between.map(|[holds, _]| holds),
            "held": self.held(),
            "between": self.between,
            "opens": self.opens.as_ref().map(contact),
            "slips_before": self.slips_before.iter().map(contact).collect::<Vec<_>>(),
            "status": self.report.status,
            "message": self.sentence(),
            "slip": report.get("slip"),
            "units": report.get("units"),
            "warnings": self.report.warnings,
        })
    }
}
