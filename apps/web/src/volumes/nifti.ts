// NIfTI-1 and -2, by nifti-reader-js.
import { NIFTI1, NIFTI2, readHeader, readImage } from 'nifti-reader-js';
import { upright, voxelsOf, type FileType, type Layout, type VolumeData } from './volume_file';

const kTypes = new Map<number, FileType>([
    [NIFTI1.TYPE_UINT8, 'uint8'],
    [NIFTI1.TYPE_INT8, 'int8'],
    [NIFTI1.TYPE_UINT16, 'uint16'],
    [NIFTI1.TYPE_INT16, 'int16'],
    [NIFTI1.TYPE_UINT32, 'uint32'],
    [NIFTI1.TYPE_INT32, 'int32'],
    [NIFTI1.TYPE_FLOAT32, 'float32'],
    [NIFTI1.TYPE_FLOAT64, 'float64'],
]);

/** [mm] */
const kUnits = new Map([
    [NIFTI1.UNITS_METER, 1000],
    [NIFTI1.UNITS_MM, 1],
    [NIFTI1.UNITS_MICRON, 0.001],
]);

export function isNifti(bytes: Uint8Array): boolean {
    if (bytes.byteLength < 348) return false;
    const at = (offset: number, text: string) => [...text].every((letter, i) => bytes[offset + i] === letter.charCodeAt(0));
    return at(344, 'n+1') || at(344, 'ni1') || at(4, 'n+2') || at(4, 'ni2');
}

/** @param bytes no longer compressed */
export function readNifti(bytes: Uint8Array<ArrayBuffer>): VolumeData {
    const buffer = bytes.byteOffset === 0 && bytes.byteLength === bytes.buffer.byteLength ? bytes.buffer : bytes.slice().buffer;
    const header = readHeader(buffer) as NIFTI1 | NIFTI2 | null;
    if (!header) throw new Error('the NIfTI header is damaged');
    const type = kTypes.get(header.datatypeCode);
    if (!type) throw new Error(`NIfTI's voxels of type ${header.datatypeCode} cannot be read`);
    const dims = header.dims.slice(1, 1 + header.dims[0]!);
    const [x = 1, y = 1, z = 1, times = 1, channels = 1] = dims;
    const layout: Layout = { size: [x, y, z], channels, times, type, bigEndian: !header.littleEndian, interleaved: false };
    if (channels > 1 && times > 1) throw new Error('NIfTI files with channels and points of time cannot be read');
    const messages: string[] = [];
    const { type: stored, voxels } = voxelsOf(new Uint8Array(readImage(header, buffer)), layout, messages);
    const millimetres = kUnits.get(header.xyzt_units & 7) ?? 1;
    const oriented = header.sform_code > 0 || header.qform_code > 0;
    // NIfTI's world is RAS: x and y point the other way.
    const column = (axis: number) => [0, 1, 2].map((row) => (row < 2 ? -1 : 1) * millimetres * header.affine[row]![axis]!);
    const spacing = header.pixDims.slice(1, 4).map((step) => millimetres * (Math.abs(step) || 1));
    const slope = header.scl_slope;
    const scaled = Number.isFinite(slope) && slope !== 0;
    return {
        form: {
            size: layout.size,
            type: stored,
            channels,
            times,
            slope: scaled ? slope : 1,
            intercept: scaled && Number.isFinite(header.scl_inter) ? header.scl_inter : 0,
            indexToWorld: oriented ? [0, 1, 2, 3].flatMap(column) : upright(spacing),
            oriented: true, // as the native reader has it: NIfTI's axes have directions of their own
            messages,
        },
        voxels,
    };
}
