// The rendering loop of the worker: works in steps, shows what they brought, and puts moves and edits between them. Knows
// neither the worker nor the browser, so that tests can run it.
import type { Engine, Vector } from './engine';
import type { Motion, RunState, Status } from './protocol';
import type { Json } from './schema';

export interface LoopHost {
    /** [ms] */
    now(): number;
    /** Calls back before the display's next picture. */
    frame(callback: () => void): void;
    /** Calls back as soon as waiting messages have been seen. */
    soon(callback: () => void): void;
    status(status: Status): void;
    /** The document has changed, and does not change again at once. */
    documentChanged(): void;
    failed(error: unknown): void;
}

export type LoopEngine = Pick<
    Engine,
    | 'step' | 'show' | 'set' | 'tunable' | 'tune' | 'samples' | 'progress' | 'width' | 'height' | 'orbit' | 'pan' | 'zoom' | 'zoomAround' | 'look'
    | 'fly' | 'aim' | 'toTarget' | 'pointAt' | 'focusAt' | 'emptyReason' | 'distanceToSurface' | 'distanceToTarget'
    | 'autopilot' | 'scalePower'
>;

/** Still moving so long after the last move [ms]. */
const kSettle = 160;
/** A frame while moving, on devices that finish a sample in it, and on others [ms]. */
const kFrame = 15;
const kSlowFrame = 30;
const kLeastBudget = 10;
/** Work while moving takes at least this part of what showing does: frames that bring next to nothing new only smear the old picture. */
const kMovingWork = 0.5;
/** At rest, steps grow from the first to the last [ms]. */
const kFirstRest = 16;
const kLongestRest = 100;
const kRestGrowth = 1.4;
/** At rest, pictures are worked for so many times as long as showing them takes. */
const kWorkPerShow = 4;
const kStatusInterval = 120;
/** After so long without an edit, the kernels are made for the present values [ms]. */
const kTuneAfter = 600;
/** Turning towards a new target [ms]. */
const kAimTime = 350;
/** A pause between wheel events that ends a zoom [ms], and so does a cursor that moves further [of the picture]. */
const kZoomPause = 350;
const kZoomReach = 0.01;
/** No single move goes further than this part of the free way ahead. */
const kNearest = 0.7;

interface Edit {
    path: string;
    value: Json;
    live: boolean;
    resolve: (answer: null) => void;
    reject: (error: unknown) => void;
}

export class Loop {
    private scheduled = false;
    private stopped = false;
    private paused = false;
    private finished = false;
    /** Something of the present state has been shown: only then may the next move forget it. */
    private shown = false;
    private mustShow = false;
    /** What is shown stays until so much of a sample is there again: the view is the same. */
    private hold = 0;
    private documentStale = false;

    private orbit = { yaw: 0, pitch: 0 };
    private pan = { right: 0, up: 0 };
    private look = { yaw: 0, pitch: 0 };
    private zoom: { factor: number; at: { x: number; y: number } | null } = { factor: 1, at: null };
    private waitingMotion = false;
    private flight: (Motion & { kind: 'fly' }) | null = null;
    private pilot: (Motion & { kind: 'autopilot' }) | null = null;
    private flownAt = 0;
    private anchor: { at: { x: number; y: number }; time: number; point: Vector | null } | null = null;
    private aim: { from: Vector; to: Vector; start: number } | null = null;
    private edits: Edit[] = [];

    private movedAt = -Infinity;
    private editedAt = -Infinity;
    private restBudget = kFirstRest;
    private fast = true;
    private showMs = 0;
    private stepMs = 0;
    private workMs = 0;
    /** Of workMs, what was done when the picture was last shown. */
    private shownWorkMs = 0;
    private distance: number | null = null;
    private emptyReason = '';
    private shownAt: number[] = [];
    private reported: RunState | null = null;
    private reportedAt = -Infinity;

    constructor(
        private readonly engine: LoopEngine,
        private readonly host: LoopHost,
        /** Where the scene says to stop. */
        private readonly limit: () => number,
    ) {}

