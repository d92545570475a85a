//! The scene file as it stands, with the place of every value that is checked later.

use serde::Deserialize;
use toml::Spanned;

use super::error::Source;
use super::{LinearBackend, Method, Plane, SceneError, Setting};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    pub title: Option<String>,
    pub mesh: Mesh,
    pub material: Material,
    #[serde(default)]
    pub support: Vec<Support>,
    #[serde(default)]
    pub contact: Vec<Contact>,
    #[serde(default)]
    pub load: Vec<Load>,
    pub time: Time,
    #[serde(default)]
    pub solver: Solver,
    #[serde(default)]
    pub output: Output,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum MeshKind {
    Block,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mesh {
    pub kind: MeshKind,
    pub size: Spanned<[f64; 2]>,
    pub elements: Spanned<[i64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Material {
    pub young: Spanned<f64>,
    pub poisson: Spanned<f64>,
    #[serde(default)]
    pub plane: Plane,
}

#[derive(Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
pub(super) enum Direction {
    X,
    Y,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Support {
    pub boundary: Spanned<String>,
    pub fix: Spanned<Vec<Direction>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Contact {
    pub boundary: Spanned<String>,
    pub friction: Spanned<f64>,
    pub obstacle: Obstacle,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ObstacleKind {
    Plane,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Obstacle {
    pub kind: ObstacleKind,
    pub gap: Option<Spanned<f64>>,
    pub normal: Option<Spanned<[f64; 2]>>,
    pub tangent: Option<Spanned<[f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Load {
    pub boundary: Spanned<String>,
    pub traction: Spanned<[f64; 2]>,
    pub history: Option<Spanned<Vec<[f64; 2]>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Time {
    pub end: Spanned<f64>,
    pub increments: Spanned<i64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Solver {
    #[serde(default)]
    pub method: Method,
    #[serde(default)]
    pub setting: Setting,
    #[serde(default)]
    pub linear: LinearBackend,
    pub max_iterations: Option<Spanned<i64>>,
    pub tolerance: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Output {
    pub times: Option<Spanned<Vec<f64>>>,
}

impl Document {
    pub(super) fn parse(source: &Source) -> Result<Self, SceneError> {
        toml::from_str(&source.text).map_err(|error| {
            let message = error.message().trim().replace('\n', ", ");
            let help = match message.split(' ').take(2).collect::<Vec<_>>()[..] {
                ["unknown", "field"] => "remove the key or correct its spelling",
                ["missing", "field"] => "add the key; data/scenes/block.toml shows a complete scene",
                ["unknown", "variant"] => "use one of the values it lists",
                ["invalid", "type:" | "length" | "value:"] => "data/scenes/block.toml shows the form of every value",
                _ => "mend the TOML here",
            };
            source.error(error.span().unwrap_or(0..0), message, help)
        })
    }
}
