// The page.
import { Client, type Notice } from './client';
import { Controls } from './controls';
import { byId, download, make, typing } from './dom';
import { automaticScale, renderSize } from './gestures';
import { Panel } from './panel';
import { isPng, sceneOf, withScene } from './png';
import { messageOf, type Answer, type Autopilot, type Size, type Status } from './protocol';
import { deviceName, messagesOf, readingsOf, valueText } from './readings';
import { at, equal, type Json, type SceneDocument, type Schema } from './schema';
import { installTips } from './tip';
import { TransferEditor } from './transfer/editor';
import { looksLikeVolume } from './volumes/open';
import type { NamedBytes } from './volumes/volume_file';

/** For tests and the curious; nothing of the page depends on it. */
export interface ApeironPage {
    ready: Promise<void>;
    samples(): number;
    status(): Status | null;
    scene(): SceneDocument;
    pixels(): Promise<Answer<'pixels'>>;
    statistics(): Promise<Json>;
    set(path: string, value: Json): Promise<null>;
    load(text: string, name?: string): Promise<void>;
    openVolume(name: string, bytes: Uint8Array<ArrayBuffer>, raw?: string): Promise<void>;
    value(x: number, y: number): Promise<Answer<'value'>>;
    loseContext(restoreAfterMs: number): Promise<null>;
}

declare global {
    interface Window {
        apeiron: ApeironPage;
    }
}

/** The page decides the picture's size, and has an editor of transfer functions. */
const kHidden = new Set(['output.width', 'output.height', 'subject.transfer']);
const kResizeDelay = 120;
/** Distances to the ground per second. */
const kAutopilotSpeed = 0.8;
const kAutopilots: readonly Autopilot[] = ['dive', 'rise'];
const kScaleKey = 'apeiron.scale';
const kScales = ['0.25', '0.5', '0.75', '1', '1.5', '2'];

const query = new URLSearchParams(location.search);

function positive(name: string): number | null {
    const value = Number(query.get(name));
    return Number.isInteger(value) && value > 0 ? value : null;
}

const fixedSize: Size | null =
    positive('width') && positive('height') ? { width: positive('width')!, height: positive('height')! } : null;

const canvas = byId<HTMLCanvasElement>('view');
const alertLine = byId('alert');
const scenes = byId<HTMLSelectElement>('scene');
const pauseButton = byId<HTMLButtonElement>('pause');
const panelElement = byId('panel');
const help = byId<HTMLDialogElement>('help');
const fileInput = byId<HTMLInputElement>('file');

let panel: Panel | null = null;
let transferEditor: TransferEditor | null = null;
let scene: SceneDocument = {};
let ownModules: Schema['modules'] = {};
let initialCamera: Json = null;
let notes: string[] = [];
let status: Status | null = null;
let started: Answer<'start'> | null = null;
let paused = false;
let canvasSize: Size = { width: 0, height: 0 };

// Messages

function showError(error: unknown): void {
    alertLine.querySelector('p')!.textContent = messageOf(error);
    alertLine.hidden = false;
}

function clearError(): void {
    alertLine.hidden = true;
}

async function attempt(work: () => Promise<unknown>): Promise<void> {
    try {
        await work();
    } catch (error) {
        showError(error);
    }
}

function onNotice(notice: Notice): void {
    switch (notice.type) {
        case 'status':
            status = notice.status;
            showStatus(status);
            showMessages();
            break;
        case 'scene':
            scene = notice.document;
            if (notice.loaded) {
                initialCamera = scene['camera'] ?? null;
                controls.land();
            }
            document.title = typeof scene['title'] === 'string' && scene['title'] ? `${scene['title']} · Apeiron` : 'Apeiron';
            ownModules = notice.modules;
            notes = notice.notes;
            showMessages();
            panel?.show(scene, ownModules);
            void showTransfer(notice.loaded);
            break;
        case 'error':
            showError(new Error(notice.message));
            break;
        case 'context':
            if (notice.state === 'lost') {
                showMode('The graphics context was lost. Waiting for the browser to restore it.');
                if (status) showStatus({ ...status, state: 'lost', moving: false });
            } else {
                showMode(null);
            }
            break;
    }
}

