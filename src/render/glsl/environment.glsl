#include "render/glsl/light.glsl"

// The environment as everything else sees it: the chosen module, turned and scaled, and its irradiance.

uniform float environment_intensity;
uniform float environment_angle;       // rotation about +z [rad]
uniform bool environment_transparent;  // rays that leave the scene are transparent
uniform sampler2D environment_sh;      // 9 x 1: radiance in spherical harmonics

vec3 environment_radiance(vec3 direction); // of the module

vec3 environment_at(vec3 direction) {
    float c = cos(environment_angle);
    float s = sin(environment_angle);
    vec3 turned = vec3(c * direction.x + s * direction.y, c * direction.y - s * direction.x, direction.z);
    return environment_intensity * environment_radiance(turned);
}

// Real spherical harmonics up to degree 2 (Ramamoorthi & Hanrahan 2001, eq. 3).
float environment_basis(int i, vec3 n) {
    if (i == 0) return 0.282095;
    if (i == 1) return 0.488603 * n.y;
    if (i == 2) return 0.488603 * n.z;
    if (i == 3) return 0.488603 * n.x;
    if (i == 4) return 1.092548 * n.x * n.y;
    if (i == 5) return 1.092548 * n.y * n.z;
    if (i == 6) return 0.315392 * (3.0 * n.z * n.z - 1.0);
    if (i == 7) return 1.092548 * n.x * n.z;
    return 0.546274 * (n.x * n.x - n.y * n.y);
}

// Irradiance on a surface of normal n from the whole environment, unoccluded (ibid., eq. 10).
vec3 environment_irradiance(vec3 n) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 9; ++i) {
        float weight = i == 0 ? 3.141593 : (i < 4 ? 2.094395 : 0.785398);
        sum += weight * environment_basis(i, n) * texelFetch(environment_sh, ivec2(i, 0), 0).rgb;
    }
    return max(sum, 0.0);
}
