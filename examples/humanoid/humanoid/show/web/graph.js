// The nodes in columns by their role. A chosen node shows who it talks to, and over what.
const SVG = "http://www.w3.org/2000/svg";
const ROLES = {
  "World": ["humanoid_simulator", "audience", "referee", "director"],
  "Senses": ["camera_driver", "joint_state_publisher", "imu_fusion", "face_detection", "obstacle_mapper", "speech_recognition", "teleop", "battery_monitor"],
  "Decisions": ["high_level_task_manager", "navigation_action_server", "dance_action_server", "emergency_stop", "inverse_kinematics_server"],
  "Plans": ["motion_planner", "footstep_planner", "footstep_generation_server", "gait_planner"],
  "Motion": ["whole_body_controller", "joint_controller"],
  "Others": [],
};
const [WIDTH, HEIGHT, COLUMN, ROW, TOP] = [186, 28, 250, 66, 34];
const MANY = 5; // listeners of a topic that would cover all others: it is drawn only for a chosen node

function make(name, attributes, parent, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  parent?.append(element);
  return element;
}

function columns(nodes) {
  const left = new Set(nodes);
  const found = Object.entries(ROLES).map(([role, names]) => [role, names.filter((name) => left.delete(name))]);
  found.at(-1)[1].push(...left);
  return found.filter(([, names]) => names.length);
}

function curve([x1, y1], [x2, y2]) {
  if (x1 === x2) {
    const out = x1 + WIDTH + 34;
    return `M${x1 + WIDTH},${y1} C${out},${y1} ${out},${y2} ${x2 + WIDTH},${y2}`;
  }
  const [a, b] = x1 < x2 ? [x1 + WIDTH, x2] : [x1, x2 + WIDTH];
  return `M${a},${y1} C${(a + b) / 2},${y1} ${(a + b) / 2},${y2} ${b},${y2}`;
}

export class Graph {
  constructor(place, big) {
    this.place = place;
    this.big = big;
    this.large = big.querySelector("div");
    this.open = document.createElement("button");
    this.open.textContent = "Show large";
    this.open.style.flex = "0 0 auto";
    this.open.addEventListener("click", () => {
      this.big.showModal();
      this.draw();
    });
    this.list = document.createElement("ul");
    this.small = document.createElement("div");
    place.append(this.open, this.small, this.list);
    document.addEventListener("tab", () => this.draw());
    big.addEventListener("close", () => this.draw());
  }

  show(graph) {
    this.graph = graph;
    this.draw();
  }

  draw() {
    if (!this.graph) return;
    if (!this.place.hidden) this.small.replaceChildren(this.picture());
    if (this.big.open) this.large.replaceChildren(this.picture());
    this.explain();
  }

  picture() {
    const { nodes, links } = this.graph;
    const shown = columns(nodes);
    const rows = Math.max(...shown.map(([, names]) => names.length));
    const box = `-8 0 ${shown.length * COLUMN - COLUMN + WIDTH + 56} ${TOP + rows * ROW}`;
    const svg = make("svg", { class: "graph", viewBox: box });
    const places = new Map();
    shown.forEach(([role, names], column) => {
      make("text", { class: "role", x: column * COLUMN, y: 18 }, svg, role);
      names.forEach((name, row) => places.set(name, [column * COLUMN, TOP + row * ROW + HEIGHT / 2]));
    });
    const loud = this.loud();
    for (const [from, to, names] of links) {
      if (!places.has(from) || !places.has(to)) continue;
      const css = from === this.chosen ? "out" : to === this.chosen ? "in" : "";
      if (!css && names.every((name) => loud.has(name))) continue;
      const path = make("path", { d: curve(places.get(from), places.get(to)), class: css }, svg);
      make("title", {}, path, `${from} → ${to}: ${names.join(", ")}`);
    }
    svg.classList.toggle("chosen", places.has(this.chosen));
    for (const [name, [x, y]] of places) {
      const group = make("g", { class: name === this.chosen ? "node chosen" : "node" }, svg);
      make("rect", { x, y: y - HEIGHT / 2, width: WIDTH, height: HEIGHT, rx: 6 }, group);
      make("text", { x: x + WIDTH / 2, y: y + 4, "text-anchor": "middle" }, group, name);
      group.addEventListener("click", () => {
        this.chosen = this.chosen === name ? null : name;
        this.draw();
      });
    }
    return svg;
  }

  // The topics that many nodes listen to.
  loud() {
    const listeners = new Map();
    for (const [, to, names] of this.graph.links) {
      for (const name of names) listeners.set(name, (listeners.get(name) ?? new Set()).add(to));
    }
    return new Set([...listeners].filter(([, nodes]) => nodes.size > MANY).map(([name]) => name));
  }

  explain() {
    const { links, problems } = this.graph;
    const lines = this.chosen
      ? links
          .filter(([from, to]) => from === this.chosen || to === this.chosen)
          .map(([from, to, names]) => (from === this.chosen ? `to ${to}: ` : `from ${from}: `) + names.join(", "))
      : ["Choose a node: it shows who it talks to.", `Heard by many, and drawn only then: ${[...this.loud()].join(", ")}`];
    (this.big.open ? this.big : this.place).append(this.list);
    this.list.replaceChildren(
      ...[...problems, ...lines].map((text) => {
        const line = document.createElement("li");
        line.textContent = text;
        return line;
      }),
    );
  }
}
