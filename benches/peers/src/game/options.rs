//! The arguments of `game` and of `reach`.

use std::path::PathBuf;

use crate::number;

/// What to measure.
pub(crate) struct Options {
    pub models: Vec<PathBuf>,
    pub generated: bool,
    pub percents: Vec<f64>,
    pub runs: usize,
    pub samples: usize,
    pub only: Vec<String>,
    /// What normals, a texture that slides and colours weigh for ours; customary where not given.
    pub weights: Option<[f32; 3]>,
    pub out: Option<PathBuf>,
    /// The side from which pictures are written, 0 to 11.
    pub view: usize,
    pub json: bool,
}

impl Options {
    pub(crate) fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self {
            models: Vec::new(),
            generated: false,
            percents: vec![50.0, 25.0, 10.0],
            runs: 1,
            samples: super::SAMPLES,
            only: Vec::new(),
            weights: None,
            out: None,
            view: 0,
            json: false,
        };
        while let Some(argument) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
            match argument.as_str() {
                "--generated" => options.generated = true,
                "--runs" => options.runs = number(&argument, &value()?, 1..=1_000_000)?,
                "--samples" => options.samples = number(&argument, &value()?, 100..=100_000_000)?,
                "--percent" => {
                    options.percents = value()?
                        .split(',')
                        .map(|p| number(&argument, p, 0.0..=100.0))
                        .collect::<Result<_, _>>()?;
                }
                "--only" => options.only.extend(value()?.split(',').map(str::to_owned)),
                "--weights" => {
                    let text = value()?;
                    let weights: Vec<f32> = text
                        .split(',')
                        .map(|w| number(&argument, w, 0.0..=1000.0))
                        .collect::<Result<_, _>>()?;
                    let weights = weights.try_into();
                    options.weights = Some(weights.map_err(|_| format!("{argument} takes three numbers"))?);
                }
                "--out" => options.out = Some(value()?.into()),
                "--view" => options.view = number(&argument, &value()?, 0..=11)?,
                "--json" => options.json = true,
                unknown if unknown.starts_with('-') => return Err(format!("there is no option {unknown}")),
                model => options.models.push(model.into()),
            }
        }
        if options.models.is_empty() && !options.generated {
            return Err("name at least one model, or --generated".to_owned());
        }
        super::contender::check_names(&options.only)?;
        Ok(options)
    }
}
