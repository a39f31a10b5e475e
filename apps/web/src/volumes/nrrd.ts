// NRRD (teem.sourceforge.net/nrrd/format.html): raw and gzip, attached, and detached where the data was given as well.
import { inflate, numbersOf, sizeInFile, turned, upright, voxelsOf, type FileType, type Layout, type NamedBytes, type VolumeData } from './volume_file';

const kTypes: { [name: string]: FileType } = {
    'signed char': 'int8', int8: 'int8', int8_t: 'int8',
    uchar: 'uint8', 'unsigned char': 'uint8', uint8: 'uint8', uint8_t: 'uint8',
    short: 'int16', 'short int': 'int16', 'signed short': 'int16', 'signed short int': 'int16', int16: 'int16', int16_t: 'int16',
    ushort: 'uint16', 'unsigned short': 'uint16', 'unsigned short int': 'uint16', uint16: 'uint16', uint16_t: 'uint16',
    int: 'int32', 'signed int': 'int32', int32: 'int32', int32_t: 'int32',
    uint: 'uint32', 'unsigned int': 'uint32', uint32: 'uint32', uint32_t: 'uint32',
    float: 'float32', double: 'float64',
};

/** What turns a space's axes into left, posterior, superior. */
const kSpaces: { [name: string]: readonly [number, number, number] } = {
    'left-posterior-superior': [1, 1, 1], lps: [1, 1, 1],
    'right-anterior-superior': [-1, -1, 1], ras: [-1, -1, 1],
    'left-anterior-superior': [1, -1, 1], las: [1, -1, 1],
};

/** A header is text of a few lines; what is longer is something else. */
const kLongestHeader = 1 << 20;

export function isNrrd(bytes: Uint8Array): boolean {
    return String.fromCharCode(...bytes.subarray(0, 4)) === 'NRRD';
}

interface Header {
    fields: Map<string, string>;
    /** Where the data begins. */
    end: number;
}

function headerOf(bytes: Uint8Array): Header {
    const text = new TextDecoder('latin1').decode(bytes.subarray(0, kLongestHeader));
    const end = /\r?\n\r?\n/.exec(text);
    const lines = (end ? text.slice(0, end.index) : text).split(/\r?\n/).slice(1);
    const fields = new Map<string, string>();
    for (const line of lines) {
        if (line.startsWith('#')) continue;
        const match = /^([^:]+):[=]?\s*(.*)$/.exec(line);
        if (match) fields.set(match[1]!.trim().toLowerCase(), match[2]!.trim());
    }
    return { fields, end: end ? end.index + end[0].length : bytes.byteLength };
}

function need(fields: Map<string, string>, name: string): string {
    const value = fields.get(name);
    if (value === undefined) throw new Error(`the NRRD header does not say "${name}"`);
    return value;
}

/** "(1,0,0) (0,1,0) none" to vectors; null where there is none. */
function vectorsOf(text: string): (number[] | null)[] {
    return [...text.matchAll(/\(([^)]*)\)|none/gi)].map((match) => (match[1] === undefined ? null : numbersOf(match[1], 'space directions')));
}

/** Bytes that the header says precede the voxels. */
function skipped(bytes: Uint8Array<ArrayBuffer>, fields: Map<string, string>): Uint8Array<ArrayBuffer> {
    let start = 0;
    for (let lines = Number(fields.get('line skip') ?? fields.get('lineskip') ?? 0); lines > 0 && start < bytes.byteLength; start++) {
        if (bytes[start] === 10) lines--;
    }
    return bytes.subarray(start);
}

/** @param others files beside it, for headers that name one */
export async function readNrrd(file: NamedBytes, others: readonly NamedBytes[]): Promise<VolumeData> {
    const { fields, end } = headerOf(file.bytes);
    const typeName = need(fields, 'type').toLowerCase();
    const type = kTypes[typeName];
    if (!type) throw new Error(`NRRD's voxels of type "${typeName}" cannot be read`);
    const sizes = numbersOf(need(fields, 'sizes'), 'sizes');
    const dimension = Number(need(fields, 'dimension'));
    if (sizes.length !== dimension) throw new Error(`the NRRD header has ${sizes.length} sizes for ${dimension} dimensions`);
    const kinds = (fields.get('kinds') ?? '').toLowerCase().split(/\s+/).filter((kind) => kind);
    const directions = vectorsOf(fields.get('space directions') ?? '');
    // The axis that is none of space: first or last.
    const isOther = (axis: number) => (kinds[axis] !== undefined ? !['domain', 'space'].includes(kinds[axis]!) : directions[axis] === null);
    let [interleaved, channels, times] = [false, 1, 1];
    let spatial = sizes.map((_, axis) => axis);
    if (dimension === 4) {
        const first = isOther(0);
        const other = first ? 0 : 3;
        spatial = spatial.filter((axis) => axis !== other);
        interleaved = first;
        if (!first && (kinds[3] === 'time' || sizes[3]! > 4)) times = sizes[3]!;
        else channels = sizes[other]!;
    } else if (dimension !== 3) {
        throw new Error(`NRRD files of ${dimension} dimensions cannot be read: 3 can, and 4 with channels or points of time`);
    }
    const size = spatial.map((axis) => sizes[axis]!) as [number, number, number];
    const layout: Layout = { size, channels, times, type, bigEndian: fields.get('endian')?.toLowerCase() === 'big', interleaved };

    const detached = fields.get('data file') ?? fields.get('datafile');
    let data: Uint8Array<ArrayBuffer>;
    if (detached === undefined) {
        data = file.bytes.subarray(end);
    } else {
        const beside = others.find((other) => other.name === detached.split(/[\\/]/).pop());
        if (!beside) throw new Error(`its voxels are in ${detached}: open both files together`);
        data = beside.bytes;
    }
    data = skipped(data, fields);
    const encoding = need(fields, 'encoding').toLowerCase();
    if (encoding === 'gzip' || encoding === 'gz') data = await inflate(data, 'gzip');
    else if (encoding !== 'raw') throw new Error(`NRRD's encoding "${encoding}" cannot be read: raw and gzip can`);
    const skip = Number(fields.get('byte skip') ?? fields.get('byteskip') ?? 0);
    // -1: the voxels are the file's last bytes.
    data = data.subarray(skip >= 0 ? skip : Math.max(0, data.byteLength - sizeInFile(layout)));

    const messages: string[] = [];
    const { type: stored, voxels } = voxelsOf(data, layout, messages);
    const axes = spatial.map((axis) => directions[axis] ?? null);
    const placed = axes.every((axis) => axis !== null && axis.length === 3);
    let indexToWorld: number[];
    if (placed) {
        const signs = kSpaces[(fields.get('space') ?? '').toLowerCase()] ?? [1, 1, 1];
        const origin = vectorsOf(fields.get('space origin') ?? '')[0] ?? [0, 0, 0];
        indexToWorld = [...axes, origin].flatMap((axis) => axis!.map((part, row) => part * signs[row]!));
    } else {
        const spacings = fields.get('spacings')?.split(/\s+/).map(Number) ?? [];
        indexToWorld = upright(spatial.map((axis) => Math.abs(spacings[axis]!) || 1));
    }
    return { form: { size, type: stored, channels, times, slope: 1, intercept: 0, indexToWorld, oriented: turned(indexToWorld), messages }, voxels };
}
