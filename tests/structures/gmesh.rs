//! Promises of a g-mesh: levels are images of each other, states turn into each other without a jump, errors hold, seams stay
//! closed, and bad parts are refused.

use std::collections::BTreeMap;

use multires::gmesh::{
    DistanceRange, Gmesh, GmeshBuilder, GmeshError, GmeshOptions, GmeshParts, Morph, Partition,
};
use multires::lod::{Baked, FromSequence, Level, Lod, LodOptions, Structure, VertexBuffer};
use multires::mesh::{Mesh, Report, names, shapes};
use multires::simplify::{Independence, Order, Placement, Simplifier, Target};
use multires::view::{View, look_at};
use proptest::prelude::*;

/// Meshes of every kind, of about `n` triangles.
fn shape(kind: usize, n: u32, seed: u32) -> Mesh {
    match kind {
        0 => shapes::rock(n, seed),
        1 => shapes::gravel(2 + n / 60, seed),
        2 => shapes::prop(4 + n / 200),
        3 => shapes::robot(4 + n / 400),
        4 => shapes::cad_part(seed),
        5 => shapes::soup(4 + n / 20, seed),
        6 => shapes::tree(3 + n / 60),
        _ => shapes::torus(1.0, 0.3, 4 + n / 40, 10),
    }
}

const KINDS: usize = 8;

fn simplifier(place: usize, order: usize) -> Simplifier {
    let place = [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal][place];
    let simplifier = Simplifier::new().placement(place);
    match order {
        0 => simplifier,
        1 => simplifier.order(Order::Batched),
        2 => simplifier.order(Order::Batched).independence(Independence::Domain),
        _ => simplifier.order(Order::Batched).independence(Independence::Matching),
    }
}

fn bake(mesh: &Mesh, place: usize, order: usize, share: f32) -> Baked<Gmesh> {
    let builder = GmeshBuilder::new().simplifier(simplifier(place, order));
    builder.options(GmeshOptions::default().with_share(share)).bake(mesh).unwrap()
}

/// The triangles of all groups of a level.
fn triangles(gmesh: &Gmesh, level: usize) -> Vec<[u32; 3]> {
    (0..gmesh.groups()).flat_map(|group| gmesh.triangles(level, group)).copied().collect()
}

fn is_degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum::<f64>().sqrt()
}

