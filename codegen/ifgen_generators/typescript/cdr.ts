/**
 * Reads and writes plain CDR (XCDR version 1) as Fast CDR does for ROS 2.
 *
 * Positions are those in the payload plus 4. So a position modulo 8 is that of the wire, which counts from after the header.
 */

/** A message that cannot be encoded: its text has the path of the field. */
export class EncodeError extends Error {}
/** A payload that holds no such message. */
export class DecodeError extends Error {}

export type Primitive =
  | "bool" | "byte" | "char" | "int8" | "uint8" | "int16" | "uint16" | "int32" | "uint32" | "int64" | "uint64"
  | "float32" | "float64" | "string" | "wstring";

/** A field of a message: `size` is that of an array, or the bound of a sequence, `bound` that of strings. */
export interface FieldType {
  readonly name: string;
  readonly type: Primitive | MessageType<any>;
  readonly array?: "fixed" | "bounded" | "unbounded";
  readonly size?: number;
  readonly bound?: number;
}

export interface DecodeOptions {
  /** Copy the payload first. Without it, arrays of numbers are views of the payload where their alignment allows that. */
  copy?: boolean;
}

/** Some of the values of a message. Here and below, names that no message can hide. */
export type Some<T> = Partial<T>;
export type Members = Record<string, unknown>;

/** The value of a message's name: what can be done with messages of that type. */
export interface MessageType<T> {
  /** `pkg/msg/Name`. */
  readonly typeName: string;
  /** `RIHS01_...`. */
  readonly typeHash: string;
  readonly fields: readonly FieldType[];
  /** A new message: default values, except for those given. */
  create(values?: Some<T>): T;
  /** The payload, with its 4-byte header. Throws EncodeError. */
  encode(message: T): Uint8Array;
  /** The message in a payload of either byte order. Throws DecodeError. */
  decode(payload: Uint8Array, options?: DecodeOptions): T;
  /** Whether all fields are equal: by IEEE 754, NaN is not equal to itself, and -0 is equal to 0. */
  equals(a: T, b: T): boolean;
}

const SMALL = 1 << 16;
const EMPTY = new ArrayBuffer(0);
const SURROGATE = /\p{Surrogate}/u;
const encoder = new TextEncoder();
const decoder = new TextDecoder("utf-8", { ignoreBOM: true });
const littleHost = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;

/** A growing buffer, seen as arrays of each kind of number. */
export class Writer {
  declare u8: Uint8Array<ArrayBuffer>;
  declare i8: Int8Array<ArrayBuffer>;
  declare u16: Uint16Array<ArrayBuffer>;
  declare i16: Int16Array<ArrayBuffer>;
  declare u32: Uint32Array<ArrayBuffer>;
  declare i32: Int32Array<ArrayBuffer>;
  declare f32: Float32Array<ArrayBuffer>;
  declare f64: Float64Array<ArrayBuffer>;
  declare u64: BigUint64Array<ArrayBuffer>;
  declare i64: BigInt64Array<ArrayBuffer>;
  declare cap: number;

  constructor(size: number) {
    this.use(new ArrayBuffer(size));
  }

  private use(buffer: ArrayBuffer): void {
    this.u8 = new Uint8Array(buffer);
    this.i8 = new Int8Array(buffer);
    this.u16 = new Uint16Array(buffer);
    this.i16 = new Int16Array(buffer);
    this.u32 = new Uint32Array(buffer);
    this.i32 = new Int32Array(buffer);
    this.f32 = new Float32Array(buffer);
    this.f64 = new Float64Array(buffer);
    this.u64 = new BigUint64Array(buffer);
    this.i64 = new BigInt64Array(buffer);
    this.cap = buffer.byteLength;
  }

  /** Make room up to position `end`. */
  grow(end: number): void {
    const old = this.u8;
    const size = end > 2 * this.cap ? end + 64 : 2 * this.cap; // a message with one large array ends soon after it
    this.use(new ArrayBuffer((size + 7) & ~7));
    this.u8.set(old);
  }

  /** Write zeros up to a multiple of `align`, and make room for `size` bytes after them. */
  room(p: number, align: number, size: number): number {
    const start = (p + align - 1) & -align;
    if (start + size > this.cap) this.grow(start + size);
    while (p < start) this.u8[p++] = 0;
    return start;
  }

  /** Write the count of a sequence. */
  count(p: number, n: number): number {
    p = this.room(p, 4, 4);
    this.u32[p >> 2] = n;
    return p + 4;
  }

