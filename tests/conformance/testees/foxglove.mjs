// @foxglove/rosmsg2-serialization as a testee: node foxglove.mjs NODE_MODULES DEFINITIONS.json, a text for each type.
import fs from "node:fs";
import { createRequire } from "node:module";
import readline from "node:readline";

const require = createRequire(`${process.argv[2]}/`);
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const texts = JSON.parse(fs.readFileSync(process.argv[3], "utf8"));
const scratch = new DataView(new ArrayBuffer(8));
const types = new Map();

class Skip extends Error {}

function typeOf(name) {
  if (!(name in texts)) throw new Skip("unknown-type");
  if (!types.has(name)) {
    const definitions = parse(texts[name], { ros2: true });
    types.set(name, { definitions, root: definitions.find((one) => one.name === undefined) ?? definitions[0],
      reader: new MessageReader(definitions), writer: new MessageWriter(definitions) });
  }
  return types.get(name);
}

const fieldsOf = (definition) => definition.definitions.filter((field) => field.isConstant !== true);
const nested = (type, field) => type.definitions.find((one) => one.name === field.type);
const TIME = { time: ["int32", "uint32"], duration: ["int32", "uint32"] };

function* leaves(type, definition, message, path) {
  for (const field of fieldsOf(definition)) {
    const value = message[field.name], at = path + field.name;
    if (!field.isArray) yield* leaf(type, field, value, at);
    else {
      if (field.arrayLength === undefined) yield `${at}#=${value.length}`;
      for (let i = 0; i < value.length; i++) yield* leaf(type, field, value[i], `${at}[${i}]`);
    }
  }
}

function* leaf(type, field, value, at) {
  if (field.isComplex) yield* leaves(type, nested(type, field), value, `${at}.`);
  else if (field.type in TIME) yield* [`${at}.sec=${value.sec}`, `${at}.nanosec=${value.nanosec}`];
  else yield `${at}=${text(field.type, value)}`;
}

function text(type, value) {
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
      return Buffer.from(value).toString("hex");
    case "wstring":
      return [...value].map((_, i) => value.charCodeAt(i).toString(16).padStart(4, "0")).join("");
    default:
      return String(value);
  }
}

function parsed(type, s) {
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
      return Buffer.from(s, "hex").toString();
    case "wstring":
      return (s.match(/..../g) ?? []).map((unit) => String.fromCharCode(parseInt(unit, 16))).join("");
    default:
      return type.endsWith("64") ? BigInt(s) : Number(s);
  }
}

function loaded(type, definition, words) {
  const next = () => words.next().value.split("=")[1];
  const one = (field) => {
    if (field.isComplex) return loaded(type, nested(type, field), words);
    return field.type in TIME ? { sec: Number(next()), nanosec: Number(next()) } : parsed(field.type, next());
  };
  const message = {};
  for (const field of fieldsOf(definition))
    message[field.name] = field.isArray
      ? Array.from({ length: field.arrayLength ?? Number(next()) }, () => one(field))
      : one(field);
  return message;
}

const hex = (bytes) => Buffer.from(bytes).toString("hex");
const bytes = (word) => new Uint8Array(Buffer.from(word === "-" ? "" : word, "hex"));

function answer(op, name, words) {
  if (op === "hello") return "protocol=1 language=javascript library=@foxglove/rosmsg2-serialization skip=size,equal,hash,bench";
  const type = typeOf(name);
  const read = () => type.reader.readMessage(bytes(words[0]));
  switch (op) {
    case "default":
      return hex(type.writer.writeMessage({}));
    case "constant": {
      const constant = type.root.definitions.find((field) => field.isConstant && field.name === words[0]);
      return text(constant.type, constant.value);
    }
    case "recode":
      return hex(type.writer.writeMessage(read()));
    case "dump":
      return [...leaves(type, type.root, read(), "")].join(" ");
    case "load":
      return hex(type.writer.writeMessage(loaded(type, type.root, words[Symbol.iterator]())));
    default:
      throw new Skip(op);
  }
}

for await (const line of readline.createInterface({ input: process.stdin })) {
  const [op, id, name, ...words] = line.split(" ");
  let reply;
  try {
    reply = `ok ${id} ${answer(op, name, words)}`;
  } catch (error) {
    const words = String(error).replaceAll("\n", " ").replace(/[^ -~]/g, "?").slice(0, 300);
    reply = error instanceof Skip ? `skip ${id} ${error.message}` : `refused ${id} ${words}`;
  }
  process.stdout.write(`${reply}\n`);
}
