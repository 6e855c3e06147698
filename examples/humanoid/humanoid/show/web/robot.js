// A robot from its URDF: boxes, cylinders, spheres and capsules. Lengths in metres, z up.
import * as THREE from "three";

const numbers = (text, fallback) => (text ?? fallback).trim().split(/\s+/).map(Number);

function place(object, origin) {
  object.position.set(...numbers(origin?.getAttribute("xyz"), "0 0 0"));
  const [roll, pitch, yaw] = numbers(origin?.getAttribute("rpy"), "0 0 0");
  object.rotation.set(roll, pitch, yaw, "ZYX"); // URDF: about the fixed axes x, y, z
}

// three.js has cylinders and capsules along y.
function shape(geometry) {
  const form = geometry?.firstElementChild;
  const [radius, length] = ["radius", "length"].map((name) => Number(form?.getAttribute(name)));
  switch (form?.tagName) {
    case "box":
      return new THREE.BoxGeometry(...numbers(form.getAttribute("size")));
    case "sphere":
      return new THREE.SphereGeometry(radius, 32, 20);
    case "cylinder":
      return new THREE.CylinderGeometry(radius, radius, length, 32).rotateX(Math.PI / 2);
    case "capsule":
      return new THREE.CapsuleGeometry(radius, length, 12, 32).rotateX(Math.PI / 2);
    default:
      return null;
  }
}

function colors(robot) {
  const found = new Map();
  for (const element of robot.querySelectorAll("material[name]")) {
    const color = element.querySelector("color")?.getAttribute("rgba");
    if (color) found.set(element.getAttribute("name"), numbers(color));
  }
  return found;
}

function mesh(visual, materials) {
  const geometry = shape(visual.querySelector("geometry"));
  if (!geometry) return null;
  const material = visual.querySelector("material");
  const own = material?.querySelector("color")?.getAttribute("rgba");
  const [r, g, b] = own ? numbers(own) : (materials.get(material?.getAttribute("name")) ?? [0.75, 0.77, 0.8]);
  const color = new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace);
  const made = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color, roughness: 0.55, metalness: 0.1 }));
  made.castShadow = made.receiveShadow = true;
  place(made, visual.querySelector("origin"));
  return made;
}

export class Robot extends THREE.Group {
  constructor(urdf) {
    super();
    const robot = new DOMParser().parseFromString(urdf, "text/xml").documentElement;
    const materials = colors(robot);
    this.joints = new Map();
    const links = new Map();
    for (const element of robot.querySelectorAll(":scope > link")) {
      const link = new THREE.Group();
      for (const visual of element.querySelectorAll(":scope > visual")) {
        const part = mesh(visual, materials);
        if (part) link.add(part);
      }
      links.set(element.getAttribute("name"), link);
    }
    const roots = new Set(links.keys());
    for (const element of robot.querySelectorAll(":scope > joint")) {
      const child = element.querySelector("child").getAttribute("link");
      const fixed = new THREE.Group();
      place(fixed, element.querySelector("origin"));
      fixed.add(links.get(child));
      links.get(element.querySelector("parent").getAttribute("link")).add(fixed);
      roots.delete(child);
      const axis = new THREE.Vector3(...numbers(element.querySelector("axis")?.getAttribute("xyz"), "1 0 0"));
      const slides = element.getAttribute("type") === "prismatic";
      this.joints.set(element.getAttribute("name"), { link: links.get(child), axis, slides });
    }
    for (const root of roots) this.add(links.get(root));
  }

  // Positions by joint, in radians or metres.
  pose(angles) {
    for (const [name, angle] of Object.entries(angles)) {
      const joint = this.joints.get(name);
      if (joint?.slides) joint.link.position.copy(joint.axis).multiplyScalar(angle);
      else joint?.link.quaternion.setFromAxisAngle(joint.axis, angle);
    }
  }

  // [x, y, z, qx, qy, qz, qw] of its root.
  move([x, y, z, ...orientation]) {
    this.position.set(x, y, z);
    this.quaternion.set(...orientation);
  }
}
