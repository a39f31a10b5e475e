// The scene's lights.
//
// The engine adds: const int light_count; const bool light_discs (some are suns or points), light_panels (some are rectangles),
// light_local (some are not suns), light_shown (some rectangles are seen by the camera). Uniforms would do, but rasterisers on the CPU
// compute what no pixel needs.

const int light_max = 8;
uniform int light_kind[light_max];     // 0 sun, 1 point, 2 rectangle
uniform vec4 light_place[light_max];   // sun: unit direction towards it; others: position relative to the camera; w: tangent of the
                                       // sun's angular radius, the point light's radius, or 1 for a rectangle that the camera sees
uniform vec4 light_x[light_max];       // rectangle: unit vectors along its sides, and half their lengths; it shines where
uniform vec4 light_y[light_max];       // cross(x, y) points
uniform vec3 light_color[light_max];   // sun: irradiance; point: radiant intensity; rectangle: radiance
uniform vec3 light_sun;                // direction of the first sun; +z when there is none

struct LightSample {
    vec3 direction;  // unit, towards the light
    float distance;
    float spread;    // tangent of the half-angle it is seen under
    vec3 irradiance; // on a surface that faces it, unoccluded
};

bool light_flat(int i) { return light_panels && (!light_discs || light_kind[i] == 2); }

// A rectangle as it is seen from a place, with coordinates along its sides and away from it (Urena, Fajardo & King 2013, "An
// Area-Preserving Parametrization for Spherical Rectangles", section 4).
struct LightPanel {
    vec3 x;
    vec3 y;
    vec4 ends;        // of its sides, from the place: x0, x1, y0, y1
    float height;     // of the place above its plane, on the side that shines; not above 0: it is not seen
    float solid;      // solid angle [sr]
    bool small;       // its solid angle is hardly known: points are drawn by area
};

// Arc tangents of y / x for x > 0 to 2e-8 (Abramowitz & Stegun 1964, 4.4.49); GPUs' own may be wrong by 1e-4.
vec4 light_atan(vec4 y, vec4 x) {
    vec4 a = abs(y);
    vec4 r = min(a, x) / max(max(a, x), 1e-30);
    vec4 q = r * r;
    vec4 angle = r + r * q * (-0.3333314528 + q * (0.1999355085 + q * (-0.1420889944 + q * (0.1065626393 + q * (-0.0752896400 +
                     q * (0.0429096138 + q * (-0.0161657367 + q * 0.0028662257)))))));
    return sign(y) * mix(angle, 1.570796327 - angle, vec4(greaterThan(a, x)));
}

LightPanel light_panel(int i, vec3 position) {
    vec4 x = light_x[i];
    vec4 y = light_y[i];
    vec3 to = light_place[i].xyz - position;
    float height = -dot(to, cross(x.xyz, y.xyz));
    vec2 centre = vec2(dot(to, x.xyz), dot(to, y.xyz));
    vec4 ends = vec4(centre.x - x.w, centre.x + x.w, centre.y - y.w, centre.y + y.w);
    // Far away the solid angle is too small a difference of large numbers; but there it is the area's projection.
    float d2 = max(dot(to, to), 1e-30);
    float solid = 4.0 * x.w * y.w * max(height, 0.0) / (d2 * sqrt(d2));
    bool small = 100.0 * (x.w * x.w + y.w * y.w) < d2;
    if (!small) {
        vec4 cx = ends.yxyx;
        vec4 cy = ends.wzzw;
        vec4 corners = light_atan(cx * cy, max(height, 1e-30) * sqrt(cx * cx + cy * cy + height * height));
        solid = (corners.x + corners.y) - (corners.z + corners.w);
    }
    return LightPanel(x.xyz, y.xyz, ends, height, height > 0.0 ? max(solid, 0.0) : 0.0, small || solid < 0.02);
}

// Probability per solid angle of a unit direction that meets the panel, of light_panel_sample().
float light_panel_pdf(LightPanel panel, vec3 direction) {
    if (!panel.small) return 1.0 / panel.solid;
    float cosine = max(-dot(direction, cross(panel.x, panel.y)), 1e-9);
    float area = (panel.ends.y - panel.ends.x) * (panel.ends.w - panel.ends.z);
    return panel.height * panel.height / (cosine * cosine * cosine * area);
}

