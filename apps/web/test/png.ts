// PNG for tests: 8 bits, RGB or RGBA, not interlaced.
import { deflateSync, inflateSync } from 'node:zlib';
import { crc } from '../src/png';

export interface Picture {
    width: number;
    height: number;
    /** RGBA. */
    data: Uint8Array;
}

const kSignature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);

function paeth(a: number, b: number, c: number): number {
    const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

export function decodePng(bytes: Uint8Array): Picture {
    const file = Buffer.from(bytes);
    if (!file.subarray(0, 8).equals(kSignature)) throw new Error('not a PNG file');
    let [width, height, channels] = [0, 0, 0];
    const parts: Buffer[] = [];
    for (let place = 8; place < file.length; ) {
        const length = file.readUInt32BE(place);
        const type = file.toString('latin1', place + 4, place + 8);
        const data = file.subarray(place + 8, place + 8 + length);
        if (type === 'IHDR') {
            [width, height] = [data.readUInt32BE(0), data.readUInt32BE(4)];
            const color = data[9];
            if (data[8] !== 8 || data[12] !== 0 || (color !== 2 && color !== 6)) throw new Error('this kind of PNG is not decoded here');
            channels = color === 2 ? 3 : 4;
        }
        if (type === 'IDAT') parts.push(data);
        place += 12 + length;
    }
    const raw = inflateSync(Buffer.concat(parts));
    const stride = width * channels;
    const rows = new Uint8Array(height * stride);
    for (let y = 0; y < height; y++) {
        const filter = raw[y * (stride + 1)]!;
        for (let i = 0; i < stride; i++) {
            const left = i >= channels ? rows[y * stride + i - channels]! : 0;
            const up = y > 0 ? rows[(y - 1) * stride + i]! : 0;
            const corner = y > 0 && i >= channels ? rows[(y - 1) * stride + i - channels]! : 0;
            const guess = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter]!;
            rows[y * stride + i] = raw[y * (stride + 1) + 1 + i]! + guess;
        }
    }
    if (channels === 4) return { width, height, data: rows };
    const data = new Uint8Array(4 * width * height).fill(255);
    for (let i = 0; i < width * height; i++) data.set(rows.subarray(3 * i, 3 * i + 3), 4 * i);
    return { width, height, data };
}

export function encodePng(width: number, height: number, data: Uint8Array): Buffer {
    const chunk = (type: string, content: Buffer) => {
        const result = Buffer.alloc(12 + content.length);
        result.writeUInt32BE(content.length);
        result.write(type, 4, 'latin1');
        content.copy(result, 8);
        result.writeUInt32BE(crc(result.subarray(4, 8 + content.length)) >>> 0, 8 + content.length);
        return result;
    };
    const header = Buffer.alloc(13);
    header.writeUInt32BE(width, 0);
    header.writeUInt32BE(height, 4);
    header.set([8, 6], 8);
    const rows = Array.from({ length: height }, (_, y) =>
        Buffer.concat([Buffer.from([0]), Buffer.from(data.subarray(4 * width * y, 4 * width * (y + 1)))]),
    );
    return Buffer.concat([kSignature, chunk('IHDR', header), chunk('IDAT', deflateSync(Buffer.concat(rows))), chunk('IEND', Buffer.alloc(0))]);
}
