"""A project outside this one builds and runs against an installed Waymark.

usage: outside_project_test.py SOURCE BUILD SCRATCH

The project is the example of processes/README.md, taken from the page itself.
It runs on a log written here, byte by byte, so that neither our writer nor our
message code can hide a fault of the other.
"""

import pathlib
import re
import shutil
import struct
import subprocess
import sys

SOURCE, BUILD, SCRATCH = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
PREFIX = SCRATCH / "prefix"
EVENT_MAGIC = 0xEDA1DA01


def run(*command, status=0):
    done = subprocess.run(
        [str(c) for c in command], capture_output=True, text=True
    )
    if done.returncode != status:
        sys.exit(
            f"{' '.join(map(str, command))}\nended with {done.returncode}, "
            f"not {status}:\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
        )
    return done


def take_example():
    """Writes the files that the page shows: ```language path."""
    page = (SOURCE / "processes" / "README.md").read_text()
    files = re.findall(r"^```\w+ (\S+)\n(.*?)^```$", page, re.M | re.S)
    for name, text in files:
        path = SCRATCH / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return [name for name, _ in files]


def write_log(path, messages):
    """An LCM log of (utime, channel, bytes)."""
    with open(path, "wb") as log:
        for number, (utime, channel, data) in enumerate(messages):
            name = channel.encode()
            log.write(
                struct.pack(
                    ">IqqII", EVENT_MAGIC, number, utime, len(name), len(data)
                )
            )
            log.write(name + data)


def read_log(path):
    data = path.read_bytes()
    position = 0
    while position < len(data):
        magic, _, utime, name_size, size = struct.unpack_from(
            ">IqqII", data, position
        )
        assert magic == EVENT_MAGIC, f"no event at byte {position}"
        position += struct.calcsize(">IqqII")
        channel = data[position : position + name_size].decode()
        position += name_size
        yield utime, channel, data[position : position + size]
        position += size


def check_on_a_log(program):
    """0.5 mm a tick; forward 100, turn on the spot, back 40: 70 mm."""
    sys.path += [
        str(PREFIX / "lib/python3/dist-packages"),
        str(SCRATCH / "python"),
    ]
    run(
        "lcm-gen", "--python", "--ppath", SCRATCH / "python",
        SCRATCH / "odometer/distance_t.lcm",
    )  # fmt: skip
    from example import distance_t
    from waymark import encoders_t

    ticks = [(0, 0), (100, 100), (50, 150), (10, 110)]
    messages = []
    for i, (left, right) in enumerate(ticks):
        message = encoders_t()
        message.utime = 1_000_000_000 + i * 50_000
        message.seq = i
        message.left_ticks, message.right_ticks = left, right
        messages.append((message.utime, "ENCODERS", message.encode()))
    # Time going backwards: one counted drop, nothing else lost.
    messages.append((messages[-1][0] + 1, "ENCODERS", messages[1][2]))
    write_log(SCRATCH / "in.lcm", messages)
    run(
        program, "--config", SCRATCH / "odometer/odometer.yaml",
        "--log-in", SCRATCH / "in.lcm", "--log-out", SCRATCH / "out.lcm",
    )  # fmt: skip
    out = [
        (utime, distance_t.decode(data).distance)
        for utime, channel, data in read_log(SCRATCH / "out.lcm")
        if channel == "DISTANCE"
    ]
    expected = [0.0, 0.05, 0.05, 0.07]
    assert [utime for utime, _ in out] == [m[0] for m in messages[:4]], out
    for (_, distance), truth in zip(out, expected):
        # Sums of a few products of doubles.
        assert abs(distance - truth) < 1e-12, out


def main():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    SCRATCH.mkdir(parents=True)
    files = take_example()
    assert len(files) >= 6, f"processes/README.md shows only {files}"
    run("cmake", "--install", BUILD, "--prefix", PREFIX)
    run(
        "cmake", "-G", "Ninja", "-S", SCRATCH / "odometer",
        "-B", SCRATCH / "build", f"-DCMAKE_PREFIX_PATH={PREFIX}",
        "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror",
    )  # fmt: skip
    run("cmake", "--build", SCRATCH / "build")

    program = SCRATCH / "build/odometer"
    config = SCRATCH / "odometer/odometer.yaml"
    assert "--check-config" in run(program, "--help").stdout
    run(program, "--config", config, "--check-config")
    printed = run(program, "--config", config, "--print-config").stdout
    assert float(printed.split("meters_per_tick:")[1]) == 0.0005, printed
    refused = run(
        program, "--set", "meters_per_tick=-1", "--check-config", status=2
    ).stderr
    assert "meters_per_tick" in refused and refused.count("\n") == 1, refused
    check_on_a_log(program)
    shutil.rmtree(SCRATCH)
    print("outside_project_test: passed")


main()