/// Triangles by the positions of their corners, from whichever corner they start.
fn by_place(mesh: &Mesh) -> BTreeMap<[[u32; 3]; 3], usize> {
    let mut count = BTreeMap::new();
    for triangle in mesh.triangles() {
        let mut corners = triangle.map(|v| mesh.positions()[v as usize].map(|x| (x + 0.0).to_bits()));
        let least = (0..3).min_by_key(|&i| corners[i]).unwrap();
        corners.rotate_left(least);
        if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
            *count.entry(corners).or_default() += 1;
        }
    }
    count
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// What is drawn does not jump where levels meet, in position or in any attribute.
    #[test]
    fn levels_meet_without_a_jump(
        kind in 0..KINDS, n in 30_u32..2000, seed in 0_u32..99, place in 0_usize..4, order in 0_usize..4, share in 0.2_f32..0.9,
    ) {
        let mesh = shape(kind, n, seed);
        let model = bake(&mesh, place, order, share);
        let gmesh = model.structure();
        let diagonal = mesh.diagonal();
        let rows: Vec<usize> = (0..gmesh.vertex_count()).collect();
        let positions = model.vertices().positions();
        for level in 0..gmesh.levels().len() {
            let all = triangles(gmesh, level);
            let prefix = gmesh.levels()[level].vertices as u32;
            prop_assert!(all.iter().all(|t| !is_degenerate(*t) && t.iter().all(|&v| v < prefix)));
            prop_assert_eq!(all.len(), gmesh.levels()[level].triangles);
            if level + 1 == gmesh.levels().len() {
                prop_assert!(gmesh.moving(level).is_empty());
                continue;
            }
            // The same vertices at the end of the way, for every triangle that the next level has.
            let image = |t: [u32; 3]| t.map(|v| {
                if gmesh.moving(level).contains(&(v as usize)) { gmesh.targets()[v as usize] } else { v }
            });
            let images = all.iter().map(|&t| image(t)).filter(|t| !is_degenerate(*t));
            prop_assert!(images.eq(triangles(gmesh, level + 1)));
            // Just before the swap every drawn point is where it will be.
            let mut drawn = Vec::new();
            gmesh.fill(positions, Morph { level, share: 1.0 - f32::EPSILON }, &mut drawn);
            let mut ids: Vec<f32> = Vec::new();
            let own: Vec<f32> = rows.iter().map(|&row| row as f32).collect();
            gmesh.fill(&own, Morph { level, share: 1.0 }, &mut ids);
            for t in &all {
                for (&v, to) in t.iter().zip(image(*t)) {
                    prop_assert!(distance(drawn[v as usize], positions[to as usize]) <= 1e-6 * diagonal);
                    // At the end, exactly: whatever a vertex carries is its target's.
                    prop_assert_eq!(ids[v as usize], to as f32);
                }
            }
        }
    }

    /// The ends are exact, and levels are what the sequence has after their batches.
    #[test]
    fn levels_are_those_of_the_sequence(
        kind in 0..KINDS, n in 30_u32..1500, seed in 0_u32..99, place in 0_usize..4, order in 0_usize..4,
    ) {
        let mesh = shape(kind, n, seed);
        let sequence = simplifier(place, order).run(&mesh).unwrap();
        let model = Baked::<Gmesh>::of_sequence(&mesh, &sequence, &GmeshOptions::default()).unwrap();
        let gmesh = model.structure();
        let mut steps = 0;
        for (level, facts) in gmesh.levels().iter().enumerate() {
            let at = model.mesh_at(Morph { level, share: 0.0 });
            let wanted = by_place(&at);
            if level > 0 {
                // The first number of steps with this level's triangles. Input triangles without area count there too.
                steps = steps.max(sequence.steps_for_triangles(at.triangles().len() + mesh.triangles().len() - gmesh.levels()[0].triangles));
                while by_place(&sequence.extract(&mesh, steps)) != wanted {
                    steps += 1;
                    prop_assert!(steps <= sequence.len(), "level {} is not of the sequence", level);
                }
            }
            prop_assert!(facts.error >= sequence.error_after(steps) || level == 0);
            prop_assert_eq!(facts.volume, at.volume());
        }
        prop_assert!(steps == sequence.len() || gmesh.levels().len() == 1
            || by_place(&sequence.extract(&mesh, sequence.len())) == by_place(&sequence.extract(&mesh, steps)));
    }

    /// A closed surface stays closed on the way: wedges of a point move together.
    #[test]
    fn seams_stay_closed_on_the_way(seed in 0_u32..99, place in 0_usize..4, t in 0.0_f32..1.0, kind in 0_usize..2) {
        let mesh = if kind == 0 { shapes::prop(6) } else { shapes::robot(6) };
        let before = Report::welded(&mesh);
        let model = bake(&mesh, place, 3, 0.65);
        let state = Partition::even(model.structure().levels().len()).at(t + seed as f32 * 1e-3);
        let drawn = model.mesh_at(state);
        if before.border_edges == 0 {
            prop_assert_eq!(Report::welded(&drawn).border_edges, 0);
        }
    }

    #[test]
    fn partitions_rise_and_states_follow(
        lengths in proptest::collection::vec(0.01_f32..10.0, 0..12), ts in proptest::collection::vec(-0.5_f32..1.5, 1..50),
    ) {
        let partition = Partition::by_lengths(&lengths).unwrap();
        let starts = partition.starts();
        prop_assert!(starts.len() == lengths.len() + 1 && starts[0] == 0.0);
        prop_assert!(starts.windows(2).all(|pair| pair[0] < pair[1]));
        prop_assert!(lengths.is_empty() || starts[lengths.len()] == 1.0);
        let mut ts = ts;
        ts.sort_by(f32::total_cmp);
        let position = |t: f32| { let m = partition.at(t); m.level as f32 + m.share };
        prop_assert!(ts.windows(2).all(|pair| position(pair[0]) <= position(pair[1])));
        for t in ts {
            prop_assert!((0.0..1.0).contains(&partition.at(t).share));
            let back = partition.t_of(partition.at(t));
            let clamped = if lengths.is_empty() { 0.0 } else { t.clamp(0.0, 1.0) };
            prop_assert!((back - clamped).abs() < 1e-6);
        }
        for (level, &start) in starts.iter().enumerate() {
            prop_assert_eq!(partition.at(start), Morph { level, share: 0.0 });
        }
    }

    /// Parts with anything changed are refused or make a mesh that draws without a panic.
    #[test]
    fn damaged_parts_do_no_harm(seed in 0_u32..99, hits in proptest::collection::vec((0_usize..7, any::<u32>(), any::<u32>()), 1..4)) {
        let mesh = shapes::prop(4);
        let model = bake(&mesh, (seed % 4) as usize, 3, 0.65);
        let mut parts = GmeshParts::from((**model.structure()).clone());
        prop_assert_eq!(&Gmesh::try_from(parts.clone()).unwrap(), &**model.structure());
        for (what, at, value) in hits {
            let put = |list: &mut Vec<u32>| {
                let at = at as usize % (list.len() + 1);
                if at == list.len() { list.push(value % 500) } else { list[at] = value % (list.len() as u32 + 2) }
            };
            match what {
                0 => put(&mut parts.level_vertices),
                1 => { let at = at as usize % parts.level_errors.len(); parts.level_errors[at] = f32::from_bits(value) }
                2 => put(&mut parts.targets),
                3 => { let at = at as usize % parts.triangles.len(); parts.triangles[at][(value % 3) as usize] = value / 3 % 600 }
                4 => put(&mut parts.group_ends),
                5 => put(&mut parts.material_ids),
                _ => { parts.level_errors.pop(); }
            }
        }
        if let Ok(gmesh) = Gmesh::try_from(parts) {
            let mut drawn = Vec::new();
            let values: Vec<f32> = (0..gmesh.vertex_count()).map(|v| v as f32).collect();
            for level in 0..gmesh.levels().len() + 1 {
                gmesh.fill(&values, Morph { level, share: 0.5 }, &mut drawn);
                let known = drawn.len() as u32;
                prop_assert!(triangles(&gmesh, level).as_flattened().iter().all(|&v| v < known));
            }
        }
    }
}