    motion(motion: Motion): void {
        if (motion.kind !== 'look') this.pilot = null;
        switch (motion.kind) {
            case 'orbit':
                this.orbit.yaw += motion.yaw;
                this.orbit.pitch += motion.pitch;
                break;
            case 'pan':
                this.pan.right += motion.right;
                this.pan.up += motion.up;
                break;
            case 'look':
                this.look.yaw += motion.yaw;
                this.look.pitch += motion.pitch;
                break;
            case 'zoom':
                this.zoom.factor *= motion.factor;
                this.zoom.at = motion.at;
                break;
            case 'fly':
                if (motion.right || motion.up || motion.ahead) {
                    if (!this.flight) this.flownAt = this.host.now();
                    this.flight = motion;
                } else {
                    this.flight = null;
                }
                this.wake();
                return;
            case 'autopilot':
                if (motion.way) {
                    this.flownAt = this.host.now();
                    this.pilot = motion;
                }
                this.report(true);
                this.wake();
                return;
        }
        this.waitingMotion = true;
        this.wake();
    }

    /** Turns towards what is seen at a point of the picture; whether there is anything. */
    focus(x: number, y: number): boolean {
        this.finishAim();
        const to = this.engine.pointAt(...this.pixelAt(x, y));
        if (!to) return false;
        this.aim = { from: this.engine.toTarget(), to, start: this.host.now() };
        this.wake();
        return true;
    }

    /** Makes sharp what is seen at a point of the picture, without turning; whether there is anything. */
    sharpen(x: number, y: number): boolean {
        this.finishAim();
        if (!this.engine.focusAt(...this.pixelAt(x, y))) return false;
        this.documentStale = true;
        this.forgetSamples();
        this.wake();
        return true;
    }

    edit(path: string, value: Json, live: boolean): Promise<null> {
        return new Promise((resolve, reject) => {
            const last = this.edits.at(-1);
            if (last && last.live && last.path === path) {
                last.resolve(null);
                this.edits.pop();
            }
            this.edits.push({ path, value, live, resolve, reject });
            this.wake();
        });
    }

    pause(paused: boolean): void {
        this.paused = paused;
        this.report(true);
        this.wake();
    }

    /** Another scene or size: nothing of it has been shown. */
    restarted(): void {
        this.pilot = null;
        this.forgetMoves();
        this.forgetSamples();
        this.report(true);
        this.wake();
    }

    /** Works until there is something to see, and shows it: before the browser shows an emptied canvas. */
    showNow(budgetMs: number): void {
        const end = this.host.now() + budgetMs;
        this.forgetSamples();
        while (!this.shown && this.host.now() < end) {
            if (this.engine.step(Math.max(end - this.host.now(), 1)).changed) this.showPicture();
        }
        this.wake();
    }

    stop(): void {
        this.stopped = true;
        for (const edit of this.edits) edit.reject(new Error('the engine has stopped'));
        this.edits = [];
    }

    private wake(): void {
        if (this.scheduled || this.stopped) return;
        this.scheduled = true;
        const run = () => {
            this.scheduled = false;
            if (this.stopped) return;
            try {
                this.tick();
            } catch (error) {
                // What the engine refuses to draw must still be open to edits.
                this.shown = true;
                this.host.failed(error);
            }
        };
        // Showing more often than the display does is lost work; before there is anything to show, waiting is.
        if (this.shown && (this.finished || this.moving())) this.host.frame(run);
        else this.host.soon(run);
    }

    private moving(): boolean {
        return this.flight !== null || this.pilot !== null || this.aim !== null || this.waitingMotion || this.host.now() - this.movedAt < kSettle;
    }

