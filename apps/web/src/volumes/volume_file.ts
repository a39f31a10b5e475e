// Volumes as the engine takes them (volume_data.cpp), and what readers of all formats share.

export type VoxelType = 'uint8' | 'int8' | 'uint16' | 'int16' | 'float16' | 'float32';

export interface VolumeForm {
    size: [number, number, number];
    type: VoxelType;
    channels: number;
    times: number;
    /** value = slope * stored + intercept */
    slope: number;
    intercept: number;
    /** Three axes from voxel to voxel, then where the centre of voxel (0, 0, 0) is: DICOM's LPS [mm]. */
    indexToWorld: number[];
    /** The file says how the grid lies in the world. */
    oriented: boolean;
    unit?: string;
    modality?: string;
    channelNames?: string[];
    /** What was done to the data on reading, one sentence each. */
    messages: string[];
}

export interface VolumeData {
    form: VolumeForm;
    /** x fastest, then y, z, channel, time; little-endian. */
    voxels: Uint8Array;
}

/** A file as it was chosen or dropped. */
export interface NamedBytes {
    name: string;
    bytes: Uint8Array<ArrayBuffer>;
}

/** Types of numbers in files: bytes of one, and what becomes of it. */
const kTypes = {
    int8: { bytes: 1, to: 'int8' },
    uint8: { bytes: 1, to: 'uint8' },
    int16: { bytes: 2, to: 'int16' },
    uint16: { bytes: 2, to: 'uint16' },
    int32: { bytes: 4, to: 'float32' },
    uint32: { bytes: 4, to: 'float32' },
    float32: { bytes: 4, to: 'float32' },
    float64: { bytes: 8, to: 'float32' },
} as const;

export type FileType = keyof typeof kTypes;

export function isFileType(name: string): name is FileType {
    return Object.hasOwn(kTypes, name);
}

/** Longest edge, as the engine has it. */
const kMostEdge = 65_536;
/** WebAssembly has 4 GB; copies on the way take their part. */
const kMostBytes = 2 ** 31;

export interface Layout {
    size: [number, number, number];
    channels: number;
    times: number;
    type: FileType;
    bigEndian: boolean;
    /** Channels of a voxel stand side by side. */
    interleaved: boolean;
}

/** Why numbers cannot be a size; null: they can. Before anything is allocated. */
export function wrongSize({ size, channels, times, type }: Layout): string | null {
    if (size.some((edge) => !Number.isInteger(edge) || edge < 1 || edge > kMostEdge)) return `a volume cannot be ${size.join(' x ')} voxels large`;
    if (!Number.isInteger(channels) || channels < 1 || channels > 4) return `${channels} channels cannot be shown: 1 to 4 can`;
    if (!Number.isInteger(times) || times < 1) return `there cannot be ${times} points of time`;
    const bytes = size[0] * size[1] * size[2] * channels * times * kTypes[type].bytes;
    return bytes > kMostBytes ? `${(bytes / 2 ** 30).toFixed(1)} GiB are too much for a page` : null;
}

/**
 * Voxels in the engine's order and types: little-endian, channels one after the other; 32-bit integers and doubles become
 * single floats, which `messages` tells.
 * @param bytes at least as many as there are voxels
 */
export function voxelsOf(bytes: Uint8Array, layout: Layout, messages: string[]): { type: VoxelType; voxels: Uint8Array } {
    const wrong = wrongSize(layout);
    if (wrong) throw new Error(wrong);
    const { size, channels, times, bigEndian } = layout;
    const { bytes: width, to } = kTypes[layout.type];
    const perChannel = size[0] * size[1] * size[2];
    const count = perChannel * channels * times;
    if (bytes.byteLength < count * width) throw new Error(`the file ends too soon: ${count * width - bytes.byteLength} bytes of voxels are missing`);
    const interleaved = layout.interleaved && channels > 1;
    if (!interleaved && to === layout.type && (!bigEndian || width === 1)) return { type: to, voxels: bytes.subarray(0, count * width) };
    if (to !== layout.type) messages.push(`${layout.type} was read as ${to}`);
    const view = new DataView(bytes.buffer, bytes.byteOffset, count * width);
    const read = readerOf(view, layout.type, !bigEndian);
    const result = new ArrayBuffer(count * kTypes[to].bytes);
    const out = to === 'int8' ? new Int8Array(result) : to === 'uint8' ? new Uint8Array(result) : to === 'int16' ? new Int16Array(result) : to === 'uint16' ? new Uint16Array(result) : new Float32Array(result);
    for (let i = 0; i < count; i++) {
        const time = Math.floor(i / (perChannel * channels));
        const within = i - time * perChannel * channels;
        const channel = Math.floor(within / perChannel);
        const from = interleaved ? (time * perChannel + within - channel * perChannel) * channels + channel : i;
        out[i] = read(from * width);
    }
    return { type: to, voxels: new Uint8Array(result) };
}

function readerOf(view: DataView, type: FileType, little: boolean): (at: number) => number {
    switch (type) {
        case 'int8':
            return (at) => view.getInt8(at);
        case 'uint8':
            return (at) => view.getUint8(at);
        case 'int16':
            return (at) => view.getInt16(at, little);
        case 'uint16':
            return (at) => view.getUint16(at, little);
        case 'int32':
            return (at) => view.getInt32(at, little);
        case 'uint32':
            return (at) => view.getUint32(at, little);
        case 'float32':
            return (at) => view.getFloat32(at, little);
        case 'float64':
            return (at) => view.getFloat64(at, little);
    }
}

/** Axes along the world's, voxel (0, 0, 0) at its origin: where a file says nothing else. */
export function upright(spacing: readonly number[]): number[] {
    return [...[0, 1, 2].flatMap((axis) => [0, 1, 2].map((row) => (row === axis ? spacing[axis]! : 0))), 0, 0, 0];
}

/** Whether the axes are turned or mirrored: what is not has the grid's own axes, and says nothing of how it lies. */
export function turned(indexToWorld: readonly number[]): boolean {
    return [0, 1, 2].some((axis) => [0, 1, 2].some((row) => (row === axis ? !(indexToWorld[3 * axis + row]! > 0) : indexToWorld[3 * axis + row] !== 0)));
}

/** Bytes of all voxels in a file. */
export function sizeInFile({ size, channels, times, type }: Layout): number {
    return size[0] * size[1] * size[2] * channels * times * kTypes[type].bytes;
}

export async function inflate(bytes: Uint8Array<ArrayBuffer>, format: 'gzip' | 'deflate'): Promise<Uint8Array<ArrayBuffer>> {
    try {
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format));
        return new Uint8Array(await new Response(stream).arrayBuffer());
    } catch {
        throw new Error('the compressed data is damaged');
    }
}

export function isGzip(bytes: Uint8Array): boolean {
    return bytes[0] === 0x1f && bytes[1] === 0x8b;
}

/** "A B  C" to numbers; throws where one is none. */
export function numbersOf(text: string, what: string): number[] {
    const numbers = text.trim().split(/[\s,]+/).map(Number);
    if (numbers.some((number) => !Number.isFinite(number))) throw new Error(`${what} are no numbers: ${text.trim().slice(0, 60)}`);
    return numbers;
}
