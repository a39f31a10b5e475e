// How fast a volume converges in Chromium: PSNR against a reference of many samples with another seed over seconds of
// waiting, and how that compares with VPT (Lesar, Bohak & Marolt 2018) on the same kind of machine.
//
//     ./run web-convergence --volume FILE [--renderers mcm mcs] [--size 512] [--grid 128] [--samples 32] [--reference 256]
//
// The scene is that of bench/convergence.cpp: boxes of voxels of the file are reduced to their means, 8-bit files stay 8-bit and
// their bytes are the opacity. Times are the wall clock's, in the page: from the edit that makes it begin anew until it says that the
// n-th sample is there; everything in between counts (steps, showing, messages), only the reading of pictures in between does
// not. Beside them stand the CPU seconds of all of the browser's processes, which other programs on the machine lengthen less.
// PSNR is that of display values (sRGB, 8 bits, dithered as on the screen: nothing of that matters below 40 dB). The reference has
// another seed; the native program makes it where it is built (--reference samples), which is faster; else the page does, in
// about --seconds. What is left of its noise takes up to 0.5 dB off where looks end at an eighth of its samples.

import { mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { parseArgs } from 'node:util';
import { openVolume } from '../apps/web/src/volumes/open';
import type { VolumeData, VolumeForm } from '../apps/web/src/volumes/volume_file';
import type { Picture } from '../apps/web/test/png';
import { hasNative, pixels, renderNatively, Rig, root } from '../apps/web/test/browser/rig';

type Page = Awaited<ReturnType<Rig['open']>>;

/** VPT's seconds until a PSNR is reached [dB, s] and its iterations a second: bonsai of 128³, 512², on two cores without a GPU. */
const kVpt: { [renderer: string]: { iterations: number; reached: [number, number][] } } = {
    mcm: { iterations: 2.6, reached: [[20.4, 15], [24.1, 34], [29.7, 138]] },
    mcs: { iterations: 1.1, reached: [[30.7, 26]] },
};

/** Nothing that the page is asked for may take longer, beside what rendering is expected to take [s]. */
const kPatience = 120;

interface Look {
    samples: number;
    seconds: number;
    cpu: number;
    psnr: number;
}

/** User and system time of everything that this process has started [s]; 0 where the system does not tell. */
function cpuOfChildren(): number {
    const parents = new Map<number, number>();
    const ticks = new Map<number, number>();
    try {
        for (const id of readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map(Number)) {
            try {
                const fields = readFileSync(`/proc/${id}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ');
                parents.set(id, Number(fields[1]));
                ticks.set(id, Number(fields[11]) + Number(fields[12]));
            } catch {
                // It has ended.
            }
        }
    } catch {
        return 0;
    }
    let sum = 0;
    for (const [id, time] of ticks) {
        let parent = parents.get(id);
        while (parent && parent !== process.pid) parent = parents.get(parent);
        if (parent === process.pid) sum += time / 100; // USER_HZ
    }
    return sum;
}

/** Fails instead of waiting for what never comes. */
async function within<T>(seconds: number, what: string, work: Promise<T>): Promise<T> {
    let timer: NodeJS.Timeout | undefined;
    const late = new Promise<never>((_, reject) => {
        timer = setTimeout(() => reject(new Error(`${what} took longer than ${seconds.toFixed(0)} s`)), 1000 * seconds);
    });
    try {
        return await Promise.race([work, late]);
    } finally {
        clearTimeout(timer);
    }
}

/** With `edge` voxels along the longest side, each the mean of the box of voxels that it stands for (as bench/convergence.cpp). */
function reduced({ form, voxels }: VolumeData, edge: number): VolumeData {
    if (form.type !== 'uint8' || form.channels !== 1 || form.times !== 1) throw new Error('the volume must be one of single bytes');
    const factor = Math.max(Math.floor(Math.max(...form.size) / edge), 1);
    const [x, y, z] = form.size;
    const size = form.size.map((side) => Math.max(Math.floor(side / factor), 1)) as VolumeForm['size'];
    const sums = new Float64Array(size[0] * size[1] * size[2]);
    for (let k = 0, i = 0; k < z; k++) {
        for (let j = 0; j < y; j++) {
            for (let h = 0; h < x; h++, i++) {
                const [a, b, c] = [Math.floor(h / factor), Math.floor(j / factor), Math.floor(k / factor)];
                if (a < size[0] && b < size[1] && c < size[2]) sums[(c * size[1] + b) * size[0] + a]! += voxels[i]!;
            }
        }
    }
    const axes = form.indexToWorld;
    const indexToWorld = axes.map((value, i) => {
        if (i < 9) return factor * value;
        return value + 0.5 * (factor - 1) * (axes[i - 9]! + axes[i - 6]! + axes[i - 3]!);
    });
    return { form: { ...form, size, indexToWorld }, voxels: Uint8Array.from(sums, (sum) => Math.round(sum / factor ** 3)) };
}

/** A file of it, as the page opens. */
function nrrd({ form, voxels }: VolumeData): Uint8Array {
    const axis = (i: number) => `(${form.indexToWorld.slice(3 * i, 3 * i + 3).join(',')})`;
    const header = `NRRD0004\ntype: uchar\ndimension: 3\nsizes: ${form.size.join(' ')}\nencoding: raw\nspace: LPS\n` +
        `space directions: ${[0, 1, 2].map(axis).join(' ')}\nspace origin: ${axis(3)}\n\n`;
    return Buffer.concat([Buffer.from(header), voxels]);
}

/** The volume around the origin, and the sphere around its whole box as high as the picture (as bench/convergence.cpp). */
function centred({ form, voxels }: VolumeData): VolumeData {
    const axes = form.indexToWorld.slice(0, 9);
    const origin = [0, 1, 2].map((k) => -[0, 1, 2].reduce((sum, i) => sum + axes[3 * i + k]! * (0.5 * form.size[i]! - 0.5), 0));
    return { form: { ...form, indexToWorld: [...axes, ...origin] }, voxels };
}

function cameraFor({ size, indexToWorld }: VolumeForm): object {
    const longest = Math.max(...[0, 1, 2].map((i) => size[i]! * Math.hypot(...indexToWorld.slice(3 * i, 3 * i + 3))));
    const front = [0.38, -1, 0.22];
    const position = front.map((part) => String((2.53 * longest * part) / Math.hypot(...front)));
    return { position, target: ['0', '0', '0'], fov: 40 };
}

const sceneOf = (source: string, renderer: string, seed: number, form: VolumeForm): string =>
    JSON.stringify({
        apeiron: 1,
        camera: cameraFor(form),
        subject: {
            type: 'volume',
            source,
            density: 100,
            transfer: {
                window: { level: 127.5, width: 255 },
                points: [
                    { value: 0, color: '#e0b080', opacity: 0 },
                    { value: 1, color: '#e0b080', opacity: 1 },
                ],
            },
        },
        renderer: renderer === 'mcm' ? { type: 'mcm', bounces: 8 } : { type: renderer },
        lights: [],
        environment: { type: 'constant', color: [1, 1, 1] },
        post: { tonemapper: 'linear' },
        output: { seed },
    });

/** Of display values; alpha does not count [dB]. */
function psnr(a: Picture, b: Picture): number {
    let squares = 0;
    for (let i = 0; i < a.data.length; i++) {
        if (i % 4 !== 3) squares += ((a.data[i]! - b.data[i]!) / 255) ** 2;
    }
    return -10 * Math.log10(squares / (0.75 * a.data.length));
}

/** Sets something and waits until the page has finished its samples. @returns how long that took [s], and its CPU time [s] */
async function finishedAfter(page: Page, path: string, value: number, samples: number, limit: number): Promise<{ seconds: number; cpu: number }> {
    const before = cpuOfChildren();
    const work = page.evaluate(
        async ({ path, value, samples, limit }) => {
            const { apeiron } = window;
            const start = performance.now();
            await apeiron.set(path, value);
            for (;;) {
                const status = apeiron.status();
                const seconds = (performance.now() - start) / 1000;
                if (status?.state === 'finished' && status.samples === samples) return seconds;
                if (seconds > limit) throw new Error(`still ${JSON.stringify(status)} after ${seconds.toFixed(0)} s`);
                await new Promise((resolve) => setTimeout(resolve, 2));
            }
        },
        { path, value, samples, limit },
    );
    const seconds = await within(limit + kPatience, `${path} = ${value}`, work);
    return { seconds, cpu: cpuOfChildren() - before };
}

/** When a PSNR is reached, between looks along the logarithm of time [s]; null: not within them. */
function reached(looks: readonly Look[], wanted: number): number | null {
    const i = looks.findIndex(({ psnr }) => psnr >= wanted);
    const [a, b] = [looks[i - 1], looks[i]];
    if (!b) return null;
    if (!a) return b.seconds;
    return a.seconds * (b.seconds / a.seconds) ** ((wanted - a.psnr) / (b.psnr - a.psnr));
}

async function run(): Promise<void> {
    const { values, positionals } = parseArgs({
        allowPositionals: true, // more renderers
        options: {
            volume: { type: 'string' },
            renderers: { type: 'string', default: 'mcm' },
            size: { type: 'string', default: '512' },
            grid: { type: 'string', default: '128' },
            samples: { type: 'string', default: '32' },
            reference: { type: 'string', default: '256' },
            seconds: { type: 'string', default: '150' },
        },
    });
    if (!values.volume) throw new Error('name a volume: --volume FILE');
    const [size, grid, most, seconds] = [values.size, values.grid, values.samples, values.seconds].map(Number) as [number, number, number, number];
    const file = { name: basename(values.volume), bytes: new Uint8Array(readFileSync(values.volume)) };
    const opened = await openVolume([file], async () => null);
    if (!opened || 'raw' in opened.form) throw new Error(`${file.name} does not tell what it is`);
    const volume = centred(reduced({ form: opened.form, voxels: opened.voxels }, grid));
    const path = join(root, 'out/web', `reduced_${volume.form.size.join('x')}.nrrd`);
    mkdirSync(join(root, 'out/web'), { recursive: true });
    writeFileSync(path, nrrd(volume));

    const rig = await Rig.start();
    try {
        const page = await within(kPatience, 'opening the page', rig.open(`scene=mandelbulb&width=${size}&height=${size}&samples=1`));
        const agent = await page.evaluate(() => navigator.userAgent);
        console.log(`${file.name} of ${volume.form.size.join(' x ')} voxels at ${size} x ${size}; ${/Chrom\S+/.exec(agent)?.[0]}, ${await page.locator('.device dd').getAttribute('data-tip')}`);
        await page.locator('#file').setInputFiles(path);
        const name = basename(path);
        await page.waitForFunction((wanted) => (window.apeiron.scene()['subject'] as { source?: string }).source === wanted, name, { timeout: 1000 * kPatience });
        for (const renderer of [values.renderers, ...positionals]) {
            await within(kPatience, 'opening the scene', page.evaluate((text) => window.apeiron.load(text), sceneOf(name, renderer, 0, volume.form)));
            // The first sample compiles: it does not count, and says how long others may take.
            const first = await finishedAfter(page, 'output.seed', 2, 1, kPatience);
            const second = await finishedAfter(page, 'output.seed', 1, 1, kPatience);
            console.log(`\n${renderer}: first sample after ${first.seconds.toFixed(2)} s, anew after ${second.seconds.toFixed(2)} s`);
            // From now on nothing is compiled, and whatever a sample costs is in the time.
            const looks: (Look & { picture: Picture })[] = [];
            const spent = await finishedAfter(page, 'output.seed', 3, 1, kPatience);
            for (let n = 1; n <= most; n *= 2) {
                if (n > 1) {
                    const more = await finishedAfter(page, 'output.samples', n, n, kPatience + 4 * second.seconds * n);
                    spent.seconds += more.seconds;
                    spent.cpu += more.cpu;
                }
                looks.push({ samples: n, ...spent, psnr: 0, picture: await within(kPatience, 'reading', pixels(page)) });
            }
            const last = looks.at(-1)!;
            await within(kPatience, 'a screenshot', page.screenshot({ path: join(root, 'out/web', `convergence_${renderer}.png`) }));
            let reference: Picture;
            let count = Number(values.reference);
            if (hasNative) {
                const scene = join(root, 'out/web', `convergence_${renderer}.json`);
                writeFileSync(scene, sceneOf(path, renderer, 4, volume.form));
                reference = await renderNatively(scene, `${size}x${size}`, count);
            } else {
                count = Math.max(Math.round((seconds / last.seconds) * last.samples), 1);
                await within(kPatience, 'output.samples', page.evaluate((samples) => window.apeiron.set('output.samples', samples), count));
                await finishedAfter(page, 'output.seed', 4, count, kPatience + 4 * seconds);
                reference = await within(kPatience, 'reading', pixels(page));
            }
            for (const look of looks) look.psnr = psnr(look.picture, reference);
            const vpt = kVpt[renderer];
            const rate = last.samples / last.seconds;
            console.log(`${rate.toFixed(2)} samples/s${vpt ? ` (VPT: ${vpt.iterations} iterations/s)` : ''}; reference of ${count} samples ${hasNative ? 'by the native program' : ''}\n`);
            console.log('| samples | seconds | CPU seconds | PSNR [dB] |\n|---|---|---|---|');
            for (const look of looks) console.log(`| ${look.samples} | ${look.seconds.toFixed(2)} | ${look.cpu.toFixed(1)} | ${look.psnr.toFixed(2)} |`);
            if (vpt && vpt.reached.length > 0) console.log('\n| PSNR [dB] | here [s] | VPT [s] | ratio |\n|---|---|---|---|');
            for (const [wanted, theirs] of vpt?.reached ?? []) {
                const ours = reached(looks, wanted);
                console.log(`| ${wanted} | ${ours === null ? `more than ${last.seconds.toFixed(1)}` : ours.toFixed(2)} | ${theirs} | ${ours === null ? '' : (theirs / ours).toFixed(1)} |`);
            }
        }
        if (rig.complaints.length > 0) throw new Error(`the page complained: ${rig.complaints.join('; ')}`);
    } finally {
        await within(kPatience, 'closing the browser', rig.stop());
    }
}

run().then(
    () => process.exit(0),
    (error: unknown) => {
        console.error(`web_convergence: ${error instanceof Error ? error.message : String(error)}`);
        process.exit(1);
    },
);