// From the place to a point of the panel, for u in [0, 1)²: uniform in solid angle, or in area.
vec3 light_panel_sample(LightPanel panel, vec2 u) {
    vec4 e = panel.ends;
    vec2 at = mix(e.xz, e.yw, u);
    float z = panel.height;
    if (!panel.small) {
        vec4 n = vec4(-e.z, e.y, e.w, -e.x) * inversesqrt(vec4(e.z, e.y, e.w, e.x) * vec4(e.z, e.y, e.w, e.x) + z * z);
        // The angles at two corners, as arc cosines of -n.z n.w and -n.w n.x.
        vec4 c = clamp(vec4(n.z * n.w, n.w * n.x, 0.0, 0.0), -1.0, 1.0);
        vec4 corners = 2.0 * light_atan(sqrt(1.0 + c), max(sqrt(1.0 - c), 1e-20));
        float angle = u.x * panel.solid - corners.x - corners.y;
        float f = (cos(angle) * n.x - n.z) / sin(angle);
        float s = clamp((f > 0.0 ? 1.0 : -1.0) * inversesqrt(f * f + n.x * n.x), -0.9999999, 0.9999999);
        at.x = clamp(s * z * inversesqrt(1.0 - s * s), e.x, e.y);
        float d2 = at.x * at.x + z * z;
        float h = mix(e.z * inversesqrt(d2 + e.z * e.z), e.w * inversesqrt(d2 + e.w * e.w), u.y);
        at.y = clamp(h * sqrt(d2 / max(1.0 - h * h, 1e-7)), e.z, e.w);
    }
    return at.x * panel.x + at.y * panel.y - z * cross(panel.x, panel.y);
}

// What is seen of a light from a place, as a whole: suns and points are discs of uniform radiance. A sun's cone is the same everywhere, a
// point light is the sphere that it is; within the sphere it is as bright as just outside. Rectangles go by their centre and, all
// around it, the sphere that holds them.
LightSample light_at(int i, vec3 position) {
    if (!light_local || light_kind[i] == 0) return LightSample(light_place[i].xyz, 1e30, light_place[i].w, light_color[i]);
    vec3 to = light_place[i].xyz - position;
    if (light_flat(i)) {
        float d2 = max(dot(to, to), 1e-30);
        float radius = length(vec2(light_x[i].w, light_y[i].w));
        return LightSample(to * inversesqrt(d2), sqrt(d2), radius * inversesqrt(d2), light_color[i] * light_panel(i, position).solid);
    }
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

// Light i by one point of it, for u in [0, 1)². `pdf` is the direction's probability per solid angle.
LightSample light_drawn(int i, vec3 position, vec2 u, out float pdf, out bool sharp) {
    if (light_flat(i)) {
        LightPanel panel = light_panel(i, position);
        vec3 to = light_panel_sample(panel, u);
        float distance = length(to);
        vec3 direction = to / max(distance, 1e-30);
        pdf = light_panel_pdf(panel, direction);
        sharp = panel.solid < 3e-8;
        return LightSample(direction, distance, 0.0, panel.solid > 0.0 ? light_color[i] / pdf : vec3(0.0));
    }
    LightSample light = light_at(i, position);
    sharp = light_sharp(light);
    pdf = light_pdf(light);
    return light_sample(light, u);
}

// Light i for renderers that do not follow paths: discs by their centre, without noise; rectangles by one point.
LightSample light_shading(int i, vec3 position, vec2 u) {
    if (light_flat(i)) {
        float pdf;
        bool sharp;
        return light_drawn(i, position, u, pdf, sharp);
    }
    return light_at(i, position);
}

// What a ray meets of light i: its radiance, or nothing; how far away, and light_drawn()'s probability per solid angle.
vec3 light_met(int i, vec3 position, vec3 direction, out float distance, out float pdf) {
    if (light_flat(i)) {
        LightPanel panel = light_panel(i, position);
        float cosine = -dot(direction, cross(panel.x, panel.y));
        distance = panel.height / max(cosine, 1e-9);
        vec2 at = distance * vec2(dot(direction, panel.x), dot(direction, panel.y));
        bool seen = panel.solid >= 3e-8 && cosine > 0.0 && at.x > panel.ends.x && at.x < panel.ends.y && at.y > panel.ends.z &&
                    at.y < panel.ends.w;
        pdf = seen ? light_panel_pdf(panel, direction) : 0.0;
        return seen ? light_color[i] : vec3(0.0);
    }
    LightSample light = light_at(i, position);
    pdf = light_pdf(light);
    return light_radiance(light, direction, distance);
}

// Radiance of the rectangles that the camera is to see, nearer than `end`. Lights are not solid: what is behind shines through.
vec3 light_seen(vec3 position, vec3 direction, float end) {
    vec3 sum = vec3(0.0);
    if (!light_shown) return sum;
    for (int i = 0; i < light_count; ++i) {
        if (light_flat(i) && light_place[i].w > 0.0) {
            float distance;
            float pdf;
            vec3 seen = light_met(i, position, direction, distance, pdf);
            sum += distance < end ? seen : vec3(0.0);
        }
    }
    return sum;
}
