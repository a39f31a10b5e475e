// Scenes hold linear RGB; people pick display (sRGB) colours. IEC 61966-2-1.

export type Rgb = readonly [number, number, number];

export function srgbFromLinear(value: number): number {
    const v = Math.min(Math.max(value, 0), 1);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
}

export function linearFromSrgb(value: number): number {
    const v = Math.min(Math.max(value, 0), 1);
    return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
}

/** "#rrggbb" of a linear colour; values beyond 1 are cut off. */
export function hexFromLinear(rgb: Rgb): string {
    const digits = rgb.map((value) => Math.round(255 * srgbFromLinear(value)).toString(16).padStart(2, '0'));
    return `#${digits.join('')}`;
}

/** Null when the text is no colour: "#rgb" and "#rrggbb" are, with or without #. Five digits: finer than 8 bits. */
export function linearFromHex(text: string): Rgb | null {
    const match = /^#?([0-9a-f]{3}|[0-9a-f]{6})$/i.exec(text.trim());
    if (!match) return null;
    let digits = match[1]!;
    if (digits.length === 3) digits = [...digits].map((digit) => digit + digit).join('');
    const channel = (index: number) => {
        const value = linearFromSrgb(parseInt(digits.slice(2 * index, 2 * index + 2), 16) / 255);
        return Math.round(value * 1e5) / 1e5;
    };
    return [channel(0), channel(1), channel(2)];
}
