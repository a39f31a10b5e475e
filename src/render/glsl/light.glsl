// The scene's lights.

const int light_max = 8;
uniform int light_count;
uniform int light_kind[light_max];     // 0 sun, 1 point
uniform vec4 light_place[light_max];   // sun: unit direction towards it; point: position relative to the camera; w: tangent of the
                                       // sun's angular radius, or the point light's radius
uniform vec3 light_color[light_max];   // sun: irradiance; point: radiant intensity
uniform vec3 light_sun;                // direction of the first sun; +z when there is none

struct LightSample {
    vec3 direction;  // unit, towards the light
    float distance;
    float spread;    // tangent of the half-angle it is seen under
    vec3 irradiance; // on a surface that faces it, unoccluded
};

LightSample light_at(int i, vec3 position) {
    if (light_kind[i] == 0) return LightSample(light_place[i].xyz, 1e30, light_place[i].w, light_color[i]);
    vec3 to = light_place[i].xyz - position;
    float d2 = max(dot(to, to), 1e-12);
    float d = sqrt(d2);
    return LightSample(to / d, d, light_place[i].w / d, light_color[i] / d2);
}

// A direction within the light's disc, for u in [0,1)².
vec3 light_point(LightSample light, vec2 u) {
    vec3 helper = abs(light.direction.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    vec3 x = normalize(cross(helper, light.direction));
    vec3 y = cross(light.direction, x);
    float radius = light.spread * sqrt(u.x);
    float angle = 6.283185307 * u.y;
    return normalize(light.direction + radius * (cos(angle) * x + sin(angle) * y));
}
