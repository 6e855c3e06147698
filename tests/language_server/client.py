"""A client of the language server: an editor without a screen, over the pipes of a process."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from queue import Queue
from typing import Any

PULLS: dict[str, Any] = {"textDocument": {"diagnostic": {}}, "general": {"positionEncodings": ["utf-8"]}}
PUSHED: dict[str, Any] = {}
LIMIT = 60.0


@dataclass
class Client:
    """An editor, which speaks the Language Server Protocol."""

    process: subprocess.Popen[bytes]
    root: Path
    published: dict[str, list[dict[str, Any]]] = field(default_factory=dict[str, list[dict[str, Any]]])
    asked: list[dict[str, Any]] = field(default_factory=list[dict[str, Any]])
    _answers: Queue[dict[str, Any]] = field(default_factory=Queue[dict[str, Any]])
    _number: int = 0

    def uri(self, name: str) -> str:
        return (self.root / name).as_uri()

    def notify(self, method: str, **params: Any) -> None:
        self._send({"method": method, "params": params})

    def request(self, method: str, **params: Any) -> Any:
        """The result of a request. Raises RuntimeError with the message of an error."""
        self._number += 1
        self._send({"id": self._number, "method": method, "params": params})
        answer = self._answers.get(timeout=LIMIT)
        assert answer["id"] == self._number
        if "error" in answer:
            raise RuntimeError(answer["error"]["message"])
        return answer["result"]

    def open(self, name: str, text: str | None = None) -> None:
        """Open a file, with another text than its own perhaps."""
        path = self.root / name
        document = {"uri": path.as_uri(), "languageId": "rosmsg", "version": 1}
        document["text"] = path.read_bytes().decode() if text is None else text
        self.notify("textDocument/didOpen", textDocument=document)

    def change(self, name: str, text: str) -> None:
        self.notify(
            "textDocument/didChange",
            textDocument={"uri": self.uri(name), "version": 2},
            contentChanges=[{"text": text}],
        )

    def at(self, name: str, line: int, character: int, **more: Any) -> dict[str, Any]:
        """The parameters of a request about a place."""
        return {
            "textDocument": {"uri": self.uri(name)},
            "position": {"line": line, "character": character},
            **more,
        }

    def pull(self, name: str) -> list[dict[str, Any]]:
        """The diagnostics of a document."""
        return self.request("textDocument/diagnostic", textDocument={"uri": self.uri(name)})["items"]

    def read(self) -> None:
        """Read what the server sends until it ends."""
        stream = self.process.stdout
        assert stream is not None
        while header := stream.readline():
            length = 0
            while header.strip():
                name, _, value = header.partition(b":")
                if name.lower() == b"content-length":
                    length = int(value)
                header = stream.readline()
            self._take(json.loads(stream.read(length)))

    def _take(self, message: dict[str, Any]) -> None:
        if "method" not in message:
            self._answers.put(message)
        elif message["method"] == "textDocument/publishDiagnostics":
            self.published[message["params"]["uri"]] = message["params"]["diagnostics"]
        else:
            self.asked.append(message)
            if "id" in message:
                result = {"applied": True} if message["method"] == "workspace/applyEdit" else None
                self._send({"id": message["id"], "result": result})

    def _send(self, message: dict[str, Any]) -> None:
        data = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(data), data))
        self.process.stdin.flush()


@contextmanager
def editing(root: Path, capabilities: dict[str, Any] | None = None) -> Generator[Client]:
    """An editor in a folder. The server must end by itself, and not complain."""
    command = [sys.executable, "-m", "ifgen", "lsp"]
    with subprocess.Popen(
        command, cwd=root, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        client = Client(process, root)
        reader = threading.Thread(target=client.read, daemon=True)
        reader.start()
        try:
            folders = [{"uri": root.as_uri(), "name": root.name}]
            client.request(
                "initialize",
                processId=None,
                rootUri=root.as_uri(),
                workspaceFolders=folders,
                capabilities=PULLS if capabilities is None else capabilities,
            )
            client.notify("initialized")
            yield client
            client.request("shutdown")
            client.notify("exit")
            _, errors = process.communicate(timeout=LIMIT)
            assert b"Traceback" not in errors, errors.decode()
        finally:
            process.kill()
