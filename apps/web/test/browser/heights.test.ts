// The GLSL of terrain heights in the browser, against the recurrence written down once more in the numbers of
// JavaScript: every bit of a million vertices. What the processor computes natively is held to the same vectors, and to
// the same GLSL, by the native tests.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { Rig, root } from './rig';

const kFraction = 4096;
const kLevels = 7;
/** Vertices along a tile's side, with a margin of one all around. */
const kSide = (1 << kLevels) + 3;

function lowBias(x: number): number {
    x = Math.imul(x ^ (x >>> 16), 0x7feb352d);
    x = Math.imul(x ^ (x >>> 15), 0x846ca68b);
    return (x ^ (x >>> 16)) >>> 0;
}

const levelHash = (seed: number, level: number): number => lowBias(Math.imul(level, 0x9e3779b9) ^ seed);

const noise = (hash: number, x: number, y: number): number => (lowBias(x ^ lowBias(y ^ hash)) >>> 19) - kFraction;

interface Shape {
    seed: number;
    /** Outer weight of an even point's three parents, of 8: 1 B-spline, 0 bilinear. */
    outer: number;
}

/** A square of heights; its first lattice point is (x, y). */
interface Square {
    level: number;
    x: number;
    y: number;
    side: number;
    heights: Int32Array;
}

/** Heights of the next level from lattice point (2 x + firstX, 2 y + firstY) of the square on. */
function subdivide(shape: Shape, square: Square, firstX: number, firstY: number, side: number): Square {
    const level = square.level + 1;
    const hash = levelHash(shape.seed, level);
    const x0 = (2 * square.x + firstX) | 0;
    const y0 = (2 * square.y + firstY) | 0;
    const parents = (point: number): [number, number][] => {
        const middle = point >> 1;
        if (point % 2 !== 0) return [[middle, 4], [middle + 1, 4]];
        return [[middle - 1, shape.outer], [middle, 8 - 2 * shape.outer], [middle + 1, shape.outer]];
    };
    const heights = new Int32Array(side * side);
    for (let j = 0; j < side; ++j) {
        const rows = parents(firstY + j);
        for (let i = 0; i < side; ++i) {
            const columns = parents(firstX + i);
            const reference = square.heights[rows[0]![0] * square.side + columns[1]![0]]!;
            // Differences that did not wrap around, weighted without loss: numbers have 53 bits.
            let sum = 0;
            for (const [row, weightY] of rows) {
                for (const [column, weightX] of columns)
                    sum += weightX * weightY * ((square.heights[row * square.side + column]! - reference) | 0);
            }
            heights[j * side + i] = 2 * reference + Math.floor(sum / 32) + noise(hash, x0 + i, y0 + j);
        }
    }
    return { level, x: x0, y: y0, side, heights };
}

/** The window of the root cell: the points from one before it to one behind it. */
function rootWindow(shape: Shape): Square {
    const hash = levelHash(shape.seed, 0);
    const heights = Int32Array.from({ length: 16 }, (_, k) => noise(hash, (k % 4) - 1, (k >> 2) - 1));
    return { level: 0, x: -1, y: -1, side: 4, heights };
}

const childWindow = (shape: Shape, window: Square, digit: number): Square =>
    subdivide(shape, window, 1 + (digit & 1), 1 + (digit >> 1), 4);

/** Fine and coarse heights of all vertices of a tile, as terrain_height() in height.glsl says. */
function tileHeights(shape: Shape, window: Square): Int32Array {
    let coarse = window;
    let fine = window;
    for (let m = 1; m <= kLevels; ++m) {
        coarse = fine;
        fine = subdivide(shape, coarse, 1, 1, (1 << m) + 3);
    }
    const result = new Int32Array(2 * kSide * kSide);
    for (let j = 0; j < kSide; ++j) {
        for (let i = 0; i < kSide; ++i) {
            const k = j * kSide + i;
            result[2 * k] = fine.heights[k]!;
            result[2 * k + 1] = 2 * coarse.heights[(((j - 1) >> 1) + 1) * coarse.side + ((i - 1) >> 1) + 1]!;
        }
    }
    return result;
}

/** What the shader is told of a tile. */
interface TileUniforms {
    window: number[];
    cell: [number, number];
    outer: number;
    hash: number[];
}

