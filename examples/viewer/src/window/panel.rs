//! The side panel: everything that can be set, and what comes of it.

use egui::{Align2, Color32, ComboBox, FontId, RichText, ScrollArea, Sense, Slider, Ui, vec2};
use multires::adapt::Geomorph;
use multires::hierarchy::Dependencies;
use multires::lod::{Triangulation, VertexBuffer};
use multires::simplify::{Placement, metric};
use multires::view::ErrorKind;
use multires::wavelet::ErrorBound;

use super::graphs::{ADAPT, BYTES, CHANGES, FRAME, OUTPUT, TESTS, TRIANGLES, UPLOAD, short};
use super::hands::Hands;
use super::viewer::Viewer;
use crate::arguments::Layout;
use crate::renderer::Shading;
use crate::scene::{Builtin, Controller, Coordinates, Source, StructureKind};

/// Width of the panel, points: a share of the window's within these.
const WIDTHS: [f32; 2] = [250.0, 310.0];
const SHARE: f32 = 0.3;
/// Width of windows that are too narrow for it to be open at first.
const NARROW: f32 = 700.0;
/// What keys do.
const KEYS: &str = "drag, one finger: around, or look about\n\
    right drag, two fingers: along the picture\n\
    wheel, pinch: nearer and farther; while flying, faster and slower\n\
    W A S D Q E, arrows, page up and down: fly; with shift fast\n\
    double click: show all\n\
    Tab: this panel\n\
    F1: this help";

/// What the panel remembers between frames.
#[derive(Debug, Default)]
pub struct Panel {
    /// Whether it is open; by the window's width until somebody said.
    open: Option<bool>,
    /// Whether it is said what keys do.
    helps: bool,
}

/// What was asked for in a frame, besides what controls hold.
#[derive(Debug, Default)]
pub struct Asked {
    /// Load this.
    pub load: Option<Source>,
    /// Build what is shown anew.
    pub rebuild: bool,
    /// Parts of the window for pictures, points: left, top, width, height.
    pub parts: Vec<egui::Rect>,
    /// Whether the camera was moved.
    pub moved: bool,
}

impl Panel {
    /// Lays out a frame, and takes what hands do over the picture.
    pub fn show(&mut self, ui: &mut Ui, viewer: &mut Viewer, seconds: f64) -> Asked {
        let mut asked = Asked::default();
        let wide = ui.available_width();
        let open = self.open.unwrap_or(wide >= NARROW);
        let typing = ui.ctx().egui_wants_keyboard_input();
        let tab = !typing && ui.input(|input| input.key_pressed(egui::Key::Tab));
        if tab {
            self.open = Some(!open);
        }
        if !typing && ui.input(|input| input.key_pressed(egui::Key::F1)) {
            self.helps = !self.helps;
        }
        if open {
            let width = (wide * SHARE).clamp(WIDTHS[0], WIDTHS[1]).min(wide * 0.9);
            egui::Panel::right("controls").resizable(false).exact_size(width).show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.heading("multires");
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        if ui.small_button("Hide").on_hover_text("Tab").clicked() {
                            self.open = Some(false);
                        }
                        if ui.small_button("?").on_hover_text(KEYS).clicked() {
                            self.helps = !self.helps;
                        }
                    });
                });
                // Always in view, below what scrolls.
                egui::Panel::bottom("curves").resizable(false).show(ui, |ui| {
                    viewer.history.show(ui, [TRIANGLES, ADAPT, UPLOAD]);
                });
                // Bars beside what they scroll, not over it.
                ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
                ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                    // Beside a slider stand its number and its name.
                    ui.spacing_mut().slider_width = (ui.available_width() - 178.0).max(48.0);
                    model(ui, viewer, &mut asked);
                    detail(ui, viewer);
                    control(ui, viewer);
                    picture(ui, viewer);
                    camera(ui, viewer);
                    numbers(ui, viewer);
                });
            });
        }
        egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| {
            let over = ui.allocate_response(ui.available_size(), Sense::click_and_drag());
            asked.parts = parts(over.rect, viewer.controls.layout);
            let (size, fov) = (viewer.size(), viewer.controls.field_of_view);
            asked.moved = viewer.hands.move_by(&over, seconds, size, fov);
            if asked.moved && viewer.tape()[1] {
                viewer.play(false);
            }
            if over.double_clicked() {
                viewer.reset_camera();
            }
            captions(ui, viewer, &asked.parts);
            if self.helps {
                let at = over.rect.left_bottom() + vec2(15.0, -16.0);
                label(ui, over.rect.width(), at, Align2::LEFT_BOTTOM, KEYS, Color32::WHITE);
            }
            if !open {
                let place =
                    egui::Rect::from_min_size(over.rect.right_top() + vec2(-76.0, 8.0), vec2(68.0, 24.0));
                if ui.put(place, egui::Button::new("Controls")).clicked() {
                    self.open = Some(true);
                }
            }
        });
        asked
    }
}

