//! Promise: the library's shader functions are accepted as they are, the card moves vertices to where the processor moves them, and
//! instances of a g-mesh share all that is on the card but two numbers each.

mod card;

use std::sync::Arc;

use card::{model, moving, open, read_back, shared};
use multires::gmesh::{Gmesh, MORPH_GLSL, MORPH_WGSL, Morph};
use multires::lod::MorphUniform;
use multires::mesh::{Mesh, shapes};
use multires_viewer::camera::{Lens, Orbit, Pose, Tolerances};
use multires_viewer::gpu::Gpu;
use multires_viewer::headless::{STEP, Stage};
use multires_viewer::renderer::{Look, TRIANGLE, Vertex};
use multires_viewer::scene::{BuildOptions, Builtin, Model, Overlays, StructureKind};
use wgpu::util::DeviceExt;

const LENS: Lens = Lens { field_of_view: 0.8, size: [400, 400] };

fn gmesh(mesh: &Mesh) -> Arc<Model> {
    model(mesh, &BuildOptions::default().with_structure(StructureKind::Gmesh))
}

fn structure(model: &Model) -> &Gmesh {
    model.gmesh().unwrap().structure()
}

#[test]
fn the_functions_are_wgsl() {
    let module =
        naga::front::wgsl::parse_str(MORPH_WGSL).map_err(|error| error.emit_to_string(MORPH_WGSL)).unwrap();
    let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), Default::default());
    validator.validate(&module).unwrap();
    let names: Vec<_> = module.functions.iter().filter_map(|(_, f)| f.name.as_deref()).collect();
    assert_eq!(names.len(), 5, "{names:?}");
}

/// The constant is for `#version 300 es`. Naga reads `#version 450`, where the number of a vertex has another name.
#[test]
fn the_functions_are_glsl() {
    let shader = format!(
        "#version 450
precision highp float;
{MORPH_GLSL}
layout(location = 0) in vec3 own;
layout(location = 1) in vec3 other;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec2 other_uv;
layout(location = 0) out vec4 varying;
layout(set = 0, binding = 0) uniform Morph {{ uint first_moving; float share; }};
void main() {{
    float share = multires_morph_share(int(gl_VertexIndex), first_moving, share);
    varying = multires_morph4(vec4(own, 0.0), vec4(other, multires_morph1(0.0, 1.0, share)), share);
    varying.xy += multires_morph2(uv, other_uv, share);
    gl_Position = vec4(multires_morph3(own, other, share), 1.0);
}}
"
    );
    let mut frontend = naga::front::glsl::Frontend::default();
    let options = naga::front::glsl::Options::from(naga::ShaderStage::Vertex);
    let module = frontend.parse(&options, &shader).map_err(|error| error.emit_to_string(&shader)).unwrap();
    let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), Default::default());
    validator.validate(&module).unwrap();
    // Of GLSL ES 3.00: nothing that needs a later version, and no `precision` or `#version` of its own.
    assert!(!MORPH_GLSL.contains('#') && !MORPH_GLSL.contains("layout") && !MORPH_GLSL.contains("precision"));
}

/// Calls all functions on every vertex: ten floats each, as [`Vertex`].
const KERNEL: &str = "
struct Morph { first_moving: u32, share: f32 }

@group(0) @binding(0) var<storage, read> own: array<f32>;
@group(0) @binding(1) var<storage, read> other: array<f32>;
@group(0) @binding(2) var<uniform> morph: Morph;
@group(0) @binding(3) var<storage, read_write> drawn: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let v = 10u * id.x;
    if v >= arrayLength(&drawn) { return; }
    let share = multires_morph_share(id.x, morph.first_moving, morph.share);
    let position = multires_morph3(
        vec3(own[v], own[v + 1u], own[v + 2u]), vec3(other[v], other[v + 1u], other[v + 2u]), share);
    let normal = multires_morph2(vec2(own[v + 3u], own[v + 4u]), vec2(other[v + 3u], other[v + 4u]), share);
    let up = multires_morph1(own[v + 5u], other[v + 5u], share);
    let rest = multires_morph4(
        vec4(own[v + 6u], own[v + 7u], own[v + 8u], own[v + 9u]),
        vec4(other[v + 6u], other[v + 7u], other[v + 8u], other[v + 9u]), share);
    drawn[v] = position.x;
    drawn[v + 1u] = position.y;
    drawn[v + 2u] = position.z;
    drawn[v + 3u] = normal.x;
    drawn[v + 4u] = normal.y;
    drawn[v + 5u] = up;
    drawn[v + 6u] = rest.x;
    drawn[v + 7u] = rest.y;
    drawn[v + 8u] = rest.z;
    drawn[v + 9u] = rest.w;
}
";

/// The functions on the card, over the vertices of a model.
struct Kernel {
    gpu: Gpu,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    morph: wgpu::Buffer,
    drawn: wgpu::Buffer,
    vertices: usize,
}

