//! The files of fields: one per increment, or one per rank if ranks share the body, and the list of all increments.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufWriter, Write};

use super::directory::Locked;
use super::names::{self, SERIES};
use crate::vtu::Grid;
use crate::{pvd, pvtu};

/// The listed file of each increment, with its time, s.
#[derive(Debug, Default)]
pub(super) struct Series(pub Vec<(f64, String)>);

impl Series {
    /// Resumes a series. Files written after the checkpoint are removed, lists of files before the files: other ranks
    /// write other parts, which must not be mixed with the old ones.
    pub(super) fn resumed(files: Vec<(f64, String)>, folder: &mut Locked) -> io::Result<Self> {
        let series = Series(files);
        let kept: BTreeSet<&str> = series.0.iter().filter_map(|(_, name)| names::increment_of_fields(name)).collect();
        let names = folder.directory.names()?.into_iter().map(|(name, _)| name);
        let is_late = |name: &String| names::increment_of_fields(name).is_some_and(|number| !kept.contains(number));
        let mut late: Vec<String> = names.filter(is_late).collect();
        late.sort_by_key(|name| !names::names_pieces(name));
        if !late.is_empty() {
            series.write(folder)?;
        }
        late.iter().try_for_each(|name| folder.directory.remove(name))?;
        Ok(series)
    }

    /// Writes the fields at the end of increment `index`, at `time` (s), without holding a whole text in memory.
    pub(super) fn add(&mut self, folder: &mut Locked, index: usize, time: f64, grid: &Grid) -> io::Result<()> {
        let pieces: Vec<(String, i32)> =
            grid.ranks().into_iter().map(|rank| (names::piece(index, rank), rank)).collect();
        let name = if pieces.is_empty() {
            let name = names::fields(index);
            folder.write(&name, |file| write_text(file, grid))?;
            name
        } else {
            folder.write_each(&pieces, |rank, file| write_text(file, &grid.part(*rank)))?;
            let name = names::pieces(index);
            let text = pvtu::parallel(grid, pieces.iter().map(|(name, _)| name.as_str()));
            folder.write(&name, |file| write_text(file, &text))?;
            name
        };
        self.0.push((time, name));
        self.write(folder)
    }

    fn write(&self, folder: &mut Locked) -> io::Result<()> {
        folder.write(SERIES, |file| write_text(file, &pvd::series(&self.0)))
    }
}

fn write_text(file: &mut File, text: &impl Display) -> io::Result<()> {
    let mut file = BufWriter::new(file);
    write!(file, "{text}")?;
    file.flush()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::part::tests::squares;

    /// Returns the existing files of fields, ascending.
    fn there(folder: &Locked) -> Vec<String> {
        let mut names: Vec<String> = folder.directory.names().unwrap().into_iter().map(|(name, _)| name).collect();
        names.retain(|name| name.starts_with("fields"));
        names.sort();
        names
    }

    #[test]
    fn a_run_goes_on_with_another_number_of_ranks() {
        let path = std::env::temp_dir().join(format!("stickslip-series-{}", std::process::id()));
        let mut folder = Locked::open(&path, |_| Ok(())).unwrap();
        folder.is_published = true;
        let shared = squares();
        let mut alone = squares();
        alone.cell_fields.pop();

        let mut series = Series::default();
        series.add(&mut folder, 1, 0.5, &shared).unwrap();
        let kept = series.0.clone();
        series.add(&mut folder, 2, 1.0, &shared).unwrap();
        let parts = |index: usize| [names::pieces(index), names::piece(index, 0), names::piece(index, 2)];
        let [series_and_first, second] = [[&parts(1)[..], &[SERIES.to_string()]].concat(), parts(2).to_vec()];
        let sorted = |names: &[&[String]]| {
            let mut names = names.concat();
            names.sort();
            names
        };
        assert_eq!(there(&folder), sorted(&[&series_and_first, &second]));

        // The checkpoint is after the first increment. The second one is solved again, by one process.
        let mut series = Series::resumed(kept.clone(), &mut folder).unwrap();
        assert_eq!(there(&folder), sorted(&[&series_and_first]));
        let text = || std::fs::read_to_string(path.join(SERIES)).unwrap();
        assert!(text().contains("fields_0001.pvtu") && !text().contains("fields_0002"), "{}", text());
        series.add(&mut folder, 2, 1.0, &alone).unwrap();
        assert_eq!(there(&folder), sorted(&[&series_and_first, &[names::fields(2)]]));
        assert!(text().contains("fields_0001.pvtu") && text().contains("fields_0002.vtu"), "{}", text());

        // The reverse case.
        let mut series = Series::resumed(kept, &mut folder).unwrap();
        series.add(&mut folder, 2, 1.0, &shared).unwrap();
        assert_eq!(there(&folder), sorted(&[&series_and_first, &second]));
        drop(folder);
        std::fs::remove_dir_all(path).unwrap();
    }

    #[test]
    fn a_part_that_cannot_be_written_is_named_nowhere() {
        let path = std::env::temp_dir().join(format!("stickslip-series-fails-{}", std::process::id()));
        let mut folder = Locked::open(&path, |_| Ok(())).unwrap();
        folder.is_published = true;
        let mut series = Series::default();
        series.add(&mut folder, 1, 0.5, &squares()).unwrap();
        // A file does not replace a folder.
        std::fs::create_dir(path.join(names::piece(2, 2))).unwrap();
        series.add(&mut folder, 2, 1.0, &squares()).unwrap_err();
        assert!(!path.join(names::pieces(2)).exists());
        let text = std::fs::read_to_string(path.join(SERIES)).unwrap();
        assert!(text.contains("fields_0001.pvtu") && !text.contains("fields_0002"), "{text}");
        assert_eq!(series.0.len(), 1);
        drop(folder);
        std::fs::remove_dir_all(path).unwrap();
    }
}
