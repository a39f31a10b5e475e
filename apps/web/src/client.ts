// The page's side of the worker.
import { Requester, type Answer, type Ask, type FromWorker, type Motion, type RequestName, type ToWorker } from './protocol';

export type Notice = Exclude<FromWorker, { type: 'answer' | 'refused' }>;

export class Client {
    private readonly worker: Worker;
    private readonly requester: Requester;

    constructor(onNotice: (notice: Notice) => void) {
        this.worker = new Worker(new URL('./worker.ts', import.meta.url), { type: 'module', name: 'apeiron' });
        this.requester = new Requester((message, transfer) => this.worker.postMessage(message, transfer));
        this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
            if (!this.requester.receive(data)) onNotice(data as Notice);
        };
        this.worker.onerror = (event) => {
            const message = event.message || 'the worker could not be started';
            this.requester.abandon(new Error(message));
            onNotice({ type: 'error', message });
        };
    }

    request<N extends RequestName>(name: N, ask: Ask<N>, transfer: Transferable[] = []): Promise<Answer<N>> {
        return this.requester.request(name, ask, transfer);
    }

    motion(motion: Motion): void {
        this.worker.postMessage({ type: 'motion', motion } satisfies ToWorker);
    }

    pause(paused: boolean): void {
        this.worker.postMessage({ type: 'pause', paused } satisfies ToWorker);
    }
}
