#include "render/glsl/slice.glsl"

// Slices: up to four planes through a volume that show its values, three across the world's axes and an oblique one. A part of the
// subject's GLSL. Clipping boxes and planes cut them as well; one that lies in a clipping plane is seen.

uniform bool slice_x;       //! false | Show a slice across the world's x axis: sagittal, in patients
uniform bool slice_y;       //! false | Show a slice across the world's y axis: coronal
uniform bool slice_z;       //! false | Show a slice across the world's z axis: axial
uniform bool slice_oblique; //! false | Show a slice across slice_normal
uniform int slice_color;    //! grey {grey, transfer} | Slices are grey from black to white over slice_window, or in the colours of the transfer function
uniform float slice_opacity;    //! 1 [0, 1] | How much of what is behind slices hide
uniform float slice_brightness; //! 1 [0, 100] log | Radiance of white
uniform bool slice_ground;      //! true | Slices are black where there is nothing (grey: below the window, transfer: opacity 0); false: one sees through there

uniform vec4 slice_planes[4]; // normal, and distance from the camera along it; along x, y, z, and the oblique one
uniform vec2 slice_grey;      // a place in the transfer function times x plus y: 0 is black, 1 white

vec4 slice_look(vec3 place) {
    vec4 shown;
    if (slice_color == 0) {
        float grey = volume_values(place).x * slice_grey.x + slice_grey.y;
        shown = vec4(vec3(clamp(grey, 0.0, 1.0)), slice_ground || grey > 0.0 ? 1.0 : 0.0);
    } else {
        vec4 seen = volume_appearance(place);
        bool nothing = seen.a <= 0.0;
        shown = vec4(nothing ? vec3(0.0) : seen.rgb, slice_ground || !nothing ? 1.0 : 0.0);
    }
    return vec4(slice_brightness * shown.rgb, slice_opacity * shown.a);
}

Slice slice_next(Ray ray, float t) {
    Slice slice = Slice(1e30, vec4(0.0));
    if (slice_x || slice_y || slice_z || slice_oblique) {
        for (int i = 0; i < 4; ++i) {
            if (!(i == 0 ? slice_x : i == 1 ? slice_y : i == 2 ? slice_z : slice_oblique)) continue;
            vec4 plane = slice_planes[i];
            float speed = dot(plane.xyz, ray.direction);
            if (abs(speed) < 1e-7) continue;
            float at = (plane.w - dot(plane.xyz, ray.origin)) / speed;
            // What is cut off there, too, is seen: rounding must not decide.
            float room = 0.02 * volume_spacing / max(abs(speed), 0.02);
            if (at > t && at < slice.t && at > ray.t_min - room && at < ray.t_max + room) slice.t = at;
        }
        if (slice.t < 1e30) slice.color = slice_look(volume_place(ray.origin + slice.t * ray.direction));
    }
    return slice;
}
