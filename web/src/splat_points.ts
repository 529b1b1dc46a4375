// Places of the splats that can be seen.
import { Vec3 } from 'playcanvas';
import { kLeastAlpha, type Splats } from './pick';

const kPoints = 8000; // splats of a sample
export const kSolid = 0.3; // opacity of a splat that is no haze

/// Median position of the splats that can be seen: the middle of the room. An exported page has no others.
export function middleOf(s: Splats, toWorld: (p: number[]) => Vec3): Vec3 {
  const seen = Array.from(s.opacities.keys()).filter((i) => s.opacities[i] >= kLeastAlpha);
  if (seen.length === 0) return new Vec3();
  return toWorld([0, 1, 2].map((k) => Float32Array.from(seen, (i) => s.centres[3 * i + k]).sort()[seen.length >> 1]));
}

/// A sample of the splats that are no haze, in the y-up world.
export function solidPoints(s: Splats, toWorld: (p: number[]) => Vec3): Vec3[] {
  const step = Math.max(1, Math.floor(s.count / kPoints)), points: Vec3[] = [];
  for (let i = 0; i < s.count; i += step) {
    if (s.opacities[i] >= kSolid) points.push(toWorld([s.centres[3 * i], s.centres[3 * i + 1], s.centres[3 * i + 2]]));
  }
  return points;
}
