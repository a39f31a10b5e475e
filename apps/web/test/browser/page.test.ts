import { readFileSync, writeFileSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, describe, expect, it } from 'vitest';
import { sceneOf } from '../../src/png';
import { at } from '../../src/schema';
import { encodePng } from '../png';
import { atRest, brightness, difference, flatness, framesDuring, inBlocks, pixels, Rig, samples, screenshotPath, shown } from './rig';

const kSmall = 'scene=mandelbulb&width=320&height=180';
const kTime = 240_000;

let rig: Rig;
let page: Page;

beforeAll(async () => {
    rig = await Rig.start();
}, kTime);
afterAll(() => rig?.stop());
afterEach(async () => {
    await page?.close();
    expect(rig.complaints.splice(0)).toEqual([]);
});

/** The camera's position. */
async function position(): Promise<number[]> {
    const value = at(await page.evaluate(() => window.apeiron.scene()), 'camera.position');
    return (value as string[]).map(Number);
}

/** Waits until the camera has come to rest elsewhere. */
async function moved(from: number[]): Promise<void> {
    await page.waitForFunction(
        (old) => JSON.stringify((window.apeiron.scene()['camera'] as { position: string[] }).position.map(Number)) !== old,
        JSON.stringify(from),
    );
}

/** Mid canvas, or an offset from there [px]. */
async function centre(dx = 0, dy = 0): Promise<[number, number]> {
    const box = (await page.locator('#view').boundingBox())!;
    return [box.x + box.width / 2 + dx, box.y + box.height / 2 + dy];
}

describe('the picture', () => {
    it('is on the screen as it is in memory', async () => {
        page = await rig.open(`${kSmall}&samples=2`);
        await atRest(page);
        // The same samples and the same dither: only rounding to 8 bits by browser and test may differ.
        await expect.poll(async () => difference(await shown(page), await pixels(page)).mean, { timeout: 30_000 }).toBeLessThan(0.5);
        expect(difference(await shown(page), await pixels(page)).failing).toBe(0);
    }, kTime);

    it('survives a lost graphics context', async () => {
        page = await rig.open(`${kSmall}&samples=2`);
        await page.evaluate(() => window.apeiron.set('subject.power', 5));
        await atRest(page);
        const before = await pixels(page);
        // Waited for from before on: it is told for no longer than the context is lost.
        await Promise.all([page.locator('#mode', { hasText: 'context was lost' }).waitFor(), page.evaluate(() => window.apeiron.loseContext(700))]);
        await page.screenshot({ path: screenshotPath('lost') });
        await page.locator('#mode').waitFor({ state: 'hidden' });
        await atRest(page);
        const after = await pixels(page);
        expect(difference(before, after)).toEqual({ mean: 0, failing: 0 });
        rig.complaints.splice(0); // Chromium tells of the loss, too
    }, kTime);
});

