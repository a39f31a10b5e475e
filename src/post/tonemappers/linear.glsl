/// No tone mapping: radiance 1 is white, more is cut off. For measurements.
#pragma apeiron invalidates present

vec3 tonemap(vec3 color) { return clamp(color, 0.0, 1.0); }