/// Pictures of one size in rows, as many a row as leaves their shorter side the longest.
fn parts(area: egui::Rect, layout: Layout) -> Vec<egui::Rect> {
    let count = layout.pictures();
    let each =
        |across: u32| vec2(area.width() / across as f32, area.height() / count.div_ceil(across) as f32);
    let short = |across: &u32| each(*across).min_elem();
    let across = (1..=count).max_by(|a, b| short(a).total_cmp(&short(b))).unwrap_or(1);
    let each = each(across);
    let at = |i: u32| vec2(each.x * (i % across) as f32, each.y * (i / across) as f32);
    (0..count).map(|i| egui::Rect::from_min_size(area.min + at(i), each)).collect()
}

/// What each picture is, on it; and what is going on.
fn captions(ui: &Ui, viewer: &Viewer, parts: &[egui::Rect]) {
    let drawn = viewer.adapted.change.triangles as f32;
    let full = viewer.scene().map_or(0, |scene| scene.model().triangle_count() * scene.len());
    let texts = [
        format!("{} triangles{}", short(drawn, ""), if viewer.is_frozen() { ", frozen" } else { "" }),
        format!("full mesh, {} triangles", short(full as f32, "")),
        match viewer.controls.layout {
            Layout::Distance => {
                format!("distance, brightest at {} px; red, blue: silhouette", viewer.brightest())
            }
            _ => "difference, 8 times; red, blue: silhouette".to_owned(),
        },
    ];
    let wide = ui.available_width().max(parts[0].width());
    let label = |at, anchor, text: &str, colour| label(ui, wide, at, anchor, text, colour);
    if viewer.scene().is_some() {
        for (part, text) in parts.iter().zip(&texts) {
            label(part.left_top() + vec2(15.0, 12.0), Align2::LEFT_TOP, text, Color32::WHITE);
        }
    }
    let all = parts.iter().fold(parts[0], |all, part| all.union(*part));
    if let Some((name, progress, elapsed)) = viewer.loading() {
        let text = format!("{name}: {:.0} %, {:.1} s", 100.0 * progress, elapsed.as_secs_f32());
        label(all.center(), Align2::CENTER_CENTER, &text, Color32::WHITE);
    } else if let Some(message) = &viewer.message {
        let at = all.center_bottom() - vec2(0.0, 16.0);
        label(at, Align2::CENTER_BOTTOM, message, Color32::from_rgb(255, 214, 150));
    }
    if ui.input(|input| !input.raw.hovered_files.is_empty()) {
        label(
            all.center(),
            Align2::CENTER_CENTER,
            "a model, a .png to paint it with, or a .csv path",
            Color32::WHITE,
        );
    }
}

/// Text on a dark ground, no wider than `wide`.
fn label(ui: &Ui, wide: f32, at: egui::Pos2, anchor: Align2, text: &str, colour: Color32) {
    let font = FontId::proportional(14.0);
    let galley = ui.painter().layout(text.to_owned(), font, colour, (wide - 40.0).max(80.0));
    let place = anchor.anchor_size(at, galley.size());
    ui.painter().rect_filled(place.expand2(vec2(7.0, 4.0)), 4.0, Color32::from_black_alpha(165));
    ui.painter().galley(place.min, galley, colour);
}

fn section(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(name).strong()).default_open(true).show(ui, add);
}

/// A choice among a few; `about` says what it chooses.
fn choice<T: PartialEq + Copy>(ui: &mut Ui, name: &str, about: &str, value: &mut T, all: &[(T, &str)]) {
    ui.horizontal(|ui| {
        ui.label(name).on_hover_text(about);
        let shown = all.iter().find(|(other, _)| other == value).map_or("", |(_, text)| text);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let width = (ui.available_width() - 8.0).min(150.0);
            let combo = ComboBox::from_id_salt(name).selected_text(shown).width(width).truncate();
            let shown = combo.show_ui(ui, |ui| {
                for (other, text) in all {
                    ui.selectable_value(value, *other, *text);
                }
            });
            shown.response.on_hover_text(about);
        });
    });
}