#[test]
fn a_model_takes_few_levels_and_little_memory() {
    let mesh = shapes::rock(10_000, 1);
    let build = |place| {
        let simplifier = simplifier(place, 3).target(Target::Triangles(200));
        GmeshBuilder::new().simplifier(simplifier).bake(&mesh).unwrap()
    };
    let model = build(0);
    let levels = model.structure().levels();
    assert!((5..=8).contains(&levels.len()), "{levels:?}");
    assert!(levels.last().unwrap().triangles <= 200);
    // Position, normal and texture coordinates.
    let vertex = 32;
    let plain = vertex * mesh.positions().len() + 12 * mesh.triangles().len();
    let ratio = model.structure().memory(vertex) as f64 / plain as f64;
    assert!(ratio <= 2.6, "{ratio}");
    // With 16-bit indices in both.
    let short = |bytes: usize, triangles: usize| (bytes - 6 * triangles) as f64;
    let all: usize = levels.iter().map(|level| level.triangles).sum();
    let ratio = short(model.structure().memory(vertex), all) / short(plain, mesh.triangles().len());
    assert!(ratio <= 2.2, "{ratio}");
}

#[test]
fn errors_of_states_hold_against_samples() {
    for mesh in [shapes::rock(3_000, 2), shapes::torus(1.0, 0.4, 60, 30)] {
        let model = bake(&mesh, 0, 3, 0.65);
        let gmesh = model.structure();
        for level in 0..gmesh.levels().len() - 3 {
            for share in [0.0, 0.25, 0.5, 0.75] {
                let morph = Morph { level, share };
                let bound = gmesh.error(morph);
                let [low, high] = [level, level + 1].map(|level| gmesh.levels()[level].error);
                assert_eq!(bound, if share == 0.0 { low } else { high });
                #[cfg(feature = "quality")]
                {
                    let options = multires::quality::DistanceOptions::default().with_samples(20_000);
                    let apart = multires::quality::distance(&mesh, &model.mesh_at(morph), &options).unwrap();
                    let most = f64::from(bound) * 1.3 + 1e-6 * mesh.diagonal();
                    assert!(apart.hausdorff() <= most, "{morph:?}: {} beyond {most}", apart.hausdorff());
                }
            }
        }
    }
}

/// Parts of a heap vanish where they are: no vertex flies to another part.
#[test]
fn vanishing_parts_shrink_in_place() {
    let mesh = shapes::gravel(60, 4);
    let model = bake(&mesh, 0, 3, 0.65);
    let gmesh = model.structure();
    let positions = model.vertices().positions();
    // The largest stone; stones lie apart by about as much.
    let stone = mesh.triangles().iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
    let edge = stone.map(|[a, b]| distance(mesh.positions()[a as usize], mesh.positions()[b as usize]));
    let edge = edge.fold(0.0, f64::max);
    let mut parts = vec![usize::MAX; gmesh.vertex_count()];
    let mut changed = true;
    for (v, part) in parts.iter_mut().enumerate() {
        *part = v;
    }
    while changed {
        changed = false;
        for t in triangles(gmesh, 0) {
            let least = t.iter().map(|&v| parts[v as usize]).min().unwrap();
            for v in t {
                changed |= parts[v as usize] != least;
                parts[v as usize] = least;
            }
        }
    }
    assert!(gmesh.levels().last().unwrap().triangles < 60, "some stones vanish: {edge}");
    for (v, &target) in gmesh.targets().iter().enumerate() {
        assert_eq!(parts[v], parts[target as usize], "{:?} flies to another stone", positions[v]);
    }
}

