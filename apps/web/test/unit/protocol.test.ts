import { describe, expect, it } from 'vitest';
import { Requester, type ToWorker } from '../../src/protocol';

function requester(): { requester: Requester; sent: ToWorker[] } {
    const sent: ToWorker[] = [];
    return { requester: new Requester((message) => sent.push(message)), sent };
}

describe('requests', () => {
    it('get their own answers, in whatever order these come', async () => {
        const { requester: r, sent } = requester();
        const first = r.request('gallery', { name: 'a' });
        const second = r.request('focus', { x: 0.5, y: 0.5 });
        expect(sent.map((message) => message.type === 'request' && [message.id, message.name])).toEqual([[1, 'gallery'], [2, 'focus']]);
        expect(r.receive({ type: 'answer', id: 2, answer: true })).toBe(true);
        expect(r.receive({ type: 'answer', id: 1, answer: null })).toBe(true);
        await expect(second).resolves.toBe(true);
        await expect(first).resolves.toBeNull();
    });

    it("are refused with the engine's words", async () => {
        const { requester: r } = requester();
        const load = r.request('load', { text: '{', name: 'x.json' });
        r.receive({ type: 'refused', id: 1, message: 'x.json:1: unexpected end' });
        await expect(load).rejects.toThrow('x.json:1: unexpected end');
    });

    it('fail when nobody will answer', async () => {
        const { requester: r } = requester();
        const png = r.request('png', {});
        r.abandon(new Error('the worker has died'));
        await expect(png).rejects.toThrow('the worker has died');
    });

    it('leave other messages alone', () => {
        const { requester: r } = requester();
        expect(r.receive({ type: 'error', message: 'x' })).toBe(false);
    });
});
