// Volumes in the page: opened from files, seen as the native program shows them, and edited by their transfer function.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { at, type Json } from '../../src/schema';
import { atRest, difference, hasNative, pixels, renderNatively, Rig, screenshotPath } from './rig';

const kTime = 240_000;
const kSize = 24;

let rig: Rig;
let page: Page;
let folder: string;

/** A ball in a box of air, brighter inside: 16-bit values up to 3000. */
function ball(): Uint16Array {
    const voxels = new Uint16Array(kSize ** 3);
    for (let z = 0, i = 0; z < kSize; z++) {
        for (let y = 0; y < kSize; y++) {
            for (let x = 0; x < kSize; x++, i++) {
                const r = Math.hypot(x - 11.5, y - 11.5, z - 11.5);
                voxels[i] = r > 9 ? 20 : r > 4 ? 1000 : 3000;
            }
        }
    }
    return voxels;
}

function nrrd(): string {
    const header = `NRRD0004\ntype: ushort\ndimension: 3\nsizes: ${kSize} ${kSize} ${kSize}\nencoding: raw\nendian: little\nspace: LPS\n` +
        'space directions: (0,2,0) (-2,0,0) (0,0,2.5)\nspace origin: (20,-24,-30)\n\n';
    const path = join(folder, 'ball.nrrd');
    writeFileSync(path, Buffer.concat([Buffer.from(header), Buffer.from(ball().buffer)]));
    return path;
}

const scene = (path: string) => page.evaluate((wanted) => window.apeiron.scene()[wanted.split('.')[0]!] as never, path).then((part) => at(part as never, path.split('.').slice(1).join('.')));

beforeAll(async () => {
    rig = await Rig.start();
    folder = mkdtempSync(join(tmpdir(), 'apeiron-volumes-'));
}, kTime);
afterAll(async () => {
    await rig?.stop();
    rmSync(folder, { recursive: true, force: true });
});
afterEach(async () => {
    await page?.close();
    expect(rig.complaints.splice(0)).toEqual([]);
});

/** The page, showing the ball. */
async function openBall(): Promise<string> {
    page = await rig.open('scene=mandelbulb&width=160&height=90&samples=2');
    const path = nrrd();
    await page.locator('#panel-toggle').click(); // pictures of a given size have no panel at first
    await page.locator('#file').setInputFiles(path);
    await page.locator('.transfer').waitFor();
    await atRest(page);
    return path;
}

describe('a volume', () => {
    it('is opened from a file, and seen as the native program shows it', async () => {
        const path = await openBall();
        expect(await scene('subject.source')).toBe('ball.nrrd');
        expect(await page.locator('.messages').innerText()).toBe('');
        expect(await page.locator('#scene').evaluate((select: HTMLSelectElement) => select.selectedOptions[0]!.text)).toBe('ball.nrrd');
        if (!hasNative) return;
        // Renderers of volumes march in small steps: two devices round a few of them to another voxel.
        const { mean, failing } = difference(await pixels(page), await renderNatively(path, '160x90', 2));
        expect(mean).toBeLessThan(1);
        expect(failing).toBeLessThan(0.01);
    }, kTime);

    it('tells its values under the cursor', async () => {
        await openBall();
        const reading = (await page.evaluate(() => window.apeiron.value(0.5, 0.5)))!;
        expect(reading.values.length).toBe(1);
        expect(reading.values[0]!.value).toBeGreaterThan(100);
        expect(reading.values[0]!.value).toBeLessThan(3001);
        expect(await page.evaluate(() => window.apeiron.value(0.01, 0.01))).toBeNull();
        const box = (await page.locator('#view').boundingBox())!;
        await page.mouse.move(box.x + box.width / 2 - 2, box.y + box.height / 2);
        await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
        await page.locator('#value', { hasText: ' mm' }).waitFor();
    }, kTime);

    it('of bare voxels is asked about', async () => {
        page = await rig.open('scene=mandelbulb&width=160&height=90&samples=1');
        const path = join(folder, 'ball_24x24x24_uint16.raw');
        writeFileSync(path, Buffer.from(ball().buffer));
        await page.locator('#file').setInputFiles(path);
        await page.locator('#raw').waitFor();
        expect(await page.locator('#raw-form').inputValue()).toBe('24x24x24:uint16');
        await page.locator('#raw button[value=open]').click();
        await page.waitForFunction(() => (window.apeiron.scene()['subject'] as { type: string }).type === 'volume');
        await atRest(page);
        // Wrong ones are told about, and the picture stays.
        await page.evaluate(() => window.apeiron.openVolume('short.raw', new Uint8Array(10), '24x24x24:uint16').catch((error: Error) => document.title = error.message));
        expect(await page.title()).toContain('too soon');
        expect(await scene('subject.source')).toBe('ball_24x24x24_uint16.raw');
    }, kTime);

    it('that is damaged leaves everything as it is', async () => {
        page = await rig.open('scene=mandelbulb&width=160&height=90&samples=1');
        const path = join(folder, 'bad.nrrd');
        writeFileSync(path, 'NRRD0004\ntype: ushort\ndimension: 3\nsizes: 9 9 9\nencoding: raw\n\nabc');
        await page.locator('#file').setInputFiles(path);
        await page.locator('#alert', { hasText: 'bad.nrrd: the file ends too soon' }).waitFor();
        expect(await scene('subject.type')).toBe('fractal');
    }, kTime);
});

