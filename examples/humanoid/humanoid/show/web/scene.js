// The scene: the robot, the floor, and what is drawn on it. Lengths in metres, z up.
import * as THREE from "three";
import { OrbitControls } from "/three/OrbitControls.js";
import { Robot } from "/robot.js";

const LEFT = 1; // Footstep.leg
const SOLE = [0.22, 0.11, 0.006];
const SOLE_AHEAD = 0.02; // the middle of a sole in front of its ankle
const FLOOR = 80; // a square about the robot
const TILE = 0.5; // so that walking can be seen
const TRAIL = 600; // points
const TRAIL_STEP = 0.02;
const LEAD = 0.7;
const SLOW = 70; // ms between frames above which the picture is made simpler
const FRAMES = 40; // that are looked at for this

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

function chequers() {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 128;
  const context = canvas.getContext("2d");
  context.fillStyle = css("floor");
  context.fillRect(0, 0, 128, 128);
  context.fillStyle = css("floor-2");
  context.fillRect(0, 0, 64, 64);
  context.fillRect(64, 64, 64, 64);
  const texture = new THREE.CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.repeat.set(FLOOR / (2 * TILE), FLOOR / (2 * TILE));
  texture.anisotropy = 8;
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

const flat = (color, opacity = 1) => new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false });

const BROAD = 0.7; // m beside the line of sight within which the board hides the robot
const HIDING = 10; // obstacles are drawn after the marks that they hide

// Draw something over the robot's feet, later things over earlier ones.
function above(object, order) {
  object.traverse((part) => {
    if (part.material) part.material.depthTest = false;
    part.renderOrder = order;
  });
  return object;
}

// An arrow on the floor from (0, 0) along x; its length is its scale.
function arrow(color) {
  const outline = new THREE.Shape();
  outline.moveTo(0, 0.02).lineTo(0.86, 0.02).lineTo(0.82, 0.06).lineTo(1, 0);
  outline.lineTo(0.82, -0.06).lineTo(0.86, -0.02).lineTo(0, -0.02);
  return new THREE.Mesh(new THREE.ShapeGeometry(outline), flat(color, 0.9));
}

