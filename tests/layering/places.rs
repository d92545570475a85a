//! What stands where it must not.

use crate::source::{Sources, code, is_program};

pub const MOST_LINES: usize = 700;

/// What `sources` hold that has no place there; `unsafe` has its place in the folder `unsafe_in`.
pub fn place_faults(sources: &Sources, unsafe_in: &[&str]) -> Vec<String> {
    let mut faults = Vec::new();
    for (file, text) in sources {
        if text.lines().count() > MOST_LINES {
            faults.push(format!("{file}: more than {MOST_LINES} lines"));
        }
        let may_be_unsafe = unsafe_in.iter().any(|folder| file.starts_with(folder));
        for (line, code) in code(text) {
            let mut forbid = |what: &str, allowed: bool| {
                if code.contains(what) && !allowed {
                    faults.push(format!("{file}:{line}: {what}"));
                }
            };
            forbid("unsafe", may_be_unsafe);
            // println, eprintln and eprint, too.
            forbid("print!", is_program(file));
            forbid("println!", is_program(file));
            forbid("dbg!", false);
            forbid(".unwrap()", false);
            forbid("panic!(", false);
            forbid("todo!(", false);
            forbid("unimplemented!(", false);
            forbid("#[path", false);
        }
        // What a caller hands in ends in an error, so there is no panic to promise.
        for (k, line) in text.lines().enumerate() {
            if line.trim_start().strip_prefix("//").is_some_and(|comment| comment.contains("# Panics")) {
                faults.push(format!("{file}:{}: a panic promised", k + 1));
            }
        }
    }
    faults
}