/// All of a vanishing part goes to its vertex nearest to what it is merged into, whichever of its vertices remains longest.
#[test]
fn a_vanishing_part_shrinks_towards_its_heir() {
    let rock = shapes::rock(2_000, 3);
    let size = rock.diagonal() as f32;
    for nearest in 0..4 {
        // A small tetrahedron far to the right, one corner of which is nearer to the rock.
        let corners: [[f32; 3]; 4] = [[0.0; 3], [0.002, 0.0, 0.0], [0.02, 0.01, 0.0], [0.02, 0.0, 0.01]];
        let mut corners = corners.map(|[x, y, z]| [size * (3.0 + x), size * y, size * z]);
        let place_of_nearest = corners[0];
        corners.rotate_right(nearest);
        let first = rock.positions().len() as u32;
        let mut positions = rock.positions().to_vec();
        positions.extend(corners);
        let mut all = rock.triangles().to_vec();
        all.extend([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]].map(|t: [u32; 3]| t.map(|v| v + first)));
        let model = bake(&Mesh::new(positions, all).unwrap(), 0, 3, 0.65);
        let gmesh = model.structure();
        let place = |v: usize| model.vertices().positions()[v];
        let part: Vec<usize> = (0..gmesh.vertex_count()).filter(|&v| place(v)[0] > 2.0 * size).collect();
        assert_eq!(part.len(), 4);
        let coarsest = gmesh.levels().last().unwrap().vertices;
        assert!(part.iter().all(|&v| v >= coarsest), "the tetrahedron vanishes");
        for &v in &part {
            assert_eq!(place(gmesh.targets()[v] as usize), place_of_nearest, "corner {nearest}");
        }
    }
}

/// Levels of equal error are passed on one way: the state follows the error without a jump.
#[test]
fn levels_of_equal_error_are_passed_on_one_way() {
    let mut found = 0;
    for seed in 0..12 {
        let mesh = shapes::rock(400, seed);
        let model = bake(&mesh, 0, 0, 0.9);
        let levels = model.structure().levels();
        let equal =
            |pair: &[multires::gmesh::GmeshLevel]| pair[0].error > 0.0 && pair[0].error == pair[1].error;
        // The error behind two equal ones lies higher, so there is a way.
        let Some(at) = levels.windows(2).position(equal) else { continue };
        let mut lod =
            model.instance(model.arrange(mesh.positions()).unwrap(), &LodOptions::default()).unwrap();
        let view = View::perspective(look_at([0.0, 0.0, 9.0], [0.0; 3], [0.0, 1.0, 0.0]), 1.0, [640, 360]);
        let views = [view.unwrap().with_tolerance_px(1.0).of_world()];
        let position = |m: Morph| m.level as f32 + m.share;
        // Factors at which the state is about there, in steps of a hundredth of the way.
        let mut last: Option<f32> = None;
        let error = f64::from(levels[at].error);
        let next = levels.iter().map(|l| f64::from(l.error)).find(|&e| e > error).unwrap_or(2.0 * error);
        lod.adapt(&views, 0.0);
        let [low, high] = model.bounds().unwrap();
        let centre: [f32; 3] = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
        let unit = views[0].error_at(distance([0.0, 0.0, 9.0], centre) - 0.5 * distance(low, high));
        for step in 0..=120 {
            let allowed = error + (next - error) * (f64::from(step) * 0.01 - 0.1);
            lod.set_tolerance_factor((allowed / unit) as f32);
            lod.adapt(&views, 0.0);
            let now = position(lod.state());
            let ways = levels.iter().filter(|level| level.error == levels[at].error).count() as f32;
            if let Some(last) = last {
                assert!(
                    now >= last - 1e-3 && now - last <= 0.1 * (ways + 1.0),
                    "{last} to {now}, seed {seed}"
                );
            }
            last = Some(now);
        }
        found += 1;
    }
    assert!(found > 0);
}

