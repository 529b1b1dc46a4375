"""The commands of the program that the series disturb: how each is called, what it writes, and a folder that it can be called in."""
import base64
import gzip
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import urllib.request
from pathlib import Path

PROGRAM = os.environ.get("ALIGNGS", str(Path(__file__).resolve().parents[2] / "build" / "aligngs"))
# Figures of a run that depend on the clock, and names of folders. Checkpoints hold the seconds spent.
CLOCKED = ("seconds", "time", "wall", "peak", "memory", "_ms", "per_second", "date", "created", "folder", "command", "resumed", "rate", "host", "pid")
NOT_COMPARED = ("events.ndjson", "model.safetensors.json", "report.html", "run.json", "train.log", "control", "checkpoints", "results.html", "results.json", "logs", "records", "leases")


PREPARED = [None]  # the folder that prepare() has made


class Command:
    """A command in a folder that `prepare` has made. `again`: what the message of the second call names when the first one has left
    something; tried then. `once`: a second call does the work once more, so that it is left out where the first has done it."""

    def __init__(self, name, arguments, outputs, again=None, needs_weights=False, once=False):
        self.name, self.arguments, self.outputs = name, arguments, outputs
        self.again, self.needs_weights, self.once = again, needs_weights, once
        self.writes = 0  # bytes of the outputs


def export(form, file, *options):
    return Command(f"export {form}" + "".join(" " + o for o in options if not o.isdigit()), ["export", "run", "-f", form, "-o", file, *options], [file])


def edit(name, *options):
    outputs = ["run/edits.json", "run/edits", "run/selections.json"]
    return Command(f"edit {name}", ["edit", "run", *options], outputs, once=name in ("move", "duplicate", "replace", "recolor"))


