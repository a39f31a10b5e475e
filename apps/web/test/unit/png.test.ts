import { deflateSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { isPng, kSceneKey, sceneOf, withScene } from '../../src/png';
import { decodePng, encodePng } from '../png';

const pixels = Uint8Array.from({ length: 4 * 3 * 2 }, (_, index) => 10 * index);
const picture = encodePng(3, 2, pixels);

describe('scenes in pictures', () => {
    it('come out as they went in, also beyond ASCII', async () => {
        const scene = { apeiron: 1, title: 'Menger, 3×3 – “größer” 🌀' };
        const file = withScene(picture, JSON.stringify(scene, null, 2));
        expect(isPng(file)).toBe(true);
        expect(JSON.parse((await sceneOf(file))!)).toEqual(scene);
    });

    it('leave the picture as it was', () => {
        const decoded = decodePng(withScene(picture, '{}'));
        expect([decoded.width, decoded.height]).toEqual([3, 2]);
        expect([...decoded.data]).toEqual([...pixels]);
    });

    it('are found compressed, too', async () => {
        const data = Buffer.concat([Buffer.from(`${kSceneKey}\0\0`, 'latin1'), deflateSync('{"apeiron":1}')]);
        const chunk = Buffer.alloc(12 + data.length);
        chunk.writeUInt32BE(data.length);
        chunk.write('zTXt', 4, 'latin1');
        data.copy(chunk, 8);
        const file = Buffer.concat([picture.subarray(0, 33), chunk, picture.subarray(33)]);
        expect(await sceneOf(file)).toBe('{"apeiron":1}');
    });

    it('are missing from other pictures, and other files are no pictures', async () => {
        expect(await sceneOf(picture)).toBeNull();
        expect(isPng(new TextEncoder().encode('{ "apeiron": 1 }'))).toBe(false);
    });
});
