//! Pictures of a contact surface: patches coloured by pressure, arrows for the tangential traction, borders between
//! stick, slip and open zones.

mod key;
mod view;

use super::largest::first_largest;
use super::mesh_lines::MeshLines;
use super::svg::{BLACK, Colour, GREY, Line, Marker, NUMBER_SIZE, PlotError, Svg, THIN, WHITE, expect_finite};
use crate::{ContactSurface, SurfaceNode};
use std::collections::BTreeMap;
use stickslip::base::{Quantity, six_digits};
use stickslip::solver::ContactStatus;
use view::View;

const HELD: Colour = [176, 176, 176];
const ALONE: Colour = [216, 216, 216];
const TANGENTIAL: Colour = [205, 80, 10];

impl ContactSurface {
    /// Returns the part of the surface in contact, and a little around it, as an SVG picture. A patch is a node's part
    /// of its facets; its colour is the pressure there. Arrows are the traction of the body on the obstacle.
    ///
    /// # Errors
    /// When a stress is not finite.
    pub fn to_svg(&self, title: &str) -> Result<String, PlotError> {
        let values = self.nodes.iter().flat_map(|node| [node.pressure, node.traction[0], node.traction[1]]);
        expect_finite(values)?;
        let surface = self.in_units();
        let view = View::new(&surface);
        let boundary = self.boundary.as_ref().map_or(String::new(), |name| format!("boundary {name}, "));
        let subtitle = format!("contact stresses, {boundary}t = {} s", six_digits(self.time));
        let mut svg = Svg::headed(view.end(), title, &subtitle);
        view.draw_legend(&mut svg);
        view.draw_inside(&mut svg, |svg| {
            surface.draw_patches(svg, &view);
            surface.draw_borders(svg, &view);
        });
        view.draw_frame(&mut svg, &self.axes);
        surface.draw_nodes(&mut svg, &view);
        surface.mark_largest(&mut svg, &view);
        view.draw_colours(&mut svg);
        Ok(svg.finish())
    }

    /// Converts coordinates and stresses to the units of the picture.
    fn in_units(&self) -> Self {
        let units = self.units.of_pictures();
        let [length, stress] = [Quantity::Length, Quantity::Stress].map(|quantity| move |x| units.of_si(quantity, x));
        let node = |node: &SurfaceNode| SurfaceNode {
            position: node.position.map(length),
            pressure: stress(node.pressure),
            traction: node.traction.map(stress),
            ..*node
        };
        let nodes = self.nodes.iter().map(node).collect();
        ContactSurface { units, nodes, degree: self.degree.map(length), ..self.clone() }
    }

    /// Returns the corners of each node's part of each facet: the node, the middle of a side, the centre, and the
    /// middle of the other side.
    fn patches(&self) -> impl Iterator<Item = (&SurfaceNode, [[f64; 2]; 4])> {
        self.parts().flat_map(move |part| {
            let (n, centre) = (part.len(), self.centre(&part));
            (0..n).map(move |k| {
                let [here, next, last] = [k, k + 1, k + n - 1].map(|k| self.nodes[part[k % n]].position);
                (&self.nodes[part[k]], [here, middle(here, next), centre, middle(here, last)])
            })
        })
    }

    /// Returns the parts of the facets: a triangle of second order is four triangles, every other facet is one part.
    fn parts(&self) -> impl Iterator<Item = Vec<usize>> {
        self.facets.iter().flat_map(|facet| match facet[..] {
            [a, ab, b, bc, c, ca] => vec![vec![a, ab, ca], vec![ab, b, bc], vec![ca, bc, c], vec![ab, bc, ca]],
            _ => vec![facet.clone()],
        })
    }

