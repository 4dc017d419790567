// wasi.mjs PROGRAM.wasm [ARGUMENT ...]: runs a program of WASI under Node, with all folders of this machine. WASI has no
// working folder: the environment's PWD tells the program that of the caller.
import { readFile } from 'node:fs/promises';
import { argv, env, exit, cwd } from 'node:process';
import { WASI } from 'node:wasi';

const [, , program, ...words] = argv;
const wasi = new WASI({ version: 'preview1', args: ['brio', ...words], env: { ...env, PWD: cwd() }, preopens: { '/': '/' }, returnOnExit: true });
const module = await WebAssembly.compile(await readFile(program));
const instance = await WebAssembly.instantiate(module, wasi.getImportObject());
exit(wasi.start(instance));
