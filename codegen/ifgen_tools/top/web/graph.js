// Draws the graph where the server has placed its boxes, and lets the user move, zoom and choose.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = 24; // px
const LEAST = 0.08; // the smallest and the largest scale
const MOST = 4;
const READABLE = 0.5; // the scale from which texts can be read
const STILL = 5; // px that a pointer may move while it chooses

const element = (name, attributes = {}) => {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
};

export class Graph {
  constructor(drawing, scene, onChoice) {
    this.drawing = drawing;
    this.scene = scene;
    this.onChoice = onChoice;
    this.boxes = new Map();
    this.lines = [];
    this.view = { x: 0, y: 0, scale: 1 };
    this.pointers = new Map();
    this.isTouched = false; // by the user: then a new picture does not move what is seen
    this.chosen = "";
    this.filter = "";
    this.listen();
  }

  draw(picture) {
    this.picture = picture;
    this.scene.replaceChildren();
    this.boxes.clear();
    this.lines = [];
    const places = new Map(picture.boxes.map((box) => [box.id, box]));
    for (const line of picture.lines) {
      const path = element("path", { class: "line", d: curve(places.get(line.from), places.get(line.to)) });
      this.scene.append(path);
      this.lines.push({ ...line, path });
    }
    for (const box of picture.boxes) this.boxes.set(box.id, this.box(box));
    if (!this.isTouched) this.fit(READABLE);
    this.emphasise();
  }

