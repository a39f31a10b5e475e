/** A hash of the engine's files, by vite.config.ts. */
declare const __ENGINE_VERSION__: string;