fn model(ui: &mut Ui, viewer: &mut Viewer, asked: &mut Asked) {
    section(ui, "Model", |ui| {
        ui.label(viewer.name());
        if let Some(scene) = viewer.scene() {
            let model = scene.model();
            let many = if scene.len() > 1 { format!("{} objects of ", scene.len()) } else { String::new() };
            ui.weak(format!(
                "{many}{} triangles, {}",
                short(model.triangle_count() as f32, ""),
                model.kind()
            ));
        }
        if let Some((_, progress, _)) = viewer.loading() {
            ui.horizontal(|ui| {
                ui.add(egui::ProgressBar::new(progress).desired_width(190.0).show_percentage());
                if ui.button("Cancel").clicked() {
                    viewer.cancel();
                }
            });
        }
        ui.horizontal_wrapped(|ui| {
            for builtin in [Builtin::Demo, Builtin::Terrain, Builtin::Rocks, Builtin::Crowd] {
                if ui.button(builtin.name()).clicked() {
                    asked.load = Some(Source::Builtin(builtin, None));
                }
            }
        });
        ui.weak("or drop a file on the window");
        let build = &mut viewer.controls.build;
        choice(
            ui,
            "Structure",
            "What is built: how levels of detail are kept",
            &mut build.structure,
            &[
                (StructureKind::Hierarchy, "vertex hierarchy"),
                (StructureKind::Tom, "totally ordered"),
                (StructureKind::Gmesh, "g-mesh"),
                (StructureKind::Wavelet, "wavelet mesh"),
            ],
        );
        if build.structure == StructureKind::Wavelet {
            choice(
                ui,
                "Bound",
                "Which errors the bounds of wavelets hold",
                &mut build.wavelets.bound,
                &[
                    (ErrorBound::Conservative, "conservative"),
                    (ErrorBound::WithoutSiblings, "without siblings"),
                ],
            );
            choice(
                ui,
                "Coordinates",
                "Texture coordinates of a wavelet mesh: of an atlas of its base faces, or its own",
                &mut build.coordinates,
                &[(Coordinates::Atlas, "atlas of the base"), (Coordinates::Own, "own")],
            );
        } else {
            let mut chosen = metric::NAMES.iter().position(|name| *name == build.metric).unwrap_or(0);
            let names: Vec<(usize, &str)> = metric::NAMES.into_iter().enumerate().collect();
            choice(ui, "Metric", "What a collapse costs", &mut chosen, &names);
            if let Some(name) = metric::NAMES.get(chosen) {
                build.metric = (*name).to_owned();
            }
        }
        if matches!(build.structure, StructureKind::Hierarchy | StructureKind::Gmesh) {
            choice(
                ui,
                "Placement",
                "Where the vertex of a collapse goes",
                &mut build.placement,
                &[
                    (Placement::Endpoint, "endpoint"),
                    (Placement::Midpoint, "midpoint"),
                    (Placement::Subset, "subset"),
                    (Placement::Optimal, "optimal"),
                ],
            );
        }
        if build.structure == StructureKind::Hierarchy {
            choice(
                ui,
                "Dependencies",
                "How near cuts stay to what the simplifier saw: none gives the fewest triangles",
                &mut build.dependencies,
                &[
                    (Dependencies::None, "none"),
                    (Dependencies::Manifold, "manifold"),
                    (Dependencies::Adjacent, "adjacent"),
                    (Dependencies::Neighbours, "neighbours"),
                ],
            );
        }
        if let Some(source) = viewer.refused().cloned() {
            ui.weak(format!("{} is no subdivision of a coarse mesh", source.name()));
            if ui.button("Build a vertex hierarchy").clicked() {
                viewer.controls.build.structure = StructureKind::Hierarchy;
                asked.load = Some(source);
            }
        }
        let outdated = viewer.is_outdated() && viewer.loading().is_none();
        let build = ui.add_enabled(outdated, egui::Button::new("Build anew"));
        asked.rebuild = build.on_disabled_hover_text("Built as it says above").clicked();
    });
}

