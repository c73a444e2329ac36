// What a run holds, unpacked from the page: src/view/head.c and src/view/frames.c write it in this order.

async function inflate(text) {
  const stream = new DecompressionStream('deflate');
  const writer = stream.writable.getWriter();
  const parts = [];
  let size = 0;
  const reading = (async () => {
    const reader = stream.readable.getReader();
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      parts.push(part.value);
      size += part.value.length;
    }
  })();
  const PART = 4 << 18;
  for (let at = 0; at < text.length; at += PART) {
    const letters = atob(text.slice(at, at + PART));
    const bytes = new Uint8Array(letters.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = letters.charCodeAt(i);
    await writer.write(bytes);
  }
  await writer.close();
  await reading;
  const whole = new Uint8Array(size);
  let at = 0;
  for (const part of parts) { whole.set(part, at); at += part.length; }
  return whole;
}

class Reader {
  constructor(bytes) { this.bytes = bytes; this.at = 0; }
  array(Type, count) {
    const end = this.at + count * Type.BYTES_PER_ELEMENT;
    if (end > this.bytes.length) throw new Error('the data of this page end too early; write it again');
    const array = new Type(this.bytes.buffer.slice(this.at, end));
    this.at = end;
    return array;
  }
  // Differences of 16-bit numbers, low bytes first, onto the numbers before.
  differences(last, out, begin) {
    const count = last.length, low = this.at, high = low + count;
    this.at = high + count;
    for (let i = 0; i < count; i++) out[begin + i] = last[i] = (last[i] + this.bytes[low + i] + (this.bytes[high + i] << 8)) & 65535;
  }
  byteDifferences(last, out, begin) {
    for (let i = 0; i < last.length; i++) out[begin + i] = last[i] = (last[i] + this.bytes[this.at + i]) & 255;
    this.at += last.length;
  }
}

const NUMBERS = 10;
const FRAGMENT = ['parent', 'line', 'object', 'tets', 'birth', 'death', 'mass', 'volume', 'x', 'y', 'z'];
const CURVES = ['time', 'number', 'mode', 'alive', 'inserted', 'failed', 'wall'];

export class Run {
  static async from(element) {
    const run = new Run();
    const reader = new Reader(await inflate(element.textContent));
    element.remove();
    run.readHead(reader);
    run.readFrames(reader);
    return run;
  }

  readHead(reader) {
    const length = reader.array(Int32Array, 1)[0];
    const head = JSON.parse(new TextDecoder().decode(reader.array(Uint8Array, length)));
    Object.assign(this, { head, name: head.name, count: head.lines, frames: head.frames, faces: head.faces, shapes: head.shapes > 0 });
    const columns = [...CURVES, ...head.ledger, ...head.costs.map((name) => 'cost ' + name)];
    this.curve = Object.fromEntries(columns.map((name) => [name, new Float64Array(this.frames)]));
    const rows = reader.array(Float64Array, this.frames * columns.length);
    columns.forEach((name, k) => { for (let i = 0; i < this.frames; i++) this.curve[name][i] = rows[i * columns.length + k]; });
    this.time = this.curve.time;
    const fragments = reader.array(Float64Array, head.fragments * FRAGMENT.length);
    this.fragment = Array.from({ length: head.fragments }, (_, i) =>
      Object.fromEntries(FRAGMENT.map((name, k) => [name, fragments[i * FRAGMENT.length + k]])));
    const events = reader.array(Float64Array, head.events * 6);
    this.events = Array.from({ length: head.events }, (_, i) => ({
      time: events[6 * i], kind: head.eventKinds[events[6 * i + 1]], fragment: events[6 * i + 2], obstacle: events[6 * i + 3],
      reason: head.reasons[events[6 * i + 4]], value: events[6 * i + 5],
    }));
    this.leaf = reader.array(Int32Array, this.count);
    this.begin = reader.array(Int32Array, this.count + 1);
    this.range = reader.array(Float32Array, this.count * 12);
    this.other = reader.array(Int32Array, this.faces);
    this.corner = reader.array(Float32Array, this.faces * 9);
    this.obstacles = head.obstacles.map((o) => ({ ...o, positions: reader.array(Float32Array, 3 * o.nodes), triangles: reader.array(Int32Array, 3 * o.triangles) }));
    this.obstaclePose = reader.array(Float32Array, this.frames * this.obstacles.length * 7);
    this.hulls = Array.from({ length: head.hulls }, () => this.readHulls(reader));
  }