impl Kernel {
    fn new(gpu: &Gpu, model: &Model) -> Self {
        let device = &gpu.device;
        let vertices = model.vertices();
        let targets = structure(model).target_values(vertices);
        let buffer = |bytes: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: bytes,
                usage,
            })
        };
        let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let own = buffer(bytemuck::cast_slice(vertices), storage);
        let other = buffer(bytemuck::cast_slice(&targets), storage);
        let drawn = buffer(&vec![0; size_of_val(&vertices[..])], storage);
        let morph = buffer(
            bytemuck::bytes_of(&MorphUniform::default()),
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        );
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl([KERNEL, MORPH_WGSL].concat().into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let entries: Vec<_> = (0..)
            .zip([&own, &other, &morph, &drawn])
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        Self { gpu: gpu.clone(), pipeline, group, morph, drawn, vertices: vertices.len() }
    }

    fn run(&self, morph: MorphUniform) -> Vec<Vertex> {
        self.gpu.queue.write_buffer(&self.morph, 0, bytemuck::bytes_of(&morph));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups((self.vertices as u32).div_ceil(64), 1, 1);
        }
        self.gpu.queue.submit([encoder.finish()]);
        bytemuck::pod_collect_to_vec(&read_back(&self.gpu, &self.drawn, self.vertices * size_of::<Vertex>()))
    }
}

#[test]
fn the_card_moves_vertices_to_where_the_processor_does() {
    let Some(gpu) = open("the_card_moves_vertices_to_where_the_processor_does") else { return };
    for (name, mesh) in [("rock", shapes::rock(5_000, 1)), ("prop", shapes::prop(8))] {
        let model = gmesh(&mesh);
        let (gmesh, values) = (structure(&model), model.vertices());
        let kernel = Kernel::new(&gpu, &model);
        let (mut states, mut most) = (0, 0.0_f64);
        let mut expected = Vec::new();
        for level in 0..gmesh.levels().len() {
            for share in [0.0, 1e-3, 0.25, 1.0 / 3.0, 0.5, 0.7, 0.999, 1.0] {
                let morph = Morph { level, share };
                gmesh.fill(values, morph, &mut expected);
                let drawn = kernel.run(gmesh.uniform(morph));
                for (v, (card, own)) in drawn.iter().zip(&expected).enumerate() {
                    let [card, own]: [[f32; 10]; 2] = [bytemuck::cast(*card), bytemuck::cast(*own)];
                    let apart = card.iter().zip(own).map(|(a, b)| f64::from((a - b).abs()));
                    let apart = apart.fold(0.0, f64::max) / mesh.diagonal();
                    most = most.max(apart);
                    assert!(apart <= 1e-6, "{name}, {morph:?}, vertex {v}: {apart} of the diagonal");
                    assert!(share % 1.0 != 0.0 || card == own, "{name}, {morph:?}, vertex {v}: not exact");
                }
                states += 1;
            }
        }
        eprintln!("{name}: {states} states of {} levels, {most:.1e} of the diagonal", gmesh.levels().len());
    }
    assert_eq!(gpu.error(), None);
}

fn framing(centre: [f64; 3], diagonal: f64, share: f64, around: f64) -> Pose {
    let orbit = Orbit::framing(centre, 0.5 * diagonal, LENS.field_of_view, false);
    Orbit { distance: share * diagonal, around, ..orbit }.pose()
}

#[test]
fn pictures_of_card_and_processor_are_equal() {
    let Some(gpu) = open("pictures_of_card_and_processor_are_equal") else { return };
    let place = glam::Mat4::IDENTITY.to_cols_array_2d();
    let mut shares = Vec::new();
    for (name, mesh) in
        [("rock", shapes::rock(30_000, 5)), ("prop", shapes::prop(24)), ("demo", shapes::demo())]
    {
        let model = gmesh(&mesh);
        let mut stages = [shared(), moving(shared(), 0.05)].map(|options| {
            Stage::new(gpu.clone(), Arc::clone(&model), &[place], options, LENS.size, 1).unwrap()
        });
        let (centre, diagonal) = (stages[0].scene().centre(), stages[0].scene().diagonal());
        // States rest half of the way from level to level, so several tolerances are tried.
        let poses = [(6.0, 0.3), (2.5, 1.1), (1.4, 1.9), (0.8, 2.7)];
        for ((away, around), pixels) in
            poses.into_iter().flat_map(|pose| [1.0, 2.6, 5.0].map(|px| (pose, px)))
        {
            let pose = framing(centre, diagonal, away, around);
            let look = pose.look(&LENS, diagonal);
            let views = [pose.view(&LENS, &Tolerances::default().with_anywhere(pixels)).unwrap()];
            let pictures = stages.each_mut().map(|stage| {
                let is_card = stage.scene().instances().all(|lod| lod.shares_vertices());
                assert_eq!(is_card, stage.scene().options().geomorph.is_none());
                // The processor's state comes after the view's.
                for _ in 0..120 {
                    stage.frame(&views, None, Overlays::default(), STEP);
                }
                let report = stage.frame(&views, Some(&look), Overlays::default(), STEP);
                (report.adapted.change.triangles, stage.picture().unwrap())
            });
            let [(triangles, card), (as_many, processor)] = &pictures;
            assert_eq!(triangles, as_many);
            let uniform = stages[0].scene().instances().next().unwrap().morph().unwrap();
            shares.push(uniform.share);
            let apart =
                card.iter().zip(processor).filter(|(a, b)| (0..4).any(|c| a[c].abs_diff(b[c]) > 1)).count();
            let surface = card.iter().filter(|pixel| pixel[3] > 0).count();
            eprintln!(
                "{name}, {triangles} triangles, share {:.3}: {apart} of {surface} pixels",
                uniform.share
            );
            assert!(surface > 1_000, "{name}: {surface} pixels");
            assert!(apart * 200 < surface, "{name}: {apart} of {surface} pixels differ");
        }
    }
    assert!(shares.iter().filter(|share| **share > 0.1 && **share < 0.9).count() >= 4, "{shares:?}");
    assert_eq!(gpu.error(), None);
}

