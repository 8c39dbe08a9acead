//! Advice where no legal collapse was left: tries options, and names only options that get further.
//!
//! The level reached is simplified on with a single option changed, or with all of them if none helps alone. Costs little,
//! since the level is coarse.

use multires::mesh::Mesh;
use multires::simplify::{SimplifyReport, Target};
use serde_json::{Value, json};

use crate::output::Failure;
use crate::rules::{Gives, Place, Rules, Switch};

/// Advice must get to this share of the triangles reached without it.
const WORTH: f64 = 0.95;

/// An option, and the triangles it reaches.
pub struct Advice {
    /// As on the command line, or in words if something is to be left out.
    option: String,
    triangles: usize,
}

/// An option to loosen a rule: the rule's name in the report, the option's text, and its change to the rules.
type Way = (&'static str, String, Box<dyn Fn(&mut Rules)>);

impl Advice {
    /// Finds options to get further than `level`, where a simplification stopped with nothing legal left; best first.
    pub fn find(
        rules: &Rules,
        place: Place,
        report: &SimplifyReport,
        level: &Mesh,
        targets: &[Target],
    ) -> Result<Vec<Self>, Failure> {
        let stands = |oracle: &str| report.refusals.iter().any(|r| r.oracle == oracle && r.standing > 0);
        let mut ways: Vec<Way> = ways(rules, level).into_iter().filter(|way| stands(way.0)).collect();
        ways.dedup_by(|a, b| a.1 == b.1);
        let most = (WORTH * level.triangles().len() as f64) as usize;
        let reached = |changed: &Rules| -> Result<Option<usize>, Failure> {
            let Ok(mesh) = changed.dropped(level.clone()) else { return Ok(None) };
            let mut simplifier = changed.simplifier(place, changed.normals.unwrap_or_default())?;
            for &target in targets {
                simplifier = simplifier.target(target);
            }
            let sequence = simplifier.run(&mesh).map_err(Failure::input)?;
            Ok(Some(sequence.report().triangles).filter(|&triangles| triangles <= most))
        };
        let mut found = Vec::new();
        for (_, option, change) in &ways {
            let mut changed = rules.clone();
            change(&mut changed);
            if let Some(triangles) = reached(&changed)? {
                found.push(Self { option: option.clone(), triangles });
            }
        }
        if found.is_empty() && ways.len() > 1 {
            let mut changed = rules.clone();
            ways.iter().for_each(|way| (way.2)(&mut changed));
            if let Some(triangles) = reached(&changed)? {
                let option = ways.iter().map(|way| way.1.as_str()).collect::<Vec<_>>().join(" and ");
                found.push(Self { option, triangles });
            }
        }
        found.sort_by_key(|advice| advice.triangles);
        Ok(found)
    }

    /// Text for people, to follow the report of the level reached.
    pub fn text(found: &[Self]) -> String {
        let lines: Vec<String> =
            found.iter().map(|a| format!("{} goes on to {} triangles", a.option, a.triangles)).collect();
        if lines.is_empty() { String::new() } else { format!("; tried from there: {}", lines.join(", ")) }
    }

    /// Values for JSON.
    pub fn json(found: &[Self]) -> Vec<Value> {
        found.iter().map(|a| json!({ "option": a.option, "triangles": a.triangles })).collect()
    }
}

/// Returns the options that may loosen rules, each with the name of its rule.
fn ways(rules: &Rules, level: &Mesh) -> Vec<Way> {
    let mut ways: Vec<Way> = Vec::new();
    if rules.lock_borders {
        let change = |rules: &mut Rules| rules.lock_borders = false;
        ways.push(("border", "leaving out --lock-borders".to_owned(), Box::new(change)));
    }
    let names: Vec<String> = level.attributes().iter().map(|a| a.name().to_owned()).collect();
    if !names.is_empty() {
        let option = format!("--drop {}", names.join(","));
        ways.push(("seam", option, Box::new(move |rules| rules.preparation.drop.clone_from(&names))));
    }
    if !level.materials().is_empty() {
        let change = |rules: &mut Rules| rules.preparation.drop.push("material".to_owned());
        ways.push(("material", "--drop material".to_owned(), Box::new(change)));
    }
    if rules.keep_parts {
        for rule in ["link", "parts"] {
            let change = |rules: &mut Rules| rules.keep_parts = false;
            ways.push((rule, "leaving out --keep-parts".to_owned(), Box::new(change)));
        }
    }
    if rules.join_distance == 0.0 {
        // A fiftieth of the diagonal, of two digits.
        let distance = 0.02 * level.diagonal();
        let digit = 10f64.powi(distance.log10().floor() as i32 - 1);
        let distance = (distance / digit).round() * digit;
        if distance.is_finite() && distance > 0.0 {
            let change = move |rules: &mut Rules| rules.join_distance = distance;
            ways.push(("link", format!("--join-distance {distance:.2e}"), Box::new(change)));
        }
    }
    if rules.max_turn < 180.0 {
        let change = |rules: &mut Rules| rules.max_turn = 180.0;
        ways.push(("normal flip", "--max-turn 180".to_owned(), Box::new(change)));
    }
    if rules.guard == Switch::On {
        let change = |rules: &mut Rules| rules.guard = Switch::Off;
        ways.push(("guard", "--guard off (what is left loses its shape)".to_owned(), Box::new(change)));
    }
    if rules.permissive == Gives::Off {
        for rule in ["seam", "material", "border", "non-manifold", "link"] {
            let change = |rules: &mut Rules| rules.permissive = Gives::Auto;
            ways.push((rule, "--permissive auto".to_owned(), Box::new(change)));
        }
    }
    if rules.keep_apart {
        let change = |rules: &mut Rules| rules.keep_apart = false;
        ways.push(("self-intersection", "leaving out --keep-apart".to_owned(), Box::new(change)));
    }
    ways
}