describe('the camera', () => {
    it('orbits with the mouse, and samples start again', async () => {
        page = await rig.open(`${kSmall}&samples=6`);
        await atRest(page);
        const before = await pixels(page);
        const from = await position();
        const work = async () => ((await page.evaluate(() => window.apeiron.statistics())) as { pixels: number }).pixels;
        const worked = await work();
        await page.mouse.move(...(await centre()));
        await page.mouse.down();
        await page.mouse.move(...(await centre(60, 20)), { steps: 8 });
        await page.mouse.up();
        await moved(from);
        await atRest(page);
        expect((await pixels(page)).samples).toBe(6);
        expect((await work()) - worked).toBeGreaterThanOrEqual(6 * 320 * 180); // all of them anew
        const to = await position();
        const target = (await page.evaluate(() => (window.apeiron.scene()['camera'] as { target: string[] }).target)).map(Number);
        const far = (place: number[]) => Math.hypot(...place.map((x, i) => x - target[i]!));
        expect(far(to)).toBeCloseTo(far(from), 1); // the same distance from the target
        expect(difference(before, await pixels(page)).failing).toBeGreaterThan(0.1);
        await page.keyboard.press('r');
        await page.waitForFunction(
            (wanted) => JSON.stringify((window.apeiron.scene()['camera'] as { position: string[] }).position.map(Number)) === wanted,
            JSON.stringify(from),
        );
    }, kTime);

    it('shows a whole, detailed picture in every frame of a drag', async () => {
        page = await rig.open(`${kSmall}&samples=4`);
        await atRest(page);
        const still = await shown(page);
        // A move for each picture, so that the camera turns as far between two of them on every machine: 0.06 rad. By time, a
        // machine that shows three pictures a second would turn so far that the old one has nothing to say about the new one.
        const kMoves = 30;
        const frames = await framesDuring(page, async (next) => {
            await page.mouse.move(...(await centre()));
            await page.mouse.down();
            for (let i = 1; i <= kMoves; i++) {
                await page.mouse.move(...(await centre(3 * i, i)));
                await next();
            }
            await page.mouse.up();
        });
        writeFileSync(screenshotPath('drag'), encodePng(320, 180, frames[Math.floor(frames.length / 2)]!.data));
        await atRest(page);
        const ends = [brightness(still), brightness(await shown(page))];
        const [rest, moving, blocks] = [flatness(still), Math.max(...frames.map(flatness)), flatness(inBlocks(still, 4))];
        const light = frames.map(brightness);
        console.log(
            `a drag: ${frames.length} pictures; at most ${moving.toFixed(3)} flat (${rest.toFixed(3)} at rest, ${blocks.toFixed(3)} in blocks), ` +
                `brightness ${Math.min(...light).toFixed(1)} to ${Math.max(...light).toFixed(1)} (${ends.map((end) => end.toFixed(1)).join(' and ')} at rest)`,
        );
        expect(frames.length).toBeGreaterThan(kMoves);
        expect(blocks).toBeGreaterThan(rest + 0.1); // or the next line would say nothing
        expect(moving).toBeLessThan(0.5 * (rest + blocks));
        // It turns by 1.6 rad in the light of two suns: a black picture, or a white one, would be far outside.
        expect(Math.min(...light)).toBeGreaterThan(0.75 * Math.min(...ends));
        expect(Math.max(...light)).toBeLessThan(1.25 * Math.max(...ends));
    }, kTime);

    it('makes sharp what is double clicked with Shift, without turning', async () => {
        page = await rig.open(`${kSmall}&samples=2`);
        await page.evaluate(() => window.apeiron.set('camera.aperture', 0.05));
        await atRest(page);
        const camera = async () => (await page.evaluate(() => window.apeiron.scene()))['camera'] as { focus: number };
        const before = await camera();
        await page.keyboard.down('Shift');
        await page.mouse.dblclick(...(await centre(20, 10)));
        await page.keyboard.up('Shift');
        await page.waitForFunction((old) => (window.apeiron.scene()['camera'] as { focus: number }).focus !== old, before.focus);
        await atRest(page);
        const after = await camera();
        expect(after).toEqual({ ...before, focus: after.focus });
        // In front of the target, which is inside the bulb, and not nearer than its surface is to the camera.
        const far = Math.hypot(...(await position()));
        expect(after.focus).toBeLessThan(far);
        expect(after.focus).toBeGreaterThan((await page.evaluate(() => window.apeiron.status()!.distance))!);
    }, kTime);

    it('zooms with the wheel to what is under the cursor, and aims there on a double click', async () => {
        page = await rig.open(`${kSmall}&samples=1`);
        await atRest(page);
        const distance = () => page.evaluate(() => window.apeiron.status()!.distance);
        const far = (await distance())!;
        const from = await position();
        await page.mouse.move(...(await centre(-20, 10)));
        for (let i = 0; i < 12; i++) {
            await page.mouse.wheel(0, -200);
            await page.waitForTimeout(30);
        }
        await moved(from);
        await atRest(page);
        const near = (await distance())!;
        expect(near).toBeLessThan(0.5 * far);
        expect(near).toBeGreaterThan(0);
        const target = JSON.stringify(at(await page.evaluate(() => window.apeiron.scene()), 'camera.target'));
        const place = await position();
        await page.mouse.dblclick(...(await centre(30, -20)));
        await page.waitForFunction(
            (old) => JSON.stringify((window.apeiron.scene()['camera'] as { target: string[] }).target) !== old,
            target,
        );
        expect(await position()).toEqual(place);
    }, kTime);

    it('flies with the keys, slower near a surface, and never through it', async () => {
        page = await rig.open(`${kSmall}&samples=1`);
        await atRest(page);
        const from = await position();
        await page.locator('#view').focus();
        await page.keyboard.press('f');
        await page.locator('#mode', { hasText: 'Flying' }).waitFor();
        await page.keyboard.down('w');
        await page.waitForTimeout(2500);
        await page.keyboard.up('w');
        await page.keyboard.press('f');
        await page.locator('#mode').waitFor({ state: 'hidden' });
        await atRest(page);
        const to = await position();
        expect(Math.hypot(...to.map((v, i) => v - from[i]!))).toBeGreaterThan(0.3);
        expect(await page.evaluate(() => window.apeiron.status()!.distance)).toBeGreaterThan(0);
    }, kTime);
});

