"""What the pages say is there.

usage: documents_test.py SOURCE

Links between pages and to pictures resolve; programs and folders that pages
name exist; every library that ./run installs is named in NOTICE; every channel
is in the table of channels.
"""

import pathlib
import re
import sys

SOURCE = pathlib.Path(sys.argv[1]).resolve()
SKIPPED = ("build", "out", ".git")
faults = []


def pages():
    for path in sorted(SOURCE.rglob("*.md")):
        first = path.relative_to(SOURCE).parts[0]
        if not first.startswith(SKIPPED):
            yield path


def text_of(name):
    return (SOURCE / name).read_text()


def check_links():
    for page in pages():
        # Code looks like links where it has lambdas.
        text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.M | re.S)
        for link in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
            if "://" not in link and not (page.parent / link).exists():
                faults.append(f"{page.relative_to(SOURCE)}: no {link}")


def check_programs():
    """Programs that pages call waymark-… or put into ./run …"""
    programs = set()
    for path in SOURCE.rglob("CMakeLists.txt"):
        if path.relative_to(SOURCE).parts[0].startswith(SKIPPED):
            continue
        text = path.read_text()
        programs.update(
            re.findall(r"waymark_add_(?:process|tool)\(\s*([\w-]+)", text)
        )
        programs.update(re.findall(r"RENAME (waymark-\w+)", text))
    commands = {"setup", "build", "test", "demo", "bench", "spy", "replay", "help"}
    for page in pages():
        text = page.read_text()
        for name in re.findall(r"`(waymark-[a-z]+)(?![\w-])", text):
            if name not in programs:
                faults.append(f"{page.relative_to(SOURCE)}: no program {name}")
        for name in re.findall(r"\./run ([a-z][\w-]*)", text):
            if name not in programs | commands:
                faults.append(f"{page.relative_to(SOURCE)}: no ./run {name}")


def check_notice():
    packages = re.search(r"^packages=\((.*?)^\)", text_of("run"), re.M | re.S)
    notice = text_of("NOTICE")
    for package in packages.group(1).split():
        if package.startswith("lib") and package not in notice:
            faults.append(f"NOTICE does not name {package}")


def check_channels():
    table = text_of("lcmtypes/README.md")
    channels = re.findall(r'= "([A-Z_]+)"', text_of("processes/support/channels.h"))
    for channel in channels:
        if f"`{channel}" not in table:
            faults.append(f"lcmtypes/README.md: no channel {channel}")


check_links()
check_programs()
check_notice()
check_channels()
for fault in faults:
    print(fault)
sys.exit(1 if faults else 0)
