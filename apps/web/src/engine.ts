// The engine (bindings.cpp, compiled to WebAssembly) as TypeScript sees it. Every method may throw an Error whose message
// is one line for people.

export type Vector = [number, number, number];

export interface StepResult {
    /** Complete samples now. */
    samples: number;
    /** show() would show something new. */
    changed: boolean;
    /** A limit of the scene's output is reached: nothing left to do. */
    finished: boolean;
}

export interface Engine {
    /** Takes over the current context; nothing else works before the first scene or volume. */
    start(): void;
    /** A size of 0 leaves the scene's own. */
    loadScene(text: string, name: string, width: number, height: number): void;
    /**
     * Shows a volume as a scene of its own, which knows it by `name`.
     * @param form JSON of a VolumeForm, or of {raw} in the words of `--raw`
     */
    openVolume(name: string, voxels: Uint8Array, form: string, width: number, height: number): void;
    /** VolumeInfo of what is shown; "null" where that is no volume. */
    volumeJson(): string;
    /** HistogramInfo of a channel, in so many classes; "null" where no volume is shown. */
    histogramJson(channel: number, values: number, gradients: number): string;
    /** What the volume holds where a pixel shows it: a Reading; "null" where it shows none. */
    valueJson(x: number, y: number): string;
    resize(width: number, height: number): void;
    /** @param all with the parameters that are at their defaults */
    sceneJson(all: boolean): string;
    /** The modules whose source travels inside the document, as "modules" of schemaJson(). */
    ownModulesJson(): string;
    /**
     * Sets one value by path; returns what that makes stale: nothing, present, samples or program.
     * @param live more such edits follow, as from a slider
     */
    set(path: string, jsonText: string, live: boolean): string;
    /** Whether tune() would make it faster: live edits have made it slower. */
    tunable(): boolean;
    /** Compiles for the present values; samples start anew. */
    tune(): void;
    reset(): void;

    step(budgetMs: number): StepResult;
    /** Shows the picture on the canvas and waits until that is done. */
    show(): void;
    samples(): number;
    progress(): number;

    /** To the right and up around the target [rad]. */
    orbit(yaw: number, pitch: number): void;
    zoom(factor: number): void;
    /** Scales the view around a point, given from the camera [world units]. */
    zoomAround(x: number, y: number, z: number, factor: number): void;
    /** Fractions of the picture's height. */
    pan(right: number, up: number): void;
    /** [world units] */
    fly(right: number, up: number, back: number): void;
    /** Turns to the left and up [rad]; the horizon stays as it is. */
    look(yaw: number, pitch: number): void;
    /** Turns towards a point, given from the camera [world units]; it becomes the target. */
    aim(x: number, y: number, z: number): void;
    toTarget(): Vector;
    /** From the camera to what is seen at a pixel [world units]; null where that is background. */
    pointAt(x: number, y: number): Vector | null;
    /** Moves the plane of focus to what is seen at a pixel; false where that is background. */
    focusAt(x: number, y: number): boolean;
    /** What someone should know about how the scene is shown: a list of sentences. */
    notesJson(): string;
    /** Why the picture shows nothing; empty when it shows something. */
    emptyReason(): string;
    /** Infinity where the subject cannot tell [world units]. */
    distanceToSurface(): number;
    distanceToTarget(): number;
    /**
     * Lets the camera fly by itself, into the subject or out of it, at `speed` distances to the surface per second; false
     * where the subject has no autopilot.
     */
    autopilot(dive: boolean, speed: number, seconds: number): boolean;
    /** How large what is around the camera is, as a power of ten; null where units never change. */
    scalePower(): number | null;

    /** sRGB with straight alpha, rows from the top. */
    pixels(): Uint8ClampedArray<ArrayBuffer>;
    statisticsJson(): string;
    device(): string;
    software(): boolean;
    maxSize(): number;
    width(): number;
    height(): number;
    /** Frees it; embind's. */
    delete(): void;
}

export interface EngineModule {
    Engine: new () => Engine;
    schemaJson(): string;
    galleryJson(): string;
    gallerySceneJson(name: string): string;
    GL: {
        registerContext(context: WebGL2RenderingContext, attributes: object): number;
        makeContextCurrent(handle: number): boolean;
    };
}

/** @param folder URL of the folder that holds apeiron.js and apeiron.wasm */
export async function loadEngine(folder: string): Promise<EngineModule> {
    const version = `?v=${__ENGINE_VERSION__}`;
    const url = new URL(`apeiron.js${version}`, folder).href;
    const { default: make } = (await import(/* @vite-ignore */ url)) as {
        default: (options: { locateFile: (file: string) => string }) => Promise<EngineModule>;
    };
    return make({ locateFile: (file) => new URL(file + version, folder).href });
}
