#!/usr/bin/python3
"""Compares the schema of the scene format with the loader.

check_format.py SOURCE_ROOT LOAD_SCENE [--write]: every file of scenes/ fits the schema and loads, and so does
what is written down of it after random edits; every bad
document of bad_scenes.json is refused by the loader with the message that stands there, and by the
schema where a schema can say it; every good one passes both. Schema and description have every
parameter of the loader's table, and the schema has its range and its types; what both say of
settings is made from the program's table, and --write makes it anew.
"""
import base64
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

# A PNG with one texel.
TEXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==")
ERR_USAGE, ERR_INPUT = 1, 2
failures = 0


def fail(name, text):
    global failures
    failures += 1
    print(f"FAIL {name}: {text}")


def load(loader, folder, case):
    """Writes the case's document, runs the loader, and returns (status, code, message)."""
    path = os.path.join(folder, "scene.json")
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write(case["text"] if "text" in case else json.dumps({"lampyris": 1} | case["scene"]))
    arguments = [f"{key}={value}" for key, value in case.get("overrides", {}).items()]
    done = subprocess.run([loader, path] + arguments, stdout=subprocess.PIPE, encoding="utf-8")
    code, _, message = done.stdout.strip().partition(" ")
    return done.returncode, int(code or 0), message


def check_scene(loader, validator, path, mesh):
    """Checks a scene file of the tree. A scene that needs a mesh of the user gets `mesh`."""
    name = os.path.basename(path)
    with open(path, encoding="utf-8") as file:
        scene = json.load(file)
    for error in validator.iter_errors(scene):
        fail(name, f"{error.json_path}: {error.message}")
    needs_mesh = "mesh" in scene.get("define", {})
    written = os.path.join(os.path.dirname(mesh), "written.json")
    done = subprocess.run([loader, "--edit", written, path] + ([f"mesh={mesh}"] if needs_mesh else []),
                          stdout=subprocess.PIPE, encoding="utf-8")
    if done.returncode != 0:
        fail(name, done.stdout.strip())
        return
    if os.path.getsize(written) > 1 << 20:
        return  # the Python module needs a second per megabyte
    with open(written, encoding="utf-8") as file:
        edited = json.load(file)
    for error in validator.iter_errors(edited):
        fail(name, f"written down: {error.json_path}: {error.message[:200]}")


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


def try_schema(validator, material):
    return validator.is_valid({"lampyris": 1, "materials": {"a": material}})


def check_parameters(loader, validator, description):
    table = subprocess.run([loader, "--parameters"], stdout=subprocess.PIPE, encoding="utf-8")
    lines = table.stdout.strip().split("\n")
    for line in lines:
        name, count, least, greatest, models, _ = line.split(" ", 5)
        if f"`{name}`" not in description:
            fail(name, "scene-format.md does not describe it")
        for model in "diffuse mirror principled dielectric conductor phong blinn_phong microfacet".split():
            material = {"type": model}
            if name == "alpha_cutoff":
                material["alpha"] = "mask"
            for value, inside in ((float(least), True), (float(greatest), True),
                                  (float(least) - 1, False), (2 * float(greatest), False)):
                material[name] = value if count == "1" else [value] * 3
                expected = inside and model in models.split(",")
                if try_schema(validator, material) != expected:
                    fail(name, f"the schema {'refuses' if expected else 'accepts'} {value} of {model}")
    return len(lines)


def schema_of(row):
    """Returns the schema's line for a row of the table of settings."""
    least, greatest = row["range"]
    values = {"switch": {"type": "boolean"}, "choice": {"enum": row["words"]},
              "count": {"type": "integer", "minimum": int(least), "maximum": int(greatest)},
              "real": {"type": "number", "minimum": least, "maximum": greatest}}[row["type"]]
    word = [{"const": row["word"]}] if row["word"] else []
    line = {"description": row["help"], "anyOf": [values] + word + [{"$ref": "#/$defs/reference"}]}
    return f'        "{row["key"]}": {json.dumps(line)}'


