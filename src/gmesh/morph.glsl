// Share of the way of a vertex to its target: 0 for vertices that stay.
float multires_morph_share(int vertex_index, uint first_moving, float share) {
    return uint(vertex_index) >= first_moving ? share : 0.0;
}

// Values on the way; exactly `own` at share 0 and `other` at share 1.
float multires_morph1(float own, float other, float share) {
    return (1.0 - share) * own + share * other;
}

vec2 multires_morph2(vec2 own, vec2 other, float share) {
    return (1.0 - share) * own + share * other;
}

vec3 multires_morph3(vec3 own, vec3 other, float share) {
    return (1.0 - share) * own + share * other;
}

vec4 multires_morph4(vec4 own, vec4 other, float share) {
    return (1.0 - share) * own + share * other;
}
