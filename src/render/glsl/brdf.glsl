#include "render/glsl/surface.glsl"

// Reflection models. `brdf_*` return f(v, l) * cos(n, l).

float brdf_alpha(Material m) { return max(m.roughness * m.roughness, 2e-3); }

vec3 brdf_f0(Material m) { return mix(vec3(0.04), m.albedo, m.metalness); }

vec3 brdf_lambert(Material m, vec3 n, vec3 l) { return m.albedo * (max(dot(n, l), 0.0) * 0.318309886); }

float brdf_exponent(Material m) {
    float alpha = max(m.roughness * m.roughness, 1e-3);
    return max(2.0 / (alpha * alpha) - 2.0, 0.0);
}

// A power of a cosine, 0 below the horizon. By itself: pow(0, 0) is undefined in GLSL, and no number on some GPUs.
float brdf_power(float cosine, float exponent) { return cosine > 0.0 ? pow(cosine, exponent) : 0.0; }

// Phong's model, normalised so that it conserves energy (Phong 1975; Lafortune & Willems 1994, eq. 8).
vec3 brdf_phong(Material m, vec3 n, vec3 v, vec3 l) {
    float cosine = max(dot(n, l), 0.0);
    float exponent = brdf_exponent(m);
    vec3 f0 = brdf_f0(m);
    float lobe = brdf_power(dot(reflect(-l, n), v), exponent) * (exponent + 2.0) * 0.159154943;
    return (m.albedo * (1.0 - f0) * ((1.0 - m.metalness) * 0.318309886) + f0 * lobe) * cosine;
}

// Part of the light from one direction that a white layer of facets loses because single scattering leaves out what is thrown
// from facet to facet. A fit to the integral over GGX with height-correlated masking, by quadrature: off by at most 0.012.
float brdf_lost(Material m, float cosine) {
    float r = m.roughness;
    float alpha = brdf_alpha(m);
    float s = cosine / (cosine + alpha);
    vec3 p = vec3(-0.05, 1.881, -1.819) + alpha * (vec3(-0.018, 0.973, -3.164) + alpha * vec3(4.757, -9.776, 20.0));
    return max(s * ((1.0 - s) * (p.x + s * (p.y + s * p.z)) + r * r * (-0.49 + r * (2.536 - 3.128 * r))), 0.0);
}

// Its mean over all directions, weighted by their cosine. A fit to the mean of brdf_lost(): with it, white metals of a roughness of 0.15
// and more reflect between 0.987 and 1.010 of the light from any direction.
float brdf_lost_mean(Material m) {
    float r = m.roughness;
    return max(r * (0.044 + r * (-0.5007 + r * (1.4286 + r * (3.5634 + r * (-7.2943 + r * 3.353))))), 2e-4);
}

// Part of the lost light that comes out again: it meets facets, and Schlick's mean Fresnel, once more for every part that is
// lost again (Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks"; the series of Fdez-Aguera 2019).
vec3 brdf_regained(Material m) {
    vec3 f0 = brdf_f0(m);
    vec3 fresnel = f0 + (1.0 - f0) * (1.0 / 21.0);
    float lost = brdf_lost_mean(m);
    return fresnel * fresnel * (1.0 - lost) / (1.0 - fresnel * lost);
}

// Part of a uniform environment that the microfacet layer reflects at once: the fit of Karis (2014, "Physically Based Shading on
// Mobile"), x times f0 plus y.
vec2 brdf_single(Material m, float nv) {
    vec4 r = m.roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a + r.zw;
}

// The same with what is scattered between the facets.
vec3 brdf_environment(Material m, vec3 n, vec3 v) {
    vec2 single = brdf_single(m, max(dot(n, v), 0.0));
    return brdf_f0(m) * single.x + single.y + brdf_regained(m) * max(1.0 - single.x - single.y, 0.0);
}

// GGX distribution of facets (Walter et al. 2007, eq. 33). The sine by a product of vectors: one minus the cosine's square has
// no digits left for narrow lobes.
float brdf_distribution(float a2, vec3 n, vec3 h) {
    float nh = dot(n, h);
    if (nh <= 0.0) return 0.0;
    vec3 sine = cross(n, h);
    float d = a2 * nh * nh + dot(sine, sine);
    return a2 / (3.141592654 * d * d);
}

// Microfacets: GGX distribution, height-correlated Smith masking (Heitz 2014, eq. 99),
// Schlick's Fresnel (1994), and the light between facets as a lobe of its own (Kulla & Conty 2017), over a Lambertian base: what the facets reflect of light from either direction does not reach it, so
// that no more is reflected than arrives, and both directions can change places.
vec3 brdf_ggx(Material m, vec3 n, vec3 v, vec3 l) {
    float nl = dot(n, l);
    if (nl <= 0.0) return vec3(0.0);
    float nv = max(dot(n, v), 1e-3);
    vec3 h = normalize(v + l);
    float lh = max(dot(l, h), 0.0);
    float alpha = brdf_alpha(m);
    float a2 = alpha * alpha;
    float distribution = brdf_distribution(a2, n, h);
    float masking = 0.5 / (nl * sqrt(a2 + (1.0 - a2) * nv * nv) + nv * sqrt(a2 + (1.0 - a2) * nl * nl));
    vec3 f0 = brdf_f0(m);
    // Rounding can take the cosine past 1, and a power of a negative number is no number.
    vec3 fresnel = f0 + (1.0 - f0) * pow(max(1.0 - lh, 0.0), 5.0);
    vec3 through = 1.0 - max(brdf_environment(m, n, v), brdf_environment(m, n, l));
    vec3 diffuse = m.albedo * through * ((1.0 - m.metalness) * 0.318309886);
    float between = brdf_lost(m, nv) * brdf_lost(m, nl) / (brdf_lost_mean(m) * 3.141592654);
    return (diffuse + fresnel * (distribution * masking) + brdf_regained(m) * between) * nl;
}

