// The drawing of a scene, which the report (viewer, small pictures, replay) and the playground share. A view places points: `at` gives CSS
// pixels, `scale` is the number of pixels for a unit of the points. A mark says how something looks: color (a name of style.css), width, dash
// and opacity; of points shape and radius, too.

/** Sizes a canvas to the screen's pixels. Its context, which takes CSS pixels, and its size. */
export function sized(canvas, most = Infinity) {
  const ratio = Math.min(devicePixelRatio || 1, most), { clientWidth: width, clientHeight: height } = canvas;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, width, height };
}

/** Points of flat coordinates. */
export const pairs = (flat) => Array.from({ length: flat.length / 2 }, (_, i) => [flat[2 * i], flat[2 * i + 1]]);

export const distance = ([ax, ay], [bx, by]) => Math.hypot(bx - ax, by - ay);

const circle = (context, x, y, r) => { context.moveTo(x + r, y); context.arc(x, y, r, 0, 2 * Math.PI); };
const lines = (context, ...ends) => ends.forEach(([x, y], i) => (i % 2 ? context.lineTo(x, y) : context.moveTo(x, y)));
const SHAPES = {
  dot: circle, ring: circle,
  cross: (context, x, y, r) => lines(context, [x - r, y - r], [x + r, y + r], [x + r, y - r], [x - r, y + r]),
  triangle: (context, x, y, r) => {
    lines(context, [x, y - r], [x + 0.87 * r, y + 0.62 * r]);
    context.lineTo(x - 0.87 * r, y + 0.62 * r);
    context.closePath();
  },
};

/** Where a line has that length; its end where it is shorter. */
function pointAt(points, length) {
  for (let i = 1; i < points.length; ++i) {
    const [ax, ay] = points[i - 1], [bx, by] = points[i], step = distance(points[i - 1], points[i]);
    if (step >= length && step > 0) return [ax + (bx - ax) * length / step, ay + (by - ay) * length / step];
    length -= step;
  }
  return points.at(-1);
}

export class Drawing {
  #colors = new Map();

  constructor(context, view) {
    Object.assign(this, { context, view });
    context.lineJoin = "round";
  }

  color(name) {
    if (!this.#colors.has(name)) this.#colors.set(name, getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim());
    return this.#colors.get(name);
  }

  /** `trace` makes a path that looks like the mark. It is filled or stroked, as `paint` says. */
  paint({ color, width = 1, dash = [], opacity = 1, cap = "butt", rim }, trace, paint = "stroke", ...rule) {
    const { context } = this;
    context.fillStyle = context.strokeStyle = this.color(color);
    Object.assign(context, { lineWidth: width, globalAlpha: opacity, lineCap: cap });
    context.setLineDash(dash);
    context.beginPath();
    trace(context);
    context[paint](...rule);
    if (rim) {
      context.strokeStyle = this.color(rim);
      context.stroke();
    }
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  trace(points, closed = false) {
    points.forEach((point, i) => this.context[i ? "lineTo" : "moveTo"](...this.view.at(point)));
    if (closed && points.length) this.context.closePath();
  }

  line(points, mark, closed = false) {
    if (points.length > 1) this.paint(mark, () => this.trace(points, closed));
  }

  /** What lies between two boundaries; of a closed lane the ring. */
  band(left, right, closed, mark) {
    const rings = closed ? [left, right] : [[...left, ...[...right].reverse()]];
    this.paint(mark, () => rings.forEach((ring) => this.trace(ring, true)), "fill", "evenodd");
  }

  points(points, mark, size = 1) {
    const isFilled = mark.shape === "dot" || mark.shape === "triangle";
    this.paint(mark, (context) => points.forEach((point) => SHAPES[mark.shape](context, ...this.view.at(point), mark.radius * size)), isFilled ? "fill" : "stroke");
  }

  /** A boundary, drawn as `bridged` where a step is longer than `longest`. */
  boundary(points, mark, closed, longest = Infinity, bridged = mark) {
    const line = closed && points.length > 2 ? [...points, points[0]] : points;
    const isFar = (i) => distance(line[i - 1], line[i]) > longest;
    for (const far of [false, true]) {
      this.paint(far ? { ...mark, ...bridged } : mark, () => {
        for (let i = 1; i < line.length; ++i) {
          if (isFar(i) !== far) continue;
          if (i === 1 || far || isFar(i - 1)) this.context.moveTo(...this.view.at(line[i - 1]));
          this.context.lineTo(...this.view.at(line[i]));
        }
      });
    }
  }

  /** The boundary that is inferred beside one that is known alone: side 0, the left one, or 1. */
  inferred(points, known, width, mark) {
    const left = known === 0 ? -width : width;
    this.line(points.map(([x, y], i) => {
      const before = points[Math.max(0, i - 1)], after = points[Math.min(points.length - 1, i + 1)], length = distance(before, after) || 1;
      return [x - left * (after[1] - before[1]) / length, y + left * (after[0] - before[0]) / length];
    }), mark);
  }

  /** A line across the lane where its boundaries have that length. */
  across(sides, length, mark) { this.line(sides.map((points) => pointAt(points, length)), mark); }

  /** A shape at a place that looks along `yaw`; its outline is ahead and left, in multiples of `size` [px]. A mark with a width is an outline. */
  body(place, yaw, mark, size = 1) {
    const [x, y] = this.view.at(place), [tip, end] = this.view.at([place[0] + Math.cos(yaw), place[1] + Math.sin(yaw)]);
    const length = Math.hypot(tip - x, end - y) / size, ax = (tip - x) / length, ay = (end - y) / length;
    const corners = mark.outline.map(([ahead, left]) => [x + ahead * ax + left * ay, y + ahead * ay - left * ax]);
    this.paint(mark, (context) => {
      corners.forEach((corner, i) => context[i ? "lineTo" : "moveTo"](...corner));
      context.closePath();
    }, mark.width && !mark.rim ? "stroke" : "fill");
  }

  /** Words at a place [px], on a ground of their own where there is a `rim`. */
  text(words, [x, y], { color, rim, font = "11px system-ui, sans-serif", align = "left" }) {
    const { context } = this;
    Object.assign(context, { font, textAlign: align, fillStyle: this.color(color) });
    if (rim) {
      Object.assign(context, { lineWidth: 4, strokeStyle: this.color(rim) });
      context.strokeText(words, x, y);
    }
    context.fillText(words, x, y);
  }
}
