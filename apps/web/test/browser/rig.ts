// A browser that looks at the built page.
import { execFile } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { chromium, type BrowserContext, type Page } from 'playwright-core';
import type { ApeironPage } from '../../src/main';
import { decodePng, type Picture } from '../png';

declare global {
    // In the page.
    interface Window {
        apeiron: ApeironPage;
    }
}

export const root = fileURLToPath(new URL('../../../..', import.meta.url));
const dist = join(root, 'apps/web/dist');
/** Nothing that a test waits for takes longer [ms]: machines that do other work as well take three times as long and more. */
const kPatience = 100_000;
/** The page must work from any folder of a server. */
const kFolder = '/some/folder/';

export const native = process.env['APEIRON'] ?? join(root, `build/${process.env['APEIRON_PRESET'] ?? 'release'}/apps/cli/apeiron`);
export const hasNative = existsSync(native);

const kTypes: { [extension: string]: string } = {
    '.html': 'text/html',
    '.js': 'text/javascript',
    '.css': 'text/css',
    '.svg': 'image/svg+xml',
    '.wasm': 'application/wasm',
};

function serve(): Promise<Server> {
    if (!existsSync(join(dist, 'index.html')) || !existsSync(join(dist, 'engine/apeiron.wasm'))) {
        throw new Error('the page is not built: run `cmake --build --preset web` and `npm run build` first');
    }
    const server = createServer((request, response) => {
        const path = decodeURIComponent(new URL(request.url ?? '/', 'http://x').pathname);
        const file = path.startsWith(kFolder) ? join(dist, normalize(path.slice(kFolder.length) || 'index.html')) : '';
        if (!file.startsWith(dist) || !existsSync(file) || !statSync(file).isFile()) {
            response.writeHead(404).end();
            return;
        }
        // As strict as servers get: nothing from elsewhere, no eval.
        const policy = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; img-src 'self' data:";
        response.writeHead(200, { 'Content-Type': kTypes[extname(file)] ?? 'application/octet-stream', 'Content-Security-Policy': policy });
        response.end(readFileSync(file));
    });
    return new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(server)));
}

export class Rig {
    /** What the page complained about, and what it asked other servers for: both must stay empty. */
    readonly complaints: string[] = [];

    private constructor(
        private readonly server: Server,
        private readonly context: BrowserContext,
        private readonly profile: string,
        private readonly origin: string,
    ) {}

    static async start(): Promise<Rig> {
        const server = await serve();
        const profile = mkdtempSync(join(tmpdir(), 'apeiron-chromium-'));
        const context = await chromium.launchPersistentContext(profile, {
            executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium',
            headless: true,
            viewport: { width: 1280, height: 800 },
            acceptDownloads: true,
            args: [
                '--headless',
                '--no-sandbox',
                '--disable-quic',
                '--no-first-run',
                '--disable-background-networking',
                '--disable-component-update',
                '--disable-sync',
            ],
        });
        context.setDefaultTimeout(kPatience);
        return new Rig(server, context, profile, `http://127.0.0.1:${(server.address() as AddressInfo).port}`);
    }

    /** An empty page. */
    async blank(): Promise<Page> {
        return this.context.newPage();
    }

    /** Opens the page and waits for its engine. */
    async open(query: string): Promise<Page> {
        const page = await this.context.newPage();
        page.on('console', (message) => {
            if (message.type() === 'error' || message.type() === 'warning') this.complaints.push(message.text());
        });
        page.on('pageerror', (error) => this.complaints.push(error.message));
        page.on('request', (request) => {
            const url = request.url();
            if (!url.startsWith(this.origin) && !/^(blob|data):/.test(url)) this.complaints.push(`asked for ${url}`);
        });
        await page.goto(`${this.origin}${kFolder}?${query}`);
        await page.evaluate(() => window.apeiron.ready);
        return page;
    }

    async stop(): Promise<void> {
        await this.context.close();
        this.server.close();
        rmSync(this.profile, { recursive: true, force: true });
    }
}

export async function samples(page: Page, count: number): Promise<void> {
    await page.waitForFunction((wanted) => window.apeiron.samples() >= wanted, count);
}

export async function atRest(page: Page): Promise<void> {
    await page.waitForFunction(() => window.apeiron.status()?.state === 'finished' && !window.apeiron.status()!.moving);
}

export async function pixels(page: Page): Promise<Picture & { samples: number }> {
    const result = await page.evaluate(async () => {
        const { width, height, data, samples: count } = await window.apeiron.pixels();
        let text = '';
        for (const byte of data) text += String.fromCharCode(byte);
        return { width, height, samples: count, base64: btoa(text) };
    });
    return { ...result, data: new Uint8Array(Buffer.from(result.base64, 'base64')) };
}

