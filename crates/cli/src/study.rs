//! The parts that all studies use. A study runs variants of a scene, takes quantities from each run, and shows them as
//! tables and charts, a sweep also as a page: [`sweep`](crate::sweep) names the variants, [`converge`](crate::converge) refines until a
//! quantity is known, [`compare`](crate::compare) judges methods and meshes against a reference.

mod curves;
mod error;
mod keys;
mod mesh;
mod places;
mod quantity;
mod record;

pub(crate) use curves::{DASHES, curve, grouped, labelled, scene_words};
pub use error::StudyError;
pub use mesh::{ElementChoice, MeshChoice, MeshSize};
pub(crate) use mesh::{each, first_elements, multiplied};
pub use places::Places;
pub(crate) use quantity::{IN_TABLES, KEY_RESULTS};
pub use quantity::{TableQuantity, listed, quantities};
pub(crate) use record::{Record, csv, number, record};

/// Returns each of the items once, in the order in which they first come.
pub(crate) fn distinct<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut distinct = Vec::new();
    for item in items {
        if !distinct.contains(&item) {
            distinct.push(item);
        }
    }
    distinct
}
