// The page of `ifgen top --web`: it listens to one stream of events, and shows what comes.

import { Graph } from "./graph.js";
import { Message } from "./message.js";

const CHANGE = 300; // [ms] after which a change of what is looked at opens a new stream
const MOST_SHOWN = 50; // topics whose bandwidth is measured

const $ = (id) => document.getElementById(id);
const state = { view: "graph", snapshot: null, picture: null, inspected: "", filter: "", sorts: {}, shown: [], hasServices: false, hasLeaves: true };

// Figures as texts

const prefixes = ["", "k", "M", "G", "T"];
function amount(value) {
  if (value === null) return "-";
  let index = 0;
  while (value >= 999.5 && index < prefixes.length - 1) {
    value /= 1000;
    index += 1;
  }
  const digits = value >= 99.95 || value === 0 ? 0 : value >= 9.995 ? 1 : 2;
  return value.toFixed(digits) + prefixes[index];
}
const percent = (value) => (value === null ? "-" : `${Math.round(100 * value)}%`);
const count = (value) => (value === null ? "-" : String(value));
const duration = (value) =>
  !value ? "-" : value < 1e-3 ? `${Math.round(1e6 * value)} us` : value < 1 ? `${(1e3 * value).toFixed(1)} ms` : `${value.toFixed(2)} s`;

// Tables: [title, class, value to sort by, text]

const TABLES = {
  topics: [
    ["Topic", "", (row) => row.name],
    ["Type", "optional", (row) => row.types.join(", ").replaceAll("/msg/", "/")],
    ["Hz", "number", (row) => row.rate, amount],
    ["B/s", "number", (row) => row.bandwidth, amount],
    ["Pub", "number", (row) => row.publishers.length],
    ["Sub", "number", (row) => row.subscriptions.length],
    ["Drops", "number warn", (row) => row.missed, count],
    ["Queue", "number optional busy", (row) => row.fill, percent],
  ],
  nodes: [
    ["Node", "", (row) => row.name],
    ["Process", "", (row) => row.process ?? "-"],
    ["Pub", "number", (row) => row.publishers],
    ["Sub", "number", (row) => row.subscriptions],
    ["Srv", "number optional", (row) => row.servers],
    ["Cli", "number optional", (row) => row.clients],
    ["Load", "number busy", (row) => row.load, percent],
  ],
  subscriptions: [
    ["Topic", "", (row) => row.topic],
    ["Node", "", (row) => row.node],
    ["Waiting", "number", (row) => row.waiting, (_, row) => `${row.waiting}/${row.depth || "-"}`],
    ["Dropped", "number warn", (row) => row.dropped],
    ["Lost", "number warn", (row) => row.lost],
  ],
  executors: [
    ["Nodes", "", (row) => row.nodes.join(" ")],
    ["Process", "optional", (row) => row.process],
    ["Kind", "optional", (row) => row.kind],
    ["Threads", "number optional", (row) => row.threads],
    ["Load", "number busy", (row) => row.load, percent],
    ["Calls/s", "number", (row) => row.rate, amount],
    ["Longest", "number", (row) => row.longest, duration],
    ["Callback", "", (row) => row.longest_is],
  ],
};