#[test]
fn partitions_come_from_levels() {
    // Volumes of one's own, in an otherwise legal mesh.
    let closed = bake(&shapes::rock(3_000, 1), 0, 3, 0.65);
    let mut parts = GmeshParts::from((**closed.structure()).clone());
    let count = parts.level_volumes.len();
    let by = |parts: &GmeshParts| Partition::by_volume(&Gmesh::try_from(parts.clone()).unwrap());
    for sign in [1.0, -1.0] {
        // Squares: the loss grows from level to level.
        parts.level_volumes = (0..count).map(|level| sign * (1e6 - (level * level) as f64)).collect();
        let whole = ((count - 1) * (count - 1)) as f64;
        for (level, start) in by(&parts).starts().iter().enumerate() {
            assert!((f64::from(*start) - (level * level) as f64 / whole).abs() < 0.01, "{level}: {start}");
        }
    }
    parts.level_volumes[2] = 2e6;
    assert_eq!(by(&parts), Partition::by_error(closed.structure()), "a level that gains volume");
    // Open: by error.
    let open = bake(&shapes::terrain(40, 1), 0, 3, 0.65);
    assert!(open.structure().levels().iter().all(|level| level.volume.is_none()));
    assert_eq!(Partition::by_volume(open.structure()), Partition::by_error(open.structure()));
    // A flat plane: no error anywhere, yet every level has a range.
    let flat = bake(&shapes::plane(20), 0, 3, 0.65);
    let partition = Partition::by_error(flat.structure());
    assert!(partition.starts().windows(2).all(|pair| pair[0] < pair[1]));
    // A level without an error of its own has 1/64 of an even range.
    let mut parts = GmeshParts::from((**closed.structure()).clone());
    parts.level_errors =
        (0..count).map(|level| if level < 3 { level as f32 } else { level as f32 - 1.0 }).collect();
    let starts = Partition::by_error(&Gmesh::try_from(parts).unwrap()).starts().to_vec();
    let even = 1.0 / (count - 1) as f32;
    assert!(((starts[3] - starts[2]) / even - 1.0 / 64.0).abs() < 1e-3, "{starts:?}");
    assert_eq!(Partition::by_lengths(&[1.0, 3.0]).unwrap().starts(), [0.0, 0.25, 1.0]);
    assert!(Partition::by_lengths(&[1.0, 0.0]).is_err());
    assert!(Partition::by_lengths(&[1.0, f32::NAN]).is_err());
    assert!(Partition::by_lengths(&[1e-30, 1e30]).is_err());
    assert_eq!(Partition::even(0).at(0.3), Morph::default());
    assert_eq!(Partition::even(1).at(7.0), Morph::default());
    assert_eq!(partition.at(f32::NAN), Morph::default());
    // Shares beyond the end are at the end.
    let beyond = |share| closed.structure().clamped(Morph { level: 0, share });
    assert_eq!([7.0, 1.0, -1.0, f32::NAN].map(|share| beyond(share).share), [1.0, 1.0, 0.0, 0.0]);
    let range = DistanceRange { near: 1.0, far: 3.0 };
    assert_eq!([range.t(0.0), range.t(2.0), range.t(5.0)], [-0.5, 0.5, 2.0]);
    let none = DistanceRange { near: 1.0, far: 1.0 };
    assert_eq!([none.t(1.0), none.t(1.5), none.t(f32::NAN)], [0.0, 1.0, 0.0]);
}

