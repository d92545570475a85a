//! Pictures of the deformed body: its cells, or in space its visible surface, with magnified displacements, on the
//! outline of the undeformed body.

use super::colours::Bands;
use super::largest::{first_largest, is_equal};
use super::mesh_lines::MeshLines;
use super::svg::{Anchor, Colour, Dash, Line, PlotError, Svg, expect_finite};
use super::svg::{BLACK, LABEL_SIZE, NUMBER_SIZE, THIN, WIDTH};
use super::visible::{Visibility, visibility};
use std::collections::BTreeMap;
use stickslip::algebra::{cross, dot, minus, norm, unit};
use stickslip::base::{Quantity, UnitSystem, six_digits};
use stickslip::body::Model;
use stickslip::run::report::{deformation, von_mises};
use stickslip::solver::history::IncrementView;

/// The picture of the body at the end of an increment.
#[derive(Debug, Clone, PartialEq)]
pub struct DeformedBody {
    /// The increment; 0 for the body before the first one.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// The magnification of displacements.
    pub magnification: f64,
    /// The longest displacement, m.
    pub largest: f64,
    /// Cells or facets, front ones last: the corners in the plane of the picture, m, and von Mises' stress in the cell,
    /// Pa.
    pub patches: Vec<(Vec<[f64; 2]>, f64)>,
    /// The largest von Mises stress of all cells, Pa, those inside the body included.
    pub largest_stress: f64,
    /// The sides of the undeformed body, in space its edges, m.
    pub outline: Vec<[[f64; 2]; 2]>,
    /// The directions of the coordinate axes in the picture.
    pub axes: Vec<[f64; 2]>,
    /// The units of the picture; the numbers here are SI.
    pub units: UnitSystem,
}

const LEFT: f64 = 40.0;
/// The space right of the body, for the colour bar.
const RIGHT: f64 = 150.0;
const TOP: f64 = 104.0;
/// The space below the body, for the axes.
const BELOW: f64 = 84.0;
const MAX_HEIGHT: f64 = 720.0;
/// The minimum height of the colour bar.
const LEAST_BAR: f64 = 160.0;

const BEFORE: Colour = [205, 80, 10];
const DASHED: Line = Line { dash: Dash::Dashed, width: 1.2 };

/// The drawn length of the longest displacement, about, relative to the size of the body.
const SHOWN: f64 = 0.05;

/// Facets whose normals differ by more than this angle meet in an edge: the cosine of 30 degrees.
const EDGE: f64 = 0.866;

/// The direction from which a body in space is viewed: slightly from the right and from above, with z upwards.
const VIEWER: [f64; 3] = [0.45, -0.8, 0.4];

