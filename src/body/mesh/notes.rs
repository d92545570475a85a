//! Notes on the file of a mesh.

use super::MeshFault;

/// Notes on the file of a mesh; empty for a mesh that was not read from a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Notes {
    /// Changes and omissions when the file was read, in words.
    pub remarks: Vec<String>,
    /// Named groups that cannot be boundaries, each with the reason. Such a group is an error only if a scene names it.
    pub unusable: Vec<(String, MeshFault)>,
    /// The entries of [`super::Mesh::groups`] for cells in several groups of the file, each with the names of these
    /// groups.
    pub combined: Vec<(String, Vec<String>)>,
}

impl Notes {
    /// Returns the groups of the file that contain the cells of `group`.
    pub fn members<'a>(&'a self, group: &'a String) -> &'a [String] {
        let combined = self.combined.iter().find(|(name, _)| name == group);
        combined.map_or(std::slice::from_ref(group), |(_, members)| members)
    }

    /// Adds the name of the body `name` to the groups.
    pub(super) fn of_body(self, name: &str) -> Self {
        let full = |group: String| format!("{name}:{group}");
        Notes {
            remarks: self.remarks.into_iter().map(|remark| format!("{name}: {remark}")).collect(),
            unusable: self.unusable.into_iter().map(|(group, fault)| (full(group), fault)).collect(),
            combined: (self.combined.into_iter())
                .map(|(group, members)| (full(group), members.into_iter().map(full).collect()))
                .collect(),
        }
    }

    /// Adds the notes of another mesh.
    pub(super) fn append(&mut self, Notes { remarks, unusable, combined }: Notes) {
        self.remarks.extend(remarks);
        self.unusable.extend(unusable);
        self.combined.extend(combined);
    }
}
