// MetaImage (itk.org/Wiki/MetaIO/Documentation): .mha, and .mhd with the file that it names.
import { inflate, numbersOf, sizeInFile, turned, voxelsOf, type FileType, type Layout, type NamedBytes, type VolumeData } from './volume_file';

const kTypes: { [name: string]: FileType } = {
    MET_CHAR: 'int8', MET_UCHAR: 'uint8', MET_SHORT: 'int16', MET_USHORT: 'uint16',
    MET_INT: 'int32', MET_UINT: 'uint32', MET_FLOAT: 'float32', MET_DOUBLE: 'float64',
};

const kLongestHeader = 1 << 16;

export function isMetaImage(bytes: Uint8Array): boolean {
    const text = new TextDecoder('latin1').decode(bytes.subarray(0, kLongestHeader));
    return /^\s*(ObjectType|NDims|Comment|Name|ID)\s*=/.test(text) && /\n\s*ElementDataFile\s*=/.test(text);
}

/** @param others files beside it, of which it names one */
export async function readMetaImage(file: NamedBytes, others: readonly NamedBytes[]): Promise<VolumeData> {
    const text = new TextDecoder('latin1').decode(file.bytes.subarray(0, kLongestHeader));
    const header = /ElementDataFile\s*=\s*([^\r\n]*)\r?\n?/.exec(text);
    if (!header) throw new Error('the MetaImage header does not say "ElementDataFile"');
    const fields = new Map<string, string>();
    for (const line of text.slice(0, header.index).split(/\r?\n/)) {
        const match = /^\s*(\w+)\s*=\s*(.*)$/.exec(line);
        if (match) fields.set(match[1]!, match[2]!.trim());
    }
    const first = (...names: string[]) => names.map((name) => fields.get(name)).find((value) => value !== undefined);
    const isTrue = (value: string | undefined) => /^(true|1|yes)$/i.test(value ?? '');
    const sizes = numbersOf(first('DimSize') ?? '', 'DimSize');
    const dimension = Number(first('NDims') ?? sizes.length);
    if (sizes.length !== dimension || dimension < 3 || dimension > 4) throw new Error(`MetaImage files of ${dimension} dimensions cannot be read: 3 and 4 can`);
    const typeName = first('ElementType') ?? '';
    const type = kTypes[typeName];
    if (!type) throw new Error(`MetaImage's voxels of type "${typeName}" cannot be read`);
    const size = sizes.slice(0, 3) as [number, number, number];
    const layout: Layout = {
        size,
        channels: Number(first('ElementNumberOfChannels') ?? 1),
        times: sizes[3] ?? 1,
        type,
        bigEndian: isTrue(first('BinaryDataByteOrderMSB', 'ElementByteOrderMSB')),
        interleaved: true,
    };

    const named = header[1]!.trim();
    let data: Uint8Array<ArrayBuffer>;
    if (/^local$/i.test(named)) {
        data = file.bytes.subarray(header.index + header[0].length);
    } else {
        const beside = others.find((other) => other.name === named.split(/[\\/]/).pop());
        if (!beside) throw new Error(`its voxels are in ${named}: open both files together`);
        data = beside.bytes;
    }
    const compressed = isTrue(first('CompressedData'));
    if (compressed) data = await inflate(data, 'deflate');
    const skip = Number(first('HeaderSize') ?? 0);
    data = data.subarray(skip >= 0 ? skip : Math.max(0, data.byteLength - sizeInFile(layout)));

    const messages: string[] = [];
    const { type: stored, voxels } = voxelsOf(data, layout, messages);
    const spacing = numbersOf(first('ElementSpacing', 'ElementSize') ?? '1 1 1', 'ElementSpacing').slice(0, 3);
    // Rows of the matrix are the axes.
    const rows = numbersOf(first('TransformMatrix', 'Rotation', 'Orientation') ?? '1 0 0 0 1 0 0 0 1', 'TransformMatrix');
    const width = rows.length === 16 ? 4 : 3;
    const place = numbersOf(first('Offset', 'Position', 'Origin') ?? '0 0 0', 'Offset').slice(0, 3);
    const indexToWorld = [0, 1, 2].flatMap((axis) => [0, 1, 2].map((row) => spacing[axis]! * rows[width * axis + row]!)).concat(place);
    return { form: { size, type: stored, channels: layout.channels, times: layout.times, slope: 1, intercept: 0, indexToWorld, oriented: turned(indexToWorld), messages }, voxels };
}
