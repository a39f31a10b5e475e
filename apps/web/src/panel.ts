// The panel: built from the schema alone, one line per parameter.
import { hexFromLinear, linearFromHex, type Rgb } from './color';
import { icon, kCross, kDown, kReset, kUp, make } from './dom';
import {
    brief,
    equal,
    format,
    humanise,
    positionOf,
    sectionsOf,
    snap,
    structureOf,
    unitSign,
    withModules,
    valueAt,
    type Json,
    type NodeView,
    type Row,
    type SceneDocument,
    type Schema,
    type Section,
    type Widget,
} from './schema';

export interface PanelHost {
    /** `live`: more such edits follow. */
    set(path: string, value: Json, live: boolean): void;
}

/** A parameter's control. */
interface Editor {
    element: HTMLElement;
    /** What the label belongs to. */
    focusable: HTMLElement | null;
    /** Shows a value that was not made here. */
    show(value: Json): void;
}

type Send = (value: Json, live: boolean) => void;

const kSliderStops = 1000;
const kOpenKey = 'apeiron.sections';
const kOpenFirst = ['subject', 'light', 'post'];
/** Choices of so few, short labels are shown side by side. */
const kSegments = 3;
const kSegmentLetters = 24;

let nextId = 0;
const newId = () => `p${++nextId}`;

/** A text field that sends on Enter and on leaving, steps with the arrow keys, and takes back what is no number. */
function numberField(label: string, step: (value: number, direction: number) => number, send: Send): {
    input: HTMLInputElement;
    show: (value: number) => void;
} {
    const input = make('input', { type: 'text', inputmode: 'decimal', class: 'field number', autocomplete: 'off', 'aria-label': label });
    let shown = '';
    let dirty = false;
    const show = (value: number) => {
        shown = format(value);
        if (!dirty) input.value = shown;
    };
    const commit = () => {
        dirty = false;
        const value = Number(input.value.trim().replace(',', '.'));
        if (input.value.trim() === '' || !Number.isFinite(value)) input.value = shown;
        else if (format(value) !== shown) send(value, false);
        else input.value = shown;
    };
    input.addEventListener('input', () => (dirty = true));
    input.addEventListener('change', commit);
    input.addEventListener('focus', () => input.select());
    input.addEventListener('keydown', (event) => {
        if (event.key === 'Escape') {
            dirty = false;
            input.value = shown;
            input.blur();
        }
        if (event.key === 'Enter') commit();
        if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
        event.preventDefault();
        const value = step(Number(input.value) || 0, event.key === 'ArrowUp' ? 1 : -1);
        dirty = false;
        input.value = format(value);
        send(value, false);
    });
    return { input, show };
}

function limited(value: number, min: number | null, max: number | null): number {
    return Math.min(Math.max(value, min ?? -Infinity), max ?? Infinity);
}

function stepped(step: number, min: number | null, max: number | null) {
    return (value: number, direction: number) => limited(Number((value + direction * step).toPrecision(12)), min, max);
}

function sliderEditor(row: Row, { scale, integer }: Widget & { kind: 'slider' }, send: Send): Editor {
    const id = newId();
    const slider = make('input', { type: 'range', id, min: 0, max: kSliderStops, step: 1 });
    const step = (value: number, direction: number) => {
        if (scale.step > 0 && !scale.logarithmic) return snap(scale, value + direction * scale.step);
        const next = valueAt(scale, positionOf(scale, value) + direction * 0.01);
        return integer && next === value ? limited(value + direction, scale.min, scale.max) : next;
    };
    const field = numberField(row.label, step, send);
    let value = scale.min;
    const place = (next: number) => {
        value = next;
        const position = positionOf(scale, next);
        slider.value = String(Math.round(kSliderStops * position));
        slider.style.setProperty('--fill', `${100 * position}%`);
        slider.setAttribute('aria-valuetext', `${format(next)}${unitSign(row.unit)}`);
        field.show(next);
    };
    let dragging = false;
    slider.addEventListener('input', () => {
        dragging = true;
        place(valueAt(scale, Number(slider.value) / kSliderStops));
        send(value, true);
    });
    slider.addEventListener('change', () => {
        dragging = false;
        send(value, false);
    });
    slider.addEventListener('keydown', (event) => {
        const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
        if (direction === undefined) return;
        event.preventDefault();
        place(step(value, direction));
        send(value, false);
    });
    const element = make('div', { class: 'slider' }, slider, field.input);
    if (row.unit) element.append(make('span', { class: 'unit' }, unitSign(row.unit)));
    return {
        element,
        focusable: slider,
        show: (next) => {
            if (!dragging && typeof next === 'number') place(next);
        },
    };
}

