"""Runs the benchmark executables of a folder and merges their JSON rows.

usage: run_benches.py FOLDER [ID|AREA...] [--full] [--json FILE]

Each executable <area>_bench takes [ID...] [--full] [--json FILE], prints its
own table and writes a list of rows. An AREA runs all rows of one executable,
an ID (as in Y23) the rows of that id wherever they are.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile


def refuse(text):
    print(f"bench: {text}", file=sys.stderr)
    sys.exit(2)


def rows_of(program, ids, full, path):
    """Runs one executable; its rows, or None when it failed."""
    command = [str(program), *ids, *(["--full"] if full else [])]
    status = subprocess.run([*command, "--json", str(path)]).returncode
    if status != 0:
        print(f"bench: {program.name} ended with {status}", file=sys.stderr)
        return None
    return json.loads(path.read_text()) if path.exists() else []


def main():
    parser = argparse.ArgumentParser(prog="./run bench")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("ids", nargs="*", metavar="ID|AREA")
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    arguments = parser.parse_intermixed_args()

    programs = {
        path.name.removesuffix("_bench"): path
        for path in sorted(arguments.folder.glob("*_bench"))
    }
    if not programs:
        refuse(f"no benchmark in {arguments.folder}")
    areas = [a for a in arguments.ids if a in programs]
    ids = [i for i in arguments.ids if i not in programs]
    if arguments.json and not arguments.json.absolute().parent.is_dir():
        refuse(f"{arguments.json}: no such folder")

    rows, failed = [], []
    with tempfile.TemporaryDirectory() as scratch:
        for area, program in programs.items():
            whole = area in areas or not arguments.ids
            if not whole and not ids:
                continue
            result = rows_of(
                program,
                [] if whole else ids,
                arguments.full,
                pathlib.Path(scratch) / f"{area}.json",
            )
            if result is None:
                failed.append(area)
            else:
                rows += result
    found = {row["id"] for row in rows}
    unknown = [i for i in ids if i not in found]
    if unknown and not failed:
        refuse(
            f"no row has the id {', '.join(unknown)}; "
            f"areas are: {', '.join(programs)}"
        )
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n")
        print(f"bench: {len(rows)} rows written to {arguments.json}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