function showTable() {
  const columns = TABLES[state.view];
  if (!columns || !state.snapshot) return;
  const sort = (state.sorts[state.view] ??= { column: 0, isDown: false });
  const head = document.createElement("tr");
  columns.forEach(([title, kind], index) => {
    const cell = document.createElement("th");
    cell.textContent = title + (index === sort.column ? (sort.isDown ? " \u25be" : " \u25b4") : "");
    cell.className = kind.replace(/warn|busy/, "");
    cell.dataset.column = index;
    head.append(cell);
  });
  $("tables").querySelector("thead").replaceChildren(head);
  const rows = state.snapshot[state.view]
    .map((row) => ({ row, values: columns.map(([, , value]) => value(row)) }))
    .map((found) => ({ ...found, texts: columns.map(([, , , text], i) => (text ? text(found.values[i], found.row) : String(found.values[i]))) }))
    .filter(({ texts }) => !state.filter || texts.some((text) => text.toLowerCase().includes(state.filter)));
  rows.sort((one, other) => {
    const [a, b] = [one.values[sort.column], other.values[sort.column]];
    if (a === null || b === null) return (a === null) - (b === null);
    const order = typeof a === "number" ? a - b : String(a).localeCompare(String(b));
    return sort.isDown ? -order : order;
  });
  $("tables").querySelector("tbody").replaceChildren(...rows.map((each) => tableRow(columns, each)));
  $("empty").textContent = rows.length ? "" : whyEmpty();
  state.shown = state.view === "topics" ? rows.slice(0, MOST_SHOWN).map(({ row }) => row.name) : [];
}

function tableRow(columns, { row, values, texts }) {
  const line = document.createElement("tr");
  const topic = state.view === "topics" ? row.name : state.view === "subscriptions" ? row.topic : "";
  if (topic) {
    line.className = topic === state.inspected ? "choice chosen" : "choice";
    line.dataset.topic = topic;
    line.tabIndex = 0;
    if (row.note) line.title = row.note;
  }
  columns.forEach(([, kind], index) => {
    const cell = document.createElement("td");
    cell.textContent = texts[index];
    cell.className = kind.replace("busy", values[index] >= 0.9 ? "bad" : "").replace("warn", values[index] > 0 ? "warn" : "");
    line.append(cell);
  });
  return line;
}

function whyEmpty() {
  if (state.filter) return `nothing has "${state.filter}" in it`;
  const isTold = state.view === "subscriptions" || state.view === "executors";
  return isTold ? `no ${state.view}: only processes of the local transport tell of theirs` : `no ${state.view}`;
}

// The graph

const graph = new Graph($("drawing"), $("scene"), (id) => {
  const [kind, name] = [id.slice(0, id.indexOf(" ")), id.slice(id.indexOf(" ") + 1)];
  if (kind === "topic") inspect(name);
});

function drawGraph() {
  if (!state.picture) return;
  graph.draw(state.picture[`${Number(state.hasServices)}${Number(state.hasLeaves)}`]);
  annotate();
}

function annotate() {
  if (!state.snapshot) return;
  const texts = new Map();
  for (const node of state.snapshot.nodes) {
    const load = node.load === null ? "" : `load ${percent(node.load)}`;
    texts.set(`node ${node.name}`, [load, false, node.process ?? ""]);
  }
  for (const topic of state.snapshot.topics) {
    const rate = topic.rate === null ? "" : `${amount(topic.rate)} Hz`;
    const missed = topic.missed > 0 ? `, ${topic.missed} missed` : "";
    texts.set(`topic ${topic.name}`, [rate, topic.missed > 0, `${topic.types.join(", ")}${missed}`]);
  }
  for (const kind of ["services", "actions"]) {
    for (const each of state.snapshot[kind]) {
      texts.set(`${kind.slice(0, -1)} ${each.name}`, [kind.slice(0, -1), false, each.types.join(", ")]);
    }
  }
  graph.annotate(texts);
}

// The message

const message = new Message($("tree"), $("plots"));

function inspect(topic) {
  if (state.inspected !== topic) {
    state.inspected = topic;
    message.clear();
    $("inspected").textContent = topic;
    reconnect();
  }
  graph.mark(`topic ${topic}`);
  if (getComputedStyle(document.querySelector('[data-view="message"]')).display !== "none") choose("message");
  facts();
}

function facts() {
  if (!state.inspected || !state.snapshot) return;
  const topic = state.snapshot.topics.find((each) => each.name === state.inspected);
  if (!topic) {
    $("facts").textContent = "this topic is gone";
    return;
  }
  const parts = [topic.types.join(", "), `${amount(topic.rate)} Hz`, `${amount(topic.bandwidth)} B/s`];
  if (topic.note) parts.push(topic.note);
  else if (!topic.publishers.length) parts.push("nobody publishes");
  else if (!$("tree").hasChildNodes()) parts.push("waiting for a message");
  $("facts").textContent = parts.join("  ·  ");
}

