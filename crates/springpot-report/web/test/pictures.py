"""Packs what pictures.mjs took: python3 test/pictures.py FOLDER OUT (needs Pillow)."""

import pathlib
import sys

from PIL import Image

folder, out = map(pathlib.Path, sys.argv[1:])
out.mkdir(parents=True, exist_ok=True)


def palette(pictures, colors):
    """Colours for all of them; vivid ones count, however few their pixels are."""
    parts = [picture.resize((picture.width // 2, picture.height // 2), Image.Resampling.NEAREST) for picture in pictures]
    vivid = {tuple(v & ~3 for v in color) for part in pictures for _, color in part.getcolors(1 << 24)}
    vivid = sorted(color for color in vivid if max(color) - min(color) > 40)
    width = parts[0].width
    rows = 5 * len(vivid) // width + 1
    sheet = Image.new("RGB", (width, sum(part.height for part in parts) + rows))
    top = 0
    for part in parts:
        sheet.paste(part, (0, top))
        top += part.height
    strip = Image.new("RGB", (width, rows))
    strip.putdata([vivid[i * len(vivid) // (rows * width)] for i in range(rows * width)])
    sheet.paste(strip, (0, top))
    return sheet.quantize(colors, Image.Quantize.MEDIANCUT)


for path in sorted(folder.glob("view-*.png")):
    picture = Image.open(path).convert("RGB")
    picture.quantize(palette=palette([picture], 256), dither=Image.Dither.NONE).save(out / path.name, optimize=True)

frames = [Image.open(path).convert("RGB") for path in sorted((folder / "frames").glob("*.png"))]
# One palette for all: what stands still keeps its colours.
colors = palette(frames[:: max(len(frames) // 6, 1)], 255)
indexed = [frame.quantize(palette=colors, dither=Image.Dither.NONE) for frame in frames]
indexed[0].save(out / "moving.gif", save_all=True, append_images=indexed[1:], duration=[50] * (len(frames) - 1) + [700], loop=0, optimize=True)

for path in sorted(out.iterdir()):
    print(f"{path.name}: {path.stat().st_size / 1000:.0f} kB")
