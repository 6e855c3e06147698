"""The language server in Emacs with eglot, which does not ask for findings, configured as docs/editors.md says."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("pygls")
EMACS = shutil.which("emacs")
PAGE = Path(__file__).parents[2] / "docs/editors.md"

SCRIPT = """
(require 'package)
(package-initialize)
(require 'eglot)
(require 'json)
{shown}
(setq eglot-sync-connect 30)
(defun wait-for (there)
  (let ((n 0))
    (while (and (< n 300) (not (funcall there)))
      (accept-process-output nil 0.1)
      (setq n (1+ n)))))
(find-file "demo_msgs/msg/Pair.msg")
(apply #'eglot (eglot--guess-contact))
(wait-for (lambda () (flymake-diagnostics)))
(let ((texts (mapcar #'flymake-diagnostic-text (flymake-diagnostics))))
  (erase-buffer)
  (insert "Pose   first\\n")
  (eglot--signal-textDocument/didChange)
  (eglot-format-buffer)
  (with-temp-file "found.json"
    (insert (json-encode `((before . ,(vconcat texts)) (text . ,(with-current-buffer "Pair.msg" (buffer-string))))))))
(set-buffer-modified-p nil)
(kill-emacs 0)
"""


@pytest.mark.slow
@pytest.mark.timeout(180)
@pytest.mark.skipif(EMACS is None, reason="Emacs is not installed")
def test_in_emacs(tmp_path: Path) -> None:
    for name, text in {"Pose": "float64 x\n", "Pair": "Poze first\n"}.items():
        path = tmp_path / f"demo_msgs/msg/{name}.msg"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (tmp_path / "pyproject.toml").write_text('[tool.ifgen]\npaths = ["."]\n')
    shown = PAGE.read_text().partition("```lisp\n")[2].partition("```")[0]
    (tmp_path / "script.el").write_text(SCRIPT.replace("{shown}", shown))
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)  # a project of Emacs
    environment = os.environ | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "HOME": str(tmp_path),
    }
    assert EMACS is not None
    done = subprocess.run(
        [EMACS, "--batch", "-l", "script.el"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=160,
        check=False,
    )
    assert (tmp_path / "demo_msgs/msg/found.json").exists(), done.stderr + done.stdout
    found = json.loads((tmp_path / "demo_msgs/msg/found.json").read_text())
    [text] = found["before"]
    assert "package 'demo_msgs' has no message 'Poze'" in text
    assert found["text"] == "Pose first\n"