export class Scene {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.shadowMap.enabled = true;
    this.scene = new THREE.Scene();
    this.scene.fog = new THREE.Fog(0xffffff, 7, 24);
    this.camera = new THREE.PerspectiveCamera(38, 1, 0.05, 80);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI / 2 - 0.03;
    this.controls.minDistance = 0.6;
    this.controls.maxDistance = 14;
    this.controls.addEventListener("change", () => (this.changed = true));
    this.light();
    this.marks();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paint());
    this.paint();
    this.resize();
    this.look();
    this.renderer.setAnimationLoop(() => this.render());
  }

  light() {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9aa7b4, 1.7));
    this.sun = new THREE.DirectionalLight(0xffffff, 2.0);
    this.sun.position.set(1.5, -2.5, 4.5);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    Object.assign(this.sun.shadow.camera, { left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, near: 1, far: 9 });
    this.sun.shadow.normalBias = 0.02;
    this.ground = new THREE.Mesh(new THREE.PlaneGeometry(FLOOR, FLOOR), new THREE.MeshLambertMaterial());
    this.ground.receiveShadow = true;
    this.scene.add(this.sun, this.sun.target, this.ground);
  }

  marks() {
    const add = (object, height = 0) => {
      object.position.z = height;
      object.visible = false;
      this.scene.add(object);
      return object;
    };
    const ring = (inner, outer, color, opacity) => new THREE.Mesh(new THREE.RingGeometry(inner, outer, 40), flat(color, opacity));
    this.footsteps = new THREE.Group();
    this.obstacles = new THREE.Group();
    this.scene.add(this.footsteps, this.obstacles);
    this.goal = add(new THREE.Group(), 0.004);
    this.goal.add(ring(0.13, 0.16, 0x1f6feb, 1));
    const heading = arrow(0x1f6feb);
    heading.scale.setScalar(0.34);
    this.goal.add(heading);
    this.hover = add(ring(0.1, 0.12, 0x1f6feb, 0.6), 0.004);
    this.push = add(arrow(0xd6336c), 1.0);
    this.capture = add(new THREE.Mesh(new THREE.CircleGeometry(0.03, 32), flat(0xd6336c)), 0.01);
    this.zmp = add(new THREE.Mesh(new THREE.CircleGeometry(0.022, 32), flat(0x7048e8)), 0.01);
    this.support = add(new THREE.Mesh(new THREE.BufferGeometry(), flat(0x1098ad, 0.4)), 0.01);
    [this.goal, this.support, this.capture, this.zmp].forEach(above);
    above(this.push, HIDING + 1); // in the air
    this.path = add(new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x1f6feb })), 0.006);
    this.trail = add(new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x8a97a5 })), 0.003);
    this.map = add(new THREE.Mesh(new THREE.PlaneGeometry(1, 1), flat(0xffffff, 0.5)), 0.002);
    this.trailed = [];
    this.lead = new THREE.Vector3();
    this.centre = new THREE.Vector3();
  }

  paint() {
    this.scene.background = new THREE.Color(css("page"));
    this.scene.fog.color = this.scene.background;
    this.ground.material.map?.dispose();
    this.ground.material.map = chequers();
    this.ground.material.needsUpdate = true;
    this.colors = { left: css("left"), right: css("right") };
    for (const [object, name] of [[this.capture, "capture"], [this.zmp, "zmp"], [this.support, "support"], [this.push, "capture"]]) {
      object.material.color.set(css(name));
    }
    this.changed = true;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * (this.simpler ? 0.75 : 1));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.fov = width < height ? 46 : 38;
    this.camera.updateProjectionMatrix();
    this.changed = true;
  }

  // From the front quarter, with the feet and the way ahead in the picture.
  look() {
    this.controls.target.set(0, 0, 0.6);
    this.camera.position.set(2.9, -2.2, 1.6);
    this.controls.update();
  }

  load(urdf) {
    if (this.robot) this.scene.remove(this.robot);
    this.robot = new Robot(urdf);
    this.scene.add(this.robot);
    if (this.angles) this.robot.pose(this.angles);
    if (this.base) this.robot.move(this.base);
    this.changed = true;
  }

  pose(angles) {
    this.angles = angles;
    this.robot?.pose(angles);
    this.changed = true;
  }

  // The camera moves with the robot, a little ahead to its goal, and keeps the direction that the visitor chose.
  move(base) {
    const [x, y] = base;
    const jumped = this.base && Math.hypot(x - this.base[0], y - this.base[1]) > 0.5;
    this.base = base;
    if (jumped) this.lead.set(0, 0, 0);
    const wanted = this.aim ? new THREE.Vector3(this.aim[0] - x, this.aim[1] - y, 0).multiplyScalar(0.4) : new THREE.Vector3();
    this.lead.lerp(wanted.clampLength(0, LEAD), 0.03);
    const centre = new THREE.Vector3(x, y, 0).add(this.lead);
    const moved = centre.clone().sub(this.centre);
    this.centre = centre;
    this.robot?.move(base);
    for (const one of [this.camera.position, this.controls.target]) one.add(moved);
    this.sun.target.position.set(x, y, 0);
    this.sun.position.set(x + 1.5, y - 2.5, 4.5);
    // The floor moves along by whole tiles, so that it seems to stand still.
    this.ground.position.set(Math.round(x / (2 * TILE)) * 2 * TILE, Math.round(y / (2 * TILE)) * 2 * TILE, 0);
    if (jumped) this.trailed = [];
    const last = this.trailed.at(-1);
    if (!last || Math.hypot(x - last.x, y - last.y) > TRAIL_STEP) {
      this.trailed = [...this.trailed.slice(1 - TRAIL), new THREE.Vector3(x, y, 0)];
      this.draw(this.trail, this.trailed);
    }
    this.changed = true;
  }

  draw(line, points) {
    line.geometry.dispose();
    line.geometry = new THREE.BufferGeometry().setFromPoints(points);
    line.visible = points.length > 1;
    this.changed = true;
  }

  walk({ steps, goal }) {
    this.aim = goal;
    this.goal.visible = Boolean(goal);
    if (goal) {
      this.goal.position.set(goal[0], goal[1], 0.004);
      this.goal.rotation.z = goal[2];
    }
    for (const old of this.footsteps.children) {
      old.geometry.dispose();
      old.material.dispose();
    }
    this.footsteps.clear();
    for (const [leg, x, y, z, yaw, index] of steps) {
      const color = leg === LEFT ? this.colors.left : this.colors.right;
      const material = new THREE.MeshLambertMaterial({ color, transparent: true });
      const mesh = new THREE.Mesh(new THREE.BoxGeometry(...SOLE), material);
      mesh.userData.index = index;
      mesh.position.set(x + SOLE_AHEAD * Math.cos(yaw), y + SOLE_AHEAD * Math.sin(yaw), z + SOLE[2] / 2);
      mesh.rotation.z = yaw;
      mesh.receiveShadow = true;
      this.footsteps.add(mesh);
    }
    this.taken(this.next ?? 0);
  }

  // Steps that have been taken fade; the goal is gone once the robot stands there.
  taken(next) {
    this.next = next;
    for (const step of this.footsteps.children) step.material.opacity = step.userData.index < next ? 0.25 : 1;
    if (this.footsteps.children.every((step) => step.userData.index < next)) this.goal.visible = Boolean((this.aim = null));
    this.changed = true;
  }

  balance({ capture, zmp, support }) {
    this.capture.position.set(...capture, 0.016);
    this.zmp.position.set(...zmp, 0.018);
    this.capture.visible = this.zmp.visible = true;
    this.support.visible = support.length > 2;
    if (this.support.visible) {
      this.support.geometry.dispose();
      this.support.geometry = new THREE.ShapeGeometry(new THREE.Shape(support.map(([x, y]) => new THREE.Vector2(x, y))));
    }
    this.changed = true;
  }

  way(points) {
    this.draw(this.path, points.map(([x, y]) => new THREE.Vector3(x, y, 0)));
  }

  occupancy(map) {
    this.map.visible = Boolean(map);
    this.changed = true;
    if (!map) return;
    const { width, height, cell, origin, occupied } = map;
    const pixels = new Uint8Array(4 * width * height);
    const color = new THREE.Color(css("danger"));
    for (const index of occupied) pixels.set([255 * color.r, 255 * color.g, 255 * color.b, 255], 4 * index);
    this.map.material.map?.dispose();
    this.map.material.map = new THREE.DataTexture(pixels, width, height);
    this.map.material.map.needsUpdate = this.map.material.needsUpdate = true;
    this.map.scale.set(width * cell, height * cell, 1);
    this.map.position.set(origin[0] + (width * cell) / 2, origin[1] + (height * cell) / 2, 0.002);
  }

  things(list) {
    this.obstacles.clear();
    for (const { name, shape, at, yaw, size, color } of list) {
      const geometry =
        shape === "box"
          ? new THREE.BoxGeometry(...size)
          : shape === "sphere"
            ? new THREE.SphereGeometry(size[0] / 2, 24, 16)
            : new THREE.CylinderGeometry(size[0] / 2, size[0] / 2, size[2], 32).rotateX(Math.PI / 2);
      const material = new THREE.MeshLambertMaterial({ color: new THREE.Color().setRGB(...color, THREE.SRGBColorSpace) });
      material.transparent = true; // so that it is drawn among the marks, and after them
      const mesh = new THREE.Mesh(geometry, material);
      mesh.renderOrder = HIDING;
      mesh.name = name;
      mesh.position.set(...at);
      mesh.rotation.z = yaw;
      mesh.castShadow = mesh.receiveShadow = true;
      this.obstacles.add(mesh);
    }
    this.changed = true;
  }

  // The board with the face, which stands in the scene from the beginning; it faces against x.
  stand({ at, half, face, eye, mouth }) {
    if (this.board) return;
    this.board = new THREE.Group();
    const add = (geometry, color, x, y, z) => {
      const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color }));
      mesh.position.set(x, y, z);
      mesh.castShadow = true;
      this.board.add(mesh);
    };
    const [dark, light] = [0x0b0b0d, 0xf2f2eb];
    const disc = (radius) => new THREE.CylinderGeometry(radius, radius, 0.004, 32).rotateZ(Math.PI / 2);
    add(new THREE.BoxGeometry(0.02, 2 * half, 2 * half), dark, 0.012, 0, at[2]);
    add(new THREE.CylinderGeometry(0.02, 0.02, at[2], 16).rotateX(Math.PI / 2), dark, 0.05, 0, at[2] / 2);
    add(disc(face), light, -0.002, 0, at[2]);
    for (const side of [-1, 1]) add(disc(eye[0]), dark, -0.004, side * eye[1], at[2] + eye[2]);
    add(new THREE.BoxGeometry(0.004, 2 * mouth[0], 2 * mouth[1]), dark, -0.004, 0, at[2] + mouth[2]);
    this.board.position.set(at[0], at[1], 0);
    this.scene.add(this.board);
    this.changed = true;
  }

  // The board is like glass while it stands between the camera and the robot.
  clear() {
    if (!this.board || !this.base) return;
    const eye = new THREE.Vector2(this.camera.position.x, this.camera.position.y);
    const way = new THREE.Vector2(this.base[0], this.base[1]).sub(eye);
    const there = new THREE.Vector2(this.board.position.x, this.board.position.y).sub(eye);
    const share = there.dot(way) / Math.max(way.lengthSq(), 1e-6);
    const beside = there.sub(way.clone().multiplyScalar(share)).length();
    const hides = share > -0.2 && share < 0.9 && beside < BROAD + (1 - share) * BROAD;
    for (const { material } of this.board.children) {
      material.opacity = hides ? 0.15 : 1;
      material.transparent = hides;
      material.depthWrite = !hides;
    }
  }

  // Nothing is drawn while nothing changes.
  render() {
    this.controls.update();
    if (!this.changed) return;
    this.changed = false;
    this.clear();
    this.renderer.render(this.scene, this.camera);
    this.ease(performance.now());
  }

  // Without a graphics card the robot needs the processor more than its picture does.
  ease(now) {
    this.slow = this.rendered && now - this.rendered > SLOW ? (this.slow ?? 0) + 1 : 0;
    this.rendered = now;
    if (this.slow < FRAMES || this.simpler) return;
    this.simpler = true;
    this.sun.shadow.mapSize.set(512, 512);
    this.sun.shadow.map?.dispose();
    this.sun.shadow.map = null;
    this.resize();
  }
}