// The stream

let source = null;
let pending = 0;
let asked = "";
let isPressed = false;

function reconnect() {
  const query = new URLSearchParams([["inspected", state.inspected], ...state.shown.map((topic) => ["shown", topic])]).toString();
  if (source && query === asked) return;
  clearTimeout(pending);
  pending = setTimeout(() => {
    source?.close();
    asked = query;
    source = new EventSource(`events?${query}`);
    source.addEventListener("snapshot", (event) => {
      state.snapshot = JSON.parse(event.data);
      summary();
      if (!isPressed) showTable(); // what is pressed stays until it is let go, or it could not be clicked
      annotate();
      facts();
      reconnect();
    });
    source.addEventListener("picture", (event) => {
      const picture = JSON.parse(event.data);
      state.picture = picture;
      drawGraph();
    });
    source.addEventListener("message", (event) => {
      if (!event.data) return;
      const found = JSON.parse(event.data);
      if (found.topic === state.inspected) message.show(found.fields, found.at);
    });
    source.addEventListener("error", () => {
      $("summary").textContent = "ifgen top has ended, or too many pages are open";
      $("summary").classList.add("lost");
    });
  }, source ? CHANGE : 0);
}

function summary() {
  const { nodes, topics, executors, silent, transport } = state.snapshot;
  const load = Math.max(0, ...executors.map((each) => each.load ?? 0));
  const parts = [`${nodes.length} nodes`, `${topics.length} topics`];
  if (executors.length) parts.push(`max load ${percent(load)}`);
  if (transport !== "local") parts.push("real rclpy tells no loads, queues and drops");
  else if (silent.length) parts.push(`${silent.length} nodes without figures`);
  $("summary").textContent = parts.join("  ·  ");
  $("summary").classList.remove("lost");
}

// What is seen

function choose(view) {
  state.view = view;
  const isNarrow = matchMedia("(max-width: 760px)").matches;
  for (const button of $("tabs").children) button.setAttribute("aria-selected", String(button.dataset.view === view));
  $("graph").hidden = view !== "graph";
  $("tables").hidden = !(view in TABLES);
  $("message").hidden = isNarrow && view !== "message";
  if (!isNarrow && view === "message") choose("graph");
  if (!(view in TABLES)) state.shown = [];
  showTable();
  reconnect();
}

$("tabs").addEventListener("click", (event) => event.target.dataset.view && choose(event.target.dataset.view));
$("zoom").addEventListener("click", (event) => event.target.dataset.zoom && graph.button(event.target.dataset.zoom));
for (const [id, name] of [["services", "hasServices"], ["leaves", "hasLeaves"]]) {
  $(id).addEventListener("change", (event) => {
    state[name] = event.target.checked;
    graph.isTouched = false;
    drawGraph();
  });
}
$("filter").addEventListener("input", (event) => {
  state.filter = event.target.value.toLowerCase();
  graph.search(state.filter);
  showTable();
});
$("tables").addEventListener("click", (event) => {
  const column = event.target.closest("th")?.dataset.column;
  if (column !== undefined) {
    const sort = state.sorts[state.view];
    const isNumber = TABLES[state.view][column][1].includes("number");
    state.sorts[state.view] = { column: Number(column), isDown: sort.column === Number(column) ? !sort.isDown : isNumber };
    showTable();
  }
  const topic = event.target.closest("tr")?.dataset.topic;
  if (topic) inspect(topic);
});
$("tables").addEventListener("pointerdown", () => (isPressed = true));
for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => (isPressed = false));
$("tables").addEventListener("keydown", (event) => {
  if (event.key === "Enter" && event.target.dataset.topic) inspect(event.target.dataset.topic);
});
matchMedia("(max-width: 760px)").addEventListener("change", () => choose(state.view));
choose("graph");
