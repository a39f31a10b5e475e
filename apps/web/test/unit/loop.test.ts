import { describe, expect, it } from 'vitest';
import type { StepResult, Vector } from '../../src/engine';
import { Loop, type LoopEngine, type LoopHost } from '../../src/loop';
import type { Status } from '../../src/protocol';

/** An engine whose sample takes `cost` ms in `parts` sub-images, on a clock that only work moves. */
class FakeEngine implements LoopEngine {
    time = 0;
    done = 0; // sub-images since the last reset
    limit = 4;
    log: string[] = [];
    surface = Infinity;
    hit: Vector | null = [0, 0, -2];

    constructor(
        private readonly cost: number,
        private readonly parts = 4,
    ) {}

    private reset(entry: string): void {
        this.log.push(entry);
        this.done = 0;
    }
    budgets: number[] = [];
    step(budget: number): StepResult {
        this.budgets.push(budget);
        const before = this.done;
        const end = this.time + budget;
        const part = this.cost / this.parts;
        while (this.samples() < this.limit && this.time + part <= Math.max(end, this.time + (this.done === before ? part : 0))) {
            this.time += part;
            this.done++;
        }
        return { samples: this.samples(), changed: this.done !== before, finished: this.samples() >= this.limit };
    }
    showing = 1;
    show(): void {
        this.time += this.showing;
        this.log.push(`show ${this.done}`);
    }
    slow = false;
    tunable = () => this.slow;
    tune(): void {
        this.slow = false;
        this.reset('tune');
    }
    set(path: string, json: string, live: boolean): string {
        if (live) this.slow = true;
        if (path === 'wrong') throw new Error('unknown part');
        if (path === 'post.exposure') return this.log.push(`${path}=${json}`), 'present';
        this.reset(`${path}=${json}`);
        return 'samples';
    }
    samples = () => Math.floor(this.done / this.parts);
    progress = () => (this.done % this.parts) / this.parts;
    width = () => 100;
    height = () => 100;
    orbit = (yaw: number) => this.reset(`orbit ${yaw}`);
    pan = () => this.reset('pan');
    zoom = (factor: number) => this.reset(`zoom ${factor.toFixed(2)}`);
    zoomAround = (x: number, y: number, z: number, factor: number) => this.reset(`zoom around ${[x, y, z].join(' ')} by ${factor}`);
    look = () => this.reset('look');
    fly = (right: number, up: number, back: number) => this.reset(`fly ${[right, up, back].map((v) => v.toFixed(3)).join(' ')}`);
    aim = (x: number, y: number, z: number) => this.reset(`aim ${[x, y, z].map((v) => v.toFixed(1)).join(' ')}`);
    toTarget = (): Vector => [0, 0, -1];
    pointAt = () => this.hit;
    focusAt(x: number, y: number): boolean {
        if (this.hit) this.reset(`focus ${x} ${y}`);
        return this.hit !== null;
    }
    empty = '';
    emptyReason = () => this.empty;
    distanceToSurface = () => this.surface;
    distanceToTarget = () => 1;
    flies = true;
    autopilot(dive: boolean, speed: number, seconds: number): boolean {
        if (this.flies) this.reset(`${dive ? 'dive' : 'rise'} ${(speed * seconds).toFixed(3)}`);
        return this.flies;
    }
    scalePower = (): number | null => (this.flies ? -12 : null);
}

function rig(cost: number) {
    const engine = new FakeEngine(cost);
    const tasks: { frame: boolean; run: () => void }[] = [];
    const statuses: Status[] = [];
    const errors: unknown[] = [];
    let documents = 0;
    const host: LoopHost = {
        now: () => engine.time,
        frame: (run) => tasks.push({ frame: true, run }),
        soon: (run) => tasks.push({ frame: false, run }),
        status: (status) => statuses.push(status),
        documentChanged: () => documents++,
        failed: (error) => errors.push(error),
    };
    const loop = new Loop(engine, host, () => engine.limit);
    const tick = () => {
        const task = tasks.shift();
        if (!task) return false;
        if (task.frame) engine.time = 16 * Math.floor(engine.time / 16 + 1);
        task.run();
        return true;
    };
    const settle = () => {
        for (let i = 0; i < 1000; i++) if (!tick()) return;
        throw new Error('the loop never comes to rest');
    };
    return { engine, loop, tick, settle, tasks, statuses, errors, documents: () => documents };
}

