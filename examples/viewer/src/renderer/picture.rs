//! Textures: pixels in all sizes, to be painted on surfaces without shimmer.

/// A texture and how it is sampled.
pub struct Paint {
    pub(super) group: wgpu::BindGroup,
}

/// Squares across the checker, and pixels across the picture of it.
const SQUARES: u32 = 16;
const CHECKER: u32 = 512;

/// Formats of pictures: sRGB, and numbers.
pub(super) const COLOURS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const NORMALS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl Paint {
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layout: &wgpu::BindGroupLayout,
        (size, pixels): ([u32; 2], &[[u8; 4]]),
        normals: Option<([u32; 2], &[[u8; 4]])>,
    ) -> Self {
        let view = texture(device, queue, COLOURS, size, &levels(size, pixels));
        // A single texel is no map: shaders leave normals as they are.
        let (size, pixels) = normals.unwrap_or(([1; 2], &[[128, 128, 255, 255]]));
        let normals = texture(device, queue, NORMALS, size, &levels(size, pixels));
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: 8,
            ..Default::default()
        });
        let entries = [
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&normals) },
        ];
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("paint"),
            layout,
            entries: &entries,
        });
        Self { group }
    }

    /// The pixels of a checker with a colour for each quarter, so that one sees where a texture slides or is mirrored; and their
    /// number on a side.
    pub fn checker() -> (u32, Vec<[u8; 4]>) {
        let pixel = |i: u32| {
            let [x, y] = [i % CHECKER, i / CHECKER];
            let [across, down] = [x, y].map(|at| at * SQUARES / CHECKER);
            let light = (across + down) % 2 == 0;
            let quarter = 2 * u32::from(2 * down >= SQUARES) + u32::from(2 * across >= SQUARES);
            let [r, g, b] =
                [[222, 120, 88], [96, 156, 210], [104, 168, 120], [214, 176, 92]][quarter as usize];
            if light { [236, 236, 232, 255] } else { [r, g, b, 255] }
        };
        (CHECKER, (0..CHECKER * CHECKER).map(pixel).collect())
    }
}

/// A picture and its halves, down to one pixel.
fn levels(size: [u32; 2], pixels: &[[u8; 4]]) -> Vec<Vec<[u8; 4]>> {
    let mut levels = vec![pixels.to_vec()];
    let mut from = size;
    while from != [1, 1] {
        let to = from.map(|side| (side / 2).max(1));
        let last = &levels[levels.len() - 1];
        let pixel = |i: u32| -> [u8; 4] {
            let [x, y] = [i % to[0], i / to[0]];
            let four = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| {
                let [x, y] = [(2 * x + dx).min(from[0] - 1), (2 * y + dy).min(from[1] - 1)];
                last[(y * from[0] + x) as usize]
            });
            std::array::from_fn(|c| (four.iter().map(|p| u16::from(p[c])).sum::<u16>() / 4) as u8)
        };
        let next = (0..to[0] * to[1]).map(pixel).collect();
        levels.push(next);
        from = to;
    }
    levels
}

/// A texture from its levels, the largest first; each half as wide and high as the one before.
pub(super) fn texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    format: wgpu::TextureFormat,
    size: [u32; 2],
    levels: &[Vec<[u8; 4]>],
) -> wgpu::TextureView {
    let extent = |level: u32| wgpu::Extent3d {
        width: (size[0] >> level).max(1),
        height: (size[1] >> level).max(1),
        depth_or_array_layers: 1,
    };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: extent(0),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, pixels) in (0..).zip(levels) {
        let size = extent(level);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            pixels.as_flattened(),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * size.width),
                rows_per_image: None,
            },
            size,
        );
    }
    texture.create_view(&Default::default())
}