// Sampling of the models by number: 0 lambert, 1 phong, 2 ggx.

vec3 brdf_value(int model, Material m, vec3 n, vec3 v, vec3 l) {
    if (model == 0) return brdf_lambert(m, n, l);
    if (model == 1) return brdf_phong(m, n, v, l);
    return brdf_ggx(m, n, v, l);
}

// Part of the samples that are drawn from the glossy lobe: about its part of the reflected light.
float brdf_gloss(int model, Material m, vec3 n, vec3 v) {
    if (model == 0) return 0.0;
    vec3 gloss = model == 1 ? brdf_f0(m) : max(brdf_environment(m, n, v), 0.0);
    vec3 base = m.albedo * max(1.0 - gloss, 0.0) * (1.0 - m.metalness);
    if (model == 2) {
        // Light from between the facets comes from everywhere, as that of the base.
        vec3 between = brdf_regained(m) * brdf_lost(m, max(dot(n, v), 1e-3));
        between = min(between, gloss);
        gloss -= between;
        base += between;
    }
    float all = dot(gloss + base, vec3(1.0));
    return all > 0.0 ? max(dot(gloss, vec3(1.0)) / all, 0.1) : 1.0;
}

// Probability per solid angle that brdf_sample() draws l: facets that v sees (Heitz 2018, eq. 17) or powers of the mirrored
// cosine, and the cosine for the base.
float brdf_pdf(int model, float gloss, Material m, vec3 n, vec3 v, vec3 l) {
    float nl = dot(n, l);
    if (nl <= 0.0) return 0.0;
    float base = nl * 0.318309886;
    if (model == 0) return base;
    float lobe;
    if (model == 1) {
        float exponent = brdf_exponent(m);
        lobe = brdf_power(dot(reflect(-v, n), l), exponent) * (exponent + 1.0) * 0.159154943;
    } else {
        float nv = max(dot(n, v), 1e-3);
        float a2 = brdf_alpha(m) * brdf_alpha(m);
        lobe = 0.5 * brdf_distribution(a2, n, normalize(v + l)) / (nv + sqrt(a2 + (1.0 - a2) * nv * nv));
    }
    return mix(base, lobe, gloss);
}

// x and y of an orthonormal basis about n (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
mat3 brdf_frame(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// A facet's normal in proportion to its area as seen from v, in the frame of the surface (Heitz 2018, "Sampling the GGX
// Distribution of Visible Normals", appendix A).
vec3 brdf_facet(float alpha, vec3 v, vec2 u) {
    vec3 seen = normalize(vec3(alpha * v.xy, v.z));
    float length2 = dot(seen.xy, seen.xy);
    vec3 x = length2 > 0.0 ? vec3(-seen.y, seen.x, 0.0) * inversesqrt(length2) : vec3(1.0, 0.0, 0.0);
    vec3 y = cross(seen, x);
    float r = sqrt(u.x);
    float phi = 6.283185307 * u.y;
    float a = r * cos(phi);
    float b = mix(sqrt(max(1.0 - a * a, 0.0)), r * sin(phi), 0.5 * (1.0 + seen.z));
    vec3 h = a * x + b * y + sqrt(max(1.0 - a * a - b * b, 0.0)) * seen;
    return normalize(vec3(alpha * h.xy, max(h.z, 1e-6)));
}

// A direction for u in [0, 1)², `lobe` in [0, 1) to choose the lobe; it may be below the horizon, where the value is 0.
vec3 brdf_sample(int model, float gloss, Material m, vec3 n, vec3 v, vec2 u, float lobe) {
    mat3 frame = brdf_frame(n);
    if (lobe < gloss && model == 2) {
        vec3 h = frame * brdf_facet(brdf_alpha(m), v * frame, u);
        return normalize(reflect(-v, h));
    }
    // A power of the cosine about the mirrored direction, or the first power about the normal.
    bool mirrored = lobe < gloss;
    float z = pow(1.0 - u.x, 1.0 / (mirrored ? brdf_exponent(m) + 1.0 : 2.0));
    float r = sqrt(max(1.0 - z * z, 0.0));
    vec3 l = vec3(r * cos(6.283185307 * u.y), r * sin(6.283185307 * u.y), z);
    return normalize(mirrored ? brdf_frame(reflect(-v, n)) * l : frame * l);
}
