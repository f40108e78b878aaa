"""Runs the benchmark executables of a folder and merges their JSON rows.

usage: run_benches.py FOLDER [ID|AREA|SYSTEM...] [--full] [--json FILE]

Each executable <area>_bench takes [ID...] [--full] [--json FILE], prints its
own table and writes a list of rows; --list prints its IDs. An AREA runs all
rows of one executable, and of those whose names begin with it and a _; an ID
(as in Y23) the rows of that id wherever they are; a SYSTEM (as in Y) those of
all its ids.
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


def ids_of(program):
    """The IDs that an executable knows, each with its meaning."""
    listed = subprocess.run(
        [str(program), "--list"], capture_output=True, text=True, check=True
    ).stdout
    return dict(line.split("\t", 1) for line in listed.splitlines())


def is_of(area, wanted):
    """Whether `wanted` asks for an area: simulator for simulator_drives."""
    return area == wanted or area.startswith(wanted + "_")


def is_id(name, wanted):
    """Whether `wanted` asks for an ID: itself, Y for Y23, Y4 for Y4-grey."""
    return name == wanted or (
        name.startswith(wanted)
        and (name[len(wanted)] == "-" or
             (len(wanted) == 1 and name[1].isdigit()))
    )


def rows_of(program, ids, full, path):
    """Runs one executable; its rows, or None when it failed."""
    command = [str(program), *ids, *(["--full"] if full else [])]
    status = subprocess.run([*command, "--json", str(path)]).returncode
    if status != 0:
        print(f"bench: {program.name} ended with {status}", file=sys.stderr)
        return None
    return json.loads(path.read_text())


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
    known = {area: ids_of(program) for area, program in programs.items()}
    for wanted in arguments.ids:
        is_known = any(is_of(area, wanted) for area in known)
        if not is_known and not any(
            is_id(name, wanted) for names in known.values() for name in names
        ):
            everything = [
                f"{area} ({', '.join(ids)})" for area, ids in known.items()
            ]
            refuse(f"no benchmark '{wanted}'; there are: {', '.join(everything)}")
    if arguments.json and not arguments.json.absolute().parent.is_dir():
        refuse(f"{arguments.json}: no such folder")

    rows, failed = [], []
    with tempfile.TemporaryDirectory() as scratch:
        for area, program in programs.items():
            ids = [
                name
                for name in known[area]
                if any(is_id(name, wanted) for wanted in arguments.ids)
            ]
            is_whole = any(is_of(area, wanted) for wanted in arguments.ids)
            if is_whole or not arguments.ids:
                ids = []
            elif not ids:
                continue
            path = pathlib.Path(scratch) / f"{area}.json"
            result = rows_of(program, ids, arguments.full, path)
            if result is None:
                failed.append(area)
            else:
                rows += result
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n")
        print(f"bench: {len(rows)} rows written to {arguments.json}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
