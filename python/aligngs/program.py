"""The program aligngs as a child process."""
from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Optional, Union

from .errors import ProgramMissingError, error_of
from .results import Run

_PAUSE = 0.2  # seconds between two looks at the events

Folder = Union[str, Path]
Event = Dict[str, Any]


def find_program(program: Optional[Folder] = None) -> str:
    """`program`, else the environment's ALIGNGS, else `aligngs` in PATH. ProgramMissingError without one."""
    wanted = str(program or os.environ.get("ALIGNGS") or "aligngs")
    found = shutil.which(wanted)
    if found is None:
        raise ProgramMissingError(f"there is no program {wanted}", remedy="install it, put it into PATH, or name it in the variable ALIGNGS")
    return found


def follow_events(folder: Folder, ended: Callable[[], bool], begin: int = 0) -> Iterator[Event]:
    """The events of a run (events.ndjson) as they appear, until `ended()` holds and all are read. A line that is half-written waits.
    `begin` is the number of bytes that are left out. A file that became shorter is read from its start."""
    path, offset = Path(folder) / "events.ndjson", begin
    while True:
        last = ended()
        data = b""
        if path.exists():
            size = path.stat().st_size
            offset = offset if size >= offset else 0  # a new run, or a resumed one that has cut steps away
            with path.open("rb") as file:
                file.seek(offset)
                data = file.read()
        whole = data.rfind(b"\n") + 1
        offset += whole
        for line in data[:whole].splitlines():
            try:
                event = json.loads(line)
            except ValueError:
                continue
            if isinstance(event, dict):
                yield event
        if last:
            return
        time.sleep(_PAUSE)


def run(source: Folder, output: Folder, *options: str, resume: bool = False, overwrite: bool = False,
        on_event: Optional[Callable[[Event], None]] = None, program: Optional[Folder] = None) -> Run:
    """`aligngs run SOURCE -o OUTPUT OPTIONS`. Calls `on_event` with each event of the training while it goes on. Raises a class of
    AlignGSError by the exit status. KeyboardInterrupt stops the program, which writes its checkpoint first."""
    return _work(["run", str(source)], output, options, resume, overwrite, on_event, program)


def demo(output: Folder, *options: str, resume: bool = False, overwrite: bool = False,
         on_event: Optional[Callable[[Event], None]] = None, program: Optional[Folder] = None) -> Run:
    """`aligngs demo -o OUTPUT OPTIONS`: a synthetic room. Otherwise as `run`."""
    return _work(["demo"], output, options, resume, overwrite, on_event, program)


def _work(command: List[str], output: Folder, options: Any, resume: bool, overwrite: bool, on_event: Optional[Callable[[Event], None]],
          program: Optional[Folder]) -> Run:
    words = [find_program(program), *command, "-o", str(output), "--json", *map(str, options)]
    words += ["--resume"] * resume + ["--overwrite"] * overwrite
    events = Path(output) / "events.ndjson"
    begin = events.stat().st_size if events.exists() else 0
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as log:
        child = subprocess.Popen(words, stdout=out, stderr=log, stdin=subprocess.DEVNULL)
        try:
            for event in follow_events(output, lambda: child.poll() is not None, begin):
                if on_event is not None:
                    on_event(event)
        finally:
            if child.poll() is None:
                child.terminate()  # it writes a checkpoint before it ends
                child.wait()
        if child.returncode != 0:
            out.seek(0)
            log.seek(0)
            status = child.returncode if child.returncode > 0 else 128 - child.returncode
            raise error_of(status, out.read().decode("utf-8", "replace"), log.read().decode("utf-8", "replace"))
    return Run(output)
