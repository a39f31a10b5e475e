// The worker: owns the canvas, its WebGL context and the engine.
import { loadEngine, type Engine, type EngineModule } from './engine';
import { Loop } from './loop';
import { messageOf, type Answer, type Ask, type FromWorker, type GalleryEntry, type RequestName, type Requests, type ToWorker } from './protocol';
import { isObject, type SceneDocument, type Schema } from './schema';
import { openVolume, rawFormOf } from './volumes/open';

const scope = self as unknown as {
    postMessage(message: FromWorker, transfer?: Transferable[]): void;
    onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
    requestAnimationFrame?: (callback: () => void) => number;
};

const kFrameMs = 16;
/** A resized canvas stays empty for no longer than this [ms]. */
const kResizeBudget = 120;

function post(message: FromWorker, transfer: Transferable[] = []): void {
    scope.postMessage(message, transfer);
}

/** Tasks that let messages pass in between; timers would wait 4 ms. */
const channel = new MessageChannel();
let soonCallbacks: (() => void)[] = [];
channel.port1.onmessage = () => {
    const callbacks = soonCallbacks;
    soonCallbacks = [];
    for (const callback of callbacks) callback();
};

class Viewer {
    private module!: EngineModule;
    private canvas!: OffscreenCanvas;
    private engine!: Engine;
    private loop!: Loop;
    private document: SceneDocument = {};
    private samples: number | null = null;
    private loaded = false;
    private paused = false;
    private lost = false;

    async start(ask: Ask<'start'>): Promise<Answer<'start'>> {
        this.canvas = ask.canvas;
        this.samples = ask.samples;
        this.module = await loadEngine(ask.engine);
        this.canvas.width = ask.size.width;
        this.canvas.height = ask.size.height;
        this.canvas.addEventListener('webglcontextlost', (event) => this.onLost(event));
        this.canvas.addEventListener('webglcontextrestored', () => this.onRestored());
        this.makeEngine();
        const gallery = JSON.parse(this.module.galleryJson()) as GalleryEntry[];
        const first = gallery.find((entry) => entry.name === 'mandelbulb') ?? gallery[0];
        const wanted = ask.scene || first?.name || '';
        let scene = '';
        // A wrong name still leaves a picture to look at.
        for (const name of new Set([wanted, first?.name ?? ''])) {
            if (!name) continue;
            try {
                this.load(this.module.gallerySceneJson(name), `scenes/${name}.json`);
                scene = name;
                break;
            } catch (error) {
                post({ type: 'error', message: messageOf(error) });
            }
        }
        if (!scene) this.load('{"apeiron": 1}', 'the default scene');
        return {
            schema: JSON.parse(this.module.schemaJson()) as Schema,
            gallery,
            scene,
            device: this.engine.device(),
            software: this.engine.software(),
            maxSize: this.engine.maxSize(),
        };
    }

    load(text: string, name: string): null {
        this.requireContext();
        this.engine.loadScene(text, name, this.canvas.width, this.canvas.height);
        this.afterLoad();
        return null;
    }

    gallery(name: string): null {
        return this.load(this.module.gallerySceneJson(name), `scenes/${name}.json`);
    }

    async openVolume({ files, raw }: Ask<'openVolume'>): Promise<Answer<'openVolume'>> {
        let question: Answer<'openVolume'> = null;
        const opened = await openVolume(files, async (name, bytes) => {
            if (raw === null) question = { name, bytes, guess: rawFormOf(name) ?? '' };
            return raw;
        });
        if (!opened) return question;
        this.requireContext();
        this.engine.openVolume(opened.name, opened.voxels, JSON.stringify(opened.form), this.canvas.width, this.canvas.height);
        this.afterLoad();
        return null;
    }

    volume(): Answer<'volume'> {
        return JSON.parse(this.engine.volumeJson()) as Answer<'volume'>;
    }

    histogram({ channel, values, gradients }: Ask<'histogram'>): Answer<'histogram'> {
        return JSON.parse(this.engine.histogramJson(channel, values, gradients)) as Answer<'histogram'>;
    }

    value({ x, y }: Ask<'value'>): Answer<'value'> {
        this.requireContext();
        const pixel = (part: number, size: number) => Math.min(Math.max(Math.floor(part * size), 0), size - 1);
        return JSON.parse(this.engine.valueJson(pixel(x, this.canvas.width), pixel(y, this.canvas.height))) as Answer<'value'>;
    }

    set({ path, value, live }: Ask<'set'>): Promise<null> {
        this.requireContext();
        return this.loop.edit(path, value, live);
    }

    resize({ width, height }: Ask<'resize'>): null {
        if (width === this.canvas.width && height === this.canvas.height) return null;
        this.requireContext();
        this.canvas.width = width;
        this.canvas.height = height;
        this.engine.resize(width, height);
        this.loop.showNow(kResizeBudget);
        this.sendDocument();
        return null;
    }

    sharpen({ x, y }: Ask<'sharpen'>): boolean {
        this.requireContext();
        return this.loop.sharpen(x, y);
    }

    focus({ x, y }: Ask<'focus'>): boolean {
        this.requireContext();
        return this.loop.focus(x, y);
    }

    pixels(): Answer<'pixels'> {
        this.requireContext();
        const data = this.engine.pixels();
        return { width: this.engine.width(), height: this.engine.height(), data, samples: this.engine.samples() };
    }

    png(): Promise<Blob> {
        const { width, height, data } = this.pixels();
        const canvas = new OffscreenCanvas(width, height);
        canvas.getContext('2d')!.putImageData(new ImageData(data, width, height), 0, 0);
        return canvas.convertToBlob({ type: 'image/png' });
    }

