#!/usr/bin/python3
"""Holds the scene format's schema against its loader.

check_format.py SOURCE_ROOT LOAD_SCENE: every file of scenes/ fits the schema; every bad document of
bad_scenes.json is refused by the loader with the message that stands there, and by the schema where
a schema can say it; every good one passes both.
"""
import json
import os
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("skipped: no module jsonschema")
    sys.exit(1 if os.environ.get("LAMPYRIS_NO_SKIP") else 77)

ERR_USAGE, ERR_INPUT = 1, 2
failures = 0


def fail(name, text):
    global failures
    failures += 1
    print(f"FAIL {name}: {text}")


def load(loader, folder, case):
    """Writes the case's document and runs the loader; returns (status, code, message)."""
    path = os.path.join(folder, "scene.json")
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write(case["text"] if "text" in case else json.dumps({"lampyris": 1} | case["scene"]))
    arguments = [f"{key}={value}" for key, value in case.get("overrides", {}).items()]
    done = subprocess.run([loader, path] + arguments, stdout=subprocess.PIPE, encoding="utf-8")
    code, _, message = done.stdout.strip().partition(" ")
    return done.returncode, int(code or 0), message


def check_bad(loader, folder, validator, case):
    name, message = case["name"], case["message"]
    status, code, said = load(loader, folder, case)
    expected = ERR_USAGE if case.get("usage") else ERR_INPUT
    if status != 1 or code != expected:
        fail(name, f"status {status}, code {code}: {said}")
    for part in [message] if isinstance(message, str) else message:
        if part not in said:
            fail(name, f"'{part}' is not in '{said}'")
    if not said.startswith(folder) and "any_place" not in case:
        fail(name, f"'{said}' does not begin with the file")
    if case.get("schema", True) and "scene" in case:
        if validator.is_valid({"lampyris": 1} | case["scene"]):
            fail(name, "the schema accepts it")


def check_good(loader, folder, validator, case):
    status, _, said = load(loader, folder, case)
    if status != 0:
        fail(case["name"], said)
    for error in validator.iter_errors({"lampyris": 1} | case["scene"]):
        fail(case["name"], f"schema: {error.message}")


def main():
    root, loader = sys.argv[1:3]
    with open(os.path.join(root, "docs", "scene.schema.json"), encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)

    scenes = os.path.join(root, "scenes")
    names = sorted(name for name in os.listdir(scenes) if name.endswith(".json"))
    for name in names:
        with open(os.path.join(scenes, name), encoding="utf-8") as file:
            for error in validator.iter_errors(json.load(file)):
                fail(name, f"{error.json_path}: {error.message}")

    with open(os.path.join(root, "tests", "scene", "bad_scenes.json"), encoding="utf-8") as file:
        table = json.load(file)
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "one.obj"), "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        with open(os.path.join(folder, "point.obj"), "w") as file:
            file.write("v 1 1 1\nf 1 1 1\n")
        with open(os.path.join(folder, "mesh.fbx"), "w") as file:
            file.write("x")
        with open(os.path.join(folder, "broken.obj"), "w") as file:
            file.write("v 0 0\n")
        os.mkfifo(os.path.join(folder, "pipe.obj"))
        os.symlink("/etc/passwd", os.path.join(folder, "link.obj"))
        for case in table["bad"]:
            check_bad(loader, folder, validator, case)
        for case in table["good"]:
            check_good(loader, folder, validator, case)
    print(f"{len(names)} scenes, {len(table['bad'])} bad and {len(table['good'])} good documents, "
          f"{failures} failures")
    sys.exit(failures > 0)


if __name__ == "__main__":
    main()
