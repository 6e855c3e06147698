/** A connection to bridge.py: topics, services and actions, whose bytes the generated modules write and read. */

interface Message<M> {
  readonly typeName: string;
  encode(message: M): Uint8Array;
  decode(payload: Uint8Array): M;
}
interface Service<Q, R> {
  readonly typeName: string;
  readonly Request: Message<Q>;
  readonly Response: Message<R>;
}
interface Action<G, R, F> {
  readonly typeName: string;
  readonly Goal: Message<G>;
  readonly Result: Message<R>;
  readonly Feedback: Message<F>;
}
interface Head {
  op: string;
  id: number;
  name?: string;
  type?: string;
  message?: string;
  status?: string;
}
type Listener = (head: Head, payload: Uint8Array) => void;

export class Connection {
  private readonly socket: WebSocket;
  private readonly listeners = new Map<number, Listener>();
  private last = 0;

  private constructor(socket: WebSocket, closed: (reason: string) => void) {
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => {
      for (const listener of this.listeners.values()) {
        listener({ op: "error", id: 0, message: "the connection is closed" }, new Uint8Array());
      }
      closed(event.reason || "the bridge is gone");
    };
  }

  static open(url: string, closed: (reason: string) => void = () => {}): Promise<Connection> {
    return new Promise((resolve, reject) => {
      const socket = new WebSocket(url);
      const connection = new Connection(socket, (reason) => {
        reject(new Error(reason));
        closed(reason);
      });
      socket.onopen = () => resolve(connection);
    });
  }

  subscribe<M>(name: string, type: Message<M>, callback: (message: M) => void): void {
    this.send("subscribe", name, type, undefined, (head, payload) => {
      if (head.op === "message") callback(type.decode(payload));
      else console.error(`${name}: ${head.message}`);
    });
  }

  publish<M>(name: string, type: Message<M>, message: M): void {
    this.send("publish", name, type, type.encode(message));
  }

  call<Q, R>(name: string, type: Service<Q, R>, request: Q): Promise<R> {
    return new Promise((resolve, reject) => {
      const id = this.send("call", name, type, type.Request.encode(request), (head, payload) => {
        this.listeners.delete(id);
        if (head.op === "result") resolve(type.Response.decode(payload));
        else reject(new Error(head.message));
      });
    });
  }

  /** Send a goal. `cancel` asks the server to stop, which is then a result too. */
  goal<G, R, F>(name: string, type: Action<G, R, F>, goal: G, feedback: (feedback: F) => void) {
    let id = 0;
    const result = new Promise<{ status: string; result: R }>((resolve, reject) => {
      id = this.send("goal", name, type, type.Goal.encode(goal), (head, payload) => {
        if (head.op === "feedback") return feedback(type.Feedback.decode(payload));
        this.listeners.delete(id);
        if (head.op === "result") resolve({ status: head.status ?? "", result: type.Result.decode(payload) });
        else reject(new Error(head.message));
      });
    });
    return { result, cancel: () => this.write({ op: "cancel", id, name, type: type.typeName }) };
  }

  close(): void {
    this.listeners.clear();
    this.socket.close();
  }

  private send(
    op: string, name: string, type: { typeName: string }, payload?: Uint8Array, listener?: Listener,
  ): number {
    const id = ++this.last;
    if (listener) this.listeners.set(id, listener);
    this.write({ op, id, name, type: type.typeName }, payload);
    return id;
  }

  private write(head: Head, payload: Uint8Array = new Uint8Array()): void {
    const text = new TextEncoder().encode(JSON.stringify(head));
    const frame = new Uint8Array(4 + text.length + payload.length);
    new DataView(frame.buffer).setUint32(0, text.length, true);
    frame.set(text, 4);
    frame.set(payload, 4 + text.length);
    this.socket.send(frame);
  }

  private receive(frame: ArrayBuffer): void {
    const end = 4 + new DataView(frame).getUint32(0, true);
    const head: Head = JSON.parse(new TextDecoder().decode(new Uint8Array(frame, 4, end - 4)));
    const listener = this.listeners.get(head.id);
    if (listener) listener(head, new Uint8Array(frame, end));
    else if (head.op === "error") console.error(head.message);
  }
}
