#include "terrain/glsl/tile_slope.glsl"

// A tile as a face of the background's cube keeps it (terrain/background.hpp).

layout(location = 0) out vec4 seen; // distance [world]; slopes along x and y; level

void main() { seen = vec4(length(vertex_position), tile_slope(), vertex_level); }