impl DeformedBody {
    /// Draws the body of `model` at the end of `step`, with displacements magnified by `magnification`. The default is
    /// 1, 2 or 5 times a power of ten, at least 1, for which the longest displacement is about a twentieth of the body.
    pub fn new(model: &Model, step: &IncrementView<'_>, magnification: Option<f64>) -> Self {
        let mesh = &model.mesh;
        let (displacements, factors) = deformation(model, step);
        let largest = displacements.iter().map(|u| norm(*u)).fold(0.0, f64::max);
        let magnification = magnification.unwrap_or_else(|| readable(SHOWN * mesh.size() / largest));
        let moved = |node: usize| [0, 1, 2].map(|c| mesh.nodes[node][c] + magnification * displacements[node][c]);
        let stresses: Vec<f64> = model.stresses(&factors, &displacements).into_iter().map(von_mises).collect();
        let view = View::of(mesh.dimension);
        let surface = mesh.surface();
        let faces: Vec<(Vec<usize>, usize)> = if mesh.dimension == 2 {
            mesh.cells.iter().enumerate().map(|(e, cell)| (cell.around(), e)).collect()
        } else {
            surface.clone()
        };
        let mut patches: Vec<(f64, Vec<[f64; 2]>, f64)> = Vec::new();
        for (nodes, e) in faces {
            let corners: Vec<[f64; 3]> = nodes.iter().map(|&node| moved(node)).collect();
            if mesh.dimension == 3 && dot(normal(&corners), view.towards) <= 0.0 {
                continue;
            }
            let depth = corners.iter().map(|x| dot(*x, view.towards)).sum::<f64>() / corners.len() as f64;
            patches.push((depth, corners.iter().map(|x| view.project(*x)).collect(), stresses[e]));
        }
        if mesh.dimension == 3 {
            patches.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let outline = if mesh.dimension == 2 {
            surface
                .iter()
                .flat_map(|(facet, _)| facet.windows(2))
                .map(|ends| [mesh.nodes[ends[0]], mesh.nodes[ends[1]]])
                .collect()
        } else {
            edges(surface.iter().map(|(facet, _)| mesh.points(facet)), view.towards)
        };
        let ends = |side: &[[f64; 3]; 2]| side.map(|end| view.project(end));
        let axis = |c: usize| view.project(stickslip::algebra::axis(c));
        DeformedBody {
            index: step.record.index,
            time: step.record.time,
            magnification,
            largest,
            patches: patches.into_iter().map(|(_, corners, stress)| (corners, stress)).collect(),
            largest_stress: stresses.iter().copied().fold(0.0, f64::max),
            outline: outline.iter().map(ends).collect(),
            axes: (0..mesh.dimension).map(axis).collect(),
            units: model.units(),
        }
    }

    /// Returns the picture as SVG: colours show von Mises' stress in the cells, dashes the undeformed body.
    ///
    /// # Errors
    /// When a coordinate or a stress is not finite.
    pub fn to_svg(&self, title: &str) -> Result<String, PlotError> {
        let corners = || self.patches.iter().flat_map(|(corners, _)| corners).chain(self.outline.iter().flatten());
        expect_finite(corners().flatten().copied())?;
        expect_finite(self.patches.iter().map(|(_, stress)| *stress))?;
        let bound = |c: usize| {
            corners().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x[c]), high.max(x[c])))
        };
        let [(left, right), (low, high)] = [bound(0), bound(1)];
        let scale = ((WIDTH - LEFT - RIGHT) / (right - left)).min(MAX_HEIGHT / (high - low));
        let start = LEFT + 0.5 * (WIDTH - LEFT - RIGHT - scale * (right - left));
        let bottom = TOP + scale * (high - low);
        let at = |[x, y]: [f64; 2]| [start + scale * (x - left), bottom - scale * (y - low)];
        // A flat body leaves room for the colour bar.
        let floor = bottom.max(TOP + LEAST_BAR);
        let shown = match self.magnification {
            1.0 => "as they are".to_string(),
            factor => format!("magnified {factor} times"),
        };
        let units = self.units.of_pictures();
        let largest = self.units.rounded(Quantity::Length, self.largest, 4);
        let subtitle = format!("t = {} s, displacements {shown}, {largest} at most", six_digits(self.time));
        let mut svg = Svg::headed(floor + BELOW, title, &subtitle);
        let patch = |(corners, stress): &(Vec<[f64; 2]>, f64)| {
            (corners.iter().map(|x| at(*x)).collect::<Vec<_>>(), units.of_si(Quantity::Stress, *stress))
        };
        let patches: Vec<_> = self.patches.iter().map(patch).collect();
        let visibilities = match self.axes.len() {
            3 => {
                let corners: Vec<&[[f64; 2]]> = patches.iter().map(|(corners, _)| corners.as_slice()).collect();
                visibility(&corners, [WIDTH, floor])
            }
            _ => vec![Visibility::Alone; patches.len()],
        };
        let visible = patches.into_iter().zip(visibilities).filter(|(_, seen)| *seen != Visibility::Hidden);
        let visible: Vec<Patch> = visible.map(|((corners, stress), seen)| Patch { corners, stress, seen }).collect();
        let most = visible.iter().map(|patch| patch.stress).fold(0.0, f64::max);
        let bands = Bands::up_to(most);
        draw_patches(&mut svg, &visible, &bands);
        svg.segments(self.outline.iter().map(|side| side.map(at)), DASHED, BEFORE);
        svg.line(&[[0.5 * WIDTH - 80.0, 76.0], [0.5 * WIDTH - 44.0, 76.0]], DASHED, BEFORE);
        svg.text([0.5 * WIDTH - 36.0, 76.0], "before the deformation", LABEL_SIZE, Anchor::Start);
        let text = |stress: f64| units.rounded(Quantity::Stress, units.to_si(Quantity::Stress, stress), 4);
        if let Some(k) = first_largest(visible.iter().map(|patch| patch.stress)) {
            svg.mark(centre(&visible[k].corners), &text(most), NUMBER_SIZE, 0.5 * (LEFT + WIDTH - RIGHT));
        }
        let label = format!("von Mises, {}", units.name(Quantity::Stress));
        bands.draw_bar(&mut svg, WIDTH - RIGHT + 30.0, [TOP, floor], &label);
        let inside = units.of_si(Quantity::Stress, self.largest_stress);
        if !is_equal(most, inside) {
            let text = format!("largest stress, out of sight: {}", text(inside));
            svg.text([WIDTH - 20.0, floor + BELOW - 30.0], &text, LABEL_SIZE, Anchor::End);
        }
        self.draw_axes(&mut svg, [LEFT + 20.0, floor + BELOW - 30.0]);
        Ok(svg.finish())
    }

    fn draw_axes(&self, svg: &mut Svg, [x, y]: [f64; 2]) {
        for (name, [right, up]) in ["x", "y", "z"].into_iter().zip(&self.axes) {
            let end = |length: f64| [x + length * right, y - length * up];
            svg.line(&[[x, y], end(32.0)], Line { width: 1.4, ..THIN }, BLACK);
            svg.text(end(44.0), name, LABEL_SIZE, Anchor::Middle);
        }
    }
}

/// A visible patch of the picture: its corners, px, and its stress.
struct Patch {
    corners: Vec<[f64; 2]>,
    stress: f64,
    seen: Visibility,
}

