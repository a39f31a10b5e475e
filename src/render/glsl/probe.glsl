#include "render/glsl/surface.glsl"

// One pixel: the distance from the camera to the nearest surface, and how much of a way from there is free, 0..1.

uniform vec3 probe_way; // from the camera [world units]; 0: none

// A way ends where the surface is so much nearer than at its beginning: a camera that is moved again and again never arrives.
const float probe_nearest = 0.05;

void kernel_main(ivec2 pixel, out vec4 result) {
    float distance_here = surface_distance(vec3(0.0));
    float way = length(probe_way);
    float t = 0.0;
    float d = distance_here;
    // Who is inside gets out wherever it likes.
    if (way <= 0.0 || d <= 0.0) t = way;
    for (int i = 0; i < 300 && t < way; ++i) {
        float next = min(t + 0.9 * d, way);
        d = surface_distance(probe_way * (next / way));
        if (d < probe_nearest * distance_here) break;
        t = next;
    }
    // Exactly 1 where all of the way is free: on GPUs a quotient of equal numbers may miss it.
    result = vec4(distance_here, t < way ? t / way : 1.0, 0.0, 1.0);
}
