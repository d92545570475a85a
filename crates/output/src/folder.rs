//! The folder of a run's results, filled while the run goes on.
//!
//! | what | file |
//! | --- | --- |
//! | whose a folder is, and what was left in it | `claim.rs` |
//! | what a run writes, and when | `results.rs` |
//! | the files of fields, one or several for an increment | `series.rs` |
//! | a folder that is locked, and published whole | `directory.rs` |
//! | a table that grows by whole lines | `table.rs` |

mod claim;
mod directory;
mod kept;
mod names;
mod results;
mod series;
mod table;

pub use claim::Claim;
pub use directory::{FolderLock, write_file};
pub use results::ResultFolder;
