#include "render/glsl/surface.glsl"

// The `surface` interface for subjects that are distance estimates: they define
//
//     float distance_estimate(vec3 p)   a lower bound of the distance to the surface
//     vec4 distance_bound()             a sphere (centre, radius) around everything
//
//     vec3 distance_gradient(vec3 p)    its gradient, needed where `normals` is analytic only
//
// and the parameters that the functions below read.

uniform float detail;         //! 1 [0.05, 20] log unit px | Size of the smallest feature that is resolved, in pixels
uniform float step_scale;     //! 1 [0.1, 1] step 0.05 | Part of the estimated distance that a step goes: lower it where a formula overshoots
uniform int max_steps;        //! 400 [8, 4000] log | Most steps along a camera ray
uniform int shadow_steps;     //! 120 [8, 1000] log | Most steps along a shadow ray
uniform bool bounding;        //! true invalidates program | Rays are cut to a sphere around everything: without, for comparison
uniform bool prepass;         //! true invalidates program | One cone per 8 x 8 pixels first finds where their rays may start: without, for comparison
uniform float relaxation;     //! 1.3 [1, 1.9] step 0.05 | Steps are longer than the estimate by this factor, and taken back where that goes too far: 1 for estimates that overshoot
uniform float occlusion_reach; //! 0.12 [0.005, 2] log | How far ambient occlusion looks, relative to the distance from the camera
uniform int normals;          //! tetrahedron {tetrahedron, analytic, position} invalidates program | Normals from four estimates around the point, smooth over the pixel's footprint; or the estimate's exact gradient by dual numbers: crisp, right for smooth surfaces and magnified views, noisy where there is detail below the pixel; or from the positions that neighbouring rays meet: less exact where they miss the surface, at silhouettes

float distance_estimate(vec3 p);
vec3 distance_gradient(vec3 p);
vec4 distance_bound();

// Without a bound, rays end where they are far beyond everything.
float distance_end(Ray ray) {
    vec4 bound = distance_bound();
    return length(bound.xyz - ray.origin) + 2.0 * bound.w;
}

float surface_distance(vec3 position) { return distance_estimate(position); }

// Cuts the ray to the part inside the bounding sphere; false when it misses.
bool distance_clip(inout Ray ray) {
    if (!bounding) {
        ray.t_max = min(ray.t_max, distance_end(ray));
        return ray.t_min < ray.t_max;
    }
    vec4 bound = distance_bound();
    vec3 to = bound.xyz - ray.origin;
    float along = dot(to, ray.direction);
    // The distance from the axis by subtraction of vectors: stable when the sphere is far away.
    vec3 aside = to - along * ray.direction;
    float half_chord2 = bound.w * bound.w - dot(aside, aside);
    if (half_chord2 <= 0.0) return false;
    float half_chord = sqrt(half_chord2);
    ray.t_min = max(ray.t_min, along - half_chord);
    ray.t_max = min(ray.t_max, along + half_chord);
    return ray.t_min < ray.t_max;
}

// Sphere tracing (Hart 1996) up to a threshold that grows with the distance: the pixel's footprint, which is also the clarity
// function of Hart, Sandin & Kauffman (1989). Over-relaxed: steps are longer than the estimate while the spheres of consecutive
// points overlap; where they do not, something may lie between, and the step is taken back (Keinert et al. 2014, "Enhanced Sphere Tracing").
bool surface_trace(Ray ray, out Hit hit) {
    hit = Hit(ray.t_max, ray.origin, 0.0, 0.0);
    if (!distance_clip(ray)) return false;
    float t = ray.t_min;
    float threshold = 0.0;
    float d = 1e30;
    float reach = 0.0; // of the sphere before
    float stride = 0.0; // from its centre to here
    float stretch = relaxation;
    int i = 0;
    for (; i < max_steps; ++i) {
        d = distance_estimate(ray.origin + t * ray.direction);
        threshold = detail * (ray.width + ray.spread * t);
        float radius = d * step_scale;
        if (stride > reach + radius && stretch > 1.0) {
            t += reach - stride;
            stride = reach;
            stretch = 1.0;
            continue;
        }
        if (d < threshold || t > ray.t_max) break;
        reach = radius;
        stride = stretch * radius;
        t += stride;
    }
    hit.effort = float(i) / float(max_steps);
    // A ray that ran out of steps just above the surface has found it; one in the open has not.
    if (t > ray.t_max || d > 20.0 * threshold) return false;
    // A last step ends anywhere below the threshold, even inside. By false position back to where it was crossed: what is found must not
    // depend on where the march began. The estimate is taken as linear along the step, which costs nothing more.
    if (stride > 0.0) t -= stride * clamp((threshold - d) / (reach / step_scale - d), 0.0, 0.9);
    hit.t = t;
    hit.position = ray.origin + t * ray.direction;
    hit.footprint = max(detail * (ray.width + ray.spread * t), 2e-7 * length(hit.position - distance_bound().xyz));
    return true;
}

