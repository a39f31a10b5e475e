// Random numbers that depend on nothing but pixel, sample index, dimension and scene seed.

uniform uint random_seed;
uniform uint random_sample; // index of the sample that is being computed, from 0

// A 32-bit integer hash of low bias (Wellons 2018, "hash-prospector").
uint random_hash(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

uint random_reverse(uint x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// Owen's nested uniform scrambling as a hash (Laine & Karras 2011; constants by Vegdahl 2021).
uint random_scramble(uint x, uint seed) {
    x = random_reverse(x);
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return random_reverse(x);
}

float random_unit(uint x) { return float(x >> 8) * (1.0 / 16777216.0); }

// Two numbers in [0, 1) of pair `dimension`: the (0,2)-sequence of Sobol's first two dimensions, scrambled
// and shuffled for each pixel and pair (Burley 2020, "Practical Hash-based Owen Scrambling").
vec2 random_pair(ivec2 pixel, uint dimension) {
    uint seed = random_hash(uint(pixel.x) ^ random_hash(uint(pixel.y) ^ random_hash(dimension ^ random_hash(random_seed))));
    uint index = random_scramble(random_sample, seed);
    uint x = random_reverse(index);
    uint y = x;
    // Sobol's second dimension is Pascal's triangle modulo 2, a Kronecker power of (1 1; 0 1) by Lucas' theorem: one step a factor.
    y ^= (y & 0x55555555u) << 1;
    y ^= (y & 0x33333333u) << 2;
    y ^= (y & 0x0f0f0f0fu) << 4;
    y ^= (y & 0x00ff00ffu) << 8;
    y ^= y << 16;
    return vec2(random_unit(random_scramble(x, random_hash(seed ^ 0x51633e2du))),
                random_unit(random_scramble(y, random_hash(seed ^ 0x68bc21ebu))));
}
