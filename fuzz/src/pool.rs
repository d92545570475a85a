//! Many inputs, each in a thread that may panic or hang without harm to the others.

use std::cell::RefCell;
use std::collections::HashMap;
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

/// No input may take longer, by the processor time of its thread: others may be at work on the machine.
pub const LONGEST: Duration = Duration::from_secs(10);

/// What has not ended by then hangs.
const HANGS: Duration = Duration::from_secs(60);

/// What became of an input: how it counts, or what is wrong.
pub type Verdict = Result<&'static str, String>;

/// Inputs by their seeds.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// The first seed; the others follow.
    pub seed: u64,
    /// How many, at most.
    pub count: u64,
    /// How long to begin new ones, at most.
    pub time: Duration,
    /// How many side by side.
    pub jobs: usize,
}

/// What became of them.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// How many ended.
    pub done: u64,
    /// How many of each kind.
    pub kinds: HashMap<&'static str, u64>,
    /// Seeds with what is wrong.
    pub failures: Vec<(u64, String)>,
    /// The longest that one took, and which.
    pub longest: (Duration, u64),
}

thread_local! {
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// What `check` says of an input.
///
/// # Errors
/// What it says is wrong; of a panic, where it was.
pub fn caught(check: impl FnOnce() -> Verdict) -> Verdict {
    let verdict = panic::catch_unwind(AssertUnwindSafe(check));
    verdict.unwrap_or_else(|_| {
        let place = PANIC.with(RefCell::take).unwrap_or_default();
        Err(format!("panic: {place}"))
    })
}

/// Panics are kept for [`caught`] from now on, and not printed.
pub fn keep_panics() {
    panic::set_hook(Box::new(|info| PANIC.with(|kept| *kept.borrow_mut() = Some(info.to_string()))));
}

struct Shared<F> {
    check: F,
    next: AtomicU64,
    plan: Plan,
    begun: Instant,
    /// What each worker is at, and since when.
    at: Mutex<HashMap<usize, (u64, Instant)>>,
}

enum Event {
    Ended(u64, Verdict, Duration),
    Idle,
}

/// The processor time of this thread.
fn busy() -> Duration {
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default()
}

fn work<F: Fn(u64) -> Verdict>(shared: &Shared<F>, worker: usize, events: &mpsc::Sender<Event>) {
    loop {
        let k = shared.next.fetch_add(1, Ordering::Relaxed);
        if k >= shared.plan.count || shared.begun.elapsed() > shared.plan.time {
            break;
        }
        let (seed, since) = (shared.plan.seed.wrapping_add(k), Instant::now());
        if let Ok(mut at) = shared.at.lock() {
            at.insert(worker, (seed, since));
        }
        let before = busy();
        let verdict = caught(|| (shared.check)(seed));
        let took = busy().saturating_sub(before);
        let verdict =
            verdict.and_then(|kind| if took > LONGEST { Err(format!("it took {took:.1?}")) } else { Ok(kind) });
        let known = shared.at.lock().is_ok_and(|mut at| at.remove(&worker).is_some());
        // One that was given up has been told, and its place is taken.
        if !known || events.send(Event::Ended(seed, verdict, took)).is_err() {
            return;
        }
    }
    let _ = events.send(Event::Idle);
}

/// Checks the inputs of a plan. `report` is shown the tally every few seconds, and each failure at once.
pub fn run<F>(plan: Plan, check: F, mut report: impl FnMut(&Tally, Option<&(u64, String)>)) -> Tally
where
    F: Fn(u64) -> Verdict + Send + Sync + 'static,
{
    let shared = Arc::new(Shared {
        check,
        next: AtomicU64::new(0),
        plan,
        begun: Instant::now(),
        at: Mutex::new(HashMap::new()),
    });
    let (sender, events) = mpsc::channel();
    let mut workers = 0;
    let mut hire = || {
        let (shared, sender, worker) = (Arc::clone(&shared), sender.clone(), workers);
        workers += 1;
        thread::spawn(move || work(&shared, worker, &sender));
    };
    (0..plan.jobs).for_each(|_| hire());
    let (mut tally, mut busy, mut reported) = (Tally::default(), plan.jobs, Instant::now());
    while busy > 0 {
        match events.recv_timeout(Duration::from_millis(500)) {
            Ok(Event::Ended(seed, verdict, took)) => {
                tally.done += 1;
                tally.longest = tally.longest.max((took, seed));
                match verdict {
                    Ok(kind) => *tally.kinds.entry(kind).or_default() += 1,
                    Err(wrong) => fail(&mut tally, seed, wrong, &mut report),
                }
            }
            Ok(Event::Idle) => busy -= 1,
            Err(_) => {}
        }
        if reported.elapsed() > Duration::from_secs(5) {
            reported = Instant::now();
            let late: Vec<(usize, u64)> = shared.at.lock().map_or(Vec::new(), |mut at| {
                let late = at.iter().filter(|(_, (_, since))| since.elapsed() > HANGS);
                let late: Vec<(usize, u64)> = late.map(|(worker, (seed, _))| (*worker, *seed)).collect();
                at.retain(|_, (_, since)| since.elapsed() <= HANGS);
                late
            });
            for (_, seed) in late {
                tally.done += 1;
                fail(&mut tally, seed, format!("no end within {} s", HANGS.as_secs()), &mut report);
                hire();
            }
            report(&tally, None);
        }
    }
    tally
}

fn fail(tally: &mut Tally, seed: u64, wrong: String, report: &mut impl FnMut(&Tally, Option<&(u64, String)>)) {
    tally.failures.push((seed, wrong));
    report(tally, tally.failures.last());
}
