/* SPDX-License-Identifier: BSD-2-Clause */
/* engine: libbis as WebAssembly, asked by lists of calls. The same code runs in a page's worker and under node.
 *
 * bisEngine(wasm, files) makes one: wasm is a WebAssembly.Module, files {path: Uint8Array}. What a function takes the
 * library tells itself: bis_flat_signatures (include/bis/flat/flat.h).
 *   engine.run(list)      makes the calls [[name, argument...], ...] in their order. An argument is a number, a text,
 *                         an array, or "#k.j", the j-th array that call k of this list has written; for a written array
 *                         it is its length; for what is opened or was opened a name of the caller's own. A function
 *                         or a flag of C (p) is never given. Returns {out: [[array...]...], hash, seconds}; the hash
 *                         leaves out what the C library's last bits are in. Throws an Error with the library's words;
 *                         after a trap the library starts anew, and nothing of the old one is freed.
 *   engine.put(path, bytes)   adds a file.
 * What was opened by the same arguments is not opened again. A name that is opened anew closes what it had.
 *
 * bisClient(assets) is its face in a page: ask(list) and put(path, bytes) return promises. */
'use strict';
function bisEngine(wasm, files) {
  const ARRAYS = {d: Float64Array, f: Float32Array, u: Uint32Array, b: Uint8Array, i: Int32Array};
  const CLOSES = {light: 'bis_flat_light_close', bsdf: 'bis_flat_bsdf_close', stage: 'bis_flat_stage_close',
    render: 'bis_flat_picture_close'};
  const SAY = 4096;
  let lib, open, opened, waiting, signatures;
  /* Has the library stopped? Its memory may be in any state then, and is left alone. */
  const stopped = (e) => e instanceof WebAssembly.RuntimeError || waiting;

  /* ---- the system: files that are only read, and a clock ---- */

  const view = () => new DataView(lib.memory.buffer);
  const text = (at, n) => new TextDecoder().decode(new Uint8Array(lib.memory.buffer, at, n));
  const clean = (path) => path.split('/').reduce((all, p) => p === '..' ? all.slice(0, -1) : p && p !== '.'
    ? all.concat(p) : all, []).join('/');
  const BADF = 8, NOENT = 44, NOSYS = 52;

  function stat(at, bytes, isFolder) {
    new Uint8Array(lib.memory.buffer, at, 64).fill(0);
    view().setUint8(at + 16, isFolder ? 3 : 4);
    view().setBigUint64(at + 32, BigInt(bytes), true);
    return 0;
  }
  const system = {
    environ_get: () => 0,
    environ_sizes_get(n, size) { view().setUint32(n, 0, true); view().setUint32(size, 0, true); return 0; },
    clock_time_get(id, precision, at) {
      view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    },
    fd_prestat_get(fd, at) {
      if (fd !== 3) return BADF;
      view().setUint8(at, 0);
      view().setUint32(at + 4, 1, true);
      return 0;
    },
    fd_prestat_dir_name(fd, at, n) { new Uint8Array(lib.memory.buffer)[at] = 47; return 0; },
    fd_fdstat_get(fd, at) {
      new Uint8Array(lib.memory.buffer, at, 24).fill(0);
      view().setUint8(at, fd === 3 ? 3 : 4);
      view().setBigUint64(at + 8, 0x1fffffffn, true); /* all rights */
      view().setBigUint64(at + 16, 0x1fffffffn, true);
      return 0;
    },
    fd_filestat_get(fd, at) { const f = open.get(fd); return f ? stat(at, f.bytes.length, false) : BADF; },
    path_filestat_get(fd, flags, path, n, at) {
      const name = clean(text(path, n));
      if (files[name]) return stat(at, files[name].length, false);
      return name === '' || Object.keys(files).some((f) => f.startsWith(name + '/')) ? stat(at, 0, true) : NOENT;
    },
    path_open(fd, look, path, n, flags, rights, inherit, how, at) {
      const bytes = files[clean(text(path, n))];
      if (!bytes || flags) return NOENT;
      for (fd = 4; open.has(fd);) fd++;
      open.set(fd, {bytes, at: 0});
      view().setUint32(at, fd, true);
      return 0;
    },
    fd_read(fd, list, n, at) {
      const f = open.get(fd);
      let all = 0;
      if (!f) return BADF;
      for (let i = 0; i < n; i++) {
        const to = view().getUint32(list + 8 * i, true), room = view().getUint32(list + 8 * i + 4, true),
          part = f.bytes.subarray(f.at, f.at + room);
        new Uint8Array(lib.memory.buffer).set(part, to);
        f.at += part.length;
        all += part.length;
      }
      view().setUint32(at, all, true);
      return 0;
    },
    fd_seek(fd, offset, whence, at) {
      const f = open.get(fd);
      if (!f) return BADF;
      f.at = Number(offset) + [0, f.at, f.bytes.length][whence];
      view().setBigUint64(at, BigInt(f.at), true);
      return 0;
    },
    fd_close(fd) { return open.delete(fd) ? 0 : BADF; },
    fd_write(fd, list, n, at) { /* an assertion's words */
      let all = 0;
      for (let i = 0; i < n; i++) {
        const from = view().getUint32(list + 8 * i, true), size = view().getUint32(list + 8 * i + 4, true);
        waiting += text(from, size);
        all += size;
      }
      view().setUint32(at, all, true);
      return 0;
    },
    proc_exit(code) { throw new Error('the library ended with ' + code); }
  };

  function start() {
    const imports = {};
    for (const one of WebAssembly.Module.imports(wasm)) imports[one.name] = system[one.name] || (() => NOSYS);
    open = new Map();
    opened = {};
    waiting = '';
    lib = new WebAssembly.Instance(wasm, {wasi_snapshot_preview1: imports}).exports;
    lib._initialize();
    signatures = {};
    for (const line of cString(lib.bis_flat_signatures()).trim().split('\n')) {
      const [name, returns, ...taken] = line.split(' ');
      signatures[name] = {hidden: returns[0] === '~', returns: returns.slice(-1),
        letters: taken.map((one) => one.split(':')[1][0])};
    }
  }

  /* ---- a call ---- */

  function claim(list, bytes) {
    const at = lib.malloc(Math.max(bytes, 8));
    if (!at) throw new Error('no memory for ' + bytes + ' bytes: a page has 512 MiB');
    list.push(at);
    return at;
  }
  function copyIn(list, Type, values) {
    const at = claim(list, values.length * Type.BYTES_PER_ELEMENT);
    new Type(lib.memory.buffer, at, values.length).set(values);
    return at;
  }
  const copyText = (list, s) => copyIn(list, Uint8Array, new TextEncoder().encode(s + '\0'));
  const cString = (at) => { const all = new Uint8Array(lib.memory.buffer); return text(at, all.indexOf(0, at) - at); };

  function close(name) {
    const old = opened[name];
    if (!old) return;
    delete opened[name];
    lib[CLOSES[old.kind]](old.at);
  }

  function marshal(letter, given, done, mine, outs) {
    if ('inkr'.includes(letter)) return +given;
    if (letter === 'q') return BigInt(given);
    if (letter === 'p') return 0;
    if (letter === 'z') return copyText(mine, given);
    if (letter === 'l') return copyIn(mine, Uint32Array, given.map((s) => copyText(mine, s)).concat(0));
    if (letter === 'h') {
      if (!opened[given]) throw new Error('"' + given + '" is not open');
      return opened[given].at;
    }
    if (letter === 'O') return claim(mine, 4);
    const Type = ARRAYS[letter.toLowerCase()];
    if (letter === letter.toLowerCase()) {
      if (typeof given === 'string') { const [k, j] = given.slice(1).split('.'); given = done[k][j]; }
      return copyIn(mine, Type, given);
    }
    const at = claim(mine, given * Type.BYTES_PER_ELEMENT);
    /* what is not written has the same hash everywhere */
    new Uint8Array(lib.memory.buffer, at, given * Type.BYTES_PER_ELEMENT).fill(0);
    outs.push({at, n: given, Type});
    return at;
  }

  function call(one, done, hash) {
    const [name, ...given] = one, {hidden, returns, letters} = signatures[name];
    const key = JSON.stringify(given), at = letters.indexOf('O'), mine = [], outs = [], own = at < 0 ? null : given[at];
    if (own && opened[own] && opened[own].key === name + key) return [];
    if (own) close(own);
    let used = 0;
    try {
      const values = letters.map((c) => marshal(c, c === 'p' ? 0 : given[used++], done, mine, outs));
      if (returns === 's') values.push(claim(mine, SAY), SAY);
      const result = lib[name](...values);
      if (returns === 's' && result) throw new Error(cString(values[values.length - 2]));
      if (own) opened[own] = {at: view().getUint32(values[at], true), key: name + key,
        kind: /bis_flat_([a-z]*)/.exec(name)[1]};
      if (!hidden) for (const o of outs) lib.bis_flat_fnv(hash, o.n * o.Type.BYTES_PER_ELEMENT, o.at);
      return returns === 'r' || returns === 'i' ? [result]
        : outs.map((o) => new o.Type(lib.memory.buffer, o.at, o.n).slice());
    } catch (e) {
      if (stopped(e)) mine.length = 0;
      throw e;
    } finally {
      mine.forEach((p) => lib.free(p));
    }
  }

  function run(list) {
    const began = performance.now(), out = [], mine = [];
    try {
      const hash = copyIn(mine, Uint32Array, [0, 0]);
      for (const one of list) out.push(call(one, out, hash));
      const h = new Uint32Array(lib.memory.buffer, hash, 2), hex = (v) => v.toString(16).padStart(8, '0');
      return {out, hash: hex(h[1]) + hex(h[0]), seconds: (performance.now() - began) / 1e3};
    } catch (e) {
      if (stopped(e)) {
        const words = waiting;
        mine.length = 0;
        start();
        throw new Error('the library stopped and was started again: ' + (words || e.message));
      }
      throw e;
    } finally {
      mine.forEach((p) => lib.free(p));
    }
  }

  start();
  return {run, put(path, bytes) { files[clean(path)] = bytes; Object.keys(opened).forEach(close); }};
}