    sceneText(): string {
        return this.engine.sceneJson(false);
    }

    statistics(): Answer<'statistics'> {
        return JSON.parse(this.engine.statisticsJson()) as Answer<'statistics'>;
    }

    loseContext({ restoreAfterMs }: Ask<'loseContext'>): null {
        const extension = (this.canvas.getContext('webgl2') as WebGL2RenderingContext).getExtension('WEBGL_lose_context');
        if (!extension) throw new Error('this browser cannot lose a context on purpose');
        extension.loseContext();
        setTimeout(() => extension.restoreContext(), restoreAfterMs);
        return null;
    }

    motion(message: Extract<ToWorker, { type: 'motion' }>): void {
        if (!this.lost) this.loop.motion(message.motion);
    }

    pause(paused: boolean): void {
        this.paused = paused;
        if (!this.lost) this.loop.pause(paused);
    }

    private makeEngine(): void {
        const gl = this.canvas.getContext('webgl2', {
            alpha: false,
            antialias: false,
            depth: false,
            stencil: false,
            powerPreference: 'high-performance',
        }) as WebGL2RenderingContext | null;
        if (!gl) throw new Error('this browser offers no WebGL 2: switch on hardware acceleration or try another browser');
        gl.getExtension('WEBGL_debug_renderer_info'); // the device's name, where the browser tells
        const attributes = { majorVersion: 2, minorVersion: 0, enableExtensionsByDefault: true };
        this.module.GL.makeContextCurrent(this.module.GL.registerContext(gl, attributes));
        this.engine = new this.module.Engine();
        this.engine.start();
        this.loop = new Loop(
            this.engine,
            {
                now: () => performance.now(),
                frame: (callback) => {
                    if (scope.requestAnimationFrame) scope.requestAnimationFrame(callback);
                    else setTimeout(callback, kFrameMs);
                },
                soon: (callback) => {
                    soonCallbacks.push(callback);
                    channel.port2.postMessage(null);
                },
                status: (status) => post({ type: 'status', status }),
                documentChanged: () => this.sendDocument(),
                failed: (error) => {
                    // A lost context is told by its event.
                    if (!this.isLost()) post({ type: 'error', message: messageOf(error) });
                },
            },
            () => this.limit(),
        );
    }

    private afterLoad(): void {
        if (this.samples !== null) this.engine.set('output.samples', String(this.samples), false);
        this.restarted();
        this.loaded = true;
        this.sendDocument();
    }

    /** The loop of a new engine does not know of a pause yet. */
    private restarted(): void {
        if (this.paused) this.loop.pause(true);
        this.loop.restarted();
    }

    private limit(): number {
        const { output } = this.document;
        return isObject(output) && typeof output['samples'] === 'number' ? output['samples'] : 0;
    }

    private sendDocument(): void {
        this.document = JSON.parse(this.engine.sceneJson(true)) as SceneDocument;
        const modules = JSON.parse(this.engine.ownModulesJson()) as Schema['modules'];
        const notes = JSON.parse(this.engine.notesJson()) as string[];
        post({ type: 'scene', document: this.document, modules, notes, loaded: this.loaded });
        this.loaded = false;
    }

    private isLost(): boolean {
        return this.lost || (this.canvas.getContext('webgl2') as WebGL2RenderingContext).isContextLost();
    }

    private requireContext(): void {
        if (this.lost) throw new Error('the graphics context is lost; wait until the browser gives it back');
    }

    private onLost(event: Event): void {
        event.preventDefault(); // asks for it to be restored
        this.lost = true;
        this.loop.stop();
        post({ type: 'context', state: 'lost' });
    }

    private onRestored(): void {
        try {
            const text = this.engine.sceneJson(false);
            this.engine.delete();
            this.lost = false;
            this.makeEngine();
            this.engine.loadScene(text, 'the scene', this.canvas.width, this.canvas.height);
            this.restarted();
            this.sendDocument();
            post({ type: 'context', state: 'restored' });
        } catch (error) {
            post({ type: 'error', message: messageOf(error) });
        }
    }
}

const viewer = new Viewer();

const handlers: { [N in RequestName]: (ask: Ask<N>) => Answer<N> | Promise<Answer<N>> } = {
    start: (ask) => viewer.start(ask),
    load: ({ text, name }) => viewer.load(text, name),
    gallery: ({ name }) => viewer.gallery(name),
    openVolume: (ask) => viewer.openVolume(ask),
    volume: () => viewer.volume(),
    histogram: (ask) => viewer.histogram(ask),
    value: (ask) => viewer.value(ask),
    set: (ask) => viewer.set(ask),
    resize: (ask) => viewer.resize(ask),
    focus: (ask) => viewer.focus(ask),
    sharpen: (ask) => viewer.sharpen(ask),
    pixels: () => viewer.pixels(),
    png: () => viewer.png(),
    sceneText: () => viewer.sceneText(),
    statistics: () => viewer.statistics(),
    loseContext: (ask) => viewer.loseContext(ask),
};

async function answer(id: number, name: RequestName, ask: Requests[RequestName]['ask']): Promise<void> {
    try {
        const handler = handlers[name] as (ask: unknown) => Answer<RequestName> | Promise<Answer<RequestName>>;
        const result = await handler(ask);
        post({ type: 'answer', id, answer: result });
    } catch (error) {
        post({ type: 'refused', id, message: messageOf(error) });
    }
}

scope.onmessage = ({ data: message }) => {
    switch (message.type) {
        case 'request':
            void answer(message.id, message.name, message.ask);
            break;
        case 'motion':
            viewer.motion(message);
            break;
        case 'pause':
            viewer.pause(message.paused);
            break;
    }
};
