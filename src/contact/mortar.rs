//! stub
use crate::mesh::{Boundary, Mesh};
use crate::units::UnitSystem;
use crate::fem::Elasticity;
#[derive(Debug, Clone, Copy)]
pub struct Asked { pub search: Option<f64>, pub direction: Option<[f64;3]> }
#[derive(Debug, Clone)]
pub struct Mortar { pub rows: Vec<MortarRow> }
#[derive(Debug, Clone)]
pub struct MortarRow { pub node: usize, pub weight: f64, pub gap: f64, pub normal: [f64;3], pub slave: Vec<(usize,f64)>, pub master: Vec<(usize,f64)> }
#[derive(Debug)]
pub struct MortarFault;
impl MortarFault { pub fn key(&self) -> &str {"against"} pub fn told(&self, _: &UnitSystem) -> String { String::new() } pub fn help(&self) -> &str {""} }
impl Mortar { pub fn new(_m: &Mesh, _s: &Boundary, _ma: &Boundary, _a: &Asked, _h: &dyn Fn(usize)->Vec<[f64;3]>) -> Result<Self, MortarFault> { Err(MortarFault) } }
pub fn preferred_slave(_m: &Mesh, _s: &Boundary, _ma: &Boundary, _a: &Asked, _h: &dyn Fn(usize)->Vec<[f64;3]>, _mat: &[Elasticity]) -> Result<Option<String>, MortarFault> { Ok(None) }
