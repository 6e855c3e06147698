// The latest message as a tree, and plots of the numbers that the user has chosen in it.

const LENGTH = 30; // [s] that a plot shows
const MOST = 4; // plots at a time

export class Message {
  constructor(tree, plots) {
    this.tree = tree;
    this.plots = plots;
    this.series = new Map(); // by path
    this.shape = "";
    this.leaves = new Map();
    this.open = new Set([""]);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.drawAll());
    new ResizeObserver(() => this.drawAll()).observe(plots);
  }

  clear() {
    this.series.clear();
    this.plots.replaceChildren();
    this.tree.replaceChildren();
    this.shape = "";
    this.leaves.clear();
  }

  show(fields, at) {
    const shape = shapeOf(fields);
    if (shape !== this.shape) { // otherwise only values change, and what is unfolded or marked stays so
      this.shape = shape;
      this.leaves.clear();
      this.tree.replaceChildren(...this.children(fields, ""));
    }
    this.fill(fields, "");
    for (const [path, series] of this.series) {
      const leaf = this.leaves.get(path);
      if (leaf === undefined || typeof leaf.current !== "number") continue;
      series.points.push([at, leaf.current]);
      while (series.points.length && series.points[0][0] < at - LENGTH) series.points.shift();
      this.draw(series);
    }
  }

  children(value, path) {
    return Object.entries(value).map(([name, each]) => this.branch(name, each, path ? `${path}.${name}` : name));
  }

  branch(name, value, path) {
    if (value === null || typeof value !== "object") return this.leaf(name, value, path);
    const details = document.createElement("details");
    const summary = document.createElement("summary");
    summary.textContent = Array.isArray(value) ? `${name} [${countOf(value)}]` : name;
    const inside = document.createElement("div");
    inside.className = "inside";
    inside.append(...this.children(value, path));
    details.append(summary, inside);
    details.open = this.open.has(path) || (!Array.isArray(value) && !this.open.has(`-${path}`)) || value.length <= 3;
    details.addEventListener("toggle", () => {
      this.open.delete(details.open ? `-${path}` : path);
      this.open.add(details.open ? path : `-${path}`);
    });
    return details;
  }

  leaf(name, value, path) {
    const line = document.createElement("div");
    line.className = "leaf";
    const label = document.createElement("span");
    label.className = "name";
    label.textContent = `${name}:`;
    const shown = document.createElement(typeof value === "number" ? "button" : "span");
    shown.className = typeof value === "number" ? "number" : "value";
    if (typeof value === "number") {
      shown.title = "plot";
      shown.addEventListener("click", () => this.toggle(path));
      shown.classList.toggle("plotted", this.series.has(path));
    }
    line.append(label, shown);
    this.leaves.set(path, { shown, current: undefined });
    return line;
  }

  fill(value, path) {
    for (const [name, each] of Object.entries(value)) {
      const inner = path ? `${path}.${name}` : name;
      if (each !== null && typeof each === "object") {
        this.fill(each, inner);
        continue;
      }
      const leaf = this.leaves.get(inner);
      if (!leaf || leaf.current === each) continue;
      leaf.current = each;
      leaf.shown.textContent = typeof each === "string" ? JSON.stringify(each) : shortNumber(each);
    }
  }

  toggle(path) {
    const known = this.series.get(path);
    if (known) {
      known.figure.remove();
      this.series.delete(path);
    } else {
      while (this.series.size >= MOST) this.toggle(this.series.keys().next().value);
      this.series.set(path, this.plot(path));
    }
    this.leaves.get(path)?.shown.classList.toggle("plotted", !known);
  }

  plot(path) {
    const figure = document.createElement("figure");
    figure.className = "plot";
    const caption = document.createElement("figcaption");
    const label = document.createElement("b");
    label.textContent = path;
    const range = document.createElement("span");
    const end = document.createElement("button");
    end.textContent = "\u00d7";
    end.setAttribute("aria-label", `no plot of ${path}`);
    end.addEventListener("click", () => this.toggle(path));
    caption.append(label, range, end);
    const canvas = document.createElement("canvas");
    canvas.dataset.path = path;
    figure.append(caption, canvas);
    this.plots.append(figure);
    const used = new Set([...this.series.values()].map((series) => series.colour));
    const colour = [0, 1, 2, 3].find((number) => !used.has(number)) ?? 0;
    return { figure, canvas, range, points: [], colour };
  }

  drawAll() {
    for (const series of this.series.values()) this.draw(series);
  }

  draw({ canvas, range, points, colour }) {
    const ratio = devicePixelRatio || 1;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (!points.length || !width) return;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const values = points.map(([, value]) => value);
    let [low, high] = [Math.min(...values), Math.max(...values)];
    range.textContent = `${shortNumber(low)} to ${shortNumber(high)}`;
    if (low === high) [low, high] = [low - Math.abs(low || 1) * 0.1, high + Math.abs(high || 1) * 0.1];
    context.strokeStyle = colourOf(canvas, "--line");
    context.beginPath();
    for (const share of [0.25, 0.5, 0.75]) {
      context.moveTo(0, share * height);
      context.lineTo(width, share * height);
    }
    context.stroke();
    context.strokeStyle = colourOf(canvas, `--plot-${colour}`);
    context.lineWidth = 1.6;
    context.beginPath();
    const last = points.at(-1)[0];
    for (const [at, value] of points) {
      const x = width - ((last - at) / LENGTH) * width;
      const y = height - 6 - ((value - low) / (high - low)) * (height - 12);
      context.lineTo(x, y);
    }
    context.stroke();
  }
}

function colourOf(canvas, name) { // a canvas does not know variables
  canvas.style.color = `var(${name})`;
  return getComputedStyle(canvas).color;
}

function shapeOf(value) {
  if (value === null || typeof value !== "object") return typeof value === "number" ? "n" : "t";
  return `{${Object.entries(value).map(([name, each]) => `${name}:${shapeOf(each)}`).join(",")}}`;
}

function countOf(values) {
  const last = values.at(-1);
  return last && typeof last === "object" && "more" in last ? values.length - 1 + last.more : values.length;
}

export function shortNumber(value) {
  if (typeof value !== "number" || Number.isInteger(value)) return String(value);
  return String(Number(value.toPrecision(6)));
}
