// Every scene of the gallery in Chromium, against the native program's picture of it.
import { readdirSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { atRest, difference, hasNative, native, pixels, renderNatively, Rig, root } from './rig';

const kTime = 120_000;
const kSize = { width: 96, height: 54 };
const kSamples = 2;
const scenes = readdirSync(`${root}/scenes`).map((file) => file.replace(/\.json$/, ''));

let rig: Rig;
let page: Page;

beforeAll(async () => {
    rig = await Rig.start();
    page = await rig.open(`width=${kSize.width}&height=${kSize.height}&samples=${kSamples}`);
}, kTime);
afterAll(() => rig?.stop());

describe(`the gallery${hasNative ? '' : ` (not compared: ${native} is not built)`}`, () => {
    it('has the scenes of scenes/', async () => {
        const names = await page.locator('#scene option').evaluateAll((options) => options.map((option) => (option as HTMLOptionElement).value));
        expect(names.sort()).toEqual(scenes.sort());
    });

    it.each(scenes)('shows %s as the native program does', async (name) => {
        const start = performance.now();
        await page.selectOption('#scene', name);
        await page.waitForURL((url) => url.searchParams.get('scene') === name);
        await atRest(page);
        const web = await pixels(page);
        const seconds = (performance.now() - start) / 1000;
        expect(web).toMatchObject({ ...kSize, samples: kSamples });
        expect(await page.locator('.messages').innerText()).toBe(''); // no error, nothing to explain
        expect(rig.complaints.splice(0)).toEqual([]);
        if (!hasNative) return;
        const { mean, failing } = difference(web, renderNatively(name, `${kSize.width}x${kSize.height}`, kSamples));
        console.log(`${name}: mean difference ${mean.toFixed(3)}/255, ${(100 * failing).toFixed(2)} % of pixels off by more than 24/255; ${seconds.toFixed(1)} s`);
        expect(mean).toBeLessThan(0.5);
        expect(failing).toBeLessThan(0.01);
    }, kTime);
});