/** What the screen shows of the canvas. */
export async function shown(page: Page): Promise<Picture> {
    return decodePng(await page.locator('#view').screenshot());
}

/** Every picture that the page shows of the canvas while something is done. `next` waits for another one than the last. */
export async function framesDuring(page: Page, work: (next: () => Promise<void>) => Promise<void>): Promise<Picture[]> {
    const recording = await page.evaluateHandle(() => {
        const view = document.querySelector<HTMLCanvasElement>('#view')!;
        const { width, height } = view.getBoundingClientRect();
        const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })!;
        const frames: Uint8ClampedArray[] = [];
        const recorder = { on: true, width, height, frames };
        const record = () => {
            context.drawImage(view, 0, 0, width, height);
            const { data } = context.getImageData(0, 0, width, height);
            const last = frames.at(-1);
            if (!last || data.some((value, i) => value !== last[i])) frames.push(data);
            if (recorder.on) requestAnimationFrame(record);
        };
        record();
        return recorder;
    });
    let known = 1;
    await work(async () => {
        known = await recording.evaluate(
            ({ frames }, before) =>
                new Promise<number>((resolve) => {
                    const look = () => (frames.length > before ? resolve(frames.length) : requestAnimationFrame(look));
                    look();
                }),
            known,
        );
    });
    const { width, height, frames } = await recording.evaluate((recorder) => {
        recorder.on = false;
        const text = (bytes: Uint8ClampedArray) => btoa(bytes.reduce((all, byte) => all + String.fromCharCode(byte), ''));
        return { width: recorder.width, height: recorder.height, frames: recorder.frames.map(text) };
    });
    return frames.map((base64) => ({ width, height, data: new Uint8Array(Buffer.from(base64, 'base64')) }));
}

/** Part of the pixels that are like their left neighbour: 7 of 8 and more where a picture is made of 8 x 8 blocks. */
export function flatness({ width, height, data }: Picture): number {
    let flat = 0;
    for (let i = 4; i < data.length; i += 4) {
        if ((i / 4) % width === 0) continue;
        if ([0, 1, 2].every((c) => Math.abs(data[i + c]! - data[i + c - 4]!) <= 1)) flat++;
    }
    return flat / ((width - 1) * height);
}

/** The picture as it would be with one value for each block of `side` pixels squared. */
export function inBlocks({ width, height, data }: Picture, side: number): Picture {
    const blocks = data.slice();
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
            const from = 4 * ((y - (y % side)) * width + x - (x % side));
            for (let c = 0; c < 4; c++) blocks[4 * (y * width + x) + c] = data[from + c]!;
        }
    }
    return { width, height, data: blocks };
}

/** Mean of all channels [1/255]. */
export function brightness({ data }: Picture): number {
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum += data[i]! + data[i + 1]! + data[i + 2]!;
    return sum / (0.75 * data.length);
}

export function screenshotPath(name: string): string {
    const folder = join(root, 'out/web');
    mkdirSync(folder, { recursive: true });
    return join(folder, `${name}.png`);
}

/** The same scene by the native program. It compiles on one processor, as browsers do: both at once take little longer than one. */
export async function renderNatively(scene: string, size: string, count: number): Promise<Picture> {
    const folder = mkdtempSync(join(tmpdir(), 'apeiron-native-'));
    try {
        const file = join(folder, 'picture.png');
        await promisify(execFile)(native, ['render', scene, '--size', size, '--samples', String(count), '-o', file]);
        return decodePng(readFileSync(file));
    } finally {
        rmSync(folder, { recursive: true });
    }
}

export interface Difference {
    /** Mean absolute difference of all channels [1/255]. */
    mean: number;
    /** Part of the pixels with a channel that differs by more than 24/255. */
    failing: number;
}

export function difference(a: Picture, b: Picture): Difference {
    if (a.width !== b.width || a.height !== b.height) throw new Error(`${a.width}x${a.height} and ${b.width}x${b.height} differ in size`);
    let [sum, failing] = [0, 0];
    for (let i = 0; i < a.data.length; i += 4) {
        let worst = 0;
        for (let c = 0; c < 3; c++) {
            const distance = Math.abs(a.data[i + c]! - b.data[i + c]!);
            sum += distance;
            worst = Math.max(worst, distance);
        }
        if (worst > 24) failing++;
    }
    const count = a.data.length / 4;
    return { mean: sum / (3 * count), failing: failing / count };
}
