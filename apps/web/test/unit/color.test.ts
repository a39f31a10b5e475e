import { describe, expect, it } from 'vitest';
import { hexFromLinear, linearFromHex, linearFromSrgb, srgbFromLinear } from '../../src/color';

describe('colours', () => {
    it('agree with IEC 61966-2-1', () => {
        expect(srgbFromLinear(0.0031308)).toBeCloseTo(0.04045, 4);
        expect(srgbFromLinear(0.5)).toBeCloseTo(0.73536, 5);
        expect(linearFromSrgb(0.5)).toBeCloseTo(0.21404, 5);
    });

    it('survive the way to linear and back in all 8-bit steps', () => {
        for (let value = 0; value < 256; value++) {
            const hex = `#${value.toString(16).padStart(2, '0').repeat(3)}`;
            expect(hexFromLinear(linearFromHex(hex)!)).toBe(hex);
        }
    });

    it('are cut off outside of what a display shows', () => {
        expect(hexFromLinear([4, -1, 1])).toBe('#ff00ff');
    });

    it('are read with and without the hash, long and short, and nothing else', () => {
        expect(linearFromHex('f00')).toEqual([1, 0, 0]);
        expect(linearFromHex(' #00FF00 ')).toEqual([0, 1, 0]);
        for (const wrong of ['', '#12', '#12345', 'red', '#gggggg']) expect(linearFromHex(wrong)).toBeNull();
    });
});
