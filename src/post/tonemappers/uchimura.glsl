/// The curve of Uchimura (2017, "HDR Theory and Practice", CEDEC): a toe, a linear middle and a shoulder that never cuts off.
#pragma apeiron invalidates present

uniform float contrast; //! 1 [0.2, 3] | Slope of the linear part
uniform float start;    //! 0.22 [0.01, 0.9] | Where the linear part begins
uniform float linear;   //! 0.4 [0, 0.9] | Part of the way to white that is linear
uniform float black;    //! 1.33 [1, 3] | How deep blacks are: the toe's power

vec3 tonemap(vec3 color) {
    vec3 x = clamp(color, 0.0, 1e4);
    float l0 = (1.0 - start) * linear / contrast;
    float s0 = start + l0;
    float s1 = start + contrast * l0;
    float c2 = contrast / (1.0 - s1);
    vec3 toe_weight = 1.0 - smoothstep(vec3(0.0), vec3(start), x);
    vec3 shoulder_weight = step(vec3(s0), x);
    vec3 toe = start * pow(max(x / start, 1e-9), vec3(black));
    vec3 line = start + contrast * (x - start);
    vec3 shoulder = 1.0 - (1.0 - s1) * exp(-c2 * (x - s0));
    return clamp(toe * toe_weight + line * (1.0 - toe_weight - shoulder_weight) + shoulder * shoulder_weight, 0.0, 1.0);
}
