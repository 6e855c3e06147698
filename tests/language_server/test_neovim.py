"""The language server in a real editor: Neovim without a screen, configured as docs/editors.md says."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("pygls")
NVIM = shutil.which("nvim", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(120),
    pytest.mark.skipif(NVIM is None, reason="Neovim is not installed"),
]
PAGE = Path(__file__).parents[2] / "docs/editors.md"

SCRIPT = """
local found = {}
local function ask(method, line, character)
  local params = {
    textDocument = vim.lsp.util.make_text_document_params(),
    position = { line = line, character = character },
    newName = "Stance",
  }
  for _, answer in pairs(vim.lsp.buf_request_sync(0, method, params, 20000) or {}) do
    return answer.result
  end
end
vim.cmd.edit("demo_msgs/msg/Pair.msg")
vim.wait(60000, function() return #vim.diagnostic.get(0) > 0 end, 20)
found.before = vim.diagnostic.get(0)
vim.api.nvim_buf_set_lines(0, 0, -1, false, { "Pose first", "Pose   second" })
vim.wait(60000, function() return #vim.diagnostic.get(0) == 0 end, 20)
found.after = #vim.diagnostic.get(0)
found.hover = ask("textDocument/hover", 0, 1).contents.value
vim.lsp.buf.format({ timeout_ms = 20000 })
found.formatted = vim.api.nvim_buf_get_lines(0, 0, -1, false)
vim.lsp.util.apply_workspace_edit(ask("textDocument/rename", 0, 1), "utf-8")
found.renamed = vim.api.nvim_buf_get_lines(0, 0, -1, false)
found.moved = vim.fn.filereadable("demo_msgs/msg/Stance.msg")
local file = assert(io.open("found.json", "w"))
file:write(vim.json.encode(found))
file:close()
vim.cmd("qa!")
"""


def test_in_neovim(tmp_path: Path) -> None:
    for name, text in {"Pose": "float64 x\n", "Pair": "Poze first\nPose second\n"}.items():
        path = tmp_path / f"demo_msgs/msg/{name}.msg"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["."]\n')
    shown = PAGE.read_text().partition("```lua\n")[2].partition("```")[0]
    (tmp_path / "init.lua").write_text(shown)
    (tmp_path / "script.lua").write_text(SCRIPT)
    assert NVIM is not None
    environment = os.environ | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        **{f"XDG_{kind}_HOME": str(tmp_path / ".editor") for kind in ("CACHE", "CONFIG", "DATA", "STATE")},
    }
    done = subprocess.run(
        [NVIM, "--headless", "-u", "init.lua", "-c", "luafile script.lua"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert (tmp_path / "found.json").exists(), done.stderr + done.stdout
    found = json.loads((tmp_path / "found.json").read_text())
    assert [each["code"] for each in found["before"]] == ["unknown-type"], "each finding once"
    assert found["after"] == 0
    assert found["hover"].startswith("**demo_msgs/msg/Pose** (message)")
    assert found["formatted"] == ["Pose first", "Pose second"]
    assert (found["renamed"], found["moved"]) == (["Stance first", "Stance second"], 1)