  box(box) {
    const group = element("g", { class: `box ${box.kind}`, tabindex: "0", role: "button", "aria-label": box.id });
    const left = box.x - box.width / 2;
    const top = box.y - box.height / 2;
    const radius = { node: 3, topic: box.height / 2 }[box.kind] ?? 9;
    group.append(element("rect", { x: left, y: top, width: box.width, height: box.height, rx: radius }));
    const name = element("text", { x: box.x, y: box.y - 2 });
    name.textContent = box.label;
    const title = element("title");
    title.textContent = box.name;
    group.append(title);
    const below = element("text", { class: "below", x: box.x, y: box.y + 12 });
    group.append(name, below);
    group.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") this.choose(box.id);
    });
    group.dataset.id = box.id;
    this.scene.append(group);
    return { ...box, group, below, title };
  }

  annotate(texts) { // a map from ids to [text, is something missing, text of the tooltip]
    for (const [id, box] of this.boxes) {
      const [text, isMissing, title] = texts.get(id) ?? ["", false, ""];
      box.title.textContent = title ? `${box.name}\n${title}` : box.name;
      if (box.below.textContent !== text) box.below.textContent = text;
      box.group.classList.toggle("missing", isMissing);
    }
  }

  choose(id) {
    this.chosen = this.chosen === id ? "" : id;
    this.emphasise();
    this.onChoice(this.chosen);
  }

  mark(id) {
    this.chosen = this.boxes.has(id) ? id : "";
    this.emphasise();
  }

  search(text) {
    this.filter = text.toLowerCase();
    this.emphasise();
  }

  emphasise() { // what is chosen with its neighbours, or what the filter lets pass with its neighbours
    const roots = new Set();
    for (const [id, box] of this.boxes) {
      if (this.filter ? box.name.toLowerCase().includes(this.filter) : id === this.chosen) roots.add(id);
    }
    const isAll = !this.filter && !this.chosen;
    const near = new Set(roots);
    for (const line of this.lines) {
      if (roots.has(line.from)) near.add(line.to);
      if (roots.has(line.to)) near.add(line.from);
    }
    for (const [id, box] of this.boxes) {
      box.group.classList.toggle("dim", !isAll && !near.has(id));
      box.group.classList.toggle("chosen", id === this.chosen);
    }
    for (const line of this.lines) {
      line.path.classList.toggle("dim", !isAll && !roots.has(line.from) && !roots.has(line.to));
    }
  }

  // Moving and zooming

  place() {
    const { x, y, scale } = this.view;
    this.scene.setAttribute("transform", `translate(${x} ${y}) scale(${scale})`);
  }

  fit(least = LEAST) { // all of it, or as much as fits at the smallest scale, from the left
    const { width, height } = this.drawing.getBoundingClientRect();
    if (!this.picture || !width) return;
    const across = (width - 2 * MARGIN) / Math.max(this.picture.width, 1);
    const down = (height - 2 * MARGIN) / Math.max(this.picture.height, 1);
    const scale = Math.max(Math.min(across, down, 1.3), least);
    this.view = {
      scale,
      x: Math.max((width - this.picture.width * scale) / 2, MARGIN),
      y: (height - this.picture.height * scale) / 2,
    };
    this.place();
  }

  zoom(factor, x, y) {
    const scale = Math.min(Math.max(this.view.scale * factor, LEAST), MOST);
    const ratio = scale / this.view.scale;
    this.view = { scale, x: x - (x - this.view.x) * ratio, y: y - (y - this.view.y) * ratio };
    this.isTouched = true;
    this.place();
  }

  button(kind) {
    const { width, height } = this.drawing.getBoundingClientRect();
    if (kind === "fit") {
      this.isTouched = false;
      this.fit();
    } else {
      this.zoom(kind === "in" ? 1.3 : 1 / 1.3, width / 2, height / 2);
    }
  }

  listen() {
    const { drawing, pointers } = this;
    const at = (event) => {
      const frame = drawing.getBoundingClientRect();
      return { x: event.clientX - frame.left, y: event.clientY - frame.top };
    };
    drawing.addEventListener("wheel", (event) => {
      event.preventDefault();
      const { x, y } = at(event);
      this.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), x, y);
    }, { passive: false });
    drawing.addEventListener("pointerdown", (event) => {
      const id = event.target.closest?.(".box")?.dataset.id ?? "";
      pointers.set(event.pointerId, { ...at(event), id, moved: 0 });
      drawing.setPointerCapture(event.pointerId);
    });
    drawing.addEventListener("pointermove", (event) => {
      const pointer = pointers.get(event.pointerId);
      if (!pointer) return;
      const now = at(event);
      const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
      if (other) {
        const before = Math.hypot(pointer.x - other.x, pointer.y - other.y);
        const after = Math.hypot(now.x - other.x, now.y - other.y);
        if (before > 0) this.zoom(after / before, (now.x + other.x) / 2, (now.y + other.y) / 2);
      }
      const share = other ? 0.5 : 1;
      this.view.x += (now.x - pointer.x) * share;
      this.view.y += (now.y - pointer.y) * share;
      pointer.moved += Math.hypot(now.x - pointer.x, now.y - pointer.y);
      Object.assign(pointer, now);
      if (pointer.moved > STILL) {
        this.isTouched = true;
        drawing.classList.add("dragged");
      }
      this.place();
    });
    const up = (event) => {
      const pointer = pointers.get(event.pointerId);
      pointers.delete(event.pointerId);
      drawing.classList.remove("dragged");
      if (!pointer || event.type !== "pointerup" || pointer.moved > STILL) return;
      if (pointer.id) this.choose(pointer.id);
      else if (this.chosen) this.choose(this.chosen);
    };
    drawing.addEventListener("pointerup", up);
    drawing.addEventListener("pointercancel", up);
    new ResizeObserver(() => this.isTouched || this.fit(READABLE)).observe(drawing);
  }
}

function curve(source, target) { // between neighbouring columns, at the sides that face each other
  const side = target.x >= source.x ? 1 : -1;
  const begin = source.x + (side * source.width) / 2;
  const end = target.x - side * (target.width / 2 + 2);
  const middle = (begin + end) / 2;
  return `M${begin},${source.y} C${middle},${source.y} ${middle},${target.y} ${end},${target.y}`;
}
