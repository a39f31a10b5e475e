import { describe, expect, it } from 'vitest';
import {
    at,
    equal,
    format,
    humanise,
    positionOf,
    sectionsOf,
    snap,
    structureOf,
    valueAt,
    widgetOf,
    withModules,
    type Parameter,
    type Scale,
    type SceneDocument,
    type Schema,
} from '../../src/schema';

function parameter(given: Partial<Parameter> & Pick<Parameter, 'name' | 'type'>): Parameter {
    return { default: 0, invalidates: 'samples', doc: 'What it is', ...given };
}

const schema: Schema = {
    version: 1,
    roles: {
        camera: { list: false, types: { '': { doc: '', parameters: [parameter({ name: 'fov', type: 'float', min: 1, max: 150 })] } } },
        subject: {
            list: false,
            types: {
                fractal: {
                    doc: '',
                    parameters: [
                        parameter({ name: 'formula', type: 'module', folder: 'formulas', default: 'bulb' }),
                        parameter({ name: 'detail', type: 'float', min: 0.05, max: 20, logarithmic: true, default: 1 }),
                    ],
                },
            },
        },
        light: {
            list: true,
            types: {
                sun: { doc: 'Far away', parameters: [parameter({ name: 'azimuth', type: 'float', min: -360, max: 360 })] },
                point: { doc: 'Near', parameters: [parameter({ name: 'radius', type: 'float' })] },
            },
        },
        effect: {
            list: true,
            types: { '': { doc: '', parameters: [parameter({ name: 'type', type: 'module', folder: 'effects', default: 'bloom' })] } },
        },
        slot: {
            list: true,
            types: { '': { doc: '', parameters: [parameter({ name: 'formula', type: 'module', folder: 'formulas', default: 'bulb' })] } },
        },
        future: { list: false, types: { '': { doc: '', parameters: [parameter({ name: 'unheard_of', type: 'bool' })] } } },
    },
    modules: {
        formulas: {
            bulb: { doc: 'A bulb\nMore of it', tags: {}, parameters: [parameter({ name: 'power', type: 'float', min: 2, max: 16, step: 0.1, default: 8 })] },
            box: { doc: 'A box', tags: {}, parameters: [parameter({ name: 'fold', type: 'float' })] },
        },
        effects: { bloom: { doc: '', tags: {}, parameters: [parameter({ name: 'strength', type: 'float' })] } },
    },
};

const scene: SceneDocument = {
    apeiron: 1,
    camera: { fov: 40 },
    subject: { type: 'fractal', formula: 'bulb', detail: 2, power: 8, slots: [{ formula: 'box', fold: 1 }] },
    lights: [{ type: 'point', radius: 1 }, { type: 'sun', azimuth: 10 }],
    post: { effects: [{ type: 'bloom', strength: 0.5 }] },
    future: { unheard_of: true },
};

describe('widgets', () => {
    const widget = (given: Partial<Parameter> & Pick<Parameter, 'type'>) => widgetOf(parameter({ name: 'x', ...given }), schema);

    it('follow from type, range and hints', () => {
        expect(widget({ type: 'bool' }).kind).toBe('toggle');
        expect(widget({ type: 'float', min: 0, max: 1 }).kind).toBe('slider');
        expect(widget({ type: 'float' }).kind).toBe('number');
        expect(widget({ type: 'int', min: 0, max: 4294967295 }).kind).toBe('number');
        expect(widget({ type: 'int', min: 1, max: 1e7, logarithmic: true }).kind).toBe('slider');
        expect(widget({ type: 'vec3' })).toMatchObject({ kind: 'vector', size: 3 });
        expect(widget({ type: 'vec3', color: true }).kind).toBe('color');
        expect(widget({ type: 'vec4' })).toMatchObject({ kind: 'vector', size: 4 });
        expect(widget({ type: 'decimal3' }).kind).toBe('decimals');
        expect(widget({ type: 'text' }).kind).toBe('text');
    });

    it('offer the labels of choices and the modules of a folder', () => {
        expect(widget({ type: 'choice', choices: ['box', 'fine_tent'] })).toMatchObject({
            options: [{ value: 'box', label: 'Box' }, { value: 'fine_tent', label: 'Fine tent' }],
        });
        expect(widget({ type: 'module', folder: 'formulas' })).toMatchObject({
            options: [{ value: 'bulb', doc: 'A bulb' }, { value: 'box', doc: 'A box' }],
        });
    });

    it('take the declared step, whole numbers for integers, and a fine one otherwise', () => {
        expect(widget({ type: 'float', min: 2, max: 16, step: 0.1 })).toMatchObject({ scale: { step: 0.1 } });
        expect(widget({ type: 'int', min: 1, max: 60 })).toMatchObject({ integer: true, scale: { step: 1 } });
        expect(widget({ type: 'float', min: 0, max: 1 })).toMatchObject({ scale: { step: 0.001 } });
    });
});

