//! The text that a run prints before and after its increments.

use stickslip::algebra::linear::process::Blas;
use stickslip::base::{Quantity, UnitSystem, six_digits};
use stickslip::body::{PeakOf, Pretension, StickZone};
use stickslip::run::Run;
use stickslip::run::report::{
    AppliedForce, BalanceRecord, ChangingLoad, ComponentSums, CycleReport, EliminatedUnknown, FrictionResult,
    HoldingForce, LargestForce, LargestPressure, PointRecord, RankRecord, Resultant, RunReport, SectionRecord,
    SlipRegime, Unknowns, Warning,
};
use stickslip::scene::{Scene, Time};
use stickslip::solver::formulation::Layout;
use stickslip::solver::history::{IncrementError, WorkingSet};

/// The digits of forces. Those of the largest component are enough to see a balance.
const FORCE_DIGITS: usize = 6;

/// A component of a force or displacement that is smaller than this share of the largest one is rounding, and a rotation that is
/// smaller than this share of one radian.
const NO_FORCE: f64 = 1e-12;

/// The digits of other results: more than their errors leave.
const DIGITS: usize = 4;

/// Prints the method, the unknowns, and warnings that need no solution.
pub(super) fn print_head(scene: &Scene, run: &Run<'_>, is_verbose: bool) {
    if is_verbose {
        print_set_up(scene, run);
    }
    let of_model = Warning::of_model(run.model()).into_iter().filter(|warning| !warning.kind.needs_the_solution);
    let of_blas = Blas::loaded().as_ref().and_then(Warning::of_blas);
    print_warnings(&of_model.chain(of_blas).collect::<Vec<_>>());
    if is_verbose {
        row!("set-up       symbolic analysis");
    }
}

fn print_set_up(scene: &Scene, run: &Run<'_>) {
    let (model, choice, method) = (run.model(), run.choice(), scene.solver.method);
    let Unknowns { u, p_t, p_o, p_n, v_n, s, lambda } =
        Unknowns::new(&Layout::new(&model.problem), method.increments());
    let blocks = [(u, "u"), (p_t, "p_t"), (p_o, "p_o"), (p_n, "p_n"), (v_n, "v_n"), (s, "s"), (lambda, "lambda")];
    let present = blocks.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count} {name}"));
    let reduced = if method.increments().is_interior() {
        format!(", reduced to {} in the matrix", u + p_t + p_o + p_n)
    } else {
        String::new()
    };
    if let Some(asked) = scene.refine {
        let (nodes, times) = (model.mesh.nodes.len(), run.coarser_meshes().len());
        let how = run.coarser_meshes().first().map_or(format!("not refined: {nodes} nodes are enough"), |first| {
            let times = if times == 1 { "once".to_string() } else { format!("{times} times") };
            format!("refined {times}, from {} to {nodes} nodes,", first.nodes)
        });
        row!("mesh         {how} for an error of {} %", six_digits(100.0 * asked));
    }
    row!("method       {}, setting {}", method.name(), method.setting());
    if let Some(reason) = &choice.reason {
        row!("solver       {reason}");
    }
    let total: usize = blocks.iter().map(|(count, _)| count).sum();
    let Time { increments, kinks, .. } = &scene.time;
    if !kinks.is_empty() {
        let fewer = if kinks.len() > *increments { "; histories with fewer points have fewer" } else { "" };
        row!("increments   {increments} equal ones, and {} more to end at kinks of histories{fewer}", kinks.len());
    }
    row!("unknowns     {total} = {}{reduced}", present.collect::<Vec<_>>().join(" + "));
    let condenses = choice.linear.condenses();
    let left_out = EliminatedUnknown::all(model, condenses, run.working_set().filter(|_| condenses));
    for (k, EliminatedUnknown { count, unknown, reason }) in left_out.iter().enumerate() {
        row!("{:<12} {count} {unknown} {reason}", if k == 0 { "left out" } else { "" });
    }
}

/// Prints each warning in a line, with its kind, and its cure, the last part of the message, in the next. A cure of several warnings is
/// printed once.
pub(in crate::commands) fn print_warnings<'a>(warnings: impl IntoIterator<Item = &'a Warning>) {
    let mut cures = Vec::new();
    for Warning { kind, message, .. } in warnings {
        let (finding, cure) = message.rsplit_once("; ").unwrap_or((message, ""));
        row!("warning      {}: {finding}", kind.name);
        if !cure.is_empty() && !cures.contains(&cure) {
            row!("             {cure}");
            cures.push(cure);
        }
    }
}

