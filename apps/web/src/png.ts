// Scenes inside PNG files, as `apeiron render` writes them: a tEXt chunk "apeiron:scene".

const kSignature = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
export const kSceneKey = 'apeiron:scene';

const kCrcTable = Uint32Array.from({ length: 256 }, (_, n) => {
    let c = n;
    for (let k = 0; k < 8; k++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
    return c;
});

export function crc(bytes: Uint8Array): number {
    let c = 0xffffffff;
    for (const byte of bytes) c = kCrcTable[(c ^ byte) & 0xff]! ^ (c >>> 8);
    return (c ^ 0xffffffff) >>> 0;
}

export function isPng(file: Uint8Array): boolean {
    return kSignature.every((byte, index) => file[index] === byte);
}

/** JSON in ASCII alone: other characters as \u escapes. */
function ascii(json: string): string {
    return json.replace(/[^\x00-\x7f]/g, (c) => `\\u${c.charCodeAt(0).toString(16).padStart(4, '0')}`);
}

/** The same PNG with the scene's JSON inside. */
export function withScene(png: Uint8Array, json: string): Uint8Array<ArrayBuffer> {
    // As small as it can be: it is not meant for reading.
    const text = `${kSceneKey}\0${ascii(JSON.stringify(JSON.parse(json)))}`;
    const chunk = new Uint8Array(12 + text.length);
    const view = new DataView(chunk.buffer);
    view.setUint32(0, text.length);
    chunk.set(new TextEncoder().encode(`tEXt${text}`), 4);
    view.setUint32(8 + text.length, crc(chunk.subarray(4, 8 + text.length)));
    // After IHDR, which is always first and 25 bytes long.
    const place = kSignature.length + 25;
    const result = new Uint8Array(png.length + chunk.length);
    result.set(png.subarray(0, place));
    result.set(chunk, place);
    result.set(png.subarray(place), place + chunk.length);
    return result;
}

/** The scene's JSON inside a PNG; null when there is none. */
export async function sceneOf(png: Uint8Array): Promise<string | null> {
    const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
    for (let place = kSignature.length; place + 12 <= png.length; ) {
        const length = view.getUint32(place);
        const type = String.fromCharCode(...png.subarray(place + 4, place + 8));
        const data = png.subarray(place + 8, place + 8 + length);
        const end = data.indexOf(0);
        if (end > 0 && new TextDecoder('latin1').decode(data.subarray(0, end)) === kSceneKey) {
            if (type === 'tEXt') return new TextDecoder('latin1').decode(data.subarray(end + 1));
            if (type === 'zTXt') return inflate(data.subarray(end + 2));
        }
        place += 12 + length;
    }
    return null;
}

async function inflate(bytes: Uint8Array): Promise<string> {
    const stream = new Blob([bytes as Uint8Array<ArrayBuffer>]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Response(stream).text();
}
