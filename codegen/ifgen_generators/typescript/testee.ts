/** Answers requests of `ifgen conformance`, one a line. */
import { DecodeError, EncodeError, INT64_NUMBER, type FieldType, type MessageType } from "./cdr.js";
import { constants, hashes, types } from "./types.js";

declare const process: any;

class Skip extends Error {}

const scratch = new DataView(new ArrayBuffer(8));
const utf8 = new TextEncoder();

function hex(bytes: Uint8Array): string {
  let s = "";
  for (const byte of bytes) s += byte.toString(16).padStart(2, "0");
  return s;
}

function bytes(s: string): Uint8Array {
  if (s === "-") return new Uint8Array(0);
  const a = new Uint8Array(s.length / 2);
  for (let i = 0; i < a.length; i++) a[i] = parseInt(s.slice(2 * i, 2 * i + 2), 16);
  return a;
}

function text(type: string, value: any): string {
  switch (type) {
    case "bool":
      return value ? "1" : "0";
    case "float32":
      scratch.setFloat32(0, value);
      return scratch.getUint32(0).toString(16).padStart(8, "0");
    case "float64":
      scratch.setFloat64(0, value);
      return scratch.getBigUint64(0).toString(16).padStart(16, "0");
    case "string":
      return hex(utf8.encode(value));
    case "wstring":
      return [...Array(value.length).keys()].map((i) => value.charCodeAt(i).toString(16).padStart(4, "0")).join("");
    default:
      return String(value);
  }
}

function* leaves(type: MessageType<any>, message: any, path: string): Generator<string> {
  for (const field of type.fields) {
    const value = message[field.name];
    const at = path + field.name.replace(/_$/, ""); // which a field's name in ROS cannot end with
    if (field.array === undefined) yield* leaf(field, value, at);
    else {
      if (field.array !== "fixed") yield `${at}#=${value.length}`;
      for (let i = 0; i < value.length; i++) yield* leaf(field, value[i], `${at}[${i}]`);
    }
  }
}

function* leaf(field: FieldType, value: any, at: string): Generator<string> {
  if (typeof field.type === "string") yield `${at}=${text(field.type, value)}`;
  else yield* leaves(field.type, value, `${at}.`);
}

function parsed(type: string, s: string): any {
  switch (type) {
    case "bool":
      return s === "1";
    case "float32":
      scratch.setUint32(0, parseInt(s, 16));
      return scratch.getFloat32(0);
    case "float64":
      scratch.setBigUint64(0, BigInt(`0x${s}`));
      return scratch.getFloat64(0);
    case "string":
      return new TextDecoder("utf-8", { ignoreBOM: true }).decode(bytes(s === "" ? "-" : s));
    case "wstring":
      return (s.match(/..../g) ?? []).map((unit) => String.fromCharCode(parseInt(unit, 16))).join("");
    case "int64":
    case "uint64":
      return INT64_NUMBER ? Number(s) : BigInt(s);
    default:
      return Number(s);
  }
}

function loaded(type: MessageType<any>, words: Iterator<string>): any {
  const next = () => words.next().value!.split("=")[1]!;
  const one = (field: FieldType) => (typeof field.type === "string" ? parsed(field.type, next()) : loaded(field.type, words));
  const message = type.create();
  for (const field of type.fields) {
    if (field.array === undefined) message[field.name] = one(field);
    else {
      const n = field.array === "fixed" ? field.size! : Number(next());
      const elements = Array.from({ length: n }, () => one(field));
      const usual = message[field.name];
      message[field.name] = Array.isArray(usual) ? elements : usual.constructor.from(elements);
    }
  }
  return message;
}

function now(): number {
  const { user, system } = process.cpuUsage();
  return 1000 * (user + system);
}

function bench(type: MessageType<any>, payload: Uint8Array, n: number): string {
  const message = type.decode(payload);
  const begin = now();
  for (let i = 0; i < n; i++) type.encode(message);
  const middle = now();
  for (let i = 0; i < n; i++) type.decode(payload);
  return `${((middle - begin) / n).toFixed(1)} ${((now() - middle) / n).toFixed(1)}`;
}

function answer(op: string, name: string, words: string[]): string {
  if (op === "hello") return "protocol=1 language=typescript library=ifgen skip=size";
  if (op === "hash" && name in hashes) return hashes[name]!;
  const type: any = types[name];
  if (type === undefined) throw new Skip("unknown-type");
  switch (op) {
    case "hash":
      return type.typeHash;
    case "default":
      return hex(type.encode(type.create()));
    case "constant":
      return text(constants[`${name}/${words[0]}`]!, type[words[0]!]);
    case "recode":
      return hex(type.encode(type.decode(bytes(words[0]!))));
    case "dump":
      return [...leaves(type, type.decode(bytes(words[0]!)), "")].join(" ");
    case "load":
      return hex(type.encode(loaded(type, words[Symbol.iterator]())));
    case "equal":
      return String(Number(type.equals(type.decode(bytes(words[0]!)), type.decode(bytes(words[1]!)))));
    case "bench":
      return bench(type, bytes(words[0]!), Number(words[1]));
    default:
      throw new Skip(op);
  }
}

function reply(line: string): string {
  const [op, id, name, ...words] = line.split(" ");
  try {
    return `ok ${id} ${answer(op!, name!, words)}\n`;
  } catch (error) {
    const words = String(error).replaceAll("\n", " ");
    if (error instanceof Skip) return `skip ${id} ${error.message}\n`;
    return `${error instanceof DecodeError || error instanceof EncodeError ? "refused" : "fail"} ${id} ${words}\n`;
  }
}

let rest = "";
process.stdin.setEncoding("ascii");
process.stdin.on("data", (chunk: string) => {
  const lines = (rest + chunk).split("\n");
  rest = lines.pop()!;
  for (const line of lines) process.stdout.write(reply(line));
});
