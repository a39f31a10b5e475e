// From files to a volume for the engine, by their first bytes.
import { isMetaImage, readMetaImage } from './metaimage';
import { isNifti, readNifti } from './nifti';
import { isNrrd, readNrrd } from './nrrd';
import { inflate, isGzip, type NamedBytes, type VolumeForm } from './volume_file';

export interface OpenedVolume {
    name: string;
    /** What the voxels are; or bare ones, in the words of `--raw`. */
    form: VolumeForm | { raw: string };
    voxels: Uint8Array;
}

/** Endings of what can be opened, for file pickers. */
export const kVolumeEndings = ['.nii', '.gz', '.nrrd', '.nhdr', '.mha', '.mhd', '.raw'];

/** Whether a file may be a volume: by its name, for files that have no first bytes of their own. */
export function looksLikeVolume(name: string): boolean {
    return /\.(nii|nii\.gz|nrrd|nhdr|mha|mhd|raw|raw\.gz|hdr|img)$/i.test(name);
}

/** "bonsai_256x256x256_uint8.raw" tells what it is: "256x256x256:uint8". Null where a name tells nothing. */
export function rawFormOf(name: string): string | null {
    const size = /(\d+)x(\d+)x(\d+)/i.exec(name);
    if (!size) return null;
    const type = /(u?int(?:8|16)|float(?:16|32)|uchar|ushort|short|float)(le|be)?/i.exec(name.slice(size.index));
    const short: { [name: string]: string } = { uchar: 'uint8', ushort: 'uint16', short: 'int16', float: 'float32' };
    const word = (type?.[1] ?? 'uint8').toLowerCase();
    return `${size[1]}x${size[2]}x${size[3]}:${short[word] ?? word}${type?.[2]?.toLowerCase() === 'be' ? ':big' : ''}`;
}

/**
 * @param files one, or a header and the voxels that it names
 * @param raw what bare voxels are; asked for only where no file tells
 * @throws Error with the file's name
 */
export async function openVolume(files: readonly NamedBytes[], raw: (name: string, bytes: number) => Promise<string | null>): Promise<OpenedVolume | null> {
    const isHeader = ({ bytes }: NamedBytes) => isNrrd(bytes) || isMetaImage(bytes) || isNifti(bytes);
    const first = files.find(isHeader) ?? files[0];
    if (!first) throw new Error('there is no file to open');
    const others = files.filter((file) => file !== first);
    const { name } = first;
    try {
        const bytes = isGzip(first.bytes) ? await inflate(first.bytes, 'gzip') : first.bytes;
        if (isNifti(bytes)) return { name, ...readNifti(bytes) };
        if (isNrrd(bytes)) return { name, ...(await readNrrd({ name, bytes }, others)) };
        if (isMetaImage(bytes)) return { name, ...(await readMetaImage({ name, bytes }, others)) };
        const form = await raw(name, bytes.byteLength);
        return form === null ? null : { name, form: { raw: form }, voxels: bytes };
    } catch (error) {
        throw new Error(`${name}: ${error instanceof Error ? error.message : String(error)}`);
    }
}
