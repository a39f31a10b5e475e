#include "render/glsl/hash.glsl"

// Random numbers that depend on nothing but pixel, sample index, dimension and scene seed.

uniform uint random_seed;
uniform uint random_sample; // index of the sample that is being computed, from 0

uint random_reverse(uint x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// Owen's nested uniform scrambling as a hash, on reversed bits (Laine & Karras 2011; constants by Vegdahl 2021).
uint random_permute(uint x, uint seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}
uint random_scramble(uint x, uint seed) { return random_reverse(random_permute(random_reverse(x), seed)); }

float random_unit(uint x) { return float(x >> 8) * (1.0 / 16777216.0); }

// Two numbers in [0, 1) of pair `dimension`: the (0,2)-sequence of Sobol's first two dimensions, scrambled
// and shuffled for each pixel and pair (Burley 2020, "Practical Hash-based Owen Scrambling").
vec2 random_pair(ivec2 pixel, uint dimension) {
    uint seed = random_hash(uint(pixel.x) ^ random_hash(uint(pixel.y) ^ random_hash(dimension ^ random_hash(random_seed))));
    // The first dimension is the index with its bits reversed.
    uint x = random_permute(random_reverse(random_sample), seed);
    // The second one's matrix is Pascal's triangle modulo 2, where C(i, p) is odd if and only if all bits of p are bits of i (Lucas
    // 1878): sums over supersets of bit positions, in five steps.
    uint y = x;
    y ^= (y << 1) & 0xaaaaaaaau;
    y ^= (y << 2) & 0xccccccccu;
    y ^= (y << 4) & 0xf0f0f0f0u;
    y ^= (y << 8) & 0xff00ff00u;
    y ^= (y << 16) & 0xffff0000u;
    return vec2(random_unit(random_scramble(x, random_hash(seed ^ 0x51633e2du))),
                random_unit(random_scramble(y, random_hash(seed ^ 0x68bc21ebu))));
}
