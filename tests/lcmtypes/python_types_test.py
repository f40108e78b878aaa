"""Generated Python types: fingerprints as stored, bytes on the wire as they
must be, round trips. Argument: fingerprints.txt."""

import importlib
import struct
import sys


def stored(path):
    with open(path, encoding="ascii") as file:
        for line in file:
            words = line.split("#")[0].split()
            if len(words) == 2:
                package, name = words[0].split(".")
                yield package, name, int(words[1], 16)


def check_fingerprints(path):
    count = 0
    for package, name, fingerprint in stored(path):
        message_type = getattr(importlib.import_module(package), name)
        packed = message_type._get_packed_fingerprint()
        assert packed == struct.pack(">Q", fingerprint), (package, name)
        count += 1
    assert count > 20, count


def check_round_trip():
    import waymark

    image = waymark.image_t()
    image.utime, image.width, image.height = 5000000, 2, 1
    image.row_stride, image.pixelformat = 2, image.PIXEL_FORMAT_GRAY
    image.size, image.data = 2, bytes([7, 200])
    seq = waymark.image_metadata_t()
    seq.key, seq.n, seq.value = "seq", 8, struct.pack(">q", 258)
    image.nmetadata, image.metadata = 1, [seq]
    data = image.encode()
    # Fingerprint, utime, five int32, data, nmetadata, key, n, value.
    expected = struct.pack(
        ">Qqiiiii", 0x14739FFE13D5F5F0, 5000000, 2, 1, 2, 1497715271, 2
    )
    expected += bytes([7, 200]) + struct.pack(">ii", 1, 4) + b"seq\0"
    expected += struct.pack(">iq", 8, 258)
    assert data == expected, data.hex()
    again = waymark.image_t.decode(data)
    assert again.metadata[0].key == "seq"
    assert again.encode() == data

    pose = waymark.pose_t()
    pose.utime, pose.is_known, pose.reason = 7, True, "fine \u00e4"
    pose.pose_W = [1.0, -2.0, 0.5]
    again = waymark.pose_t.decode(pose.encode())
    assert list(again.pose_W) == [1.0, -2.0, 0.5]
    assert again.reason == "fine \u00e4" and again.is_known
    try:
        waymark.image_t.decode(pose.encode())
    except ValueError:
        return
    raise AssertionError("another type's fingerprint was accepted")


check_fingerprints(sys.argv[1])
check_round_trip()
print("passed")