/// Draws the visible patches, back ones first, with the lines of the mesh.
fn draw_patches(svg: &mut Svg, patches: &[Patch], bands: &Bands) {
    let lines = |of: Visibility| {
        let own = patches.iter().filter(move |patch| patch.seen == of);
        MeshLines::of(own.map(|patch| patch.corners.as_slice()))
    };
    let single = patches.iter().filter(|patch| patch.seen == Visibility::Alone);
    let single: Vec<_> = single.map(|patch| (bands.of(patch.stress), patch.corners.clone())).collect();
    bands.fill(svg, &single);
    lines(Visibility::Alone).draw(svg);
    let layered = lines(Visibility::Layered);
    for patch in patches.iter().filter(|patch| patch.seen == Visibility::Layered) {
        svg.region([patch.corners.as_slice()], bands.colour(bands.of(patch.stress)));
        layered.draw_around(svg, &patch.corners);
    }
}

/// Returns the mean of the corners.
fn centre(corners: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|c| corners.iter().map(|corner| corner[c]).sum::<f64>() / corners.len() as f64)
}

/// The projection on the plane of the picture.
struct View {
    right: [f64; 3],
    up: [f64; 3],
    towards: [f64; 3],
}

impl View {
    fn of(dimension: usize) -> Self {
        let [x, y, z] = [0, 1, 2].map(stickslip::algebra::axis);
        if dimension == 2 {
            return View { right: x, up: y, towards: z };
        }
        let towards = unit(VIEWER);
        let right = unit(cross(z, towards));
        View { right, up: cross(towards, right), towards }
    }

    fn project(&self, x: [f64; 3]) -> [f64; 2] {
        [dot(x, self.right), dot(x, self.up)]
    }
}

/// Returns the normal of a facet, not normalised.
fn normal(corners: &[[f64; 3]]) -> [f64; 3] {
    let n = corners.len();
    // For a quadrilateral, the cross product of its diagonals.
    cross(minus(corners[n / 2], corners[0]), minus(corners[n - 1], corners[1]))
}

/// A side shared by facets, with their normals.
struct Joint {
    ends: [[f64; 3]; 2],
    normals: Vec<[f64; 3]>,
}

impl Joint {
    /// Returns `true` if the facets meet at an angle, or there is only one facet.
    fn is_edge(&self) -> bool {
        self.normals.len() == 1 || self.normals.windows(2).any(|pair| dot(pair[0], pair[1]) < EDGE)
    }
}

/// Returns the edges of a surface of `facets` of which at least one adjacent facet is visible.
fn edges(facets: impl Iterator<Item = Vec<[f64; 3]>>, towards: [f64; 3]) -> Vec<[[f64; 3]; 2]> {
    let mut joints: BTreeMap<[[u64; 3]; 2], Joint> = BTreeMap::new();
    for corners in facets {
        let outward = unit(normal(&corners));
        for (k, &a) in corners.iter().enumerate() {
            let ends = [a, corners[(k + 1) % corners.len()]];
            let mut key = ends.map(|x| x.map(f64::to_bits));
            key.sort_unstable();
            joints.entry(key).or_insert(Joint { ends, normals: Vec::new() }).normals.push(outward);
        }
    }
    let is_visible = |joint: &Joint| joint.normals.iter().any(|normal| dot(*normal, towards) > 0.0);
    joints.into_values().filter(|joint| joint.is_edge() && is_visible(joint)).map(|joint| joint.ends).collect()
}

/// Returns the largest 1, 2 or 5 times a power of ten up to `most`, at least 1. Returns 1 for a body that has not
/// moved.
fn readable(most: f64) -> f64 {
    if !most.is_finite() || most < 1.0 {
        return 1.0;
    }
    // The slack absorbs the rounding of logarithms of powers of ten.
    let power = 10.0_f64.powf((most.log10() + 1e-12).floor());
    [5.0, 2.0].map(|k| k * power).into_iter().find(|&k| k <= most).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_can_be_read() {
        let cases = [(0.3, 1.0), (1.0, 1.0), (1.9, 1.0), (2.0, 2.0), (49.0, 20.0), (50.0, 50.0), (1000.0, 1000.0)];
        assert!(cases.into_iter().all(|(most, factor)| readable(most) == factor));
        assert_eq!([f64::INFINITY, f64::NAN].map(readable), [1.0; 2]);
    }

    /// x points to the right, y away, z upwards.
    #[test]
    fn a_body_in_space_stands_upright() {
        let view = View::of(3);
        let [x, y, z] = [0, 1, 2].map(|c| view.project(stickslip::algebra::axis(c)));
        assert!(x[0] > 0.5 && y[0] > 0.0 && z[0].abs() < 1e-15 && z[1] > 0.5 && y[1] > 0.0);
        assert!((dot(cross(view.right, view.up), view.towards) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_cube_shows_the_edges_of_three_faces() {
        let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2].map(|c| c as f64);
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets = faces.into_iter().map(|face: [usize; 4]| face.map(corner).to_vec());
        assert_eq!(edges(facets, View::of(3).towards).len(), 9);
    }
}