function numberEditor(row: Row, widget: Widget & { kind: 'number' }, send: Send): Editor {
    const field = numberField(row.label, stepped(widget.step, widget.min, widget.max), send);
    field.input.id = newId();
    const element = make('div', { class: 'numbers' }, field.input);
    if (row.unit) element.append(make('span', { class: 'unit' }, unitSign(row.unit)));
    return { element, focusable: field.input, show: (value) => typeof value === 'number' && field.show(value) };
}

function vectorEditor(row: Row, widget: Widget & { kind: 'vector' }, send: Send): Editor {
    let current: number[] = [];
    const fields = Array.from({ length: widget.size }, (_, index) =>
        numberField(`${row.label} ${'xyzw'[index] ?? index}`, stepped(widget.step, widget.min, widget.max), (value, live) => {
            send(current.map((old, i) => (i === index ? Number(value) : old)), live);
        }),
    );
    const element = make('div', { class: 'numbers' }, ...fields.map((field) => field.input));
    return {
        element,
        focusable: null,
        show: (value) => {
            if (!Array.isArray(value)) return;
            current = value.map(Number);
            fields.forEach((field, index) => field.show(current[index] ?? 0));
        },
    };
}

function colorEditor(row: Row, send: Send): Editor {
    const picker = make('input', { type: 'color', id: newId(), class: 'swatch' });
    const text = make('input', { type: 'text', class: 'field hex', 'aria-label': `${row.label}, hexadecimal`, spellcheck: 'false', autocomplete: 'off' });
    let shown = '#000000';
    const place = (hex: string) => {
        shown = hex;
        picker.value = hex;
        text.value = hex;
    };
    const pick = (live: boolean) => {
        const color = linearFromHex(picker.value);
        text.value = picker.value;
        // Opening and closing the picker is no edit.
        if (color && (live || picker.value !== shown)) send([...color], live);
        if (color) shown = picker.value;
    };
    picker.addEventListener('input', () => pick(true));
    picker.addEventListener('change', () => {
        const color = linearFromHex(picker.value);
        if (color) send([...color], false);
    });
    text.addEventListener('change', () => {
        const color = linearFromHex(text.value);
        if (!color) text.value = shown;
        else if (hexFromLinear(color) !== shown) send([...color], false);
    });
    text.addEventListener('focus', () => text.select());
    return {
        element: make('div', { class: 'color' }, picker, text),
        focusable: picker,
        show: (value) => {
            if (Array.isArray(value) && document.activeElement !== text) place(hexFromLinear(value.map(Number) as unknown as Rgb));
        },
    };
}

function toggleEditor(send: Send): Editor {
    const input = make('input', { type: 'checkbox', role: 'switch', class: 'switch', id: newId() });
    input.addEventListener('change', () => send(input.checked, false));
    return { element: make('div', { class: 'toggle' }, input), focusable: input, show: (value) => (input.checked = value === true) };
}

function choiceEditor(row: Row, widget: Widget & { kind: 'choice' }, send: Send): Editor {
    const letters = widget.options.reduce((sum, option) => sum + option.label.length, 0);
    if (widget.options.length <= kSegments && letters <= kSegmentLetters && widget.options.length > 1) {
        const name = newId();
        const radios = widget.options.map((option) => {
            const radio = make('input', { type: 'radio', name, value: option.value });
            radio.addEventListener('change', () => send(option.value, false));
            return radio;
        });
        const labels = radios.map((radio, index) => {
            const option = widget.options[index]!;
            return make('label', { 'data-tip': option.doc || undefined }, radio, make('span', {}, option.label));
        });
        return {
            element: make('div', { class: 'segments', role: 'radiogroup', 'aria-label': row.label }, ...labels),
            focusable: null,
            show: (value) => radios.forEach((radio) => (radio.checked = radio.value === value)),
        };
    }
    const select = make('select', { class: 'select', id: newId() });
    for (const option of widget.options) select.append(make('option', { value: option.value, title: option.doc }, option.label));
    select.addEventListener('change', () => send(select.value, false));
    return { element: select, focusable: select, show: (value) => (select.value = String(value)) };
}