let messages = '';

function showMessages(): void {
    const lines = messagesOf(notes, status);
    if (lines.join('\n') === messages) return;
    messages = lines.join('\n');
    const element = byId('notes');
    element.replaceChildren(...lines.map((line) => make('p', {}, line)));
    element.hidden = lines.length === 0;
}

const readings = new Map<string, HTMLElement[]>();

function showStatus(now: Status): void {
    const list = byId('readings');
    const told = readingsOf(now);
    for (const [key, [term]] of readings) term!.parentElement!.hidden = !told.some((reading) => reading.key === key);
    for (const { key, label, value } of told) {
        let cells = readings.get(key);
        if (!cells) {
            const [term, text] = [make('dt'), make('dd')];
            list.append(make('div', { class: key }, term, text));
            cells = [term, text];
            readings.set(key, cells);
        }
        if (cells[0]!.textContent !== label) cells[0]!.textContent = label;
        if (cells[1]!.textContent !== value) cells[1]!.textContent = value;
    }
    const meter = document.querySelector<HTMLElement>('.meter')!;
    const part = now.limit > 0 ? Math.min((now.samples + (now.state === 'finished' ? 0 : now.progress)) / now.limit, 1) : 0;
    meter.style.setProperty('--part', String(part));
    meter.setAttribute('aria-valuemax', String(now.limit));
    meter.setAttribute('aria-valuenow', String(now.samples));
    byId('autopilot').hidden = now.scale === null;
    for (const way of kAutopilots) byId(way).setAttribute('aria-pressed', String(now.autopilot === way));
    document.body.dataset['state'] = now.moving ? 'moving' : now.state;
}

function showDevice({ device, software }: Answer<'start'>): void {
    const value = make('dd', { 'data-tip': device, tabindex: 0 }, deviceName(device));
    const kind = software ? 'software' : 'GPU';
    value.append(make('span', { class: software ? 'badge slow' : 'badge' }, kind));
    byId('readings').append(make('div', { class: 'device' }, make('dt', {}, 'Device'), value));
}

function showMode(text: string | null): void {
    const mode = byId('mode');
    mode.hidden = text === null;
    mode.textContent = text ?? '';
}

// Size

let chosenScale = 'auto';
try {
    chosenScale = localStorage.getItem(kScaleKey) ?? 'auto';
} catch {
    // Storage may be refused.
}
if (!kScales.includes(chosenScale)) chosenScale = 'auto';

function wantedSize(): Size {
    if (fixedSize) return fixedSize;
    const css = { width: innerWidth, height: innerHeight };
    const software = started?.software ?? false;
    const scale = chosenScale === 'auto' ? automaticScale(css, devicePixelRatio, software) : Number(chosenScale);
    return renderSize(css, devicePixelRatio, scale, started?.maxSize ?? 4096);
}

// Volumes

/** What decides which volume is shown, and how: what the transfer function's editor shows depends on it. */
let shownVolume: Json = null;

async function showTransfer(loaded = false): Promise<void> {
    if (!transferEditor) return;
    const isVolume = at(scene, 'subject.type') === 'volume';
    const names = ['source', 'raw', 'resolution', 'time', 'transfer', 'seed', 'orbital_n', 'orbital_l', 'orbital_m', 'orbital_phases'];
    const wanted: Json = isVolume ? names.map((name) => at(scene, `subject.${name}`) ?? null) : null;
    if (!loaded && equal(wanted, shownVolume)) return;
    shownVolume = wanted;
    try {
        const info = isVolume ? await client.request('volume', {}) : null;
        if (equal(wanted, shownVolume)) transferEditor.show(info, at(scene, 'subject.transfer') ?? null);
    } catch (error) {
        showError(error);
    }
}

