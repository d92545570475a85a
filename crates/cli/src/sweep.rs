//! Runs one scene with several values of some of its keys. Every combination is a variant; all variants share one table,
//! one chart and one page.
//!
//! ```
//! use stickslip::base::Field;
//! use stickslip::scene::Scene;
//! use stickslip_cli::sweep::{Variation, combinations};
//!
//! let friction: Variation = "contact.friction=0.1:0.5:3".parse()?;
//! let mesh: Variation = "mesh.elements=[10,10],[20,20]".parse()?;
//! assert_eq!(friction.values, ["0.1", "0.3", "0.5"]);
//! let variants = combinations(&[friction, mesh])?;
//! assert_eq!(variants.len(), 6);
//!
//! let block = Scene::parse("block.toml", include_str!("../../../data/scenes/block.toml"), &variants[1].overrides)?;
//! assert_eq!(block.description.contacts[0].friction, Field::Uniform(0.1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod outcome;
mod page;
mod picture;
mod table;
mod variation;

pub use outcome::VariantResult;
pub use table::{Row, Sweep, TableQuantities};
pub use variation::{MAX_VARIANTS, Variant, Variation, combinations};