function textField(label: string, send: (text: string) => void): { input: HTMLInputElement; show: (text: string) => void } {
    const input = make('input', { type: 'text', class: 'field', spellcheck: 'false', autocomplete: 'off', 'aria-label': label });
    let shown = '';
    input.addEventListener('change', () => input.value !== shown && send(input.value));
    input.addEventListener('keydown', (event) => {
        if (event.key !== 'Escape') return;
        input.value = shown;
        input.blur();
    });
    return {
        input,
        show: (text) => {
            if (document.activeElement !== input || input.value === shown) input.value = text;
            shown = text;
        },
    };
}

function decimalsEditor(row: Row, send: Send): Editor {
    let current: string[] = [];
    const fields = ['x', 'y', 'z'].map((axis, index) =>
        textField(`${row.label} ${axis}`, (text) => send(current.map((old, i) => (i === index ? text.trim() : old)), false)),
    );
    const lines = fields.map((field, index) => make('label', {}, make('span', { class: 'axis' }, 'xyz'[index]!), field.input));
    return {
        element: make('div', { class: 'decimals' }, ...lines),
        focusable: null,
        show: (value) => {
            if (!Array.isArray(value)) return;
            current = value.map(String);
            fields.forEach((field, index) => field.show(current[index] ?? '0'));
        },
    };
}

function textEditor(row: Row, send: Send): Editor {
    const field = textField(row.label, (text) => send(text, false));
    field.input.id = newId();
    return { element: field.input, focusable: field.input, show: (value) => field.show(String(value)) };
}

function editorOf(row: Row, send: Send): Editor {
    switch (row.widget.kind) {
        case 'slider':
            return sliderEditor(row, row.widget, send);
        case 'number':
            return numberEditor(row, row.widget, send);
        case 'vector':
            return vectorEditor(row, row.widget, send);
        case 'color':
            return colorEditor(row, send);
        case 'toggle':
            return toggleEditor(send);
        case 'choice':
            return choiceEditor(row, row.widget, send);
        case 'decimals':
            return decimalsEditor(row, send);
        case 'text':
            return textEditor(row, send);
    }
}

class RowView {
    readonly element: HTMLElement;
    private readonly editor: Editor;
    private row: Row;

    constructor(row: Row, host: PanelHost) {
        this.row = row;
        this.editor = editorOf(row, (value, live) => host.set(this.row.path, value, live));
        const label = make('label', { class: 'label', 'data-tip': row.doc ? brief(row.doc) : undefined }, row.label);
        if (this.editor.focusable) {
            label.htmlFor = this.editor.focusable.id;
            if (row.doc) this.editor.focusable.dataset['tip'] = brief(row.doc);
        }
        const back = make('button', { type: 'button', class: 'back', 'aria-label': `${row.label}: back to the default` }, icon(kReset));
        back.addEventListener('click', () => host.set(this.row.path, this.row.standard, false));
        this.element = make('div', { class: `row of-${row.widget.kind}` }, make('div', { class: 'name' }, label, back), this.editor.element);
        this.show(row);
    }

    show(row: Row): void {
        this.row = row;
        this.editor.show(row.value);
        const changed = !row.structural && row.standard !== null && !equal(row.value, row.standard);
        this.element.classList.toggle('changed', changed);
    }
}

export class Panel {
    private structure = '';
    private rows: RowView[] = [];
    private document: SceneDocument | null = null;
    private readonly open: Set<string>;

    /** @param lead what the page puts first @param extra what it adds below */
    constructor(
        private readonly root: HTMLElement,
        private readonly schema: Schema,
        private readonly host: PanelHost,
        private readonly hidden: ReadonlySet<string>,
        private readonly lead: HTMLElement,
        private readonly extra: HTMLElement,
    ) {
        this.open = new Set(readOpen());
    }

    /** @param modules those whose source the document holds */
    show(document: SceneDocument, modules: Schema['modules']): void {
        const sections = sectionsOf(withModules(this.schema, modules), document, this.hidden);
        const structure = structureOf(sections);
        this.document = document;
        if (structure === this.structure) {
            const rows = sections.flatMap((section) => section.nodes.flatMap((node) => node.rows));
            rows.forEach((row, index) => this.rows[index]?.show(row));
            return;
        }
        this.structure = structure;
        this.rows = [];
        const scroll = this.root.scrollTop;
        // The control that caused it keeps the focus.
        const focused = this.root.contains(globalThis.document.activeElement) ? focusPath(this.root) : null;
        this.root.replaceChildren(this.lead, ...sections.map((section) => this.sectionElement(section)), this.extra);
        this.root.scrollTop = scroll;
        if (focused) restoreFocus(this.root, focused);
    }

