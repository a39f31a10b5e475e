import { describe, expect, it } from 'vitest';
import type { Status } from '../../src/protocol';
import { deviceName, messagesOf, milliseconds, powerOfTen, readingsOf, short } from '../../src/readings';

const status: Status = {
    state: 'rendering', samples: 3, limit: 64, progress: 0.5, moving: true, fps: 29.7, stepMs: 12, sampleMs: 430,
    size: { width: 640, height: 360 }, distance: null, scale: null, autopilot: null, emptyReason: '',
};

describe('messages', () => {
    it('begin with why there is nothing to see', () => {
        const empty = { ...status, emptyReason: 'the camera is inside the surface' };
        expect(messagesOf(['menger has no constant'], empty)).toEqual(['The camera is inside the surface', 'Menger has no constant']);
        expect(messagesOf(['a note'], status)).toEqual(['A note']);
        expect(messagesOf([], null)).toEqual([]);
    });
});

describe('readings', () => {
    it('keep numbers short at every scale', () => {
        expect([0, 1.6034, 123.4, 0.00000123, 1e6].map(short)).toEqual(['0', '1.6', '123', '1.2 e-6', '1.0 e6']);
        expect([0.42, 42.4, 1234, 61000].map(milliseconds)).toEqual(['0.4 ms', '42 ms', '1.2 s', '61 s']);
    });

    it('tell the scale as a power of ten, where there is one', () => {
        expect([-12, -12.4, -0.02, -1023.5, 0].map(powerOfTen)).toEqual(['10⁻¹²', '4 · 10⁻¹³', '10⁰', '3 · 10⁻¹⁰²⁴', '10⁰']);
        expect(readingsOf(status).some((reading) => reading.key === 'scale')).toBe(false);
        expect(readingsOf({ ...status, scale: -12 }).at(-1)).toEqual({ key: 'scale', label: 'Scale', value: '10⁻¹²' });
    });

    it("find the device's name in what browsers tell", () => {
        const names = {
            'ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero) (0x0000C0DE)), SwiftShader driver)': 'SwiftShader',
            'ANGLE (NVIDIA, NVIDIA GeForce RTX 3060 (0x00002504) Direct3D11 vs_5_0 ps_5_0, D3D11)': 'NVIDIA GeForce RTX 3060',
            'ANGLE (Apple, ANGLE Metal Renderer: Apple M2, Unspecified Version)': 'Apple M2',
            'Radeon R9 200 Series, or similar': 'Radeon R9 200 Series',
            'Mali-G78': 'Mali-G78',
        };
        for (const [told, name] of Object.entries(names)) expect(deviceName(told)).toBe(name);
    });

    it('tell frames per second while moving and time per sample at rest', () => {
        const value = (now: Status, key: string) => readingsOf(now).find((reading) => reading.key === key)!.value;
        expect(value(status, 'speed')).toBe('30 fps');
        expect(value({ ...status, moving: false }, 'speed')).toBe('430 ms');
        expect(value(status, 'samples')).toBe('3 / 64');
        expect(value({ ...status, distance: Infinity }, 'distance')).toBe('∞');
    });
});