function transferPresets(schema: Schema): string[] {
    const parameters = schema.roles['subject']?.types['volume']?.parameters ?? [];
    return parameters.find((parameter) => parameter.name === 'transfer')?.choices ?? [];
}

/** Milliseconds between two looks at the value under the cursor. */
const kValueDelay = 120;
let valueTimer = 0;

function lookUnder(event: PointerEvent): void {
    clearTimeout(valueTimer);
    const chip = byId('value');
    if (at(scene, 'subject.type') !== 'volume' || event.buttons !== 0) {
        chip.hidden = true;
        return;
    }
    const box = canvas.getBoundingClientRect();
    const place = { x: (event.clientX - box.left) / box.width, y: (event.clientY - box.top) / box.height };
    valueTimer = window.setTimeout(async () => {
        try {
            const reading = await client.request('value', place);
            chip.hidden = reading === null;
            if (reading) chip.textContent = valueText(reading);
        } catch {
            chip.hidden = true; // a lost context is told elsewhere
        }
    }, kValueDelay);
}

let resizeTimer = 0;

function scheduleResize(delay = kResizeDelay): void {
    clearTimeout(resizeTimer);
    resizeTimer = window.setTimeout(() => {
        if (!started) return;
        const size = wantedSize();
        if (size.width === canvasSize.width && size.height === canvasSize.height) return;
        canvasSize = size;
        void attempt(() => client.request('resize', size));
    }, delay);
}

/** What the page itself decides, in the panel's manner. */
function pageSection(): HTMLElement {
    const select = make('select', { class: 'select', id: 'scale', disabled: fixedSize !== null });
    select.append(make('option', { value: 'auto' }, 'Automatic'));
    for (const scale of kScales) select.append(make('option', { value: scale }, `${Math.round(100 * Number(scale))} %`));
    select.value = chosenScale;
    select.addEventListener('change', () => {
        chosenScale = select.value;
        try {
            localStorage.setItem(kScaleKey, chosenScale);
        } catch {
            // It lasts as long as the page.
        }
        scheduleResize(0);
    });
    const tip = 'Pixels of the picture for each pixel of the window. Automatic takes fewer where a processor has to do the work';
    const label = make('label', { class: 'label', for: 'scale', 'data-tip': tip }, 'Resolution');
    const row = make('div', { class: 'row of-choice' }, make('div', { class: 'name' }, label), select);
    return make('details', { class: 'section', open: true }, make('summary', {}, 'Window'), make('div', { class: 'node' }, row));
}

// Scenes and files

async function openFiles(files: readonly File[]): Promise<void> {
    const [file] = files;
    if (!file) return;
    if (files.some(({ name }) => looksLikeVolume(name))) {
        await openVolume(await Promise.all(files.map(async (one) => ({ name: one.name, bytes: new Uint8Array(await one.arrayBuffer()) }))));
        return;
    }
    const bytes = new Uint8Array(await file.arrayBuffer());
    let text: string | null;
    if (isPng(bytes)) {
        text = await sceneOf(bytes);
        if (text === null) throw new Error(`${file.name}: there is no scene inside this picture`);
    } else {
        text = new TextDecoder().decode(bytes);
    }
    await loadText(text, file.name);
}

async function openVolume(files: NamedBytes[], raw: string | null = null): Promise<void> {
    const question = await client.request('openVolume', { files, raw });
    if (question) {
        const answer = await askRaw(question);
        if (answer !== null) await openVolume(files, answer);
        return;
    }
    showOwn(files[0]!.name);
}

