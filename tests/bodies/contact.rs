//! Contact of bodies with obstacles and with each other, what holds them, and what moves them.

mod axisymmetric_contact;
mod between_nodes;
mod concave;
mod couplings;
mod friction;
pub mod fronts;
mod joints;
mod mortar;
mod moving_obstacles;
mod obstacles;
pub mod second_order_contact;
mod several_bodies;
mod slip;
pub mod surfaces;
mod turning;
mod two_bodies;
