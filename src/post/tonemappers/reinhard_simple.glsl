/// The global operator of Reinhard, Stark, Shirley & Ferwerda (2002, eq. 3), on each channel: x / (1 + x). Nothing is ever cut
/// off, and bright colours fade towards white.
#pragma apeiron invalidates present

vec3 tonemap(vec3 color) {
    vec3 x = max(color, 0.0);
    return x / (1.0 + x);
}