/// What is drawn is what the state says, whatever led to it.
#[test]
fn moved_vertices_are_those_of_the_state() {
    let mesh = shapes::rock(3_000, 5);
    let model = Gmesh::bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap().with_blending();
    let morph = multires::adapt::Geomorph::default().with_duration(0.3);
    // Vertices begin to move once asked to.
    let mut lod = model.instance(values.clone(), &LodOptions::default()).unwrap();
    lod.set_options(&LodOptions::default().with_geomorph(morph)).unwrap();
    let view = |far: f32| {
        let to_eye = look_at([0.0, 0.0, far], [0.0; 3], [0.0, 1.0, 0.0]);
        View::perspective(to_eye, 1.0, [1280, 720]).unwrap().with_tolerance_px(2.0).of_world()
    };
    let (mut drawn, mut shares) = (Vec::new(), 0);
    for frame in 0..200 {
        let far = 20.0 + 18.5 * (frame as f32 * 0.05).sin();
        let change = lod.adapt(&[view(far)], 1.0 / 60.0);
        let state = lod.state();
        shares += usize::from(state.share > 0.0);
        lod.gmesh().fill(&values, state, &mut drawn);
        assert!(
            lod.vertex_bytes() == bytemuck::cast_slice::<[f32; 3], u8>(&drawn),
            "frame {frame}: {state:?}"
        );
        assert_eq!(change.triangles, lod.gmesh().levels()[state.level].triangles);
    }
    assert!(shares > 20);
    // An eye that jumps turns the state round between two levels, too.
    let mut turned = 0;
    for frame in 0..300_u32 {
        let far = 1.5 + (frame.wrapping_mul(2_654_435_761) >> 16) as f32 / 65_536.0 * 37.0;
        let before = lod.state();
        lod.adapt(&[view(far)], [0.02, 0.1, 0.35][frame as usize % 3]);
        let state = lod.state();
        turned += usize::from(state.level != before.level && state.share > 0.0 && before.share > 0.0);
        lod.gmesh().fill(&values, state, &mut drawn);
        assert!(
            lod.vertex_bytes() == bytemuck::cast_slice::<[f32; 3], u8>(&drawn),
            "{before:?} to {state:?}"
        );
    }
    assert!(turned > 20, "{turned}");
    // A still eye comes to rest, wherever the state is then.
    let still = view(30.0);
    for _ in 0..40 {
        lod.adapt(std::slice::from_ref(&still), 0.1);
    }
    let change = lod.adapt(std::slice::from_ref(&still), 0.1);
    assert_eq!((change.moving, change.pending), (0, 0));
    // Asked for less, it is under way for a while, or there at once.
    let rest = lod.state();
    lod.set_tolerance_factor(4.0);
    let change = lod.adapt(std::slice::from_ref(&still), 0.01);
    assert!(change.pending > 0 && lod.state() != rest);
    lod.settle();
    let change = lod.adapt(std::slice::from_ref(&still), 0.0);
    assert!(change.pending == 0 && lod.state().level > rest.level);
}

/// Parts that grow together keep their triangles, so they cannot shrink.
#[test]
fn parts_that_grow_together_build() {
    use multires::simplify::Parts;
    for seed in 0..6 {
        for mesh in [shapes::gravel(20, seed), shapes::soup(60, seed)] {
            for reach in [0.1, 1.0] {
                for order in 0..4 {
                    for place in [0, 3] {
                        let distance = reach * mesh.diagonal() as f32;
                        let mut simplifier =
                            simplifier(place, order).parts(Parts::Keep).join_distance(distance);
                        let sequence = simplifier.run(&mesh).unwrap();
                        let built = Gmesh::build(&mesh, &sequence, &GmeshOptions::default());
                        assert!(built.is_ok(), "{reach} {order} {place}: {built:?}");
                    }
                }
            }
        }
    }
}

/// The memory of levels is in proportion to the file, whatever the file says.
#[test]
fn levels_of_nothing_are_refused() {
    let count = 40_000;
    let parts = GmeshParts {
        level_vertices: vec![0; count],
        level_errors: vec![0.0; count],
        level_volumes: vec![0.0; count],
        targets: Vec::new(),
        triangles: Vec::new(),
        group_ends: vec![0; count],
        material_ids: (0..count as u32).collect(),
    };
    assert!(matches!(Gmesh::try_from(parts), Err(GmeshError::Length { .. })));
}

/// Each promise of the parts has a refusal of its own.
#[test]
fn parts_that_break_a_promise_are_refused() {
    let legal = GmeshParts {
        level_vertices: vec![5, 4],
        level_errors: vec![0.0, 1.0],
        level_volumes: vec![f64::NAN; 2],
        targets: vec![0, 1, 2, 3, 3],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        group_ends: vec![2],
        material_ids: Vec::new(),
    };
    assert!(Gmesh::try_from(legal.clone()).is_ok());
    // No triangle uses the vertex.
    let far = GmeshParts { targets: vec![0, 1, 2, 3, 9], ..legal.clone() };
    assert_eq!(Gmesh::try_from(far).unwrap_err(), GmeshError::Target { vertex: 4, target: 9 });
    let falling = GmeshParts { level_errors: vec![1.0, 0.5], ..legal.clone() };
    assert_eq!(Gmesh::try_from(falling).unwrap_err(), GmeshError::Level { level: 1 });
    let count = 3_000;
    let alike = GmeshParts {
        level_vertices: vec![5; count],
        level_errors: vec![0.0; count],
        level_volumes: vec![f64::NAN; count],
        targets: (0..5).collect(),
        ..legal
    };
    assert!(matches!(Gmesh::try_from(alike).unwrap_err(), GmeshError::TooLittle { .. }));
}

