import { describe, expect, it } from 'vitest';
import {
    addPoint, addShape, changePoint, changeShape, gradientOf, heightOf, hexOf, isTransferJson, movePoint, opacityAt, pointAt, removePoint, removeShape,
    transferJson, transferOf, type Transfer,
} from '../../src/transfer/transfer';

const kRamp: Transfer = {
    window: 'none',
    points: [
        { value: 0, color: '#000000', opacity: 0 },
        { value: 100, color: '#ffffff', opacity: 1, emission: 2 },
    ],
    shapes: [],
};
const kBox = { type: 'box', center: [50, 5], size: [20, 4], color: '#ff0000', opacity: 0.5 } as const;

describe('a transfer function', () => {
    it('is linear between its points, in linear light, and constant beyond', () => {
        expect(pointAt(kRamp.points, 25)).toMatchObject({ opacity: 0.25, emission: 0.5 });
        expect(pointAt(kRamp.points, 50).color).toBe('#bcbcbc'); // half the light
        expect(pointAt(kRamp.points, -10)).toEqual({ value: -10, color: '#000000', opacity: 0 });
        expect(pointAt(kRamp.points, 1000)).toMatchObject({ color: '#ffffff', opacity: 1 });
        expect(pointAt([], 1)).toMatchObject({ opacity: 0 });
        expect(gradientOf(kRamp.points, 0, 100, 3)).toEqual(['rgb(0 0 0)', 'rgb(188 188 188)', 'rgb(255 255 255)']);
    });

    it('gets points in order, in its own colour', () => {
        const { transfer, index } = addPoint(kRamp, 50, 2);
        expect(index).toBe(1);
        expect(transfer.points.map(({ value }) => value)).toEqual([0, 50, 100]);
        expect(transfer.points[1]).toMatchObject({ color: '#bcbcbc', opacity: 1 });
        expect(kRamp.points.length).toBe(2);
        expect(addPoint(kRamp, -5, 0).index).toBe(0);
        expect(addPoint(kRamp, 500, 0).index).toBe(2);
    });

    it('keeps points between their neighbours', () => {
        const three = addPoint(kRamp, 50, 0.5).transfer;
        expect(movePoint(three, 1, 300, -1).points[1]).toMatchObject({ value: 100, opacity: 0 });
        expect(movePoint(three, 1, -300, 0.25).points[1]).toMatchObject({ value: 0, opacity: 0.25 });
    });

    it('never becomes nothing, which the engine refuses', () => {
        const one = removePoint(kRamp, 0);
        expect(one.points.length).toBe(1);
        expect(removePoint(one, 0)).toEqual(one);
        const shaped = addShape(one, { ...kBox, center: [50, 5], size: [20, 4] }).transfer;
        const only = removePoint(shaped, 0);
        expect(only.points).toEqual([]);
        expect(removeShape(only, 0)).toEqual(only);
        expect(removeShape(shaped, 0).shapes).toEqual([]);
    });

    it('is written as the engine reads it', () => {
        expect(transferJson([kRamp])).toEqual({ window: 'none', points: kRamp.points });
        const shaped = changeShape(addShape(kRamp, { ...kBox, center: [50, 5], size: [20, 4] }).transfer, 0, { opacity: 0.25 });
        expect(transferJson([kRamp, shaped])).toEqual([
            { window: 'none', points: kRamp.points },
            { window: 'none', points: kRamp.points, shapes: [{ ...kBox, opacity: 0.25 }] },
        ]);
        expect(transferOf({ window: 'none', points: kRamp.points as never })).toEqual(kRamp);
        // The engine leaves out what is 0.
        expect(changePoint(kRamp, 1, { emission: 0 }).points[1]).toEqual({ value: 100, color: '#ffffff', opacity: 1 });
    });

    it('is told from other JSON', () => {
        for (const json of [{ points: [] }, { preset: 'grey' }, [{ shapes: [] }, 'grey']]) expect(isTransferJson(json)).toBe(true);
        for (const json of [null, 3, 'grey', [], {}, { apeiron: 1, subject: {} }, [3]]) expect(isTransferJson(json)).toBe(false);
    });

    it('has colours for pickers', () => {
        expect(hexOf('#12ab34')).toBe('#12ab34');
        expect(hexOf([1, 0.5, 0])).toBe('#ff8000');
    });

    it('shows small opacities large, and takes heights back', () => {
        expect(heightOf(0.01)).toBeCloseTo(0.1);
        for (const opacity of [0, 0.002, 0.3, 1]) expect(opacityAt(heightOf(opacity))).toBeCloseTo(opacity);
    });
});
