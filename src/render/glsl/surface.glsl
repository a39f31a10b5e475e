// The `surface` interface: what a renderer asks of a subject that has surfaces. Positions are relative to the camera, so
// that nothing here depends on where in the world it is.

struct Ray {
    vec3 origin;
    vec3 direction; // unit length
    float t_min;
    float t_max;
    float width;    // footprint's diameter at the origin ...
    float spread;   // ... and how much it grows per unit of length: a pixel's cone
};

struct Hit {
    float t;        // along the ray
    vec3 position;
    float footprint; // diameter of the pixel there: the size of the smallest thing worth resolving
    float effort;   // steps from t_min to there, as part of the most there may be: 0..1
};

struct Material {
    vec3 albedo;     // linear
    float roughness; // 0..1, perceptual: GGX alpha is its square
    float metalness; // 0..1
    vec3 emission;   // radiance
};

// The first surface along the ray within [t_min, t_max].
bool surface_trace(Ray ray, out Hit hit);

// How far along a cone, of the ray's width and spread about it, there is certainly no surface: a t from which any ray within the
// cone may start. 1e30: there is none at all. The cone is empty before ray.t_min.
float surface_clear(Ray cone);

// Unit normal, towards the side the ray came from.
vec3 surface_normal(Hit hit, vec3 direction);

Material surface_material(Hit hit, vec3 normal);

// Part of a light that reaches `position`: 0..1 within a cone of the light's half-angle (tangent `spread`; 0: a hard edge).
float surface_visibility(Hit hit, vec3 normal, vec3 direction, float t_max, float spread);

// Whether anything is in the way: exact, for sampled light. A march can be made step by step, so that pixels that are computed
// side by side need not wait for each other at the end of every ray (Aila & Laine 2009, "persistent threads").
struct March {
    vec3 origin;
    vec3 direction;
    float t;
    float t_max;
    float threshold; // as near is a hit
    float start;     // how far around the origin there is nothing
    float reach;     // how far around the point before there is nothing
    float stride;    // from there to here
    int steps;       // that are left
};
const int march_on = 0;
const int march_blocked = 1;
const int march_free = 2;
March surface_march(Hit hit, vec3 normal);                               // from there; then, for each direction,
void surface_march_to(inout March march, vec3 direction, float t_max);   // begin
int surface_march_on(inout March march);                                 // and go on until it is blocked or free
bool surface_blocked(Hit hit, vec3 normal, vec3 direction, float t_max);

// Where rays that leave the surface start.
vec3 surface_leave(Hit hit, vec3 normal);

// A lower bound of the distance from `position` to the nearest surface.
float surface_distance(vec3 position);

// How open the surroundings are, 0..1, from a few looks around.
float surface_openness(Hit hit, vec3 normal);
