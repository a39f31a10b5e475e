/// Shadows, middle and lights by hand, as photographers' curves have them, and saturation.
#pragma apeiron invalidates present

uniform float low;        //! 0 [0, 1000] | Radiance that is shown as black
uniform float middle;     //! 0.45 [0.001, 1000] log | Radiance that is shown half as bright as white
uniform float high;       //! 1 [0.001, 1000] log | Radiance that is shown as white
uniform float saturation; //! 1 [0, 4] | 0 grey, 1 as it is, above: more colourful

vec3 tonemap(vec3 color) {
    float width = max(high - low, 1e-6);
    float grey = dot(color, vec3(0.2126, 0.7152, 0.0722));
    vec3 place = clamp((mix(vec3(grey), color, saturation) - low) / width, 0.0, 1.0);
    // The power that takes the middle to 1/2.
    float power = -1.0 / log2(clamp((middle - low) / width, 0.001, 0.999));
    return pow(max(place, 1e-9), vec3(power)) * vec3(greaterThan(place, vec3(0.0))); // black is black, however low the power
}
