//! The result folder of a run, filled during the run.
//!
//! | file | content |
//! | --- | --- |
//! | `locked.rs` | ownership of a folder, and the state left by an earlier run |
//! | `results.rs` | the files written by a run, and when |
//! | `series.rs` | the files of fields, one or several per increment |
//! | `directory.rs` | a locked folder whose files are published all at once |
//! | `table.rs` | a table that grows by whole lines |

mod directory;
mod locked;
mod names;
mod results;
mod series;
mod state;
mod table;

pub use directory::{FileLock, FolderLock, write_file};
pub use locked::LockedOutputDir;
pub use results::{ResultFolder, write_page};
pub use state::KeptSolver;
