// The objects of a scene, from the classes and object numbers of its splats: place and size of each.
import { Vec3 } from 'playcanvas';
import { type ClassInfo } from './api';
import { kLeastAlpha, type Splats } from './pick';

export interface SceneObject {
  name: string;          // "pillow#2"
  label: number; instance: number;
  count: number;         // splats
  centre: Vec3;          // in the y-up world
  size: Vec3;            // width, height and depth in scene units, width >= depth
  measured: boolean;     // the size is that of room.json
}

/// Sizes that `aligngs room` measured, by name of the object: width, depth, height in the units of the scene.
export type MeasuredSizes = Map<string, [number, number, number]>;

const kSample = 4000;  // splats of an object that its size is taken from
const kTail = 0.02;    // share of splats at either end that do not count: stray ones

/// The value below which `share` of sorted values lie.
const quantile = (sorted: Float32Array, share: number): number => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
const extent = (values: Float32Array): [number, number] => {
  values.sort();
  return [quantile(values, kTail), quantile(values, 1 - kTail)];
};

/// Objects with a number, the largest first. `toWorld` turns a splat's position into the y-up world.
export function objectsOf(splats: Splats, classes: ClassInfo[], toWorld: (p: number[]) => Vec3, measured: MeasuredSizes): SceneObject[] {
  const { labels, instances } = splats, rows = new Map<number, number[]>();
  if (!labels || !instances) return [];
  for (let i = 0; i < splats.count; ++i) {
    if (instances[i] === 0 || splats.opacities[i] < kLeastAlpha) continue;
    const key = labels[i] * 65536 + instances[i], list = rows.get(key);
    if (list) list.push(i); else rows.set(key, [i]);
  }
  const names = new Map(classes.map((c) => [c.id, c.name])), objects: SceneObject[] = [];
  for (const [key, list] of rows) {
    const label = Math.floor(key / 65536), instance = key % 65536, name = names.get(label);
    if (name === undefined) continue;
    const step = Math.max(1, Math.floor(list.length / kSample)), points: Vec3[] = [];
    for (let i = 0; i < list.length; i += step) points.push(toWorld([0, 1, 2].map((k) => splats.centres[3 * list[i] + k])));
    const box = upright(points), full = `${name}#${instance}`, known = measured.get(full);
    objects.push({ name: full, label, instance, count: list.length, ...box, measured: !!known,
      size: known ? new Vec3(Math.max(known[0], known[1]), known[2], Math.min(known[0], known[1])) : box.size });
  }
  return objects.sort((a, b) => b.count - a.count);
}

/// The upright box along the main direction of the points as seen from above.
function upright(points: Vec3[]): { centre: Vec3; size: Vec3 } {
  const n = points.length, mean = points.reduce((sum, p) => sum.add(p), new Vec3()).mulScalar(1 / n);
  let xx = 0, xz = 0, zz = 0;
  for (const p of points) { const x = p.x - mean.x, z = p.z - mean.z; xx += x * x; xz += x * z; zz += z * z; }
  const turn = 0.5 * Math.atan2(2 * xz, xx - zz), c = Math.cos(turn), s = Math.sin(turn);
  const along = extent(Float32Array.from(points, (p) => c * p.x + s * p.z)), across = extent(Float32Array.from(points, (p) => c * p.z - s * p.x));
  const height = extent(Float32Array.from(points, (p) => p.y));
  const middle = (e: [number, number]) => (e[0] + e[1]) / 2, u = middle(along), v = middle(across);
  const sides = [along[1] - along[0], across[1] - across[0]].sort((a, b) => b - a);
  return { centre: new Vec3(c * u - s * v, middle(height), s * u + c * v), size: new Vec3(sides[0], height[1] - height[0], sides[1]) };
}

/// "212 × 148 × 61 cm": width, depth and height. `metres`: of a scene unit; null: nobody knows.
export function sizeText(size: Vec3, metres: number | null): string {
  const numbers = [size.x, size.z, size.y];
  return metres !== null ? `${numbers.map((v) => Math.round(100 * metres * v)).join(' × ')} cm` : `${numbers.map((v) => v.toFixed(2)).join(' × ')} units`;
}