/// Prints the results at the end, the computation, and last, where the eye is, the peak and the verdict.
pub(super) fn print_results(scene: &Scene, report: &RunReport, increments: usize, is_verbose: bool) {
    let has_results = report.totals.converged > 0;
    if is_verbose {
        row!("");
        if has_results {
            print_forces(scene, report);
            print_estimates(scene, report);
            let (law, error) = report.totals.kkt.worst();
            let backward = report.totals.backward_error;
            row!("laws         error {error:.1e} at most ({law}); backward error of the solves {backward:.1e}");
        }
        print_work(report);
    }
    print_warnings(report.warnings.iter().filter(|warning| warning.kind.needs_the_solution));
    print_verdict(report, increments, has_results);
}

/// Prints the largest results, the verdict and its reason.
fn print_verdict(report: &RunReport, increments: usize, has_results: bool) {
    row!("");
    if has_results {
        print_largest(report);
    }
    let totals = &report.totals;
    row!("verdict      {}, {} of {increments} increments", report.status, totals.converged);
    if !report.explanation.reason.is_empty() {
        row!("             {}", report.explanation.reason);
    }
}

/// Returns the largest component of any force on the body, N.
fn largest_force(report: &RunReport) -> f64 {
    let supports = report.last_reactions.iter().flat_map(|all| all.supports.iter().chain(&all.springs));
    let of_contact =
        report.boundaries.iter().flat_map(|boundary| boundary.force.iter().chain([&boundary.sums.sum_p_n]));
    let others = supports.flat_map(|support| &support.force);
    of_contact.chain(others).fold(0.0, |m: f64, f| m.max(f.abs()))
}

/// Prints the resultants of each contact, the reactions and their balance.
fn print_forces(scene: &Scene, report: &RunReport) {
    let units = &report.units;
    let largest = largest_force(report);
    let without_rounding = |numbers: &[f64], size: f64| -> Vec<f64> {
        numbers.iter().map(|x| if x.abs() > NO_FORCE * size { *x } else { 0.0 }).collect()
    };
    let vector = |force: &[f64]| units.rounded_vector(Quantity::Force, &without_rounding(force, largest), FORCE_DIGITS);
    for Resultant { boundary, force, sums: ComponentSums { sum_p_n, sum_p_t, sum_p_o }, obstacles, opposite, .. } in
        &report.boundaries
    {
        let names = if sum_p_o.is_some() { "p_n, p_t, p_o" } else { "p_n, p_t" };
        let sums: Vec<f64> = [*sum_p_n, *sum_p_t].into_iter().chain(*sum_p_o).collect();
        row!("contact      {boundary}: sums of {names} {}", vector(&sums));
        let on = opposite.as_ref().map_or("the obstacle", |of| of.boundary.as_str());
        row!("             force on {on} {}", vector(force));
        for on in obstacles {
            row!("             {} of it on {}", vector(&on.force), on.obstacle);
        }
    }
    if let Some(BalanceRecord { supports, springs, couplings, pretensions, balance, .. }) = &report.last_reactions {
        for (kind, AppliedForce { at, force, moment, .. }) in
            supports.iter().map(|support| ("reaction", support)).chain(springs.iter().map(|spring| ("spring", spring)))
        {
            // Sums of forces around the axis have no meaning, but their torque has.
            if units.components > units.dimension {
                let torque = units.rounded(Quantity::Moment, moment[1], FORCE_DIGITS);
                row!("{kind:<12} {at}: {} and a torque of {torque} on the body", vector(&force[..units.dimension]));
            } else {
                row!("{kind:<12} {at}: {} on the body", vector(force));
            }
        }
        for PointRecord { at, force, moment, displacement, rotation } in couplings {
            let length = report.largest_displacement.as_ref().map_or(0.0, |largest| largest.length);
            let moved = units.rounded_vector(Quantity::Length, &without_rounding(displacement, length), DIGITS);
            let turned = without_rounding(rotation, 1.0).into_iter().map(|angle| six_digits(angle).to_string());
            let turned: Vec<String> = turned.collect();
            row!("coupling     {at}: moved by {moved}, turned by ({}) rad", turned.join(", "));
            let moment = units.rounded_vector(Quantity::Moment, moment, FORCE_DIGITS);
            row!("             {} and {moment} on the body", vector(force));
        }
        for SectionRecord { at, normal_force, shortening, .. } in pretensions {
            let force = units.rounded(Quantity::Force, *normal_force, FORCE_DIGITS);
            let shortening = units.rounded(Quantity::Length, *shortening, DIGITS);
            let periodic =
                |pretension: &Pretension| pretension.name == *at && scene.description.is_periodic(&pretension.boundary);
            let how = if scene.description.pretensions.iter().any(periodic) { "elongated" } else { "shortened" };
            row!("pretension   {at}: {force} across the section, {how} by {shortening}");
        }
        for bolt in &report.pretension_forces {
            let [least, most] = bolt.force_range.map(|force| units.rounded(Quantity::Force, force, FORCE_DIGITS));
            if let Some(locked) = bolt.locked_force.map(|force| units.rounded(Quantity::Force, force, FORCE_DIGITS)) {
                row!("             {}: {locked} at the lock, from {least} to {most} since", bolt.name);
            }
        }
        row!("balance      the forces on the body balance to {balance:.1e} of their sizes");
    }
}