    private tick(): void {
        const start = this.host.now();
        // A state that was not seen at all is not given up: otherwise slow devices would show nothing during a move.
        if (this.shown) {
            this.applyEdits();
            if (this.applyMotions(start)) {
                this.movedAt = start;
                this.documentStale = true;
                this.forgetSamples();
            }
        }
        this.report(false);
        const moving = this.moving();
        if (this.engine.tunable() && this.shown && !moving && start - this.editedAt > kTuneAfter) {
            const done = this.done();
            this.engine.tune();
            this.forgetSamples();
            this.shown = true;
            this.hold = done;
        }
        const resting = this.paused && this.shown && this.engine.samples() > 0 && !moving;
        if (!resting) {
            const result = this.engine.step(this.budget(moving));
            this.finished = result.finished;
            if (moving) this.fast = result.samples > 0;
            this.stepMs = this.host.now() - start;
            this.workMs += this.stepMs;
            // A scene that was opened again keeps its samples: nothing changes, but it has to be seen.
            if (result.changed || (!this.shown && result.samples > 0)) this.mustShow = true;
        }
        const worth = moving || resting || !this.shown || this.finished || this.workMs - this.shownWorkMs >= kWorkPerShow * this.showMs;
        if (this.mustShow && worth && this.done() >= this.hold) {
            this.showPicture();
            this.stepMs = this.host.now() - start;
        }
        if (!moving && this.documentStale) {
            this.documentStale = false;
            this.host.documentChanged();
        }
        if (!moving && this.distance === null && this.engine.samples() > 0) {
            this.distance = this.engine.distanceToSurface();
            this.emptyReason = this.engine.emptyReason();
        }
        const idle = !moving && (this.finished || resting) && this.edits.length === 0 && !this.engine.tunable();
        this.report(idle);
        if (!idle) this.wake();
    }

    /** The part of the first sample that is there, 0..1. */
    private done(): number {
        return this.engine.samples() > 0 ? 1 : this.engine.progress();
    }

    private budget(moving: boolean): number {
        if (moving) {
            this.restBudget = kFirstRest;
            return Math.max((this.fast ? kFrame : kSlowFrame) - this.showMs, kLeastBudget, Math.min(kMovingWork * this.showMs, kLongestRest));
        }
        const budget = Math.max(this.restBudget, kWorkPerShow * this.showMs);
        this.restBudget *= kRestGrowth;
        return Math.min(budget, kLongestRest);
    }

    private showPicture(): void {
        const start = this.host.now();
        this.engine.show();
        const end = this.host.now();
        this.showMs = this.showMs === 0 ? end - start : 0.8 * this.showMs + 0.2 * (end - start);
        this.shown = true;
        this.shownWorkMs = this.workMs;
        this.mustShow = false;
        this.shownAt = this.shownAt.filter((time) => end - time < 1000);
        this.shownAt.push(end);
    }

    private mustShowAtOnce(): void {
        this.mustShow = true;
        this.shownWorkMs = Number.NEGATIVE_INFINITY;
    }

    private forgetSamples(): void {
        this.shown = false;
        this.hold = 0;
        this.mustShow = false;
        this.finished = false;
        this.distance = null;
        this.emptyReason = '';
        this.workMs = 0;
        this.shownWorkMs = 0;
    }

    private forgetMoves(): void {
        this.orbit = { yaw: 0, pitch: 0 };
        this.pan = { right: 0, up: 0 };
        this.look = { yaw: 0, pitch: 0 };
        this.zoom = { factor: 1, at: null };
        this.waitingMotion = false;
        this.anchor = null;
        this.aim = null;
    }

    private applyEdits(): void {
        const edits = this.edits;
        this.edits = [];
        if (edits.length > 0) this.editedAt = this.host.now();
        for (const edit of edits) {
            try {
                const stale = this.engine.set(edit.path, JSON.stringify(edit.value), edit.live);
                if (stale === 'samples' || stale === 'program') this.forgetSamples();
                else if (this.shown) this.mustShowAtOnce();
                this.finished = false;
                if (edit.live) this.movedAt = this.editedAt;
                else this.documentStale = true;
                edit.resolve(null);
            } catch (error) {
                // The panel takes back what was refused.
                this.documentStale = true;
                edit.reject(error);
            }
        }
    }

