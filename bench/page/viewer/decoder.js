// Reads a recording: bench/recording/recording.h says how it is made. `motley view` has checked it.
"use strict";

class Run {
  constructor(bytes) {
    this.bytes = bytes;
    const head = new DataView(bytes.buffer);
    this.secondsAFrame = head.getFloat64(12, true);
    const length = head.getUint32(20, true);
    this.scene = new TextDecoder().decode(bytes.subarray(24, 24 + length));
    this.begins = [];
    this.isKey = [];
    for (let at = 24 + length; at + 8 <= bytes.length;) {
      const size = head.getUint32(at, true);
      if (at + 8 + size > bytes.length) break;
      this.begins.push(at + 8);
      this.at = at + 8;
      this.number();
      this.isKey.push((this.number() & 1) !== 0);
      at += 8 + size;
    }
    this.frame = -1;
    this.count = 0;
    this.walls = [];
    this.wallPressures = [];
    this.make(0);
  }
  get frames() { return this.begins.length; }

  number() {
    let value = 0, scale = 1;
    for (;;) {
      const byte = this.bytes[this.at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
    }
  }
  signed() {
    const folded = this.number();
    return folded % 2 === 0 ? folded / 2 : -(folded + 1) / 2;
  }
  make(count) {
    this.person = new Float64Array(count);
    this.radius = new Float64Array(count);
    this.isLong = new Uint8Array(count);
    this.ends = new Float64Array(4 * count);  // from and to, mm
    this.pressure = new Float64Array(count);
  }

  // Makes `frame` the present one: on from there if it is the next, else on from the key frame before it.
  seek(frame) {
    if (frame === this.frame) return;
    let begin = frame;
    while (!this.isKey[begin]) --begin;
    if (this.frame >= begin && this.frame < frame) begin = this.frame + 1;
    for (let i = begin; i <= frame; ++i) this.decode(i);
    this.frame = frame;
  }
  decode(frame) {
    this.at = this.begins[frame];
    this.step = this.number();
    const flags = this.number(), key = (flags & 1) !== 0;
    if ((flags & 2) !== 0) {
      this.walls = [];
      for (let left = this.number(); left > 0; --left)
        this.walls.push([this.signed(), this.signed(), this.signed(), this.signed()]);
    }
    this.wallPressures = [];
    for (let left = this.number(); left > 0; --left) {
      const bands = [];
      for (let more = this.number(); more > 0; --more) bands.push(this.number());
      this.wallPressures.push(bands);
    }
    const count = this.number();
    if (key && count !== this.count) this.make(count);
    this.count = count;
    if (key) {
      this.ends.fill(0);
      this.pressure.fill(0);
    }
    if (key) this.decodeShapes(count);
    else this.decodeChanges(count);
  }
  decodeShapes(count) {
    for (let i = 0; i < count; ++i) {
      this.person[i] = this.number();
      const radius = this.number();
      this.isLong[i] = radius % 2;
      this.radius[i] = Math.floor(radius / 2);
      this.change(i);
    }
  }
  change(i) {
    const ends = this.ends, x = ends[4 * i] += this.signed(), y = ends[4 * i + 1] += this.signed();
    ends[4 * i + 2] = this.isLong[i] ? x + this.signed() : x;
    ends[4 * i + 3] = this.isLong[i] ? y + this.signed() : y;
    this.pressure[i] += this.signed();
  }
  // Nearly all changes of a disc are numbers of one or two bytes, which are read here without a call each.
  decodeChanges(count) {
    const { bytes, ends, isLong, pressure } = this, change = [0, 0, 0];
    let at = this.at;
    for (let i = 0; i < count; ++i) {
      const start = at;
      let isShort = !isLong[i];
      for (let k = 0; isShort && k < 3; ++k) {
        let folded = bytes[at++];
        if (folded > 127) {
          const high = bytes[at++];
          folded += 128 * high - 128;
          isShort = high < 128;
        }
        change[k] = (folded >>> 1) ^ -(folded & 1);
      }
      if (!isShort) {
        this.at = start;
        this.change(i);
        at = this.at;
        continue;
      }
      ends[4 * i + 2] = ends[4 * i] += change[0];
      ends[4 * i + 3] = ends[4 * i + 1] += change[1];
      pressure[i] += change[2];
    }
    this.at = at;
  }
  // The place of a person among the shapes of the present frame, or -1.
  find(person) { return this.person.indexOf(person); }
}
