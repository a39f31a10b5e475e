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

// Both kinds are discs of uniform radiance: a sun's cone is the same everywhere, a point light is the sphere that it is. Within the
// sphere it is as bright as just outside.
LightSample light_at(int i, vec3 position) {
    if (light_kind[i] == 0) return LightSample(light_place[i].xyz, 1e30, light_place[i].w, light_color[i]);
    vec3 to = light_place[i].xyz - position;
    float radius2 = light_place[i].w * light_place[i].w;
    float seen2 = max(dot(to, to), 1e-12);
    float d2 = max(seen2, 1.001 * radius2);
    return LightSample(to * inversesqrt(seen2), sqrt(d2), light_place[i].w * inversesqrt(d2 - radius2), light_color[i] / d2);
}

// One minus the cosine of the half-angle that the light is seen under, without cancellation.
float light_cap(LightSample light) {
    float secant2 = 1.0 + light.spread * light.spread;
    return light.spread * light.spread / (secant2 + sqrt(secant2));
}

// Lights seen under less than this are points for all purposes: no ray meets them by chance.
bool light_sharp(LightSample light) { return light.spread < 1e-4; }

// How far the light is in a direction, of which the sine of the angle to its centre is known: a sphere's near side, as nothing
// within the sphere can be in the way.
float light_near(LightSample light, float cosine, float sine2) {
    float edge2 = light.spread * light.spread / (1.0 + light.spread * light.spread);
    return light.distance * (cosine - sqrt(max(edge2 - sine2, 0.0)));
}

// What of the light is seen in a direction: its radiance, or nothing; and how far away.
vec3 light_radiance(LightSample light, vec3 direction, out float distance) {
    vec3 aside = cross(light.direction, direction);
    float cosine = dot(light.direction, direction);
    float sine2 = dot(aside, aside);
    float edge2 = light.spread * light.spread / (1.0 + light.spread * light.spread);
    distance = light_near(light, cosine, sine2);
    if (light_sharp(light) || cosine <= 0.0 || sine2 >= edge2) return vec3(0.0);
    return light.irradiance * (0.318309886 / edge2);
}

// Probability per solid angle of a direction from light_sample().
float light_pdf(LightSample light) { return 0.159154943 / max(light_cap(light), 1e-30); }

// The same light by one point of its disc, for u in [0, 1)²: uniform in solid angle. The mean over u is the whole light's.
LightSample light_sample(LightSample light, vec2 u) {
    vec3 helper = abs(light.direction.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    vec3 x = normalize(cross(helper, light.direction));
    vec3 y = cross(light.direction, x);
    float cap = light_cap(light);
    float h = cap * u.x;
    float r = sqrt(h * (2.0 - h));
    float angle = 6.283185307 * u.y;
    vec3 direction = normalize((1.0 - h) * light.direction + r * (cos(angle) * x + sin(angle) * y));
    // Radiance times solid angle, of a disc whose radiance times *projected* solid angle is the irradiance.
    vec3 irradiance = light.irradiance * (2.0 / (2.0 - cap));
    return LightSample(direction, light_near(light, 1.0 - h, r * r), light.spread, irradiance);
}
