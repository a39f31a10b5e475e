/// A picture of all directions (equirectangular, twice as wide as high) from an EXR, HDR, PNG or JPEG file. Its middle is seen looking
/// along +y, its upper edge is straight above (+z). As long as no file is named: white.
#pragma apeiron picture file

uniform sampler2D picture; // radiance, linear; the first row is the upper one

vec3 texel(ivec2 at, ivec2 size) {
    at.x += at.x < 0 ? size.x : (at.x >= size.x ? -size.x : 0); // all around
    return texelFetch(picture, ivec2(at.x, clamp(at.y, 0, size.y - 1)), 0).rgb;
}

vec3 radiance(vec3 direction) {
    ivec2 size = textureSize(picture, 0);
    float turn = direction.x == 0.0 && direction.y == 0.0 ? 0.0 : atan(direction.x, direction.y) * 0.159154943;
    float down = acos(clamp(direction.z, -1.0, 1.0)) * 0.318309886;
    vec2 place = vec2(0.5 + turn, down) * vec2(size) - 0.5;
    vec2 corner = floor(place);
    vec2 part = place - corner;
    ivec2 c = ivec2(corner);
    return mix(mix(texel(c, size), texel(c + ivec2(1, 0), size), part.x),
               mix(texel(c + ivec2(0, 1), size), texel(c + ivec2(1, 1), size), part.x), part.y);
}