SMALL = ["--size", "160x120", "--views", "8", "--test-views", "2"]
VOXEL = ["--set", "mesh.voxel=0.05"]
NO_NETWORK = ["--semantics", "none", "--depth", "none"]
COMMANDS = [
    Command("synth", ["synth", "made", *SMALL], ["made"], "--overwrite"),
    Command("synth without", ["synth", "made", *SMALL, "--without", "bed#1"], ["made"], "--overwrite"),
    Command("data simulate", ["data", "simulate", "room", "-o", "made"], ["made"], "--overwrite"),
    Command("import", ["import", "colmap", "-o", "made"], ["made"], "--overwrite"),
    Command("import transforms", ["import", "nerf", "-o", "made"], ["made"], "--overwrite"),
    Command("poses", ["poses", "colmap/images", "--method", "given", "-o", "made"], ["made"], "--overwrite"),
    Command("refine", ["refine", "room", "-o", "made"], ["made"], "--overwrite"),
    Command("train", ["train", "room", "-o", "made", "-n", "60", "--set", "checkpoint.every=20"], ["made"], "--resume"),
    Command("train raw", ["train", "colmap", "-o", "made", "-n", "40"], ["made"], "--resume"),
    Command("run", ["run", "room", "-o", "made", "-n", "40", "--no-refine", *VOXEL], ["made"], "--resume"),
    Command("run refine", ["run", "room", "-o", "made", "-n", "30", "--refine", *VOXEL], ["made"], "--resume"),
    Command("run given", ["run", "colmap/images", "--method", "given", "-o", "made", "-n", "30", *NO_NETWORK, *VOXEL], ["made"], "--resume"),
    Command("batch", ["batch", "rooms.tsv", "-o", "made"], ["made"], "batch retry"),
    Command("batch collect", ["batch", "collect", "rooms"], ["rooms/results.csv"]),
    Command("mesh", ["mesh", "run", "-o", "mesh_made.ply"], ["mesh_made.ply"]),
    Command("mesh in place", ["mesh", "run", *VOXEL], ["run/mesh"]),
    Command("eval", ["eval", "run"], ["run/metrics.json"]),
    Command("render", ["render", "run", "--split", "train"], ["run/renders/train"]),
    Command("render path", ["render", "run", "--path", "orbit", "--size", "160x90", "--seconds", "1", "-o", "made.mp4"], ["made.mp4"]),
    Command("render path pictures", ["render", "run", "--path", "walk", "--size", "160x90", "--seconds", "1", "-o", "made"], ["made"]),
    Command("render view", ["render", "run", "--view", "view_003", "--size", "640x480", "-o", "made.png"], ["made.png"]),
    export("ply", "made.ply"),
    export("labels.ply", "made.labels.ply"),
    export("glb", "made.glb"),
    export("glb", "made.glb", "--textured", "--texture-size", "1024"),
    export("collision.glb", "made.collision.glb"),
    export("obj", "made.obj"),
    Command("export obj textured", ["export", "run", "-f", "obj", "-o", "objects/made.obj", "--textured"], ["objects"]),
    export("sog", "made.sog"),
    export("spz", "made.spz"),
    export("splat", "made.splat"),
    Command("export usda", ["export", "run", "-f", "usda", "-o", "usd/made.usda"], ["usd"]),
    export("usdz", "made.usdz"),
    export("html", "made.html"),
    export("plan.svg", "made.plan.svg"),
    export("plan.dxf", "made.plan.dxf"),
    export("plan.pdf", "made.plan.pdf"),
    edit("delete", "--select", "bed", "--delete"),
    edit("fill", "--select", "bed", "--delete", "--fill"),
    edit("move", "--select", "bed", "--move", "0.3,0,0"),
    edit("duplicate", "--select", "armchair", "--duplicate"),
    edit("replace", "--select", "armchair", "--replace", "other#bed#1", "--fit"),
    edit("recolor", "--say", "recolor bed dark green"),
    edit("undo", "--undo"),
    edit("rename", "--rename-selection", "my corner", "reading corner"),
    edit("by hand", "--select", "my corner", "--delete", "--fill"),
    Command("edit out", ["edit", "run", "--select", "bed", "--extract", "-o", "made"], ["made"]),
    Command("edit picture", ["edit", "run", "--select", "bed", "--delete", "--dry-run", "--picture", "made.png"], ["made.png"]),
    Command("room", ["room", "run"], ["run/room.json"]),
    Command("scale", ["scale", "run", "--between", "0,0,0", "0.5,0,0", "0.9"], ["run/room.json"]),
    Command("report", ["report", "run"], ["run/overview.jpg"]),
    Command("compare", ["compare", "run", "run", "--html", "made.html", "--csv", "made.csv"], ["made.html", "made.csv"]),
    Command("manual", ["manual", "made"], ["made"]),
    Command("poses da3", ["poses", "room/images", "--method", "da3", "--poses-model", "da3-small", "--metres", "none", "-o", "made"], ["made"], "--overwrite", needs_weights=True),
    Command("priors", ["priors", "plain", "-o", "made", "--semantics", "linear-s", "--depth", "none"], ["made"], "--overwrite", needs_weights=True),
    Command("models import", ["models", "import", "da3-small", "PREPARED/models/da3-small/model.safetensors"], ["imported"], needs_weights=True),
]


def without_clock(value):
    if isinstance(value, dict):
        return {k: without_clock(v) for k, v in value.items() if not any(word in k for word in CLOCKED)}
    return [without_clock(v) for v in value] if isinstance(value, list) else value


def digest(path):
    """Digest of the files below, by name; JSON without the parts that depend on the clock."""
    found = {}
    files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file()) if path.exists() else []
    for file in files:
        name = str(file.relative_to(path)) if file != path else ""
        if any(part in NOT_COMPARED for part in file.parts[len(path.parts):]) or file.name == "results.csv" or ".tmp-" in file.name:
            continue
        data = file.read_bytes()
        if file.suffix == ".json":
            try:
                data = json.dumps(without_clock(json.loads(data)), sort_keys=True).replace(str(path.parent), "").encode()
            except ValueError:
                pass
        found[name] = hashlib.sha256(data).hexdigest()
    return found


def state(folder, command):
    return {output: digest(folder / output) for output in command.outputs}


def temporary_files(folder):
    return [str(p.relative_to(folder)) for p in folder.rglob("*") if ".tmp-" in p.name or ".work-" in p.name]


