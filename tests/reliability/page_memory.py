#!/usr/bin/env python3
"""Memory of `aligngs view` after each kind of work, as a table. Usage: page_memory.py PROGRAM RUN [EDIT EDIT]. The run is
copied first. The peak of each row is its own: Linux forgets the peak before it (clear_refs, proc(5))."""
import argparse
import json
import os
import shutil
import tempfile

from page_soak import Server

KINDS = ["rgb", "depth", "label", "normal"]
EXPORTS = ["labels.ply", "ply", "splat", "spz", "sog", "html", "glb", "collision.glb", "obj", "usda", "usdz"]
FORGET_PEAK = "5"  # proc(5), clear_refs


def must(answer):
    if answer[0] != 200:
        raise SystemExit(f"the server answered with {answer[0]}: {answer[2][:200]}")
    return answer


def row(server, name, work):
    with open(f"/proc/{server.process.pid}/clear_refs", "w") as f:
        f.write(FORGET_PEAK)
    work()
    private, peak, _ = server.memory()
    print(f"| {name} | {private:.0f} | {peak:.0f} |", flush=True)


def measure(server, edits):
    state = json.loads(must(server.ask("/api/state"))[2])
    views = [c["img_name"] for c in state["cameras"]]
    push = lambda edit: must(server.ask("/api/edits/push", {"edit": edit}))
    start = lambda: must(server.ask("/api/start.jpg"))
    download = lambda: must(server.ask("/files/scene.ply"))
    pictures = lambda kinds: [must(server.ask(f"/api/render/{view}/{kind}.png")) for view in views for kind in kinds]
    print("| the server after | private MB | peak MB |\n|---|---|---|")
    row(server, "the scene, its start picture and a download of `scene.ply`", lambda: (start(), download()))
    row(server, "pictures of colour, depth, labels and normals", lambda: pictures(KINDS))
    row(server, "the list of objects, which opens the run for edits", lambda: must(server.ask("/api/edits")))
    row(server, "an edit and its start picture", lambda: (push(edits[0]), start()))
    row(server, "a second edit, a picture and the start picture", lambda: (push(edits[1]), pictures(KINDS[:1]), start()))
    for name in EXPORTS:
        row(server, f"with two edits, an export to `{name}`", lambda: must(server.ask("/api/export", {"format": name})))
    row(server, "undo of both edits", lambda: [must(server.ask("/api/edits/undo", {})) for _ in edits])
    row(server, "the same edits and exports four times more",
        lambda: [(push(edits[0]), push(edits[1]), [must(server.ask("/api/export", {"format": f})) for f in EXPORTS],
                  [must(server.ask("/api/edits/undo", {})) for _ in edits]) for _ in range(4)])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("run")
    parser.add_argument("edits", nargs="*", default=["delete pillow, cushion", "recolor bed #2040a0"])
    options = parser.parse_args()
    if len(options.edits) != 2:
        parser.error("give two edits or none")
    with tempfile.TemporaryDirectory() as folder:
        run = os.path.join(folder, "run")
        shutil.copytree(options.run, run, ignore=shutil.ignore_patterns("control"))
        server = Server(options.program, run)
        try:
            measure(server, options.edits)
        finally:
            server.process.terminate()
            server.process.wait()


if __name__ == "__main__":
    main()