fn detail(ui: &mut Ui, viewer: &mut Viewer) {
    let triangulations = viewer.scene().is_some_and(|scene| scene.model().baked().has_triangulations());
    section(ui, "Level of detail", |ui| {
        let tolerances = &mut viewer.controls.tolerances;
        let slider =
            Slider::new(&mut tolerances.anywhere, 0.1..=50.0).logarithmic(true).text("tolerance, px");
        ui.add(slider).on_hover_text("How far the surface on the screen may be off, pixels");
        let mut own = tolerances.silhouette.is_some();
        ui.horizontal(|ui| {
            ui.checkbox(&mut own, "silhouette")
                .on_hover_text("A tolerance of its own for what may be on the silhouette");
            let mut pixels = tolerances.silhouette.unwrap_or(tolerances.anywhere * 0.5);
            ui.add_enabled(own, Slider::new(&mut pixels, 0.1..=50.0).logarithmic(true).text("px"));
            tolerances.silhouette = own.then_some(pixels);
        });
        ui.add_enabled_ui(!triangulations, |ui| {
            choice(
                ui,
                "Error",
                "Distance of surfaces, or of points with the same texture coordinates",
                &mut tolerances.error,
                &[(ErrorKind::Geometric, "geometric"), (ErrorKind::Parametric, "parametric")],
            );
        });
        let options = &mut viewer.controls.options;
        choice(
            ui,
            "Vertices",
            "Static: one vertex buffer for all instances; compact: each holds the vertices that it draws",
            &mut options.buffer,
            &[(VertexBuffer::Shared, "static"), (VertexBuffer::Packed, "compact")],
        );
        if triangulations {
            choice(
                ui,
                "Triangles",
                "Exact: no triangle is larger than asked for; minimal: as few as there can be",
                &mut options.triangulation,
                &[(Triangulation::Exact, "exact"), (Triangulation::Minimal, "minimal")],
            );
        }
        let mut limited = options.triangles.is_some();
        ui.horizontal(|ui| {
            ui.checkbox(&mut limited, "budget")
                .on_hover_text("Most triangles of each object; the tolerance gives way");
            let mut most = options.triangles.unwrap_or(10_000);
            // A name behind it would not fit: wider than the panel, it moves the panel's edge and hides the scroll bar.
            ui.add_enabled(limited, Slider::new(&mut most, 100..=1_000_000).logarithmic(true));
            *options = options.with_triangles(limited.then_some(most));
        });
        let mut moves = options.geomorph.is_some();
        ui.horizontal(|ui| {
            ui.checkbox(&mut moves, "geomorph")
                .on_hover_text("Vertices move to their places instead of jumping");
            let mut seconds = options.geomorph.map_or(0.3, |geomorph| geomorph.duration);
            ui.add_enabled(moves, Slider::new(&mut seconds, 0.05..=3.0).logarithmic(true).text("s"));
            options.geomorph = moves.then(|| Geomorph::default().with_duration(seconds));
        });
        if viewer.adapted.change.over_budget {
            ui.weak("the coarsest mesh is above the budget");
        }
        let mut frozen = viewer.is_frozen();
        let freeze = ui.checkbox(&mut frozen, "freeze the cut, show its frustum");
        if freeze.on_hover_text("To walk around what is drawn for the present view").changed() {
            viewer.freeze(frozen);
        }
    });
}

fn control(ui: &mut Ui, viewer: &mut Viewer) {
    let gmesh = viewer.scene().is_some_and(|scene| scene.model().gmesh().is_some());
    section(ui, "Control", |ui| {
        let control = &mut viewer.controls.control;
        let mut all = vec![
            (Controller::Off, "off"),
            (Controller::Triangles, "triangle budget"),
            (Controller::Time, "frame time"),
        ];
        if gmesh {
            all.push((Controller::Bias, "bias of g-meshes"));
        } else if control.controller == Controller::Bias {
            control.controller = Controller::Off;
        }
        choice(
            ui,
            "All objects",
            "What is held over all objects of the scene",
            &mut control.controller,
            &all,
        );
        match control.controller {
            Controller::Off => return,
            Controller::Triangles | Controller::Bias => {
                let slider = Slider::new(&mut control.triangles, 1_000..=20_000_000);
                ui.add(slider.logarithmic(true).text("triangles")).on_hover_text("Of all objects together");
            }
            Controller::Time => {
                let mut millis = control.seconds * 1e3;
                let slider = Slider::new(&mut millis, 2.0..=500.0).logarithmic(true).text("ms a frame");
                ui.add(slider).on_hover_text("From the start of a frame to the start of the next");
                control.seconds = millis * 1e-3;
            }
        }
        if let Some(controlled) = viewer.adapted.controlled {
            let (drawn, target) = (controlled.change.triangles as f32, controlled.target as f32);
            ui.weak(format!("{} of {} triangles", short(drawn, ""), short(target, "")));
            if controlled.change.over_budget {
                ui.weak("the coarsest levels are above the budget");
            }
        }
        viewer.history.show(ui, [OUTPUT]);
    });
}