    private sectionElement(section: Section): HTMLElement {
        const summary = make('summary', {}, section.title);
        if (section.list && section.nodes.length > 0) summary.append(make('span', { class: 'count' }, String(section.nodes.length)));
        const element = make('details', { class: 'section', 'data-role': section.role, open: this.open.has(section.role) }, summary);
        element.addEventListener('toggle', () => {
            if (element.open) this.open.add(section.role);
            else this.open.delete(section.role);
            writeOpen([...this.open]);
        });
        section.nodes.forEach((node, index) => element.append(this.nodeElement(section, node, index)));
        if (section.list) element.append(this.addElement(section));
        else if (section.nodes.every((node) => node.rows.length === 0)) element.hidden = true;
        return element;
    }

    private nodeElement(section: Section, node: NodeView, index: number): HTMLElement {
        const rows = node.rows.map((row) => {
            const view = new RowView(row, this.host);
            this.rows.push(view);
            view.element.dataset['path'] = row.path;
            return view.element;
        });
        if (!section.list) return make('div', { class: 'node' }, ...rows);
        const { path } = section.list;
        const button = (label: string, shape: string, act: () => void, disabled = false) => {
            const element = make('button', { type: 'button', class: 'button icon small', 'aria-label': label, 'data-tip': label, disabled }, icon(shape));
            element.addEventListener('click', act);
            return element;
        };
        const head = make('div', { class: 'head' }, make('h3', { 'data-tip': brief(node.doc) || undefined }, node.title));
        if (section.nodes.length > 1) {
            head.append(
                button('Move up', kUp, () => this.swap(path, index, index - 1), index === 0),
                button('Move down', kDown, () => this.swap(path, index, index + 1), index === section.nodes.length - 1),
            );
        }
        head.append(button('Remove', kCross, () => this.host.set(node.path, null, false)));
        return make('div', { class: 'node card' }, head, ...rows);
    }

    private addElement(section: Section): HTMLElement {
        const { path, key, options } = section.list!;
        const buttons = options.map((option) => {
            const element = make('button', { type: 'button', class: 'chip', 'data-tip': option.doc || undefined }, option.label);
            element.addEventListener('click', () => this.host.set(`${path}.${section.nodes.length}.${key}`, option.value, false));
            return element;
        });
        return make('div', { class: 'add', role: 'group', 'aria-label': `Add ${humanise(section.role).toLowerCase()}` }, make('span', {}, 'Add'), ...buttons);
    }

    private swap(path: string, a: number, b: number): void {
        const list = path.split('.').reduce<Json>((here, key) => (here as { [key: string]: Json })[key]!, this.document!);
        if (!Array.isArray(list)) return;
        const changed = [...list];
        [changed[a], changed[b]] = [changed[b]!, changed[a]!];
        this.host.set(path, changed, false);
    }
}

/** Which control of which row has the focus. */
function focusPath(root: HTMLElement): { path: string; index: number } | null {
    const active = root.ownerDocument.activeElement as HTMLElement;
    const row = active.closest<HTMLElement>('[data-path]');
    if (!row) return null;
    return { path: row.dataset['path']!, index: controlsOf(row).indexOf(active) };
}

function restoreFocus(root: HTMLElement, { path, index }: { path: string; index: number }): void {
    const row = root.querySelector<HTMLElement>(`[data-path="${CSS.escape(path)}"]`);
    if (row) controlsOf(row)[index]?.focus({ preventScroll: true });
}

function controlsOf(row: HTMLElement): HTMLElement[] {
    return [...row.querySelectorAll<HTMLElement>('input, select, button')];
}

// Storage may be refused: then sections just open as at first.
function readOpen(): string[] {
    try {
        const stored: unknown = JSON.parse(localStorage.getItem(kOpenKey) ?? 'null');
        if (Array.isArray(stored)) return stored.map(String);
    } catch {
        // As at first.
    }
    return kOpenFirst;
}

function writeOpen(open: string[]): void {
    try {
        localStorage.setItem(kOpenKey, JSON.stringify(open));
    } catch {
        // As at first.
    }
}
