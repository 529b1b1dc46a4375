// How deep the first surface is behind each part of the picture: splats blended front to back on a coarse grid.
import { kLeastAlpha, type Splats } from './pick';

/// The camera in the scene's own axes; lengths of the picture in CSS pixels of the canvas. Axes have the length 1.
export interface SplatView { eye: number[]; right: number[]; down: number[]; forward: number[]; focal: number; width: number; height: number }
export interface Region { left: number; top: number; right: number; bottom: number } // CSS pixels of the canvas

const kNear = 0.02;             // scene units, as the camera's
const kLeastCell = 2;           // CSS pixels
const kMostCells = 320;         // in each direction
const kReach = 3;               // standard deviations of a splat that count
const kStopped = 0.5;           // share of the light that a surface stops: what is behind is hidden
const kDark = 0.02;             // of the light: what is behind changes nothing

const dot = (a: number[], x: number, y: number, z: number): number => a[0] * x + a[1] * y + a[2] * z;

/// The place of a splat's centre in the picture; null behind the camera.
export function projected(s: Splats, i: number, v: SplatView): { x: number; y: number; depth: number } | null {
  const x = s.centres[3 * i] - v.eye[0], y = s.centres[3 * i + 1] - v.eye[1], z = s.centres[3 * i + 2] - v.eye[2];
  const depth = dot(v.forward, x, y, z);
  if (depth <= kNear) return null;
  return { x: v.width / 2 + (v.focal * dot(v.right, x, y, z)) / depth, y: v.height / 2 + (v.focal * dot(v.down, x, y, z)) / depth, depth };
}

export class FrontDepth {
  private constructor(private region: Region, private cell: number, private columns: number, private depth: Float32Array) {}

  /// Depth of the first surface at a point; Infinity where there is none.
  at(x: number, y: number): number {
    const column = Math.floor((x - this.region.left) / this.cell), row = Math.floor((y - this.region.top) / this.cell);
    return this.depth[row * this.columns + column] ?? Infinity;
  }

  /// The surface of the splats that are drawn, in a region of the picture.
  static of(s: Splats, drawn: (splat: number) => boolean, v: SplatView, region: Region): FrontDepth {
    const width = region.right - region.left, height = region.bottom - region.top;
    const cell = Math.max(kLeastCell, width / kMostCells, height / kMostCells);
    const columns = Math.max(1, Math.ceil(width / cell)), rows = Math.max(1, Math.ceil(height / cell));
    const light = new Float32Array(columns * rows).fill(1), depth = new Float32Array(columns * rows).fill(Infinity);
    for (const { i, x, y, rx, ry } of footprints(s, drawn, v, region)) {
      const ray = new SplatRay(s, i, v);
      const c0 = Math.max(0, Math.floor((x - rx - region.left) / cell)), c1 = Math.min(columns - 1, Math.floor((x + rx - region.left) / cell));
      const r0 = Math.max(0, Math.floor((y - ry - region.top) / cell)), r1 = Math.min(rows - 1, Math.floor((y + ry - region.top) / cell));
      for (let r = r0; r <= r1; ++r) {
        for (let c = c0; c <= c1; ++c) {
          const at = r * columns + c;
          if (light[at] < kDark) continue;
          const alpha = ray.alpha(region.left + (c + 0.5) * cell, region.top + (r + 0.5) * cell);
          if (alpha < kLeastAlpha || ray.depth <= kNear) continue;
          light[at] *= 1 - alpha;
          if (light[at] <= kStopped && depth[at] === Infinity) depth[at] = ray.depth;
        }
      }
    }
    return new FrontDepth(region, cell, columns, depth);
  }
}

interface Footprint { i: number; x: number; y: number; depth: number; rx: number; ry: number }

/// Splats that reach into a region, nearest first, with the half sizes of their boxes in the picture.
function footprints(s: Splats, drawn: (splat: number) => boolean, v: SplatView, region: Region): Footprint[] {
  const found: Footprint[] = [];
  for (let i = 0; i < s.count; ++i) {
    if (s.opacities[i] < kLeastAlpha) continue;
    const p = projected(s, i, v);
    if (!p) continue;
    const scale = (kReach * v.focal) / p.depth, most = scale * Math.max(s.scales[3 * i], s.scales[3 * i + 1], s.scales[3 * i + 2]);
    const slant = Math.hypot(1, (p.x - v.width / 2) / v.focal, (p.y - v.height / 2) / v.focal), r = most * slant;
    if (p.x + r < region.left || p.x - r > region.right || p.y + r < region.top || p.y - r > region.bottom) continue;
    if (!drawn(i)) continue;
    // Half sizes of the box: the Gaussian's axes, projected near its centre.
    const axes = axesOf(s, i), u = (p.x - v.width / 2) / v.focal, w = (p.y - v.height / 2) / v.focal;
    let xx = 0, yy = 0;
    for (let k = 0; k < 3; ++k) {
      const [ax, ay, az] = axes[k], size = s.scales[3 * i + k], f = dot(v.forward, ax, ay, az);
      xx += (size * (dot(v.right, ax, ay, az) - u * f)) ** 2;
      yy += (size * (dot(v.down, ax, ay, az) - w * f)) ** 2;
    }
    found.push({ i, x: p.x, y: p.y, depth: p.depth, rx: scale * Math.sqrt(xx), ry: scale * Math.sqrt(yy) });
  }
  return found.sort((a, b) => a.depth - b.depth);
}

/// The Gaussian's axes in the scene.
function axesOf(s: Splats, i: number): number[][] {
  const w = s.rotations[4 * i], x = s.rotations[4 * i + 1], y = s.rotations[4 * i + 2], z = s.rotations[4 * i + 3];
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ];
}

/// The largest response of one splat along the ray through a point of the picture (as pick.ts), and its depth there.
class SplatRay {
  depth = 0;
  private readonly g: number[] = [];       // the centre, seen from the eye, in the Gaussian's axes and sizes
  private readonly e: number[][] = [];     // the same of forward, right and down
  private readonly opacity: number;

  constructor(s: Splats, i: number, private v: SplatView) {
    const p = [0, 1, 2].map((k) => s.centres[3 * i + k] - v.eye[k]), axes = axesOf(s, i);
    this.opacity = s.opacities[i];
    for (let k = 0; k < 3; ++k) {
      const inverse = 1 / Math.max(1e-9, s.scales[3 * i + k]), [ax, ay, az] = axes[k];
      this.g.push(dot(p, ax, ay, az) * inverse);
      this.e.push([v.forward, v.right, v.down].map((d) => dot(d, ax, ay, az) * inverse));
    }
  }

  alpha(x: number, y: number): number {
    const u = (x - this.v.width / 2) / this.v.focal, w = (y - this.v.height / 2) / this.v.focal;
    let ee = 0, ge = 0, gg = 0;
    for (let k = 0; k < 3; ++k) {
      const e = this.e[k][0] + u * this.e[k][1] + w * this.e[k][2], g = this.g[k];
      ee += e * e; ge += g * e; gg += g * g;
    }
    this.depth = ge / ee;
    const distance2 = Math.max(0, gg - (ge * ge) / ee);
    return distance2 > kReach * kReach ? 0 : this.opacity * Math.exp(-0.5 * distance2);
  }
}
