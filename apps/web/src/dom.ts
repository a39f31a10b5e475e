// Small help with the DOM.

export function byId<T extends HTMLElement>(id: string): T {
    const element = document.getElementById(id);
    if (!element) throw new Error(`the page has no #${id}`);
    return element as T;
}

type Attributes = { [name: string]: string | number | boolean | undefined };

/** An element with attributes (true: empty, false and undefined: none) and children. */
export function make<K extends keyof HTMLElementTagNameMap>(
    tag: K,
    attributes: Attributes = {},
    ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (value === undefined || value === false) continue;
        element.setAttribute(name, value === true ? '' : String(value));
    }
    element.append(...children);
    return element;
}

const kSvg = 'http://www.w3.org/2000/svg';

export function icon(path: string): SVGSVGElement {
    const svg = document.createElementNS(kSvg, 'svg');
    svg.setAttribute('viewBox', '0 0 16 16');
    svg.setAttribute('aria-hidden', 'true');
    const shape = document.createElementNS(kSvg, 'path');
    shape.setAttribute('d', path);
    svg.append(shape);
    return svg;
}

export const kCross = 'm4.5 4.5 7 7m0-7-7 7';
export const kUp = 'm4 10 4-4 4 4';
export const kDown = 'm4 6 4 4 4-4';
export const kReset = 'M4.2 6.200A4.500 4.500 0 1 1 3.500 8.800M4 3v3.300h3.300';

/** Whether keys belong to an element that is typed into. */
export function typing(target: EventTarget | null): boolean {
    if (!(target instanceof HTMLElement)) return false;
    if (target instanceof HTMLInputElement) return !['checkbox', 'range', 'color', 'button', 'radio'].includes(target.type);
    return target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement || target.isContentEditable;
}

/** Saves a file from the page. */
export function download(blob: Blob, name: string): void {
    const url = URL.createObjectURL(blob);
    make('a', { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
