import { Connection } from "./connection.js";
import { Twist } from "./ros/geometry_msgs/msg/Twist.js";
import { Drive } from "./ros/rover_msgs/action/Drive.js";
import { State } from "./ros/rover_msgs/msg/State.js";
import { Place } from "./ros/rover_msgs/srv/Place.js";

const find = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const canvas = find<HTMLCanvasElement>("paper");
const pen = canvas.getContext("2d")!;
const SCALE = 60; // pixels for a metre

function draw(state: State): void {
  const { width, height } = canvas;
  pen.clearRect(0, 0, width, height);
  pen.strokeStyle = "#8884";
  for (let at = (width / 2) % SCALE; at < width; at += SCALE) pen.strokeRect(at, -1, 0, height + 2);
  for (let at = (height / 2) % SCALE; at < height; at += SCALE) pen.strokeRect(-1, at, width + 2, 0);
  pen.save();
  pen.translate(width / 2, height / 2);
  pen.scale(SCALE, -SCALE);
  pen.lineWidth = 0.04;
  pen.strokeStyle = "#e80";
  pen.beginPath();
  for (let i = 0; i < state.trail.length; i += 2) pen.lineTo(state.trail[i]!, state.trail[i + 1]!);
  pen.stroke();
  pen.translate(state.x, state.y);
  pen.rotate(state.heading);
  pen.fillStyle = state.mode === State.MODE_DRIVING ? "#080" : "#06c";
  pen.beginPath();
  for (const [x, y] of [[0.3, 0], [-0.2, 0.18], [-0.1, 0], [-0.2, -0.18]] as const) pen.lineTo(x, y);
  pen.fill();
  pen.restore();
  const mode = state.mode === State.MODE_DRIVING ? "driving" : "idle";
  find("state").textContent =
    `${mode} at ${state.x.toFixed(2)} m, ${state.y.toFixed(2)} m (state ${state.count})`;
}

const say = (text: string): void => void (find("said").textContent = text);
const failed = (error: unknown): void => say(String(error));
const ros = await Connection.open(`ws://${location.host}/`, say);
ros.subscribe("state", State, draw);

// Commands, as long as a button is held.
const directions = { left: [0, 1.5], ahead: [0.8, 0], right: [0, -1.5] } as const;
for (const [id, [linear, angular]] of Object.entries(directions)) {
  let timer: number | undefined;
  const command = Twist.create();
  command.linear.x = linear;
  command.angular.z = angular;
  const stop = (): void => clearInterval(timer);
  find(id).onpointerdown = () => {
    stop();
    ros.publish("cmd_vel", Twist, command);
    timer = setInterval(() => ros.publish("cmd_vel", Twist, command), 100);
  };
  find(id).onpointerup = find(id).onpointerleave = stop;
}

find("place").onclick = () => {
  ros.call("place", Place, { x: 0, y: 0, heading: 0 }).then((response) => say(response.message), failed);
};

find("drive").onclick = async () => {
  const bar = find<HTMLProgressElement>("progress");
  const goal = ros.goal("drive", Drive, { distance: 2 }, (feedback) => (bar.value = 2 - feedback.remaining));
  find("cancel").onclick = goal.cancel;
  try {
    const { status, result } = await goal.result;
    say(`${status} after ${result.driven.toFixed(2)} m`);
  } catch (error) {
    failed(error);
  }
};