/// Prints the largest displacement and pressure.
fn print_largest(report: &RunReport) {
    let units = &report.units;
    if let Some(largest) = &report.largest_displacement {
        row!(
            "displacement {} at most, at t = {} s",
            units.rounded(Quantity::Length, largest.length, DIGITS),
            six_digits(largest.time)
        );
    }
    let about = |error: Option<f64>| match error {
        Some(error) if error.abs() < 1e-3 => "below 0.1 %".to_string(),
        Some(error) => format!("about {}", percent(error.abs())),
        None => "unknown".to_string(),
    };
    let of_mesh = |error: Option<f64>, given: bool| {
        if given { "loads alone determine it".to_string() } else { format!("error of the mesh {}", about(error)) }
    };
    // The exact path has no increments.
    let of_increments = |error| match &*report.method {
        "events" => String::new(),
        _ => format!(", error of the increments {}", about(error)),
    };
    if let Some(LargestForce { boundary, magnitude, time, mesh_error, given, .. }) = &report.largest_force {
        let force = units.rounded(Quantity::Force, *magnitude, DIGITS);
        let error = of_mesh(*mesh_error, *given);
        row!("force        {force} at most on `{boundary}`, at t = {} s, {error}", six_digits(*time));
    }
    if let Some(HoldingForce { boundary, magnitude, time, mesh_error, given, time_error, .. }) = &report.holding_force {
        let force = units.rounded(Quantity::Force, *magnitude, DIGITS);
        let error = format!("{}{}", of_mesh(*mesh_error, *given), of_increments(*time_error));
        row!("tangential   {force} at most on `{boundary}`, at t = {} s, {error}", six_digits(*time));
    }
    for used in &report.friction_use {
        let (share, at) = (percent(used.largest), six_digits(used.time));
        let from = |nodes: &str, time: Option<f64>, k: usize| {
            Some(format!("{nodes} slip from {} s{}", six_digits(time?), ChangingLoad::in_words(&used.factors, k)))
        };
        let first = used.slips_from.filter(|time| Some(*time) != used.slips_wholly_from);
        let ways = [from("some nodes", first, 0), from("all", used.slips_wholly_from, 1)].into_iter();
        let slips = ways.flatten().reduce(|some, all| format!("{some}, {all}")).unwrap_or("no node slips".to_string());
        let limit = units.rounded(Quantity::Force, used.friction_limit, DIGITS);
        let (boundary, end) = (&used.boundary, format!("{:?}", used.end).to_lowercase());
        row!(
            "slip         {share} of the friction in use at most on `{boundary}`, at t = {at} s, of {limit} at most; {slips}; \
             at the end {end}"
        );
    }
    if let Some(FrictionResult { friction_work, time_error, .. }) = report.friction {
        let energy = |work: f64| units.rounded(Quantity::Energy, work, DIGITS);
        let of_steps = match time_error {
            Some(error) if error.abs() >= 1e-3 => {
                let (verb, corrected) =
                    (if error < 0.0 { "take" } else { "add" }, energy(friction_work * (1.0 - error)));
                format!(", increments {verb} {}: corrected {corrected}", percent(error.abs()))
            }
            error => of_increments(error),
        };
        row!("friction     work {}, error of the mesh unknown{of_steps}", energy(friction_work));
    }
    let partial = report.stick_zone.as_ref().filter(|zone| zone.ratio > 0.0 && zone.ratio < 1.0);
    if let Some(StickZone { boundary, time, ratio, uncertainty, .. }) = partial {
        let known =
            uncertainty.map_or(String::new(), |share| format!(" ± {}", units.rounded(Quantity::Number, share, 1)));
        let time = six_digits(*time);
        row!("stick zone   {ratio:.2}{known} of the contact width on `{boundary}`, at t = {time} s");
    }
    if let Some(cycle) = &report.cycle {
        print_cycle(cycle, units);
    }
    let Some(largest) = &report.largest_pressure else { return };
    let LargestPressure { pressure, peak_of, boundary, position, time, nodes_across, mesh_error, singular, .. } =
        largest;
    let across = nodes_across.map_or(String::new(), |nodes| format!(", {nodes} nodes across"));
    let error = match mesh_error {
        _ if *singular => "singular: it depends on the mesh".to_string(),
        error => of_mesh(*error, false),
    };
    let place = units.point(position.map(six_digits));
    let place = format!("at {place} on `{boundary}`, t = {} s", six_digits(*time));
    let stress = |value: f64| units.rounded(Quantity::Stress, value, DIGITS);
    let mean = largest.mean_pressure.map_or(String::new(), |mean| format!(", mean {}", stress(mean)));
    match (peak_of, pressure.map(stress)) {
        (Some(of), Some(pressure)) => {
            let of = if *of == PeakOf::Patches { " on a node with its neighbours" } else { "" };
            row!("pressure     {pressure} at most{of}{mean}, {error}{across}, {place}");
        }
        _ => row!("pressure     too few tetrahedra across the contact for a peak, {place}"),
    }
}

