// A robot from its URDF: boxes, cylinders and spheres; ours has no other shapes. Lengths in metres, z up.
import * as THREE from "three";

const numbers = (text, fallback) => (text ?? fallback).trim().split(/\s+/).map(Number);

function place(object, origin) {
  object.position.set(...numbers(origin?.getAttribute("xyz"), "0 0 0"));
  const [roll, pitch, yaw] = numbers(origin?.getAttribute("rpy"), "0 0 0");
  object.rotation.set(roll, pitch, yaw, "ZYX"); // URDF: about the fixed axes x, y, z
}

function shape(geometry) {
  const form = geometry?.firstElementChild;
  switch (form?.tagName) {
    case "box":
      return new THREE.BoxGeometry(...numbers(form.getAttribute("size")));
    case "sphere":
      return new THREE.SphereGeometry(Number(form.getAttribute("radius")), 24, 16);
    case "cylinder": {
      const [radius, length] = ["radius", "length"].map((name) => Number(form.getAttribute(name)));
      return new THREE.CylinderGeometry(radius, radius, length, 24).rotateX(Math.PI / 2); // three.js has them along y
    }
    default:
      return null;
  }
}

export class Robot extends THREE.Group {
  constructor(urdf) {
    super();
    const document = new DOMParser().parseFromString(urdf, "text/xml");
    const robot = document.documentElement;
    const materials = new Map();
    for (const element of robot.querySelectorAll("material[name]")) {
      const color = element.querySelector("color")?.getAttribute("rgba");
      if (color) materials.set(element.getAttribute("name"), numbers(color));
    }
    this.joints = new Map();
    const links = new Map();
    for (const element of robot.querySelectorAll(":scope > link")) {
      const link = new THREE.Group();
      for (const visual of element.querySelectorAll(":scope > visual")) {
        const geometry = shape(visual.querySelector("geometry"));
        if (!geometry) continue;
        const named = visual.querySelector("material")?.getAttribute("name");
        const [r, g, b] = materials.get(named) ?? [0.75, 0.77, 0.8];
        const color = new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace);
        const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color, roughness: 0.6 }));
        mesh.castShadow = true;
        place(mesh, visual.querySelector("origin"));
        link.add(mesh);
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
      this.joints.set(element.getAttribute("name"), { link: links.get(child), axis });
    }
    for (const root of roots) this.add(links.get(root));
  }

  pose(angles) {
    for (const [name, angle] of Object.entries(angles)) {
      const joint = this.joints.get(name);
      joint?.link.quaternion.setFromAxisAngle(joint.axis, angle);
    }
  }
}
