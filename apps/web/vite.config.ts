import { createHash } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { defineConfig } from 'vitest/config';

/** The engine's files keep their names: a query tells browsers that they changed. */
function engineVersion(): string {
    const hash = createHash('sha256');
    for (const name of ['apeiron.js', 'apeiron.wasm']) {
        const path = fileURLToPath(new URL(`public/engine/${name}`, import.meta.url));
        if (existsSync(path)) hash.update(readFileSync(path));
    }
    return hash.digest('hex').slice(0, 12);
}

export default defineConfig({
    base: './', // works from any folder of a server
    define: { __ENGINE_VERSION__: JSON.stringify(engineVersion()) },
    worker: { format: 'es' },
    build: { target: 'es2022' },
    test: { include: ['test/**/*.test.ts'], testTimeout: 20_000 },
});
