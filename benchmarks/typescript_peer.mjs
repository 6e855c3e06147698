// Reads and writes the payloads in a folder with both libraries, in turns: node typescript_peer.mjs FOLDER
import fs from "node:fs";
import { createRequire } from "node:module";

const folder = process.argv[2];
const require = createRequire(`${folder}/`);
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { types } = await import(`${folder}/js/types.js`);

const now = () => {
  const { user, system } = process.cpuUsage();
  return user + system;
};
const round = (task, count) => {
  const begin = now();
  for (let i = 0; i < count; i++) task();
  return (now() - begin) / count;
};
const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
const mean = (values) => Math.exp(values.reduce((sum, value) => sum + Math.log(value), 0) / values.length);

console.log("| message | bytes | encode | Foxglove | ratio | decode | Foxglove | ratio |\n|---|---:|---:|---:|---:|---:|---:|---:|");
const ratios = [[], []];
for (const file of fs.readdirSync(`${folder}/payloads`).sort()) {
  const name = file.replace(".bin", "").replaceAll(".", "/");
  const payload = new Uint8Array(fs.readFileSync(`${folder}/payloads/${file}`)); // alone in its buffer, as from a socket
  const type = types[name];
  const definitions = parse(type.definition, { ros2: true });
  const reader = new MessageReader(definitions), writer = new MessageWriter(definitions);
  const ours = type.decode(payload), theirs = reader.readMessage(payload);
  if (Buffer.compare(Buffer.from(type.encode(ours)), Buffer.from(writer.writeMessage(theirs))) !== 0) throw new Error(`${name} differs`);
  const tasks = [
    () => type.encode(ours),
    () => writer.writeMessage(theirs),
    () => type.decode(payload),
    () => reader.readMessage(payload),
  ];
  const counts = tasks.map((task) => {
    round(task, 100);
    return Math.max(20, Math.min(20000, Math.round(30000 / Math.max(round(task, 100), 0.1))));
  });
  const times = tasks.map(() => []);
  for (let k = 0; k < 9; k++) tasks.forEach((task, i) => times[i].push(round(task, counts[i])));
  const [encode, peerEncode, decode, peerDecode] = times.map(median);
  ratios[0].push(peerEncode / encode);
  ratios[1].push(peerDecode / decode);
  const cells = [encode.toFixed(2), peerEncode.toFixed(2), (peerEncode / encode).toFixed(1), decode.toFixed(2), peerDecode.toFixed(2), (peerDecode / decode).toFixed(1)];
  console.log(`| ${name} | ${payload.length} | ${cells.join(" | ")} |`);
}
console.log(`| geometric mean (asked: 4, 2) | | | | **${mean(ratios[0]).toFixed(1)}** | | | **${mean(ratios[1]).toFixed(1)}** |`);
