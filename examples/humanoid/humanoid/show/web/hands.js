// What a visitor does with pointer and keys becomes commands to the robot.
import * as THREE from "three";

const CLICK = 6; // pixels that a pointer may move in a click
const PUSH = 10; // N s for a metre of arrow
const STRONGEST = 25; // N s
const AGAIN = 150; // ms between repeated commands while something is held
const NEAR = 0.35; // m within which a goal is beside the robot, which keeps its heading
const KEYS = {
  KeyW: [1, 0, 0], ArrowUp: [1, 0, 0], KeyS: [-1, 0, 0], ArrowDown: [-1, 0, 0],
  KeyA: [0, 0, 1], ArrowLeft: [0, 0, 1], KeyD: [0, 0, -1], ArrowRight: [0, 0, -1],
  KeyQ: [0, 1, 0], KeyE: [0, -1, 0],
};

const toast = document.getElementById("toast");

export function say(text, refused = false) {
  if (!text) return;
  toast.textContent = text;
  toast.className = refused ? "refused" : "";
  toast.hidden = false;
  clearTimeout(say.timer);
  say.timer = setTimeout(() => (toast.hidden = true), refused ? 6000 : 2500);
}

// Send a command; says what came of it, unless it is quiet and was accepted.
export async function command(what, quiet = false) {
  try {
    const answer = await fetch("/command", {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Humanoid": "1" },
      body: JSON.stringify(what),
    });
    document.getElementById("hint").hidden = true; // who commands has read it
    const { accepted, text } = answer.ok ? await answer.json() : { accepted: false, text: answer.statusText };
    if (!quiet || !accepted) say(accepted ? text : `Refused: ${text}`, !accepted);
    return accepted;
  } catch {
    say("The demo does not answer.", true);
    return false;
  }
}

// A finger or the mouse on the picture: click the floor, drag an arrow from the robot, or drag an obstacle.
export class Pointer {
  constructor(scene) {
    this.scene = scene;
    this.ray = new THREE.Raycaster();
    const { canvas } = scene;
    canvas.addEventListener("pointerdown", (event) => this.down(event), true);
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    for (const name of ["pointercancel", "pointerleave"]) canvas.addEventListener(name, () => this.leave());
  }

  aim(event) {
    const { left, top, width, height } = this.scene.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    this.ray.setFromCamera(at, this.scene.camera);
  }

  // The point under the pointer at a height, or null if it is far away.
  at(height) {
    const point = new THREE.Vector3();
    const plane = new THREE.Plane(new THREE.Vector3(0, 0, 1), -height);
    const found = this.ray.ray.intersectPlane(plane, point);
    const { base } = this.scene;
    return found && base && Math.hypot(point.x - base[0], point.y - base[1]) < 10 ? point : null;
  }

  down(event) {
    if (event.button !== 0 || !event.isPrimary) return;
    this.aim(event);
    this.start = [event.clientX, event.clientY];
    const { robot, base } = this.scene;
    const things = robot && base ? [robot, ...this.scene.obstacles.children] : [];
    const hit = this.ray.intersectObjects(things, true)[0]?.object;
    this.moving = this.scene.obstacles.children.includes(hit) ? hit : null;
    this.pushing = Boolean(hit && !this.moving);
    this.scene.controls.enabled = !hit;
    if (hit) this.scene.canvas.setPointerCapture(event.pointerId);
  }

  move(event) {
    this.aim(event);
    const { scene } = this;
    if (this.pushing) {
      this.momentum = this.arrow();
      return;
    }
    if (this.moving) {
      const place = this.at(0);
      if (place) [this.moving.position.x, this.moving.position.y] = [place.x, place.y];
      scene.changed = true;
      return;
    }
    const point = event.pointerType === "mouse" && !event.buttons ? this.at(0) : null;
    if (!point && !scene.hover.visible) return;
    scene.hover.visible = Boolean(point);
    if (point) scene.hover.position.set(point.x, point.y, 0.004);
    scene.changed = true;
  }