  string(p: number, s: string): number {
    if (typeof s !== "string") throw new EncodeError("");
    const n = s.length;
    p = this.room(p, 4, 5 + 3 * n);
    const u8 = this.u8;
    let q = p + 4;
    let i = 0;
    for (; i < n; i++) {
      const c = s.charCodeAt(i);
      if (c > 127 || c === 0) break;
      u8[q + i] = c;
    }
    if (i < n) {
      if (SURROGATE.test(s) || s.includes("\0")) throw new EncodeError("");
      q += encoder.encodeInto(s, u8.subarray(q)).written;
    } else q += n;
    u8[q] = 0;
    this.u32[p >> 2] = q - p - 3;
    return q + 1;
  }

  wstring(p: number, s: string): number {
    if (typeof s !== "string" || SURROGATE.test(s)) throw new EncodeError("");
    const n = s.length;
    p = this.room(p, 4, 4 + 4 * n);
    const u32 = this.u32;
    let i = p >> 2;
    u32[i++] = n;
    for (let k = 0; k < n; k++) u32[i++] = s.charCodeAt(k);
    return p + 4 + 4 * n;
  }

  bools(p: number, a: readonly boolean[]): number {
    const n = a.length;
    p = this.room(p, 1, n);
    for (let i = 0; i < n; i++) this.u8[p + i] = bool(a[i]!);
    return p + n;
  }

  u8s(p: number, a: Uint8Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 1, 1 * n);
    this.u8.set(a instanceof Uint8Array ? a : checked(a, "u8"), p);
    return p + 1 * n;
  }

  i8s(p: number, a: Int8Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 1, 1 * n);
    this.i8.set(a instanceof Int8Array ? a : checked(a, "i8"), p);
    return p + 1 * n;
  }

  u16s(p: number, a: Uint16Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 2, 2 * n);
    this.u16.set(a instanceof Uint16Array ? a : checked(a, "u16"), p >> 1);
    return p + 2 * n;
  }

  i16s(p: number, a: Int16Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 2, 2 * n);
    this.i16.set(a instanceof Int16Array ? a : checked(a, "i16"), p >> 1);
    return p + 2 * n;
  }

  u32s(p: number, a: Uint32Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 4, 4 * n);
    this.u32.set(a instanceof Uint32Array ? a : checked(a, "u32"), p >> 2);
    return p + 4 * n;
  }

  i32s(p: number, a: Int32Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 4, 4 * n);
    this.i32.set(a instanceof Int32Array ? a : checked(a, "i32"), p >> 2);
    return p + 4 * n;
  }

  f32s(p: number, a: Float32Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 4, 4 * n);
    this.f32.set(a instanceof Float32Array ? a : checked(a, "f32"), p >> 2);
    return p + 4 * n;
  }

  f64s(p: number, a: Float64Array | readonly number[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 8, 8 * n);
    this.f64.set(a instanceof Float64Array ? a : checked(a, "f64"), p >> 3);
    return p + 8 * n;
  }

  u64s(p: number, a: BigUint64Array | readonly bigint[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 8, 8 * n);
    this.u64.set(a instanceof BigUint64Array ? a : checked(a, "u64"), p >> 3);
    return p + 8 * n;
  }

  i64s(p: number, a: BigInt64Array | readonly bigint[]): number {
    const n = a.length;
    if (n === 0) return p;
    p = this.room(p, 8, 8 * n);
    this.i64.set(a instanceof BigInt64Array ? a : checked(a, "i64"), p >> 3);
    return p + 8 * n;
  }
}

// A value that is not what its field holds ends the writing; `problem` then finds it again, with its path.

export function float(v: number): number {
  if (typeof v !== "number") throw new EncodeError("");
  return v;
}
export function bool(v: boolean): number {
  if (v === true) return 1;
  if (v === false) return 0;
  throw new EncodeError("");
}
export function u8(v: number): number {
  if ((v & 255) !== v) throw new EncodeError("");
  return v;
}
export function i8(v: number): number {
  if ((v << 24) >> 24 !== v) throw new EncodeError("");
  return v;
}
export function u16(v: number): number {
  if ((v & 65535) !== v) throw new EncodeError("");
  return v;
}
export function i16(v: number): number {
  if ((v << 16) >> 16 !== v) throw new EncodeError("");
  return v;
}
export function u32(v: number): number {
  if (v >>> 0 !== v) throw new EncodeError("");
  return v;
}
export function i32(v: number): number {
  if ((v | 0) !== v) throw new EncodeError("");
  return v;
}
export function u64(v: bigint): bigint {
  if (typeof v !== "bigint" || BigInt.asUintN(64, v) !== v) throw new EncodeError("");
  return v;
}
export function i64(v: bigint): bigint {
  if (typeof v !== "bigint" || BigInt.asIntN(64, v) !== v) throw new EncodeError("");
  return v;
}
/** The length of an array or a sequence, if it is as it should be. */
export function exactly(a: { readonly length: number }, n: number): number {
  if (a.length !== n) throw new EncodeError("");
  return n;
}
/** An array, if it has the right number of elements. */
export function sized<T extends { readonly length: number }>(a: T, n: number): T {
  if (a.length !== n) throw new EncodeError("");
  return a;
}
export function atMost(a: { readonly length: number }, n: number): number {
  if (!(a.length <= n)) throw new EncodeError("");
  return a.length;
}
export function bounded(s: string, n: number): string {
  if (s.length > n && [...s].length > n) throw new EncodeError("");
  return s;
}

