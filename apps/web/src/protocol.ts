// What the page and its worker say to each other.
import type { Json, SceneDocument, Schema } from './schema';
import type { HistogramInfo, VolumeInfo } from './transfer/transfer';
import type { NamedBytes } from './volumes/volume_file';

export interface Size {
    width: number;
    height: number;
}

export interface GalleryEntry {
    name: string;
    title: string;
}

export interface SceneText {
    text: string;
    /** For messages. */
    name: string;
}

/** Bare voxels of which nobody has said what they are. */
export interface RawQuestion {
    name: string;
    bytes: number;
    /** What the name says; empty: nothing. */
    guess: string;
}

/** What a volume holds at a place. */
export interface Reading {
    /** [mm] */
    position: [number, number, number];
    voxel: [number, number, number];
    unit: string;
    values: { name: string; value: number | null }[];
}

/** What the page asks for; the worker answers each with a Reply. */
export interface Requests {
    start: {
        ask: {
            canvas: OffscreenCanvas;
            /** URL of the engine's folder. */
            engine: string;
            size: Size;
            /** A gallery scene's name; empty: the first of the gallery. */
            scene: string;
            /** Overrides the scene's number of samples. */
            samples: number | null;
        };
        answer: Started;
    };
    load: { ask: SceneText; answer: null };
    gallery: { ask: { name: string }; answer: null };
    /** Opens a volume: a file, or a header and its voxels. `raw`: what bare voxels are, once it was asked for. */
    openVolume: { ask: { files: NamedBytes[]; raw: string | null }; answer: RawQuestion | null };
    /** The volume that is shown. */
    volume: { ask: Record<string, never>; answer: VolumeInfo | null };
    histogram: { ask: { channel: number; values: number; gradients: number }; answer: HistogramInfo | null };
    /** What a volume holds at a point of the picture (fractions from the top left); null: it shows none there. */
    value: { ask: { x: number; y: number }; answer: Reading | null };
    /** `live`: while a slider is dragged; only the last of several such edits of a path counts. */
    set: { ask: { path: string; value: Json; live: boolean }; answer: null };
    resize: { ask: Size; answer: null };
    /** Makes what is seen at a point of the picture (fractions from the top left) the target; whether there is any. */
    focus: { ask: { x: number; y: number }; answer: boolean };
    /** Moves the plane of focus there; whether there is anything. */
    sharpen: { ask: { x: number; y: number }; answer: boolean };
    pixels: { ask: Record<string, never>; answer: Size & { data: Uint8ClampedArray<ArrayBuffer>; samples: number } };
    png: { ask: Record<string, never>; answer: Blob };
    sceneText: { ask: Record<string, never>; answer: string };
    statistics: { ask: Record<string, never>; answer: Json };
    /** For tests: what a driver's crash does, and how it ends. */
    loseContext: { ask: { restoreAfterMs: number }; answer: null };
}

export type RequestName = keyof Requests;
export type Ask<N extends RequestName> = Requests[N]['ask'];
export type Answer<N extends RequestName> = Requests[N]['answer'];

/** Camera moves, which need no answer and add up until the next frame. */
export type Motion =
    /** [rad] */
    | { kind: 'orbit'; yaw: number; pitch: number }
    /** Fractions of the picture's height. */
    | { kind: 'pan'; right: number; up: number }
    /** Around a point of the picture, in fractions from the top left; without one around the target. */
    | { kind: 'zoom'; factor: number; at: { x: number; y: number } | null }
    /** [rad] */
    | { kind: 'look'; yaw: number; pitch: number }
    /** Steady flight: each from -1 to 1, `speed` in distances to the surface per second. All 0 ends it. */
    | { kind: 'fly'; right: number; up: number; ahead: number; speed: number }
    /** By itself, until any other move; `way` null ends it. */
    | { kind: 'autopilot'; way: Autopilot | null; speed: number };

export type Autopilot = 'dive' | 'rise';

export type ToWorker =
    | { [N in RequestName]: { type: 'request'; id: number; name: N; ask: Ask<N> } }[RequestName]
    | { type: 'motion'; motion: Motion }
    | { type: 'pause'; paused: boolean };

export interface Started {
    schema: Schema;
    gallery: GalleryEntry[];
    scene: string;
    device: string;
    software: boolean;
    maxSize: number;
}

export type RunState = 'rendering' | 'finished' | 'paused' | 'lost';

export interface Status {
    state: RunState;
    samples: number;
    /** Where it will stop. */
    limit: number;
    /** Part of the sample in progress, 0..1. */
    progress: number;
    moving: boolean;
    /** Pictures shown per second, while moving. */
    fps: number;
    /** The last step, with showing it [ms]. */
    stepMs: number;
    /** [ms]; 0: not known yet */
    sampleMs: number;
    size: Size;
    /** To the nearest surface [world units]; null: not known. */
    distance: number | null;
    /** Of what is around the camera, as a power of ten; null: its units never change, and there is no autopilot. */
    scale: number | null;
    autopilot: Autopilot | null;
    /** Why the picture shows nothing, in a line; empty: it shows something, or is not known yet. */
    emptyReason: string;
}

export type FromWorker =
    | { type: 'answer'; id: number; answer: Answer<RequestName> }
    | { type: 'refused'; id: number; message: string }
    | { type: 'status'; status: Status }
    /**
     * The document has changed. `modules`: those whose source it holds; `notes`: what someone should know about how it is
     * shown; `loaded`: it is another one.
     */
    | { type: 'scene'; document: SceneDocument; modules: Schema['modules']; notes: string[]; loaded: boolean }
    | { type: 'error'; message: string }
    | { type: 'context'; state: 'lost' | 'restored' };

export function messageOf(error: unknown): string {
    return error instanceof Error ? error.message : String(error);
}

/** Matches answers to requests. */
export class Requester {
    private nextId = 1;
    private readonly waiting = new Map<number, { resolve: (answer: never) => void; reject: (error: Error) => void }>();

    constructor(private readonly post: (message: ToWorker, transfer: Transferable[]) => void) {}

    request<N extends RequestName>(name: N, ask: Ask<N>, transfer: Transferable[] = []): Promise<Answer<N>> {
        return new Promise((resolve, reject) => {
            const id = this.nextId++;
            this.waiting.set(id, { resolve, reject });
            this.post({ type: 'request', id, name, ask } as ToWorker, transfer);
        });
    }

    /** Whether the message was an answer. */
    receive(message: FromWorker): boolean {
        if (message.type !== 'answer' && message.type !== 'refused') return false;
        const waiting = this.waiting.get(message.id);
        this.waiting.delete(message.id);
        if (message.type === 'answer') waiting?.resolve(message.answer as never);
        else waiting?.reject(new Error(message.message));
        return true;
    }

    /** Nothing will be answered any more. */
    abandon(error: Error): void {
        for (const { reject } of this.waiting.values()) reject(error);
        this.waiting.clear();
    }
}
