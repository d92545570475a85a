//! Tests of the results of a run: fields, tables, pictures and folders.

#[path = "../../../../tests/common/mod.rs"]
mod common;

mod bodies_in_space;
mod contact_surface;
mod outputs;
mod patches;
mod prisms;
mod second_order;
mod units;
mod vtu;