/* A map of one's own has no more bytes, packed or unpacked: 2048 x 1024 pixels as .pfm have 24 MiB. */
const bisMostBytes = 64 << 20;

/* What runs in the worker. files arrive compressed by gzip where their names end in .gz. */
function bisWorker() {
  let engine;
  async function unpack(bytes) {
    const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')).getReader(), parts = [];
    for (let all = 0, next = await reader.read(); !next.done; next = await reader.read()) {
      all += next.value.length;
      if (all > bisMostBytes) {
        reader.cancel();
        throw new Error('what is packed in this file has more than ' + (bisMostBytes >> 20) + ' MiB');
      }
      parts.push(next.value);
    }
    return new Blob(parts).arrayBuffer();
  }
  async function begin(m) {
    const files = {};
    for (const name of Object.keys(m.files))
      files[name.replace(/\.gz$/, '')] = new Uint8Array(await unpack(m.files[name]));
    engine = bisEngine(await WebAssembly.compile(await unpack(m.wasm)), files);
  }
  let last = Promise.resolve();
  onmessage = (event) => {
    const m = event.data;
    last = last.then(async () => {
      try {
        if (m.wasm) await begin(m);
        else if (m.put) {
          const isZip = m.bytes[0] === 0x1f && m.bytes[1] === 0x8b;
          engine.put(m.put, isZip ? new Uint8Array(await unpack(m.bytes)) : m.bytes);
        }
        postMessage({id: m.id, answer: m.list ? engine.run(m.list) : null});
      } catch (e) {
        postMessage({id: m.id, error: e.message});
      }
    });
  };
}

