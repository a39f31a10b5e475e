// What is cut away from a volume: everything outside a box, and what is in front of up to three planes, in world space. A part of
// the subject's GLSL; the engine gives clip_camera. Positions are relative to the camera, as all of the shader's.

uniform bool clip;       //! false | Cut away what is outside the box from clip_low to clip_high
uniform vec3 clip_low;   //! (-100, -100, -100) [-1e6, 1e6] unit mm | Lower corner of the clipping box in the world
uniform vec3 clip_high;  //! (100, 100, 100) [-1e6, 1e6] unit mm | Upper corner of the clipping box in the world
uniform int clip_planes; //! 0 [0, 3] | How many planes cut: what lies on the side that their normals point to is left out
uniform vec3 clip_normal_1; //! (0, 0, 1) [-1, 1] | Normal of the first plane
uniform vec3 clip_normal_2; //! (1, 0, 0) [-1, 1] | Normal of the second plane
uniform vec3 clip_normal_3; //! (0, -1, 0) [-1, 1] | Normal of the third plane
uniform vec3 clip_offsets;  //! (0, 0, 0) [-1e6, 1e6] unit mm | How far the planes are from the world's origin, along their normals

uniform vec3 clip_camera; // where the camera is in the world [mm]

// Cuts [near, far] of a ray by the half space dot(normal, p) <= offset, p relative to the camera.
void clip_half_space(vec3 normal, float offset, vec3 origin, vec3 direction, inout float near, inout float far) {
    float size = length(normal);
    if (size == 0.0) return;
    float speed = dot(normal, direction) / size;
    float room = offset - dot(normal, origin) / size;
    if (abs(speed) < 1e-12) {
        if (room < 0.0) far = near - 1.0;
        return;
    }
    float t = room / speed;
    if (speed > 0.0) far = min(far, t); else near = max(near, t);
}

// The part of a ray that is left; nothing where near > far.
void volume_clip(vec3 origin, vec3 direction, inout float near, inout float far) {
    if (clip) {
        for (int axis = 0; axis < 3; ++axis) {
            vec3 normal = vec3(axis == 0, axis == 1, axis == 2);
            clip_half_space(normal, clip_high[axis] - clip_camera[axis], origin, direction, near, far);
            clip_half_space(-normal, clip_camera[axis] - clip_low[axis], origin, direction, near, far);
        }
    }
    for (int i = 0; i < clip_planes; ++i) {
        vec3 normal = i == 0 ? clip_normal_1 : (i == 1 ? clip_normal_2 : clip_normal_3);
        float size = max(length(normal), 1e-20);
        clip_half_space(normal, clip_offsets[i] - dot(normal, clip_camera) / size, origin, direction, near, far);
    }
}
