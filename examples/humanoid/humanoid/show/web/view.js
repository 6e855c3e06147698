// The page: draws each state that the server sends.
import * as THREE from "three";
import { OrbitControls } from "/three/OrbitControls.js";
import { Robot } from "/robot.js";

const LEFT = 1;
const SOLE = [0.22, 0.11, 0.004]; // m
const FLOOR = 40; // m, a square about the origin
const SOLE_AHEAD = 0.02; // m, the middle of a sole in front of its ankle
const COLORS = { left: 0x2e9e5b, right: 0xe8862e, goal: 0x1f6feb };
const element = (id) => document.getElementById(id);

// Squares of half a metre, so that walking can be seen.
function chequers() {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 2;
  const context = canvas.getContext("2d");
  context.fillStyle = "#dde4ea";
  context.fillRect(0, 0, 2, 2);
  context.fillStyle = "#c9d3dc";
  context.fillRect(0, 0, 1, 1);
  context.fillRect(1, 1, 1, 1);
  const texture = new THREE.CanvasTexture(canvas);
  texture.magFilter = THREE.NearestFilter;
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.repeat.set(FLOOR, FLOOR);
  texture.anisotropy = 8;
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

class Scene {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.shadowMap.enabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.05, 60);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(2.4, -2.2, 1.5);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0, 0, 0.7);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.light();
    this.footsteps = new THREE.Group();
    this.scene.add(this.footsteps);
    this.goal = new THREE.Mesh(
      new THREE.ConeGeometry(0.09, 0.28, 24).rotateZ(-Math.PI / 2), // points along x
      new THREE.MeshStandardMaterial({ color: COLORS.goal }),
    );
    this.goal.visible = false;
    this.scene.add(this.goal);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paint());
    this.paint();
    this.resize();
    this.renderer.setAnimationLoop(() => this.render());
  }

  light() {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8899aa, 1.6));
    const sun = new THREE.DirectionalLight(0xffffff, 2.2);
    sun.position.set(2, -3, 5);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    const ground = new THREE.Mesh(
      new THREE.PlaneGeometry(FLOOR, FLOOR),
      new THREE.MeshStandardMaterial({ map: chequers(), roughness: 1 }),
    );
    ground.receiveShadow = true;
    this.sun = sun;
    this.scene.add(sun, sun.target, ground);
  }

  paint() {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    this.scene.background = new THREE.Color(dark ? 0x1a212a : 0xeef2f6);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  show(state) {
    if (!this.robot) return;
    this.robot.pose(state.joints);
    if (state.base) {
      const [x, y, z, ...orientation] = state.base;
      const before = this.robot.position.clone();
      this.robot.position.set(x, y, z);
      this.robot.quaternion.set(...orientation);
      // The camera moves with the robot and keeps the direction that the user chose.
      const moved = this.robot.position.clone().sub(before).setZ(0);
      this.camera.position.add(moved);
      this.controls.target.add(moved);
      this.sun.position.add(moved);
      this.sun.target.position.add(moved);
    }
    this.goal.visible = Boolean(state.goal);
    if (state.goal) {
      this.goal.position.set(state.goal[0], state.goal[1], 0.02);
      this.goal.rotation.z = state.goal[2];
    }
    const steps = JSON.stringify(state.steps);
    if (steps !== this.drawn) this.drawSteps(state.steps);
    this.drawn = steps;
  }

  drawSteps(steps) {
    this.footsteps.clear();
    for (const [leg, x, y, z, yaw] of steps) {
      const color = leg === LEFT ? COLORS.left : COLORS.right;
      const mesh = new THREE.Mesh(new THREE.BoxGeometry(...SOLE), new THREE.MeshStandardMaterial({ color }));
      mesh.position.set(x + SOLE_AHEAD * Math.cos(yaw), y + SOLE_AHEAD * Math.sin(yaw), z + SOLE[2]);
      mesh.rotation.z = yaw;
      this.footsteps.add(mesh);
    }
  }

  render() {
    this.controls.update();
    this.renderer.render(this.scene, this.camera);
  }
}

const words = (name) => name.replace(/^\//, "").replaceAll("_", " ");

function goalCard([name, goal]) {
  const card = document.createElement("div");
  const share = goal.progress ?? (goal.steps ? goal.taken / goal.steps : 0);
  const parts = [goal.state];
  if (goal.left !== undefined) parts.push(`${goal.left.toFixed(2)} m left`, `step ${goal.taken} of ${goal.steps}`);
  if (goal.beat !== undefined) parts.push(`beat ${goal.beat}`);
  if (goal.replanning) parts.push("planning again");
  const text = document.createElement("p");
  text.innerHTML = "<b></b> <span class=quiet></span>";
  text.firstElementChild.textContent = words(name);
  text.lastElementChild.textContent = parts.filter(Boolean).join(", ");
  const bar = document.createElement("progress");
  bar.value = goal.state === "succeeded" ? 1 : share;
  bar.setAttribute("aria-label", words(name));
  card.append(text, bar);
  return card;
}

function topicRow([name, type, rate]) {
  const row = document.createElement("tr");
  for (const text of [name, type, rate.toFixed(1)]) {
    const cell = row.insertCell();
    cell.textContent = cell.title = text;
  }
  row.lastElementChild.className = "number";
  return row;
}

function showWords(state) {
  element("mode").textContent = state.mode ?? "waiting";
  element("reason").textContent = state.reason ?? "";
  element("time").textContent = `${(state.time ?? 0).toFixed(1)} s`;
  element("speed").textContent = `${state.speed.toFixed(2)}×`;
  if (state.battery) {
    element("battery").textContent = `${Math.round(state.battery.charge * 100)} % (${state.battery.level})`;
  }
  const goals = Object.entries(state.goals).filter(([, goal]) => goal.state);
  const running = goals.some(([, goal]) => ["accepted", "executing"].includes(goal.state));
  element("cancel").disabled = !running;
  if (goals.length) element("goals").replaceChildren(...goals.map(goalCard));
  const stopped = Boolean(state.stop?.active);
  element("banner").hidden = !stopped;
  element("banner").textContent = `Emergency stop: ${state.stop?.reason || "no reason given"}`;
  element("stop").textContent = stopped ? "Release the stop" : "Emergency stop";
  element("stop").dataset.post = stopped ? "/release" : "/stop";
  element("topics").replaceChildren(...state.topics.map(topicRow));
}

async function showGraph() {
  const answer = await fetch("/graph.svg");
  const text = await answer.text();
  if (text !== showGraph.shown) element("drawing").innerHTML = text;
  showGraph.shown = text;
}

for (const button of document.querySelectorAll("button[data-post]")) {
  button.addEventListener("click", () =>
    fetch(button.dataset.post, { method: "POST", headers: { "X-Humanoid": "1" } }),
  );
}

const scene = new Scene(element("robot"));
const states = new EventSource("/states");
states.onopen = () => (element("lost").hidden = true);
states.onerror = () => (element("lost").hidden = false);
states.onmessage = async ({ data }) => {
  const state = JSON.parse(data);
  if (state.robot && !scene.robot && !scene.loading) {
    scene.loading = true;
    scene.robot = new Robot(await (await fetch("/robot.urdf")).text());
    scene.scene.add(scene.robot);
  }
  scene.show(state);
  showWords(state);
};
showGraph();
setInterval(() => showGraph().catch(() => {}), 3000);
