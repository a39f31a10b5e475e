/// A clear daylight sky for the scene's first sun: Preetham, Shirley & Smits, "A Practical Analytic Model for Daylight" (1999), with
/// a ground below the horizon. The sun's disc itself is a light, not part of it.
#include "render/glsl/light.glsl"

uniform float turbidity;   //! 3 [1.8, 10] step 0.1 | Haziness of the air: 2 arctic blue, 10 mist
uniform float brightness;  //! 1 [0, 20] log | Scale of the sky's radiance: 1 is a zenith of about 0.3
uniform vec3 ground;       //! (0.28, 0.25, 0.22) [0, 1] color | Albedo of the ground

// Perez' distribution (ibid., eq. 3), for a, b, c, d, e of one channel.
float perez(float cos_theta, float gamma, float cos_gamma, vec4 abcd, float e) {
    return (1.0 + abcd.x * exp(abcd.y / max(cos_theta, 0.01))) *
           (1.0 + abcd.z * exp(abcd.w * gamma) + e * cos_gamma * cos_gamma);
}

float channel(vec4 abcd, float e, float cos_theta, float gamma, float cos_gamma, float theta_sun, float cos_sun) {
    return perez(cos_theta, gamma, cos_gamma, abcd, e) / perez(1.0, theta_sun, cos_sun, abcd, e);
}

vec3 above(vec3 direction) {
    float t = turbidity;
    float cos_sun = clamp(light_sun.z, 0.02, 1.0);
    float s = acos(cos_sun);
    float cos_theta = max(direction.z, 0.0);
    // The sun is kept above the horizon for the model, in its own azimuth.
    vec3 sun = normalize(vec3(light_sun.xy + vec2(1e-6, 0.0), max(light_sun.z, 0.02)));
    float cos_gamma = clamp(dot(direction, sun), -1.0, 1.0);
    float gamma = acos(cos_gamma);

    // Distribution coefficients and zenith values: ibid., appendix A.2.
    float y = channel(vec4(0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771),
                      -0.0670 * t + 0.3703, cos_theta, gamma, cos_gamma, s, cos_sun);
    float cx = channel(vec4(-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989),
                       -0.0033 * t + 0.0452, cos_theta, gamma, cos_gamma, s, cos_sun);
    float cy = channel(vec4(-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537),
                       -0.0109 * t + 0.0529, cos_theta, gamma, cos_gamma, s, cos_sun);
    float chi = (4.0 / 9.0 - t / 120.0) * (3.141592654 - 2.0 * s);
    float zenith = max((4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192, 0.05); // [kcd/m2]
    float s2 = s * s;
    float s3 = s2 * s;
    vec3 tt = vec3(t * t, t, 1.0);
    vec4 ss = vec4(s3, s2, s, 1.0);
    float zx = dot(tt, vec3(dot(ss, vec4(0.00166, -0.00375, 0.00209, 0.0)), dot(ss, vec4(-0.02903, 0.06377, -0.03202, 0.00394)),
                            dot(ss, vec4(0.11693, -0.21196, 0.06052, 0.25886))));
    float zy = dot(tt, vec3(dot(ss, vec4(0.00275, -0.00610, 0.00317, 0.0)), dot(ss, vec4(-0.04214, 0.08970, -0.04153, 0.00516)),
                            dot(ss, vec4(0.15346, -0.26756, 0.06670, 0.26688))));
    float luminance = zenith * y;
    float x_ = zx * cx;
    float y_ = zy * cy;
    vec3 xyz = luminance * vec3(x_ / y_, 1.0, (1.0 - x_ - y_) / y_);
    vec3 rgb = mat3(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252) * xyz;
    // At and below sunset the model no longer holds: fade towards night.
    return max(rgb, 0.0) * (0.06 * smoothstep(-0.12, 0.06, light_sun.z));
}

vec3 radiance(vec3 direction) {
    float horizon = smoothstep(-0.015, 0.015, direction.z);
    vec3 sky = above(normalize(vec3(direction.xy, max(direction.z, 0.0))));
    // The ground sends back part of the light that an open sky gives it; its edge fades into the haze.
    vec3 far = above(normalize(vec3(direction.xy + vec2(1e-6, 0.0), 0.03)));
    vec3 earth = ground * (0.75 * above(vec3(0.0, 0.0, 1.0)) + 0.25 * far + 0.25 * max(light_sun.z, 0.0));
    earth = mix(far, earth, smoothstep(0.0, 0.35, -direction.z));
    return brightness * mix(earth, sky, horizon);
}