/** What bare voxels are; null: never mind. */
function askRaw({ name, bytes, guess }: { name: string; bytes: number; guess: string }): Promise<string | null> {
    const dialog = byId<HTMLDialogElement>('raw');
    const field = byId<HTMLInputElement>('raw-form');
    byId('raw-name').textContent = `${name}, ${bytes.toLocaleString('en')} bytes`;
    field.value = guess;
    dialog.returnValue = '';
    dialog.showModal();
    return new Promise((resolve) => {
        dialog.addEventListener('close', () => resolve(dialog.returnValue === 'open' && field.value.trim() ? field.value.trim() : null), { once: true });
    });
}

async function loadText(text: string, name: string): Promise<void> {
    await client.request('load', { text, name });
    showOwn(name);
}

/** The list of scenes names what was opened. */
function showOwn(name: string): void {
    clearError();
    scenes.querySelector('option.own')?.remove();
    scenes.prepend(make('option', { value: '', class: 'own' }, name));
    scenes.value = '';
}

async function openGallery(name: string): Promise<void> {
    await client.request('gallery', { name });
    clearError();
    scenes.querySelector('option.own')?.remove();
    const url = new URL(location.href);
    url.searchParams.set('scene', name);
    history.replaceState(null, '', url);
}

function fileName(): string {
    const title = typeof scene['title'] === 'string' ? scene['title'] : '';
    const slug = title.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '');
    return slug || 'apeiron';
}

async function saveScene(): Promise<void> {
    const text = await client.request('sceneText', {});
    download(new Blob([text, '\n'], { type: 'application/json' }), `${fileName()}.json`);
}

async function savePicture(): Promise<void> {
    const [picture, text] = [await client.request('png', {}), await client.request('sceneText', {})];
    const bytes = withScene(new Uint8Array(await picture.arrayBuffer()), text);
    download(new Blob([bytes], { type: 'image/png' }), `${fileName()}.png`);
}

function installFiles(): void {
    byId('open').addEventListener('click', () => fileInput.click());
    fileInput.addEventListener('change', () => {
        const files = [...(fileInput.files ?? [])];
        fileInput.value = '';
        void attempt(() => openFiles(files));
    });
    canvas.addEventListener('pointermove', lookUnder);
    canvas.addEventListener('pointerleave', () => {
        clearTimeout(valueTimer);
        byId('value').hidden = true;
    });
    byId('save-scene').addEventListener('click', () => void attempt(saveScene));
    byId('save-picture').addEventListener('click', () => void attempt(savePicture));
    scenes.addEventListener('change', () => {
        const name = scenes.value;
        if (name) void attempt(() => openGallery(name));
    });
    let depth = 0; // dragenter and dragleave come for every element that is passed
    const over = (active: boolean) => document.body.classList.toggle('dropping', active);
    const isFile = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
    addEventListener('dragenter', (event) => isFile(event) && over(++depth > 0));
    addEventListener('dragleave', (event) => isFile(event) && over(--depth > 0));
    addEventListener('dragover', (event) => event.preventDefault());
    addEventListener('drop', (event) => {
        event.preventDefault();
        depth = 0;
        over(false);
        const files = [...(event.dataTransfer?.files ?? [])];
        void attempt(() => openFiles(files));
    });
}

// Keys, buttons, camera

function togglePause(): void {
    paused = !paused;
    client.pause(paused);
    pauseButton.setAttribute('aria-pressed', String(paused));
    pauseButton.setAttribute('aria-label', paused ? 'Go on' : 'Pause');
}

function toggleAutopilot(way: Autopilot): void {
    if (!status || status.scale === null) return;
    client.motion({ kind: 'autopilot', way: status.autopilot === way ? null : way, speed: kAutopilotSpeed });
}

function showPanel(visible: boolean): void {
    document.body.classList.toggle('no-panel', !visible);
    panelElement.inert = !visible;
    byId('panel-toggle').setAttribute('aria-expanded', String(visible));
}

