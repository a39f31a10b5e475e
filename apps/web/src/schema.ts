// From the engine's schema (`apeiron schema --json`) and a scene document to what a panel shows. Knows no parameter by name.

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonObject = { [key: string]: Json };
export type SceneDocument = JsonObject;

export type ParameterType =
    | 'bool' | 'int' | 'float' | 'vec2' | 'vec3' | 'vec4' | 'choice' | 'text' | 'decimal3' | 'module' | 'structure';

export interface Parameter {
    name: string;
    type: ParameterType;
    default: Json;
    min?: number;
    max?: number;
    step?: number;
    unit?: string;
    choices?: string[];
    folder?: string;
    invalidates: 'nothing' | 'present' | 'samples' | 'program';
    color?: boolean;
    logarithmic?: boolean;
    doc: string;
}

export interface NodeType {
    doc: string;
    parameters: Parameter[];
}

export interface Module extends NodeType {
    tags: { [key: string]: string };
}

export interface Schema {
    version: number;
    roles: { [role: string]: { list: boolean; types: { [type: string]: NodeType } } };
    modules: { [folder: string]: { [name: string]: Module } };
}

export type Widget =
    | { kind: 'toggle' }
    | { kind: 'slider'; scale: Scale; integer: boolean }
    | { kind: 'number'; integer: boolean; min: number | null; max: number | null; step: number }
    | { kind: 'vector'; size: number; min: number | null; max: number | null; step: number }
    | { kind: 'color' }
    | { kind: 'choice'; options: Option[] }
    | { kind: 'decimals' }
    | { kind: 'text' };

export interface Option {
    value: string;
    label: string;
    doc: string;
}

/** How a slider's position maps to values. */
export interface Scale {
    min: number;
    max: number;
    step: number;
    logarithmic: boolean;
}

/** One line of the panel. */
export interface Row {
    path: string;
    label: string;
    doc: string;
    unit: string;
    value: Json;
    /** Null where the schema does not say. */
    standard: Json;
    widget: Widget;
    /** Chooses a module or a type: the rows that follow depend on it. */
    structural: boolean;
}

/** Something with a list of parameters: a part of the scene, a light. */
export interface NodeView {
    path: string;
    title: string;
    doc: string;
    rows: Row[];
}

export interface Section {
    role: string;
    title: string;
    nodes: NodeView[];
    /** For lists: where an element goes and what can be added. */
    list: { path: string; key: string; options: Option[] } | null;
}

/** The order in which people think of a scene; roles that are new to this page come after. */
const kOrder = ['subject', 'slot', 'renderer', 'light', 'environment', 'post', 'effect', 'camera', 'output'];

/** Where the document keeps a role, if not under its name. */
const kPaths: { [role: string]: string } = { light: 'lights', effect: 'post.effects', slot: 'subject.slots' };

/** Written in capitals wherever they stand. */
const kAbbreviations = new Set(['ao', 'brdf', 'ct', 'fov', 'ggx', 'hdr', 'ibl', 'iso', 'lod', 'mip', 'mri', 'rgb', 'sh', 'srgb']);

/** "color_scale" to "Color scale". */
export function humanise(name: string): string {
    const words = name.split('_').filter((word) => word !== '');
    const written = words.map((word) => (kAbbreviations.has(word) ? word.toUpperCase() : word)).join(' ');
    return written.charAt(0).toUpperCase() + written.slice(1);
}

export function isObject(json: Json | undefined): json is JsonObject {
    return typeof json === 'object' && json !== null && !Array.isArray(json);
}

export function equal(a: Json, b: Json): boolean {
    if (a === b) return true;
    if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((v, i) => equal(v, b[i]!));
    if (!isObject(a) || !isObject(b)) return false;
    const keys = Object.keys(a);
    return keys.length === Object.keys(b).length && keys.every((key) => key in b && equal(a[key]!, b[key]!));
}

/** The value at a path such as `post.effects.0`. */
export function at(document: SceneDocument, path: string): Json | undefined {
    let here: Json | undefined = document;
    for (const key of path.split('.')) {
        if (Array.isArray(here)) here = here[Number(key)];
        else if (isObject(here)) here = here[key];
        else return undefined;
    }
    return here;
}

/** A name, or {name, source} of a user's own module. */
function moduleName(value: Json | undefined): string {
    if (isObject(value)) return String(value['name'] ?? '');
    return typeof value === 'string' ? value : '';
}

/** As it stands behind a number. */
export function unitSign(unit: string): string {
    return unit === 'deg' ? '°' : unit;
}

/** The first line of a doc text. */
export function brief(doc: string): string {
    return doc.split('\n')[0]!;
}

