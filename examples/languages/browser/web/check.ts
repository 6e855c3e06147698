/** The same exchange without a page: node web/check.js [ws://127.0.0.1:8765] */
import { Connection } from "./connection.js";
import { Twist } from "./ros/geometry_msgs/msg/Twist.js";
import { Drive } from "./ros/rover_msgs/action/Drive.js";
import { State } from "./ros/rover_msgs/msg/State.js";
import { Place } from "./ros/rover_msgs/srv/Place.js";

declare const process: { argv: string[] };

const ros = await Connection.open(process.argv[2] ?? "ws://127.0.0.1:8765");
let latest = State.create();
const waiting: (() => void)[] = [];
ros.subscribe("state", State, (state) => {
  latest = state;
  for (const look of waiting.splice(0)) look();
});
const until = async (holds: (state: State) => boolean): Promise<void> => {
  while (!holds(latest)) await new Promise<void>((resolve) => waiting.push(resolve));
};

const placed = await ros.call("place", Place, { x: 1, y: -2, heading: 0 });
console.log("service:", placed.success, placed.message);
await until((state) => state.x === 1 && state.y === -2);
console.log("topic from Python:", typeof latest.count, latest.trail.constructor.name, latest.trail.length);

const nowhere = await ros.call("place", Place, { x: NaN, y: 0, heading: 0 });
console.log("service:", nowhere.success, nowhere.message);

const command = Twist.create();
command.linear.x = 1;
while (latest.mode !== State.MODE_DRIVING) {
  ros.publish("cmd_vel", Twist, command);
  const before = latest.count;
  await until((state) => state.count > before);
}
console.log("topic to Python:", latest.speed.linear.x, latest.x > 1);

const left: number[] = [];
const driven = await ros.goal("drive", Drive, { distance: 0.2 }, (feedback) => left.push(feedback.remaining)).result;
console.log("action:", driven.status, driven.result.driven.toFixed(3), left.map((each) => each.toFixed(2)).join(" "));

const endless = ros.goal("drive", Drive, { distance: 1000 }, () => endless.cancel());
console.log("cancelled:", (await endless.result).status);

await ros.call("plaice", { ...Place, typeName: "rover_msgs/srv/Plaice" }, { x: 0, y: 0, heading: 0 }).catch((error) => console.log("error:", error.message));
ros.close();