#[test]
fn a_hundred_frames_of_fifty_instances_upload_two_numbers_each() {
    let Some(gpu) = open("a_hundred_frames_of_fifty_instances_upload_two_numbers_each") else { return };
    let model = gmesh(&shapes::rock(5_000, 1));
    let places: Vec<_> = Builtin::Crowd.places().into_iter().take(50).collect();
    let mut stage = Stage::new(gpu.clone(), Arc::clone(&model), &places, shared(), LENS.size, 1).unwrap();
    let (centre, diagonal) = (stage.scene().centre(), stage.scene().diagonal());
    let mut counts = Vec::new();
    for frame in 0..101 {
        let pose = framing(centre, diagonal, 2.0 - 0.019 * frame as f64, 0.02 * frame as f64);
        let views = [pose.view(&LENS, &Tolerances::default()).unwrap()];
        let report = stage.frame(&views, None, Overlays::default(), STEP);
        let [vertices, indices, other] =
            [report.uploaded.vertices, report.uploaded.indices, report.uploaded.other];
        if frame == 0 {
            let held: usize =
                (0..structure(&model).groups()).map(|g| structure(&model).index_buffer(g).len()).sum();
            assert_eq!(vertices, 2 * size_of_val(&model.vertices()[..]) as u64);
            assert_eq!(indices, held as u64 * TRIANGLE);
            let [own, shared] = stage.scene().card_memory();
            assert_eq!((own, shared), (50 * 8, vertices + indices));
        } else {
            assert_eq!((vertices, indices), (0, 0), "frame {frame}");
            assert!(other == 0 || other == 50 * 8, "frame {frame}: {other} bytes");
        }
        assert_eq!(stage.scene().index_bytes(), report.adapted.change.triangles as u64 * TRIANGLE);
        counts.push(report.adapted.change.triangles);
    }
    counts.sort_unstable();
    assert!(counts[100] > 2 * counts[0], "{} to {} triangles", counts[0], counts[100]);
    assert_eq!(gpu.error(), None);
}

#[test]
fn ways_of_drawing_change_on_the_fly() {
    let Some(gpu) = open("ways_of_drawing_change_on_the_fly") else { return };
    let model = gmesh(&shapes::prop(16));
    let place = glam::Mat4::IDENTITY.to_cols_array_2d();
    let mut stage = Stage::new(gpu.clone(), model, &[place], Default::default(), LENS.size, 1).unwrap();
    let (centre, diagonal) = (stage.scene().centre(), stage.scene().diagonal());
    let pose = framing(centre, diagonal, 1.2, 0.5);
    let look: Look = pose.look(&LENS, diagonal);
    let views = [pose.view(&LENS, &Tolerances::default().with_anywhere(2.0)).unwrap()];
    let glowing = Overlays { written: true, ..Overlays::default() };
    let mut pictures = Vec::new();
    for options in [shared(), Default::default(), moving(shared(), 0.05), shared()] {
        let (device, queue) = (gpu.device.clone(), gpu.queue.clone());
        let mut uploads = multires_viewer::renderer::Uploads::default();
        stage.scene_mut().set_options(&device, &mut uploads, options).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        uploads.flush(&device, &queue, &mut encoder);
        queue.submit([encoder.finish()]);
        for _ in 0..60 {
            stage.frame(&views, None, Overlays::default(), STEP);
        }
        stage.frame(&views, Some(&look), Overlays::default(), STEP);
        pictures.push(stage.picture().unwrap());
        // What was written glows no more, and no longer ago than it was drawn.
        stage.frame(&views, Some(&look), glowing, STEP);
        assert!(pictures.last() == Some(&stage.picture().unwrap()), "{options:?}: something glows");
    }
    assert!(pictures[0] == pictures[3], "the card's path after all others");
    assert_eq!(gpu.error(), None);
}
