//! The arguments of `fly`.

use std::error::Error;
use std::path::PathBuf;

use multires::hierarchy::Dependencies;
use multires::mesh::shapes;

use crate::input::{self, Input};
use crate::number;
use crate::subdivide::subdivide;

/// Every policy by its name.
const POLICIES: [(&str, Dependencies); 4] = [
    ("none", Dependencies::None),
    ("manifold", Dependencies::Manifold),
    ("adjacent", Dependencies::Adjacent),
    ("neighbours", Dependencies::Neighbours),
];

/// What to fly past, and how.
pub(crate) struct Options {
    models: Vec<PathBuf>,
    pub path: Option<PathBuf>,
    pub tolerance: f32,
    subdivide: u32,
    pub dependencies: Vec<(&'static str, Dependencies)>,
    pub optimal: bool,
    pub still_path: bool,
    pub rounds: usize,
    pub json: bool,
}

impl Options {
    pub fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            models: Vec::new(),
            path: None,
            tolerance: 1.0,
            subdivide: 0,
            dependencies: POLICIES.to_vec(),
            optimal: false,
            still_path: false,
            rounds: 5,
            json: false,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--path" => options.path = Some(value()?.into()),
                "--tolerance" => options.tolerance = number(&argument, &value()?, 1e-3..=1e3)?,
                "--subdivide" => options.subdivide = number(&argument, &value()?, 0..=4)?,
                "--rounds" => options.rounds = number(&argument, &value()?, 1..=1000)?,
                "--dependencies" => {
                    options.dependencies = value()?.split(',').map(policy).collect::<Result<_, _>>()?;
                }
                "--optimal" => options.optimal = true,
                "--still-path" => options.still_path = true,
                "--json" => options.json = true,
                unknown if unknown.starts_with('-') => return Err(format!("there is no option {unknown}")),
                model => options.models.push(model.into()),
            }
        }
        Ok(options)
    }

    /// The models named, or the demo; without attributes, welded.
    pub fn inputs(&self) -> Result<Vec<Input>, Box<dyn Error>> {
        let mut inputs = Vec::new();
        for path in &self.models {
            inputs.push(input::read(path).map_err(|e| format!("{}: {e}", path.display()))?);
        }
        if inputs.is_empty() {
            inputs.push(Input { name: "demo".to_owned(), mesh: input::welded(shapes::demo())? });
        }
        for input in &mut inputs {
            input.mesh = subdivide(std::mem::take(&mut input.mesh), self.subdivide)?;
        }
        Ok(inputs)
    }
}

fn policy(name: &str) -> Result<(&'static str, Dependencies), String> {
    POLICIES.into_iter().find(|policy| policy.0 == name).ok_or_else(|| {
        format!(
            "there are no dependencies {name:?}; there are: {}",
            POLICIES.map(|policy| policy.0).join(", ")
        )
    })
}