    private applyMotions(now: number): boolean {
        if (this.waitingMotion) {
            this.finishAim();
            const { orbit, pan, look, zoom } = this;
            const anchor = this.anchor;
            this.forgetMoves();
            if (zoom.factor !== 1) {
                this.anchor = anchor;
                this.applyZoom(zoom.factor, zoom.at, now);
            }
            if (orbit.yaw || orbit.pitch) this.engine.orbit(orbit.yaw, orbit.pitch);
            if (pan.right || pan.up) this.engine.pan(pan.right, pan.up);
            if (look.yaw || look.pitch) this.engine.look(look.yaw, look.pitch);
            if (orbit.yaw || orbit.pitch || pan.right || pan.up) this.anchor = null;
            if (this.flight) this.applyFlight(now);
            return true;
        }
        if (this.flight) {
            this.applyFlight(now);
            return true;
        }
        if (this.pilot) {
            const seconds = this.secondsFlown(now);
            if (!this.engine.autopilot(this.pilot.way === 'dive', this.pilot.speed, seconds)) this.pilot = null;
            return true;
        }
        if (this.aim) {
            const { from, to, start } = this.aim;
            const t = Math.min((now - start) / kAimTime, 1);
            if (t === 1) {
                this.finishAim();
            } else {
                const s = t * t * (3 - 2 * t);
                const mix = (i: 0 | 1 | 2) => from[i] + s * (to[i] - from[i]);
                this.engine.aim(mix(0), mix(1), mix(2));
            }
            return true;
        }
        return false;
    }

    private pixelAt(x: number, y: number): [number, number] {
        return [Math.floor(x * this.engine.width()), Math.floor(y * this.engine.height())];
    }

    private finishAim(): void {
        if (!this.aim) return;
        this.engine.aim(...this.aim.to);
        this.aim = null;
    }

    private applyZoom(factor: number, at: { x: number; y: number } | null, now: number): void {
        if (at) {
            let { anchor } = this;
            const same =
                anchor && now - anchor.time < kZoomPause && Math.hypot(at.x - anchor.at.x, at.y - anchor.at.y) < kZoomReach;
            if (!anchor || !same) {
                anchor = { at, time: now, point: this.engine.pointAt(...this.pixelAt(at.x, at.y)) };
            }
            anchor.time = now;
            this.anchor = anchor;
            if (anchor.point) {
                const [x, y, z] = anchor.point;
                this.engine.zoomAround(x, y, z, factor);
                anchor.point = [factor * x, factor * y, factor * z];
                return;
            }
        }
        // Towards the target, which may lie behind a surface: never through it.
        let allowed = factor;
        if (factor < 1) {
            const free = this.engine.distanceToSurface();
            if (Number.isFinite(free)) allowed = Math.max(factor, 1 - (kNearest * free) / this.engine.distanceToTarget());
        }
        if (allowed > 0 && allowed !== 1) this.engine.zoom(allowed);
    }

    /** Since the last time; no jumps where a picture takes long. */
    private secondsFlown(now: number): number {
        const seconds = Math.min(now - this.flownAt, 100) / 1000;
        this.flownAt = now;
        return seconds;
    }

    private applyFlight(now: number): void {
        const flight = this.flight!;
        const seconds = this.secondsFlown(now);
        const target = this.engine.distanceToTarget();
        let free = this.engine.distanceToSurface();
        if (!Number.isFinite(free)) free = target;
        // Someone who got inside a surface gets out again.
        if (free < 1e-6 * target) free = 1e-2 * target;
        const way = Math.min(flight.speed * free * seconds, kNearest * free);
        const length = Math.hypot(flight.right, flight.up, flight.ahead);
        const scale = way / length;
        this.engine.fly(flight.right * scale, flight.up * scale, -flight.ahead * scale);
    }

    /** Tells how things stand: at once when they have changed in kind, else now and then. */
    private report(now: boolean): void {
        const time = this.host.now();
        const state: RunState = this.paused ? 'paused' : this.finished ? 'finished' : 'rendering';
        if (!now && state === this.reported && time - this.reportedAt < kStatusInterval) return;
        this.reported = state;
        this.reportedAt = time;
        const samples = this.engine.samples();
        const recent = this.shownAt.filter((shown) => time - shown < 1000);
        const span = recent.length > 1 ? recent.at(-1)! - recent[0]! : 0;
        this.host.status({
            state,
            samples,
            limit: this.limit(),
            progress: this.engine.progress(),
            moving: this.moving(),
            fps: span > 0 ? (1000 * (recent.length - 1)) / span : 0,
            stepMs: this.stepMs,
            sampleMs: samples > 0 ? this.workMs / samples : 0,
            size: { width: this.engine.width(), height: this.engine.height() },
            distance: this.distance,
            scale: this.engine.scalePower(),
            autopilot: this.pilot?.way ?? null,
            emptyReason: this.emptyReason,
        });
    }
}
