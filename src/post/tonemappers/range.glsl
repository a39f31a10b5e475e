/// A window: radiance from low to high is shown as it is from black to white, the rest is cut off. For maximum intensity and other
/// pictures that are measurements.
#pragma apeiron invalidates present

uniform float low;  //! 0 [-1000, 1000] | Radiance that is shown as black
uniform float high; //! 1 [-1000, 1000] | Radiance that is shown as white

// (Where high is not above low, all is black up to there and white beyond.)
vec3 tonemap(vec3 color) { return clamp((color - low) / max(high - low, 1e-6), 0.0, 1.0); }