describe('slider scales', () => {
    const linear: Scale = { min: -180, max: 180, step: 0.5, logarithmic: false };
    const logarithmic: Scale = { min: 0.05, max: 20, step: 0, logarithmic: true };
    const fromZero: Scale = { min: 0, max: 1000, step: 0, logarithmic: true };

    it('reach both ends exactly', () => {
        for (const scale of [linear, logarithmic, fromZero]) {
            expect(valueAt(scale, 0)).toBe(scale.min);
            expect(valueAt(scale, 1)).toBe(scale.max);
            expect(positionOf(scale, scale.min)).toBe(0);
            expect(positionOf(scale, scale.max)).toBe(1);
        }
    });

    it('map there and back', () => {
        for (const [scale, value] of [[linear, 12.5], [logarithmic, 1], [fromZero, 3]] as const) {
            expect(valueAt(scale, positionOf(scale, value))).toBeCloseTo(value, 9);
        }
    });

    it('give each decade of a logarithmic scale the same room', () => {
        const decade = positionOf(fromZero, 100) - positionOf(fromZero, 10);
        expect(positionOf(fromZero, 10) - positionOf(fromZero, 1)).toBeCloseTo(decade, 9);
    });

    it('snap to steps without the dust of binary fractions', () => {
        expect(snap({ min: 0, max: 1, step: 0.1, logarithmic: false }, 0.30000001)).toBe(0.3);
        expect(snap(linear, 1000)).toBe(180);
        expect(format(0.1 + 0.2)).toBe('0.3');
    });
});

describe('sections', () => {
    const sections = sectionsOf(schema, scene);
    const find = (role: string) => sections.find((section) => section.role === role)!;

    it('come in the order of thought, with new roles last', () => {
        expect(sections.map((section) => section.role)).toEqual(['subject', 'slot', 'light', 'effect', 'camera', 'future']);
        expect(find('future').nodes[0]!.rows[0]).toMatchObject({ path: 'future.unheard_of', label: 'Unheard of' });
    });

    it("put a module's parameters right after what chooses it", () => {
        expect(find('subject').nodes[0]!.rows.map((row) => row.path)).toEqual(['subject.formula', 'subject.power', 'subject.detail']);
    });

    it('address the nodes of lists and know what can be added', () => {
        expect(find('light').nodes.map((node) => [node.path, node.title])).toEqual([['lights.0', 'Point'], ['lights.1', 'Sun']]);
        expect(find('light').list).toMatchObject({ path: 'lights', key: 'type', options: [{ value: 'sun' }, { value: 'point' }] });
        expect(find('effect').nodes[0]).toMatchObject({ path: 'post.effects.0', title: 'Bloom' });
        expect(find('effect').nodes[0]!.rows.map((row) => row.path)).toEqual(['post.effects.0.strength']);
        expect(find('slot').list).toMatchObject({ path: 'subject.slots', key: 'formula', options: [{ value: 'bulb' }, { value: 'box' }] });
        expect(find('slot').nodes[0]).toMatchObject({ path: 'subject.slots.0', title: 'Box' });
    });

    it('do not show a list among the parameters of what has it, even an empty one', () => {
        const none = { ...scene, subject: { type: 'fractal', formula: 'bulb', detail: 1, power: 8, slots: [] } };
        const [view] = sectionsOf(schema, none).find((section) => section.role === 'subject')!.nodes;
        expect(view!.rows.map((row) => row.path)).toEqual(['subject.formula', 'subject.power', 'subject.detail']);
    });

    it("show a user's own formula like any other", () => {
        const own = { ...scene, subject: { type: 'fractal', formula: { name: 'mine', source: '...' }, detail: 1, twist: 0.2, odd: 3 } };
        const twist = parameter({ name: 'twist', type: 'float', min: 0, max: 1, default: 0 });
        const known = withModules(schema, { formulas: { mine: { doc: 'Mine', tags: {}, parameters: [twist] } } });
        const [view] = sectionsOf(known, own).find((section) => section.role === 'subject')!.nodes;
        expect(view!.rows[0]).toMatchObject({ value: 'mine', widget: { options: [{}, {}, { value: 'mine', label: 'mine (own)' }] } });
        expect(view!.rows[1]).toMatchObject({ path: 'subject.twist', value: 0.2, widget: { kind: 'slider' } });
        // Even what no schema knows can be edited.
        expect(view!.rows.at(-1)).toMatchObject({ path: 'subject.odd', widget: { kind: 'number' }, standard: null });
        expect(Object.keys(schema.modules['formulas']!)).toEqual(['bulb', 'box']);
    });

    it('leave out what something else decides', () => {
        const hidden = sectionsOf(schema, scene, new Set(['camera.fov']));
        expect(hidden.find((section) => section.role === 'camera')!.nodes[0]!.rows).toEqual([]);
    });

    it('keep their structure when only values change', () => {
        const moved = { ...scene, camera: { fov: 20 } };
        expect(structureOf(sectionsOf(schema, moved))).toBe(structureOf(sections));
        const other = { ...scene, subject: { type: 'fractal', formula: 'box', detail: 2, fold: 1 } };
        expect(structureOf(sectionsOf(schema, other))).not.toBe(structureOf(sections));
    });
});

describe('values', () => {
    it('are found by path', () => {
        expect(at(scene, 'lights.1.azimuth')).toBe(10);
        expect(at(scene, 'lights.7.azimuth')).toBeUndefined();
    });

    it('are compared by content', () => {
        expect(equal([1, [2]], [1, [2]])).toBe(true);
        expect(equal({ a: 1, b: 2 }, { b: 2, a: 1 })).toBe(true);
        expect(equal([1, 2], [1])).toBe(false);
        expect(equal(null, {})).toBe(false);
    });

    it('have names for people', () => {
        expect(humanise('color_scale')).toBe('Color scale');
        expect(humanise('brdf')).toBe('BRDF');
    });
});
