// A file system in memory for the module, as much of WASI preview 1 as brio asks for: files that are written, renamed and
// read within one call. Nothing of it reaches the page's machine.

const OK = 0, BAD_FILE = 8, EXISTS = 20, INVALID = 28, MISSING = 44, NOT_HERE = 52;
const FOLDER = 3, FILE = 4, CHARACTERS = 2; // kinds of files
const ROOT = 3; // the descriptor of the one folder
const CREATE = 1, EXCLUSIVE = 4, TRUNCATE = 8;
const ALL_RIGHTS = 0xffffffffffffffffn;

class File {
  constructor() { this.bytes = new Uint8Array(1 << 16); this.size = 0; this.number = File.count++; }
  write(from, place) {
    const end = place + from.length;
    if (end > this.bytes.length) {
      const grown = new Uint8Array(Math.max(end, 2 * this.bytes.length));
      grown.set(this.bytes.subarray(0, this.size));
      this.bytes = grown;
    }
    this.bytes.set(from, place);
    this.size = Math.max(this.size, end);
  }
}
File.count = 1;

export class Files {
  constructor() { this.files = new Map(); this.open = new Map([[ROOT, { folder: true }]]); this.memory = null; this.said = ''; }

  take(name) {
    const file = this.files.get(name);
    this.files.delete(name);
    return file && file.bytes.slice(0, file.size);
  }

  imports() {
    const view = () => new DataView(this.memory.buffer), bytes = (at, size) => new Uint8Array(this.memory.buffer, at, size);
    const name_at = (at, size) => new TextDecoder().decode(bytes(at, size)).replace(/^(\.\/|\/)+/, '') || '.';
    const put_stat = (at, kind, file) => {
      const v = view();
      for (let i = 0; i < 64; i += 8) v.setBigUint64(at + i, 0n, true);
      v.setBigUint64(at + 8, BigInt(file ? file.number : 0), true);
      v.setUint8(at + 16, kind);
      v.setBigUint64(at + 24, 1n, true);
      v.setBigUint64(at + 32, BigInt(file ? file.size : 0), true);
      return OK;
    };
    const each = (at, count, take) => {
      let sum = 0;
      for (let i = 0; i < count; i++) sum += take(bytes(view().getUint32(at + 8 * i, true), view().getUint32(at + 8 * i + 4, true)));
      return sum;
    };
    const write = (number, at, count, place, done) => {
      const opened = this.open.get(number);
      if (number === 1 || number === 2) {
        view().setUint32(done, each(at, count, (b) => { this.said += new TextDecoder().decode(b); return b.length; }), true);
        return OK;
      }
      if (!opened || !opened.file) return BAD_FILE;
      let here = place === undefined ? opened.place : Number(place);
      view().setUint32(done, each(at, count, (b) => { opened.file.write(b, here); here += b.length; return b.length; }), true);
      if (place === undefined) opened.place = here;
      return OK;
    };
    const read = (number, at, count, place, done) => {
      const opened = this.open.get(number);
      if (!opened || !opened.file) return BAD_FILE;
      let here = place === undefined ? opened.place : Number(place);
      view().setUint32(done, each(at, count, (b) => {
        const part = opened.file.bytes.subarray(here, Math.min(here + b.length, opened.file.size));
        b.set(part);
        here += part.length;
        return part.length;
      }), true);
      if (place === undefined) opened.place = here;
      return OK;
    };
    const known = {
      args_sizes_get: (count, size) => { view().setUint32(count, 0, true); view().setUint32(size, 0, true); return OK; },
      args_get: () => OK,
      environ_sizes_get: (count, size) => { view().setUint32(count, 0, true); view().setUint32(size, 0, true); return OK; },
      environ_get: () => OK,
      clock_time_get: (clock, precision, at) => { view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true); return OK; },
      random_get: (at, size) => { crypto.getRandomValues(bytes(at, size)); return OK; },
      sched_yield: () => OK,
      proc_exit: (code) => { throw new Error('brio.wasm ended with ' + code); },
      fd_prestat_get: (number, at) => {
        if (number !== ROOT) return BAD_FILE;
        view().setUint32(at, 0, true);
        view().setUint32(at + 4, 1, true);
        return OK;
      },
      fd_prestat_dir_name: (number, at) => { bytes(at, 1)[0] = 47; return OK; },
      fd_fdstat_get: (number, at) => {
        const opened = this.open.get(number);
        if (!opened && number > 2) return BAD_FILE;
        view().setUint8(at, !opened ? CHARACTERS : opened.folder ? FOLDER : FILE);
        view().setUint16(at + 2, 0, true);
        view().setBigUint64(at + 8, ALL_RIGHTS, true);
        view().setBigUint64(at + 16, ALL_RIGHTS, true);
        return OK;
      },
      fd_filestat_get: (number, at) => {
        const opened = this.open.get(number);
        if (!opened && number > 2) return BAD_FILE;
        return put_stat(at, !opened ? CHARACTERS : opened.folder ? FOLDER : FILE, opened && opened.file);
      },
      path_filestat_get: (folder, flags, path, size, at) => {
        const name = name_at(path, size);
        if (name === '.') return put_stat(at, FOLDER, null);
        return this.files.has(name) ? put_stat(at, FILE, this.files.get(name)) : MISSING;
      },
      path_readlink: (folder, path, size) => (this.files.has(name_at(path, size)) ? INVALID : MISSING),
      path_open: (folder, flags, path, size, how, rights, more, mode, out) => {
        const name = name_at(path, size);
        let number = ROOT + 1;
        while (this.open.has(number)) number++;
        if (name === '.') {
          this.open.set(number, { folder: true });
        } else {
          let file = this.files.get(name);
          if (file && how & CREATE && how & EXCLUSIVE) return EXISTS;
          if (!file && !(how & CREATE)) return MISSING;
          if (!file || how & TRUNCATE) this.files.set(name, (file = new File()));
          this.open.set(number, { file, place: 0 });
        }
        view().setUint32(out, number, true);
        return OK;
      },
      path_rename: (folder, from, from_size, to_folder, to, to_size) => {
        const name = name_at(from, from_size);
        if (!this.files.has(name)) return MISSING;
        this.files.set(name_at(to, to_size), this.files.get(name));
        this.files.delete(name);
        return OK;
      },
      path_unlink_file: (folder, path, size) => (this.files.delete(name_at(path, size)) ? OK : MISSING),
      fd_write: (number, at, count, done) => write(number, at, count, undefined, done),
      fd_pwrite: write,
      fd_read: (number, at, count, done) => read(number, at, count, undefined, done),
      fd_pread: read,
      fd_seek: (number, by, from, out) => {
        const opened = this.open.get(number);
        if (!opened || !opened.file) return BAD_FILE;
        opened.place = Number(by) + (from === 0 ? 0 : from === 1 ? opened.place : opened.file.size);
        view().setBigUint64(out, BigInt(opened.place), true);
        return OK;
      },
      fd_sync: () => OK,
      fd_close: (number) => (this.open.delete(number) ? OK : BAD_FILE),
    };
    return new Proxy(known, { get: (table, name) => table[name] || (() => NOT_HERE) });
  }
}