/// Prints the results of a load cycle.
fn print_cycle(cycle: &CycleReport, units: &UnitSystem) {
    let work = match cycle.regime {
        SlipRegime::Stick => String::new(),
        _ => format!(", friction work {}", units.rounded(Quantity::Energy, cycle.friction_work, DIGITS)),
    };
    let change = cycle.change.map_or(String::new(), |change| match change {
        same if same.abs() < 5e-4 => ", as in the cycle before".to_string(),
        less if less < 0.0 => format!(", {} less than in the cycle before", percent(-less)),
        more => format!(", {} more than in the cycle before", percent(more)),
    });
    let ends = [cycle.start, cycle.end].map(six_digits);
    row!("cycle        t = {} to {} s: {}{work}{change}", ends[0], ends[1], cycle.regime.name());
}

/// Formats a share in percent, with two digits if it is small.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    // A share above 0 is never told as 0.0.
    let is_small = share != 0.0 && percent < 9.5;
    if is_small { format!("{:.1} %", percent.max(0.1)) } else { format!("{percent:.0} %") }
}

/// Prints the errors that mesh and increments leave.
fn print_estimates(scene: &Scene, report: &RunReport) {
    if let Some(error) = report.estimates.discretisation {
        let asked = |asked| format!("; mesh.refine asks for {} %", six_digits(100.0 * asked));
        row!(
            "mesh error   about {:.1} % in the energy norm{}",
            100.0 * error,
            scene.refine.map_or(String::new(), asked)
        );
    }
    let slips = |found: &IncrementError| found.friction_work > 0.0;
    let force_error = report.estimates.increments.filter(slips).and_then(|found| found.force_error);
    if let Some(error) = force_error.filter(|e| *e > 0.0) {
        let size = if error > 1.0 { "unknown".to_string() } else { format!("about {:.1} %", 100.0 * error) };
        row!("time steps   error of the tangential forces {size}");
    }
    if let Some(error) = report.estimates.start {
        row!(
            "time steps   what acts at t = 0 leaves an error of the friction forces of {:.1} %, by solving the first increments \
             again",
            100.0 * error
        );
    }
}

/// Prints the counts of the solvers, time and memory.
fn print_work(report: &RunReport) {
    let totals = &report.totals;
    let linear = match totals.krylov_iterations {
        Some(krylov) => format!(
            "{} with {} entries, {} of GMRES",
            counted(totals.factorizations, "Newton matrix", "Newton matrices"),
            totals.nnz_factors,
            counted(krylov, "iteration", "iterations")
        ),
        None => format!(
            "{}, {}, {} entries in L and U",
            counted(totals.factorizations, "factorisation", "factorisations"),
            counted(totals.symbolic_analyses, "symbolic analysis", "symbolic analyses"),
            totals.nnz_factors
        ),
    };
    row!("work         {}, {linear}", counted(totals.iterations, "iteration", "iterations"));
    if let Some(WorkingSet { first, last, all, grown }) = report.working_set {
        let then = match grown {
            0 => String::new(),
            1 => format!(" at first, {last} after it grew once"),
            _ => format!(" at first, {last} after it grew {grown} times"),
        };
        row!("working set  {first} of {all} contact nodes{then}");
    }
    let memory = totals.peak_rss_bytes.map_or(String::new(), |bytes| format!(", {:.0} MB", bytes as f64 * 1e-6));
    row!("time         {:.2} s ({:.2} s CPU){memory}", totals.wall_seconds, totals.cpu_seconds);
    for RankRecord { rank, cpu_seconds, peak_rss_bytes } in &totals.ranks {
        row!("rank {rank:<8}{cpu_seconds:.2} s CPU, {:.0} MB", *peak_rss_bytes as f64 * 1e-6);
    }
}

/// Formats a count with the word for it.
fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
