//! The tables and figures of the paper, and the suite of extremes.

#[path = "../common/mod.rs"]
mod common;

mod extremes;
mod figures;
mod table_block;
mod table_punch;
