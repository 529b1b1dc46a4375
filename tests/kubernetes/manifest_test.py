#!/usr/bin/env python3
"""The manifest that `aligngs batch --print kubernetes` writes, against job.schema.json; and that the schema finds faults.

    manifest_test.py PROGRAM      77 where python3-yaml or python3-jsonschema is missing

KUBERNETES_OPENAPI=FILE checks it strictly against the published description of the interface as well, which is
api/openapi-spec/swagger.json of the sources of Kubernetes. It is too large for this repository."""
import copy
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import jsonschema
    import yaml
except ImportError as error:
    print(f"skipped: {error} (apt-get install python3-yaml python3-jsonschema)")
    sys.exit(77)

PROGRAM = sys.argv.pop(1)
SCHEMA = json.loads(Path(__file__).with_name("job.schema.json").read_text())


def manifest(rooms, *options):
    with tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / 'my "rooms".tsv').write_text("".join(f"room{i}\tdemo\n" for i in range(rooms)))
        text = subprocess.run([PROGRAM, "batch", 'my "rooms".tsv', "-o", "out", "--print", "kubernetes", *options], cwd=scratch, check=True,
                              capture_output=True, text=True).stdout
    return yaml.safe_load(text)


def published_schema(file):
    """Of a Job. Unknown fields are errors; two types are texts or numbers, which the description does not say."""
    definitions = json.loads(Path(file).read_text())["definitions"]
    for definition in definitions.values():
        if "properties" in definition:
            definition.setdefault("additionalProperties", False)
    definitions["io.k8s.apimachinery.pkg.util.intstr.IntOrString"] = {"type": ["integer", "string"]}
    definitions["io.k8s.apimachinery.pkg.api.resource.Quantity"] = {"type": ["number", "string"]}
    return {"$ref": "#/definitions/io.k8s.api.batch.v1.Job", "definitions": definitions}


class Manifest(unittest.TestCase):
    def test_follows_the_schema(self):
        jsonschema.validate(manifest(12, "--jobs", "3"), SCHEMA)

    @unittest.skipUnless("KUBERNETES_OPENAPI" in os.environ, "KUBERNETES_OPENAPI names no file")
    def test_follows_the_published_schema(self):
        schema = published_schema(os.environ["KUBERNETES_OPENAPI"])
        job = manifest(12, "--jobs", "3", "--shards", "5")
        jsonschema.validate(job, schema)
        for fault in (lambda m: m["spec"].update(podFailurePolicies={}),
                      lambda m: m["spec"]["podFailurePolicy"]["rules"][0]["onExitCodes"].update(values=["75"])):
            bad = copy.deepcopy(job)
            fault(bad)
            with self.assertRaises(jsonschema.ValidationError):
                jsonschema.validate(bad, schema)

    def test_has_a_pod_a_room_and_names_of_files_as_they_are(self):
        spec = manifest(5)["spec"]
        self.assertEqual((spec["completions"], spec["parallelism"]), (5, 4))
        container = spec["template"]["spec"]["containers"][0]
        self.assertEqual(container["args"], ["batch", '/data/my "rooms".tsv', "-o", "/data/out", "--shards", "5"])
        mounts = {mount["name"] for mount in container["volumeMounts"]}
        self.assertEqual(mounts, {volume["name"] for volume in spec["template"]["spec"]["volumes"]})

    def test_status_75_is_no_failure_and_comes_before_other_rules(self):
        first = manifest(1)["spec"]["podFailurePolicy"]["rules"][0]
        self.assertEqual((first["action"], first["onExitCodes"]["values"]), ("Ignore", [75]))

    def test_the_schema_finds_faults(self):
        good = manifest(2)
        for fault in (lambda m: m["spec"].pop("template"),
                      lambda m: m["spec"].update(completionsMode="Indexed"),
                      lambda m: m["spec"].update(completions="2"),
                      lambda m: m["spec"]["template"]["spec"].update(restartPolicy="OnFailure"),
                      lambda m: m["spec"]["podFailurePolicy"]["rules"][0].update(action="Retry"),
                      lambda m: m["spec"]["podFailurePolicy"]["rules"][0]["onExitCodes"].update(values=[0]),
                      lambda m: m["spec"]["template"]["spec"]["containers"][0].update(name="Not A Label")):
            bad = copy.deepcopy(good)
            fault(bad)
            with self.assertRaises(jsonschema.ValidationError):
                jsonschema.validate(bad, SCHEMA)


if __name__ == "__main__":
    unittest.main()
