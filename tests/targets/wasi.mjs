// wasi.mjs PROGRAM.wasm [ARGUMENT ...]: runs a program of WASI under Node, with all folders of this machine. WASI has no
// working folder: the environment's PWD tells the program that of the caller. With BRIO_CLOSED in the environment the program finds its
// standard streams closed, which a host may do, though Node never does.
import { readFile } from 'node:fs/promises';
import { argv, env, exit, cwd } from 'node:process';
import { WASI } from 'node:wasi';

const [, , program, ...words] = argv;
const wasi = new WASI({ version: 'preview1', args: ['brio', ...words], env: { ...env, PWD: cwd() }, preopens: { '/': '/' }, returnOnExit: true });
const module = await WebAssembly.compile(await readFile(program));
const imports = wasi.getImportObject();
if (env.BRIO_CLOSED) {
    const { fd_close, fd_prestat_get } = imports.wasi_snapshot_preview1;
    const close = (...of) => ([0, 1, 2].forEach((stream) => fd_close(stream)), fd_prestat_get(...of)); // what a program asks first
    imports.wasi_snapshot_preview1 = { ...imports.wasi_snapshot_preview1, fd_prestat_get: close };
}
const instance = await WebAssembly.instantiate(module, imports);
exit(wasi.start(instance));