  // Draw the arrow from the robot's chest to the pointer; returns the push in N s, or null if there is none.
  arrow() {
    const { base, push } = this.scene;
    const height = base[2] + 0.3;
    const point = this.at(height) ?? this.at(0);
    push.visible = false;
    this.scene.changed = true;
    if (!point) return null;
    let [x, y] = [point.x - base[0], point.y - base[1]];
    const length = Math.hypot(x, y);
    if (length < 0.1) return null;
    const most = Math.min(1, STRONGEST / PUSH / length);
    [x, y] = [x * most, y * most];
    push.visible = true;
    push.position.set(base[0], base[1], height);
    push.rotation.z = Math.atan2(y, x);
    push.scale.set(length * most, 2, 1);
    say(`${(PUSH * length * most).toFixed(1)} N s`);
    return [PUSH * x, PUSH * y];
  }

  up(event) {
    if (!this.start) return;
    const moved = Math.hypot(event.clientX - this.start[0], event.clientY - this.start[1]);
    this.aim(event);
    if (this.pushing && this.momentum) {
      command({ do: "push", x: this.momentum[0], y: this.momentum[1] });
    } else if (this.moving && moved >= CLICK) {
      const { x, y } = this.moving.position;
      command({ do: "move", name: this.moving.name, x, y });
    } else if (!this.pushing && !this.moving && moved < CLICK) {
      const point = this.at(0);
      if (point) this.walk(point);
    }
    this.leave();
  }

  // Walk to a point, heading where the way there leads.
  walk({ x, y }) {
    const [bx, by, , qx, qy, qz, qw] = this.scene.base;
    const present = Math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz));
    const far = Math.hypot(x - bx, y - by) > NEAR;
    command({ do: "walk", x, y, yaw: far ? Math.atan2(y - by, x - bx) : present });
  }

  leave() {
    this.start = this.momentum = this.moving = null;
    this.pushing = this.scene.hover.visible = this.scene.push.visible = false;
    this.scene.controls.enabled = this.scene.changed = true;
  }
}

// Keys and buttons that drive while they are held.
export class Driver {
  constructor() {
    this.held = new Map();
    const typing = (event) => event.target.closest?.("input, select, dialog") || event.ctrlKey || event.metaKey || event.altKey;
    addEventListener("keydown", (event) => {
      if (KEYS[event.code] && !typing(event)) {
        event.preventDefault();
        if (!event.repeat) this.hold(event.code, KEYS[event.code]);
      }
    });
    addEventListener("keyup", (event) => this.release(event.code));
    addEventListener("blur", () => this.releaseAll());
    document.addEventListener("visibilitychange", () => this.releaseAll());
    for (const button of document.querySelectorAll("[data-drive]")) {
      const axes = button.dataset.drive.split(" ").map(Number);
      button.addEventListener("pointerdown", (event) => {
        button.setPointerCapture(event.pointerId);
        button.classList.add("held");
        this.hold(button, axes);
      });
      for (const name of ["pointerup", "pointercancel"]) {
        button.addEventListener(name, () => {
          button.classList.remove("held");
          this.release(button);
        });
      }
    }
  }

  hold(who, axes) {
    this.held.set(who, axes);
    this.timer ??= setInterval(() => this.send(), AGAIN);
    this.send();
  }

  release(who) {
    if (!this.held.delete(who)) return;
    if (this.held.size === 0) {
      clearInterval(this.timer);
      this.timer = null;
    }
    this.send();
  }

  releaseAll() {
    for (const who of [...this.held.keys()]) this.release(who);
  }

  async send() {
    const sum = [0, 1, 2].map((axis) => [...this.held.values()].reduce((total, axes) => total + axes[axis], 0));
    const [forward, left, turn] = sum.map((value) => Math.max(-1, Math.min(1, value)));
    if (!(await command({ do: "drive", forward, left, turn }, true))) this.releaseAll();
  }
}