/** Runs in the page: heights of tiles, two integers a vertex. */
function drawTiles(given: { source: string; tiles: TileUniforms[]; levels: number; side: number }): { device: string; heights: number[][] } {
    const gl = document.createElement('canvas').getContext('webgl2');
    if (!gl) throw new Error('there is no WebGL 2');
    const compile = (kind: number, text: string): WebGLShader => {
        const shader = gl.createShader(kind)!;
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? 'no words');
        return shader;
    };
    const head = '#version 300 es\nprecision highp float;\nprecision highp int;\n';
    const program = gl.createProgram()!;
    gl.attachShader(
        program,
        compile(gl.VERTEX_SHADER, `${head}void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`),
    );
    gl.attachShader(
        program,
        compile(
            gl.FRAGMENT_SHADER,
            `${head}${given.source}\nout ivec4 heights;\nvoid main() { heights = ivec4(terrain_height(ivec2(gl_FragCoord.xy) - 1), 0, 0); }`,
        ),
    );
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? 'no words');
    gl.useProgram(program);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RG32I, given.side, given.side);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, gl.getParameter(gl.TEXTURE_BINDING_2D), 0);
    gl.viewport(0, 0, given.side, given.side);
    const at = (name: string): WebGLUniformLocation | null => gl.getUniformLocation(program, name);
    const heights = given.tiles.map((tile) => {
        gl.uniform1iv(at('terrain_window'), tile.window);
        gl.uniform2i(at('terrain_cell'), tile.cell[0], tile.cell[1]);
        gl.uniform1i(at('terrain_levels'), given.levels);
        gl.uniform1i(at('terrain_outer'), tile.outer);
        gl.uniform1iv(at('terrain_hash'), tile.hash);
        gl.uniform1iv(at('terrain_amplitude'), tile.hash.map(() => 4096));
        gl.uniform1iv(at('terrain_step'), tile.hash.map(() => 1));
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        const texels = new Int32Array(4 * given.side * given.side);
        gl.readPixels(0, 0, given.side, given.side, gl.RGBA_INTEGER, gl.INT, texels);
        return Array.from(texels).filter((_, k) => k % 4 < 2);
    });
    if (gl.getError() !== gl.NO_ERROR) throw new Error('WebGL complains');
    const info = gl.getExtension('WEBGL_debug_renderer_info');
    return { device: String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER)), heights };
}

describe('terrain heights', () => {
    let rig: Rig;
    let page: Page;

    beforeAll(async () => {
        rig = await Rig.start();
        page = await rig.blank();
    }, 60_000);
    afterAll(async () => {
        await rig?.stop();
    });

    it('meets the reference vectors with the recurrence of this test', () => {
        const file = JSON.parse(readFileSync(join(root, 'tests/data/terrain_vectors.json'), 'utf8')) as {
            vectors: { seed: number; path: string; bilinear: number[]; bspline_window: number[] }[];
        };
        expect(file.vectors.length).toBeGreaterThanOrEqual(14);
        for (const vector of file.vectors) {
            const windowOf = (outer: number): number[] => {
                const shape = { seed: vector.seed, outer };
                let window = rootWindow(shape);
                for (const digit of vector.path) window = childWindow(shape, window, Number(digit));
                return Array.from(window.heights);
            };
            expect(windowOf(1)).toEqual(vector.bspline_window);
            const linear = windowOf(0);
            expect([5, 6, 9, 10].map((k) => linear[k])).toEqual(vector.bilinear);
        }
    });

    it('are those of the recurrence in every bit, of a million vertices of both kernels', async () => {
        const read = (file: string) => readFileSync(join(root, 'src', file), 'utf8');
        const source = read('terrain/glsl/height.glsl').replace(/^#include "(.*)"$/gm, (_, file: string) => read(file));
        const kTiles = 30; // of each kernel: 131 x 131 vertices each
        let compared = 0;
        let mismatches = 0;
        let device = '';
        for (const shape of [
            { seed: 0xdecade, outer: 1 },
            { seed: 77, outer: 0 },
        ]) {
            let random = shape.seed;
            let window = rootWindow(shape);
            const tiles: TileUniforms[] = [];
            const expected: Int32Array[] = [];
            for (let i = 0; i < kTiles; ++i) {
                while (window.level < (10_000 * i) / (kTiles - 1)) {
                    random = lowBias(random + 1);
                    window = childWindow(shape, window, random & 3);
                }
                tiles.push({
                    window: Array.from(window.heights),
                    cell: [(window.x + 1) | 0, (window.y + 1) | 0],
                    outer: shape.outer,
                    hash: Array.from({ length: 8 }, (_, k) => levelHash(shape.seed, window.level + 1 + k) | 0),
                });
                expected.push(tileHeights(shape, window));
            }
            const drawn = await page.evaluate(drawTiles, { source, tiles, levels: kLevels, side: kSide });
            device = drawn.device;
            expected.forEach((heights, i) => {
                for (let k = 0; k < heights.length; k += 2) {
                    ++compared;
                    if (drawn.heights[i]![k] !== heights[k] || drawn.heights[i]![k + 1] !== heights[k + 1]) ++mismatches;
                }
            });
        }
        console.log(`${compared} vertices of levels 7 to 10,007 compared on ${device}, ${mismatches} mismatches`);
        expect(mismatches).toBe(0);
        expect(compared).toBeGreaterThanOrEqual(1_000_000);
    }, 90_000);
});
