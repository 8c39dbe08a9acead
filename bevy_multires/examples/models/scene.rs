//! A field of models: procedural shapes of multires, each in several colours and sizes.

use bevy::prelude::*;
use bevy_multires::convert::to_bevy;
use multires::mesh::shapes;

/// The size of the field, and of its models.
#[derive(Resource, Debug, Clone, Copy)]
pub struct Field {
    /// Number of models.
    pub models: usize,
    /// Triangles of a model, about.
    pub triangles: u32,
}

/// A model of the field.
#[derive(Component)]
pub struct Model;

/// Returns the shapes, of about so many triangles each.
fn shapes_of(triangles: u32) -> Vec<multires::Mesh> {
    let side = (triangles / 2).isqrt().max(8);
    vec![
        shapes::rock(triangles, 1),
        shapes::torus_knot(2, 3, 4 * side, side / 4),
        shapes::rock(triangles, 7),
        shapes::robot((triangles / 240).isqrt()),
        shapes::uv_sphere(2 * side, side / 2),
        shapes::prop((triangles / 12).isqrt()),
    ]
}

/// Returns a shape as a Bevy mesh, with normals, 2 units wide and standing on y = 0.
fn standing(shape: &multires::Mesh) -> Option<Mesh> {
    let [low, high] = shape.bounds()?.map(Vec3::from);
    let scale = 2.0 / (high - low).max_element();
    let middle = Vec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
    let mesh = to_bevy(shape).inspect_err(|error| error!("a shape is left out: {error}")).ok()?;
    let mesh = if mesh.contains_attribute(Mesh::ATTRIBUTE_NORMAL) {
        mesh
    } else {
        mesh.with_computed_area_weighted_normals()
    };
    Some(mesh.translated_by(-middle).scaled_by(Vec3::splat(scale)))
}

/// Returns a number from 0 to 1 that looks like chance, the same in every run.
fn chance(at: usize, which: u32) -> f32 {
    let mixed = (at as u32).wrapping_mul(0x9e37_79b9).wrapping_add(which.wrapping_mul(0x85eb_ca6b));
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2c1b_3c6d);
    ((mixed ^ mixed >> 12).wrapping_mul(0x297a_2d39) >> 8) as f32 / (1 << 24) as f32
}

/// Spawns the ground, the light and the models. The camera is the caller's: [`eye`] is a good place.
pub fn spawn(
    mut commands: Commands,
    field: Res<Field>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let shapes: Vec<Handle<Mesh>> =
        shapes_of(field.triangles).iter().filter_map(standing).map(|mesh| meshes.add(mesh)).collect();
    let paints = [0xe8a33d, 0x4f7cac, 0xb5563c, 0x7a9e5f, 0x8d6a9f, 0xd8c9a7].map(|rgb: u32| {
        let [_, red, green, blue] = rgb.to_be_bytes();
        materials.add(StandardMaterial {
            base_color: Color::srgb_u8(red, green, blue),
            perceptual_roughness: 0.7,
            ..default()
        })
    });
    // Rows that go away from the camera, wider with the distance.
    let columns = (field.models as f32 / 1.6).sqrt().ceil().max(1.0) as usize;
    for at in 0..field.models {
        let (row, column) = (at / columns, at % columns);
        let spacing = 3.2;
        let x = (column as f32 - 0.5 * (columns as f32 - 1.0) + 0.6 * (chance(at, 0) - 0.5)) * spacing;
        let z = -(row as f32 + 0.6 * (chance(at, 1) - 0.5)) * spacing;
        let place = Transform::from_xyz(x, 0.0, z)
            .with_rotation(Quat::from_rotation_y(chance(at, 2) * std::f32::consts::TAU))
            .with_scale(Vec3::splat(0.7 + 0.6 * chance(at, 3)));
        let Some(mesh) = shapes.get((chance(at, 4) * shapes.len() as f32) as usize) else { continue };
        let paint = &paints[(chance(at, 5) * paints.len() as f32) as usize % paints.len()];
        commands.spawn((Model, Mesh3d(mesh.clone()), MeshMaterial3d(paint.clone()), place));
    }
    let ground = materials.add(StandardMaterial {
        base_color: Color::srgb(0.32, 0.34, 0.33),
        perceptual_roughness: 1.0,
        ..default()
    });
    let wide = 400.0;
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(wide, wide).build())),
        MeshMaterial3d(ground),
    ));
    let sun = DirectionalLight { illuminance: 9_000.0, ..default() };
    commands.spawn((sun, Transform::from_xyz(2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.insert_resource(GlobalAmbientLight { brightness: 500.0, ..default() });
}

/// Returns the place from which all of the field is seen.
pub fn eye(field: &Field) -> Transform {
    let deep = (field.models as f32 * 1.6).sqrt() * 3.2;
    Transform::from_xyz(0.0, 3.0 + 0.14 * deep, 6.0).looking_at(Vec3::new(0.0, 0.0, -0.35 * deep), Vec3::Y)
}

/// The colour behind everything.
pub const SKY: Color = Color::srgb(0.74, 0.8, 0.86);