const client = new Client(onNotice);
const controls = new Controls(canvas, {
    motion: (motion) => client.motion(motion),
    focus: (x, y) => void attempt(() => client.request('focus', { x, y })),
    sharpen: (x, y) => void attempt(() => client.request('sharpen', { x, y })),
    resetCamera: () => {
        if (initialCamera !== null) void attempt(() => client.request('set', { path: 'camera', value: initialCamera, live: false }));
    },
    togglePause,
    toggleAutopilot,
    togglePanel: () => showPanel(document.body.classList.contains('no-panel')),
    help: () => help.showModal(),
    flying: (active) => showMode(active ? 'Flying: W A S D, E Q, mouse to look. F or Esc ends it.' : null),
});

function installButtons(): void {
    pauseButton.addEventListener('click', togglePause);
    for (const way of kAutopilots) byId(way).addEventListener('click', () => toggleAutopilot(way));
    byId('panel-toggle').addEventListener('click', () => showPanel(document.body.classList.contains('no-panel')));
    byId('help-open').addEventListener('click', () => help.showModal());
    help.addEventListener('click', (event) => {
        if (event.target === help) help.close(); // beside it
    });
    alertLine.querySelector('button')!.addEventListener('click', clearError);
    document.addEventListener('keydown', (event) => {
        if (event.key === 'Escape' && !typing(event.target) && !help.open) clearError();
    });
}

async function start(): Promise<void> {
    if (typeof canvas.transferControlToOffscreen !== 'function') {
        throw new Error('this browser cannot draw in the background (OffscreenCanvas): use a newer one');
    }
    canvasSize = wantedSize();
    if (fixedSize) {
        canvas.classList.add('fixed');
        canvas.style.width = `${fixedSize.width / devicePixelRatio}px`;
        canvas.style.height = `${fixedSize.height / devicePixelRatio}px`;
    }
    const offscreen = canvas.transferControlToOffscreen();
    const engine = new URL('engine/', document.baseURI).href;
    const ask = { canvas: offscreen, engine, size: canvasSize, scene: query.get('scene') ?? '', samples: positive('samples') };
    started = await client.request('start', ask, [offscreen]);
    for (const { name, title } of started.gallery) scenes.append(make('option', { value: name }, title));
    scenes.value = started.scene;
    transferEditor = new TransferEditor(transferPresets(started.schema), {
        set: (value, live) => void attempt(() => client.request('set', { path: 'subject.transfer', value, live }).then(clearError)),
        histogram: (channel, values, gradients) => client.request('histogram', { channel, values, gradients }),
        save: (text) => download(new Blob([text, '\n'], { type: 'application/json' }), `${fileName()}.transfer.json`),
        failed: showError,
    });
    panel = new Panel(
        panelElement,
        started.schema,
        { set: (path, value, live) => void attempt(() => client.request('set', { path, value, live }).then(clearError)) },
        kHidden,
        transferEditor.element,
        pageSection(),
    );
    panel.show(scene, ownModules);
    void showTransfer();
    showDevice(started);
    // Only now is it known whether a processor does the work.
    scheduleResize(0);
    new ResizeObserver(() => scheduleResize()).observe(document.documentElement);
    document.body.classList.remove('starting');
}

installTips();
installFiles();
installButtons();
showPanel(innerWidth > 760 && !fixedSize);

window.apeiron = {
    ready: start().catch((error: unknown) => {
        byId('curtain').textContent = 'The engine could not be started';
        showError(error);
        throw error;
    }),
    samples: () => status?.samples ?? 0,
    status: () => status,
    scene: () => scene,
    pixels: () => client.request('pixels', {}),
    statistics: () => client.request('statistics', {}),
    set: (path, value) => client.request('set', { path, value, live: false }),
    load: (text, name = 'scene') => loadText(text, name),
    openVolume: (name, bytes, raw) => openVolume([{ name, bytes }], raw ?? null),
    value: (x, y) => client.request('value', { x, y }),
    loseContext: (restoreAfterMs) => client.request('loseContext', { restoreAfterMs }),
};
window.apeiron.ready.catch(() => {}); // told already