describe('scenes', () => {
    const broken = '{\n  "apeiron": 1,\n  "subject": { "type": "fractal", "formula": "mandelbulb", "powr": 3 }\n}\n';

    it('that are wrong are explained in a line that can be dismissed, and change nothing', async () => {
        page = await rig.open(`${kSmall}&samples=1`);
        await atRest(page);
        const before = await pixels(page);
        await page.setInputFiles('#file', { name: 'broken.json', mimeType: 'application/json', buffer: Buffer.from(broken) });
        const line = page.locator('#alert');
        await line.waitFor();
        expect(await line.innerText()).toContain("broken.json:3 (/subject/powr): unknown parameter 'powr'; did you mean 'power'?");
        await page.screenshot({ path: screenshotPath('error') });
        await line.getByRole('button', { name: 'Dismiss' }).click();
        expect(await line.isVisible()).toBe(false);
        expect(difference(before, await pixels(page))).toEqual({ mean: 0, failing: 0 });
    }, kTime);

    it('that are missing leave a picture and an error', async () => {
        page = await rig.open('scene=atlantis&width=96&height=54&samples=1');
        await atRest(page);
        expect(await page.locator('#alert').innerText()).toContain('"atlantis"');
    }, kTime);

    it('that show nothing are explained until they do, and so are choices without effect', async () => {
        page = await rig.open(`${kSmall}&samples=1`);
        await atRest(page);
        const told = page.locator('#notes');
        expect(await told.isVisible()).toBe(false);
        const camera = at(await page.evaluate(() => window.apeiron.scene()), 'camera')!;
        await page.evaluate(() => window.apeiron.set('camera.position', ['0.2', '0', '0']));
        await told.getByText('The camera is inside the surface').waitFor();
        await page.screenshot({ path: screenshotPath('inside') });
        await page.evaluate((text) => window.apeiron.set('camera', JSON.parse(text)), JSON.stringify(camera));
        await told.waitFor({ state: 'hidden' });
        await page.evaluate(() => window.apeiron.set('subject.formula', 'menger'));
        await page.evaluate(() => window.apeiron.set('subject.julia', true));
        await told.getByText('subject.julia does not change it').waitFor();
        await page.evaluate(() => window.apeiron.set('subject.julia', false));
        await told.waitFor({ state: 'hidden' });
    }, kTime);

    it('travel inside saved pictures', async () => {
        page = await rig.open(`${kSmall}&samples=1`);
        await page.evaluate(() => window.apeiron.set('subject.power', 6));
        await atRest(page);
        const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save picture' }).click()]);
        const file = readFileSync(await download.path());
        expect(download.suggestedFilename()).toBe('mandelbulb.png');
        expect(at(JSON.parse((await sceneOf(file))!), 'subject.power')).toBe(6);
        writeFileSync(screenshotPath('saved'), file);
        await page.selectOption('#scene', 'mandelbulb');
        await page.waitForFunction(() => (window.apeiron.scene()['subject'] as { power: number }).power === 8);
        await page.setInputFiles('#file', { name: 'saved.png', mimeType: 'image/png', buffer: file });
        await page.waitForFunction(() => (window.apeiron.scene()['subject'] as { power: number }).power === 6);
        expect(await page.locator('#scene option:checked').innerText()).toBe('saved.png');
    }, kTime);
});

