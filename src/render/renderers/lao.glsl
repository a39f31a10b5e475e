/// Emission and absorption with local ambient occlusion and shadows: places look around for a short way, so that folds are dark and
/// forms are seen; much faster than paths of light. Each sample lights one place of each ray, chosen by how much of it is
/// seen: the first is grainy, further ones smooth it.
/// Hernell, Ljung & Ynnerman (2010, "Local Ambient Occlusion in Direct Volume Rendering").
#pragma apeiron needs field
#pragma apeiron integrate mean
#include "render/glsl/field_march.glsl"

uniform float step;      //! 1 [0.05, 4] log | Distance of the places that are looked at, in voxels
uniform float reach;     //! 24 [1, 400] log | How far places look around, in voxels; lights' shadows twice as far
uniform int rays;        //! 4 [1, 16] | Looks around of each place in each sample
uniform bool shadows;    //! true invalidates program | What is near casts shadows
uniform float shading;   //! 1 [0, 1] step 0.05 | Part of the light that depends on the gradient: 0 shows the colours as they are
uniform float specular;  //! 0.3 [0, 2] step 0.05 | Strength of the highlights
uniform float shininess; //! 30 [1, 500] log | Exponent of the highlights (Blinn 1977)
uniform float sky_light; //! 1 [0, 4] | Strength of the environment's light

void kernel_main(ivec2 pixel, out vec4 radiance, out vec4 geometry, out vec4 albedo) {
    field_march(FieldLook(step, shading, specular, shininess, sky_light, rays, reach, shadows, 1.0), pixel, radiance, geometry, albedo);
}