const CHECKS: Record<string, (v: any) => unknown> = { u8, i8, u16, i16, u32, i32, u64, i64, f32: float, f64: float };

/** The numbers of something that is not the typed array of its field. */
function checked<T>(a: T, kind: string): T {
  for (const value of a as Iterable<unknown>) CHECKS[kind]!(value);
  return a;
}

let writer = new Writer(SMALL);
let busy = false;

/** The payload of a message that a function writes from position 8. */
export function encode<T>(type: MessageType<T>, write: (w: Writer, m: T, p: number) => number, message: T): Uint8Array {
  const w = busy ? new Writer(256) : writer; // a getter of a message may encode another one
  const outer = busy;
  busy = true;
  try {
    w.u32[1] = littleHost ? 0x100 : 0x10000;
    const end = write(w, message, 8);
    return end <= SMALL || end < w.cap >> 1 ? w.u8.slice(4, end) : w.u8.subarray(4, end);
  } catch (error) {
    throw new EncodeError(problem(type, message, shortName(type)) ?? String(error));
  } finally {
    busy = outer;
    if (w === writer && w.cap !== SMALL) writer = new Writer(SMALL);
  }
}

/** The message that a function reads from a payload. */
export function decode<T>(read: (r: Reader) => T, payload: Uint8Array, options?: DecodeOptions): T {
  const r = new Reader(payload);
  if (options?.copy) r.copy();
  return read(r);
}

/** A payload that is read. Offsets are those in the payload. */
export class Reader {
  declare bytes: Uint8Array;
  declare view: DataView;
  declare le: boolean;
  declare native: boolean;
  declare p: number;
  declare end: number;
  declare start: number;

  constructor(payload: Uint8Array) {
    const size = payload.byteLength;
    if (size < 4) throw new DecodeError(`expected a header of 4 bytes, got ${size} bytes`);
    this.bytes = payload;
    this.view = new DataView(payload.buffer, payload.byteOffset, size);
    this.le = (payload[1]! & 1) === 1;
    this.native = this.le === littleHost;
    this.p = 8;
    this.end = size + 4;
    this.start = 0;
  }

  /** Read from a copy of the payload, in which all values are aligned. */
  copy(): void {
    const bytes = new Uint8Array(this.end);
    bytes.set(this.bytes, 4);
    this.bytes = bytes.subarray(4);
  }

  /** The offset of the next `size` bytes, after alignment. */
  take(align: number, size: number): number {
    const p = (this.p + align - 1) & -align;
    if (p + size > this.end) this.fail(p, size);
    this.p = p + size;
    return p - 4;
  }

  fail(p: number, size: number): never {
    throw new DecodeError(`expected ${size} bytes at ${p - 4}, the payload ends at ${this.end - 4}`);
  }

  /** The count of a sequence whose elements have at least `size` bytes each. */
  count(size: number, most?: number): number {
    const n = this.view.getUint32(this.take(4, 4), this.le);
    if (n * size > this.end - this.p) this.fail(this.p, n * size);
    if (most !== undefined && n > most) throw new DecodeError(`expected at most ${most} elements before ${this.p - 4}, got ${n}`);
    return n;
  }

  string(most?: number): string {
    const n = this.view.getUint32(this.take(4, 4), this.le);
    const a = this.take(1, n);
    let z = a + n;
    if (n > 0 && this.bytes[z - 1] === 0) z--;
    const s = n < 48 ? this.ascii(a, z) : this.text(a, z);
    return most === undefined || s.length <= most ? s : this.within(s, most);
  }