/** A step that makes about 200 to 500 stops of a range. */
export function stepOf(min: number, max: number): number {
    return 10 ** Math.floor(Math.log10((max - min) / 200));
}

/** Ranges that are too wide for a linear slider's few hundred positions. */
const kWidest = 1e4;

export function widgetOf(parameter: Parameter, schema: Schema): Widget {
    const { min = null, max = null } = parameter;
    const integer = parameter.type === 'int';
    const ranged = min !== null && max !== null && max > min;
    const step = parameter.step ?? (integer ? 1 : ranged ? stepOf(min, max) : 0.01);
    switch (parameter.type) {
        case 'bool':
            return { kind: 'toggle' };
        case 'structure':
            // Its texts are what is chosen from; whoever writes more of it has a document or an editor of its own.
        case 'choice':
            return {
                kind: 'choice',
                options: (parameter.choices ?? []).map((label) => ({ value: label, label: humanise(label), doc: '' })),
            };
        case 'module': {
            const modules = schema.modules[parameter.folder ?? ''] ?? {};
            return {
                kind: 'choice',
                options: Object.entries(modules).map(([name, module]) => ({
                    value: name,
                    label: humanise(name),
                    doc: brief(module.doc),
                })),
            };
        }
        case 'int':
        case 'float': {
            const logarithmic = parameter.logarithmic ?? false;
            if (ranged && (logarithmic || max - min <= kWidest)) {
                return { kind: 'slider', integer, scale: { min, max, step: logarithmic && !integer ? 0 : step, logarithmic } };
            }
            return { kind: 'number', integer, min, max, step };
        }
        case 'vec3':
            if (parameter.color) return { kind: 'color' };
            return { kind: 'vector', size: 3, min, max, step };
        case 'vec2':
            return { kind: 'vector', size: 2, min, max, step };
        case 'vec4':
            return { kind: 'vector', size: 4, min, max, step };
        case 'decimal3':
            return { kind: 'decimals' };
        case 'text':
            return { kind: 'text' };
    }
}

/** The schema with further modules, such as a formula that travels inside the document. */
export function withModules(schema: Schema, modules: Schema['modules']): Schema {
    const all = { ...schema.modules };
    for (const [folder, own] of Object.entries(modules)) all[folder] = { ...all[folder], ...own };
    return { ...schema, modules: all };
}

/** For parameters that the schema does not know. */
function widgetOfValue(value: Json): Widget {
    if (typeof value === 'boolean') return { kind: 'toggle' };
    if (typeof value === 'number') return { kind: 'number', integer: false, min: null, max: null, step: 0.01 };
    if (Array.isArray(value) && value.every((v) => typeof v === 'number')) {
        return { kind: 'vector', size: value.length, min: null, max: null, step: 0.01 };
    }
    return { kind: 'text' };
}

/** A logarithmic scale from 0 begins here, relative to its end. */
const kLogSpan = 1e-5;

/** @param position 0..1 along the slider */
export function valueAt(scale: Scale, position: number): number {
    const t = Math.min(Math.max(position, 0), 1);
    if (!scale.logarithmic) return snap(scale, scale.min + t * (scale.max - scale.min));
    if (t === 0) return scale.min;
    if (t === 1) return scale.max;
    const from = scale.min > 0 ? scale.min : kLogSpan * scale.max;
    return snap(scale, from * (scale.max / from) ** t);
}

export function positionOf(scale: Scale, value: number): number {
    const v = Math.min(Math.max(value, scale.min), scale.max);
    if (!scale.logarithmic) return (v - scale.min) / (scale.max - scale.min);
    const from = scale.min > 0 ? scale.min : kLogSpan * scale.max;
    return v <= from ? 0 : Math.log(v / from) / Math.log(scale.max / from);
}

/** To the scale's step, counted from 0; without one to three significant digits. Always within the range. */
export function snap(scale: Scale, value: number): number {
    const snapped =
        scale.step > 0 ? Number((Math.round(value / scale.step) * scale.step).toPrecision(12)) : Number(value.toPrecision(3));
    return Math.min(Math.max(snapped, scale.min), scale.max);
}

/** A number as short as it says the same to a person. */
export function format(value: number): string {
    if (!Number.isFinite(value)) return String(value);
    return String(Number(value.toPrecision(6)));
}

