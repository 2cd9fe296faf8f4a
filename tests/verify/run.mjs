// Prints the table of a WebAssembly build: node run.mjs verify.wasm
import { readFileSync } from "node:fs";

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), {});
const { memory, table_start, table_length } = instance.exports;
const [start, length] = [table_start(), table_length()];
process.stdout.write(new TextDecoder().decode(new Uint8Array(memory.buffer, start, length)));
