// What an effect sees: the picture so far and its geometry. It writes the picture after it.

uniform sampler2D effect_color;    // rgb radiance, w coverage
uniform sampler2D effect_geometry; // xyz normal, w depth
uniform sampler2D effect_albedo;   // rgb albedo, w part of samples that hit
uniform sampler2D effect_mean;     // w samples of the pixel; 0 while the first one is not complete
uniform sampler2D effect_spread;   // rgb sum of their squared deviations from the mean
uniform sampler2D effect_input;    // of several passes (`#pragma apeiron passes N`): the picture before the first one
uniform int effect_pass;           // 0 .. N - 1
uniform int effect_level;          // of an effect with `#pragma apeiron pyramid`: how often the picture was halved. Level after level is made of the
uniform int effect_levels;         // one before in effect_color, from 1 to effect_levels; and then on the way back, from effect_levels - 1 to 0, where
uniform sampler2D effect_same;     // this is what the way there left of the same level: of level 0, the picture before the effect
uniform ivec2 effect_size;         // [px]
uniform float effect_focus;        // distance of the camera's plane of focus, along the axis
uniform float effect_scale;        // height of a thing of size 1 at distance 1, or anywhere in parallel projection [px]
uniform bool effect_orthographic;

// The picture at a pixel; outside, at the nearest one.
vec4 effect_at(ivec2 pixel) { return texelFetch(effect_color, clamp(pixel, ivec2(0), effect_size - 1), 0); }