  /** A short string: eight characters at a time cost a third of what TextDecoder does. */
  private ascii(a: number, z: number): string {
    const b = this.bytes;
    let s = "";
    let i = a;
    for (; i + 8 <= z; i += 8) {
      const c0 = b[i]!, c1 = b[i + 1]!, c2 = b[i + 2]!, c3 = b[i + 3]!;
      const c4 = b[i + 4]!, c5 = b[i + 5]!, c6 = b[i + 6]!, c7 = b[i + 7]!;
      const isAscii = ((c0 | c1 | c2 | c3 | c4 | c5 | c6 | c7) & 128) === 0;
      const hasNul = ((c0 - 1) | (c1 - 1) | (c2 - 1) | (c3 - 1) | (c4 - 1) | (c5 - 1) | (c6 - 1) | (c7 - 1)) < 0;
      if (!isAscii || hasNul) return this.text(a, z);
      s += String.fromCharCode(c0, c1, c2, c3, c4, c5, c6, c7);
    }
    for (; i < z; i++) {
      const c = b[i]!;
      if (c > 127 || c === 0) return this.text(a, z);
      s += String.fromCharCode(c);
    }
    return s;
  }

  private text(a: number, z: number): string {
    const s = decoder.decode(this.bytes.subarray(a, z));
    const nul = s.indexOf("\0");
    return nul < 0 ? s : s.slice(0, nul);
  }

  wstring(most?: number): string {
    const n = this.view.getUint32(this.take(4, 4), this.le);
    if (n * 4 > this.end - this.p) this.fail(this.p, n * 4);
    const a = this.take(4, 4 * n);
    let s = "";
    for (let i = 0; i < n; i++) {
      const unit = this.view.getUint32(a + 4 * i, this.le);
      if (unit > 0xffff) throw new DecodeError(`expected a UTF-16 unit at ${a + 4 * i}, got ${unit}`);
      s += String.fromCharCode(unit);
    }
    return most === undefined || s.length <= most ? s : this.within(s, most);
  }

  private within(s: string, most: number): string {
    if ([...s].length > most) throw new DecodeError(`expected at most ${most} characters before ${this.p - 4}`);
    return s;
  }

  bools(o: number, n: number): boolean[] {
    const a: boolean[] = [];
    for (let i = 0; i < n; i++) a.push(this.bytes[o + i] !== 0);
    return a;
  }

  /** The memory of `size` bytes at an offset, which `start` then points to. Copies them if they are not aligned. */
  private at(o: number, size: number, mask: number): ArrayBufferLike {
    const start = this.bytes.byteOffset + o;
    if ((start & mask) === 0) {
      this.start = start;
      return this.bytes.buffer;
    }
    if (size > this.end >> 2 || this.end < 4096) {
      this.copy(); // at once, since other arrays are not aligned either
      this.start = o + 4;
      return this.bytes.buffer;
    }
    this.start = 0;
    return this.bytes.slice(o, o + size).buffer;
  }

  u8s(o: number, n: number): Uint8Array {
    return new Uint8Array(this.bytes.buffer, this.bytes.byteOffset + o, n);
  }

  i8s(o: number, n: number): Int8Array {
    return new Int8Array(this.bytes.buffer, this.bytes.byteOffset + o, n);
  }

  u16s(o: number, n: number): Uint16Array {
    if (n === 0) return new Uint16Array(EMPTY);
    if (this.native) return new Uint16Array(this.at(o, 2 * n, 1), this.start, n);
    const a = new Uint16Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getUint16(o + 2 * i, this.le);
    return a;
  }

  i16s(o: number, n: number): Int16Array {
    if (n === 0) return new Int16Array(EMPTY);
    if (this.native) return new Int16Array(this.at(o, 2 * n, 1), this.start, n);
    const a = new Int16Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getInt16(o + 2 * i, this.le);
    return a;
  }

  u32s(o: number, n: number): Uint32Array {
    if (n === 0) return new Uint32Array(EMPTY);
    if (this.native) return new Uint32Array(this.at(o, 4 * n, 3), this.start, n);
    const a = new Uint32Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getUint32(o + 4 * i, this.le);
    return a;
  }

  i32s(o: number, n: number): Int32Array {
    if (n === 0) return new Int32Array(EMPTY);
    if (this.native) return new Int32Array(this.at(o, 4 * n, 3), this.start, n);
    const a = new Int32Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getInt32(o + 4 * i, this.le);
    return a;
  }

  f32s(o: number, n: number): Float32Array {
    if (n === 0) return new Float32Array(EMPTY);
    if (this.native) return new Float32Array(this.at(o, 4 * n, 3), this.start, n);
    const a = new Float32Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getFloat32(o + 4 * i, this.le);
    return a;
  }

  f64s(o: number, n: number): Float64Array {
    if (n === 0) return new Float64Array(EMPTY);
    if (this.native) return new Float64Array(this.at(o, 8 * n, 7), this.start, n);
    const a = new Float64Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getFloat64(o + 8 * i, this.le);
    return a;
  }