def start(folder, arguments, quiet=True):
    models = "imported" if arguments[0] == "models" else "models"
    environment = {**os.environ, "ALIGNGS_MODELS": str(folder / models), "HF_HOME": str(folder / "no"), "TORCH_HOME": str(folder / "no")}
    # Weights lie outside of the disturbed folder: on one file system they would be linked, and write nothing.
    arguments = [argument.replace("PREPARED", str(PREPARED[0])) for argument in arguments]
    return subprocess.Popen([PROGRAM, *arguments, *(["-q"] if quiet else [])], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                            env=environment)


def call(folder, arguments):
    process = start(folder, arguments)
    message = process.communicate()[1]
    return process.returncode, message


def fresh(prepared, folder):
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(prepared, folder, symlinks=True)


def draw_selection(folder):
    """Keeps a selection as the page does: the first splats of the run, by its server."""
    opened = urllib.request.build_opener(urllib.request.ProxyHandler({})).open  # never a proxy of the environment
    server = subprocess.Popen([PROGRAM, "view", "run", "--port", "7991"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        for line in server.stdout:
            if "http://" in line:
                break
        at = "http://localhost:7991"
        token = re.search(r"aligngs_7991=([^;]+);", opened(at).headers["Set-Cookie"]).group(1)
        with opened(at + "/api/scene/coarse/scene.labels.ply") as answer:
            splats = json.loads(gzip.decompress(answer.read()).split(b"\n", 1)[0])["total"]
        bits = bytearray((splats + 7) // 8)
        bits[: splats // 80] = b"\xff" * (splats // 80)
        body = {"name": "my corner", "scene": "scene.labels.ply", "splats": str(splats), "places": base64.b64encode(gzip.compress(bytes(bits), mtime=0)).decode()}
        headers = {"Content-Type": "application/json", "X-AlignGS-Token": token}
        opened(urllib.request.Request(at + "/api/selections/save", json.dumps(body).encode(), headers)).read()
    finally:
        server.terminate()
        server.communicate()


def write_transforms(prepared):
    """The photos and cameras once more as nerfstudio has them."""
    shutil.copytree(prepared / "room" / "images", prepared / "nerf" / "images")
    text = (prepared / "run" / "transforms.json").read_text().replace("../room/images/", "images/")
    (prepared / "nerf" / "transforms.json").write_text(text)


def prepare(output, size=None, iterations=100):
    """A folder with a scene (`room`), the same as other data sets, two trained runs, a list of rooms and a finished batch."""
    prepared = PREPARED[0] = output / "prepared"
    if (prepared / "ready").exists():
        return prepared
    shutil.rmtree(prepared, ignore_errors=True)
    prepared.mkdir(parents=True)
    small = size or SMALL
    (prepared / "rooms.tsv").write_text("one\troom\t-n 20 --no-refine --set mesh.voxel=0.05\ntwo\tcolmap/images\t--method given --semantics none --depth none -n 20\n")
    (prepared / "done.tsv").write_text("one\troom\t-n 5 --no-refine --set mesh.voxel=0.1\n")
    for arguments in (["synth", "room", *small], ["run", "room", "-o", "run", "-n", str(iterations), "--no-refine", *VOXEL],
                      ["edit", "run", "--select", "window", "--recolor", "#ff8800"], ["train", "room", "-o", "other", "-n", "100"],
                      ["batch", "done.tsv", "-o", "rooms"]):
        status, message = call(prepared, arguments)
        if status:
            sys.exit(message)
    draw_selection(prepared)
    for folder in ("images", "sparse"):
        shutil.copytree(prepared / "room" / folder, prepared / "colmap" / folder)
    shutil.copytree(prepared / "colmap", prepared / "plain")
    write_transforms(prepared)
    random_weights = Path(PROGRAM).parent / "benchmarks" / "random_weights"
    if random_weights.exists():
        subprocess.run([random_weights, prepared / "models", "da3-small", "ade20k-linear-s"], check=True, stdout=subprocess.DEVNULL)
    (prepared / "ready").write_text("")
    return prepared
