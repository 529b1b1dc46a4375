// The part of the mesh that belongs to one object. The mesh knows classes alone: of a class, what is near the object's
// splats is the object (as mesh_pick.ts has it).
import { type PlyMesh } from './mesh_ply';
import { type Splats } from './pick';
import { kSolid } from './splat_points';

const kCells = 60;       // cells of the grid along the longest side of the object
const kSpare = 1.5;      // cells: a vertex so near to a splat belongs to it

/// One flag a vertex. `instance` 0: the whole class. Null: the mesh has no classes.
export function verticesOf(mesh: PlyMesh, splats: Splats | null, which: { label: number; instance: number }): Uint8Array | null {
  const { labels, positions } = mesh;
  if (!labels) return null;
  const flags = new Uint8Array(labels.length), near = which.instance > 0 && splats ? nearTo(splats, which) : null;
  for (let v = 0; v < labels.length; ++v) flags[v] = labels[v] === which.label && (!near || near(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2])) ? 1 : 0;
  return flags;
}

/// Whether a place is near a solid splat of an object.
function nearTo(s: Splats, { label, instance }: { label: number; instance: number }): (x: number, y: number, z: number) => boolean {
  const own: number[] = [], low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < s.count; ++i) {
    if (s.labels?.[i] !== label || s.instances?.[i] !== instance || s.opacities[i] < kSolid) continue;
    own.push(i);
    for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], s.centres[3 * i + k]); high[k] = Math.max(high[k], s.centres[3 * i + k]); }
  }
  if (own.length === 0) return () => false;
  const cell = Math.max(...low.map((l, k) => high[k] - l), 1e-6) / kCells, reach = Math.ceil(kSpare), side = kCells + 2 * reach + 1;
  const at = (v: number, k: number) => Math.floor((v - low[k]) / cell) + reach;
  const filled = new Uint8Array(side ** 3);
  for (const i of own) {
    const [x, y, z] = [0, 1, 2].map((k) => at(s.centres[3 * i + k], k));
    for (let a = -reach; a <= reach; ++a) for (let b = -reach; b <= reach; ++b) for (let c = -reach; c <= reach; ++c) {
      if (a * a + b * b + c * c <= kSpare ** 2 + 1) filled[((x + a) * side + y + b) * side + z + c] = 1;
    }
  }
  return (x, y, z) => {
    const i = at(x, 0), j = at(y, 1), k = at(z, 2);
    return i >= 0 && j >= 0 && k >= 0 && i < side && j < side && k < side && filled[(i * side + j) * side + k] === 1;
  };
}
