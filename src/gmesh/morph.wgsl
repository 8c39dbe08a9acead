// Share of the way of a vertex to its target: 0 for vertices that stay.
fn multires_morph_share(vertex_index: u32, first_moving: u32, share: f32) -> f32 {
    return select(0.0, share, vertex_index >= first_moving);
}

// Values on the way; exactly `own` at share 0 and `other` at share 1.
fn multires_morph1(own: f32, other: f32, share: f32) -> f32 {
    return (1.0 - share) * own + share * other;
}

fn multires_morph2(own: vec2<f32>, other: vec2<f32>, share: f32) -> vec2<f32> {
    return (1.0 - share) * own + share * other;
}

fn multires_morph3(own: vec3<f32>, other: vec3<f32>, share: f32) -> vec3<f32> {
    return (1.0 - share) * own + share * other;
}

fn multires_morph4(own: vec4<f32>, other: vec4<f32>, share: f32) -> vec4<f32> {
    return (1.0 - share) * own + share * other;
}
