/// A studio backdrop: three colours from below to above, smoothly blended.
uniform vec3 top;     //! (0.35, 0.45, 0.65) [0, 100] color | Radiance straight above
uniform vec3 horizon; //! (0.85, 0.85, 0.9) [0, 100] color | Radiance at the horizon
uniform vec3 bottom;  //! (0.12, 0.11, 0.1) [0, 100] color | Radiance straight below
uniform float sharpness; //! 1 [0.1, 20] log | How narrow the horizon is

vec3 radiance(vec3 direction) {
    float h = clamp(direction.z, -1.0, 1.0);
    float t = 1.0 - pow(1.0 - abs(h), sharpness);
    return mix(horizon, h > 0.0 ? top : bottom, t);
}
