// Transfer functions as the engine's JSON has them (src/volume/transfer_function.hpp), and what an editor does to them. All functions
// leave what they are given as it is.
import { hexFromLinear, linearFromSrgb, srgbFromLinear, type Rgb } from '../color';
import { isObject, type Json, type JsonObject } from '../schema';

/** "#rrggbb", or three sRGB numbers where those do not say it exactly. */
export type Color = string | number[];

export interface TransferPoint {
    value: number;
    color: Color;
    opacity: number;
    emission?: number;
}

export type ShapeType = 'box' | 'gaussian' | 'triangle';

/** A region of value (x) and gradient magnitude (y). */
export interface TransferShape {
    type: ShapeType;
    center: [number, number];
    size: [number, number];
    color: Color;
    opacity: number;
    emission?: number;
}

/** In value units. */
export interface Transfer {
    window: 'none';
    points: TransferPoint[];
    shapes: TransferShape[];
}

/** One channel as the engine describes it (volumeJson()). */
export interface ChannelInfo {
    name: string;
    minimum: number;
    maximum: number;
    low: number;
    high: number;
    gradient_high: number;
    /** What histograms are shown over. */
    axis: [number, number];
    transfer: JsonObject;
}

export interface VolumeInfo {
    time: number;
    unit: string;
    modality: string;
    channels: ChannelInfo[];
}

export interface HistogramInfo {
    values: number;
    gradients: number;
    low: number;
    high: number;
    gradient_high: number;
    voxels: number;
    counts: number[];
    /** Counts by log(1 + n), 0 to 1. */
    log: number[];
}

/** What the engine wrote: its own JSON, all written out. */
export function transferOf(json: JsonObject): Transfer {
    const list = <T>(value: Json | undefined) => (Array.isArray(value) ? (value as unknown as T[]) : []);
    return { window: 'none', points: list<TransferPoint>(json['points']), shapes: list<TransferShape>(json['shapes']) };
}

/** What `subject.transfer` takes for these functions of all channels. */
export function transferJson(transfers: readonly Transfer[]): Json {
    const json = transfers.map(({ window, points, shapes }) => ({ window, points, ...(shapes.length > 0 ? { shapes } : {}) }));
    return (json.length === 1 ? json[0]! : json) as unknown as Json;
}

/** Whether a file's JSON may be a transfer function; the engine judges the rest. */
export function isTransferJson(json: Json): boolean {
    const one = (value: Json): boolean => typeof value === 'string' || (isObject(value) && ['points', 'shapes', 'preset'].some((key) => key in value));
    return Array.isArray(json) ? json.length > 0 && json.every(one) : isObject(json) && one(json);
}

/** Linear RGB. */
export function linearOf(color: Color): Rgb {
    if (typeof color === 'string') {
        const part = (i: number) => linearFromSrgb(parseInt(color.slice(1 + 2 * i, 3 + 2 * i), 16) / 255);
        return [part(0), part(1), part(2)];
    }
    return [linearFromSrgb(color[0] ?? 0), linearFromSrgb(color[1] ?? 0), linearFromSrgb(color[2] ?? 0)];
}

/** What a colour picker shows. */
export function hexOf(color: Color): string {
    return typeof color === 'string' ? color : hexFromLinear(linearOf(color));
}

/** Colour and opacity of the points at a value: linear in between, constant beyond the ends, as the engine has it. */
export function pointAt(points: readonly TransferPoint[], value: number): TransferPoint {
    const after = points.findIndex((point) => point.value > value);
    const next = after < 0 ? points.length - 1 : after;
    const a = points[Math.max(next - 1, 0)];
    const b = points[next];
    if (!a || !b) return { value, color: '#ffffff', opacity: 0 };
    if (after === 0 || after < 0) return { ...(after === 0 ? a : b), value };
    const t = (value - a.value) / (b.value - a.value);
    const mix = (x: number, y: number) => x + t * (y - x);
    const [from, to] = [linearOf(a.color), linearOf(b.color)];
    const rgb = [0, 1, 2].map((i) => mix(from[i]!, to[i]!)) as unknown as Rgb;
    const emission = mix(a.emission ?? 0, b.emission ?? 0);
    return { value, color: hexFromLinear(rgb), opacity: mix(a.opacity, b.opacity), ...(emission > 0 ? { emission } : {}) };
}