// Cone marching (Bonnet 2012, "Cone marching in mandelbulb"): a ball around a point of the axis is empty, and with it the cone up to
// where its rim, which is half of width + spread t away from the axis's point at the same t, leaves the ball.
float surface_clear(Ray cone) {
    if (!prepass) return cone.t_min;
    vec4 bound = distance_bound();
    float widening = 1.0 / (1.0 + 0.5 * cone.spread);
    float t = cone.t_min;
    float stride = 0.0;
    for (int i = 0; i < 80; ++i) {
        vec3 p = cone.origin + t * cone.direction;
        float radius = 0.5 * (cone.width + cone.spread * t);
        vec3 from = p - bound.xyz;
        float outside = length(from) - bound.w;
        // Beside the sphere and leaving it faster than the cone widens: it never meets it again.
        if (outside > radius && dot(from, cone.direction) > 0.5 * cone.spread * length(from)) return 1e30;
        float d = outside > 2.0 * radius ? outside : distance_estimate(p) * step_scale;
        // The ball before reached as far as this cone is wide, unless its estimate overshot: then its step is taken back.
        if (d < 0.99 * radius) {
            t -= stride;
            break;
        }
        stride = (d - radius) * widening;
        if (stride < 0.15 * radius) break;
        t += stride;
    }
    return t * 0.99999;
}

// Where a ray that passes p meets the estimate's level, from p along the ray, and whether it does within a few h: by secants, which
// are kept from turning back or leaping away. Neighbours must meet the level of the hit itself: marches end anywhere below their
// threshold, which would tilt the surface between them.
vec2 distance_beside(vec3 p, vec3 direction, float level, float h) {
    float s = 0.0;
    float f = distance_estimate(p) - level;
    float stride = abs(f) < 0.05 * h ? 0.05 * h : clamp(f, -2.0 * h, 2.0 * h);
    for (int i = 0; i < 5; ++i) {
        float next = distance_estimate(p + (s + stride) * direction) - level;
        float slope = min((next - f) / stride, -0.02);
        s += stride;
        f = next;
        stride = clamp(-f / slope, -3.0 * h, 3.0 * h);
        // So near, a further step would divide two roundings.
        if (abs(stride) < 1e-3 * h) break;
    }
    return vec2(s + stride, float(abs(stride) < 0.1 * h && abs(s) < 10.0 * h));
}

// From the positions that the rays on either side meet, half a footprint away. One that misses (silhouettes, edges) leaves it to the
// other; where both do, the surface is taken to face the eye in that direction.
vec3 distance_position_normal(Hit hit, vec3 direction) {
    float h = 0.5 * hit.footprint;
    float level = distance_estimate(hit.position);
    vec3 x = normalize(abs(direction.z) < 0.9 ? vec3(direction.y, -direction.x, 0.0) : vec3(0.0, direction.z, -direction.y));
    vec3 y = cross(direction, x);
    vec3 n = -direction;
    for (int i = 0; i < 2; ++i) {
        vec3 axis = i == 0 ? x : y;
        vec2 sum = vec2(0.0);
        for (int k = -1; k <= 1; k += 2) {
            vec2 beside = distance_beside(hit.position + float(k) * h * axis, direction, level, h);
            sum += vec2(float(k) * beside.x, 1.0) * beside.y;
        }
        n += axis * (sum.x / (h * max(sum.y, 1.0)));
    }
    return normalize(n);
}