describe('the transfer function', () => {
    const transfer = () => scene('subject.transfer') as Promise<Json>;
    const stage = () => page.locator('.transfer-front');

    it('is edited by its points, and the picture follows', async () => {
        await openBall();
        const before = await pixels(page);
        const count = await stage().locator('circle').count();
        expect(count).toBeGreaterThan(1);
        expect(await page.locator('.transfer-stage canvas').evaluate((canvas: HTMLCanvasElement) => canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v > 0))).toBe(true);
        const box = (await stage().boundingBox())!;
        await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.5 * box.height);
        await page.mouse.down();
        await page.mouse.move(box.x + 0.32 * box.width, box.y + 0.1 * box.height, { steps: 4 });
        await page.mouse.up();
        await page.waitForFunction(() => typeof (window.apeiron.scene()['subject'] as { transfer: unknown }).transfer === 'object');
        expect(await stage().locator('circle').count()).toBe(count + 1);
        await page.locator('#transfer-color').evaluate((input: HTMLInputElement) => {
            input.value = '#ff0000';
            input.dispatchEvent(new Event('change'));
        });
        await page.waitForFunction(() => JSON.stringify(window.apeiron.scene()).includes('#ff0000'));
        await atRest(page);
        expect(difference(before, await pixels(page)).mean).toBeGreaterThan(1);
        await stage().focus();
        await page.keyboard.press('Delete');
        await page.waitForFunction(() => !JSON.stringify(window.apeiron.scene()).includes('#ff0000'));
        expect(await stage().locator('circle').count()).toBe(count);
    }, kTime);

    it('has presets, and shapes over value and gradient', async () => {
        await openBall();
        await page.selectOption('#transfer-preset', 'grey');
        await page.waitForFunction(() => (window.apeiron.scene()['subject'] as { transfer: unknown }).transfer === 'grey');
        await page.waitForFunction(() => document.querySelectorAll('.transfer-front circle').length === 2);
        await page.locator('.transfer label', { hasText: 'Shapes' }).click();
        await page.locator('.transfer-actions button', { hasText: 'Triangle' }).click();
        await page.waitForFunction(() => JSON.stringify(window.apeiron.scene()).includes('"triangle"'));
        expect(await stage().locator('polygon.shape').count()).toBe(1);
        await atRest(page);
        expect(await page.locator('#alert').isVisible()).toBe(false);
    }, kTime);

    it('is saved and loaded as scenes have it', async () => {
        await openBall();
        await page.selectOption('#transfer-preset', 'grey');
        await page.waitForFunction(() => document.querySelectorAll('.transfer-front circle').length === 2);
        const saving = page.waitForEvent('download');
        await page.locator('.transfer-files button', { hasText: 'Save' }).click();
        const saved = JSON.parse(readFileSync(await (await saving).path(), 'utf8')) as { points: { opacity: number }[] };
        expect(saved.points.map(({ opacity }) => opacity)).toEqual([0, 1]);
        saved.points[1]!.opacity = 0.5;
        const path = join(folder, 'half.json');
        writeFileSync(path, JSON.stringify(saved));
        await page.locator('#transfer-file').setInputFiles(path);
        await page.waitForFunction(() => typeof (window.apeiron.scene()['subject'] as { transfer: unknown }).transfer === 'object');
        expect(await transfer()).toEqual(saved);
        writeFileSync(path, '{"apeiron": 1}');
        await page.locator('#transfer-file').setInputFiles(path);
        await page.locator('#alert', { hasText: 'half.json: there is no transfer function in it' }).waitFor();
    }, kTime);

    it('looks like something', async () => {
        page = await rig.open('scene=volume_phantom&samples=2');
        await page.locator('.transfer').waitFor();
        await atRest(page);
        await page.screenshot({ path: screenshotPath('transfer') });
        await page.locator('.transfer label', { hasText: 'Shapes' }).click();
        await page.waitForTimeout(500);
        await page.screenshot({ path: screenshotPath('transfer_shapes') });
    }, kTime);
});
