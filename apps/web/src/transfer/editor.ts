// The editor of transfer functions: opacity and colour along the value over the volume's histogram, and shapes over value and
// gradient magnitude. What it shows comes from the engine, and every edit goes there.
import { make } from '../dom';
import { format, humanise, type Json } from '../schema';
import {
    addPoint, addShape, changePoint, changeShape, clamp, gradientOf, heightOf, hexOf, isTransferJson, movePoint, opacityAt, pointAt, removePoint,
    removeShape, transferJson, transferOf, type HistogramInfo, type ShapeType, type Transfer, type TransferShape, type VolumeInfo,
} from './transfer';

export interface TransferHost {
    /** `live`: more such edits follow. */
    set(transfer: Json, live: boolean): void;
    histogram(channel: number, values: number, gradients: number): Promise<HistogramInfo | null>;
    save(text: string): void;
    failed(error: unknown): void;
}

const kWidth = 300;
const kHeight = 132;
/** Classes of the histograms. */
const kValues = 150;
const kSquare = 100;
const kRadius = 5;
const kSvg = 'http://www.w3.org/2000/svg';

function svg(tag: string, attributes: { [name: string]: string | number }): SVGElement {
    const element = document.createElementNS(kSvg, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
    return element;
}

export class TransferEditor {
    readonly element: HTMLElement;
    private info: VolumeInfo | null = null;
    private transfers: Transfer[] = [];
    private channel = 0;
    private square = false;
    private selected = 0;
    private dragging = false;
    private histograms = new Map<string, HistogramInfo>();
    private readonly preset: HTMLSelectElement;
    private readonly channels = make('select', { class: 'select', 'aria-label': 'Channel' });
    private readonly back = make('canvas', { width: kWidth, height: kHeight });
    private readonly front = svg('svg', { viewBox: `0 0 ${kWidth} ${kHeight}`, class: 'transfer-front', tabindex: 0, role: 'application' }) as SVGSVGElement;
    private readonly bar = make('div', { class: 'transfer-bar' });
    private readonly axis = make('div', { class: 'transfer-axis' });
    private readonly details = make('div', { class: 'transfer-details' });
    private readonly tabs: HTMLInputElement[];

    /** @param presets names that the engine knows */
    constructor(presets: readonly string[], private readonly host: TransferHost) {
        this.preset = make('select', { class: 'select', id: 'transfer-preset', 'aria-label': 'Preset' });
        this.preset.append(make('option', { value: '', hidden: true }, 'Own'), ...presets.map((name) => make('option', { value: name }, humanise(name))));
        this.preset.addEventListener('change', () => this.host.set(this.preset.value, false));
        this.channels.addEventListener('change', () => {
            this.channel = Number(this.channels.value);
            this.selected = 0;
            this.draw();
        });
        const tab = (label: string, square: boolean, tip: string) => {
            const radio = make('input', { type: 'radio', name: 'transfer-kind', value: String(square), checked: !square });
            radio.addEventListener('change', () => {
                this.square = square;
                this.selected = 0;
                this.draw();
            });
            return { radio, label: make('label', { 'data-tip': tip }, radio, make('span', {}, label)) };
        };
        const kinds = [
            tab('Points', false, 'Colour and opacity along the value'),
            tab('Shapes', true, 'Regions of value (to the right) and gradient magnitude (upwards): borders between materials are arcs'),
        ];
        this.tabs = kinds.map(({ radio }) => radio);
        const stage = make('div', { class: 'transfer-stage' }, this.back);
        stage.append(this.front);
        const button = (label: string, tip: string, act: () => void) => {
            const element = make('button', { type: 'button', class: 'button', 'data-tip': tip }, label);
            element.addEventListener('click', act);
            return element;
        };
        const file = make('input', { type: 'file', accept: '.json,application/json', hidden: true, id: 'transfer-file' });
        file.addEventListener('change', () => void this.load(file));
        this.element = make(
            'details',
            { class: 'section transfer', 'data-role': 'transfer', open: true, hidden: true },
            make('summary', {}, 'Transfer function'),
            make(
                'div',
                { class: 'node' },
                make('div', { class: 'transfer-head' }, this.preset, this.channels),
                make('div', { class: 'segments', role: 'radiogroup', 'aria-label': 'What is edited' }, ...kinds.map(({ label }) => label)),
                stage,
                this.bar,
                this.axis,
                this.details,
                make(
                    'div',
                    { class: 'transfer-files' },
                    button('Load', 'Load a transfer function (JSON)', () => file.click()),
                    button('Save', 'Save the transfer function as JSON, as scenes have it', () => this.host.save(JSON.stringify(transferJson(this.transfers), null, 2))),
                    file,
                ),
            ),
        );
        this.front.addEventListener('pointerdown', (event) => this.onDown(event));
        this.front.addEventListener('keydown', (event) => this.onKey(event));
    }

    /**
     * What the engine shows now; null: no volume.
     * @param chosen the document's `subject.transfer`
     */
    show(info: VolumeInfo | null, chosen: Json): void {
        this.element.hidden = info === null;
        if (!info) {
            this.info = null;
            return;
        }
        this.preset.value = typeof chosen === 'string' ? chosen : '';
        if (this.dragging) return;
        const ranges = (one: VolumeInfo | null) => JSON.stringify(one?.channels.map(({ transfer: _, ...rest }) => rest));
        if (ranges(info) !== ranges(this.info)) {
            this.histograms.clear();
            this.channel = Math.min(this.channel, info.channels.length - 1);
            this.channels.replaceChildren(...info.channels.map(({ name }, i) => make('option', { value: i }, name || `Channel ${i + 1}`)));
            this.channels.value = String(this.channel);
            this.channels.hidden = info.channels.length < 2;
        }
        this.info = info;
        this.transfers = info.channels.map(({ transfer }) => transferOf(transfer));
        if (this.transfers[this.channel]!.points.length === 0 && !this.square) this.setSquare(true);
        this.draw();
    }

    private setSquare(square: boolean): void {
        this.square = square;
        for (const tab of this.tabs) tab.checked = tab.value === String(square);
    }

    private get transfer(): Transfer {
        return this.transfers[this.channel]!;
    }

    private edit(transfer: Transfer, live: boolean): void {
        this.transfers = this.transfers.map((old, i) => (i === this.channel ? transfer : old));
        this.host.set(transferJson(this.transfers), live);
        this.preset.value = '';
        this.draw();
    }

    // From values to the stage and back. The stage has a margin of kRadius on all sides, so that points on its border can be taken.

    private toX(value: number): number {
        const [low, high] = this.info!.channels[this.channel]!.axis;
        return kRadius + ((value - low) / (high - low || 1)) * (kWidth - 2 * kRadius);
    }
    private toValue(x: number): number {
        const [low, high] = this.info!.channels[this.channel]!.axis;
        return clamp(low + ((x - kRadius) / (kWidth - 2 * kRadius)) * (high - low), low, high);
    }
    private upwards(part: number): number {
        return kHeight - kRadius - part * (kHeight - 2 * kRadius);
    }
    private partAt(y: number): number {
        return clamp((kHeight - kRadius - y) / (kHeight - 2 * kRadius), 0, 1);
    }
    private get steepest(): number {
        return this.info!.channels[this.channel]!.gradient_high;
    }

    private draw(): void {
        if (!this.info) return;
        this.front.setAttribute('aria-label', this.square ? 'Shapes over value and gradient' : 'Opacity over the value. Click adds a point; arrows move it; Delete removes it.');
        this.front.replaceChildren(...(this.square ? this.drawShapes() : this.drawPoints()));
        const [low, high] = this.info.channels[this.channel]!.axis;
        const { unit } = this.info;
        this.axis.replaceChildren(make('span', {}, format(low)), make('span', {}, unit), make('span', {}, format(high)));
        this.bar.hidden = this.square;
        this.bar.style.background = `linear-gradient(to right, ${gradientOf(this.transfer.points, low, high, 48).join(', ')})`;
        this.drawDetails();
        void this.drawHistogram();
    }

    private drawPoints(): SVGElement[] {
        const { points } = this.transfer;
        const places = points.map((point) => [clamp(this.toX(point.value), -kWidth, 2 * kWidth), this.upwards(heightOf(point.opacity))] as const);
        // Between points opacity is linear, and heights are its roots: a few places in between make the curve.
        const steps: string[] = [];
        const [low, high] = this.info!.channels[this.channel]!.axis;
        for (let i = 0; i <= 200; i++) {
            const value = low + ((high - low) * i) / 200;
            steps.push(`${this.toX(value).toFixed(1)} ${this.upwards(heightOf(pointAt(points, value).opacity)).toFixed(1)}`);
        }
        const line = svg('polyline', { points: steps.join(' '), class: 'transfer-line' });
        const area = svg('polygon', { points: `${kRadius} ${this.upwards(0)} ${steps.join(' ')} ${kWidth - kRadius} ${this.upwards(0)}`, class: 'transfer-area' });
        const handles = places.map(([x, y], i) =>
            svg('circle', { cx: x.toFixed(1), cy: y.toFixed(1), r: kRadius, fill: hexOf(points[i]!.color), class: i === this.selected ? 'handle chosen' : 'handle', 'data-index': i }),
        );
        return [area, line, ...handles];
    }

    private drawShapes(): SVGElement[] {
        const elements: SVGElement[] = [];
        this.transfer.shapes.forEach((shape, i) => {
            const [x, y] = [this.toX(shape.center[0]), this.upwards(shape.center[1] / this.steepest)];
            const [right, top] = [this.toX(shape.center[0] + 0.5 * shape.size[0]), this.upwards((shape.center[1] + 0.5 * shape.size[1]) / this.steepest)];
            const [w, h] = [right - x, y - top];
            const look = { fill: hexOf(shape.color), 'fill-opacity': 0.15 + 0.5 * shape.opacity, class: i === this.selected ? 'shape chosen' : 'shape', 'data-index': i };
            if (shape.type === 'box') elements.push(svg('rect', { x: x - w, y: y - h, width: 2 * w, height: 2 * h, ...look }));
            else if (shape.type === 'gaussian') elements.push(svg('ellipse', { cx: x, cy: y, rx: w, ry: h, ...look }));
            else elements.push(svg('polygon', { points: `${x},${y + h} ${x - w},${y - h} ${x + w},${y - h}`, ...look }));
            if (i === this.selected) elements.push(svg('circle', { cx: clamp(x + w, kRadius, kWidth - kRadius), cy: clamp(y - h, kRadius, kHeight - kRadius), r: kRadius, class: 'handle corner', 'data-corner': i }));
        });
        return elements;
    }

    private async drawHistogram(): Promise<void> {
        const [values, gradients] = this.square ? [kSquare, kSquare] : [kValues, 1];
        const key = `${this.channel} ${gradients}`;
        try {
            if (!this.histograms.has(key)) {
                const asked = await this.host.histogram(this.channel, values, gradients);
                if (asked) this.histograms.set(key, asked);
            }
        } catch (error) {
            this.host.failed(error);
        }
        if (key !== `${this.channel} ${this.square ? kSquare : 1}`) return; // another one is wanted by now
        const context = this.back.getContext('2d')!;
        context.clearRect(0, 0, kWidth, kHeight);
        const histogram = this.histograms.get(key);
        if (!histogram) return;
        const [w, h] = [(kWidth - 2 * kRadius) / values, (kHeight - 2 * kRadius) / gradients];
        for (let y = 0; y < gradients; y++) {
            for (let x = 0; x < values; x++) {
                const part = histogram.log[y * values + x]!;
                if (part <= 0) continue;
                if (this.square) {
                    context.fillStyle = `rgb(236 226 208 / ${(0.05 + 0.6 * part).toFixed(3)})`;
                    context.fillRect(kRadius + x * w, this.upwards((y + 1) / gradients), w + 0.4, h + 0.4);
                } else {
                    context.fillStyle = 'rgb(236 226 208 / 0.16)';
                    context.fillRect(kRadius + x * w, this.upwards(part), w + 0.4, part * (kHeight - 2 * kRadius));
                }
            }
        }
    }

    /** What is selected, in numbers. */
    private drawDetails(): void {
        if (this.dragging || this.details.contains(document.activeElement)) return;
        const { points, shapes } = this.transfer;
        const part = this.square ? shapes[this.selected] : points[this.selected];
        const change = (what: { [key: string]: number | string }, live: boolean) => {
            if (this.square) this.edit(changeShape(this.transfer, this.selected, what as Partial<TransferShape>), live);
            else this.edit(changePoint(this.transfer, this.selected, what), live);
        };
        const number = (label: string, value: number, low: number, high: number, act: (value: number) => void) => {
            const input = make('input', { type: 'text', inputmode: 'decimal', class: 'field number', value: format(value), 'aria-label': label });
            input.addEventListener('change', () => {
                const next = Number(input.value.replace(',', '.'));
                if (input.value.trim() !== '' && Number.isFinite(next)) act(clamp(next, low, high));
                else input.value = format(value);
            });
            return make('label', {}, make('span', {}, label), input);
        };
        const rows: HTMLElement[] = [];
        if (part) {
            const color = make('input', { type: 'color', class: 'swatch', value: hexOf(part.color), 'aria-label': 'Colour', id: 'transfer-color' });
            color.addEventListener('input', () => change({ color: color.value }, true));
            color.addEventListener('change', () => change({ color: color.value }, false));
            rows.push(make('label', {}, make('span', {}, 'Colour'), color));
            if ('value' in part) rows.push(number('Value', part.value, -1e9, 1e9, (value) => this.edit(movePoint(this.transfer, this.selected, value, part.opacity), false)));
            rows.push(number('Opacity', part.opacity, 0, 1, (opacity) => change({ opacity }, false)));
            rows.push(number('Glow', part.emission ?? 0, 0, 1000, (emission) => change({ emission }, false)));
        }
        const actions = make('div', { class: 'transfer-actions' });
        const action = (label: string, tip: string, act: () => void, disabled = false) => {
            const element = make('button', { type: 'button', class: 'chip', 'data-tip': tip, disabled }, label);
            element.addEventListener('click', act);
            actions.append(element);
        };
        if (this.square) for (const type of ['box', 'gaussian', 'triangle'] as const) action(humanise(type), 'A further shape', () => this.append(type));
        if (part) action('Remove', this.square ? 'Remove the shape' : 'Remove the point', () => this.remove());
        this.details.replaceChildren(...rows, actions);
    }

    private append(type: ShapeType): void {
        const { axis, high, low } = this.info!.channels[this.channel]!;
        const width = axis[1] - axis[0];
        const value = clamp(0.5 * (low + high), axis[0], axis[1]);
        const shape: TransferShape = {
            type, center: [value, (type === 'triangle' ? 0.5 : 0.4) * this.steepest], size: [0.25 * width, (type === 'triangle' ? 1 : 0.4) * this.steepest],
            color: '#e2b06a', opacity: 0.5,
        };
        const { transfer, index } = addShape(this.transfer, shape);
        this.selected = index;
        this.edit(transfer, false);
    }

    private remove(): void {
        const index = this.selected;
        this.selected = Math.max(0, index - 1);
        this.edit(this.square ? removeShape(this.transfer, index) : removePoint(this.transfer, index), false);
    }

    private async load(file: HTMLInputElement): Promise<void> {
        const chosen = file.files?.[0];
        file.value = '';
        if (!chosen) return;
        try {
            const json = JSON.parse(await chosen.text()) as Json;
            if (!isTransferJson(json)) throw new Error('there is no transfer function in it: it has neither points nor shapes');
            this.host.set(json, false);
        } catch (error) {
            this.host.failed(new Error(`${chosen.name}: ${error instanceof Error ? error.message : String(error)}`));
        }
    }

    private place(event: PointerEvent): [number, number] {
        const box = this.front.getBoundingClientRect();
        return [((event.clientX - box.left) / box.width) * kWidth, ((event.clientY - box.top) / box.height) * kHeight];
    }

    private onDown(event: PointerEvent): void {
        if (!this.info || event.button !== 0) return;
        event.preventDefault();
        this.front.focus({ preventScroll: true });
        const target = event.target as SVGElement;
        const [x0, y0] = this.place(event);
        let move: (x: number, y: number) => Transfer;
        if (this.square) {
            const corner = target.dataset['corner'];
            const index = corner ?? target.dataset['index'];
            if (index === undefined) return;
            this.selected = Number(index);
            const { center, size } = this.transfer.shapes[this.selected]!;
            const at = (x: number, y: number) => [this.toValue(x), this.partAt(y) * this.steepest] as const;
            const [v0, g0] = at(x0, y0);
            move = (x, y) => {
                const [v, g] = at(x, y);
                if (corner === undefined) return changeShape(this.transfer, this.selected, { center: [center[0] + v - v0, center[1] + g - g0] });
                const least = 1e-3;
                const width = Math.max(2 * Math.abs(v - center[0]), least * size[0]);
                return changeShape(this.transfer, this.selected, { size: [width, Math.max(2 * Math.abs(g - center[1]), least * size[1])] });
            };
        } else {
            const index = target.dataset['index'];
            if (index === undefined) {
                const added = addPoint(this.transfer, this.toValue(x0), opacityAt(this.partAt(y0)));
                this.selected = added.index;
                this.edit(added.transfer, true);
            } else {
                this.selected = Number(index);
            }
            move = (x, y) => movePoint(this.transfer, this.selected, this.toValue(x), opacityAt(this.partAt(y)));
        }
        this.dragging = true;
        this.front.setPointerCapture(event.pointerId);
        let moved = false;
        const onMove = (next: PointerEvent) => {
            const [x, y] = this.place(next);
            if (!moved && Math.hypot(x - x0, y - y0) < 1.5) return;
            moved = true;
            this.edit(move(x, y), true);
        };
        const onUp = () => {
            this.front.removeEventListener('pointermove', onMove);
            this.front.removeEventListener('pointerup', onUp);
            this.front.removeEventListener('pointercancel', onUp);
            this.dragging = false;
            // The engine compiles for it again only now.
            this.edit(this.transfer, false);
        };
        this.front.addEventListener('pointermove', onMove);
        this.front.addEventListener('pointerup', onUp);
        this.front.addEventListener('pointercancel', onUp);
        this.draw();
    }

    private onKey(event: KeyboardEvent): void {
        if (!this.info) return;
        const { points, shapes } = this.transfer;
        const part = this.square ? shapes[this.selected] : points[this.selected];
        if (!part) return;
        const [dx = 0, dy = 0] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
        if (event.key === 'Delete' || event.key === 'Backspace') {
            this.remove();
        } else if (dx !== 0 || dy !== 0) {
            const [low, high] = this.info.channels[this.channel]!.axis;
            const step = 0.01 * (high - low);
            if ('value' in part) {
                this.edit(movePoint(this.transfer, this.selected, part.value + dx * step, opacityAt(heightOf(part.opacity) + 0.02 * dy)), false);
            } else {
                const center: [number, number] = [part.center[0] + dx * step, part.center[1] + 0.01 * dy * this.steepest];
                this.edit(changeShape(this.transfer, this.selected, { center }), false);
            }
        } else {
            return;
        }
        event.preventDefault();
        event.stopPropagation(); // arrows turn the camera elsewhere
    }
}