/* assets: {'bis.wasm.gz': base64, path: base64}. The worker is made of this file's own text, because a page that was
 * opened from disk may load neither a worker nor a module from there. */
function bisClient(assets) {
  const source = '"use strict";\nconst bisMostBytes = ' + bisMostBytes + ';\n' + bisEngine + '\n' + bisWorker +
    '\nbisWorker();';
  const worker = new Worker(URL.createObjectURL(new Blob([source], {type: 'text/javascript'})));
  const bytes = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)), waits = new Map();
  let next = 0;
  worker.onmessage = (event) => {
    const w = waits.get(event.data.id);
    waits.delete(event.data.id);
    if (event.data.error === undefined) w.done(event.data.answer);
    else w.fail(new Error(event.data.error));
  };
  const send = (m) => new Promise((done, fail) => {
    m.id = next++;
    waits.set(m.id, {done, fail});
    worker.postMessage(m);
  });
  const files = {};
  for (const name of Object.keys(assets)) if (name !== 'bis.wasm.gz') files[name] = bytes(assets[name]);
  const began = send({wasm: bytes(assets['bis.wasm.gz']), files});
  return {ask: (list) => began.then(() => send({list})),
    put: (path, data) => began.then(() => send({put: path, bytes: data}))};
}
if (typeof module !== 'undefined') module.exports = bisEngine;
