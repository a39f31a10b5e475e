in vec3 vertex_position;
flat in vec2 vertex_kind;

layout(location = 0) out vec4 seen_position; // as tile_fragment.glsl
layout(location = 1) out vec4 seen_slope;

void main() {
    seen_position = vec4(vertex_position, 1.0);
    seen_slope = vec4(0.0, 0.0, vertex_kind);
}
