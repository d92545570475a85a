//! Chooses the kernel of the BLAS. OpenBLAS reads the environment variable for its kernel when it is loaded, before the
//! program can set the variable. If a better kernel exists, the program therefore sets the variable and restarts itself
//! in place: with the same process number, arguments, files and environment.

use std::convert::Infallible;
use std::env;
use std::ffi::OsString;
use std::fmt;
use std::io;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::Command;
use std::str::FromStr;

use stickslip::algebra::linear::blas::{Blas, KERNEL_VARIABLE, Vectors, kernel_names, may_run_here};

use super::Failure;

/// The kernel to use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Kernel {
    /// The best kernel for the processor, unless the environment names one.
    Auto,
    /// The kernel that OpenBLAS chose.
    Keep,
    /// The kernel of this name.
    Named(String),
}

impl FromStr for Kernel {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        // Case does not matter, as in the names of OpenBLAS. An empty variable counts as unset.
        Ok(match text.to_ascii_lowercase().as_str() {
            "" | "auto" => Kernel::Auto,
            "keep" => Kernel::Keep,
            _ => Kernel::Named(text.to_string()),
        })
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Kernel::Auto => "auto",
            Kernel::Keep => "keep",
            Kernel::Named(name) => name,
        })
    }
}

/// Environment variable that marks a restarted program. It holds the process number, which a restart does not change,
/// and the kernel before the restart. Other processes, such as children, have another number and ignore it.
const RESTARTED: &str = "STICKSLIP_RESTARTED";

/// Makes the wanted kernel run, if necessary by restarting the program. It must be called before any thread is started.
/// Returns the kernel before the restart if the program has been restarted.
///
/// # Errors
/// A named kernel that the library does not run.
pub(super) fn choose(wanted: &Kernel) -> Result<Option<String>, Failure> {
    let Some(blas) = Blas::loaded().filter(|_| *wanted != Kernel::Keep) else { return Ok(None) };
    if let Some(before) = restarted_from() {
        return restarted(wanted, &blas, before);
    }
    let running = blas.kernel.as_deref().unwrap_or_default();
    match (wanted, blas.better_kernel) {
        (Kernel::Named(name), _) if !name.eq_ignore_ascii_case(running) => {
            check(name, &blas)?;
            let error = restart(Some(name), running);
            Err(Failure::Machine(miette::miette!("the program cannot restart itself for the kernel {name}: {error}")))
        }
        (Kernel::Auto, Some(better)) if blas.selectable && blas.kernel_asked.is_none() => {
            // If the system refuses the restart, the run is slow, and its report says so.
            restart(Some(better), running);
            Ok(None)
        }
        _ => Ok(None),
    }
}

/// Checks the kernel after a restart.
fn restarted(wanted: &Kernel, blas: &Blas, before: String) -> Result<Option<String>, Failure> {
    let running = blas.kernel.as_deref().unwrap_or_default();
    match wanted {
        Kernel::Named(name) if !name.eq_ignore_ascii_case(running) => Err(bad_kernel(&format!(
            "--blas-kernel {name}: there is no such kernel; the library uses {running} instead"
        ))),
        // A library that does not know the name may now use a worse kernel than before. Restart without a name.
        Kernel::Auto if Vectors::of_kernel(running) < Vectors::of_kernel(&before) => {
            restart(None, "");
            Ok(None)
        }
        _ => Ok(Some(before).filter(|before| !before.is_empty() && before != running)),
    }
}

/// Returns an error if such a kernel cannot exist.
fn check(name: &str, blas: &Blas) -> Result<(), Failure> {
    if !blas.selectable {
        let help = "leave it out, or use auto or keep";
        return Err(Failure::Input(miette::miette!(
            help = help,
            "--blas-kernel {name}: the BLAS ({blas}) has no selectable kernels"
        )));
    }
    if may_run_here(name) {
        Ok(())
    } else {
        Err(bad_kernel(&format!("--blas-kernel {name}: this processor cannot run it")))
    }
}

fn bad_kernel(message: &str) -> Failure {
    let names: Vec<&str> = kernel_names().filter(|name| may_run_here(name)).collect();
    let help = format!("kernels, if the library was built with them: {}", names.join(", "));
    Failure::Input(miette::miette!(help = help, "{message}"))
}

fn restarted_from() -> Option<String> {
    let told = env::var(RESTARTED).ok()?;
    let (process, kernel) = told.split_once(':')?;
    (process == std::process::id().to_string()).then(|| kernel.to_string())
}

/// Restarts the program in place, with `kernel` or with none. Returns only if the restart fails.
fn restart(kernel: Option<&str>, running: &str) -> io::Error {
    let mut arguments = env::args_os();
    let name: OsString = arguments.next().unwrap_or_default();
    let arguments: Vec<OsString> = arguments.collect();
    let replace = |program: PathBuf| {
        let mut command = Command::new(program);
        command.arg0(&name).args(&arguments).env(RESTARTED, format!("{}:{running}", std::process::id()));
        match kernel {
            Some(kernel) => command.env(KERNEL_VARIABLE, kernel),
            None => command.env_remove(KERNEL_VARIABLE),
        };
        command.exec()
    };
    // The path makes the system list the program under its name. If that file has been removed, the open file is used.
    if let Ok(path) = env::current_exe() {
        replace(path);
    }
    replace(PathBuf::from("/proc/self/exe"))
}
