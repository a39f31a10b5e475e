#include "render/glsl/surface.glsl"

// Reflection models. `brdf_*` return f(v, l) * cos(n, l).

vec3 brdf_lambert(Material m, vec3 n, vec3 l) { return m.albedo * (max(dot(n, l), 0.0) * 0.318309886); }

// Phong's model, normalised so that it conserves energy (Phong 1975; Lafortune & Willems 1994, eq. 8).
vec3 brdf_phong(Material m, vec3 n, vec3 v, vec3 l) {
    float cosine = max(dot(n, l), 0.0);
    float alpha = max(m.roughness * m.roughness, 1e-3);
    float exponent = 2.0 / (alpha * alpha) - 2.0;
    vec3 f0 = mix(vec3(0.04), m.albedo, m.metalness);
    float lobe = pow(max(dot(reflect(-l, n), v), 0.0), max(exponent, 0.0)) * (exponent + 2.0) * 0.159154943;
    return (m.albedo * (1.0 - f0) * ((1.0 - m.metalness) * 0.318309886) + f0 * lobe) * cosine;
}

// Part of a uniform environment that the microfacet layer reflects: the fit of Karis (2014, "Physically Based Shading on Mobile").
vec3 brdf_environment(Material m, vec3 n, vec3 v) {
    float nv = max(dot(n, v), 0.0);
    vec4 r = m.roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    vec2 ab = vec2(-1.04, 1.04) * a + r.zw;
    return mix(vec3(0.04), m.albedo, m.metalness) * ab.x + ab.y;
}

// Microfacets: GGX distribution (Walter et al. 2007, eq. 33), height-correlated Smith masking (Heitz 2014, eq. 99),
// Schlick's Fresnel (1994), over a Lambertian base: what the facets reflect of light from either direction does not reach it, so
// that no more is reflected than arrives, and both directions can change places.
vec3 brdf_ggx(Material m, vec3 n, vec3 v, vec3 l) {
    float nl = dot(n, l);
    if (nl <= 0.0) return vec3(0.0);
    float nv = max(dot(n, v), 1e-3);
    vec3 h = normalize(v + l);
    float nh = max(dot(n, h), 0.0);
    float lh = max(dot(l, h), 0.0);
    float alpha = max(m.roughness * m.roughness, 2e-3);
    float a2 = alpha * alpha;
    float d = nh * nh * (a2 - 1.0) + 1.0;
    float distribution = a2 / (3.141592654 * d * d);
    float masking = 0.5 / (nl * sqrt(a2 + (1.0 - a2) * nv * nv) + nv * sqrt(a2 + (1.0 - a2) * nl * nl));
    vec3 f0 = mix(vec3(0.04), m.albedo, m.metalness);
    // Rounding can take the cosine past 1, and a power of a negative number is no number.
    vec3 fresnel = f0 + (1.0 - f0) * pow(max(1.0 - lh, 0.0), 5.0);
    vec3 through = 1.0 - max(brdf_environment(m, n, v), brdf_environment(m, n, l));
    vec3 diffuse = m.albedo * through * ((1.0 - m.metalness) * 0.318309886);
    return (diffuse + fresnel * (distribution * masking)) * nl;
}