fn picture(ui: &mut Ui, viewer: &mut Viewer) {
    section(ui, "Picture", |ui| {
        let controls = &mut viewer.controls;
        choice(
            ui,
            "Shading",
            "What colours surfaces: level and error show what the structure does",
            &mut controls.shading,
            &[
                (Shading::Material, "material"),
                (Shading::Level, "level"),
                (Shading::Error, "error"),
                (Shading::Normal, "normal"),
                (Shading::Texture, "texture"),
                (Shading::Dirty, "dirty triangles"),
            ],
        );
        choice(
            ui,
            "Beside it",
            "Pictures of the same view: of the full mesh, and of the difference of colours, or of the distance between the surfaces, \
             for which normals do not count",
            &mut controls.layout,
            &[
                (Layout::Nothing, "nothing"),
                (Layout::Full, "full mesh"),
                (Layout::Difference, "that and difference"),
                (Layout::Distance, "that and distance"),
            ],
        );
        ui.horizontal(|ui| {
            let compares = controls.layout.pictures() == 3;
            ui.add_enabled(!compares, egui::Checkbox::new(&mut controls.wire, "wireframe"))
                .on_hover_text("Edges of triangles")
                .on_disabled_hover_text("differences are those of surfaces");
            ui.checkbox(&mut controls.flat, "flat").on_hover_text("One normal for each triangle");
        });
    });
}

fn camera(ui: &mut Ui, viewer: &mut Viewer) {
    section(ui, "Camera", |ui| {
        let size = viewer.size();
        ui.horizontal_wrapped(|ui| {
            let mut flies = matches!(viewer.hands, Hands::Fly(_));
            ui.selectable_value(&mut flies, false, "orbit").on_hover_text("Around the middle of the picture");
            ui.selectable_value(&mut flies, true, "fly").on_hover_text("W A S D Q E, shift is fast");
            viewer.hands.fly(flies, size);
            if ui.button("Show all").on_hover_text("double click").clicked() {
                viewer.reset_camera();
            }
            let mut z_up = viewer.controls.z_up;
            if ui.checkbox(&mut z_up, "z up").on_hover_text("The model stands on its x and y").changed() {
                viewer.controls.z_up = z_up;
                viewer.reset_camera();
            }
        });
        let mut degrees = viewer.controls.field_of_view.to_degrees();
        ui.add(Slider::new(&mut degrees, 10.0..=120.0).text("field of view"))
            .on_hover_text("Vertical, degrees");
        viewer.controls.field_of_view = degrees.to_radians();
        ui.horizontal_wrapped(|ui| {
            let [records, plays] = viewer.tape();
            let record = ui.button(if records { "Stop recording" } else { "Record path" });
            if record.on_hover_text("Keeps every frame's camera, and writes it as .csv").clicked() {
                viewer.record(!records);
            }
            let frames = viewer.path_frames();
            let text = if plays { "Stop".to_owned() } else { format!("Replay {frames} frames") };
            let play = ui.add_enabled(frames > 0 && !records, egui::Button::new(text));
            let about = "The recorded path, or a .csv that was dropped";
            if play.on_hover_text(about).on_disabled_hover_text(about).clicked() {
                viewer.play(!plays);
            }
        });
    });
}

fn numbers(ui: &mut Ui, viewer: &Viewer) {
    section(ui, "Numbers", |ui| {
        viewer.history.show(ui, [TESTS, CHANGES, FRAME, BYTES]);
        if let Some(scene) = viewer.scene() {
            let [own, shared] = scene.card_memory();
            ui.weak(format!(
                "on the card: {}B of instances, {}B shared",
                short(own as f32, ""),
                short(shared as f32, "")
            ));
        }
        ui.weak(viewer.card());
    });
}
