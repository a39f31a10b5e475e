import { describe, expect, it } from 'vitest';
import { automaticScale, flightOf, PointerTracker, renderSize, wheelFactor } from '../../src/gestures';

const frame = { left: 100, top: 50, width: 800, height: 400 };

describe('dragging', () => {
    it('turns the scene with the cursor: half a turn over the height of the picture', () => {
        const tracker = new PointerTracker();
        tracker.down(1, { x: 0, y: 0 }, 'orbit');
        const [motion] = tracker.move(1, { x: 400, y: 100 }, frame);
        expect(motion).toEqual({ kind: 'orbit', yaw: expect.closeTo(-Math.PI, 9), pitch: expect.closeTo(Math.PI / 4, 9) });
    });

    it('pans by fractions of the height', () => {
        const tracker = new PointerTracker();
        tracker.down(1, { x: 10, y: 10 }, 'pan');
        expect(tracker.move(1, { x: 50, y: 30 }, frame)).toEqual([{ kind: 'pan', right: -0.1, up: 0.05 }]);
    });

    it('ignores pointers that are not down, and moves that are none', () => {
        const tracker = new PointerTracker();
        expect(tracker.move(1, { x: 5, y: 5 }, frame)).toEqual([]);
        tracker.down(1, { x: 5, y: 5 }, 'orbit');
        expect(tracker.move(1, { x: 5, y: 5 }, frame)).toEqual([]);
        tracker.up(1);
        expect(tracker.count).toBe(0);
    });
});

describe('two fingers', () => {
    it('zoom around their centre by the ratio of their distances', () => {
        const tracker = new PointerTracker();
        tracker.down(1, { x: 400, y: 250 }, 'orbit');
        tracker.down(2, { x: 500, y: 250 }, 'orbit');
        const motions = tracker.move(2, { x: 600, y: 250 }, frame);
        expect(motions[0]).toEqual({ kind: 'pan', right: -0.125, up: 0 });
        expect(motions[1]).toEqual({ kind: 'zoom', factor: 0.5, at: { x: 0.5, y: 0.5 } });
    });

    it('only pan when they move together', () => {
        const tracker = new PointerTracker();
        tracker.down(1, { x: 0, y: 0 }, 'orbit');
        tracker.down(2, { x: 100, y: 0 }, 'orbit');
        const motions = [...tracker.move(1, { x: 0, y: 40 }, frame), ...tracker.move(2, { x: 100, y: 40 }, frame)];
        const up = motions.reduce((sum, motion) => sum + (motion.kind === 'pan' ? motion.up : 0), 0);
        const factor = motions.reduce((product, motion) => product * (motion.kind === 'zoom' ? motion.factor : 1), 1);
        expect(up).toBeCloseTo(0.1, 12);
        expect(factor).toBeCloseTo(1, 12);
    });
});

describe('the wheel', () => {
    it('undoes itself', () => {
        expect(wheelFactor(100, 0, false, 800) * wheelFactor(-100, 0, false, 800)).toBeCloseTo(1, 12);
        expect(wheelFactor(-100, 0, false, 800)).toBeLessThan(1);
    });

    it('counts lines and pages as pixels, and never leaps', () => {
        expect(wheelFactor(3, 1, false, 800)).toBeCloseTo(wheelFactor(48, 0, false, 800), 12);
        expect(wheelFactor(1e6, 0, false, 800)).toBe(1.6);
        expect(wheelFactor(-1, 2, false, 800)).toBe(1 / 1.6);
    });
});

describe('flying keys', () => {
    it('add up and cancel', () => {
        expect(flightOf(new Set(['KeyW', 'KeyD', 'KeyA']))).toEqual({ kind: 'fly', right: 0, up: 0, ahead: 1, speed: 1 });
        expect(flightOf(new Set(['KeyQ', 'ShiftLeft']))).toMatchObject({ up: -1, speed: 3 });
        expect(flightOf(new Set())).toMatchObject({ right: 0, up: 0, ahead: 0 });
    });
});

describe('the size of the picture', () => {
    it('is that of the window in device pixels, within what the device can hold', () => {
        expect(renderSize({ width: 640.4, height: 360 }, 2, 0.5, 4096)).toEqual({ width: 640, height: 360 });
        expect(renderSize({ width: 9000, height: 0 }, 1, 1, 4096)).toEqual({ width: 4096, height: 1 });
    });

    it('is full on a GPU and smaller where a processor does the work', () => {
        const css = { width: 1920, height: 1080 };
        expect(automaticScale(css, 2, false)).toBe(1);
        const scale = automaticScale(css, 1, true);
        expect(1920 * scale * 1080 * scale).toBeLessThan(300_000);
        expect(automaticScale({ width: 320, height: 180 }, 1, true)).toBe(1);
    });
});
