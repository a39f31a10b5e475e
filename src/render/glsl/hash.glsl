// A 32-bit integer hash of low bias (Wellons 2018, "hash-prospector").
uint random_hash(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}
