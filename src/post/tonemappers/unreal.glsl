/// The default of the Unreal Engine 3 ("Color Grading" in its documentation): a simple shoulder that is near the look of film.
#pragma apeiron invalidates present

vec3 tonemap(vec3 color) {
    vec3 x = max(color, 0.0);
    return pow(min(1.019 * x / (x + 0.155), 1.0), vec3(2.2)); // made for displays of gamma 2.2, which follow here
}
