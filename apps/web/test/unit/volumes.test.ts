import { gzipSync, deflateSync } from 'node:zlib';
import { describe, expect, it } from 'vitest';
import { openVolume, rawFormOf } from '../../src/volumes/open';
import type { NamedBytes, VolumeForm } from '../../src/volumes/volume_file';

const never = async () => {
    throw new Error('nobody was to be asked');
};

function file(name: string, ...parts: (string | ArrayBufferView)[]): NamedBytes {
    const buffers = parts.map((part) => (typeof part === 'string' ? Buffer.from(part, 'latin1') : Buffer.from(part.buffer, part.byteOffset, part.byteLength)));
    return { name, bytes: new Uint8Array(Buffer.concat(buffers)) };
}

/** 2 x 3 x 4 voxels that are all different. */
const kVoxels = Int16Array.from({ length: 24 }, (_, i) => 100 * i - 1000);

async function opened(...files: NamedBytes[]): Promise<{ form: VolumeForm; values: number[] }> {
    const volume = (await openVolume(files, never))!;
    const form = volume.form as VolumeForm;
    const bytes = volume.voxels.slice().buffer;
    const values = { int16: () => new Int16Array(bytes), float32: () => new Float32Array(bytes), uint8: () => new Uint8Array(bytes) }[form.type as 'int16']!();
    return { form, values: [...values] };
}

function nifti(type: number, bits: number, data: ArrayBufferView, change: (view: DataView) => void = () => {}): NamedBytes {
    const view = new DataView(new ArrayBuffer(352));
    view.setInt32(0, 348, true);
    [3, 2, 3, 4, 1, 1, 1, 1].forEach((size, i) => view.setInt16(40 + 2 * i, size, true));
    view.setInt16(70, type, true);
    view.setInt16(72, bits, true);
    [1, 0.5, 0.6, 0.7].forEach((step, i) => view.setFloat32(76 + 4 * i, step, true));
    view.setFloat32(108, 352, true); // where the voxels begin
    view.setUint8(123, 2); // mm
    view.setInt16(254, 1, true); // sform
    const rows = [[0.5, 0, 0, 10], [0, 0, 0.7, 20], [0, 0.6, 0, 30]];
    rows.flat().forEach((value, i) => view.setFloat32(280 + 4 * i, value, true));
    [...'n+1\0'].forEach((letter, i) => view.setUint8(344 + i, letter.charCodeAt(0)));
    change(view);
    return file('brain.nii', view, data);
}

function near(numbers: number[], wanted: number[]): void {
    expect(numbers.length).toBe(wanted.length);
    numbers.forEach((number, i) => expect(number).toBeCloseTo(wanted[i]!, 6));
}

describe('NIfTI', () => {
    it('lies in the world as its header says, in LPS', async () => {
        const { form, values } = await opened(nifti(4, 16, kVoxels));
        expect(form).toMatchObject({ size: [2, 3, 4], type: 'int16', channels: 1, times: 1, slope: 1, intercept: 0 });
        near(form.indexToWorld, [-0.5, 0, 0, 0, 0, 0.6, 0, -0.7, 0, -10, -20, 30]);
        expect(values).toEqual([...kVoxels]);
    });

    it('is scaled by its slope, not in its voxels', async () => {
        const { form, values } = await opened(nifti(4, 16, kVoxels, (view) => {
            view.setFloat32(112, 0.5, true);
            view.setFloat32(116, -1024, true);
        }));
        expect(form).toMatchObject({ slope: 0.5, intercept: -1024 });
        expect(values).toEqual([...kVoxels]);
    });

    it('may be compressed, and of doubles', async () => {
        const plain = nifti(64, 64, Float64Array.from(kVoxels, (value) => value / 3));
        const { form, values } = await opened({ name: 'brain.nii.gz', bytes: new Uint8Array(gzipSync(plain.bytes)) });
        expect(form.messages).toEqual(['float64 was read as float32']);
        near(values, [...Float32Array.from(kVoxels, (value) => value / 3)]);
    });

    it('is refused where it is cut off', async () => {
        const whole = nifti(4, 16, kVoxels);
        await expect(opened({ ...whole, bytes: whole.bytes.slice(0, -10) })).rejects.toThrow(/brain\.nii: .*(too soon|missing|damaged)/);
    });
});

