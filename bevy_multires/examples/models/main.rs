//! 500 models in a window: `cargo run --release -p bevy_multires --example models --features window`
//!
//! Keys: L levels off and on; up and down, or W and S, forward and back; left and right, or A and D, turn; + and - tolerance.
//! `--frames N` ends after so many frames, and prints what was drawn.

mod scene;

use std::process::ExitCode;

use bevy::prelude::*;
use bevy::window::WindowResolution;
use bevy_multires::{AutoLod, LodCache, LodSettings, LodStats, MultiresPlugin};
use scene::Field;

/// Frames to draw before the end.
#[derive(Resource)]
struct Frames(Option<u32>);

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let frames = match (arguments.next().as_deref(), arguments.next(), arguments.next()) {
        (None, ..) => None,
        (Some("--frames"), Some(number), None) if number.parse::<u32>().is_ok() => number.parse().ok(),
        _ => {
            eprintln!("usage: models [--frames N]");
            return ExitCode::from(2);
        }
    };
    let window = Window {
        title: "bevy_multires: 500 models".to_owned(),
        resolution: WindowResolution::new(1280, 720),
        ..default()
    };
    let exit = App::new()
        .add_plugins(DefaultPlugins.set(WindowPlugin { primary_window: Some(window), ..default() }))
        .add_plugins(MultiresPlugin)
        .insert_resource(ClearColor(scene::SKY))
        .insert_resource(Field { models: 500, triangles: 20_000 })
        .insert_resource(LodSettings::default().with_all(AutoLod::default()))
        .insert_resource(Frames(frames))
        .add_systems(Startup, (scene::spawn, spawn_camera))
        .add_systems(Update, (fly, keys, show, end))
        .run();
    if exit.is_success() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn spawn_camera(mut commands: Commands, field: Res<Field>) {
    commands.spawn((Camera3d::default(), scene::eye(&field)));
    let place = Node { position_type: PositionType::Absolute, top: px(10), left: px(12), ..default() };
    commands.spawn((Text::default(), TextColor(Color::BLACK), place));
}

/// Moves the camera.
fn fly(
    pressed: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
) {
    let axis = |plus: [KeyCode; 2], minus: [KeyCode; 2]| {
        f32::from(pressed.any_pressed(plus)) - f32::from(pressed.any_pressed(minus))
    };
    let ahead = axis([KeyCode::ArrowUp, KeyCode::KeyW], [KeyCode::ArrowDown, KeyCode::KeyS]);
    let turn = axis([KeyCode::ArrowLeft, KeyCode::KeyA], [KeyCode::ArrowRight, KeyCode::KeyD]);
    for mut place in &mut cameras {
        place.rotate_y(turn * time.delta_secs());
        let forward = place.forward();
        place.translation += forward * (ahead * 12.0 * time.delta_secs());
    }
}

/// Switches levels, and changes the tolerance.
fn keys(pressed: Res<ButtonInput<KeyCode>>, mut settings: ResMut<LodSettings>) {
    if pressed.just_pressed(KeyCode::KeyL) {
        settings.enabled = !settings.enabled;
    }
    if pressed.any_just_pressed([KeyCode::NumpadAdd, KeyCode::Equal]) {
        settings.tolerance_factor *= 1.25;
    }
    if pressed.any_just_pressed([KeyCode::NumpadSubtract, KeyCode::Minus]) {
        settings.tolerance_factor *= 0.8;
    }
}

/// Writes what is drawn.
fn show(
    mut texts: Query<&mut Text>,
    stats: Res<LodStats>,
    settings: Res<LodSettings>,
    cache: Res<LodCache>,
    time: Res<Time>,
) {
    for mut text in &mut texts {
        text.0 = format!(
            "{} of {} triangles\n{:.1} ms a frame\nlevels {} (L), tolerance {:.2} px (+ -)",
            grouped(stats.triangles),
            grouped(stats.full_triangles),
            1e3 * time.delta_secs(),
            if settings.enabled { "on" } else { "off" },
            settings.tolerance_factor,
        );
        if stats.building > 0 {
            text.0 += &format!("\nbuilding levels: {:.0} %", 100.0 * cache.total_progress());
        }
    }
}

/// Returns a number with a comma after each three digits.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let comma = |at: usize| at > 0 && (digits.len() - at).is_multiple_of(3);
    digits
        .chars()
        .enumerate()
        .flat_map(|(at, digit)| comma(at).then_some(',').into_iter().chain([digit]))
        .collect()
}

/// Ends after the frames asked for.
fn end(frames: Res<Frames>, mut drawn: Local<u32>, stats: Res<LodStats>, mut exit: MessageWriter<AppExit>) {
    *drawn += 1;
    if frames.0.is_some_and(|frames| *drawn >= frames) {
        println!("{} of {} triangles after {} frames", stats.triangles, stats.full_triangles, *drawn);
        exit.write(AppExit::Success);
    }
}
