#include "render/glsl/phase.glsl"

// A haze over the whole world: everywhere alike, or thinning out exponentially with the height. Its optical depths and free flights
// are closed forms, so that it needs no majorants.

uniform float camera_height; // z of the camera in the world [world units]

struct Haze {
    float density; // extinction at the height `base` [1/world unit]
    float base;    // [world units]
    float scale;   // height by which it becomes thinner by a factor of e [world units]; 0: it does not
};

float haze_extinction(Haze haze, vec3 position) {
    if (haze.scale <= 0.0) return haze.density;
    return haze.density * exp(clamp((haze.base - camera_height - position.z) / haze.scale, -60.0, 30.0));
}

// Optical depth of the way from `origin` to there: the integral of the extinction.
float haze_depth(Haze haze, vec3 origin, vec3 direction, float t) {
    float here = haze_extinction(haze, origin);
    float k = haze.scale > 0.0 ? direction.z / haze.scale : 0.0;
    float x = k * t;
    if (abs(x) < 1e-3) return here * t * (1.0 - 0.5 * x);
    return here * (1.0 - exp(clamp(-x, -60.0, 60.0))) / k;
}

// Where a ray has gone through that optical depth; 1e30: never.
float haze_flight(Haze haze, vec3 origin, vec3 direction, float depth) {
    float here = haze_extinction(haze, origin);
    if (here <= 0.0) return 1e30;
    float k = haze.scale > 0.0 ? direction.z / haze.scale : 0.0;
    float x = depth * k / here;
    if (x >= 1.0) return 1e30;
    return abs(x) < 1e-3 ? depth / here * (1.0 + 0.5 * x) : -log(1.0 - x) / k;
}