describe('NRRD', () => {
    const header = (more: string) => `NRRD0004\n# a comment\ntype: short\ndimension: 3\nsizes: 2 3 4\nendian: little\n${more}\n`;

    it('has axes and an origin in its space', async () => {
        const text = header('encoding: raw\nspace: right-anterior-superior\nspace directions: (1,0,0) (0,0.8,0.6) (0,-0.6,0.8)\nspace origin: (5,6,7)\n');
        const { form, values } = await opened(file('a.nrrd', text, kVoxels));
        near(form.indexToWorld, [-1, 0, 0, 0, -0.8, 0.6, 0, 0.6, 0.8, -5, -6, 7]);
        expect(form.oriented).toBe(true);
        expect(values).toEqual([...kVoxels]);
    });

    it('may be compressed, big-endian, and apart from its voxels', async () => {
        const swapped = Buffer.from(kVoxels.buffer.slice(0)).swap16();
        const text = header('encoding: gzip\nspacings: 1 2 3\ndata file: a.raw.gz\n').replace('little', 'big');
        const { form, values } = await opened({ name: 'a.raw.gz', bytes: new Uint8Array(gzipSync(swapped)) }, file('a.nhdr', text));
        near(form.indexToWorld, [1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]);
        expect(form.oriented).toBe(false);
        expect(values).toEqual([...kVoxels]);
        await expect(opened(file('a.nhdr', text))).rejects.toThrow('a.nhdr: its voxels are in a.raw.gz: open both files together');
    });

    it('has channels side by side, which the engine has one after the other', async () => {
        const text = 'NRRD0005\ntype: uint8\ndimension: 4\nsizes: 2 2 1 3\nencoding: raw\nkinds: vector domain domain domain\n\n';
        const { form, values } = await opened(file('c.nrrd', text, Uint8Array.from({ length: 12 }, (_, i) => (i % 2) * 100 + Math.floor(i / 2))));
        expect(form).toMatchObject({ size: [2, 1, 3], channels: 2, times: 1 });
        expect(values).toEqual([0, 1, 2, 3, 4, 5, 100, 101, 102, 103, 104, 105]);
    });

    it.each([
        ['sizes: 2 3 99999999', /cannot be 2 x 3 x 99999999/],
        ['sizes: 65536 65536 65536', /too much for a page/],
        ['sizes: 2 3', /2 sizes for 3 dimensions/],
        ['sizes: 2 three 4', /no numbers/],
        ['type: complex', /type "complex"/],
        ['encoding: bzip2', /encoding "bzip2"/],
    ])('is refused with %s', async (line, message) => {
        const key = line.split(':')[0]!;
        const text = header('encoding: raw\n').replace(new RegExp(`^${key}:.*$`, 'm'), line);
        await expect(opened(file('bad.nrrd', text, kVoxels))).rejects.toThrow(message);
    });
});

describe('MetaImage', () => {
    const header = (more: string, data = 'LOCAL') =>
        `ObjectType = Image\nNDims = 3\nDimSize = 2 3 4\nElementType = MET_SHORT\nElementSpacing = 3 2 1\nElementByteOrderMSB = False\n${more}ElementDataFile = ${data}\n`;

    it('has its voxels inside or beside it', async () => {
        const turned = 'TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 7 8 9\n';
        const inside = await opened(file('a.mha', header(turned), kVoxels));
        near(inside.form.indexToWorld, [0, 3, 0, -2, 0, 0, 0, 0, 1, 7, 8, 9]);
        expect(inside.form.oriented).toBe(true);
        expect(inside.values).toEqual([...kVoxels]);
        const beside = await opened(file('a.mhd', header(turned, 'folder/a.raw')), file('a.raw', kVoxels));
        expect(beside).toEqual(inside);
        await expect(opened(file('a.mhd', header('', 'a.raw')))).rejects.toThrow('open both files together');
    });

    it('may be compressed', async () => {
        const { values } = await opened(file('a.mha', header('CompressedData = True\n'), deflateSync(Buffer.from(kVoxels.buffer))));
        expect(values).toEqual([...kVoxels]);
        await expect(opened(file('a.mha', header('CompressedData = True\n'), 'nonsense'))).rejects.toThrow('damaged');
    });
});

describe('bare voxels', () => {
    it('are asked about, with what their name tells', async () => {
        expect(rawFormOf('bonsai_256x256x128_uint8.raw')).toBe('256x256x128:uint8');
        expect(rawFormOf('headsq_quarter_64x64x93_int16le.raw')).toBe('64x64x93:int16');
        expect(rawFormOf('x_10x10x10_ushort_be.raw')).toBe('10x10x10:uint16');
        expect(rawFormOf('voxels.raw')).toBeNull();
        const bytes = new Uint8Array(8);
        expect(await openVolume([{ name: 'x.raw', bytes }], async () => null)).toBeNull();
        expect(await openVolume([{ name: 'x.raw', bytes }], async (name, count) => `${name} ${count}`)).toEqual({ name: 'x.raw', form: { raw: 'x.raw 8' }, voxels: bytes });
    });
});
