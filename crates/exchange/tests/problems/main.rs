//! Tests of exchange files, and of problems in contact forces alone.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod exchange;
mod local;
