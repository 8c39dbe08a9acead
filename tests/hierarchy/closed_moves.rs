//! Promise: a closed mesh with seams stays closed while its vertices move, whatever the rules it was simplified by: vertices at one
//! point of the input are drawn at one point at every moment.

use std::collections::BTreeMap;

use crate::support::lod::{POLICIES, Random, bake_hierarchy, places, shape};
use multires::adapt::Geomorph;
use multires::lod::{LodOptions, VertexBuffer};
use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::oracle::{Oracle, default_oracles};
use multires::simplify::{Parts, Placement, Simplifier};
use multires::view::Motion;

/// Every triangle with a value of its own where `all`, or one of a few.
fn torn(mesh: &Mesh, all: bool) -> Mesh {
    let corners = mesh.triangles().as_flattened();
    let positions: Vec<[f32; 3]> = corners.iter().map(|&v| mesh.positions()[v as usize]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..mesh.triangles().len() as u32).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect();
    let value = |corner: usize| {
        let triangle = corner / 3;
        if all {
            triangle as f32
        } else {
            (positions[3 * triangle][0] > 0.0) as u8 as f32 + (positions[3 * triangle][1] > 0.3) as u8 as f32
        }
    };
    let values: Vec<[f32; 2]> = (0..corners.len()).map(|corner| [value(corner), 0.0]).collect();
    Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &values)).unwrap()
}

fn without_seam_rules() -> Vec<Box<dyn Oracle>> {
    default_oracles()
        .into_iter()
        .filter(|oracle| !["seam", "uv orientation"].contains(&oracle.name()))
        .collect()
}

#[test]
fn points_stay_together() {
    for (which, all) in [(2, false), (2, true), (7, false), (4, false), (6, true)] {
        let mesh = torn(&shape(which), all);
        for (join, placement) in [
            (0.0, Placement::Endpoint),
            (0.3, Placement::Endpoint),
            (0.3, Placement::Optimal),
            (0.0, Placement::Midpoint),
        ] {
            let simplifier = Simplifier::new().placement(placement).oracles(without_seam_rules());
            let sequence = simplifier.parts(Parts::Keep).join_distance(join).run(&mesh).unwrap();
            for policy in POLICIES {
                let model = bake_hierarchy(&mesh, &sequence, policy);
                let hierarchy = model.structure();
                let mut points: BTreeMap<[u32; 3], Vec<u32>> = BTreeMap::new();
                let of = model.vertices().positions();
                for &leaf in hierarchy.triangles().as_flattened() {
                    let place = of[leaf as usize].map(|x| (x + 0.0).to_bits());
                    points.entry(place).or_default().push(leaf);
                }
                let geomorph = Geomorph::default().with_duration(1.0);
                let options = LodOptions::default().with_buffer(VertexBuffer::Packed).with_geomorph(geomorph);
                let mut lod = model.instance(places(&model), &options).unwrap();
                let mut moved = 0;
                for step in 0..12_u64 {
                    let asked = Random::new(hierarchy, step % 5, [100, 60, 0, 90, 97][step as usize % 5]);
                    for _ in 0..4 {
                        moved += lod.adapt_by(&asked, Motion::Other, 0.17).moving;
                        for wedges in points.values() {
                            let place = |leaf: u32| lod.value(lod.representative(leaf)).unwrap();
                            let first = place(wedges[0]);
                            assert!(
                                wedges.iter().all(|&leaf| place(leaf) == first),
                                "shape {which}, {all}, {join}, {placement:?}, {policy:?}, step {step}: {first:?}, {:?}",
                                wedges.iter().map(|&leaf| place(leaf)).collect::<Vec<_>>()
                            );
                        }
                    }
                }
                assert!(moved > 0);
            }
        }
    }
}