const orbit = (yaw: number) => ({ kind: 'orbit', yaw, pitch: 0 }) as const;

describe('the loop', () => {
    it('works until the limit and then does nothing at all', () => {
        const { engine, loop, settle, tasks, statuses } = rig(20);
        loop.restarted();
        settle();
        expect(engine.samples()).toBe(4);
        expect(tasks).toEqual([]);
        expect(statuses.at(-1)).toMatchObject({ state: 'finished', samples: 4, moving: false });
        expect(engine.log.at(-1)).toBe('show 16');
    });

    it('takes moves also after a scene was opened again that needs no new samples', () => {
        const { engine, loop, settle } = rig(20);
        loop.restarted();
        settle();
        loop.restarted();
        settle();
        loop.motion(orbit(1));
        settle();
        expect(engine.log).toContain('orbit 1');
    });

    it('adds moves up and applies them once per picture', () => {
        const { engine, loop, settle } = rig(20);
        loop.restarted();
        settle();
        loop.motion(orbit(1));
        loop.motion(orbit(2));
        settle();
        expect(engine.log.filter((entry) => entry.startsWith('orbit'))).toEqual(['orbit 3']);
        expect(engine.samples()).toBe(4);
    });

    it('flies by itself, picture by picture, until someone else moves', () => {
        const { engine, loop, settle, tick, statuses } = rig(4);
        loop.restarted();
        settle();
        loop.motion({ kind: 'autopilot', way: 'dive', speed: 2 });
        for (let i = 0; i < 20; i++) tick();
        const dives = engine.log.filter((entry) => entry.startsWith('dive'));
        expect(dives.length).toBeGreaterThan(5);
        expect(statuses.at(-1)).toMatchObject({ autopilot: 'dive', moving: true, scale: -12 });
        loop.motion(orbit(1));
        settle();
        expect(engine.log.slice(engine.log.indexOf('orbit 1')).some((entry) => entry.startsWith('dive'))).toBe(false);
        expect(statuses.at(-1)).toMatchObject({ autopilot: null, moving: false, state: 'finished' });
    });

    it('does not fly by itself where the subject cannot', () => {
        const { engine, loop, settle, statuses } = rig(4);
        engine.flies = false;
        loop.restarted();
        settle();
        loop.motion({ kind: 'autopilot', way: 'rise', speed: 2 });
        settle();
        expect(statuses.at(-1)).toMatchObject({ autopilot: null, scale: null, state: 'finished' });
    });

    it('shows something between moves, however slow the device', () => {
        const { engine, loop, tick } = rig(4000);
        loop.restarted();
        for (let i = 0; i < 60; i++) {
            loop.motion(orbit(1));
            tick();
        }
        const entries = engine.log.map((entry) => entry.split(' ')[0]);
        expect(entries.filter((entry) => entry === 'orbit').length).toBeGreaterThan(3);
        entries.forEach((entry, index) => {
            if (entry === 'orbit') expect(entries[index - 1]).toBe('show');
        });
    });

    it('keeps frames short while moving and lets steps grow at rest', () => {
        const { engine, loop, tick, settle } = rig(4);
        engine.limit = 1e9;
        loop.restarted();
        for (let i = 0; i < 30; i++) tick();
        const restStart = engine.time;
        tick();
        expect(engine.time - restStart).toBeGreaterThan(90);
        loop.motion(orbit(1));
        tick();
        loop.motion(orbit(1));
        const start = engine.time;
        tick();
        expect(engine.time - start).toBeLessThan(34);
        engine.limit = 0;
        settle();
    });

    it('works while moving for a part of the time that showing takes, where that takes long', () => {
        const { engine, loop, tick, settle } = rig(4);
        loop.restarted();
        settle();
        const moves = (showing: number) => {
            engine.showing = showing;
            for (let i = 0; i < 20; i++) {
                loop.motion(orbit(1));
                tick();
            }
            return engine.budgets.at(-1)!;
        };
        expect(moves(1)).toBeLessThan(16);
        expect(moves(80)).toBeGreaterThan(35);
        expect(moves(800)).toBe(100);
    });

    it('shows the first of a picture at once, at rest no more than a fifth of the time, and the last of it', () => {
        const { engine, loop, settle } = rig(400);
        engine.showing = 100;
        engine.limit = 10;
        loop.restarted();
        settle();
        const shows = engine.log.filter((entry) => entry.startsWith('show'));
        expect(shows[0]).toBe('show 1');
        expect(shows.at(-1)).toBe('show 40');
        expect(shows.length).toBeGreaterThan(5);
        expect(shows.length).toBeLessThanOrEqual(2 + (10 * 400) / 400);
    });

    it('shows an edit of how the picture looks at once', () => {
        const { engine, loop, tick } = rig(400);
        engine.showing = 100;
        engine.limit = 10;
        loop.restarted();
        for (let i = 0; i < 5; i++) tick();
        void loop.edit('post.exposure', 1, false);
        const before = engine.log.length;
        tick();
        expect(engine.log.slice(before)).toEqual(['post.exposure=1', `show ${engine.done}`]);
    });

    it('tells of a changed document once the camera has come to rest', () => {
        const { loop, settle, documents } = rig(20);
        loop.restarted();
        settle();
        for (let i = 0; i < 5; i++) loop.motion(orbit(1));
        expect(documents()).toBe(0);
        settle();
        expect(documents()).toBe(1);
    });

    it('applies only the last of the live edits of a slider, and all others', async () => {
        const { engine, loop, settle } = rig(20);
        loop.restarted();
        settle();
        engine.log = [];
        const edits = [loop.edit('a', 1, true), loop.edit('a', 2, true), loop.edit('a', 3, false), loop.edit('b', null, false), loop.edit('b', null, false)];
        settle();
        await Promise.all(edits);
        expect(engine.log.filter((entry) => entry.includes('='))).toEqual(['a=3', 'b=null', 'b=null']);
    });

    it('makes the kernels for the present values when a slider has come to rest, and shows nothing coarse meanwhile', () => {
        const { engine, loop, settle } = rig(20);
        loop.restarted();
        settle();
        engine.log = [];
        void loop.edit('a', 1, true);
        void loop.edit('a', 2, true);
        settle();
        expect(engine.log.filter((entry) => !entry.startsWith('show'))).toEqual(['a=2', 'tune']);
        expect(engine.log.slice(engine.log.indexOf('tune') + 1)[0]).not.toMatch(/show [0-3]$/);
        expect(engine.log.at(-1)).toBe('show 16');
    });

    it('refuses a wrong edit and goes on', async () => {
        const { engine, loop, settle, documents } = rig(20);
        loop.restarted();
        settle();
        const wrong = loop.edit('wrong', 1, false);
        const right = loop.edit('a', 1, false);
        settle();
        await expect(wrong).rejects.toThrow('unknown part');
        await expect(right).resolves.toBeNull();
        expect(documents()).toBe(1);
        expect(engine.samples()).toBe(4);
    });

    it('shows an edit of the post chain without new samples, also when finished or paused', () => {
        for (const paused of [false, true]) {
            const { engine, loop, settle } = rig(20);
            loop.restarted();
            settle();
            loop.pause(paused);
            settle();
            engine.log = [];
            void loop.edit('post.exposure', 1, false);
            settle();
            expect(engine.log).toEqual(['post.exposure=1', 'show 16']);
        }
    });

    it('when paused, finishes one sample of a new view and no more', () => {
        const { engine, loop, settle, statuses } = rig(200);
        loop.pause(true);
        loop.restarted();
        settle();
        expect(engine.samples()).toBe(1);
        expect(statuses.at(-1)!.state).toBe('paused');
        loop.pause(false);
        settle();
        expect(engine.samples()).toBe(4);
    });

    it('zooms to what is under the cursor, which is looked up once per gesture', () => {
        const { engine, loop, tick, settle } = rig(20);
        loop.restarted();
        settle();
        engine.log = [];
        loop.motion({ kind: 'zoom', factor: 0.5, at: { x: 0.5, y: 0.5 } });
        tick();
        tick();
        engine.hit = [9, 9, 9];
        loop.motion({ kind: 'zoom', factor: 0.5, at: { x: 0.5, y: 0.5 } });
        settle();
        expect(engine.log.filter((entry) => entry.startsWith('zoom'))).toEqual(['zoom around 0 0 -2 by 0.5', 'zoom around 0 0 -1 by 0.5']);
    });

    it('never zooms through a surface in front of the target', () => {
        const { engine, loop, settle } = rig(20);
        engine.hit = null;
        engine.surface = 0.1;
        loop.restarted();
        settle();
        loop.motion({ kind: 'zoom', factor: 0.5, at: { x: 0.9, y: 0.5 } });
        settle();
        expect(engine.log.find((entry) => entry.startsWith('zoom'))).toBe('zoom 0.93');
    });

    it('flies at a speed that follows the distance to the surface', () => {
        for (const surface of [1, 1e-4]) {
            const { engine, loop, tick, settle } = rig(4);
            engine.surface = surface;
            loop.restarted();
            settle();
            loop.motion({ kind: 'fly', right: 0, up: 0, ahead: 1, speed: 1 });
            const start = engine.time;
            for (let i = 0; i < 10; i++) tick();
            const way = engine.log.filter((entry) => entry.startsWith('fly')).reduce((sum, entry) => sum - Number(entry.split(' ')[3]), 0);
            if (surface === 1) expect(way).toBeCloseTo((engine.time - start) / 1000, 1);
            else expect(way).toBeLessThan(0.01);
            loop.motion({ kind: 'fly', right: 0, up: 0, ahead: 0, speed: 1 });
            settle();
        }
    });

    it('tells why there is nothing to see once that is known, and forgets it with the next move', () => {
        const { engine, loop, tick, settle, statuses } = rig(20);
        engine.empty = 'inside';
        loop.restarted();
        expect(statuses.at(-1)!.emptyReason).toBe('');
        settle();
        expect(statuses.at(-1)!.emptyReason).toBe('inside');
        engine.empty = '';
        loop.motion(orbit(1));
        tick();
        loop.pause(true);
        expect(statuses.at(-1)!.emptyReason).toBe('');
        settle();
        expect(statuses.at(-1)!.emptyReason).toBe('');
    });

    it('turns to a new target smoothly and ends exactly there', () => {
        const { engine, loop, settle } = rig(4);
        engine.hit = [1, 0, 0];
        loop.restarted();
        settle();
        expect(loop.focus(0.5, 0.5)).toBe(true);
        settle();
        const aims = engine.log.filter((entry) => entry.startsWith('aim'));
        expect(aims.length).toBeGreaterThan(5);
        expect(aims.at(-1)).toBe('aim 1.0 0.0 0.0');
        engine.hit = null;
        expect(loop.focus(0.5, 0.5)).toBe(false);
    });

    it('makes sharp what is seen at a point, without turning', () => {
        const { engine, loop, settle, documents } = rig(20);
        loop.restarted();
        settle();
        engine.log = [];
        expect(loop.sharpen(0.25, 0.5)).toBe(true);
        settle();
        expect(engine.log.filter((entry) => !entry.startsWith('show'))).toEqual(['focus 25 50']);
        expect(engine.log.at(-1)).toBe('show 16');
        expect(documents()).toBe(1);
        engine.hit = null;
        expect(loop.sharpen(0.5, 0.5)).toBe(false);
    });

    it('tells of failures and still takes edits that may mend them', async () => {
        const { engine, loop, settle, errors } = rig(20);
        const step = engine.step.bind(engine);
        engine.step = () => {
            throw new Error('out of memory');
        };
        loop.restarted();
        settle();
        expect(errors).toHaveLength(1);
        engine.step = step;
        const edit = loop.edit('a', 1, false);
        settle();
        await expect(edit).resolves.toBeNull();
        expect(engine.samples()).toBe(4);
    });
});
