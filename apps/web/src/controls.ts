// Mouse, touch and keys on the canvas.
import { typing } from './dom';
import { flightOf, fractionsOf, lookBy, orbitBy, panBy, PointerTracker, wheelFactor, type DragMode, type Frame } from './gestures';
import type { Autopilot, Motion } from './protocol';

export interface ControlHost {
    motion(motion: Motion): void;
    /** Fractions of the picture, from the top left. */
    focus(x: number, y: number): void;
    sharpen(x: number, y: number): void;
    resetCamera(): void;
    togglePause(): void;
    togglePanel(): void;
    /** By itself, into the subject or out of it; again: no more. */
    toggleAutopilot(way: Autopilot): void;
    help(): void;
    flying(active: boolean): void;
}

const kFlightKeys = new Set(['KeyW', 'KeyA', 'KeyS', 'KeyD', 'KeyQ', 'KeyE', 'ShiftLeft', 'ShiftRight']);
/** What one press of an arrow key drags [px of a picture 1000 px high]. */
const kArrow = 26;
const kKeyZoom = 1.12;

export class Controls {
    private readonly tracker = new PointerTracker();
    private readonly held = new Set<string>();
    private flight = false;

    constructor(
        private readonly canvas: HTMLCanvasElement,
        private readonly host: ControlHost,
    ) {
        canvas.addEventListener('pointerdown', (event) => this.onDown(event));
        canvas.addEventListener('pointermove', (event) => this.onMove(event));
        for (const name of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) {
            canvas.addEventListener(name, (event) => {
                this.tracker.up(event.pointerId);
                if (this.tracker.count === 0) canvas.classList.remove('dragging');
            });
        }
        canvas.addEventListener('wheel', (event) => this.onWheel(event), { passive: false });
        canvas.addEventListener('contextmenu', (event) => event.preventDefault());
        canvas.addEventListener('dblclick', (event) => {
            const { x, y } = fractionsOf({ x: event.clientX, y: event.clientY }, this.frame());
            if (event.shiftKey) host.sharpen(x, y);
            else host.focus(x, y);
        });
        document.addEventListener('keydown', (event) => this.onKey(event));
        document.addEventListener('keyup', (event) => this.onKeyUp(event));
        window.addEventListener('blur', () => this.release());
        document.addEventListener('pointerlockchange', () => {
            // Escape gives the mouse back: that ends the flight too.
            if (this.flight && document.pointerLockElement !== canvas && this.locked) this.setFlight(false);
            this.locked = document.pointerLockElement === canvas;
        });
    }

    private locked = false;

    /** Ends flying: another scene has been opened. */
    land(): void {
        if (this.flight) this.setFlight(false);
    }

    private frame(): Frame {
        return this.canvas.getBoundingClientRect();
    }

    private onDown(event: PointerEvent): void {
        this.canvas.focus({ preventScroll: true });
        if (event.button > 2) return;
        let mode: DragMode = 'orbit';
        if (this.flight) mode = 'look';
        else if (event.button !== 0 || event.shiftKey) mode = 'pan';
        this.tracker.down(event.pointerId, { x: event.clientX, y: event.clientY }, mode);
        if (!this.locked) this.canvas.setPointerCapture(event.pointerId);
        this.canvas.classList.add('dragging');
    }

    private onMove(event: PointerEvent): void {
        const frame = this.frame();
        if (this.locked) {
            if (event.movementX || event.movementY) this.host.motion(lookBy(event.movementX, event.movementY, frame));
            return;
        }
        for (const motion of this.tracker.move(event.pointerId, { x: event.clientX, y: event.clientY }, frame)) {
            this.host.motion(motion);
        }
    }

    private onWheel(event: WheelEvent): void {
        event.preventDefault();
        const factor = wheelFactor(event.deltaY, event.deltaMode, event.ctrlKey, innerHeight);
        const at = this.locked ? null : fractionsOf({ x: event.clientX, y: event.clientY }, this.frame());
        this.host.motion({ kind: 'zoom', factor, at });
    }

    private onKey(event: KeyboardEvent): void {
        if (event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
        if (document.querySelector('dialog[open]')) return;
        if (this.flight && kFlightKeys.has(event.code)) {
            event.preventDefault();
            this.held.add(event.code);
            if (!event.repeat) this.host.motion(flightOf(this.held));
            return;
        }
        if (this.onCanvasKey(event)) {
            event.preventDefault();
            return;
        }
        if (event.repeat) return;
        switch (event.key) {
            case '?':
                this.host.help();
                break;
            case ' ':
                // On a button, Space presses it.
                if (event.target instanceof HTMLElement && event.target.closest('button, summary, input')) return;
                this.host.togglePause();
                break;
            case 'h':
            case 'H':
                this.host.togglePanel();
                break;
            case 'r':
            case 'R':
                this.host.resetCamera();
                break;
            case 'z':
            case 'Z':
                this.host.toggleAutopilot('dive');
                break;
            case 'x':
            case 'X':
                this.host.toggleAutopilot('rise');
                break;
            case 'f':
            case 'F':
                this.setFlight(!this.flight);
                break;
            case 'Escape':
                if (this.flight) this.setFlight(false);
                break;
            default:
                return;
        }
        event.preventDefault();
    }

    /** Arrows and + - move the camera while the picture has the focus. */
    private onCanvasKey(event: KeyboardEvent): boolean {
        if (event.target !== this.canvas && event.target !== document.body) return false;
        const frame: Frame = { left: 0, top: 0, width: 1000, height: 1000 };
        const by = event.shiftKey && !this.flight ? panBy : this.flight ? lookBy : orbitBy;
        const drag = (dx: number, dy: number) => this.host.motion(by(dx, dy, frame));
        switch (event.key) {
            case 'ArrowLeft':
                drag(-kArrow, 0);
                return true;
            case 'ArrowRight':
                drag(kArrow, 0);
                return true;
            case 'ArrowUp':
                drag(0, -kArrow);
                return true;
            case 'ArrowDown':
                drag(0, kArrow);
                return true;
            case '+':
            case '=':
                this.host.motion({ kind: 'zoom', factor: 1 / kKeyZoom, at: null });
                return true;
            case '-':
                this.host.motion({ kind: 'zoom', factor: kKeyZoom, at: null });
                return true;
        }
        return false;
    }

    private onKeyUp(event: KeyboardEvent): void {
        if (this.held.delete(event.code) && this.flight) this.host.motion(flightOf(this.held));
    }

    private release(): void {
        if (this.held.size === 0) return;
        this.held.clear();
        this.host.motion(flightOf(this.held));
    }

    private setFlight(active: boolean): void {
        this.flight = active;
        this.held.clear();
        this.host.motion(flightOf(this.held));
        this.host.flying(active);
        this.canvas.classList.toggle('flying', active);
        if (active) {
            this.canvas.focus({ preventScroll: true });
            // Refused where there is no mouse: then dragging looks around. Older browsers return nothing.
            void Promise.resolve(this.canvas.requestPointerLock() as unknown).catch(() => {});
        } else if (document.pointerLockElement) {
            document.exitPointerLock();
        }
    }
}
