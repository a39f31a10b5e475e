/// The curve of Lottes (2016, "Advanced Techniques and Optimization of HDR Color Pipelines"): contrast, shoulder, a middle grey and a
/// white point, each by hand.
#pragma apeiron invalidates present

uniform float contrast; //! 1.6 [1, 2.5] | Slope of the middle tones
uniform float shoulder; //! 0.977 [0.8, 1] | How much of the contrast is left in the lights
uniform float white;    //! 8 [1, 1000] log | Smallest radiance that is shown as white
uniform float grey_in;  //! 0.18 [0.01, 0.9] log | Radiance ...
uniform float grey_out; //! 0.267 [0.01, 0.9] log | ... that is shown as this

vec3 tonemap(vec3 color) {
    float ad = contrast * shoulder;
    float whole = pow(white, ad);
    float middle = pow(grey_in, ad);
    float below = (whole - middle) * grey_out;
    float b = (pow(white, contrast) * grey_out - pow(grey_in, contrast)) / below;
    float c = (whole * pow(grey_in, contrast) - pow(white, contrast) * middle * grey_out) / below;
    // Beyond the white point everything is white.
    vec3 x = clamp(color, 1e-9, white);
    return clamp(pow(x, vec3(contrast)) / (pow(x, vec3(ad)) * b + c), 0.0, 1.0);
}
