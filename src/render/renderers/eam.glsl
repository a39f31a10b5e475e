/// Emission and absorption: the volume glows in its colours and hides what is behind, shaded by its gradient; without shadows, so that
/// each sample is nearly complete by itself: places that are seen little, 3 % together, are lit as one of them. How bright it is does not
/// depend on the step.
/// Max (1995, "Optical Models for Direct Volume Rendering"); Levoy (1988, "Display of Surfaces from Volume Data").
#pragma apeiron needs field
#pragma apeiron integrate mean
#include "render/glsl/field_march.glsl"

uniform float step;      //! 0.5 [0.05, 4] log | Distance of the places that are looked at, in voxels
uniform float shading;   //! 1 [0, 1] step 0.05 | Part of the light that depends on the gradient: 0 shows the colours as they are
uniform float specular;  //! 0.3 [0, 2] step 0.05 | Strength of the highlights
uniform float shininess; //! 30 [1, 500] log | Exponent of the highlights (Blinn 1977)
uniform float sky_light; //! 1 [0, 4] | Strength of the environment's light

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    field_march(FieldLook(step, shading, specular, shininess, sky_light, 0, 0.0, false, 0.03), pixel, radiance, geometry, albedo);
}