  // The convex pieces of a fragment.
  readHulls(reader) {
    const [fragment, count] = reader.array(Int32Array, 2);
    const pieces = Array.from({ length: count }, () => {
      const [vertices, faces] = reader.array(Int32Array, 2);
      return { vertices: reader.array(Float32Array, 3 * vertices), faces: reader.array(Uint8Array, 3 * faces) };
    });
    return { fragment, pieces };
  }

  readFrames(reader) {
    const { count, frames } = this, faces = this.shapes ? this.faces : 0;
    this.motion = new Uint16Array(frames * NUMBERS * count);
    this.carrier = new Int32Array(frames * count);
    this.bytes = new Uint8Array(frames * (count + 2 * faces));
    this.shape = new Uint16Array(frames * 9 * faces);
    const motion = new Uint16Array(NUMBERS * count), bytes = new Uint8Array(count + 2 * faces), shape = new Uint16Array(9 * faces);
    const carrier = new Int32Array(count);
    for (let f = 0; f < frames; f++) {
      reader.differences(motion, this.motion, f * NUMBERS * count);
      const change = reader.array(Int32Array, count);
      for (let i = 0; i < count; i++) this.carrier[f * count + i] = carrier[i] += change[i];
      reader.byteDifferences(bytes, this.bytes, f * bytes.length);
      if (faces > 0) reader.differences(shape, this.shape, f * 9 * faces);
    }
  }

  // The frame at or before a time, and how far it is to the next.
  find(time) {
    let low = 0, high = this.frames - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time[middle] <= time) low = middle; else high = middle - 1;
    }
    const next = Math.min(low + 1, this.frames - 1), step = this.time[next] - this.time[low];
    return { frame: low, next, share: step > 0 ? Math.min(1, Math.max(0, (time - this.time[low]) / step)) : 0 };
  }

  number(frame, line, k) {
    const value = this.motion[(frame * NUMBERS + k) * this.count + line];
    if (k >= 3 && k < 7) return ((value << 16) >> 16) / 32767;
    const range = 12 * line + 2 * (k < 3 ? k : k - 4);
    return this.range[range] + this.range[range + 1] * value;
  }

  carrierAt(frame, line) { return this.carrier[frame * this.count + line]; }
  awakeAt(frame, line) { return this.bytes[frame * (this.count + (this.shapes ? 2 * this.faces : 0)) + line]; }
  velocity(frame, line) { return [7, 8, 9].map((k) => this.number(frame, line, k)); }
  // Byte of a face: damage (0) or root of the stress (1), 0 … 255.
  faceByte(frame, face, which) { return this.bytes[frame * (this.count + 2 * this.faces) + this.count + which * this.faces + face]; }

  // Position and orientation (x, y, z, w) between two frames.
  pose(at, line, out) {
    const { frame, next, share } = at;
    const live = share > 0 && this.carrierAt(next, line) >= 0;
    let length = 0;
    for (let k = 0; k < 7; k++) {
      const value = this.number(frame, line, k);
      out[k] = live ? value + share * (this.number(next, line, k) - value) : value;
      if (k >= 3) length += out[k] * out[k];
    }
    length = Math.sqrt(length) || 1;
    for (let k = 3; k < 7; k++) out[k] /= length;
    return out;
  }

  // Displacement of the corners of all faces between two frames, added to where they rest, by corner.
  deform(at, out) {
    const { frame, next, share } = at, faces = this.faces, step = this.head.reach / 32767;
    for (let k = 0; k < 9; k++) {
      const one = (frame * 9 + k) * faces, two = (next * 9 + k) * faces;
      for (let f = 0; f < faces; f++) {
        const a = (this.shape[one + f] << 16) >> 16, b = (this.shape[two + f] << 16) >> 16;
        out[9 * f + k] = this.corner[9 * f + k] + step * (a + share * (b - a));
      }
    }
  }

  // The centre of mass of the piece that moves a line, from the line's own pose.
  centre(frame, line) {
    const pose = this.pose({ frame, next: frame, share: 0 }, line, new Float64Array(7));
    const own = this.fragment[this.leaf[line]], piece = this.fragment[this.carrierAt(frame, line)] ?? own;
    const arm = [piece.x - own.x, piece.y - own.y, piece.z - own.z];
    const [x, y, z, w] = pose.subarray(3);
    const t = [2 * (y * arm[2] - z * arm[1]), 2 * (z * arm[0] - x * arm[2]), 2 * (x * arm[1] - y * arm[0])];
    return [pose[0] + arm[0] + w * t[0] + y * t[2] - z * t[1], pose[1] + arm[1] + w * t[1] + z * t[0] - x * t[2], pose[2] + arm[2] + w * t[2] + x * t[1] - y * t[0]];
  }
}