/// Batches are joined into a level until it has the share of the triangles asked for.
#[test]
fn batches_are_joined_into_levels() {
    for (order, share) in [(1, 0.5), (3, 0.4), (0, 0.7)] {
        let model = bake(&shapes::rock(3_000, 2), 0, order, share);
        let levels = model.structure().levels();
        let kept = levels.windows(2).map(|pair| pair[1].triangles as f32 / pair[0].triangles as f32);
        let kept: Vec<f32> = kept.collect();
        assert!(kept.len() > 3 && kept.iter().rev().skip(1).all(|&kept| kept <= share), "{kept:?}");
    }
}

/// An instance draws the coarsest state within the tolerance, moves no faster than asked, and writes indices once.
#[test]
fn an_instance_follows_the_view() {
    let mesh = shapes::rock(5_000, 7);
    let model = Gmesh::bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap().with_blending();
    let diagonal = mesh.diagonal() as f32;
    let [low, high] = model.bounds().unwrap();
    let centre: [f32; 3] = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
    let view = |far: f32| {
        let to_eye = look_at([0.0, 0.0, far * diagonal], [0.0; 3], [0.0, 1.0, 0.0]);
        View::perspective(to_eye, 1.0, [1280, 720]).unwrap().with_tolerance_px(2.0).of_world()
    };
    let shared = LodOptions::default().with_buffer(VertexBuffer::Shared);
    let mut lod = model.instance(values.clone(), &shared).unwrap();
    lod.clean();
    let (mut states, mut rests) = (Vec::new(), 0);
    for i in 0..60 {
        let far = 0.8 + i as f32 * i as f32 * 0.05;
        let view = view(far);
        lod.adapt(std::slice::from_ref(&view), 0.0);
        let nearest = distance([0.0, 0.0, far * diagonal], centre) - 0.5 * f64::from(diagonal);
        let allowed = view.error_at(nearest);
        let error = f64::from(lod.gmesh().error(lod.state()));
        assert!(error <= allowed * 1.000_01, "{error} beyond {allowed}");
        // At rest in the coarsest level that is allowed, or on the way to it.
        let level = lod.gmesh().level_of_error(allowed as f32);
        let state = lod.state();
        // Half-way to the next level's error it has arrived.
        let [own, next] = [level, level + 1].map(|i| lod.gmesh().levels().get(i).map(|l| f64::from(l.error)));
        let half = own.unwrap() + 0.5 * (next.unwrap_or(f64::INFINITY) - own.unwrap());
        let arrived = state == Morph { level, share: 0.0 };
        assert!(arrived || allowed < half * 1.000_01, "{state:?} at {allowed}, {level} at rest from {half}");
        rests += usize::from(arrived && next.is_some_and(|next| allowed < next));
        assert!(
            state == Morph { level, share: 0.0 } || state.level < level,
            "{state:?} instead of level {level}"
        );
        states.push(state);
        // The shader moves them; the instance's own vertices are at rest.
        let uniform = lod.morph().unwrap();
        let moving = lod.gmesh().moving(state.level);
        assert_eq!((uniform.first_moving as usize, uniform.share), (moving.start, state.share));
        assert!(i % 10 > 0 || lod.to_mesh() == model.mesh_at(Morph { share: 0.0, ..state }));
        assert_eq!(lod.uploads().count(), 0, "all was uploaded once");
    }
    assert!(rests > 5, "{rests}");
    let position = |m: &Morph| m.level as f32 + m.share;
    assert!(states.windows(2).all(|pair| position(&pair[0]) <= position(&pair[1])));
    assert!(states.iter().map(|m| m.level).max() > Some(2) && states.iter().any(|m| m.share > 0.0));

    // With a duration, a cut of the eye takes time; the first view does not.
    let slow = multires::adapt::Geomorph::default()
        .with_duration(1.0)
        .with_travel(f32::INFINITY)
        .with_turn(f32::INFINITY);
    let mut lod = model.instance(values, &LodOptions::default().with_geomorph(slow)).unwrap();
    lod.adapt(&[view(1.0)], 0.1);
    let fine = lod.state();
    let mut before = position(&fine);
    for _ in 0..200 {
        lod.adapt(&[view(40.0)], 0.1);
        let now = position(&lod.state());
        assert!(now >= before && now - before <= 0.1001);
        before = now;
    }
    let mut at_once =
        model.instance(model.arrange(mesh.positions()).unwrap(), &LodOptions::default()).unwrap();
    at_once.adapt(&[view(40.0)], 0.1);
    assert_eq!(lod.state(), at_once.state());

    // Out of view nobody sees a jump: back at once, too.
    let away = look_at([0.0, 0.0, 2.0 * diagonal], [0.0, 0.0, 9.0 * diagonal], [0.0, 1.0, 0.0]);
    let away = View::perspective(away, 1.0, [1280, 720]).unwrap().of_world();
    lod.adapt(&[away], 0.1);
    assert_eq!(lod.state().level, lod.gmesh().levels().len() - 1);
    lod.adapt(&[view(1.0)], 0.1);
    assert_eq!(lod.state(), fine);

    // Limits.
    let levels = at_once.gmesh().levels();
    let most = levels[2].vertices - levels[3].vertices;
    let few = LodOptions::default().with_operations(most);
    let mut lod = model.instance(model.arrange(mesh.positions()).unwrap(), &few).unwrap();
    let (mut calls, mut before) = (0, lod.state().level);
    while lod.state() != Morph::default() {
        lod.adapt(&[view(0.501)], 0.1);
        let after = lod.state().level;
        let moved = levels[after].vertices - levels[before].vertices;
        assert!(after < before && (moved <= most || before - after == 1), "{before} to {after}");
        (calls, before) = (calls + 1, after);
    }
    assert!(calls > 3, "{calls}");
    let limited = LodOptions::default().with_triangles(500);
    let mut lod = model.instance(model.arrange(mesh.positions()).unwrap(), &limited).unwrap();
    assert!(lod.refine_fully().triangles <= 500 && lod.adapt(&[view(0.8)], 0.1).triangles <= 500);
}

