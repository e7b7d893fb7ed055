/** @file Curves on a canvas: decimated so that many rows cost as much as there are pixels. */

/** @typedef {{x0: number, x1: number, y0: number, y1: number, left: number, top: number, width: number, height: number}} Frame axes' ranges and their place in pixels */

/**
 * Rows in order of x: of every column of pixels the first, lowest, highest and last value are drawn. Empty cells are gaps.
 * @param {CanvasRenderingContext2D} g @param {ArrayLike<number>} xs @param {ArrayLike<number>} ys @param {number} from @param {number} to @param {Frame} f
 */
export function ordered(g, xs, ys, from, to, f) {
  const sx = f.width / (f.x1 - f.x0), sy = f.height / (f.y1 - f.y0), ox = f.left - f.x0 * sx, oy = f.top + f.y1 * sy;
  g.beginPath();
  let bucket = NaN, low = 0, high = 0, last = 0, open = false;
  for (let i = from; i < to; i++) {
    const y = ys[i];
    if (!(Math.abs(y) < Infinity)) {
      if (open) flush(g, bucket, low, high, last, oy, sy);
      open = false;
      bucket = NaN;
      continue;
    }
    const px = ox + xs[i] * sx, column = Math.round(px * 2);
    if (!open) {
      g.moveTo(px, oy - y * sy);
      open = true;
      bucket = column;
      low = high = last = y;
    } else if (column === bucket) {
      if (y < low) low = y;
      if (y > high) high = y;
      last = y;
    } else {
      flush(g, bucket, low, high, last, oy, sy);
      g.lineTo(px, oy - y * sy);
      bucket = column;
      low = high = last = y;
    }
  }
  if (open) flush(g, bucket, low, high, last, oy, sy);
  g.stroke();
}

function flush(g, bucket, low, high, last, oy, sy) {
  if (low === high) return;
  const x = bucket / 2;
  g.lineTo(x, oy - low * sy);
  g.lineTo(x, oy - high * sy);
  g.lineTo(x, oy - last * sy);
}

/** Any rows: what moves less than half a pixel is passed over. */
export function free(g, xs, ys, from, to, f) {
  const sx = f.width / (f.x1 - f.x0), sy = f.height / (f.y1 - f.y0), ox = f.left - f.x0 * sx, oy = f.top + f.y1 * sy;
  g.beginPath();
  let open = false, lx = 0, ly = 0;
  for (let i = from; i < to; i++) {
    const px = ox + xs[i] * sx, py = oy - ys[i] * sy;
    if (!(Math.abs(px) < 1e7 && Math.abs(py) < 1e7)) {
      open = false;
      continue;
    }
    if (!open) g.moveTo(px, py);
    else if (Math.abs(px - lx) + Math.abs(py - ly) < 0.6 && i + 1 < to) continue;
    else g.lineTo(px, py);
    open = true;
    lx = px;
    ly = py;
  }
  g.stroke();
}

/** Widens a range by a little; an empty one gets a size. @param {number} low @param {number} high @param {number} share */
export function widen(low, high, share) {
  if (!(low <= high)) return [-1, 1];
  const span = high - low;
  // What only rounding moves is shown as a level line.
  const least = 1e-6 * Math.max(Math.abs(low), Math.abs(high));
  if (span > least) return [low - share * span, high + share * span];
  const half = Math.max(0.05 * Math.abs(high), least, 1e-9) || 1;
  return low === 0 && high === 0 ? [-1, 1] : [low - half, high + half];
}