  u64s(o: number, n: number): BigUint64Array {
    if (n === 0) return new BigUint64Array(EMPTY);
    if (this.native) return new BigUint64Array(this.at(o, 8 * n, 7), this.start, n);
    const a = new BigUint64Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getBigUint64(o + 8 * i, this.le);
    return a;
  }

  i64s(o: number, n: number): BigInt64Array {
    if (n === 0) return new BigInt64Array(EMPTY);
    if (this.native) return new BigInt64Array(this.at(o, 8 * n, 7), this.start, n);
    const a = new BigInt64Array(n);
    for (let i = 0; i < n; i++) a[i] = this.view.getBigInt64(o + 8 * i, this.le);
    return a;
  }
}

// -- errors in words ---------------------------------------------------------------------------------------------------

const RANGES: Record<string, readonly [number, number]> = {
  byte: [0, 255], char: [0, 255], uint8: [0, 255], int8: [-128, 127], uint16: [0, 65535], int16: [-32768, 32767],
  uint32: [0, 4294967295], int32: [-2147483648, 2147483647],
};

function shortName(type: MessageType<any>): string {
  return type.typeName.slice(type.typeName.lastIndexOf("/") + 1);
}

function shown(v: unknown): string {
  if (typeof v === "string") return v.length > 40 ? `a string of ${v.length} characters` : JSON.stringify(v);
  if (typeof v === "object" && v !== null) return "an object";
  return typeof v === "bigint" ? `${v}n` : String(v);
}

/** What is wrong with a message, with the path of the field; undefined if nothing is. */
export function problem(type: MessageType<any>, message: any, path: string): string | undefined {
  if (typeof message !== "object" || message === null) return `${path}: expected ${type.typeName}, got ${shown(message)}`;
  for (const field of type.fields) {
    const value = message[field.name];
    const at = `${path}.${field.name}`;
    const found = field.array === undefined ? wrong(field, value, at) : wrongArray(field, value, at);
    if (found !== undefined) return found;
  }
  return undefined;
}

function wrongArray(field: FieldType, value: any, at: string): string | undefined {
  const n: unknown = value?.length;
  if (typeof n !== "number" || typeof value === "string") return `${at}: expected an array, got ${shown(value)}`;
  if (field.array === "fixed" && n !== field.size) return `${at}: expected ${field.size} elements, got ${n}`;
  if (field.array === "bounded" && n > field.size!) return `${at}: expected at most ${field.size} elements, got ${n}`;
  for (let i = 0; i < n; i++) {
    const found = wrong(field, value[i], `${at}[${i}]`);
    if (found !== undefined) return found;
  }
  return undefined;
}

function wrong({ type, bound }: FieldType, value: any, at: string): string | undefined {
  if (typeof type !== "string") return problem(type, value, at);
  const no = (expected: string) => `${at}: expected ${expected}, got ${shown(value)}`;
  switch (type) {
    case "bool":
      return typeof value === "boolean" ? undefined : no("a boolean");
    case "float32":
    case "float64":
      return typeof value === "number" ? undefined : no("a number");
    case "int64":
    case "uint64": {
      const fits = type === "int64" ? BigInt.asIntN : BigInt.asUintN;
      if (typeof value !== "bigint" && !(INT64_NUMBER && Number.isSafeInteger(value))) return no(INT64_NUMBER ? "an integer" : "a bigint");
      return fits(64, BigInt(value)) === BigInt(value) ? undefined : no(`a value of ${type}`);
    }
    case "string":
    case "wstring":
      if (typeof value !== "string") return no("a string");
      if (SURROGATE.test(value)) return no("a string without half of a surrogate pair");
      if (type === "string" && value.includes("\0")) return no("a string without NUL");
      return bound !== undefined && [...value].length > bound ? no(`at most ${bound} characters`) : undefined;
    default: {
      const [low, high] = RANGES[type]!;
      return Number.isInteger(value) && value >= low && value <= high ? undefined : no(`an integer from ${low} to ${high}`);
    }
  }
}

/** Whether 64-bit integers are numbers in messages: an option of the generator. */
export const INT64_NUMBER: boolean = false;

/** Whether all fields of two messages are equal. */
export function equals<T>(type: MessageType<T>, a: T, b: T): boolean {
  return type.fields.every(({ name, type, array }) => {
    const one = a[name as keyof T] as any;
    const other = b[name as keyof T] as any;
    const same = (x: any, y: any) => (typeof type === "string" ? x === y : equals(type, x, y));
    if (array === undefined) return same(one, other);
    return one.length === other.length && one.every((element: any, i: number) => same(element, other[i]));
  });
}
