// From pointers and wheels to camera moves: no DOM here.
import type { Motion } from './protocol';

export interface Point {
    x: number;
    y: number;
}

/** The picture's place on the page [CSS px]. */
export interface Frame {
    left: number;
    top: number;
    width: number;
    height: number;
}

/** Dragging across the picture's height turns by so much [rad]. */
export const kOrbitPerHeight = Math.PI;
/** [rad] */
export const kLookPerHeight = 1.1;
/** A notch of a usual wheel (100 px) scales by exp of this. */
const kZoomPerPixel = 0.0016;
const kLinePixels = 16;
/** Pinching on a trackpad arrives as small wheel deltas with ctrl. */
const kPinchGain = 6;
/** One event scales by no more than this, whatever a device reports. */
const kMostPerEvent = 1.6;

export function fractionsOf(point: Point, frame: Frame): Point {
    return { x: (point.x - frame.left) / frame.width, y: (point.y - frame.top) / frame.height };
}

/** The scene follows the cursor: dragging right moves the camera to the left. */
export function orbitBy(dx: number, dy: number, frame: Frame): Motion {
    const scale = kOrbitPerHeight / frame.height;
    return { kind: 'orbit', yaw: -dx * scale, pitch: dy * scale };
}

export function panBy(dx: number, dy: number, frame: Frame): Motion {
    return { kind: 'pan', right: -dx / frame.height, up: dy / frame.height };
}

/** The view follows the mouse. */
export function lookBy(dx: number, dy: number, frame: Frame): Motion {
    const scale = kLookPerHeight / frame.height;
    return { kind: 'look', yaw: -dx * scale, pitch: -dy * scale };
}

/** Below 1 brings nearer. */
export function wheelFactor(deltaY: number, deltaMode: number, ctrl: boolean, pageHeight: number): number {
    const pixels = deltaY * (deltaMode === 1 ? kLinePixels : deltaMode === 2 ? pageHeight : 1);
    const factor = Math.exp(pixels * kZoomPerPixel * (ctrl ? kPinchGain : 1));
    return Math.min(Math.max(factor, 1 / kMostPerEvent), kMostPerEvent);
}

export type DragMode = 'orbit' | 'pan' | 'look';

/** Follows the pointers that are down: one drags in its mode, two pan and zoom together. */
export class PointerTracker {
    private readonly points = new Map<number, Point>();
    private mode: DragMode = 'orbit';

    get count(): number {
        return this.points.size;
    }

    down(id: number, point: Point, mode: DragMode): void {
        if (this.points.size === 0) this.mode = mode;
        this.points.set(id, point);
    }

    up(id: number): void {
        this.points.delete(id);
    }

    move(id: number, point: Point, frame: Frame): Motion[] {
        const before = this.points.get(id);
        if (!before) return [];
        const spreadBefore = this.spread();
        this.points.set(id, point);
        const dx = point.x - before.x;
        const dy = point.y - before.y;
        if (dx === 0 && dy === 0) return [];
        if (this.points.size === 1) {
            if (this.mode === 'pan') return [panBy(dx, dy, frame)];
            return [this.mode === 'look' ? lookBy(dx, dy, frame) : orbitBy(dx, dy, frame)];
        }
        if (this.points.size > 2 || !spreadBefore) return [];
        const spread = this.spread()!;
        // Each finger moves the centre by half its way.
        const motions = [panBy(dx / 2, dy / 2, frame)];
        if (spread.distance > 0 && spreadBefore.distance > 0) {
            const factor = spreadBefore.distance / spread.distance;
            if (factor !== 1) motions.push({ kind: 'zoom', factor, at: fractionsOf(spread.centre, frame) });
        }
        return motions;
    }

    private spread(): { centre: Point; distance: number } | null {
        const [a, b] = [...this.points.values()];
        if (!a || !b) return null;
        return { centre: { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 }, distance: Math.hypot(a.x - b.x, a.y - b.y) };
    }
}

/** Keys that are held down while flying, as a motion. */
export function flightOf(held: ReadonlySet<string>): Motion {
    const axis = (positive: string, negative: string) => Number(held.has(positive)) - Number(held.has(negative));
    const fast = held.has('ShiftLeft') || held.has('ShiftRight');
    return {
        kind: 'fly',
        right: axis('KeyD', 'KeyA'),
        up: axis('KeyE', 'KeyQ'),
        ahead: axis('KeyW', 'KeyS'),
        speed: fast ? 3 : 1,
    };
}

/** The size of the picture for a place on the page [px]. */
export function renderSize(
    css: { width: number; height: number },
    pixelRatio: number,
    scale: number,
    maxSize: number,
): { width: number; height: number } {
    const side = (length: number) => Math.min(Math.max(Math.round(length * pixelRatio * scale), 1), maxSize);
    return { width: side(css.width), height: side(css.height) };
}

/** Software devices compute so many pixels in a time that is still pleasant. */
const kSoftwarePixels = 560 * 350;

/** The scale that "auto" means: full resolution on a GPU, fewer pixels on a processor. */
export function automaticScale(css: { width: number; height: number }, pixelRatio: number, software: boolean): number {
    if (!software) return 1;
    const pixels = css.width * css.height * pixelRatio ** 2;
    return Math.min(1, Math.max(0.2, Math.sqrt(kSoftwarePixels / Math.max(pixels, 1))));
}
