#!/usr/bin/env python3
# validate_json.py SCHEMA FILE...: checks JSON files against a JSON Schema. Status 0: all are valid; 1: a line on stderr for each violation;
# 77: python3-jsonschema is not installed.
import json
import sys

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed", file=sys.stderr)
    sys.exit(77)


def main(schema_path, *paths):
    with open(schema_path, encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    valid = True
    for path in paths:
        with open(path, encoding="utf-8") as file:
            # NaN and Infinity are no JSON, though Python's reader takes them.
            document = json.load(file, parse_constant=lambda word: word)
        for error in validator.iter_errors(document):
            valid = False
            where = "/".join(str(part) for part in error.absolute_path)
            print(f"{path}: {where or 'document'}: {error.message[:300]}", file=sys.stderr)
    return 0 if valid else 1


sys.exit(main(*sys.argv[1:]))
