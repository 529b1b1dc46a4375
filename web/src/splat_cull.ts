// Splats that a picture cannot show: outside of the view, too small, or too faint. They are not given to the graphics
// unit, which would compute four corners of each.
import { type Splats } from './pick';

const kSpare = (8 * Math.PI) / 180; // how much wider than the view is kept: the camera turns until the next sort
const kMostHalf = (80 * Math.PI) / 180; // of half a view with that
const kReach = 3;         // standard deviations of a splat that are drawn
const kCorner = 2.83;     // of a splat's standard deviation, the side that PlayCanvas compares with the least size
const kLowPass = 0.3;     // squared half pixels that PlayCanvas adds to a splat's variance
const kOblique = 1.5;     // a splat beside the axis is drawn larger than one on it, at most by so much

/// A camera in the scene's own axes. `tanX`, `tanY`: of half the view. `focal`, `leastSize`: half pixels as drawn, as PlayCanvas
/// counts them (gsplatCorner).
export interface CullView { eye: number[]; right: number[]; down: number[]; forward: number[]; tanX: number; tanY: number; focal: number; leastSize: number; leastAlpha: number }

export class SplatCull {
  private sizes: Float32Array; // the largest standard deviation of each splat
  private kept: Uint8Array;

  constructor(private splats: Splats) {
    this.sizes = Float32Array.from({ length: splats.count }, (_, i) => Math.max(splats.scales[3 * i], splats.scales[3 * i + 1], splats.scales[3 * i + 2]));
    this.kept = new Uint8Array(splats.count);
  }

  /// Moves the splats of `order` that a picture may show before the others, both in their order. Their number, or `count`
  /// where `order` is not that of these splats.
  apply(order: Uint32Array, count: number, view: CullView): number {
    const { kept } = this, hidden: number[] = [];
    if (count !== kept.length) return count;
    for (let k = 0; k < count; ++k) if (order[k] >= count) return count;
    this.look(view);
    let n = 0;
    for (let k = 0; k < count; ++k) {
      const i = order[k];
      if (kept[i]) order[n++] = i; else hidden.push(i);
    }
    for (let k = 0; k < hidden.length; ++k) order[n + k] = hidden[k];
    return n;
  }

  private look({ eye, right, down, forward, tanX, tanY, focal, leastSize, leastAlpha }: CullView): void {
    const { centres, opacities } = this.splats, { sizes, kept } = this;
    const halfX = Math.min(kMostHalf, Math.atan(tanX) + kSpare), halfY = Math.min(kMostHalf, Math.atan(tanY) + kSpare);
    const wideX = Math.tan(halfX), wideY = Math.tan(halfY), edgeX = kReach / Math.cos(halfX), edgeY = kReach / Math.cos(halfY);
    const leastShare = Math.sqrt(Math.max(0, (leastSize / kCorner) ** 2 - kLowPass)) / (kOblique * focal); // of the distance
    for (let i = 0; i < kept.length; ++i) {
      if (opacities[i] < leastAlpha) { kept[i] = 0; continue; }
      const x = centres[3 * i] - eye[0], y = centres[3 * i + 1] - eye[1], z = centres[3 * i + 2] - eye[2], s = sizes[i];
      const ahead = x * forward[0] + y * forward[1] + z * forward[2];
      const shown = ahead > -kReach * s && s >= leastShare * ahead
        && Math.abs(x * right[0] + y * right[1] + z * right[2]) <= ahead * wideX + s * edgeX
        && Math.abs(x * down[0] + y * down[1] + z * down[2]) <= ahead * wideY + s * edgeY;
      kept[i] = shown ? 1 : 0;
    }
  }
}