#[test]
fn odd_input_makes_a_small_g_mesh() {
    for mesh in [Mesh::new([], []).unwrap(), shapes::tetrahedron()] {
        let model = Gmesh::bake(&mesh).unwrap();
        assert!(!model.structure().levels().is_empty());
        let mut lod =
            model.instance(model.arrange(mesh.positions()).unwrap(), &LodOptions::default()).unwrap();
        assert_eq!(lod.refine_fully().triangles, mesh.triangles().len());
        lod.adapt(&[], f32::NAN);
        assert_eq!(model.level(Level::Error(f32::NAN)).mesh.triangles().len(), mesh.triangles().len());
    }
    let mesh = shapes::rock(300, 1);
    let sequence = Gmesh::simplifier().run(&mesh).unwrap();
    for share in [0.0, -1.0, 0.95, f32::NAN] {
        let options = GmeshOptions::default().with_share(share);
        let refused = Gmesh::build(&mesh, &sequence, &options);
        assert!(matches!(refused, Err(GmeshError::Option(_))), "{share}");
    }
    assert!(matches!(
        Gmesh::build(&shapes::cube(), &sequence, &GmeshOptions::default()),
        Err(GmeshError::Sequence(_))
    ));
}

/// Attributes of moved vertices are mixed as the level's are.
#[test]
fn moved_vertices_carry_all_attributes() {
    let mesh = shapes::prop(6);
    let model = bake(&mesh, 0, 3, 0.65);
    let [own, half] = [0.0, 0.5].map(|share| model.mesh_at(Morph { level: 1, share }));
    assert_eq!(own.triangles().len(), half.triangles().len());
    assert_eq!(own.materials(), half.materials());
    for attribute in mesh.attributes() {
        assert!(half.attribute(attribute.name()).is_some(), "{} is lost", attribute.name());
    }
    let normals = half.attribute(names::NORMAL).and_then(|a| a.as_floats()).unwrap();
    assert!(normals.chunks(3).all(|n| (n.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-3));
    assert_ne!(own.positions(), half.positions());
    // Positions and texture coordinates as the processor moves them, corner by corner.
    let gmesh = model.structure();
    let uv: &[[f32; 2]] =
        bytemuck::cast_slice(model.vertices().attribute(names::UV).unwrap().as_floats().unwrap());
    let values: Vec<[f32; 5]> =
        model.vertices().positions().iter().zip(uv).map(|(p, t)| [p[0], p[1], p[2], t[0], t[1]]).collect();
    let mut drawn = Vec::new();
    gmesh.fill(&values, Morph { level: 1, share: 0.5 }, &mut drawn);
    let half_uv: &[[f32; 2]] = bytemuck::cast_slice(half.attribute(names::UV).unwrap().as_floats().unwrap());
    for (there, here) in triangles(gmesh, 1).iter().zip(half.triangles()) {
        for (&v, &w) in there.iter().zip(here) {
            let ([x, y, z], [s, t]) = (half.positions()[w as usize], half_uv[w as usize]);
            assert_eq!(drawn[v as usize], [x, y, z, s, t]);
        }
    }
}
