#!/usr/bin/env python3
"""Asks much of `aligngs view` for minutes: edits, pictures, downloads, and clients that vanish. Memory and descriptors
must not grow. Usage: page_soak.py PROGRAM RUN [--minutes 10]. The run is copied first. Status 1: something grew."""
import argparse
import http.client
import json
import os
import random
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

WARM_SHARE = 0.3         # of the time: until then caches fill and allocators find their size
GROWTH_MB = 40           # of private memory after that, which is the noise of the allocator
GROWTH_DESCRIPTORS = 4   # connections that the kernel is about to close
PATIENCE = 300           # seconds that an answer may take on a busy machine
VANISH_BYTES = 65536     # that a vanishing client takes of a download


class Server:
    def __init__(self, program, run):
        self.process = subprocess.Popen([program, "view", run, "--json", "-q"], stdout=subprocess.PIPE)
        self.port = json.loads(self.process.stdout.readline())["port"]
        self.host = f"127.0.0.1:{self.port}"
        answer = self.ask("/")
        self.token = re.search(r"=([0-9a-f]+)", answer[1]["Set-Cookie"]).group(1)

    def ask(self, path, body=None):
        """Status, headers and content of one request."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        if body is None:
            connection.request("GET", path)
        else:
            connection.request("POST", path, json.dumps(body), {"Content-Type": "application/json", "X-AlignGS-Token": self.token})
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, answer.headers, content

    def vanish(self, request, read):
        """Sends bytes, takes some of the answer, and is gone without a word."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE) as s:
            s.sendall(request.replace("HOST", self.host).encode())
            while read > 0:
                got = len(s.recv(min(read, 65536)))
                if got == 0:
                    break
                read -= got

    def memory(self):
        """Private memory and peak in MB, and open descriptors."""
        with open(f"/proc/{self.process.pid}/status") as f:
            text = f.read()
        number = lambda name: int(re.search(name + r":\s+(\d+)", text).group(1)) / 1024
        return number("RssAnon"), number("VmHWM"), len(os.listdir(f"/proc/{self.process.pid}/fd"))


def soak(server, run, minutes, log):
    state = json.loads(server.ask("/api/state")[2])
    objects = [o["object"] for o in json.loads(server.ask("/api/edits")[2])["objects"]]
    objects = [o for o in objects if not re.match("wall|floor|ceiling", o)] or objects
    views = [c["img_name"] for c in state["cameras"]]
    choose = random.Random(0)
    asked, failed, samples = 0, 0, []
    begin = next_sample = time.time()
    end = begin + 60 * minutes
    while time.time() < end:
        work = choose.choice(["edit", "picture", "scene", "file", "state", "vanish", "vanish", "vanish"])
        wanted = 200
        if work == "edit":
            status = server.ask("/api/edits/push", {"edit": f"highlight {choose.choice(objects)}"})[0]
            status = max(status, server.ask("/api/edits/undo", {})[0])
        elif work == "picture":
            status = server.ask(f"/api/render/{choose.choice(views)}/{choose.choice(['rgb', 'depth', 'normal', 'label'])}.png")[0]
        elif work == "scene":
            status = server.ask(f"/api/scene/{choose.choice(['coarse', 'rest'])}/{state['splats']}")[0]
        elif work == "file":
            status = server.ask("/files/scene.ply")[0]
        elif work == "state":
            status = server.ask("/api/state")[0]
        else:
            status = wanted
            request = choose.choice(["GET /files/scene.ply HTTP/1.1\r\nHost: HOST\r\n\r\n", "GET /api/events HTTP/1.1\r\nHost: HOST\r\n\r\n",
                                     f"GET /api/render/{views[0]}/rgb.png HTTP/1.1\r\nHost: HOST\r\nConnection: close\r\n\r\n", "GET /files/sc"])
            endless = not request.startswith("GET /files/scene") and not request.startswith("GET /api/render")
            server.vanish(request, 0 if request.endswith("sc") else choose.choice([0, 1] if endless else [0, 1, VANISH_BYTES]))
        asked += 1
        if status != wanted:
            failed += 1
            print(f"{work} was answered with {status}", file=log)
        if time.time() >= next_sample:
            private, peak, descriptors = server.memory()
            samples.append((time.time() - begin, private, descriptors))
            print(f"{(time.time() - begin) / 60:5.1f} min  {asked:6d} requests  {private:7.0f} MB private  {peak:7.0f} MB peak  {descriptors:3d} descriptors", file=log, flush=True)
            next_sample += min(60, 6 * minutes)
    time.sleep(2)  # the kernel closes what was left
    private, peak, descriptors = server.memory()
    warm = [s for s in samples if s[0] >= WARM_SHARE * 60 * minutes] or samples
    grown = private - max(s[1] for s in warm[: max(1, len(warm) // 3)])
    more = descriptors - min(s[2] for s in samples)
    print(f"end: {asked} requests, {failed} failed, {private:.0f} MB private, {peak:.0f} MB peak, {descriptors} descriptors; "
          f"{grown:+.0f} MB and {more:+d} descriptors", file=log)
    return failed == 0 and grown <= GROWTH_MB and more <= GROWTH_DESCRIPTORS


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("run")
    parser.add_argument("--minutes", type=float, default=10)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        run = os.path.join(folder, "run")
        shutil.copytree(options.run, run, ignore=shutil.ignore_patterns("control"))
        server = Server(options.program, run)
        try:
            flat = soak(server, run, options.minutes, sys.stdout)
        finally:
            server.process.terminate()
            server.process.wait()
    print("flat" if flat else "NOT flat")
    sys.exit(0 if flat else 1)


if __name__ == "__main__":
    main()
