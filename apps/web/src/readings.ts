// The status line's words and numbers.
import type { Reading as VolumeReading, Status } from './protocol';

export interface Reading {
    key: string;
    label: string;
    value: string;
}

/** Three significant digits, without exponents where that reads well. */
export function short(value: number): string {
    if (value === 0) return '0';
    const size = Math.abs(value);
    if (size < 1e-3 || size >= 1e5) return value.toExponential(1).replace('e', ' e').replace('+', '');
    return size >= 100 ? value.toFixed(0) : String(Number(value.toPrecision(3)));
}

/** A power of ten as people write it: one digit and an exponent. */
export function powerOfTen(power: number): string {
    let exponent = Math.floor(power);
    let digit = Math.round(10 ** (power - exponent));
    if (digit === 10) [digit, exponent] = [1, exponent + 1];
    const raised = [...String(exponent)].map((sign) => (sign === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(sign)])).join('');
    return digit === 1 ? `10${raised}` : `${digit} · 10${raised}`;
}

export function milliseconds(ms: number): string {
    if (ms >= 9950) return `${(ms / 1000).toFixed(0)} s`;
    if (ms >= 1000) return `${(ms / 1000).toFixed(1)} s`;
    return `${ms >= 10 ? ms.toFixed(0) : ms.toFixed(1)} ms`;
}

/** "CT 312 HU at 12.5, -3.1, 40 mm" */
export function valueText({ values, unit, position }: VolumeReading): string {
    const parts = values.map(({ name, value }) => `${name ? `${name} ` : ''}${value === null ? '–' : short(value)}${unit ? ` ${unit}` : ''}`);
    return `${parts.join(' · ')}  at ${position.map(short).join(', ')} mm`;
}

/** What the page tells about the picture, most urgent first. */
export function messagesOf(notes: readonly string[], status: Status | null): string[] {
    const reason = status?.emptyReason ?? '';
    return (reason ? [reason, ...notes] : notes).map((line) => line.charAt(0).toUpperCase() + line.slice(1));
}

/** "ANGLE (NVIDIA, NVIDIA GeForce RTX 3060 (0x2504) Direct3D11 vs_5_0 ps_5_0, D3D11)" to "NVIDIA GeForce RTX 3060". */
export function deviceName(renderer: string): string {
    if (/swiftshader/i.test(renderer)) return 'SwiftShader';
    if (/llvmpipe/i.test(renderer)) return 'llvmpipe';
    const angle = /^ANGLE \((.*)\)$/.exec(renderer);
    const parts = angle ? angle[1]!.split(', ') : [renderer];
    const name = (parts[1] ?? parts[0]!).replace(/^ANGLE Metal Renderer: /, '');
    return name.replace(/\s*(\(0x[0-9a-f]+\)|Direct3D.*|OpenGL.*|\/PCIe.*|,? or similar)/gi, '').trim() || renderer;
}

const kStates = { rendering: 'Rendering', finished: 'Finished', paused: 'Paused', lost: 'Context lost' };

export function readingsOf(status: Status): Reading[] {
    const { samples, limit, state, moving } = status;
    const speed = moving ? `${status.fps.toFixed(0)} fps` : status.sampleMs > 0 ? milliseconds(status.sampleMs) : '–';
    return [
        { key: 'state', label: 'State', value: moving ? 'Moving' : kStates[state] },
        { key: 'samples', label: 'Samples', value: `${samples} / ${limit}` },
        { key: 'speed', label: moving ? 'Speed' : 'Per sample', value: speed },
        { key: 'step', label: 'Step', value: milliseconds(status.stepMs) },
        { key: 'size', label: 'Size', value: `${status.size.width} × ${status.size.height}` },
        { key: 'distance', label: 'Distance', value: status.distance === null ? '–' : Number.isFinite(status.distance) ? short(status.distance) : '∞' },
        ...(status.scale === null ? [] : [{ key: 'scale', label: 'Scale', value: powerOfTen(status.scale) }]),
    ];
}