// Gradient by four taps at the corners of a tetrahedron (Quilez 2015), or exact, or from positions.
vec3 surface_normal(Hit hit, vec3 direction) {
    float h = 0.5 * hit.footprint;
    if (normals == 2) return distance_position_normal(hit, direction);
    const vec2 k = vec2(1.0, -1.0);
    vec3 n = vec3(0.0);
    if (normals == 1) {
        vec3 gradient = distance_gradient(hit.position);
        float most = max(abs(gradient.x), max(abs(gradient.y), abs(gradient.z)));
        // Squares of what is very large or small are no floats any more.
        return most > 0.0 && most < 1e37 ? normalize(gradient / most) : -direction;
    }
    // A loop keeps the compiler from writing the formula out four times.
    for (int i = 0; i < 4; ++i) {
        vec3 corner = i == 0 ? k.xyy : (i == 1 ? k.yyx : (i == 2 ? k.yxy : k.xxx));
        n += corner * distance_estimate(hit.position + h * corner);
    }
    float length2 = dot(n, n);
    return length2 > 0.0 ? n * inversesqrt(length2) : -direction;
}

vec3 surface_leave(Hit hit, vec3 normal) { return hit.position + 1.5 * hit.footprint * normal; }

// Soft shadows from one march (Quilez 2010, with Aaltonen's closest-approach estimate of 2018).
float surface_visibility(Hit hit, vec3 normal, vec3 direction, float t_max, float spread) {
    Ray ray = Ray(surface_leave(hit, normal), direction, 0.0, t_max, hit.footprint, 0.0);
    if (!distance_clip(ray)) return 1.0;
    float t = ray.t_min + hit.footprint;
    float visible = 1.0;
    float previous = 1e20;
    float width = max(spread, 1e-4);
    for (int i = 0; i < shadow_steps && t < ray.t_max; ++i) {
        float d = distance_estimate(ray.origin + t * direction);
        float y = d * d / (2.0 * previous);
        float closest = sqrt(max(d * d - y * y, 0.0));
        visible = min(visible, closest / (width * max(t - y, 1e-20)));
        if (visible < 0.005 || d < 0.25 * hit.footprint) return 0.0;
        previous = d;
        t += max(d * step_scale, 0.25 * hit.footprint);
    }
    return visible * visible * (3.0 - 2.0 * visible);
}

March surface_march(Hit hit, vec3 normal) {
    vec3 origin = surface_leave(hit, normal);
    float start = max(distance_estimate(origin) * step_scale, hit.footprint);
    return March(origin, vec3(0.0), 0.0, 0.0, hit.footprint, start, 0.0, 0.0, 0);
}

void surface_march_to(inout March march, vec3 direction, float t_max) {
    // From inside the bounding sphere: its far side, or at most a radius beyond, without a root for every ray.
    vec4 bound = distance_bound();
    float end = bounding ? dot(bound.xyz - march.origin, direction) + bound.w
                         : distance_end(Ray(march.origin, direction, 0.0, t_max, 0.0, 0.0));
    march.steps = shadow_steps;
    march.direction = direction;
    march.t_max = min(t_max, end);
    // The first step is the same in all directions.
    march.reach = march.start;
    march.stride = (2.0 * relaxation - 1.0) * march.start;
    march.t = march.stride;
}

// Over-relaxed as surface_trace() is, and more: what is asked for is not where the surface is but whether there is any, so that
// nothing is lost by coming close with a long stride. Who runs out of steps is not blocked.
int surface_march_on(inout March march) {
    if (march.steps <= 0 || march.t >= march.t_max) return march_free;
    --march.steps;
    float d = distance_estimate(march.origin + march.t * march.direction);
    float radius = max(d * step_scale, 0.0);
    if (march.stride > march.reach + radius) {
        march.t += march.reach - march.stride;
        march.stride = march.reach;
        return march_on;
    }
    if (d < 0.5 * march.threshold) return march_blocked;
    march.reach = radius;
    march.stride = (2.0 * relaxation - 1.0) * radius;
    march.t += march.stride;
    return march_on;
}

bool surface_blocked(Hit hit, vec3 normal, vec3 direction, float t_max) {
    March march = surface_march(hit, normal);
    surface_march_to(march, direction, t_max);
    int state = march_on;
    while (state == march_on) state = surface_march_on(march);
    return state == march_blocked;
}

// Compares estimates along the normal with the distances gone (Evans 2006; Quilez 2008).
float surface_openness(Hit hit, vec3 normal) {
    float reach = max(occlusion_reach * (hit.t + 1e-20), 8.0 * hit.footprint);
    float blocked = 0.0;
    float weight = 0.5;
    for (int i = 1; i <= 5; ++i) {
        float h = reach * float(i * i) / 25.0;
        blocked += weight * clamp(1.0 - distance_estimate(hit.position + h * normal) / h, 0.0, 1.0);
        weight *= 0.62;
    }
    return clamp(1.0 - blocked / 1.195, 0.0, 1.0);
}
