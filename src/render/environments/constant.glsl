/// The same radiance from every direction: a white furnace, a studio, darkness.
uniform vec3 color; //! (1, 1, 1) [0, 100] color | Radiance

vec3 radiance(vec3 direction) { return color; }