const kMostPoints = 256;
const kMostShapes = 64;

export interface Edited {
    transfer: Transfer;
    /** The point or shape that was made or moved. */
    index: number;
}

/** A further point; at the curve's colour. */
export function addPoint(transfer: Transfer, value: number, opacity: number): Edited {
    if (transfer.points.length >= kMostPoints) return { transfer, index: transfer.points.length - 1 };
    const index = transfer.points.filter((point) => point.value <= value).length;
    const points = [...transfer.points];
    points.splice(index, 0, { ...pointAt(transfer.points, value), opacity: clamp(opacity, 0, 1) });
    return { transfer: { ...transfer, points }, index };
}

/** Points keep their order: none passes its neighbours. */
export function movePoint(transfer: Transfer, index: number, value: number, opacity: number): Transfer {
    const { points } = transfer;
    const low = points[index - 1]?.value ?? -Infinity;
    const high = points[index + 1]?.value ?? Infinity;
    return changePoint(transfer, index, { value: clamp(value, low, high), opacity: clamp(opacity, 0, 1) });
}

export function changePoint(transfer: Transfer, index: number, change: Partial<TransferPoint>): Transfer {
    return { ...transfer, points: transfer.points.map((point, i) => (i === index ? withoutZero({ ...point, ...change }) : point)) };
}

/** The engine needs something to show: the last point of a function without shapes stays. */
export function removePoint(transfer: Transfer, index: number): Transfer {
    if (transfer.points.length <= 1 && transfer.shapes.length === 0) return transfer;
    return { ...transfer, points: transfer.points.filter((_, i) => i !== index) };
}

export function addShape(transfer: Transfer, shape: TransferShape): Edited {
    if (transfer.shapes.length >= kMostShapes) return { transfer, index: transfer.shapes.length - 1 };
    return { transfer: { ...transfer, shapes: [...transfer.shapes, shape] }, index: transfer.shapes.length };
}

export function changeShape(transfer: Transfer, index: number, change: Partial<TransferShape>): Transfer {
    return { ...transfer, shapes: transfer.shapes.map((shape, i) => (i === index ? withoutZero({ ...shape, ...change }) : shape)) };
}

export function removeShape(transfer: Transfer, index: number): Transfer {
    if (transfer.shapes.length <= 1 && transfer.points.length === 0) return transfer;
    return { ...transfer, shapes: transfer.shapes.filter((_, i) => i !== index) };
}

function withoutZero<T extends { emission?: number }>(part: T): T {
    if (part.emission) return part;
    const { emission: _, ...rest } = part;
    return rest as T;
}

/** CSS colours along an axis, of the points. @param count at least 2 */
export function gradientOf(points: readonly TransferPoint[], low: number, high: number, count: number): string[] {
    return Array.from({ length: count }, (_, i) => {
        const [r, g, b] = linearOf(pointAt(points, low + ((high - low) * i) / (count - 1)).color).map((part) => Math.round(255 * srgbFromLinear(part)));
        return `rgb(${r} ${g} ${b})`;
    });
}

/** How opaque heights show small opacities, which matter most: 0.01 stands at a tenth. */
export function heightOf(opacity: number): number {
    return Math.sqrt(clamp(opacity, 0, 1));
}

export function opacityAt(height: number): number {
    const h = clamp(height, 0, 1);
    return h * h;
}

export function clamp(value: number, low: number, high: number): number {
    return Math.min(Math.max(value, low), high);
}