    /// Returns the sides that belong to one facet only.
    fn outline(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let mut facets: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for facet in &self.facets {
            for (&a, &b) in facet.iter().zip(facet.iter().cycle().skip(1)) {
                *facets.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let once = facets.into_iter().filter(|(_, facets)| *facets == 1);
        once.map(|(side, _)| side.map(|node| self.nodes[node].position))
    }

    fn centre(&self, facet: &[usize]) -> [f64; 2] {
        [0, 1].map(|c| facet.iter().map(|&node| self.nodes[node].position[c]).sum::<f64>() / facet.len() as f64)
    }

    fn draw_patches(&self, svg: &mut Svg, view: &View) {
        let patches: Vec<_> = self.patches().filter(|(_, corners)| view.shows(corners)).collect();
        let placed = |corners: &[[f64; 2]; 4]| corners.map(|corner| view.at(corner)).to_vec();
        let without = |wanted: fn(&SurfaceNode) -> bool| {
            let own = patches.iter().filter(move |(node, _)| node.pressure <= 0.0 && wanted(node));
            own.map(|(_, corners)| placed(corners)).collect::<Vec<_>>()
        };
        for (wanted, colour) in [
            ((|node| node.status.is_some()) as fn(&SurfaceNode) -> bool, WHITE),
            (|node| node.status.is_none() && node.held, HELD),
            (|node| node.status.is_none() && !node.held, ALONE),
        ] {
            svg.region(without(wanted).iter().map(Vec::as_slice), colour);
        }
        // The two sides of a surface around the body overlap in the picture. Pressed patches are drawn on top.
        let pressed = patches.iter().filter(|(node, _)| node.pressure > 0.0);
        let pressed: Vec<_> = pressed.map(|(node, corners)| (view.bands.of(node.pressure), placed(corners))).collect();
        view.bands.fill(svg, &pressed);
        let facets = self.facets.iter().map(|facet| facet.iter().map(|&node| self.nodes[node].position).collect());
        let facets: Vec<Vec<[f64; 2]>> = facets.filter(|facet: &Vec<_>| view.shows(facet)).collect();
        let facets: Vec<Vec<[f64; 2]>> =
            facets.iter().map(|facet| facet.iter().map(|corner| view.at(*corner)).collect()).collect();
        MeshLines::of(facets.iter().map(Vec::as_slice)).draw(svg);
    }

    /// Draws the outline of the surface, and lines between patches of different contact status.
    fn draw_borders(&self, svg: &mut Svg, view: &View) {
        let placed = |line: [[f64; 2]; 2]| line.map(|point| view.at(point));
        svg.segments(self.outline().filter(|ends| view.shows(ends)).map(placed), THIN, GREY);
        let closed = |node: &SurfaceNode| node.status.is_some_and(|status| status != ContactStatus::Open);
        let mut borders = Vec::new();
        for part in self.parts() {
            let n = part.len();
            let node = |k: usize| &self.nodes[part[k % n]];
            let centre = self.centre(&part);
            for k in 0..n {
                let (a, b) = (node(k), node(k + 1));
                let line = [middle(a.position, b.position), centre];
                // Without friction, stick and slip are equivalent.
                let differ = if view.friction() { a.status != b.status } else { closed(a) != closed(b) };
                if differ && view.shows(&line) {
                    borders.push(placed(line));
                }
            }
        }
        for (width, colour) in [(4.0, WHITE), (1.8, BLACK)] {
            svg.segments(borders.iter().copied(), Line { width, ..THIN }, colour);
        }
    }

    /// Marks the node with the largest pressure, if there is pressure: the first one if several have it within rounding.
    fn mark_largest(&self, svg: &mut Svg, view: &View) {
        if let Some(node) = first_largest(self.nodes.iter().map(|node| node.pressure)).map(|k| &self.nodes[k]) {
            let text = self.units.rounded(Quantity::Stress, self.units.to_si(Quantity::Stress, node.pressure), 4);
            svg.mark(view.at(node.position), &text, NUMBER_SIZE, view.at(view.middle())[0]);
        }
    }

    /// Draws the status of each node, and its traction if there is room for an arrow.
    fn draw_nodes(&self, svg: &mut Svg, view: &View) {
        if !view.friction() {
            return;
        }
        let mut arrows: Vec<([f64; 2], [f64; 2])> = Vec::new();
        for node in self.nodes.iter().filter(|node| view.shows(&[node.position])) {
            let at = view.at(node.position);
            let marker = match node.status {
                Some(ContactStatus::Stick) => Some(Marker::Disc),
                Some(ContactStatus::Slip) => Some(Marker::Circle),
                Some(ContactStatus::Open) | None => None,
            };
            match marker.filter(|_| view.markers) {
                Some(Marker::Disc) => svg.disc(at, BLACK),
                Some(marker) => svg.marker(at, marker, BLACK),
                None => {}
            }
            // If nodes are close, some of them have no arrow.
            let room = arrows.iter().all(|(other, _)| (at[0] - other[0]).hypot(at[1] - other[1]) > 0.7 * view.arrow);
            if room && node.traction != [0.0; 2] {
                let [right, up] = node.traction.map(|stress| stress / view.most_traction * view.arrow);
                arrows.push((at, [right, -up]));
            }
        }
        for (at, along) in arrows {
            arrow(svg, at, along);
        }
    }
}

/// Draws an arrow from a point along a vector, px, with a white edge.
fn arrow(svg: &mut Svg, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) {
    let length = dx.hypot(dy);
    // Shorter than its own width.
    if length < 1.5 {
        return;
    }
    let (ex, ey) = (dx / length, dy / length);
    let head = (0.45 * length).min(11.0);
    let at = |along: f64, aside: f64| [x + along * ex - aside * ey, y + along * ey + aside * ex];
    let (shaft, wide) = (f64::min(1.4, 0.2 * head), 0.45 * head);
    let outline = [(0.0, shaft), (length - head, shaft), (length - head, wide), (length, 0.0)];
    let back = outline.into_iter().rev().skip(1).map(|(along, aside)| (along, -aside));
    let corners: Vec<[f64; 2]> = outline.into_iter().chain(back).map(|(along, aside)| at(along, aside)).collect();
    svg.edged(&corners, TANGENTIAL);
}

fn middle(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::base::UnitSystem;

    /// A triangle of second order is divided between its six nodes: a corner has a twelfth of it, the middle of a side a
    /// quarter. No part reaches across the element.
    #[test]
    fn nodes_of_a_triangle_of_second_order_have_their_surroundings() {
        let places = [[0.0, 0.0], [3.0, 0.0], [6.0, 0.0], [3.0, 3.0], [0.0, 6.0], [0.0, 3.0]];
        let node = |position| SurfaceNode { position, pressure: 1e6, traction: [0.0; 2], status: None, held: false };
        let surface = ContactSurface {
            boundary: None,
            index: 1,
            time: 1.0,
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            degree: None,
            nodes: places.map(node).to_vec(),
            facets: vec![(0..6).collect()],
            units: UnitSystem::si(3),
        };
        let mut areas = [0.0; 6];
        for (node, corners) in surface.patches() {
            let around = corners.iter().zip(corners.iter().cycle().skip(1));
            let area = 0.5 * around.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>();
            areas[places.iter().position(|place| *place == node.position).unwrap()] += area;
            assert!(area > 0.0 && corners.iter().all(|corner| (corner[0] - node.position[0]).abs() < 2.5));
        }
        assert_eq!(areas, [1.5, 4.5, 1.5, 4.5, 1.5, 4.5]);
        assert_eq!(surface.outline().count(), 6);
    }
}
