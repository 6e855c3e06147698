// The page: what the server sends, to whom it concerns.
import { Graph } from "/graph.js";
import { Driver, Pointer } from "/hands.js";
import { Panel } from "/panel.js";
import { Scene } from "/scene.js";

const element = (id) => document.getElementById(id);
const panel = new Panel();
const graph = new Graph(element("nodes"), element("big"));
const scene = new Scene(element("robot"));
new Pointer(scene);
new Driver();

const channels = {
  setup: (value) => {
    panel.setup(value);
    scene.stand(value.board);
  },
  time: (value) => panel.text("time", `${value.toFixed(1)} s`),
  factor: (value) => panel.text("factor", value === null ? "paused" : `${value.toFixed(2)}×`),
  battery: ({ charge, level }) => panel.text("battery", `${Math.round(charge * 100)} %${level === "normal" ? "" : ` ${level}`}`),
  gait: (value) => {
    panel.gait(value);
    scene.taken(value.next);
  },
  stop: (value) => panel.stop(value),
  run: (value) => panel.run(value),
  task: (value) => panel.job(value),
  walk: (value) => panel.goal("walk", value),
  "walk feedback": (value) => panel.goal("walk", value),
  dance: (value) => panel.goal("dance", value),
  "dance feedback": (value) => panel.goal("dance", value),
  log: (value) => panel.log(value),
  topics: (value) => panel.topics(value),
  graph: (value) => graph.show(value),
  picture: (value) => panel.picture(value),
  found: (value) => panel.found(value),
  robot: (urdf) => scene.load(urdf),
  joints: (angles) => scene.pose(angles),
  base: (pose) => scene.move(pose),
  footsteps: (value) => scene.walk(value),
  balance: (value) => {
    element("legend").hidden = false;
    scene.balance(value);
  },
  path: (points) => scene.way(points),
  map: (value) => scene.occupancy(value),
  obstacles: (list) => scene.things(list),
};

const news = new EventSource("/news");
news.onopen = () => panel.connected(true);
news.onerror = () => panel.connected(false);
for (const [channel, show] of Object.entries(channels)) {
  news.addEventListener(channel, ({ data }) => show(JSON.parse(data)));
}
