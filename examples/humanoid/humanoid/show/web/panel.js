// The words beside the picture: goals, buttons, log and topics. Each part changes only when its values do.
import { command, say } from "/hands.js";

const element = (id) => document.getElementById(id);
const RUNNING = ["accepted", "executing", "canceling"];

function tabs() {
  const buttons = document.querySelectorAll("[data-tab]");
  for (const button of buttons) {
    button.addEventListener("click", () => {
      for (const other of buttons) {
        other.setAttribute("aria-selected", String(other === button));
        element(other.dataset.tab).hidden = other !== button;
      }
      document.dispatchEvent(new CustomEvent("tab", { detail: button.dataset.tab }));
    });
  }
}

export class Panel {
  constructor() {
    this.goals = { walk: {}, dance: {} };
    this.stopped = false;
    this.paused = false;
    this.waiting = {}; // values of tabs that nobody sees
    tabs();
    document.addEventListener("tab", () => this.showTab());
    this.buttons();
  }

  buttons() {
    const on = (id, what) => element(id).addEventListener("click", () => command(what()));
    on("cancel", () => ({ do: "cancel" }));
    on("stop", () => ({ do: this.stopped ? "release" : "stop" }));
    on("pause", () => ({ do: this.paused ? "run" : "pause" }));
    on("step", () => ({ do: "step" }));
    on("restart", () => ({ do: "restart", scenario: element("scenario").value }));
    element("speed").addEventListener("change", (event) => command({ do: "speed", factor: Number(event.target.value) }));
    element("eye").addEventListener("change", async (event) => {
      if (!(await command({ do: "camera", on: event.target.checked }))) event.target.checked = false;
    });
    element("say").addEventListener("submit", async (event) => {
      event.preventDefault();
      const { words } = event.target.elements;
      if (await command({ do: "say", words: words.value })) words.value = "";
    });
  }

  setup({ dances, scenarios }) {
    element("dances").replaceChildren(
      ...dances.map((name) => {
        const button = document.createElement("button");
        button.textContent = name;
        button.addEventListener("click", () => command({ do: "dance", name }));
        return button;
      }),
    );
    const none = element("scenario").options[0];
    element("scenario").replaceChildren(none, ...scenarios.map((name) => new Option(name, name)));
  }

  gait({ mode, reason }) {
    element("mode").textContent = mode;
    element("mode").title = reason;
    if (reason && reason !== this.reason) say(reason, true);
    this.reason = reason;
  }

  stop({ active, reason }) {
    this.stopped = active;
    element("banner").hidden = !active;
    const help = reason.includes("has fallen") ? ": Restart stands it up" : "";
    element("banner").textContent = `Emergency stop: ${reason || "no reason given"}${help}`;
    element("stop").textContent = active ? "Release the stop" : "Emergency stop";
  }

  run({ paused, speed }) {
    this.paused = paused;
    element("pause").textContent = paused ? "Go on" : "Pause";
    element("step").disabled = !paused;
    const known = [...element("speed").options].some((option) => Number(option.value) === speed);
    if (known && document.activeElement !== element("speed")) element("speed").value = String(speed);
  }

  goal(kind, values) {
    const old = this.goals[kind];
    if (values.goal === old.goal) Object.assign(old, values);
    else if (values.state !== undefined) this.goals[kind] = values; // how far the last one came says nothing of it
    this.showGoals();
  }

  job(task) {
    this.task = task;
    this.showGoals();
  }

  showGoals() {
    const cards = [];
    const { walk, dance } = this.goals;
    if (RUNNING.includes(walk.state)) {
      const words = walk.left === undefined ? "" : `${walk.left.toFixed(2)} m left, step ${walk.taken} of ${walk.steps}`;
      cards.push(["Walk", `${walk.state}${words && ": "}${words}`, walk.steps ? walk.taken / walk.steps : 0]);
    }
    if (RUNNING.includes(dance.state)) {
      cards.push(["Dance", `${dance.state}${dance.beat ? `: beat ${dance.beat}` : ""}`, dance.progress ?? 0]);
    }
    element("cancel").disabled = cards.length === 0 && this.task?.state !== "running";
    const { task } = this;
    const more = task?.waiting ? `, ${task.waiting} more` : "";
    if (!cards.length && task?.state === "running") cards.push(["Task", `${task.words}${more}`, 0]);
    if (!cards.length) cards.push(["No goal", this.ended(), null]);
    element("goals").replaceChildren(...cards.map((card) => this.card(...card)));
  }

  // How the last goals have ended.
  ended() {
    const ends = Object.entries(this.goals).filter(([, goal]) => goal.state);
    return ends.map(([kind, goal]) => `${kind} ${goal.state}`).join(", ") || "click the floor";
  }

  card(title, text, share) {
    const card = document.createElement("div");
    const words = document.createElement("p");
    const name = document.createElement("b");
    const quiet = document.createElement("span");
    name.textContent = title;
    quiet.className = "quiet";
    quiet.textContent = ` ${text}`;
    words.append(name, quiet);
    card.append(words);
    if (share !== null) {
      const bar = document.createElement("progress");
      bar.value = share;
      bar.setAttribute("aria-label", title);
      card.append(bar);
    }
    return card;
  }

  log(lines) {
    this.later("log", () =>
      element("lines").replaceChildren(
        ...lines.toReversed().map(([, level, name, text]) => {
          const line = document.createElement("li");
          const who = document.createElement("b");
          line.className = level;
          who.textContent = `${name}: `;
          line.append(who, text);
          return line;
        }),
      ),
    );
  }

  topics(rows) {
    this.later("topics", () =>
      document.querySelector("#topics tbody").replaceChildren(
        ...rows.map(([topic, type, rate]) => {
          const row = document.createElement("tr");
          const name = row.insertCell();
          const kind = document.createElement("small");
          kind.textContent = type.replace("/msg/", "/");
          name.append(topic, kind);
          const number = row.insertCell();
          number.className = "number";
          number.textContent = rate.toFixed(1);
          return row;
        }),
      ),
    );
  }

  // Draw a tab when somebody sees it.
  later(tab, draw) {
    this.waiting[tab] = draw;
    this.showTab();
  }

  showTab() {
    for (const [tab, draw] of Object.entries(this.waiting)) {
      if (element(tab).hidden) continue;
      delete this.waiting[tab];
      draw();
    }
  }

  text(id, value) {
    if (element(id).textContent !== value) element(id).textContent = value;
  }

  connected(is) {
    element("lost").hidden = is;
  }

  async picture(number) {
    element("camera").hidden = !number;
    element("eye").checked = Boolean(number);
    if (!number) return;
    const image = await createImageBitmap(await (await fetch(`/camera.jpg?${number}`)).blob());
    const canvas = document.querySelector("#camera canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    this.image = image;
    this.found(this.objects ?? []);
  }

  // The camera's picture, with what was detected in it.
  found(objects) {
    this.objects = objects;
    if (!this.image) return;
    const canvas = document.querySelector("#camera canvas");
    const context = canvas.getContext("2d");
    context.drawImage(this.image, 0, 0);
    context.strokeStyle = context.fillStyle = "#ffd43b";
    context.lineWidth = Math.max(1, canvas.width / 160);
    context.font = `${Math.round(canvas.width / 16)}px system-ui, sans-serif`;
    for (const [label, x, y, width, height] of objects) {
      context.strokeRect(x, y, width, height);
      context.fillText(label, x, y > 16 ? y - 4 : y + height + 14);
    }
  }
}