describe('the panel', () => {
    it('edits the scene; only what decides samples restarts them', async () => {
        page = await rig.open(`${kSmall}&samples=3`);
        await page.keyboard.press('h'); // small pictures start without it
        await atRest(page);
        const scene = () => page.evaluate(() => window.apeiron.scene());
        const open = async (role: string) => {
            const section = page.locator(`[data-role="${role}"]`);
            if ((await section.getAttribute('open')) === null) await section.locator('summary').click();
        };
        await open('post');
        const exposure = page.getByRole('textbox', { name: 'Exposure' });
        await exposure.fill('1.5');
        await exposure.press('Enter');
        await page.waitForFunction(() => (window.apeiron.scene()['post'] as { exposure: number }).exposure === 1.5);
        expect(await page.evaluate(() => window.apeiron.samples())).toBe(3);
        const { data } = await pixels(page);
        // Shown without another sample, as soon as the browser composes its next frame.
        await expect.poll(async () => difference(await shown(page), { width: 320, height: 180, data }).failing, { timeout: 30_000 }).toBe(0);

        const power = page.getByRole('slider', { name: 'Power', exact: true });
        await power.focus();
        await power.press('ArrowRight');
        await page.waitForFunction(() => (window.apeiron.scene()['subject'] as { power: number }).power === 8.1);
        await atRest(page);

        await page.getByRole('group', { name: 'Add light' }).getByText('Point').click();
        await page.locator('[data-path="lights.0.intensity"]').waitFor();
        await page.waitForFunction(() => (window.apeiron.scene()['lights'] as { type: string }[]).at(-1)!.type === 'point');
        const count = (at(await scene(), 'lights') as unknown[]).length;
        await page.locator('[data-role="light"] .card').last().getByRole('button', { name: 'Remove' }).click();
        await page.waitForFunction((old) => (window.apeiron.scene()['lights'] as unknown[]).length === old - 1, count);

        await open('slot');
        const kCompile = { timeout: 60_000 };
        const slots = page.locator('[data-role="slot"]');
        const formulas = () => page.evaluate(() => (window.apeiron.scene()['subject'] as { slots: { formula: string }[] }).slots.map((slot) => slot.formula));
        await slots.getByLabel('Add slot').getByText('Mandelbox', { exact: true }).click();
        await page.locator('[data-path="subject.slots.0.repeat"]').waitFor();
        await slots.getByLabel('Add slot').getByText('Menger', { exact: true }).click();
        await slots.locator('.card').nth(1).waitFor();
        const repeat = page.locator('[data-path="subject.slots.1.repeat"]').getByRole('textbox');
        await repeat.fill('2');
        await repeat.press('Enter');
        await page.waitForFunction(() => (window.apeiron.scene()['subject'] as { slots: { repeat: number }[] }).slots[1]?.repeat === 2);
        await slots.locator('.card').nth(1).getByRole('button', { name: 'Move up' }).click();
        await expect.poll(formulas, kCompile).toEqual(['menger', 'mandelbox']);
        await atRest(page);
        await page.screenshot({ path: screenshotPath('slots') });
        await slots.locator('.card').first().getByRole('button', { name: 'Remove' }).click();
        await expect.poll(formulas, kCompile).toEqual(['mandelbox']);
        await slots.locator('.card').first().getByRole('button', { name: 'Remove' }).click();
        await expect.poll(formulas, kCompile).toEqual([]);

        await page.locator('[data-path="subject.formula"] select').selectOption('menger');
        await page.locator('[data-path="subject.rotation"]').waitFor();
        expect(await page.locator('[data-path="subject.power"]').count()).toBe(0);
        await page.locator('[data-path="subject.formula"] select').selectOption('mandelbulb');
        await page.locator('[data-path="subject.power"]').waitFor();
        expect(await page.locator('#alert').isVisible()).toBe(false);
    }, kTime);

    it('takes back a value that the engine refuses', async () => {
        page = await rig.open(`${kSmall}&samples=1`);
        await page.keyboard.press('h');
        await atRest(page);
        const field = page.getByRole('textbox', { name: 'Iterations' });
        const before = await field.inputValue();
        await field.fill('1000');
        await field.press('Enter');
        await page.locator('#alert').waitFor();
        expect(await page.locator('#alert').innerText()).toContain('subject.iterations');
        await page.waitForFunction((old) => (document.activeElement as HTMLInputElement).value === old, before);
    }, kTime);
});

describe('the page', () => {
    it('fills the window, follows its size, and has help and panel on keys', async () => {
        page = await rig.open('scene=mandelbulb&samples=4');
        await atRest(page);
        expect(await page.evaluate(() => window.apeiron.status()!.size)).toEqual({ width: 560, height: 350 }); // automatic
        await page.screenshot({ path: screenshotPath('page') });
        await page.keyboard.press('?');
        await page.locator('#help').waitFor();
        await page.screenshot({ path: screenshotPath('help') });
        await page.keyboard.press('Escape');
        await page.keyboard.press('h');
        expect(await page.locator('#panel').evaluate((panel) => (panel as HTMLElement).inert)).toBe(true);
        await page.setViewportSize({ width: 420, height: 720 });
        await page.waitForFunction(() => window.apeiron.status()!.size.height > window.apeiron.status()!.size.width);
        await atRest(page);
        await page.screenshot({ path: screenshotPath('phone') });
    }, kTime);

    it('pauses', async () => {
        page = await rig.open(`${kSmall}&samples=1000`);
        await samples(page, 2);
        await page.getByRole('button', { name: 'Pause' }).click();
        await page.waitForFunction(() => window.apeiron.status()!.state === 'paused');
        const count = await page.evaluate(() => window.apeiron.samples());
        await page.waitForTimeout(700);
        expect(await page.evaluate(() => window.apeiron.samples())).toBe(count);
        await page.locator('#view').press('Space');
        await samples(page, count + 1);
    }, kTime);
});
