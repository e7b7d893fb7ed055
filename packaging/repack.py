"""Compresses a wheel as far as deflate goes, in place: the same files, a few per cent smaller. Takes zopfli from PyPI: python repack.py WHEEL."""

import sys
import zipfile
from pathlib import Path

import zopfli.zlib


class Deflate:
    """What zipfile takes for a compressor: all of a file at once."""

    def __init__(self) -> None:
        self.data = bytearray()

    def compress(self, data: bytes) -> bytes:
        self.data += data
        return b""

    def flush(self) -> bytes:
        # Without the head and the checksum of zlib.
        return zopfli.zlib.compress(bytes(self.data), numiterations=5)[2:-4]


def main(wheel: Path) -> None:
    """Writes a new file beside it, which takes its name when it holds the same."""
    new = wheel.with_suffix(".new")
    # zipfile asks here, for a file that is written, and has no public way to be told.
    zipfile._get_compressor = lambda *_: Deflate()
    with zipfile.ZipFile(wheel) as before, zipfile.ZipFile(new, "w", zipfile.ZIP_DEFLATED) as after:
        for entry in before.infolist():
            after.writestr(entry, before.read(entry))
    with zipfile.ZipFile(wheel) as before, zipfile.ZipFile(new) as after:
        assert before.namelist() == after.namelist()
        for name in before.namelist():
            assert before.read(name) == after.read(name), name
    print(f"{wheel.name}: {wheel.stat().st_size} bytes, now {new.stat().st_size}")
    new.replace(wheel)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
