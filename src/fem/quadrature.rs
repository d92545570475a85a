//! Integration points on the reference square [-1, 1]².

/// 1/√3.
const A: f64 = 0.577_350_269_189_625_8;

/// The 2 × 2 Gauss points; each has weight 1 and integrates bicubic polynomials exactly.
pub const GAUSS_2X2: [[f64; 2]; 4] = [[-A, -A], [A, -A], [A, A], [-A, A]];