def description_of(row):
    """Returns the line of scene-format.md for a row of the table of settings."""
    quoted = [f'`"{word}"`' for word in row["words"] + ([row["word"]] if row["word"] else [])]
    values = {"switch": "`true` or `false`", "choice": ", ".join(quoted[:-1]) + " or " + "".join(quoted[-1:])}
    least, greatest = (f"{value:.15g}" for value in row["range"])
    text = values[row["type"]] if row["type"] in values else f"{least} to {greatest}" + "".join(" or " + word for word in quoted)
    word, colon, meaning = row["default"].partition(":")
    word = {"switch": {"on": "`true`", "off": "`false`"}.get(word), "choice": f'`"{word}"`'}.get(row["type"], word)
    return f'| `{row["key"]}` | {text} | {word + colon + meaning} | {row["help"]} |'


def replaced(text, begin, end, lines):
    head, rest = text.split(begin, 1)
    return head + begin + lines + end + rest.split(end, 1)[1]


def check_settings(root, loader, writes):
    """Checks that the schema and the description agree with the program's table of settings, or updates
    them."""
    table = json.loads(subprocess.run([loader, "--settings"], stdout=subprocess.PIPE, encoding="utf-8").stdout)
    for name in ("scene.schema.json", "scene-format.md"):
        path = os.path.join(root, "docs", name)
        with open(path, encoding="utf-8") as file:
            text = wanted = file.read()
        for section in ("film", "settings"):
            rows = [row for row in table if row["section"] == section]
            if name.endswith("json"):
                begin = f'    "{section}": {{\n      "type": "object",\n      "properties": {{\n        "comment": {{"$ref": "#/$defs/comment"}},\n'
                wanted = replaced(wanted, begin, "\n      },\n", ",\n".join(map(schema_of, rows)))
            else:
                lines = ["", "| key | values | default | meaning |", "|---|---|---|---|", *map(description_of, rows), "", ""]
                wanted = replaced(wanted, f"<!-- {section}: -->\n", f"<!-- :{section} -->", "\n".join(lines))
        if writes:
            with open(path, "w", encoding="utf-8") as file:
                file.write(wanted)
        elif wanted != text:
            fail(name, "is not what the table of settings says: check_format.py ... --write makes it so")
    return len(table)


def main():
    root, loader = sys.argv[1:3]
    settings = check_settings(root, loader, "--write" in sys.argv)
    with open(os.path.join(root, "docs", "scene.schema.json"), encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)

    with open(os.path.join(root, "docs", "scene-format.md"), encoding="utf-8") as file:
        parameters = check_parameters(loader, validator, file.read())

    scenes = os.path.join(root, "scenes")
    names = sorted(name for name in os.listdir(scenes) if name.endswith(".json"))
    with open(os.path.join(root, "tests", "scene", "bad_scenes.json"), encoding="utf-8") as file:
        table = json.load(file)
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "one.obj"), "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        with open(os.path.join(folder, "ball.json"), "w") as file:
            json.dump({"lampyris": 1, "materials": {"m": {}},
                       "shapes": [{"type": "sphere", "radius": 1, "material": "m"}]}, file)
        with open(os.path.join(folder, "point.obj"), "w") as file:
            file.write("v 1 1 1\nf 1 1 1\n")
        with open(os.path.join(folder, "mesh.fbx"), "w") as file:
            file.write("x")
        with open(os.path.join(folder, "texel.png"), "wb") as file:
            file.write(TEXEL)
        with open(os.path.join(folder, "broken.obj"), "w") as file:
            file.write("v 0 0\n")
        os.mkfifo(os.path.join(folder, "pipe.obj"))
        os.symlink("/etc/passwd", os.path.join(folder, "link.obj"))
        for name in names:
            check_scene(loader, validator, os.path.join(scenes, name),
                        os.path.join(folder, "one.obj"))
        for case in table["bad"]:
            check_bad(loader, folder, validator, case)
        for case in table["good"]:
            check_good(loader, folder, validator, case)
    print(f"{settings} settings, {parameters} parameters, {len(names)} scenes, {len(table['bad'])} bad and {len(table['good'])} good documents, "
          f"{failures} failures")
    sys.exit(failures > 0)


if __name__ == "__main__":
    main()
