//! What the file of a mesh says beyond the mesh.

use super::MeshFault;

/// What the file of a mesh says beyond the mesh. A mesh that was not read from a file has none of it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Notes {
    /// What was changed or left out when the file was read, in words.
    pub remarks: Vec<String>,
    /// Named groups that cannot be boundaries, each with the reason. It is an error only if a scene names such a group.
    pub unusable: Vec<(String, MeshFault)>,
    /// The entries of [`super::Mesh::groups`] that stand for cells in several groups of the file, each with the names of these.
    pub combined: Vec<(String, Vec<String>)>,
}

impl Notes {
    /// The groups of the file that the cells of `group` are in.
    pub fn members<'a>(&'a self, group: &'a String) -> &'a [String] {
        let combined = self.combined.iter().find(|(name, _)| name == group);
        combined.map_or(std::slice::from_ref(group), |(_, members)| members)
    }

    /// The notes of the body `name`, whose name its groups have.
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