/** The type's parameters, each module's right after what chooses it; then whatever else the document has. */
function rowsOf(schema: Schema, type: NodeType, node: JsonObject, path: string, structural: string | null): Row[] {
    const rows: Row[] = [];
    const seen = new Set<string>(structural === null ? [] : [structural]);
    const add = (parameter: Parameter) => {
        if (seen.has(parameter.name) || !(parameter.name in node)) return;
        seen.add(parameter.name);
        const raw = node[parameter.name]!;
        const widget = widgetOf(parameter, schema);
        const isModule = parameter.type === 'module';
        const value = isModule ? moduleName(raw) : raw;
        if (isObject(raw) && widget.kind === 'choice') {
            // Another of that name is not meant; choosing it again means the engine's own.
            const others = widget.options.filter((option) => option.value !== value);
            widget.options = [...others, { value: String(value), label: `${String(value)} (own)`, doc: '' }];
        }
        rows.push({
            path: `${path}.${parameter.name}`,
            label: humanise(parameter.name),
            doc: parameter.doc,
            unit: parameter.unit ?? '',
            value,
            standard: parameter.default,
            widget,
            structural: isModule,
        });
        if (isModule) schema.modules[parameter.folder ?? '']?.[String(value)]?.parameters.forEach(add);
    };
    type.parameters.forEach(add);
    const lists = new Set(Object.values(kPaths)); // sections of their own
    for (const [name, value] of Object.entries(node)) {
        if (seen.has(name) || lists.has(`${path}.${name}`)) continue;
        rows.push({
            path: `${path}.${name}`,
            label: humanise(name),
            doc: '',
            unit: '',
            value,
            standard: null,
            widget: widgetOfValue(value),
            structural: false,
        });
    }
    return rows;
}

function nodeView(schema: Schema, role: string, node: JsonObject, path: string): NodeView | null {
    const types = schema.roles[role]!.types;
    const names = Object.keys(types);
    const typed = !names.includes('');
    const typeName = typed ? moduleName(node['type']) || names[0]! : '';
    const type = types[typeName];
    if (!type) return null;
    const rows = rowsOf(schema, type, node, path, typed ? 'type' : null);
    if (typed && names.length > 1) {
        rows.unshift({
            path: `${path}.type`,
            label: 'Type',
            doc: type.doc,
            unit: '',
            value: typeName,
            standard: null,
            widget: {
                kind: 'choice',
                options: names.map((name) => ({ value: name, label: humanise(name), doc: brief(types[name]!.doc) })),
            },
            structural: true,
        });
    }
    return { path, title: humanise(typeName || role), doc: type.doc, rows };
}

function optionsOf(schema: Schema, role: string): { key: string; options: Option[] } {
    const types = schema.roles[role]!.types;
    const single = types[''];
    if (!single) {
        const options = Object.entries(types).map(([name, type]) => ({ value: name, label: humanise(name), doc: brief(type.doc) }));
        return { key: 'type', options };
    }
    const chooser = single.parameters.find((parameter) => parameter.type === 'module');
    const widget = chooser && widgetOf(chooser, schema);
    return { key: chooser?.name ?? 'type', options: widget?.kind === 'choice' ? widget.options : [] };
}

/**
 * The whole panel.
 * @param document with all parameters, also those at their defaults
 * @param hidden paths that something else than the panel decides
 */
export function sectionsOf(schema: Schema, document: SceneDocument, hidden: ReadonlySet<string> = new Set()): Section[] {
    const rank = (role: string) => (kOrder.includes(role) ? kOrder.indexOf(role) : kOrder.length);
    const roles = Object.keys(schema.roles).sort((a, b) => rank(a) - rank(b));
    return roles.map((role) => {
        const path = kPaths[role] ?? role;
        const { list } = schema.roles[role]!;
        const value = at(document, path);
        const elements = list ? (Array.isArray(value) ? value : []) : [value];
        const nodes = elements.flatMap((element, index) => {
            if (!isObject(element)) return [];
            const view = nodeView(schema, role, element, list ? `${path}.${index}` : path);
            if (!view) return [];
            view.rows = view.rows.filter((row) => !hidden.has(row.path));
            if (list) {
                // Its type stands in its title and is chosen when it is added.
                const chooser = view.rows.find((row) => row.structural);
                if (chooser) {
                    view.title = humanise(String(chooser.value));
                    view.rows = view.rows.filter((row) => row !== chooser);
                }
            }
            return [view];
        });
        return {
            role,
            title: humanise(list ? `${role}s` : role),
            nodes,
            list: list ? { path, ...optionsOf(schema, role) } : null,
        };
    });
}

/** Two panels with the same key differ in values only. */
export function structureOf(sections: Section[]): string {
    return JSON.stringify(
        sections.map((section) => [
            section.role,
            section.nodes.map((node) => [
                node.path,
                node.title,
                node.rows.map((row) => [row.path, row.widget.kind, row.structural ? row.value : null]),
            ]),
        ]),
    );
}
