//! stickslip.

pub mod contact;
pub mod fem;
pub mod formulation;
pub mod history;
pub mod linear;
pub mod loading;
pub mod mesh;
pub mod model;
pub mod nonlinear;
pub mod null_space;
pub mod problem;
pub mod report;
pub mod scene;
pub mod sparse;
pub mod tables;
pub mod units;
