//! Describes meshes and bodies.

use stickslip::base::Quantity;
use stickslip::body::Model;
use stickslip::body::mesh::{HalfPlane, MeshSource, Segment};

/// Describes how the mesh of `model`, or of one of its bodies, is made.
pub(super) fn made(source: &MeshSource, model: &Model) -> String {
    let units = model.units();
    let length = |x: f64| units.text(Quantity::Length, x);
    match source {
        MeshSource::Block { axes, origin, .. } => {
            let each = |value: &dyn Fn(&Segment) -> String, within: &str, between: &str| {
                let along = |axis: &Vec<Segment>| match &axis[..] {
                    [segment] => value(segment),
                    all => format!("({})", all.iter().map(value).collect::<Vec<_>>().join(within)),
                };
                axes.iter().map(along).collect::<Vec<_>>().join(between)
            };
            let lengths = each(&|segment| length(segment.length), " + ", " x ");
            let elements = each(&|segment| segment.elements.to_string(), " + ", " x ");
            let graded = if axes.iter().flatten().all(|segment| segment.grading == 1.0) {
                String::new()
            } else {
                format!(" (graded {})", each(&|segment| format!("1 : {}", segment.grading), ", ", ", "))
            };
            let from = origin.map_or(String::new(), |x| format!(" from {}", units.point(x.components())));
            format!("block {lengths}{from}, {elements}{graded}")
        }
        MeshSource::HalfPlane(HalfPlane {
            size: [width, height], contact_elements, outer_elements, layers, ..
        }) => {
            let (width, height) = (length(*width), length(*height));
            format!("half-plane {width} x {height}, ({contact_elements} + {outer_elements}) x {layers}")
        }
        MeshSource::File { file, scale, .. } => {
            // The extent reveals a forgotten scale. Six digits hide the rounding of a difference.
            let extent = |x: &f64| {
                let value = units.of_si(Quantity::Length, *x);
                let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
                format!("{rounded} {}", units.name(Quantity::Length))
            };
            let lengths = model.mesh.extent()[..model.mesh.dimension].iter().map(extent).collect::<Vec<_>>();
            format!("{}, unit {}, {} over all,", file.display(), length(*scale), lengths.join(" x "))
        }
        MeshSource::Given(_) => "given".to_string(),
        MeshSource::Bodies(bodies) => match bodies.len() {
            1 => "1 body,".to_string(),
            n => format!("{n} bodies,"),
        },
    }
}

/// Lists the bodies of a mesh, if there may be several, with their nodes and elements.
pub(super) fn bodies(source: &MeshSource, model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    let bodies = model.mesh.bodies();
    if let MeshSource::Bodies(given) = source {
        for body in given {
            let at = body.at.map_or(String::new(), |at| format!(", put at {}", model.units().point(at.components())));
            let made = match &body.mesh {
                MeshSource::File { file, scale, .. } => {
                    format!("{}, unit {}", file.display(), model.units().text(Quantity::Length, *scale))
                }
                other => made(other, model),
            };
            lines.push(format!("body         {}: {made}{at}", body.name));
        }
    }
    if bodies.are_several() {
        for (k, name) in bodies.names().iter().enumerate() {
            let (nodes, cells) = (bodies.nodes(k).count(), bodies.cells(k).count());
            lines.push(format!("             {name}: {nodes} nodes, {cells} elements"));
        }
    }
    lines
}
